//! What an estimator says of a sample. `figures` adds the figures of merit; where headings come from outside, `north` turns f and says so in `north`; the
//! compensator then adds heading and attitude.

use crate::calibration::{Calibration, Given, independent};
use crate::priors::{DAYS_UT, IRON_PER_UT, SETTLED_S};
use crate::reading::{Event, ModelOrder, SensorMode};
use crate::sample::seconds;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// A change of the device that moves b by less is no event, uT: from day to day b moves as far.
pub(crate) const LEAST_TOLD_UT: f64 = 2.0 * DAYS_UT;

/// The latest change of the device that was told, or that went on with one: its first onset, when its latest part was decided, and how far b moved then, in
/// the estimator's units.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Told {
    pub since_ns: i64,
    pub decided_ns: i64,
    pub moved: Vector3<f64>,
}

impl Told {
    /// Whether a change from `onset_ns` on, by which b moved so, goes on with this one: a magnet that slides on is one change, told once.
    pub fn goes_on(&self, onset_ns: i64, moved: &Vector3<f64>) -> bool {
        seconds(self.decided_ns, onset_ns) < SETTLED_S && self.moved.dot(moved) >= 0.0
    }
}

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
    /// Covariance of the turns about a horizontal axis by which `up` and the carried field are off, rad^2.
    pub common_rad2: f64,
    pub sigma_t: Option<f64>,
    pub direction_sigma_deg: Option<f64>,
    pub worst_sigma_deg: Option<f64>,
    pub model_order: Option<ModelOrder>,
    pub mode: SensorMode,
    pub event: Option<Event>,
    /// Samples that the estimator looks at.
    pub window: usize,
    /// How the gyroscope has turned the device since the sample before; `None` where that is not known.
    pub carry: Option<Carry>,
    /// North as headings from outside have it, where the field tells nothing of it.
    pub north: Option<KnownNorth>,
}

/// A turn, and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Carry {
    /// Takes a vector of the device frame at the sample before to that at this one.
    pub turn: Matrix3<f64>,
    /// Where up is, and its variance about a horizontal axis, rad^2.
    pub up: Option<Vector3<f64>>,
    pub tilt_rad2: f64,
    /// Variance of the gyroscope's bias about the worst axis, (rad/s)^2; whether it is what samples have told, and how long the turn took, s.
    pub bias_rad2_s2: f64,
    pub is_bias_told: bool,
    pub span_s: f64,
    /// Variance of what its noise adds, per axis, rad^2.
    pub noise_rad2: f64,
}

/// A horizontal direction of magnetic north, device frame, of length 1, with up.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct KnownNorth {
    pub north: Vector3<f64>,
    pub variance_rad2: f64,
    pub up: Vector3<f64>,
    pub tilt_rad2: f64,
}

/// Which samples the coverage counts, and through which calibration it sees them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Counted<'a> {
    /// They are seen through this, once there is one.
    pub through: Option<&'a Calibration>,
    /// Over so many of the latest samples.
    pub samples: usize,
}

/// A calibration, and its covariance where that is known.
pub(crate) struct Known {
    pub calibration: Option<Calibration>,
    pub covariance: Option<SMatrix<f64, 9, 9>>,
}

impl Known {
    /// As sure as the covariance says, or as usual.
    pub fn in_force(self) -> Option<Given> {
        let usual = || independent(DAYS_UT.powi(2), (IRON_PER_UT * DAYS_UT).powi(2));
        Some(Given { calibration: self.calibration?, covariance: self.covariance.unwrap_or_else(usual) })
    }
}

impl Answer {
    /// The same vectors in other axes.
    pub fn turn(&mut self, by: &Matrix3<f64>) {
        for vector in [&mut self.field_ut, &mut self.filtered_field_ut, &mut self.up].into_iter().flatten() {
            *vector = by * *vector;
        }
        if let Some(carry) = &mut self.carry {
            carry.turn = by * carry.turn * by.transpose();
            carry.up = carry.up.map(|up| by * up);
        }
    }

    /// Of an estimator that has no gyroscope: `up` is the accelerometer's.
    pub fn without_gyroscope(self, up: Option<Vector3<f64>>) -> Self {
        let mode = if up.is_some() { SensorMode::GravityOnly } else { SensorMode::MagnetometerOnly };
        Self { up, mode, ..self }
    }
}
