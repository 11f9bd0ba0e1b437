//! Gravity's constraint: the field's part along the vertical is the same wherever the device points,
//!     up.T (u - beta) - s = y.theta = 0,     theta = [T (6), g, s],  g = T (beta - centre),
//!     y = [x x', y y', z z', x y' + y x', x z' + z x', y z' + z y', -up, -1]    (up = (x, y, z), u - centre = (x', y', z')).
//! y.theta is linear in theta, so that sum y y^T (55 sums, exact) is all that the samples say:
//!     L_v(tau) = w theta^T Y theta,   w = n / (kappa v)
//! Derivatives: dg = dT (beta - centre) + T dbeta, all else is the identity.

#[cfg(test)]
mod tests;

use super::parameters::{COUNT, Tau, TauMatrix, centre, gradient, products, shape, ten};
use crate::ellipsoid::ExactSums;
use crate::math::ldl::{add, times};
use crate::math::symmetric::PLACES;
use nalgebra::{Matrix3, Vector3};

const SUMS: usize = COUNT * (COUNT + 1) / 2;
/// Row and column of each sum.
const PAIRS: [(usize, usize); SUMS] = {
    let mut pairs = [(0, 0); SUMS];
    let mut at = 1;
    while at < SUMS {
        let (i, j) = pairs[at - 1];
        pairs[at] = if j < i { (i, j + 1) } else { (i + 1, 0) };
        at += 1;
    }
    pairs
};

/// Exact sums of y y^T.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct VerticalMoments {
    count: usize,
    sums: ExactSums<SUMS>,
}

/// y of a sample about a centre.
fn row(u: &Vector3<f64>, up: &Vector3<f64>) -> Tau {
    ten(&products(up, u), &-up, -1.0)
}

/// theta of a tau about a centre.
fn linear(tau: &Tau, about: &Vector3<f64>) -> Tau {
    let g = shape(tau) * (centre(tau) - about);
    let mut theta = *tau;
    (0..3).for_each(|i| theta[6 + i] = g[i]);
    theta
}

/// A dtheta/dtau, in place: dg = dT off + T dbeta, off = beta - about, and all else is the identity.
fn times_jacobian(a: &mut TauMatrix, t: &Matrix3<f64>, off: &Vector3<f64>) {
    let g: [_; 3] = std::array::from_fn(|i| a.data.0[6 + i]);
    let columns = &mut a.data.0;
    for (k, (row, column)) in PLACES.into_iter().enumerate() {
        add(&mut columns[k], off[column], &g[row]);
        if row != column {
            add(&mut columns[k], off[row], &g[column]);
        }
    }
    for i in 0..3 {
        columns[6 + i] = [0.0; COUNT];
        (0..3).for_each(|j| add(&mut columns[6 + i], t[(j, i)], &g[j]));
    }
}

/// up.T (u - beta) - s of a sample and its derivative by tau.
pub(super) fn miss(tau: &Tau, u: &Vector3<f64>, up: &Vector3<f64>) -> (f64, Tau) {
    let offset = u - centre(tau);
    (up.dot(&(shape(tau) * offset)) - tau[9], gradient(tau, up, &offset, 1.0))
}

impl VerticalMoments {
    pub fn new() -> Self {
        Self { count: 0, sums: ExactSums::ZERO }
    }

    pub fn count(&self) -> f64 {
        self.count as f64
    }

    /// The mean of `count` neighbouring samples, as seen from the centre, and their mean vertical.
    pub fn add(&mut self, u: &Vector3<f64>, up: &Vector3<f64>, count: usize) {
        let y = row(u, up);
        self.count += count;
        self.sums.add_times(PAIRS.map(|(i, j)| y[i] * y[j]), count as i64);
    }

    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// The likelihood about the same centre, for a variance of one sample (units^2) of which kappa are worth one.
    pub fn likelihood(&self, about: &Vector3<f64>, variance: f64, kappa: f64) -> VerticalLikelihood {
        let mut y = TauMatrix::zeros();
        for ((i, j), sum) in PAIRS.into_iter().zip(self.sums.values()) {
            (y[(i, j)], y[(j, i)]) = (sum, sum);
        }
        VerticalLikelihood { y: y / (variance * kappa), about: *about }
    }
}

/// L_v.
#[derive(Clone, Debug)]
pub(super) struct VerticalLikelihood {
    y: TauMatrix,
    about: Vector3<f64>,
}

impl VerticalLikelihood {
    pub fn cost(&self, tau: &Tau) -> f64 {
        let theta = linear(tau, &self.about);
        theta.dot(&times(&self.y, &theta)).max(0.0)
    }

    /// Half the gradient and half the Gauss-Newton Hessian.
    pub fn derivatives(&self, tau: &Tau) -> (Tau, TauMatrix) {
        let (t, off) = (shape(tau), centre(tau) - self.about);
        let mut product = self.y;
        times_jacobian(&mut product, &t, &off);
        let gradient = product.tr_mul(&linear(tau, &self.about));
        let mut hessian = product.transpose();
        times_jacobian(&mut hessian, &t, &off);
        (gradient, hessian)
    }
}
