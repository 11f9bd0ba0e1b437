//! What an estimator says of one sample, before a heading is formed from it.

use crate::reading::{Event, ModelOrder, SensorMode, Status};
use nalgebra::{Matrix3, Vector3};

/// What an estimator says of one sample.
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
    pub status: Status,
}

impl Answer {
    /// An answer that says nothing but its status.
    pub fn none(mode: SensorMode, status: Status) -> Self {
        Self {
            field_ut: None,
            field_covariance_ut2: None,
            filtered_field_ut: None,
            filtered_covariance_ut2: None,
            up: None,
            tilt_rad2: None,
            sigma_t: None,
            direction_sigma_deg: None,
            worst_sigma_deg: None,
            model_order: None,
            mode,
            event: None,
            status,
        }
    }
}
