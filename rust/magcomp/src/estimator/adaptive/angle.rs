//! Errors of parameters as errors of directions. An error dtau turns the corrected unit vector n by (1 - n n^T) G dtau / r,
//! G = d(T (u - beta))/dtau; over a set of directions its mean square is dtau^T W dtau, and its expectation tr(W P), with
//!     W = mean of G^T (1 - n n^T) G / r^2      (radians^2)

#[cfg(test)]
mod tests;

use super::parameters::{Gaussian, Tau, TauMatrix, centre, radius_gradient, see, shape, vector_gradient};
use crate::quadric::ldl::add;
use nalgebra::Vector3;

/// W over some directions.
#[derive(Clone, Debug)]
pub(super) struct AngularWeight {
    sum: TauMatrix,
    count: f64,
}

/// Mean square direction error all around, rad^2.
pub(super) fn expected(known: &Gaussian) -> f64 {
    AngularWeight::sphere(&known.mean).expected(&known.covariance)
}

/// Half of an icosahedron's corners: their mean is that of the sphere for everything even up to the fifth degree.
fn corners() -> [Vector3<f64>; 6] {
    let (a, b) = (0.525_731_112_119_133_6, 0.850_650_808_352_039_9);
    std::array::from_fn(|k| {
        let x = if k & 1 == 0 { a } else { -a };
        match k / 2 {
            0 => Vector3::new(x, b, 0.0),
            1 => Vector3::new(0.0, x, b),
            _ => Vector3::new(b, 0.0, x),
        }
    })
}

impl AngularWeight {
    pub fn new() -> Self {
        Self { sum: TauMatrix::zeros(), count: 0.0 }
    }

    /// Over the whole sphere.
    pub fn sphere(tau: &Tau) -> Self {
        let mut weight = Self::new();
        if let Some(inverse) = shape(tau).try_inverse() {
            for n in corners() {
                weight.add(tau, &(centre(tau) + inverse * n));
            }
            // opposite corners: what is odd, T with beta, cancels
            weight.sum.fixed_view_mut::<3, 6>(6, 0).fill(0.0);
            weight.sum.fixed_view_mut::<6, 3>(0, 6).fill(0.0);
        }
        weight
    }

    /// One more sample u whose direction counts.
    pub fn add(&mut self, tau: &Tau, u: &Vector3<f64>) {
        let Some(seen) = see(tau, u) else { return };
        let along = radius_gradient(tau, &seen);
        let g = vector_gradient(tau, &seen.offset).transpose();
        for axis in 0..3 {
            let across = (g.column(axis) - along * seen.direction[axis]) / seen.radius;
            for (sum, factor) in self.sum.data.0.iter_mut().zip(&across) {
                add(sum, *factor, &across.data.0[0]);
            }
        }
        self.count += 1.0;
    }

    /// Expected mean square of the angle, radians^2.
    pub fn expected(&self, covariance: &TauMatrix) -> f64 {
        self.sum.dot(covariance).max(0.0) / self.count.max(1.0)
    }
}
