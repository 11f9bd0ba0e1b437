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

use super::config::AidedConfig;
use super::tuning;

/// Hysteresis: the share of the limit below which the disturbance is over.
const OVER: f64 = 0.9;
/// The running median is faster before this age, in inverse proportion to it, s.
const LEARNED_S: f64 = 30.0;
/// A single sample counts as no more than this, so that a spike is no disturbance.
const LARGEST: f64 = 0.4;
/// Nor does any single one weigh more than this, however far apart they are.
const LARGEST_GAIN: f64 = 0.33;
/// Seconds of motion after the first calibration until the median, and the calibration itself, count as known.
const YOUNG_S: f64 = 5.0;
const SIGMAS: f64 = 3.0;

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
    pub(crate) fn step(&mut self, time_ns: i64, witness: &Witness, dt_s: f64, config: &AidedConfig) {
        let &Witness { size_ut, field_ut, sd_ut, moving } = witness;
        if self.median_ut <= 0.0 {
            self.median_ut = field_ut.max(1.0);
        }
        if moving {
            self.age_s = (self.age_s + dt_s).min(LEARNED_S);
            let most = tuning::STRENGTH_PACE_UT_S * dt_s * (LEARNED_S / self.age_s.max(1.0));
            self.median_ut = (self.median_ut + (size_ut - self.median_ut).clamp(-most, most)).max(1.0);
        }
        let gain = (dt_s / tuning::STRENGTH_TIME_S.max(dt_s)).min(LARGEST_GAIN);
        let off = (size_ut / self.median_ut - 1.0).clamp(-LARGEST, LARGEST);
        self.deviation += gain * (off - self.deviation);
        self.limit = config.strength_share.max(SIGMAS * sd_ut / self.median_ut);
        if self.deviation.abs() > self.limit && !self.young() {
            self.since_ns.get_or_insert(time_ns);
        } else if self.deviation.abs() < OVER * self.limit {
            self.since_ns = None;
        }
    }

    /// What does not fit now is likelier the first calibration's own error than a change.
    pub(crate) fn young(&self) -> bool {
        self.age_s < YOUNG_S
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
