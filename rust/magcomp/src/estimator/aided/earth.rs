//! The Earth's field, after a change of place: either still that of before (h, carried by the gyroscope, probability w), or that of
//! the new place (m).
//!
//! ```text
//! a new place:  h <- m as it was carried there,  s^2 <- tr P_mm / 2,  w <- 1
//! then:         h <- R h,  s^2 <- (s + |h| sigma_g dt)^2 + |h|^2 (q_g^2 dt + v),  w <- w exp(-dt motion / 300 s)
//! f = m + w (h - m),   P_f = P_mm + w s^2 I + w (1 - w) (h - m) (h - m)^T + ...
//! ```

use crate::math::elementary::{exp, hypot};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

use super::state::{BIAS, FIELD, Filter};
use super::step::Step;
use super::tuning::Tuning;
use crate::math::gaussian::Gaussian;

/// The Earth's field in a place whose field is another.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Earth {
    /// When the field of the place changed.
    pub(crate) since_ns: i64,
    /// h, device frame, uT.
    field_ut: Vector3<f64>,
    /// s, per axis, uT.
    sd_ut: f64,
    /// w: above a half it is likelier another than that of the place.
    pub(super) probability: f64,
}

impl Earth {
    /// As `carried` has it, which went by what `before` knew.
    pub(crate) fn of(carried: &Filter, before: Option<&Self>, since_ns: i64) -> Self {
        let Gaussian { mean: field_ut, covariance } = Self::mixed(before, &carried.part(FIELD));
        let variance_ut2 = carried.variances(FIELD).sum() / 2.0 + covariance.trace() / 3.0;
        let since_ns = before.map_or(since_ns, |it| it.since_ns);
        Self { since_ns, field_ut, sd_ut: variance_ut2.sqrt(), probability: 1.0 }
    }

    /// One sample; `filter` is as it was before it.
    pub(crate) fn step(&mut self, step: &Step, filter: &Filter, tuning: &Tuning) {
        let bias_rad_s = filter.variances(BIAS).max().sqrt();
        let size_ut = self.field_ut.norm();
        let drifted_ut = self.sd_ut + size_ut * bias_rad_s * step.dt_s;
        self.sd_ut = hypot(drifted_ut, size_ut * step.noise.turn_rad2(step.dt_s).sqrt());
        self.probability *= exp(-step.dt_s * step.motion / tuning.new_place_time_s);
        self.field_ut = step.turn * self.field_ut;
    }

    /// The chain of rotations is broken, and the field of the place, which was `m`, is `now`: how far it is off is still known,
    /// which way is not.
    pub(crate) fn lose(&mut self, m: &Vector3<f64>, now: &Vector3<f64>) {
        self.sd_ut = hypot(self.sd_ut, (self.field_ut - m).norm() / 3.0_f64.sqrt());
        self.field_ut = *now;
    }

    /// f where the field of the place is `m`, and what its covariance has beyond that of m.
    pub(crate) fn mixed(earth: Option<&Self>, m: &Vector3<f64>) -> Gaussian<3> {
        let Some(earth) = earth else { return Gaussian { mean: *m, ..Gaussian::default() } };
        let (w, off_ut) = (earth.probability, earth.field_ut - m);
        let drifted = Matrix3::from_diagonal_element(w * earth.sd_ut * earth.sd_ut);
        Gaussian { mean: m + off_ut * w, covariance: drifted + off_ut * off_ut.transpose() * (w * (1.0 - w)) }
    }

    /// Whether the field of `found` is it again, where that of `carried` was not.
    pub(crate) fn is_that_of(&self, found: &Filter, carried: &Filter, tuning: &Tuning) -> bool {
        let off_ut = |it: &Filter| (it.part(FIELD) - self.field_ut).norm();
        off_ut(found) < tuning.smallest_step_ut.min(0.5 * off_ut(carried))
    }
}
