//! A rate of beta in the samples of one segment: |T (u - beta - r t)| = 1, t the time from the middle of them.
//!
//! To first order in r the residual is d.p + t l.(J_b r), d the ten monomials, l = [x, y, z, 1] the last four of them, J_b the
//! columns of dp/dtau that belong to beta (rows of l only). Sums of d l^T weighted with time do for r what S does for tau, and
//! noise adds to them what it adds to S, so that L has no bias here either:
//!     C = p^T S p + 2 p^T O v + v^T W v,     O = mean of t d l^T,   W = mean of t^2 l l^T,   v = J_b r
//!     D = p^T N p + 2 p^T O' v + v^T W' v,   O' = mean of t ((grad d)(grad l)^T + c l^T),   W' = mean of t^2 (grad l)(grad l)^T
//! with c half the Laplacian of d. tau and r are fitted together as tau alone is in `hypothesis`.

use super::hypothesis::{PARTS, SHORTER, SOFTENING, is_linear};
use super::likelihood::{Likelihood, form};
use super::parameters::{Jacobian, Matrix9, Matrix10, Vector9, Vector10, is_bounded, jacobian, quadric};
use super::rate::{Course, RATE_VARIANCE_UT};
use crate::ellipsoid::ldl::Ldl;
use crate::snapshot::{LARGEST_COUNT, checked};
use nalgebra::{Matrix4, SMatrix, SVector, Vector3, Vector4};
use serde::{Deserialize, Serialize};

type Matrix10x4 = SMatrix<f64, 10, 4>;
pub(super) type Vector12 = SVector<f64, 12>;
pub(super) type Matrix12 = SMatrix<f64, 12, 12>;

const ITERATIONS: usize = 3;
const DAMPINGS: usize = 3;
const FIRST_DAMPING: f64 = 1e-6;

/// Sums since a segment began, weighted with the number of the sample.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Timed {
    count: f64,
    sum: Matrix10x4,
    once: Matrix10x4,
    twice: Matrix4<f64>,
}

checked!(Timed, |it| (0.0..=LARGEST_COUNT as f64).contains(&it.count));

impl Timed {
    pub fn new() -> Self {
        Self { count: 0.0, sum: Matrix10x4::zeros(), once: Matrix10x4::zeros(), twice: Matrix4::zeros() }
    }

    pub fn count(&self) -> usize {
        self.count as usize
    }

    /// The next sample, units about the centre.
    pub fn add(&mut self, u: &Vector3<f64>) {
        let (x, y, z) = (u.x, u.y, u.z);
        let d = Vector10::from([x * x, y * y, z * z, 2.0 * x * y, 2.0 * x * z, 2.0 * y * z, x, y, z, 1.0]);
        let l = Vector4::new(x, y, z, 1.0);
        let product = d * l.transpose();
        self.sum += product;
        self.once += product * self.count;
        self.twice += l * (l * (self.count * self.count)).transpose();
        self.count += 1.0;
    }

    /// The samples before the latest.
    pub fn without(&self, latest: &Self) -> Self {
        let count = self.count - latest.count;
        // the first of the latest has the number `count` here
        let once = latest.once + latest.sum * count;
        let twice = latest.twice
            + latest.once.fixed_rows::<4>(6) * (2.0 * count)
            + latest.sum.fixed_rows::<4>(6) * (count * count);
        Self { count, sum: self.sum - latest.sum, once: self.once - once, twice: self.twice - twice }
    }

    /// O and W for samples `period_s` apart.
    pub fn means(&self, period_s: f64) -> (Matrix10x4, Matrix4<f64>) {
        let middle = 0.5 * (self.count - 1.0);
        let once = self.once - self.sum * middle;
        let twice = self.twice - self.once.fixed_rows::<4>(6) * (2.0 * middle)
            + self.sum.fixed_rows::<4>(6) * (middle * middle);
        (once * (period_s / self.count), twice * (period_s * period_s / self.count))
    }
}

/// F of tau and r (units per second).
pub(super) struct Line<'a> {
    likelihood: &'a Likelihood,
    /// O and O', W and W'.
    once: [Matrix10x4; 2],
    twice: [Matrix4<f64>; 2],
    information: Matrix12,
    mean: Vector12,
}

impl<'a> Line<'a> {
    /// `prior` of tau: Lambda and tau_0.
    pub fn new(
        likelihood: &'a Likelihood,
        timed: &Timed,
        period_s: f64,
        prior: (&Matrix9, &Vector9),
        unit_ut: f64,
    ) -> Self {
        let (once, twice) = timed.means(period_s);
        let of_one = once.fixed_view::<1, 3>(9, 0) * 2.0;
        let (x, y, z) = (of_one[0], of_one[1], of_one[2]);
        let gradients = [x, y, z, y, x, z, x, z, y];
        let places = [(0, 0), (1, 1), (2, 2), (3, 0), (3, 1), (4, 0), (4, 2), (5, 1), (5, 2)];
        let mut of_noise = Matrix10x4::zeros();
        places.into_iter().zip(gradients).for_each(|(place, value)| of_noise[place] = value);
        (0..3).for_each(|i| (0..4).for_each(|k| of_noise[(i, k)] += once[(9, k)]));
        let square = twice[(3, 3)];
        let mut information = Matrix12::identity() * (unit_ut * unit_ut / RATE_VARIANCE_UT);
        information.fixed_view_mut::<9, 9>(0, 0).copy_from(prior.0);
        let mut mean = Vector12::zeros();
        mean.fixed_rows_mut::<9>(0).copy_from(prior.1);
        Self {
            likelihood,
            once: [once, of_noise],
            twice: [twice, Matrix4::from_diagonal(&Vector4::new(square, square, square, 0.0))],
            information,
            mean,
        }
    }

