//! The settings of the paper's method, and what its fits accept.

#[cfg(test)]
mod tests;

use super::uniformity::Normalisation;
use crate::ellipsoid::{FitOptions, Residual};

/// Choice: parameters converge to this, in field strengths, in two iterations from the fit before: a hundredth of what noise at 40 dB leaves in a window of
/// 2000 (tests/host/steps.rs).
const TOLERANCE: f64 = 1e-6;

/// The paper's method (section IV, fig. 3).
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct WindowedConfig {
    /// N_min, samples, 9 to N_max: the shortest window, and what sigma_T looks at. Default 100 (the paper's). Smaller follows
    /// changes sooner with more noise.
    pub n_min: usize,
    /// N_max, samples, at most 100 000 (24 bytes each): the longest window. Default 2000 (the paper's). Larger is steadier under
    /// poor motion and slower to forget.
    pub n_max: usize,
    /// sigma_th, dimensionless, 0 to 10: below it nothing is updated. Default 0.1. It stops updates at rest (not near azimuth
    /// 180), but not in all planar motion.
    pub sigma_th: f64,
    /// How the standard deviations in sigma_T are normalised. Default `HalfRange`, which comes closest to the transient in the
    /// paper's fig. 4.
    pub normalisation: Normalisation,
    /// What is squared and summed. Default [`Residual::Corrected`]. With [`Residual::Algebraic`] the paper is followed as
    /// written: a window is fitted however far its samples lie from one ellipsoid.
    pub residual: Residual,
    /// White noise, uT per axis, 0 to 1000, that a fit is judged by at the least, as [`FitOptions::noise_floor_ut`]. Default 5.
    pub noise_floor_ut: f64,
}

impl Default for WindowedConfig {
    fn default() -> Self {
        Self {
            n_min: 100,
            n_max: 2000,
            sigma_th: 0.1,
            normalisation: Normalisation::HalfRange,
            residual: Residual::Corrected,
            noise_floor_ut: FitOptions::default().noise_floor_ut,
        }
    }
}

impl WindowedConfig {
    /// What a fit of a stream accepts.
    pub(super) fn fit_options(&self, field_strength_ut: Option<f64>) -> FitOptions {
        let usual = FitOptions::default();
        let is_algebraic = self.residual == Residual::Algebraic;
        let max_residual_share = if is_algebraic { f64::INFINITY } else { usual.max_residual_share };
        FitOptions {
            residual: self.residual,
            field_strength_ut,
            noise_floor_ut: self.noise_floor_ut,
            max_residual_share,
            tolerance: TOLERANCE,
            ..usual
        }
    }
}
