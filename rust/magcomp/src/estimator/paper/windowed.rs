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

use super::uniformity::{Evenness, evenness};
use super::window::{Window, window_length};
use crate::calibration::{Calibration, UNEVEN_UT, calibration_covariance};
use crate::config::WindowedConfig;
use crate::ellipsoid::{EllipsoidFit, FitError};
use crate::estimator::answer::{Answer, Counted, Known};
use crate::explanation::{EXPLAINED_HYPOTHESES, Estimator, EstimatorPhase, Explanation, NoiseLevels, SampleUse};
use crate::reading::{HoldReason, Missing, Status};
use crate::sample::MagneticSample;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

/// Choice: the constant method keeps its first fit that predicts direction errors below this, deg: an even sphere of 100 samples at 30 dB reaches 0.7
/// (tests/host/steps.rs).
const CONSTANT_SIGMA_DEG: f64 = 1.0;
/// Choice: rms deviation of |h| over the latest N_min samples, as a share of the field strength, that is suspect: rooms stay below 5 %, a magnet of 13 uT makes
/// 20 % (tests/recordings, broad_34).
const SUSPECT_SPREAD: f64 = 0.1;
/// Choice: samples from a refused fit to the next try, a tenth of the shortest window: one that does not fit now will hardly fit one sample later.
const RETRY_SAMPLES: usize = 10;

/// The paper's estimator.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Windowed {
    config: WindowedConfig,
    /// |h|, uT, where it is known.
    strength_ut: Option<f64>,
    /// The first good fit is kept.
    is_constant: bool,
    window: Window,
    state: State,
}

/// What is carried from sample to sample beside the samples themselves.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct State {
    /// M_k, b_k.
    calibration: Option<Calibration>,
    /// The latest fit that was accepted.
    fit: Option<EllipsoidFit>,
    since_fit: usize,
    /// Samples since the last change that was noticed: older ones are not used.
    since_change: usize,
    refused: Option<FitError>,
    suspect_since_ns: Option<i64>,
}

impl Windowed {
    /// For a validated config and a field strength (uT) where it is known. All memory is taken here.
    pub fn new(is_constant: bool, config: WindowedConfig, strength_ut: Option<f64>) -> Self {
        let window = Window::new(config.n_max, strength_ut);
        Self { config, strength_ut, is_constant, window, state: State::default() }
    }

    pub fn restart(&mut self) {
        self.window.restart();
        self.state = State::default();
    }

    /// From now on this calibration is in force, where there is one, until the next fit.
    pub fn begin_from(&mut self, calibration: Option<Calibration>) {
        self.state.fit = None;
        self.state.calibration = calibration.or(self.state.calibration);
    }

    pub fn known(&self) -> Known {
        Known { calibration: self.state.calibration, covariance: self.state.fit.map(|fit| fit.covariance) }
    }

    pub fn fit(&self) -> Option<&EllipsoidFit> {
        self.state.fit.as_ref()
    }