    /// p, dp/dtau, v, C and D.
    fn point(&self, at: &Vector12) -> (Vector10, Jacobian, Vector4<f64>, [f64; 2]) {
        let tau = at.fixed_rows::<9>(0).into_owned();
        let (p, j) = (quadric(&tau), jacobian(&tau));
        let v = j.fixed_view::<4, 3>(6, 6) * at.fixed_rows::<3>(9);
        let of =
            |q: &Matrix10, k: usize| p.dot(&(q * p)) + 2.0 * p.dot(&(self.once[k] * v)) + v.dot(&(self.twice[k] * v));
        (p, j, v, [of(&self.likelihood.s, 0), of(&self.likelihood.n, 1)])
    }

    /// L, and F.
    fn total(&self, at: &Vector12) -> Option<[f64; 2]> {
        if !is_bounded(&at.fixed_rows::<9>(0).into_owned()) {
            return None;
        }
        let (_, _, _, [c, d]) = self.point(at);
        let (off, cost) = (at - self.mean, self.likelihood.weight * c / d);
        (d > 1e-6 && cost.is_finite()).then(|| [cost, cost + off.dot(&(self.information * off))])
    }

    /// Half the gradient of L, and the Gauss-Newton Hessian.
    fn derivatives(&self, at: &Vector12) -> (Vector12, Matrix12) {
        let (p, j, v, [c, d]) = self.point(at);
        let of = |q: &Matrix10, k: usize| (q * p + self.once[k] * v, self.once[k].tr_mul(&p) + self.twice[k] * v);
        let ((s, timed), (n, timed_n)) = (of(&self.likelihood.s, 0), of(&self.likelihood.n, 1));
        let jb = j.fixed_view::<4, 3>(6, 6);
        let mut gradient = Vector12::zeros();
        gradient.fixed_rows_mut::<9>(0).copy_from(&j.tr_mul(&(s - n * (c / d))));
        gradient.fixed_rows_mut::<3>(9).copy_from(&jb.tr_mul(&(timed - timed_n * (c / d))));
        let scale = self.likelihood.weight / d;
        (gradient * scale, self.square(&j, 0) * scale)
    }

    /// J^T S J (0) or J^T N J (1) of tau and r.
    fn square(&self, j: &Jacobian, k: usize) -> Matrix12 {
        let jb = j.fixed_view::<4, 3>(6, 6).into_owned();
        let q = if k == 0 { &self.likelihood.s } else { &self.likelihood.n };
        let beside = j.tr_mul(&(self.once[k] * jb));
        let mut square = Matrix12::zeros();
        square.fixed_view_mut::<9, 9>(0, 0).copy_from(&form(j, q, 1.0));
        square.fixed_view_mut::<9, 3>(0, 9).copy_from(&beside);
        square.fixed_view_mut::<3, 9>(9, 0).copy_from(&beside.transpose());
        square.fixed_view_mut::<3, 3>(9, 9).copy_from(&jb.tr_mul(&(self.twice[k] * jb)));
        square
    }

    /// The same, and the curvature.
    fn expansion(&self, at: &Vector12) -> (Vector12, Matrix12, Matrix12) {
        let (gradient, raw) = self.derivatives(at);
        let (_, j, _, [_, d]) = self.point(at);
        let noise = self.square(&j, 1) * (self.likelihood.weight / d * self.likelihood.variance);
        (gradient, raw, raw - noise)
    }

    /// From tau without a rate towards the minimum of F, by Levenberg-Marquardt.
    fn descend(&self, tau: &Vector9) -> Option<Vector12> {
        let mut at = Vector12::zeros();
        at.fixed_rows_mut::<9>(0).copy_from(tau);
        let [_, mut cost] = self.total(&at)?;
        let mut damping = FIRST_DAMPING;
        for _ in 0..ITERATIONS {
            let (gradient, raw) = self.derivatives(&at);
            let gradient = gradient + self.information * (at - self.mean);
            for _ in 0..DAMPINGS {
                let mut damped = raw + self.information;
                (0..12).for_each(|i| damped[(i, i)] *= 1.0 + damping);
                let next = Ldl::new(&damped).map(|factors| at - factors.solve(&gradient));
                if let Some(next) = next
                    && let Some([_, lower]) = self.total(&next)
                    && lower <= cost
                {
                    (at, cost) = (next, lower);
                    damping = (damping * 0.1).max(FIRST_DAMPING);
                    break;
                }
                damping = (damping * 30.0).max(1e-3);
            }
        }
        Some(at)
    }

    /// tau, r and their covariance.
    pub fn fit(&self, tau: &Vector9) -> Option<Course> {
        let at = self.descend(tau)?;
        let (gradient, raw, curvature) = self.expansion(&at);
        let weights = Ldl::new(&(raw + self.information * SOFTENING))?;
        let (information, score) = weights.weigh(&curvature, &gradient);
        let factors = Ldl::new(&(information + self.information))?;
        let towards = -factors.solve(&(score + self.information * (at - self.mean)));
        let [here, _] = self.total(&at)?;
        let linear = |step: &Vector12| {
            let rise = 2.0 * gradient.dot(step) + step.dot(&(curvature * step));
            self.total(&(at + step)).is_some_and(|[higher, _]| is_linear(higher - here, rise))
        };
        let step = (0..PARTS).map(|k| towards * SHORTER.powi(k)).find(linear).unwrap_or_else(Vector12::zeros);
        Course::of(&(at + step), &factors.inverse())
    }
}
