//! The level frame that a vector and the vertical make: east, north and up, device frame, and how well the vector tells where they are.
//!
//! ```text
//! E = h x U / |h x U|,   N = U x E,   H = |h x U|,   V = h . U                                  H^2 + V^2 = |h|^2
//! variance of a turn about U:   (E^T P E (1 + 3 N^T P N / H^2) + V^2 (s_tilt^2 - 2 C)) / H^2       P: covariance of h
//! ```
//! C: covariance of the turns about a horizontal axis by which h and U are off: where one gyroscope carries both, what it gets wrong turns both alike.
//! `E[(y/x)^2] = var y / x^2 (1 + 3 var x / x^2 + ...)`: a horizontal part whose length is not known turns by more.

use crate::math::elementary::{atan2, hypot};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

/// Mathematics: what has a smaller sine to the vertical has no heading, for rounding: 1e-6 is 0.2 arc seconds.
pub(crate) const VERTICAL: f64 = 1e-6;

/// How well `up` is known.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tilt {
    /// Standard deviation about a horizontal axis.
    pub sigma_deg: f64,
    /// C, rad^2.
    pub common_rad2: f64,
}

impl Tilt {
    pub fn variance_rad2(&self) -> f64 {
        self.sigma_deg.to_radians().powi(2)
    }
}

/// The axes have length 1.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Level {
    pub east: Vector3<f64>,
    pub north: Vector3<f64>,
    pub up: Vector3<f64>,
    /// H and V, in the vector's unit.
    pub horizontal: f64,
    pub vertical: f64,
}

impl Level {
    /// North is where the horizontal part of `towards` points, for an `up` of any length. `None` where it has none, or anything is not finite.
    pub fn of(towards: &Vector3<f64>, up: &Vector3<f64>) -> Option<Self> {
        let up = up.try_normalize(0.0)?;
        let across = towards.cross(&up);
        let (horizontal, vertical) = (across.norm(), towards.dot(&up));
        let is_level = horizontal > VERTICAL * hypot(horizontal, vertical) && horizontal.is_finite();
        is_level.then(|| {
            // across once more, because rounding is large where the vector is almost vertical
            let north = up.cross(&(across / horizontal));
            Self { east: north.cross(&up), north, up, horizontal, vertical }
        })
    }

    /// Variance of the turn about `up` by which the vector is off, for its covariance, the variance of `up` about a horizontal axis, and C, rad^2.
    pub fn variance_rad2(&self, covariance: &Matrix3<f64>, tilt_rad2: f64, common_rad2: f64) -> f64 {
        self.variance_of(self.across_rad2(covariance), tilt_rad2, common_rad2)
    }

    /// The same of the part that is the vector's own.
    pub fn variance_of(&self, across_rad2: f64, tilt_rad2: f64, common_rad2: f64) -> f64 {
        let own_rad2 = tilt_rad2 - 2.0 * common_rad2;
        (across_rad2 + own_rad2 * (self.vertical / self.horizontal).powi(2)).max(0.0)
    }

    /// The part of it that is the vector's own.
    pub fn across_rad2(&self, covariance: &Matrix3<f64>) -> f64 {
        let variance = |d: &Vector3<f64>| (covariance * d).dot(d) / (self.horizontal * self.horizontal);
        variance(&self.east) * (1.0 + 3.0 * variance(&self.north).max(0.0))
    }

    /// East and north part of an axis.
    pub fn parts(&self, axis: &Vector3<f64>) -> (f64, f64) {
        (axis.dot(&self.east), axis.dot(&self.north))
    }

    /// Clockwise from north, rad; `None` for an axis whose horizontal part is at most so much of it.
    pub fn bearing(&self, axis: &Vector3<f64>, least_horizontal: f64) -> Option<f64> {
        let (east, north) = self.parts(axis);
        (hypot(east, north) > least_horizontal * axis.norm()).then(|| atan2(east, north))
    }
}
