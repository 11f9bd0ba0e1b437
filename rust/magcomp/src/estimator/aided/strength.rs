//! The magnitude as a witness: | |c| / F - 1 | > 15 % says that the field is not that of the place.
//!
//! ```text
//! F += pace dt sign(|c| - F)                      (a running median: short disturbances do not move it)
//! deviation += (dt / t) ((|c| - F) / F - deviation)
//! ```
//! It only colours the status and weakens the learning (noise grows by the excess), once the calibration is 5 s of
//! motion old; it decides nothing: a calibration that is wrong itself must still be able to learn. Only deviations
//! beyond three sigma of |c| count. New here.

use crate::snapshot::checked;
use serde::{Deserialize, Serialize};

use super::tuning::Tuning;

/// What one sample says: |c|, |m|, the standard deviation of |c|, all uT.
pub(crate) struct Witness {
    pub(crate) size_ut: f64,
    pub(crate) field_ut: f64,
    pub(crate) sd_ut: f64,
    pub(crate) moving: bool,
}

/// Running median of |c| and the deviation from it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(crate) struct Strength {
    median_ut: f64,
    age_s: f64,
    deviation: f64,
    limit: f64,
    /// Since when the magnitude is off.
    pub(crate) since_ns: Option<i64>,
}

checked!(Strength, |it| [it.median_ut, it.age_s, it.limit].iter().all(|v| *v >= 0.0));

impl Strength {
    pub(crate) fn step(&mut self, time_ns: i64, witness: &Witness, dt_s: f64, tuning: &Tuning) {
        let &Witness { size_ut, field_ut, sd_ut, moving } = witness;
        if self.median_ut <= 0.0 {
            self.median_ut = field_ut.max(1.0);
        }
        if moving {
            self.age_s = (self.age_s + dt_s).min(tuning.learned_s);
            let most = tuning.strength_pace_ut_s * dt_s * (tuning.learned_s / self.age_s.max(1.0));
            self.median_ut = (self.median_ut + (size_ut - self.median_ut).clamp(-most, most)).max(1.0);
        }
        let gain = (dt_s / tuning.strength_time_s).min(1.0);
        let off = size_ut / self.median_ut - 1.0;
        self.deviation += gain * (off - self.deviation);
        self.limit = tuning.strength_share.max(tuning.strength_sigmas * sd_ut / self.median_ut);
        if self.deviation.abs() > self.limit && !self.young(tuning) {
            self.since_ns.get_or_insert(time_ns);
        } else if self.deviation.abs() < self.limit {
            self.since_ns = None;
        }
    }

    /// What does not fit now is likelier the first calibration's own error than a change.
    pub(crate) fn young(&self, tuning: &Tuning) -> bool {
        self.age_s < tuning.young_s
    }

    /// How far |c| is off, while it is, uT.
    pub(crate) fn excess_ut(&self) -> f64 {
        if self.since_ns.is_some() { self.deviation.abs() * self.median_ut } else { 0.0 }
    }

    /// The device stepped: the deviation was its own.
    pub(crate) fn clear(&mut self) {
        self.since_ns = None;
        self.deviation = 0.0;
    }
}
