//! The paper's real-time method (section IV, fig. 3). For each new sample, with the M_k, b_k of the step before:
//! 1. sigma_T over the latest N_min samples, (11) to (15);
//! 2. below sigma_th nothing is updated;
//! 3. (16) the window N;
//! 4. (10) on the latest N samples gives M_k+1, b_k+1.
//!
//! What is ours: the cost of a window is kept as its moments, so a fit costs the same for every N; each fit starts from
//! the previous parameters or from a closed form, whichever fits better; a fit that the samples don't support is refused
//! with its reason and the parameters stay; and when the window holds samples that lie on no one ellipsoid, it is cut to
//! the latest N_min and grows from there.

#[cfg(test)]
mod tests;

use super::clerk::Clerk;
use super::config::WindowedConfig;
use crate::ellipsoid::{EllipsoidFit, FitError};
use crate::explanation::{EXPLAINED_HYPOTHESES, Estimator, EstimatorPhase, Explanation, NoiseLevels, SampleUse};
use crate::reading::{HoldReason, Missing, Status};
use nalgebra::Vector3;

/// The constant method keeps its first fit that predicts direction errors below this, degrees: an even sphere of 100
/// samples at 30 dB reaches 0.7.
const CONSTANT_SIGMA_DEG: f64 = 1.0;
/// Rms deviation of |h| over the latest N_min samples, as a share of the field strength, that is suspect: rooms stay
/// below 5 %, a magnet of 13 uT on the phone gives 20 %.
const SUSPECT_SPREAD: f64 = 0.1;

/// Samples from a refused fit to the next try.
const RETRY_SAMPLES: usize = 10;

/// (16) N = N_max - (N_max - N_min) sigma_T, kept in [N_min, N_max]: how many of the latest samples a fit uses, rounded to a whole
/// number. Even orientations need few samples, poor ones many.
#[must_use]
pub fn window_length(sigma_t: f64, n_min: usize, n_max: usize) -> usize {
    let n = n_max as f64 - (n_max as f64 - n_min as f64) * sigma_t;
    if n.is_nan() { n_max } else { (n.round() as usize).clamp(n_min, n_max.max(n_min)) }
}

/// The paper's estimator, over the samples of a clerk, who has the calibration in force too.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Windowed {
    /// The first good fit is kept.
    pub constant: bool,
    /// The latest that was accepted.
    pub fit: Option<EllipsoidFit>,
    since_fit: usize,
    /// Samples since the last change that was noticed: older ones are not used.
    since_change: usize,
    refused: Option<FitError>,
    suspect_since_ns: Option<i64>,
}

impl Windowed {
    /// `constant`: the first good fit is kept.
    pub fn new(constant: bool) -> Self {
        Self { constant, ..Self::default() }
    }

    /// One step of fig. 3; (15) is the clerk's then.
    pub fn push(&mut self, time_ns: i64, raw_ut: &Vector3<f64>, clerk: &mut Clerk) -> Status {
        let WindowedConfig { n_min, n_max, sigma_th, .. } = clerk.config;
        clerk.enter(raw_ut);
        self.since_change = self.since_change.saturating_add(1);
        self.since_fit = self.since_fit.saturating_add(1);
        let spread = clerk.measure();
        let status = match clerk.noted.sigma_t {
            _ if self.constant && clerk.noted.calibration.is_some() => {
                clerk.resize(clerk.window.min(n_min));
                Status::Held(HoldReason::Constant)
            }
            Some(sigma_t) if sigma_t < sigma_th => {
                clerk.resize(clerk.window - 1);
                Status::Held(HoldReason::LowUniformity)
            }
            Some(sigma_t) => {
                let length = window_length(sigma_t, n_min, n_max);
                clerk.resize(length.min(self.since_change));
                self.refit(clerk)
            }
            None if clerk.len() >= n_min => self.refit(clerk),
            None => self.collecting(clerk),
        };
        clerk.recount();
        if spread <= SUSPECT_SPREAD {
            self.suspect_since_ns = None;
            return status;
        }
        Status::Suspect { since_ns: *self.suspect_since_ns.get_or_insert(time_ns) }
    }

    /// 4. (10) on the window.
    fn refit(&mut self, clerk: &mut Clerk) -> Status {
        // a window that does not fit now will hardly fit one sample later
        let wait = if self.refused.is_some() { RETRY_SAMPLES } else { 1 };
        if self.since_fit >= wait {
            self.since_fit = 0;
            let WindowedConfig { n_min, n_max, .. } = clerk.config;
            let options = clerk.config.fit_options(clerk.field_strength_ut);
            match clerk.moments.fit_from(clerk.noted.calibration.as_ref(), &options) {
                // a better one may come while the window grows
                Ok(fit) if self.constant && fit.direction_sigma_deg > CONSTANT_SIGMA_DEG && clerk.window < n_max => {}
                Ok(fit) => {
                    (clerk.noted.calibration, self.fit, self.refused) = (Some(fit.calibration), Some(fit), None);
                    clerk.recentre(fit.calibration.hard_iron_ut(), fit.calibration.field_strength_ut());
                }
                Err(error) => {
                    self.refused = Some(error);
                    if matches!(error, FitError::Inconsistent { .. }) {
                        // something changed inside the window: only its latest samples may still agree
                        self.since_change = n_min;
                        clerk.resize(n_min);
                    }
                }
            }
        }
        match (clerk.noted.calibration, self.refused) {
            (None, _) => self.collecting(clerk),
            (_, None) => Status::Tracking,
            (_, Some(error)) => Status::Held(HoldReason::FitRefused(error)),
        }
    }

    pub fn explain(&self, clerk: &Clerk) -> Explanation {
        let is_kept = self.constant && clerk.noted.calibration.is_some();
        let usage = if is_kept { SampleUse::Unused } else { SampleUse::Pooled };
        Explanation {
            estimator: Estimator::Windowed,
            phase: match (self.fit, self.suspect_since_ns) {
                (None, _) => EstimatorPhase::Starting,
                (Some(_), None) => EstimatorPhase::Running,
                (Some(_), Some(_)) => EstimatorPhase::Undecided,
            },
            tries_both: false,
            sample: (clerk.len() > 0).then_some(usage),
            innovation: None,
            gated_share: None,
            compared_turn_deg: None,
            hypotheses: [None; EXPLAINED_HYPOTHESES],
            noise: NoiseLevels { white_ut: self.fit.map(|fit| fit.residual_rms_ut), ..NoiseLevels::default() },
        }
    }

    fn collecting(&self, clerk: &Clerk) -> Status {
        Status::Collecting(match self.refused {
            Some(error) => Missing::Fit(error),
            None => Missing::Samples { have: clerk.len(), need: clerk.config.n_min },
        })
    }
}
