//! Slow change: a random walk of beta (and a hundredth of it of T) between blocks of samples.
//!
//! When a block has been absorbed, what is known is N(tau, P), P = (Lambda + H)^-1; before the next block it becomes
//! P + Q t. Which Q: for each of a ladder the block after it gives log evidence
//!     g^T (H + P_q^-1)^-1 g / 2 - log det (I + P_q H) / 2,     P_q = P + Q t, g and H of the block at tau,
//! added up with a memory of some blocks. The smallest is the rule, a larger one must earn its place.

use super::hypothesis::Gaussian;
use super::likelihood::Likelihood;
use super::parameters::Matrix9;
use crate::ellipsoid::ldl::Ldl;
use serde::{Deserialize, Serialize};

/// Random walks of b, uT per square root of a second: none to speak of, a warming phone, 0.1 uT/s, 0.5 uT/s.
const WALKS_UT: [f64; 4] = [0.003, 0.05, 0.2, 0.8];
/// That of T over that of beta.
const SHAPE_SHARE: f64 = 0.02;
/// What is kept of the evidence from one block to the next: a memory of ten.
const KEPT: f64 = 0.9;
/// Log evidence that a larger walk must have over the smallest.
const EARNED: f64 = 3.0;

/// Which random walk the samples speak for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Drift {
    evidence: [f64; 4],
    chosen: usize,
}

/// A walk of `sigma` units per square root of a second over `seconds`.
fn walked(known: &Matrix9, sigma: f64, seconds: f64) -> Matrix9 {
    let mut covariance = *known;
    let variance = sigma * sigma * seconds;
    for i in 0..6 {
        covariance[(i, i)] += variance * SHAPE_SHARE * SHAPE_SHARE;
    }
    for i in 6..9 {
        covariance[(i, i)] += variance;
    }
    covariance
}

impl Drift {
    /// Whether more than the smallest walk is on.
    pub fn is_on(&self) -> bool {
        self.chosen > 0
    }

    /// What is known after `seconds` more.
    pub fn walk(&self, known: &Gaussian, unit_ut: f64, seconds: f64) -> Gaussian {
        let covariance = walked(&known.covariance, WALKS_UT[self.chosen] / unit_ut, seconds);
        Gaussian { mean: known.mean, covariance }
    }

    /// A block of samples taken over `seconds`, after `known` (no walk added yet).
    pub fn learn(&mut self, known: &Gaussian, block: &Likelihood, unit_ut: f64, seconds: f64) {
        let Some(point) = block.at(&known.mean) else { return };
        let score = block.score(&known.mean, &point);
        let (_, raw) = block.derivatives(&known.mean, &point);
        let mut logs = [0.0; 4];
        for (log, walk) in logs.iter_mut().zip(WALKS_UT) {
            let Some(prior) = Ldl::new(&walked(&known.covariance, walk / unit_ut, seconds)) else { return };
            // log det (I + P_q H) = log det P_q + log det (H + P_q^-1)
            let Some(factors) = Ldl::new(&(raw + prior.inverse())) else { return };
            *log = 0.5 * (factors.square(&score) - factors.log_det - prior.log_det);
        }
        for k in 0..4 {
            self.evidence[k] = KEPT * self.evidence[k] + logs[k] - logs[0];
        }
        let best = (1..4).max_by(|a, b| self.evidence[*a].total_cmp(&self.evidence[*b])).unwrap_or(0);
        let needed = if self.chosen > 0 { 0.0 } else { EARNED };
        self.chosen = if self.evidence[best] > needed { best } else { 0 };
    }

    /// After a change the past says nothing about drift.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}
