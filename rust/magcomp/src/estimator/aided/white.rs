//! White noise of the magnetometer, from one sample or frame to the next.
//!
//! ```text
//! e_k = raw_k - b - M R M^-1 (raw_{k-1} - b),   sigma^2 += (dt / 0.5 s) (min(|e|^2 / 6, 9 sigma^2) - sigma^2)       of samples, and over 5 s of
//!                                                the means of frames: what a logger has interpolated or held is no better known than it says
//! ```
//! Source: docs/dev/METHOD-AIDED.md.

use crate::math::elementary::gain;
use crate::math::symmetric::inverse;
use crate::priors::BEYOND_CHANCE;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

use super::state::Parts;
use super::tuning::Tuning;

/// Choice: least magnetometer noise, per axis, uT: phones read in steps of up to 0.6 uT, whose rounding alone is 0.17 uT.
const LEAST_NOISE_UT: f64 = 0.2;

/// See the module.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct White {
    variance_ut2: f64,
    /// The one before, uT, and the turn from it to the latest that said nothing.
    pub(super) previous: Option<(Vector3<f64>, Option<Matrix3<f64>>)>,
}

impl White {
    pub(super) fn new(tuning: &Tuning) -> Self {
        Self { variance_ut2: tuning.noise_start_ut.powi(2), previous: None }
    }

    /// sigma^2, uT^2.
    pub(super) fn variance_ut2(&self) -> f64 {
        self.variance_ut2
    }

    /// sigma, uT.
    pub(super) fn sigma_ut(&self) -> f64 {
        self.variance_ut2.sqrt()
    }

    /// A sample or a mean, with the turn from the one before; `None` says nothing.
    pub(super) fn step(
        &mut self,
        raw_ut: Option<&Vector3<f64>>,
        x: &Parts,
        turn: &Matrix3<f64>,
        dt_s: f64,
        memory_s: f64,
        tuning: &Tuning,
    ) {
        let Some(raw_ut) = raw_ut else {
            self.previous =
                self.previous.map(|(raw_ut, since)| (raw_ut, Some(since.map_or(*turn, |since| turn * since))));
            return;
        };
        let (offset_ut, soft_iron) = (x.hard_iron, x.soft_iron());
        if let (Some((previous, since)), Some(w)) = (self.previous, inverse(&soft_iron)) {
            let c = w * (previous - offset_ut);
            let e = raw_ut - offset_ut - soft_iron * (turn * since.map_or(c, |since| since * c));
            let size = e.norm();
            let share = if tuning.noise_learning { gain(dt_s, memory_s) } else { 0.0 };
            let variance = self.variance_ut2;
            self.variance_ut2 += share * ((size * size / 6.0).min(BEYOND_CHANCE.powi(2) * variance) - variance);
            self.variance_ut2 = self.variance_ut2.max(LEAST_NOISE_UT.powi(2));
        }
        self.previous = Some((*raw_ut, None));
    }
}

#[cfg(test)]
mod tests;
