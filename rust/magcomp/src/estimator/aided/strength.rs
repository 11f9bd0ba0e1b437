//! The magnitude as a witness: | |c| / |m| - 1 | > 15 % says that the field is not that of the place, which m carries. It only
//! colours the status, once the calibration is 5 s of motion old; it decides nothing. New here.

use crate::snapshot::checked;
use serde::{Deserialize, Serialize};

use super::events::Step;
use super::tuning::Tuning;

/// How far |c| is from |m|.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(crate) struct Strength {
    /// Seconds of motion since the first calibration.
    age_s: f64,
    /// |c| / |m| - 1, low-passed.
    deviation: f64,
    /// Since when the magnitude is off.
    pub(crate) since_ns: Option<i64>,
}

checked!(Strength, |it| it.age_s >= 0.0);

impl Strength {
    pub(crate) fn step(&mut self, step: &Step<'_>, ratio: f64, tuning: &Tuning) {
        if !step.resting {
            self.age_s += step.dt_s;
        }
        self.deviation += (step.dt_s / tuning.strength_time_s).min(1.0) * (ratio - 1.0 - self.deviation);
        if self.deviation.abs() <= tuning.strength_share {
            self.since_ns = None;
        } else if !self.is_young(tuning) {
            self.since_ns.get_or_insert(step.time_ns);
        }
    }

    /// What does not fit now is likelier the first calibration's own error than a change.
    pub(crate) fn is_young(&self, tuning: &Tuning) -> bool {
        self.age_s < tuning.settled_s
    }

    /// The device stepped: the deviation was its own.
    pub(crate) fn clear(&mut self) {
        self.since_ns = None;
        self.deviation = 0.0;
    }
}
