//! What the fits of the paper's method accept.

#[cfg(test)]
mod tests;

use crate::config::{Residual, WindowedConfig};
use crate::ellipsoid::FitOptions;

/// Choice: parameters converge to this, in field strengths, in two iterations from the fit before: a hundredth of what noise at 40 dB leaves in a window of
/// 2000 (tests/host/steps.rs).
const TOLERANCE: f64 = 1e-6;

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
