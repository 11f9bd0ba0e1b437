//! The cost of (9) and (10) in closed form, and its minimum (`math/descend`).
//!
//! (9) (u - beta)^T A (u - beta) - 1 = z.p with p = [A11, A22, A33, A12, A13, A23, -2 a, a.beta - 1], a = A beta, and
//! A = T^2, T = M^-1 in units of the field. Two residuals, both in closed form for the unknowns y = (A, a):
//!     Algebraic, (10) as written:              cost(y) = p^T S p / n
//!     Corrected, divided by its own gradient:  cost / slope, slope = p^T B p / n    (the mean square of distances in raw units:
//!         E[S] = S0 + nu^2 B for noise nu, see `moments`, so the noise does not move its minimum up to nu^4)
//! Jacobian J = dp/dy = diag(1 1 1 1 1 1 -2 -2 -2) and a last row r = [-beta_i^2, -2 beta_i beta_j, 2 beta].
//! With Q = S or S - (cost/slope) B the half gradient is J^T Q p and the Hessian J^T Q J (exact at the minimum of the second,
//! Gauss-Newton for the first). An iteration costs the same for 100 samples as for 2000. Source: docs/dev/METHOD-PAPER.md.

#[cfg(test)]
mod tests;

use super::options::FitOptions;
use super::start::{Shape, closed_form};
use crate::config::Residual;
use crate::math::descend::{Cost, Derivatives, Descent, Limits, Step, descend};
use crate::math::symmetric::{PLACES, six};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

type Matrix9 = SMatrix<f64, 9, 9>;
type Vector9 = SVector<f64, 9>;
type Matrix10 = SMatrix<f64, 10, 10>;
type Vector10 = SVector<f64, 10>;

/// Mathematics: a step may be tried down to where it changes nothing any more in 16 digits.
const MOST_DAMPINGS: usize = 16;

/// Mathematics: the diagonal part of J.
const DIAGONAL: Vector9 =
    Vector9::from_array_storage(nalgebra::ArrayStorage([[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -2.0, -2.0, -2.0]]));

/// The cost of one window: moments and which residual.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    /// S / n and B / n of the moments.
    pub s: Matrix10,
    pub b: Matrix10,
    pub residual: Residual,
}

/// An ellipsoid, with its cost.
#[derive(Clone, Debug)]
pub(super) struct Candidate {
    pub shape: Shape,
    /// The centre.
    pub beta: Vector3<f64>,
    p: Vector10,
    /// p^T S p / n and p^T B p / n.
    cost: f64,
    slope: f64,
    /// Of the two residuals the one that is squared and summed.
    value: f64,
}

/// A minimum of the problem.
pub(super) type Solution = Descent<Candidate>;

impl Problem {
    /// The minimum, from `warm` where that has the lower cost, else from the closed form.
    ///
    /// Close to it steps shrink by a factor rho from one to the next, and what is left after a step of this size is
    /// rho * size: when that is below the tolerance, another iteration would change nothing.
    pub fn solve(&self, warm: Option<Shape>, options: &FitOptions) -> Option<Solution> {
        let starts = [warm, closed_form(&self.s)].into_iter().flatten().filter_map(|shape| self.at(shape));
        let start = starts.min_by(|one, other| one.value.total_cmp(&other.value))?;
        let limits = Limits { iterations: options.max_iterations.max(1), dampings: MOST_DAMPINGS };
        let mut previous_size: Option<f64> = None;
        let is_last = |step: &Step| {
            let shrinks = previous_size.filter(|_| step.damping == 0.0);
            let rho = shrinks.map_or(1.0, |previous| (step.size / previous).min(1.0));
            previous_size = Some(step.size);
            step.size * rho <= options.tolerance
        };
        Some(descend(self, start, limits, is_last))
    }

    /// J^T (S - nu^2 B) J / slope with nu^2 = cost / slope: the information of one sample about y, times nu^2, the noise's own
    /// share taken off. Lower triangle.
    pub fn information(&self, at: &Candidate) -> Matrix9 {
        at.hessian(&(self.s - self.b * at.distance_squared())) / at.slope
    }

