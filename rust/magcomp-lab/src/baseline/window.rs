//! Fits over the latest N samples, made anew every so often: the sphere, the linear ellipsoid, the smallest ellipsoid
//! around them.

use super::method::Baseline;
use super::{algebraic, enclosing};
use magcomp::nalgebra::{Matrix3, Vector3};
use magcomp::{Calibration, MagneticSample};
use std::collections::VecDeque;

/// Samples before the first fit.
const FEWEST: usize = 50;
/// Samples from one fit to the next.
const STRIDE: usize = 20;

/// Which surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Surface {
    /// |h - b| = r by linear least squares.
    Sphere,
    /// A quadric with trace A = 3 by linear least squares.
    Linear,
    /// The ellipsoid of least volume around the samples.
    Enclosing,
}

/// A surface through the latest N samples.
#[derive(Clone, Debug)]
pub struct Windowed {
    surface: Surface,
    length: usize,
    samples: VecDeque<Vector3<f64>>,
    count: usize,
    calibration: Option<Calibration>,
}

impl Windowed {
    /// Over `length` samples.
    pub fn new(surface: Surface, length: usize) -> Self {
        Self { surface, length, samples: VecDeque::with_capacity(length), count: 0, calibration: None }
    }
}

impl Baseline for Windowed {
    fn push(&mut self, sample: &MagneticSample) {
        if self.samples.len() == self.length {
            self.samples.pop_front();
        }
        self.samples.push_back(sample.field_ut);
        self.count += 1;
        if self.samples.len() < FEWEST || !self.count.is_multiple_of(STRIDE) {
            return;
        }
        let points: Vec<_> = self.samples.iter().copied().collect();
        let found = match self.surface {
            Surface::Sphere => algebraic::sphere(&points),
            Surface::Linear => algebraic::ellipsoid(&points),
            Surface::Enclosing => enclosing::ellipsoid(&points),
        };
        self.calibration = found.and_then(|(a, b)| calibration_of(&a, b)).or(self.calibration);
    }

    fn correct(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>> {
        self.calibration.map(|calibration| calibration.correct(raw_ut))
    }

    fn calibration(&self) -> Option<Calibration> {
        self.calibration
    }
}

/// The calibration of (h - b)^T A (h - b) = 1: M = A^(-1/2) / |h|, det M = 1.
pub(super) fn calibration_of(a: &Matrix3<f64>, b: Vector3<f64>) -> Option<Calibration> {
    let eigen = a.symmetric_eigen();
    if eigen.eigenvalues.min() <= 0.0 {
        return None;
    }
    let axes = eigen.eigenvalues.map(|value| value.sqrt().recip());
    let strength = axes.product().cbrt();
    let m = eigen.eigenvectors * Matrix3::from_diagonal(&(axes / strength)) * eigen.eigenvectors.transpose();
    Calibration::new((m + m.transpose()) * 0.5, b, strength).ok()
}
