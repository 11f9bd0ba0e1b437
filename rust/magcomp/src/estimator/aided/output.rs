//! What comes out: the corrected sample c, the carried field f, and how sure they are.
//!
//! ```text
//! c = W (raw - b) - tau (w x W (raw - b)),  W = M^-1     (brought to the gyroscope's time)
//! P_c = W [I D(h)] P_(b,e) [I D(h)]^T W^T + sigma^2 W W^T + (s_d^2 + floor^2) I + timing
//! f = m,  P_f = P_mm + floor^2 I + timing,   timing = s_clock^2 (w x h)(w x h)^T
//! ```
//! Heading sigma, up known: e = unit(up x h) the horizontal direction across the field, h_n its horizontal size:
//! ```text
//! sigma = atan(sqrt(e^T P e) / h_n)
//! ```
//! P alone is right about b, but cannot know that the field of a room is not uniform: hence the floors.
//! Source: docs/METHOD.md.

use crate::reading::{Event, SensorMode, Status};
use nalgebra::{Matrix3, SMatrix, Vector3};

/// One answer of the aided estimator.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct AidedOutput {
    /// Time of the sample, ns.
    pub time_ns: i64,
    /// c: the corrected sample at the gyroscope's time, uT; `None` while collecting.
    pub corrected_ut: Option<Vector3<f64>>,
    /// Covariance of c, uT^2.
    pub corrected_covariance_ut2: Matrix3<f64>,
    /// f: the carried field, uT; `None` while collecting and without a gyroscope.
    pub filtered_ut: Option<Vector3<f64>>,
    /// Covariance of f, uT^2.
    pub filtered_covariance_ut2: Matrix3<f64>,
    /// Unit vector, what an accelerometer at rest reads; `None` without accelerometer.
    pub up: Option<Vector3<f64>>,
    /// One sigma of the heading of c, degrees; at most 180.
    pub corrected_heading_sigma_deg: Option<f64>,
    /// One sigma of the heading of f, degrees; at most 180. This is the published heading's.
    pub filtered_heading_sigma_deg: Option<f64>,
    /// Status.
    pub status: Status,
    /// The last event, kept until the next.
    pub event: Option<Event>,
    /// Sensors in use.
    pub mode: SensorMode,
}

/// sigma = atan(sqrt(e^T P e) / h_n), degrees; 180 where the field has no horizontal part to speak of.
pub(crate) fn heading_sigma_deg(field: &Vector3<f64>, covariance: &Matrix3<f64>, up: &Vector3<f64>) -> f64 {
    let across = up.cross(field);
    let horizontal = across.norm();
    if horizontal < 1e-6 {
        return 180.0;
    }
    let e = across / horizontal;
    let sd = e.dot(&(covariance * e)).max(0.0).sqrt();
    // beyond the linear range the arc tangent stops at 90; a field lost in its sigma knows nothing
    if sd > 2.0 * horizontal { 180.0 } else { (sd / horizontal).atan().to_degrees() }
}

/// W [I D(h)] P [I D(h)]^T W^T for the 9x9 covariance of (b, e).
pub(crate) fn calibration_covariance(p: &SMatrix<f64, 9, 9>, w: &Matrix3<f64>, h: &Vector3<f64>) -> Matrix3<f64> {
    let rows = super::state::iron_rows(h);
    let mut g = SMatrix::<f64, 3, 9>::zeros();
    for i in 0..3 {
        g[(i, i)] = 1.0;
        for k in 0..6 {
            g[(i, 3 + k)] = rows[i][k];
        }
    }
    let g = w * g;
    g * p * g.transpose()
}
