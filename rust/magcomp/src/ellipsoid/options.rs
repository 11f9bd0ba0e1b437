//! What a fit accepts, and why it refuses.

use crate::calibration::EARTH_FIELD_UT;
use crate::priors::OF_USE_DEG;

/// Mathematics: nine parameters need nine samples.
pub const SMALLEST_SAMPLE_COUNT: usize = 9;

/// What is squared and summed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Residual {
    /// Eq. (10) as written. Biased in scale by about 3 nu^2 (nu: noise over field strength), and in everything when the
    /// sphere is only partly covered.
    Algebraic,
    /// Divided by its own gradient: a distance in raw units, free of the noise bias. The default.
    #[default]
    Corrected,
}

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

/// Why there is no ellipsoid to report.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum FitError {
    /// Fewer samples than parameters.
    #[error("{have} samples are too few for an ellipsoid: {SMALLEST_SAMPLE_COUNT} are needed, more are better")]
    TooFewSamples {
        /// How many there are.
        have: usize,
    },
    /// All samples lie near one plane, as they do when the device turns about a single axis or not at all.
    #[error("samples lie within {thickness_ut:.2} uT of one plane; turn the device about a second axis")]
    Planar {
        /// Standard deviation of the samples across their thinnest direction, uT.
        thickness_ut: f64,
    },
    /// The directions do not determine the ellipsoid well enough.
    #[error(
        "predicted direction error {direction_sigma_deg:.1} deg exceeds {limit_deg:.1} deg; turn the device to more directions"
    )]
    PoorCoverage {
        /// Predicted rms direction error, degrees.
        direction_sigma_deg: f64,
        /// The limit it exceeds, degrees.
        limit_deg: f64,
    },
    /// The samples do not lie on one ellipsoid.
    #[error(
        "samples lie {residual_ut:.1} uT off the best ellipsoid, more than {limit_ut:.1} uT; the disturbance or the place changed meanwhile"
    )]
    Inconsistent {
        /// Residual rms, uT.
        residual_ut: f64,
        /// The limit it exceeds, uT.
        limit_ut: f64,
    },
    /// The best quadric is not an ellipsoid.
    #[error(
        "samples are fitted best by a surface that is no ellipsoid; the disturbance changed meanwhile, or too few directions were seen"
    )]
    NotAnEllipsoid,
    /// The field is too weak or too strong to be the Earth's.
    #[error(
        "field strength {field_ut:.1} uT is outside {low_ut:.1} to {high_ut:.1} uT; the place is disturbed or the sensor's unit is not microtesla"
    )]
    FieldOutOfRange {
        /// Strength found, uT: the geometric mean of the half axes, or |m| with the gyroscope.
        field_ut: f64,
        /// Smallest accepted, uT.
        low_ut: f64,
        /// Largest accepted, uT.
        high_ut: f64,
    },
    /// A sample was NaN or infinite, or the numbers overflowed.
    #[error("a sample is not finite; leave out NaN and infinite values")]
    NotFinite,
}
