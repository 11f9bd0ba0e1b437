//! How far the samples spread, and how far only their noise does.
//!
//! A filter learns beta from derivatives of the frames that differ. Noise across the line of sight makes them differ where the device did not
//! turn, and the filter takes that for information. Where a device turns about one axis only, the samples lie in a plane, and all that the
//! filter has of beta across that plane may be made by noise. With weights w = 1/S of the frames and v the plane's normal:
//!     D = sum w (u - mean)(u - mean)^T,   N = sum w white,   share = N / v.D v:   of noise in the plane's thickness
//! What is known of v.beta is at most what was known before, the thickness without noise and its chance (n frames), and what two means tell
//! where what they depend on is known: that of the strength, along the mean direction, and that of the vertical part, along the vertical.
//!     1 / variance <= 1 / before + (1 - share (1 + 3 (2/n)^1/2))+ v.T D T v + (v.n)^2 / (strength + uneven) + (v.up)^2 / (vertical part + tilt)

#[cfg(test)]
mod tests;

use super::frame::Frame;
use crate::priors::BEYOND_CHANCE;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

/// See the module.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Spread {
    /// What is known before it begins: the covariance of beta, and the variances of the strength, relative, and of mu.
    beta: Matrix3<f64>,
    strength: f64,
    vertical: f64,
    frames: f64,
    weight: f64,
    sum: Vector3<f64>,
    square: Matrix3<f64>,
    noise: f64,
    direction: Vector3<f64>,
    up: Vector3<f64>,
    uneven: f64,
    tilt: f64,
}

impl Spread {
    pub fn new(beta: Matrix3<f64>, strength: f64, vertical: f64) -> Self {
        Self { beta, strength, vertical, ..Self::default() }
    }

    /// A frame seen in a direction; the variance of its innovation.
    pub fn add(&mut self, frame: &Frame, direction: &Vector3<f64>, s: f64) {
        let u = frame.u;
        self.frames += 1.0;
        self.weight += 1.0 / s;
        self.sum += u / s;
        self.square += u * u.transpose() / s;
        self.noise += frame.white / s;
        self.direction += direction;
        self.uneven = frame.uneven.variance;
        if let Some(up) = frame.up {
            self.up += up;
            self.tilt = frame.tilt.variance;
        }
    }

    /// Beta has moved by a variance `q` along each axis.
    pub fn walk(&mut self, q: f64) {
        self.beta += Matrix3::from_diagonal_element(q);
        let less = 1.0 / (1.0 + q * self.noise);
        self.weight *= less;
        self.sum *= less;
        self.square *= less;
        self.noise *= less;
    }

    /// The axis of beta of which noise tells most, and the least variance that can be known along it; t is T.
    pub fn least(&self, t: &Matrix3<f64>) -> Option<(Vector3<f64>, f64)> {
        if self.frames <= 3.0 {
            return None;
        }
        let differ = self.square - self.sum * self.sum.transpose() / self.weight;
        let eigen = differ.symmetric_eigen();
        let thinnest = eigen.eigenvalues.imin();
        let normal: Vector3<f64> = eigen.eigenvectors.column(thinnest).into();
        let thickness = eigen.eigenvalues[thinnest];
        let share = self.noise / thickness.max(f64::MIN_POSITIVE) * (1.0 + BEYOND_CHANCE * (2.0 / self.frames).sqrt());
        let along = (t * normal).norm_squared();
        let mean = |sum: &Vector3<f64>| (sum / self.frames).dot(&normal).powi(2);
        let known = 1.0 / normal.dot(&(self.beta * normal)).max(f64::MIN_POSITIVE)
            + (1.0 - share).max(0.0) * thickness * along
            + mean(&self.direction) * along / (self.strength + self.uneven)
            + mean(&self.up) * along / (self.vertical + self.tilt).max(f64::MIN_POSITIVE);
        Some((normal, 1.0 / known))
    }
}
