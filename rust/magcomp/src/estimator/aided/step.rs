//! One sample with a rotation, as the parts of the estimator share it.

use nalgebra::Vector3;

use super::propagate::ProcessNoise;

/// A sample, the turn before it, and what is known of noise and motion then.
pub(crate) struct Step<'a> {
    pub(crate) time_ns: i64,
    pub(crate) raw_ut: &'a Vector3<f64>,
    pub(crate) rate_rad_s: &'a Vector3<f64>,
    pub(crate) increment_rad: &'a Vector3<f64>,
    pub(crate) angle_rad: f64,
    pub(crate) dt_s: f64,
    pub(crate) noise: &'a ProcessNoise,
    pub(crate) sigma_ut: f64,
    pub(crate) resting: bool,
    pub(crate) motion: f64,
}
