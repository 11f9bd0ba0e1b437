//! A constant angle between the headings of a source and those of the magnetometer: how a phone lies in its holder, or the declination.
//!
//! The magnetometer's own error stays the same while the device points the same way. So one difference counts for each part of a circle.

use super::carried::wrap;
use crate::priors::{BEYOND_CHANCE, OF_USE_DEG};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

/// The magnetometer's error is another where the device points elsewhere by this, deg: a disturbance that goes with the vehicle has one or two periods in a
/// circle.
const APART_DEG: f64 = 3.0 * OF_USE_DEG;

/// The angle and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Offset {
    /// Of this axis of the device.
    pub axis: Vector3<f64>,
    pub angle_rad: f64,
    pub variance_rad2: f64,
    /// Where the device pointed when it was last learned, rad.
    at_rad: f64,
}

impl Offset {
    /// Nothing is known but its size.
    pub fn unknown(sd_rad: f64, axis: Vector3<f64>) -> Self {
        Self { axis, angle_rad: 0.0, variance_rad2: sd_rad * sd_rad, at_rad: f64::INFINITY }
    }

    /// A heading less the magnetometer's, where the device points to `at_rad`. One that is far off is no error: the device was moved, or the source
    /// is wrong.
    pub fn learn(&mut self, difference_rad: f64, at_rad: f64, variance_rad2: f64) {
        let off_rad = wrap(difference_rad - self.angle_rad);
        let is_elsewhere = !self.at_rad.is_finite() || wrap(at_rad - self.at_rad).abs() > APART_DEG.to_radians();
        if is_elsewhere && off_rad * off_rad < BEYOND_CHANCE.powi(2) * (self.variance_rad2 + variance_rad2) {
            let gain = self.variance_rad2 / (self.variance_rad2 + variance_rad2);
            self.angle_rad = wrap(self.angle_rad + gain * off_rad);
            self.variance_rad2 *= 1.0 - gain;
            self.at_rad = at_rad;
        }
    }

    /// It is another by `off_rad` since, where the device points to `at_rad`.
    pub fn begin_at(&mut self, off_rad: f64, at_rad: f64, variance_rad2: f64) {
        *self = Self { angle_rad: wrap(self.angle_rad + off_rad), variance_rad2, at_rad, ..*self };
    }
}
