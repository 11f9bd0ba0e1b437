//! Levenberg-Marquardt on the cost of (9) and (10), in closed form.
//!
//! (9) (u - beta)^T A (u - beta) - 1 = d.p with p = [A11, A22, A33, A12, A13, A23, -2 g, g.beta - 1], g = A beta, and
//! A = T^2, T = M^-1 in units of the field. Two residuals, both costs in closed form:
//!     Algebraic, (10) as written:              C(theta) = p^T S p / n
//!     Corrected, divided by its own gradient:  C / D, D = p^T N p / n    (the mean square of distances in raw units:
//!         E[S] = S0 + s^2 N for noise s, see `moments`, so the noise does not move its minimum up to s^4)
//! Jacobian J = dp/dtheta = diag(1 1 1 1 1 1 -2 -2 -2) and a last row r = [-beta_i^2, -2 beta_i beta_j, 2 beta].
//! With Q = S or S - (C/D) N the half gradient is J^T Q p and the Hessian J^T Q J (exact at the minimum of the second,
//! Gauss-Newton for the first). An iteration costs the same for 100 samples as for 2000.

use super::ldl;
use super::options::{FitOptions, Residual};
use super::start::{Shape, closed_form};
use super::symmetric::{PLACES, six};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

type Matrix9 = SMatrix<f64, 9, 9>;
type Vector9 = SVector<f64, 9>;
type Matrix10 = SMatrix<f64, 10, 10>;
type Vector10 = SVector<f64, 10>;

/// Why the iteration stopped. Each is an answer; `Stalled` and `MaxIterations` say how good.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum Termination {
    /// The last step was below the tolerance.
    Converged,
    /// No step lowers the cost any more: rounding decides.
    Stalled,
    /// The number of iterations ran out first.
    MaxIterations,
}

/// The cost of one window: moments and which residual.
#[derive(Clone, Debug)]
pub(super) struct Problem {
    /// S / n and N / n of the moments.
    pub s: Matrix10,
    pub n: Matrix10,
    pub residual: Residual,
}

/// The problem at one ellipsoid.
#[derive(Clone, Debug)]
struct Point {
    shape: Shape,
    beta: Vector3<f64>,
    p: Vector10,
    /// p^T S p / n and p^T N p / n.
    c: f64,
    d: f64,
    cost: f64,
}

/// A minimum of the problem.
#[derive(Clone, Debug)]
pub(super) struct Solution {
    point: Point,
    pub iterations: usize,
    pub termination: Termination,
}

impl Solution {
    /// C / D: mean squared distance from the ellipsoid, in scaled units.
    pub fn distance_squared(&self) -> f64 {
        (self.point.c / self.point.d).max(0.0)
    }

    /// The ellipsoid found: (A, its centre beta), scaled units.
    pub fn ellipsoid(&self) -> (&Matrix3<f64>, &Vector3<f64>) {
        (&self.point.shape.a, &self.point.beta)
    }
}

impl Problem {
    /// The minimum, from `warm` where that has the lower cost, else from the closed form.
    pub fn solve(&self, warm: Option<Shape>, options: &FitOptions) -> Option<Solution> {
        let starts = [warm, closed_form(&self.s)].into_iter().flatten().filter_map(|shape| self.at(shape));
        Some(self.minimise(starts.min_by(|a, b| a.cost.total_cmp(&b.cost))?, options))
    }

    /// J^T (S - s^2 N) J / D with s^2 = C / D: the information of one sample about theta, times s^2, the noise's own
    /// share taken off. Lower triangle.
    pub fn information(&self, solution: &Solution) -> Matrix9 {
        solution.point.hessian(&(self.s - self.n * solution.distance_squared())) / solution.point.d
    }

    /// None where the shape is no ellipsoid.
    fn at(&self, shape: Shape) -> Option<Point> {
        let beta = shape.centre()?;
        let p = shape.theta().component_mul(&DIAGONAL).push(shape.g.dot(&beta) - 1.0);
        let c = (self.s * p).dot(&p).max(0.0);
        let d = (self.n * p).dot(&p);
        let cost = match self.residual {
            Residual::Algebraic => c,
            Residual::Corrected => c / d,
        };
        (d > 0.0 && cost.is_finite()).then_some(Point { shape, beta, p, c, d, cost })
    }

