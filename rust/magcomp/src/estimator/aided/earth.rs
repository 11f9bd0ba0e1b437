//! The Earth's field, after a change of place: carried by the gyroscope, where the field of the place says little of it.
//!
//! ```text
//! a new place:  h <- m as it was carried there,  V <- tr P_mm / 2
//! then:         h <- R h + (1 - a) (m - h),      V <- a^2 (sqrt V + |h| sigma_g dt)^2 + (1 - a^2) |m - h|^2 / 3
//! a = exp(-dt motion / 300 s);   f = h,   P_f = P_mm + V I + ...
//! ```
//! So a new place changes no heading when it is believed: its field says how the device turns, not where north is. The longer the
//! device moves about in it, the more it is taken as the Earth's. Source: docs/METHOD-AIDED.md.

use crate::sound::checked;
use nalgebra::Vector3;

use super::state::{BIAS, FIELD, Gaussian};
use super::step::Step;
use super::tuning::Tuning;

/// The Earth's field in a place whose field is another.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub(crate) struct Earth {
    /// h, device frame, uT.
    pub(crate) field_ut: Vector3<f64>,
    /// V, per axis, uT^2.
    pub(crate) variance_ut2: f64,
    /// When the field of the place changed.
    pub(crate) since_ns: i64,
}

checked!(Earth, |it| it.variance_ut2 >= 0.0);

impl Earth {
    /// As `carried` has it.
    pub(crate) fn of(carried: &Gaussian, since_ns: i64) -> Self {
        Self { field_ut: carried.vector(FIELD), variance_ut2: carried.block(FIELD, FIELD).trace() / 2.0, since_ns }
    }

    /// One sample; `filter` is as it was before it.
    pub(crate) fn step(&mut self, step: &Step<'_>, filter: &Gaussian, tuning: &Tuning) {
        let off_ut = filter.vector(FIELD) - self.field_ut;
        let kept = (-step.dt_s * step.motion / tuning.new_place_time_s).exp();
        let bias_rad_s = filter.block(BIAS, BIAS).diagonal().max().sqrt();
        let spread_ut = self.variance_ut2.sqrt() + self.field_ut.norm() * bias_rad_s * step.dt_s;
        self.variance_ut2 = (kept * spread_ut).powi(2) + (1.0 - kept * kept) * off_ut.norm_squared() / 3.0;
        self.field_ut = step.turn * (self.field_ut + off_ut * (1.0 - kept));
    }

    /// Whether the field of `found` is it again, where that of `carried` was not.
    pub(crate) fn is_that_of(&self, found: &Gaussian, carried: &Gaussian, tuning: &Tuning) -> bool {
        let off_ut = |it: &Gaussian| (it.vector(FIELD) - self.field_ut).norm();
        off_ut(found) < tuning.smallest_step_ut.min(0.5 * off_ut(carried))
    }
}
