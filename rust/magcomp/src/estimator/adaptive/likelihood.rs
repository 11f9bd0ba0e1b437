//! The likelihood of a set of samples, from their moments alone, in constant time:
//!     L(tau) = w C / D,   C = p^T S p,  D = p^T N p  (means over the samples),   w = n / (kappa s^2)
//! twice the negative logarithm, up to a constant, for white noise of variance s^2 (kappa: see `noise`). C / D is the mean
//! square of the residual over its own gradient: a distance, free of the noise bias up to s^4 (`ellipsoid/fit`).
//! Half gradient w/D J^T (S - C/D N) p; Gauss-Newton Hessian w/D J^T S J; curvature w/D J^T (S - s^2 N) J, the noise's own
//! share taken off, so that poor coverage is not taken for knowledge.

use super::parameters::{Jacobian, Matrix9, Matrix10, Vector9, Vector10, jacobian, quadric};
use crate::ellipsoid::Moments;
use crate::ellipsoid::ldl::{add, times};

/// L of a set of samples.
#[derive(Clone, Debug)]
pub(super) struct Likelihood {
    pub s: Matrix10,
    pub n: Matrix10,
    pub weight: f64,
    /// Of the noise, units^2.
    pub variance: f64,
}

/// L at one tau.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// L.
    pub cost: f64,
    /// C / D, units^2.
    pub distance_squared: f64,
    d: f64,
    sp: Vector10,
    np: Vector10,
}

impl Likelihood {
    /// Of samples with noise of `variance` (units^2); `samples` of them count, n / kappa.
    pub fn new(moments: &Moments, variance: f64, samples: f64) -> Self {
        let (s, n) = moments.scatter();
        Self { s, n, weight: samples / variance, variance }
    }

    /// A quarter of the variance that the noise alone gives the difference of L between two tau: n (1 - rho^2), rho the
    /// correlation of their residuals, that of their gradients.
    pub fn disagreement(&self, a: &Vector9, b: &Vector9) -> f64 {
        let (a, b) = (quadric(a), quadric(b));
        let (na, nb) = (times(&self.n, &a), times(&self.n, &b));
        let agreement = a.dot(&nb).powi(2) / (a.dot(&na) * b.dot(&nb));
        self.weight * self.variance * (1.0 - agreement).clamp(0.0, 1.0)
    }

    /// None where tau is no ellipsoid near the samples.
    pub fn at(&self, tau: &Vector9) -> Option<Point> {
        let p = quadric(tau);
        let (sp, np) = (times(&self.s, &p), times(&self.n, &p));
        let d = p.dot(&np);
        let distance_squared = p.dot(&sp).max(0.0) / d;
        (d > 1e-6 && distance_squared.is_finite()).then_some(Point {
            cost: self.weight * distance_squared,
            distance_squared,
            d,
            sp,
            np,
        })
    }

    /// Half the gradient of L, and the Gauss-Newton Hessian.
    pub fn derivatives(&self, tau: &Vector9, point: &Point) -> (Vector9, Matrix9) {
        let j = jacobian(tau);
        let scale = self.weight / point.d;
        (self.gradient(&j, point, scale), form(&j, &self.s, scale))
    }

    /// The same, and the curvature.
    pub fn expansion(&self, tau: &Vector9, point: &Point) -> (Vector9, Matrix9, Matrix9) {
        let j = jacobian(tau);
        let scale = self.weight / point.d;
        let raw = form(&j, &self.s, scale);
        let curvature = raw - form(&j, &self.n, scale * self.variance);
        (self.gradient(&j, point, scale), raw, curvature)
    }

    fn gradient(&self, j: &Jacobian, point: &Point, scale: f64) -> Vector9 {
        j.tr_mul(&(point.sp - point.np * point.distance_squared)) * scale
    }

    /// Half the score of white noise of the known variance: w/D J^T (S - s^2 N) p; zero on average at the truth.
    pub fn score(&self, tau: &Vector9, point: &Point) -> Vector9 {
        jacobian(tau).tr_mul(&(point.sp - point.np * self.variance)) * (self.weight / point.d)
    }

    /// What these samples say about tau.
    pub fn information(&self, tau: &Vector9, point: &Point) -> Matrix9 {
        self.expansion(tau, point).2
    }
}

/// J^T Q J times `scale`, Q symmetric. Columns of J for beta are zero in the first six rows.
pub(super) fn form(j: &Jacobian, q: &Matrix10, scale: f64) -> Matrix9 {
    let (j, q) = (&j.data.0, &q.data.0);
    let mut out = Matrix9::zeros();
    for b in 0..6 {
        let mut column = [0.0; 10];
        for (factor, q) in j[b].iter().zip(q) {
            add(&mut column, *factor, q);
        }
        for a in 0..=b {
            out[(a, b)] = scale * (0..10).map(|i| j[a][i] * column[i]).sum::<f64>();
        }
        for a in 6..9 {
            out[(b, a)] = scale * (6..10).map(|i| j[a][i] * column[i]).sum::<f64>();
        }
    }
    for b in 6..9 {
        for a in 6..=b {
            let row = |i: usize| (6..10).map(|k| q[i][k] * j[b][k]).sum::<f64>();
            out[(a, b)] = scale * (6..10).map(|i| j[a][i] * row(i)).sum::<f64>();
        }
    }
    out.fill_lower_triangle_with_upper_triangle();
    out
}