    /// Levenberg-Marquardt: Hessian + mu diag(J^T S J), mu from 0 upwards only when a step does not lower the cost.
    ///
    /// Close to the minimum steps shrink by a factor rho from one to the next, and what is left after a step of this
    /// size is rho * size: when that is below the tolerance, another iteration would change nothing.
    fn minimise(&self, start: Point, options: &FitOptions) -> Solution {
        let mut point = start;
        let mut damping = 0.0;
        let mut previous_size: Option<f64> = None;
        for iteration in 1..=options.max_iterations.max(1) {
            let q = match self.residual {
                Residual::Algebraic => self.s,
                Residual::Corrected => self.s - self.n * point.cost,
            };
            let gradient = point.gradient(&q);
            let mut hessian = point.hessian(&q);
            if self.residual == Residual::Algebraic {
                hessian += point.curvature(&q);
            }
            let theta = point.shape.theta();
            let mut taken = None;
            for _ in 0..MAX_DAMPINGS {
                let mut damped = hessian;
                if damping > 0.0 {
                    let diagonal = point.hessian(&self.s).diagonal();
                    (0..9).for_each(|i| damped[(i, i)] += damping * diagonal[i]);
                }
                let step = ldl::solve(&damped, &-gradient);
                let next = step.and_then(|step| Some((step.amax(), self.at(Shape::from_theta(&(theta + step)))?)));
                if let Some((size, next)) = next
                    && (next.cost <= point.cost || (damping == 0.0 && next.cost <= point.cost * (1.0 + ROUNDING)))
                {
                    point = next;
                    taken = Some(size);
                    break;
                }
                damping = if damping == 0.0 { FIRST_DAMPING } else { damping * 10.0 };
            }
            let Some(size) = taken else {
                return Solution { point, iterations: iteration, termination: Termination::Stalled };
            };
            let rho = previous_size.filter(|_| damping == 0.0).map_or(1.0, |previous| (size / previous).min(1.0));
            if size * rho <= options.tolerance {
                return Solution { point, iterations: iteration, termination: Termination::Converged };
            }
            previous_size = Some(size);
            damping = if damping > FIRST_DAMPING { damping * 0.1 } else { 0.0 };
        }
        Solution { point, iterations: options.max_iterations, termination: Termination::MaxIterations }
    }
}

/// A Newton step that raises the cost by no more than its rounding (relative) is taken: closer to the minimum than
/// the root of this the cost says nothing any more, the gradient still does.
const ROUNDING: f64 = 1e-11;
/// Damping of the first step after one that did not lower the cost.
const FIRST_DAMPING: f64 = 1e-4;
/// Factors of 10 in the damping before an iteration gives up.
const MAX_DAMPINGS: usize = 16;

impl Point {
    /// Last row of J: d(g.beta - 1)/d theta, with beta = A^-1 g.
    fn last_row(&self) -> Vector9 {
        let b = &self.beta;
        let [xx, yy, zz, xy, xz, yz] = six(&(b * b.transpose())).data.0[0];
        let b = b * 2.0;
        Vector9::from([-xx, -yy, -zz, -2.0 * xy, -2.0 * xz, -2.0 * yz, b.x, b.y, b.z])
    }

    /// J^T Q p: half the gradient of the cost (times D for the corrected one).
    fn gradient(&self, q: &Matrix10) -> Vector9 {
        let qp = q * self.p;
        let mut gradient = qp.fixed_rows::<9>(0).component_mul(&DIAGONAL) + self.last_row() * qp[9];
        gradient.apply(|v| *v = if v.is_finite() { *v } else { 0.0 });
        gradient
    }

    /// What J^T Q J leaves out of the Hessian: (Q p)_10 times the second derivative of g.A^-1 g - 1, 2 V^T A^-1 V with
    /// V = [-E_k beta, I]. Zero at the minimum of the corrected cost, where Q p = 0; without it the algebraic cost's
    /// iteration converges only linearly.
    fn curvature(&self, q: &Matrix10) -> Matrix9 {
        let b = &self.beta;
        let mut v = SMatrix::<f64, 3, 9>::zeros();
        for (k, (i, j)) in PLACES.into_iter().enumerate() {
            v[(i, k)] = -b[j];
            v[(j, k)] = -b[i];
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

/// Diagonal part of J.
const DIAGONAL: Vector9 =
    Vector9::from_array_storage(nalgebra::ArrayStorage([[1.0, 1.0, 1.0, 1.0, 1.0, 1.0, -2.0, -2.0, -2.0]]));
