//! A hypothesis: what was known of tau before the samples of the segment, a Gaussian N(tau_0, Lambda^-1), and the estimate it
//! leads to. First towards the minimum of
//!     F(tau) = L(tau) + (tau - tau_0)^T Lambda (tau - tau_0)      by Levenberg-Marquardt
//! Noise alone moves it along what the motion does not see: half the score g of L has the variance R = w/D J^T S J, but the
//! curvature there is only H = w/D J^T (S - s^2 N) J. The score that counts is therefore H R^-1 g, its information
//! G = H R^-1 H (Godambe 1960), and from where F has led
//!     tau <- tau - (G + Lambda)^-1 (H R^-1 g + Lambda (tau - tau_0)),     P = (G + Lambda)^-1
//!     log evidence = -F/2 + (log det Lambda - log det (G + Lambda)) / 2 + log prior     (Laplace)
//! Where the samples say all, G = H = R.

use super::likelihood::{Likelihood, Point};
use super::parameters::{Matrix9, Seen, Vector9, is_bounded, radius_gradient, see};
use crate::ellipsoid::ldl::{self, Ldl, times};
use crate::reading::ModelOrder;
use crate::snapshot::{checked, is_covariance};
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A Gaussian over tau.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Gaussian {
    pub mean: Vector9,
    pub covariance: Matrix9,
}

checked!(Gaussian, |it| is_covariance(&it.covariance));

/// A prior and what the samples of the segment make of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Hypothesis {
    /// What the hypothesis lets change.
    pub order: ModelOrder,
    prior_mean: Vector9,
    prior_information: Matrix9,
    log_prior: f64,
    /// Its prior for what is told, over that for what is released.
    pub told: f64,
    log_det_prior: f64,
    /// (log det Lambda - log det (G + Lambda)) / 2.
    log_volume: f64,
    /// The estimate and its covariance P.
    pub posterior: Gaussian,
    /// C / D there, units^2.
    pub distance_squared: f64,
    /// L and F there.
    pub samples_cost: f64,
    pub cost: f64,
    /// Logarithm of the evidence, comparable between hypotheses on the same samples.
    pub log_evidence: f64,
    damping: f64,
}

checked!(Hypothesis, |it| {
    is_covariance(&it.prior_information)
        && it.damping > 0.0
        && [it.told, it.distance_squared, it.samples_cost, it.cost].iter().all(|v| *v >= 0.0)
});

impl Gaussian {
    /// The coordinates move by `by`: beta with them.
    pub fn shift(&mut self, by: &Vector3<f64>) {
        (0..3).for_each(|i| self.mean[6 + i] += by[i]);
    }
}

/// Not known yet, and nowhere near the samples: finite, since snapshots are JSON.
const NO_COST: f64 = f64::MAX;
pub(super) const NO_EVIDENCE: f64 = f64::MIN;
const FIRST_DAMPING: f64 = 1e-6;
const DAMPINGS: usize = 4;
/// Most of it that is kept for the next samples: they make another F.
const KEPT_DAMPING: f64 = 0.01;
/// A step that lowers F by less is the last.
const SETTLED: f64 = 1.0;
const ITERATIONS_ELSEWHERE: usize = 2;
/// Step of a finite difference, units.
const BESIDE: f64 = 1e-4;
/// Share of Lambda that is added to R, which few samples leave singular.
pub(super) const SOFTENING: f64 = 0.01;
/// The step from there is tried in so many sizes, each SHORTER than the one before, until L rises by no more than a half
/// over what its curvature predicts, and LEAST_RISE: beyond that it is not linear.
pub(super) const PARTS: i32 = 3;
pub(super) const SHORTER: f64 = 0.4;
const LEAST_RISE: f64 = 1.0;

/// Whether a step by which L rises so much where its curvature says `expected` is a linear one.
pub(super) fn is_linear(rise: f64, expected: f64) -> bool {
    rise < expected.max(0.0) * 1.5 + LEAST_RISE
}

impl Hypothesis {
    /// None when the prior is no Gaussian (numerically).
    pub fn new(order: ModelOrder, prior: &Gaussian, log_prior: f64) -> Option<Self> {
        let factors = Ldl::new(&prior.covariance)?;
        let log_det_prior = -factors.log_det;
        Some(Self {
            order,
            prior_mean: prior.mean,
            prior_information: factors.inverse(),
            log_prior,
            told: 1.0,
            log_det_prior,
            log_volume: 0.0,
            posterior: *prior,
            distance_squared: 0.0,
            samples_cost: 0.0,
            cost: NO_COST,
            log_evidence: log_prior,
            damping: FIRST_DAMPING,
        })
    }

    /// Lambda and tau_0.
    pub fn prior(&self) -> (&Matrix9, &Vector9) {
        (&self.prior_information, &self.prior_mean)
    }

    /// -log det Lambda: how much its prior leaves open.
    pub fn openness(&self) -> f64 {
        -self.log_det_prior
    }

    /// Whether it has seen the samples at all.
    pub fn is_fitted(&self) -> bool {
        self.cost < NO_COST
    }

    fn total(&self, likelihood: &Likelihood, tau: &Vector9) -> Option<(f64, Point)> {
        if !is_bounded(tau) {
            return None;
        }
        let point = likelihood.at(tau)?;
        let off = tau - self.prior_mean;
        Some((point.cost + off.dot(&times(&self.prior_information, &off)), point))
    }

