//! The likelihood of a set of samples, from their moments alone, in constant time:
//!     L(tau) = w C / D,   C = p^T S p,  D = p^T N p  (means over the samples),   w = n / (kappa v)
//! twice the negative logarithm, up to a constant, for white noise of variance v of which kappa samples are worth one. C / D
//! is the mean square of the residual over its own gradient: a distance, free of the noise's bias (`ellipsoid/fit`).
//! N = G + (d c^T + c d^T), G from the gradients alone (Taubin 1991). N is not positive well inside the ellipsoid, so that D is
//! at least half of p^T G p.
//! Half gradient w/D J^T (S - C/D N) p; Gauss-Newton Hessian w/D J^T S J.

use super::parameters::{Jacobian, Matrix10, Tau, TauMatrix, Vector10, is_bounded, jacobian, quadric};
use crate::ellipsoid::Moments;
use crate::math::ldl::{add, times};
use nalgebra::Vector3;

/// Smallest D: a tau whose quadric is flat at the samples is none of theirs.
const LEAST_GRADIENT: f64 = 1e-6;

/// L of a set of samples.
#[derive(Clone, Debug)]
pub(super) struct Likelihood {
    s: Matrix10,
    n: Matrix10,
    gradients: Matrix10,
    weight: f64,
    /// Variance of what was added, units^2: means of neighbours have less than samples.
    variance: f64,
    centre: Vector3<f64>,
}

/// L at one tau.
#[derive(Clone, Copy, Debug)]
pub(super) struct Point {
    /// L.
    pub cost: f64,
    distance_squared: f64,
    d: f64,
    sp: Vector10,
    np: Vector10,
}

/// L to second order at one tau.
pub(super) struct Expansion {
    /// Half the gradient.
    pub gradient: Tau,
    /// Half the Gauss-Newton Hessian.
    pub hessian: TauMatrix,
    /// The share of it that noise makes: poor coverage must not be taken for knowledge.
    pub noise: TauMatrix,
}

impl Likelihood {
    /// Of samples about `centre` (units), with noise of `white` (units^2) a sample and `variance` as they were added, of which
    /// `kappa` are worth one.
    pub fn new(moments: &Moments, centre: Vector3<f64>, white: f64, variance: f64, kappa: f64) -> Self {
        let (s, n) = moments.scatter();
        let mut gradients = n;
        let d = s.column(9).into_owned();
        for i in 0..3 {
            for j in 0..10 {
                gradients[(i, j)] -= d[j];
                gradients[(j, i)] -= d[j];
            }
        }
        Self { s, n, gradients, weight: moments.count() as f64 / (kappa * white), variance, centre }
    }

    fn local(&self, tau: &Tau) -> Tau {
        let mut local = *tau;
        (0..3).for_each(|i| local[6 + i] -= self.centre[i]);
        local
    }

    /// None where tau is no ellipsoid near the samples.
    pub fn at(&self, tau: &Tau) -> Option<Point> {
        if !is_bounded(tau) {
            return None;
        }
        let p = quadric(&self.local(tau));
        let (sp, mut np) = (times(&self.s, &p), times(&self.n, &p));
        let mut d = p.dot(&np);
        let least = times(&self.gradients, &p) * 0.5;
        if d < p.dot(&least) {
            (d, np) = (p.dot(&least), least);
        }
        let distance_squared = p.dot(&sp).max(0.0) / d;
        let cost = self.weight * distance_squared;
        (d > LEAST_GRADIENT && cost.is_finite()).then_some(Point { cost, distance_squared, d, sp, np })
    }

    /// Half the gradient of L, and half the Gauss-Newton Hessian.
    pub fn derivatives(&self, tau: &Tau, point: &Point) -> (Tau, TauMatrix) {
        let j = jacobian(&self.local(tau));
        (self.gradient(&j, point), form(&j, &self.s, self.weight / point.d))
    }

    /// L to second order.
    pub fn expansion(&self, tau: &Tau, point: &Point) -> Expansion {
        let j = jacobian(&self.local(tau));
        let scale = self.weight / point.d;
        Expansion {
            gradient: self.gradient(&j, point),
            hessian: form(&j, &self.s, scale),
            noise: form(&j, &self.gradients, scale * self.variance),
        }
    }

    fn gradient(&self, j: &Jacobian, point: &Point) -> Tau {
        j.tr_mul(&(point.sp - point.np * point.distance_squared)) * (self.weight / point.d)
    }
}

/// J^T Q J times `scale`, Q symmetric. Columns of J for beta are zero in the first six rows.
fn form(j: &Jacobian, q: &Matrix10, scale: f64) -> TauMatrix {
    let (j, q) = (&j.data.0, &q.data.0);
    let mut out = TauMatrix::zeros();
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
