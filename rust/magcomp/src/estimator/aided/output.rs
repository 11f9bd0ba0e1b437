//! What comes out: the corrected sample c, the carried field f, and how sure they are.
//!
//! ```text
//! c = W (raw - b) - max(tau, 0) (w x W (raw - b)),  W = M^-1,   f = m + min(tau, 0) (w x m)
//! P_c = W [I D(h)] P_(b,e) [I D(h)]^T W^T + sigma^2 W W^T + (L^2 + floor^2) I + timing
//! P_f = P_mm + floor^2 I + axes^2 (|f|^2 I - f f^T) + timing + w s^2 I + w (1 - w) (h - m)(h - m)^T
//! timing = P_tau (w x h)(w x h)^T
//! ```
//! tau > 0: the magnetometer is late, and c is brought to the gyroscope's time; tau < 0: the gyroscope is, and f is brought
//! to the magnetometer's; neither is ever early. P alone is right about b, but cannot know that the field of a room is
//! not uniform: hence the floors. Nor can it know how far the frames of accelerometer and body are off the magnetometer's: hence `axes`.
//! L is the difference between c and f beyond white noise and the floor's slow part (`adapt`). w, h and s belong to a new
//! place (`earth`); elsewhere f is m.
//! Source: docs/METHOD-AIDED.md.

use crate::reading::{Event, SensorMode, Status};
use nalgebra::{Matrix3, SMatrix, Vector3};

/// One answer of the aided estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AidedOutput {
    /// Time of the sample, ns.
    pub time_ns: i64,
    /// c: the corrected sample at the time of the sensor that is less late, uT; `None` while collecting.
    pub corrected_ut: Option<Vector3<f64>>,
    /// Covariance of c, uT^2.
    pub corrected_covariance_ut2: Matrix3<f64>,
    /// f: the carried field, uT; `None` while collecting and without a gyroscope.
    pub filtered_ut: Option<Vector3<f64>>,
    /// Covariance of f, uT^2.
    pub filtered_covariance_ut2: Matrix3<f64>,
    /// Unit vector, what an accelerometer at rest reads; `None` without accelerometer.
    pub up: Option<Vector3<f64>>,
    /// Variance of `up` about a horizontal axis for the motion that the accelerometer feels, rad^2; `None` without gyroscope.
    pub tilt_rad2: Option<f64>,
    /// Status.
    pub status: Status,
    /// The last event, kept until the next.
    pub event: Option<Event>,
    /// Sensors in use.
    pub mode: SensorMode,
}

/// W [I D(h)] P [I D(h)]^T W^T for the 9x9 covariance of (b, e).
pub(crate) fn calibration_covariance(p: &SMatrix<f64, 9, 9>, w: &Matrix3<f64>, h: &Vector3<f64>) -> Matrix3<f64> {
    let d = super::state::iron_rows(h);
    let seen = p.fixed_columns::<3>(0) + p.fixed_columns::<6>(3) * d.transpose();
    w * (seen.fixed_rows::<3>(0) + d * seen.fixed_rows::<6>(3)) * w.transpose()
}