    /// Moves to `start` where F is lower by more than `margin`.
    pub fn consider(&mut self, likelihood: &Likelihood, start: &Vector9, margin: f64) {
        let here = self.total(likelihood, &self.posterior.mean).map_or(f64::INFINITY, |(cost, _)| cost);
        if let Some((cost, _)) = self.total(likelihood, start)
            && cost < here - margin
        {
            self.posterior.mean = *start;
            self.damping = FIRST_DAMPING;
        }
    }

    /// Iterates from elsewhere.
    pub fn move_to(&mut self, likelihood: &Likelihood, tau: &Vector9) {
        self.posterior.mean = *tau;
        self.damping = FIRST_DAMPING;
        self.refine(likelihood, ITERATIONS_ELSEWHERE);
    }

    /// F on more samples, where it stands: keeps the evidence comparable between iterations.
    pub fn rescore(&mut self, likelihood: &Likelihood) {
        if let Some((cost, point)) = self.total(likelihood, &self.posterior.mean) {
            (self.cost, self.samples_cost, self.distance_squared) = (cost, point.cost, point.distance_squared);
            self.log_evidence = self.log_prior + self.log_volume - 0.5 * cost;
        }
    }

    /// Variance of the radius of a sample through the parameters; what the sample's own noise adds by turning the gradient
    /// is taken off.
    pub fn variance_at(&self, u: &Vector3<f64>, seen: &Seen, noise: f64) -> f64 {
        let (tau, p) = (&self.posterior.mean, &self.posterior.covariance);
        let g = radius_gradient(tau, seen);
        let mut turned = 0.0;
        for axis in 0..3 {
            if let Some(beside) = see(tau, &(u + Vector3::ith(axis, BESIDE))) {
                let d = (radius_gradient(tau, &beside) - g) / BESIDE;
                turned += d.dot(&(p * d));
            }
        }
        (g.dot(&(p * g)) - noise * turned).max(0.0)
    }

    /// The coordinates move by `by`: beta with them.
    pub fn shift(&mut self, by: &Vector3<f64>) {
        self.posterior.shift(by);
        (0..3).for_each(|i| self.prior_mean[6 + i] += by[i]);
    }

    /// At most so many iterations, then the estimate, its covariance and the evidence. Returns how many.
    pub fn refine(&mut self, likelihood: &Likelihood, iterations: usize) -> usize {
        let mut tau = self.posterior.mean;
        let Some((mut cost, mut point)) = self.total(likelihood, &tau) else {
            self.posterior.mean = self.prior_mean;
            self.log_evidence = NO_EVIDENCE;
            return 0;
        };
        let mut done = 0;
        while done < iterations {
            done += 1;
            let (gradient, hessian) = likelihood.derivatives(&tau, &point);
            let gradient = gradient + self.prior_information * (tau - self.prior_mean);
            let hessian = hessian + self.prior_information;
            let (before, mut taken) = (cost, false);
            for _ in 0..DAMPINGS {
                let mut damped = hessian;
                (0..9).for_each(|i| damped[(i, i)] *= 1.0 + self.damping);
                let next = ldl::solve(&damped, &-gradient).map(|step| tau + step);
                if let Some(next) = next
                    && let Some((lower, at)) = self.total(likelihood, &next)
                    && lower <= cost
                {
                    (tau, cost, point) = (next, lower, at);
                    self.damping = (self.damping * 0.1).max(FIRST_DAMPING);
                    taken = true;
                    break;
                }
                self.damping = (self.damping * 30.0).max(1e-3);
            }
            if !taken || before - cost < SETTLED {
                break;
            }
        }
        self.damping = self.damping.min(KEPT_DAMPING);
        self.settle(likelihood, &tau, cost, &point);
        done
    }

    /// From where F has led to the estimate: see the module.
    fn settle(&mut self, likelihood: &Likelihood, tau: &Vector9, cost: f64, point: &Point) {
        (self.posterior.mean, self.cost) = (*tau, cost);
        (self.samples_cost, self.distance_squared) = (point.cost, point.distance_squared);
        let (gradient, raw, curvature) = likelihood.expansion(tau, point);
        let Some(weights) = Ldl::new(&(raw + self.prior_information * SOFTENING)) else { return };
        let (information, score) = weights.weigh(&curvature, &gradient);
        let Some(factors) = Ldl::new(&(information + self.prior_information)) else { return };
        let towards = -factors.solve(&(score + self.prior_information * (tau - self.prior_mean)));
        let mut part = 1.0;
        for _ in 0..PARTS {
            let step = towards * part;
            let rise = 2.0 * gradient.dot(&step) + step.dot(&(curvature * step));
            if let Some((higher, at)) = self.total(likelihood, &(tau + step))
                && is_linear(at.cost - point.cost, rise)
            {
                (self.posterior.mean, self.cost) = (tau + step, higher);
                (self.samples_cost, self.distance_squared) = (at.cost, at.distance_squared);
                break;
            }
            part *= SHORTER;
        }
        self.log_volume = 0.5 * (self.log_det_prior - factors.log_det);
        self.log_evidence = self.log_prior + self.log_volume - 0.5 * self.cost;
        self.posterior.covariance = factors.inverse();
    }
}
