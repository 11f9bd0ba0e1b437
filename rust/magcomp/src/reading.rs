//! What one `push` answers: the corrected sample, the heading, and in `status` what the compensator is doing.

use crate::attitude::Attitude;
use crate::heading::Heading;
pub(crate) use crate::status::{
    Axis, EventKind, HeadingAid, HoldReason, Missing, ModelOrder, RejectReason, SensorMode, Status,
};
use nalgebra::Vector3;

/// The answer to one magnetometer sample. What is not known is None, never NaN.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct Reading {
    /// Time of the sample, nanoseconds.
    pub time_ns: i64,
    /// The corrected sample M^-1 (h_m - b), uT, device frame. None until there is a calibration, and for a rejected sample.
    pub field_ut: Option<Vector3<f64>>,
    /// The estimator's own, smoother estimate of the same vector, uT, where it has one; the heading comes from it.
    pub filtered_field_ut: Option<Vector3<f64>>,
    /// One standard deviation of `field_ut` per axis, uT. None without `field_ut` or a known covariance.
    pub field_sigma_ut: Option<f64>,
    /// |field_ut|, uT.
    pub total_field_ut: Option<f64>,
    /// Heading and inclination. None without a calibration, without a recent `up`, or where the axis is vertical.
    pub heading: Option<Heading>,
    /// How the device lies in the world, from the vector that the heading comes from. None without a calibration, without a recent
    /// `up`, or where the field is vertical.
    pub attitude: Option<Attitude>,
    /// (15) sigma_T over the latest N_min samples; the aided and the adaptive method form it anew once a second. None until there are
    /// that many and a calibration.
    pub sigma_t: Option<f64>,
    /// Samples that the estimator looks at: the paper's window; of the adaptive method those since the latest change; the aided
    /// method has no window, and counts directions over the latest N_max.
    pub window: usize,
    /// Share of the directions seen in that window, 0 to 1.
    pub coverage: f64,
    /// Predicted rms error of a corrected direction by the parameters in force, over all directions, degrees, above 0 and up to 180; the
    /// aided and the adaptive method form it anew once a second. None without a calibration or a known covariance.
    pub direction_sigma_deg: Option<f64>,
    /// The same for the one combination of parameters that is known worst: the root of the inverse of the information
    /// matrix's smallest eigenvalue, as an angle, degrees. Large where the directions seen leave something open, also
    /// where sigma_T does not show it. Adaptive method only.
    pub worst_sigma_deg: Option<f64>,
    /// Which parameters the latest change set free. Adaptive method only.
    pub model_order: Option<ModelOrder>,
    /// The sensors the estimator runs on.
    pub mode: SensorMode,
    /// The latest change that was decided, kept until the next. None before the first.
    pub event: Option<Event>,
    /// What the compensator is doing, and why.
    pub status: Status,
}

/// A change that was decided. Its text is one sentence an app may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{kind} in {:.1} s", (*.decided_ns as f64 - *.since_ns as f64) * 1e-9)]
#[derive(serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct Event {
    /// What changed.
    pub kind: EventKind,
    /// Time of the first sample that no longer fitted, nanoseconds.
    pub since_ns: i64,
    /// Time of the decision, nanoseconds.
    pub decided_ns: i64,
}
