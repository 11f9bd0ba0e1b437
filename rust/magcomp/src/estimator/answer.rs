//! What an estimator says of a sample.

use crate::reading::{Event, ModelOrder, SensorMode};
use nalgebra::{Matrix3, Vector3};

/// What an estimator says of one sample, before a heading is formed from it.
#[derive(Default)]
pub(crate) struct Answer {
    pub field_ut: Option<Vector3<f64>>,
    pub field_covariance_ut2: Option<Matrix3<f64>>,
    pub filtered_field_ut: Option<Vector3<f64>>,
    pub filtered_covariance_ut2: Option<Matrix3<f64>>,
    pub up: Option<Vector3<f64>>,
    /// Variance of `up` about a horizontal axis for the motion it was averaged over, rad^2; `None`: it is the accelerometer's.
    pub tilt_rad2: Option<f64>,
    pub sigma_t: Option<f64>,
    pub direction_sigma_deg: Option<f64>,
    pub worst_sigma_deg: Option<f64>,
    pub model_order: Option<ModelOrder>,
    pub mode: SensorMode,
    pub event: Option<Event>,
}