    /// The window.
    pub fn counted(&self) -> Counted<'_> {
        Counted { through: self.state.calibration.as_ref(), samples: self.window.length }
    }

    /// One sample, and what gravity says with it, m/s^2.
    pub fn push(&mut self, sample: &MagneticSample, up_m_s2: Option<Vector3<f64>>) -> (Status, Answer) {
        let evenness = self.enter(&sample.field_ut);
        let sigma_t = evenness.map(|it| it.sigma_t);
        let status = self.update(sigma_t);
        let is_suspect = evenness.is_some_and(|it| it.spread > SUSPECT_SPREAD);
        let suspect_since_ns = is_suspect.then(|| self.state.suspect_since_ns.unwrap_or(sample.time_ns));
        self.state.suspect_since_ns = suspect_since_ns;
        let status = suspect_since_ns.map_or(status, |since_ns| Status::Suspect { since_ns });
        (status, Answer { sigma_t, ..self.answer(&sample.field_ut) }.without_gyroscope(up_m_s2))
    }

    /// The sample enters the window. 1. (11) to (15), once there are N_min samples and a calibration.
    fn enter(&mut self, raw_ut: &Vector3<f64>) -> Option<Evenness> {
        if self.state.calibration.is_none() {
            self.window.begin_about(raw_ut);
        }
        self.window.enter(raw_ut);
        self.state.since_change = self.state.since_change.saturating_add(1);
        self.state.since_fit = self.state.since_fit.saturating_add(1);
        let n_min = self.config.n_min;
        let calibration = self.state.calibration.filter(|_| self.window.kept() >= n_min)?;
        Some(evenness(self.window.latest(n_min), &calibration, self.config.normalisation))
    }

    /// 2. to 4.
    fn update(&mut self, sigma_t: Option<f64>) -> Status {
        let WindowedConfig { n_min, n_max, sigma_th, .. } = self.config;
        match sigma_t {
            _ if self.is_kept() => {
                self.window.resize(self.window.length.min(n_min));
                Status::Held(HoldReason::Constant)
            }
            Some(sigma_t) if sigma_t < sigma_th => {
                self.window.resize(self.window.length - 1);
                Status::Held(HoldReason::LowUniformity)
            }
            Some(sigma_t) => {
                let length = window_length(sigma_t, n_min, n_max);
                self.window.resize(length.min(self.state.since_change));
                self.refit()
            }
            None if self.window.kept() >= n_min => self.refit(),
            None => self.collecting(),
        }
    }

    /// Whether the calibration in force is the constant method's last.
    fn is_kept(&self) -> bool {
        self.is_constant && self.state.calibration.is_some()
    }

    /// 4. (10) on the window.
    fn refit(&mut self) -> Status {
        let wait = if self.state.refused.is_some() { RETRY_SAMPLES } else { 1 };
        if self.state.since_fit >= wait {
            self.state.since_fit = 0;
            self.fit_window();
        }
        match (self.state.calibration, self.state.refused) {
            (None, _) => self.collecting(),
            (_, None) => Status::Tracking,
            (_, Some(error)) => Status::Held(HoldReason::FitRefused(error)),
        }
    }

    fn fit_window(&mut self) {
        let WindowedConfig { n_min, n_max, .. } = self.config;
        let options = self.config.fit_options(self.strength_ut);
        match self.window.moments.fit_from(self.state.calibration.as_ref(), &options) {
            Ok(fit) => {
                let may_improve = self.is_constant && self.window.length < n_max;
                if may_improve && fit.direction_sigma_deg > CONSTANT_SIGMA_DEG {
                    return;
                }
                let State { calibration, fit: latest, refused, .. } = &mut self.state;
                (*calibration, *latest, *refused) = (Some(fit.calibration), Some(fit), None);
                self.window.recentre(fit.calibration.hard_iron_ut(), fit.calibration.field_strength_ut(), n_min);
            }
            Err(error) => {
                self.state.refused = Some(error);
                if matches!(error, FitError::Inconsistent { .. }) {
                    // something changed inside the window: only its latest samples may still agree
                    self.state.since_change = n_min;
                    self.window.resize(n_min);
                }
            }
        }
    }

    /// The sample, corrected, with all that is told beside it; sigma_T is that of before the fit.
    fn answer(&self, raw_ut: &Vector3<f64>) -> Answer {
        let State { calibration, fit, .. } = &self.state;
        let field_ut = calibration.map(|calibration| calibration.correct(raw_ut));
        let field_ut = field_ut.filter(|field| field.norm().is_finite());
        let field_covariance_ut2 = fit.zip(field_ut).map(|(fit, field)| {
            let w = fit.calibration.soft_iron_inverse();
            let noise = w * w.transpose() * fit.residual_rms_ut.powi(2);
            // what this method does not learn: rooms are not uniform
            let uneven = Matrix3::from_diagonal_element(UNEVEN_UT.powi(2));
            calibration_covariance(&fit.covariance, w, &field) + noise + uneven
        });
        Answer {
            field_ut,
            field_covariance_ut2,
            direction_sigma_deg: fit.map(|fit| fit.direction_sigma_deg),
            window: self.window.length,
            ..Answer::default()
        }
    }

    fn collecting(&self) -> Status {
        Status::Collecting(match self.state.refused {
            Some(error) => Missing::Fit(error),
            None => Missing::Samples { have: self.window.kept(), need: self.config.n_min },
        })
    }

    pub fn explain(&self) -> Explanation {
        let usage = if self.is_kept() { SampleUse::Unused } else { SampleUse::Pooled };
        Explanation {
            estimator: Estimator::Windowed,
            phase: match (&self.state.fit, self.state.suspect_since_ns) {
                (None, _) => EstimatorPhase::Starting,
                (Some(_), None) => EstimatorPhase::Running,
                (Some(_), Some(_)) => EstimatorPhase::Undecided,
            },
            tries_both: false,
            sample: (self.window.kept() > 0).then_some(usage),
            innovation: None,
            gated_share: None,
            compared_turn_deg: None,
            hypotheses: [None; EXPLAINED_HYPOTHESES],
            noise: NoiseLevels { white_ut: self.state.fit.map(|fit| fit.residual_rms_ut), ..NoiseLevels::default() },
            outside: None,
        }
    }
}
