//! What b does in time: it hardly moves, or it moves at a rate that lasts. tau and the rate are jointly Gaussian,
//!     rate = rate_0 + K (tau - tau_0) + e,   e ~ N(0, D),   K and D from the time that samples last became prior,
//!     b <- b + rate t + walk,   rate <- rate exp(-t / lasting) + what is fresh

use super::parameters::{COUNT, Gaussian, Tau, TauMatrix};
use super::setting::Setting;
use crate::math::ldl::Ldl;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// See the module.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Motion {
    pub moves: bool,
    pub rate: Vector3<f64>,
    gain: SMatrix<f64, 3, COUNT>,
    covariance: Matrix3<f64>,
}

impl Motion {
    /// With a rate to begin with, units/s, of which nothing is known but the size of rates.
    pub fn new(moves: bool, rate: Vector3<f64>, at: &Setting) -> Self {
        let covariance = Matrix3::identity() * (at.tuning.rate_ut_s / at.unit_ut).powi(2);
        Self { moves, rate, gain: SMatrix::zeros(), covariance }
    }

    /// What is known some seconds later, its factors, and the motion from there; None where that is not positive.
    pub fn carry(
        &self,
        known: &Gaussian,
        prior: &Tau,
        seconds: f64,
        at: &Setting,
    ) -> Option<(Gaussian, Ldl<COUNT>, Self)> {
        let tuning = at.tuning;
        let Gaussian { mut mean, mut covariance } = *known;
        let walk = tuning.walk_ut / at.unit_ut;
        (6..9).for_each(|i| covariance[(i, i)] += walk * walk * seconds);
        if !self.moves {
            return Ldl::new(&covariance).map(|factors| (Gaussian { mean, covariance }, factors, *self));
        }
        let rate = self.rate + self.gain * (mean - prior);
        let mut cross = self.gain * known.covariance;
        let variance = cross * self.gain.transpose() + self.covariance;
        let mut moved = TauMatrix::zeros();
        for i in 0..COUNT {
            for j in 0..3 {
                moved[(i, 6 + j)] = cross[(j, i)] * seconds;
            }
        }
        covariance += moved + moved.transpose();
        for i in 0..3 {
            mean[6 + i] += rate[i] * seconds;
            for j in 0..3 {
                covariance[(6 + i, 6 + j)] += variance[(i, j)] * seconds * seconds;
                cross[(i, 6 + j)] += variance[(i, j)] * seconds;
            }
        }
        let lasts = (-seconds / tuning.rate_s).exp();
        let fresh = (1.0 - lasts * lasts) * (tuning.rate_ut_s / at.unit_ut).powi(2);
        cross *= lasts;
        let variance = variance * (lasts * lasts) + Matrix3::identity() * fresh;
        let factors = Ldl::new(&covariance)?;
        let gain = cross * factors.inverse();
        let motion = Self { moves: true, rate: rate * lasts, gain, covariance: variance - gain * cross.transpose() };
        Some((Gaussian { mean, covariance }, factors, motion))
    }
}
