//! What a sample with a rotation brings, and what a frame of them brings.

#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

use super::propagate::ProcessNoise;
use super::state::{AXES, BIAS, Filter, Parts};

/// Data sheet: the interval of a phone's magnetometer at its fastest, s, that noise at rest and odds are told for: errors of others last longer than
/// theirs.
pub(super) const SAMPLE_S: f64 = 0.01;

/// What a sample brings: its field, the turn before it, and what is known of noise and motion then.
pub(crate) struct Step {
    pub(crate) time_ns: i64,
    pub(crate) raw_ut: Vector3<f64>,
    /// The sensor was at its full scale: `raw_ut` says nothing.
    pub(crate) is_blank: bool,
    pub(crate) rate_rad_s: Vector3<f64>,
    /// Mean reading of the gyroscope since the magnetometer's delay before the sample, rad/s.
    pub(crate) delayed_rad_s: Vector3<f64>,
    pub(crate) increment_rad: Vector3<f64>,
    /// Turns the field from the sample before to this one, with what is known of the gyroscope's errors.
    pub(crate) turn: Matrix3<f64>,
    pub(crate) dt_s: f64,
    pub(crate) noise: ProcessNoise,
    pub(crate) sigma_ut: f64,
    /// How long it has waited for the gyroscope, s.
    pub(crate) late_s: f64,
    /// Standard deviation of the gyroscope's bias about the worst axis before this sample, rad/s.
    pub(crate) bias_sd_rad_s: f64,
    pub(crate) resting: bool,
    /// Variance of the rate about the bias, (rad/s)^2, once the device has rested for long enough.
    pub(crate) bias_variance: Option<f64>,
    pub(crate) motion: f64,
}

/// What a frame brings: the means and sums of its samples, at the time of the last.
pub(crate) struct FrameStep {
    pub(crate) time_ns: i64,
    pub(crate) raw_ut: Vector3<f64>,
    /// None of its samples said anything of the field.
    pub(crate) is_blank: bool,
    pub(crate) rate_rad_s: Vector3<f64>,
    /// Mean reading of the gyroscope since the magnetometer's delay before the mean, rad/s.
    pub(crate) delayed_rad_s: Vector3<f64>,
    pub(crate) increment_rad: Vector3<f64>,
    /// Angle of the turn.
    pub(crate) angle_rad: f64,
    pub(crate) dt_s: f64,
    pub(crate) noise: ProcessNoise,
    /// Of its mean.
    pub(crate) sigma_ut: f64,
    /// Mean age of the samples, s.
    pub(crate) late_s: f64,
    pub(crate) resting: bool,
    /// Variance of the rate about the bias, (rad/s)^2, once the device has rested for long enough.
    pub(crate) bias_variance: Option<f64>,
    pub(crate) motion: f64,
}

/// What is known of calibration and gyroscope before a sample.
pub(crate) struct Known {
    pub(crate) x: Parts,
    /// Standard deviation of the bias about the worst axis, rad/s.
    pub(crate) bias_sd_rad_s: f64,
    /// Standard deviation of the scale of an axis: a misalignment turns `up` and the field alike.
    pub(crate) axes_sd: f64,
}

impl Known {
    pub(crate) fn of(filter: &Filter) -> Self {
        let axes = filter.variances(AXES);
        Self {
            x: filter.parts(),
            bias_sd_rad_s: filter.variances(BIAS).max().sqrt(),
            axes_sd: ((axes[0] + axes[4] + axes[8]) / 3.0).sqrt(),
        }
    }
}

#[cfg(test)]
mod tests;
