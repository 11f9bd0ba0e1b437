//! What a fit accepts.

use crate::calibration::EARTH_FIELD_UT;
use crate::config::Residual;
use crate::priors::OF_USE_DEG;

/// Mathematics: nine parameters need nine samples.
pub const SMALLEST_SAMPLE_COUNT: usize = 9;

/// What a fit accepts and how it iterates.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct FitOptions {
    /// What is squared and summed. Default [`Residual::Corrected`].
    pub residual: Residual,
    /// |h| in uT, 1 to 1000, where it is known (the paper sets it to 1; a world magnetic model gives it): then M carries the
    /// sensor's scale. None (the default): |h| is the geometric mean of the half axes, so det M = 1.
    pub field_strength_ut: Option<f64>,
    /// Half axes' geometric mean that is accepted, uT, within 1 to 1000. Default 22 to 67: what the Earth's field spans.
    pub field_range_ut: (f64, f64),
    /// Largest rms direction error, degrees, 0.001 to 180, that is accepted, as predicted from the coverage for the residual found or
    /// `noise_floor_ut`, whichever is larger. Default 10; larger accepts poorer coverage.
    pub max_direction_sigma_deg: f64,
    /// White noise, uT per axis, 0 to 1000, that the direction error is predicted for at the least. Default 5: rooms bend the
    /// field by 1 to 2 uT over half a second, some 20 samples, which does as much harm. Smaller accepts poorer coverage where the
    /// residual is small; 0 trusts the residual alone, for simulated data.
    pub noise_floor_ut: f64,
    /// Largest residual rms that is accepted, as a share of the field strength, 0.0001 to 1000. Default 0.05: 30 dB of noise is 0.032, rooms
    /// stay below 0.04; a window across a change of the disturbance lies above. Larger accepts more noise.
    pub max_residual_share: f64,
    /// Iterations at the most, 1 to 1000. Default 50; warm or closed-form starts take 2 to 6.
    pub max_iterations: usize,
    /// The iteration has converged when no parameter would change by more than this (field strengths), 1e-16 to 0.1. Default
    /// 1e-10.
    pub tolerance: f64,
}

impl Default for FitOptions {
    fn default() -> Self {
        Self {
            residual: Residual::Corrected,
            field_strength_ut: None,
            field_range_ut: EARTH_FIELD_UT,
            max_direction_sigma_deg: OF_USE_DEG,
            noise_floor_ut: 5.0,
            max_residual_share: 0.05,
            max_iterations: 50,
            tolerance: 1e-10,
        }
    }
}
