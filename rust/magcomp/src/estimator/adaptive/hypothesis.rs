//! A hypothesis: what was known of tau before the samples of the segment, a Gaussian N(tau_0, Lambda^-1), and the maximum a
//! posteriori estimate it leads to.
//!     F(tau) = L(tau) + (tau - tau_0)^T Lambda (tau - tau_0)      minimised by Levenberg-Marquardt
//!     P = (H + Lambda)^-1,                                        H the information of the samples
//!     log evidence = -F/2 + (log det Lambda - log det (H + Lambda)) / 2 + log prior    (Laplace)

use super::likelihood::{Likelihood, Point};
use super::parameters::{Matrix9, Vector9, is_bounded};
use crate::ellipsoid::ldl;
use crate::reading::ModelOrder;
use nalgebra::Vector3;
use serde::{Deserialize, Serialize};

/// A Gaussian over tau.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Gaussian {
    pub mean: Vector9,
    pub covariance: Matrix9,
}

/// A prior and what the samples of the segment make of it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Hypothesis {
    /// What the hypothesis lets change.
    pub order: ModelOrder,
    prior_mean: Vector9,
    prior_information: Matrix9,
    log_prior: f64,
    log_det_prior: f64,
    /// The estimate and its covariance P.
    pub posterior: Gaussian,
    /// C / D there, units^2.
    pub distance_squared: f64,
    /// F there.
    pub cost: f64,
    /// Logarithm of the evidence, comparable between hypotheses on the same samples.
    pub log_evidence: f64,
    damping: f64,
}

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
const DAMPINGS: usize = 3;

impl Hypothesis {
    /// None when the prior is no Gaussian (numerically).
    pub fn new(order: ModelOrder, prior: &Gaussian, log_prior: f64) -> Option<Self> {
        let cholesky = prior.covariance.cholesky()?;
        let log_det_prior = -log_det(&cholesky.l());
        let information = cholesky.inverse();
        Some(Self {
            order,
            prior_mean: prior.mean,
            prior_information: (information + information.transpose()) * 0.5,
            log_prior,
            log_det_prior,
            posterior: *prior,
            distance_squared: 0.0,
            cost: NO_COST,
            log_evidence: log_prior,
            damping: FIRST_DAMPING,
        })
    }

    /// Lambda and tau_0.
    pub fn prior(&self) -> (&Matrix9, &Vector9) {
        (&self.prior_information, &self.prior_mean)
    }

    fn total(&self, likelihood: &Likelihood, tau: &Vector9) -> Option<(f64, Point)> {
        if !is_bounded(tau) {
            return None;
        }
        let point = likelihood.at(tau)?;
        let off = tau - self.prior_mean;
        Some((point.cost + off.dot(&(self.prior_information * off)), point))
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
    pub fn move_to(&mut self, tau: &Vector9) {
        self.posterior.mean = *tau;
        self.damping = FIRST_DAMPING;
        self.cost = NO_COST;
    }

    /// F on more samples, where it stands: keeps the evidence comparable between iterations.
    pub fn rescore(&mut self, likelihood: &Likelihood) {
        let before = self.cost;
        if let Some((cost, point)) = self.total(likelihood, &self.posterior.mean) {
            (self.cost, self.distance_squared) = (cost, point.distance_squared);
            if before < NO_COST {
                self.log_evidence -= 0.5 * (cost - before);
            }
        }
    }

    /// The coordinates move by `by`: beta with them.
    pub fn shift(&mut self, by: &Vector3<f64>) {
        self.posterior.shift(by);
        (0..3).for_each(|i| self.prior_mean[6 + i] += by[i]);
    }

    /// So many iterations, then the evidence, and the covariance where the evidence exceeds `worth`.
    pub fn refine(&mut self, likelihood: &Likelihood, iterations: usize, worth: f64) {
        let mut tau = self.posterior.mean;
        let Some((mut cost, mut point)) = self.total(likelihood, &tau) else {
            self.posterior.mean = self.prior_mean;
            self.log_evidence = NO_EVIDENCE;
            return;
        };
        for _ in 0..iterations {
            let (gradient, hessian) = likelihood.derivatives(&tau, &point);
            let gradient = gradient + self.prior_information * (tau - self.prior_mean);
            let hessian = hessian + self.prior_information;
            let mut taken = false;
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
            if !taken {
                break;
            }
        }
        self.damping = self.damping.min(1e3);
        self.posterior.mean = tau;
        self.cost = cost;
        self.distance_squared = point.distance_squared;
        let information = likelihood.information(&tau, &point) + self.prior_information;
        // poor coverage can leave the samples' own share of it indefinite: then they say nothing new
        let cholesky = information.cholesky().or_else(|| self.prior_information.cholesky());
        if let Some(cholesky) = cholesky {
            let volume: f64 = (0..9).map(|i| cholesky.l_dirty()[(i, i)].ln()).sum();
            self.log_evidence = self.log_prior - 0.5 * cost + 0.5 * self.log_det_prior - volume;
            if self.log_evidence > worth {
                let inverse = cholesky.inverse();
                self.posterior.covariance = (inverse + inverse.transpose()) * 0.5;
            }
        }
    }
}

/// log det of L L^T.
fn log_det(l: &Matrix9) -> f64 {
    2.0 * (0..9).map(|i| l[(i, i)].ln()).sum::<f64>()
}
