//! The magnitude as a witness: | |c| / |m| - 1 | > 15 % says that the field is not that of the place, which m carries. It only
//! colours the status, once the calibration is 5 s of motion old; it decides nothing. New here.

use crate::sound::checked;
use nalgebra::SVector;

use super::state::{FIELD, Gaussian, OFFSET};
use super::step::Step;
use super::tuning::Tuning;
use crate::quadric::FitError;

/// Half of the Earth's weakest and twice its strongest field, uT: disturbed places are within it, other units are not.
const POSSIBLE_UT: (f64, f64) = (11.0, 134.0);

/// How far |c| is from |m|.
#[derive(Clone, Debug, Default, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
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

/// That no place has a field as strong or as weak as m, if so.
pub(super) fn impossible_field(filter: &Gaussian, beyond_doubt: f64) -> Option<FitError> {
    let m = filter.vector(FIELD);
    let field_ut = m.norm();
    let doubt_ut = beyond_doubt * m.dot(&(filter.block(FIELD, FIELD) * m)).max(0.0).sqrt() / field_ut;
    let (low_ut, high_ut) = POSSIBLE_UT;
    (field_ut + doubt_ut < low_ut || field_ut - doubt_ut > high_ut).then_some(FitError::FieldOutOfRange {
        field_ut,
        low_ut,
        high_ut,
    })
}

/// The covariance of (b, e) with |m|, and the variance of |m|. Where the field points is not known when it was lost; how strong
/// it is stays known.
pub(super) fn strength_covariance(filter: &Gaussian, lost: bool, lost_sd_ut: f64) -> (SVector<f64, 9>, f64) {
    if lost {
        return (SVector::zeros(), lost_sd_ut * lost_sd_ut);
    }
    let m = filter.vector(FIELD);
    let along = m / m.norm().max(1.0);
    let cross = filter.p.fixed_view::<9, 3>(OFFSET, FIELD) * along;
    (cross, along.dot(&(filter.block(FIELD, FIELD) * along)))
}