    /// None where the shape is no ellipsoid.
    fn at(&self, shape: Shape) -> Option<Candidate> {
        let beta = shape.centre()?;
        let p = shape.unknowns().component_mul(&DIAGONAL).push(shape.offset.dot(&beta) - 1.0);
        let cost = (self.s * p).dot(&p).max(0.0);
        let slope = (self.b * p).dot(&p);
        let value = match self.residual {
            Residual::Algebraic => cost,
            Residual::Corrected => cost / slope,
        };
        (slope > 0.0 && value.is_finite()).then_some(Candidate { shape, beta, p, cost, slope, value })
    }
}

impl Cost<9> for Problem {
    type Place = Candidate;

    fn value(&self, at: &Candidate) -> f64 {
        at.value
    }

    fn derivatives(&self, at: &Candidate) -> Derivatives<9> {
        match self.residual {
            Residual::Algebraic => {
                Derivatives { gradient: at.gradient(&self.s), hessian: at.hessian(&self.s) + at.curvature(&self.s) }
            }
            Residual::Corrected => {
                let q = self.s - self.b * at.value;
                Derivatives { gradient: at.gradient(&q), hessian: at.hessian(&q) }
            }
        }
    }

    fn scale(&self, at: &Candidate, _hessian: &Matrix9) -> Vector9 {
        at.hessian(&self.s).diagonal()
    }

    fn after(&self, from: &Candidate, step: &Vector9) -> Option<Candidate> {
        self.at(Shape::of_unknowns(&(from.shape.unknowns() + step)))
    }
}

impl Candidate {
    /// cost / slope: mean squared distance from the ellipsoid, in scaled units.
    pub fn distance_squared(&self) -> f64 {
        (self.cost / self.slope).max(0.0)
    }

    /// Last row of J: d(a.beta - 1)/dy, with beta = A^-1 a.
    fn last_row(&self) -> Vector9 {
        let beta = &self.beta;
        let [xx, yy, zz, xy, xz, yz] = six(&(beta * beta.transpose())).data.0[0];
        let twice = beta * 2.0;
        Vector9::from([-xx, -yy, -zz, -2.0 * xy, -2.0 * xz, -2.0 * yz, twice.x, twice.y, twice.z])
    }

    /// J^T Q p: half the gradient of the cost (times the slope for the corrected one).
    fn gradient(&self, q: &Matrix10) -> Vector9 {
        let qp = q * self.p;
        let mut gradient = qp.fixed_rows::<9>(0).component_mul(&DIAGONAL) + self.last_row() * qp[9];
        gradient.apply(|v| *v = if v.is_finite() { *v } else { 0.0 });
        gradient
    }

    /// What J^T Q J leaves out of the Hessian: (Q p)_10 times the second derivative of a.A^-1 a - 1, 2 V^T A^-1 V with
    /// V = [-E_k beta, I]. Zero at the minimum of the corrected cost, where Q p = 0; without it the algebraic cost's
    /// iteration converges only linearly.
    fn curvature(&self, q: &Matrix10) -> Matrix9 {
        let beta = &self.beta;
        let mut v = SMatrix::<f64, 3, 9>::zeros();
        for (k, (i, j)) in PLACES.into_iter().enumerate() {
            v[(i, k)] = -beta[j];
            v[(j, k)] = -beta[i];
        }
        v.fixed_view_mut::<3, 3>(0, 6).fill_with_identity();
        let inverse = self.shape.a.try_inverse().unwrap_or_else(Matrix3::zeros);
        v.transpose() * inverse * v * (2.0 * q.row(9).transpose().dot(&self.p))
    }

    /// Lower triangle of J^T Q J.
    fn hessian(&self, q: &Matrix10) -> Matrix9 {
        let r = self.last_row();
        let edge = q.fixed_view::<9, 1>(0, 9).component_mul(&DIAGONAL);
        let half = edge + r * (0.5 * q[(9, 9)]);
        let mut hessian = Matrix9::zeros();
        for j in 0..9 {
            for i in j..9 {
                hessian[(i, j)] = q[(i, j)] * DIAGONAL[i] * DIAGONAL[j] + r[i] * half[j] + half[i] * r[j];
            }
        }
        hessian
    }
}
