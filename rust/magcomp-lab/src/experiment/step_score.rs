//! Figures of the runs of the step experiment.
//!
//! * relative error of a parameter: (estimated - true) / |true|, at every sample after the step; relative to |h| where |true| is
//!   below 0.001;
//! * transient: samples after the step until the rms over runs of that error stays below 5 % for good;
//! * steady state: its rms over the last 1000 samples;
//! * azimuth phi = atan2(h_y, h_x) and elevation theta = acos(h_z / |h|) of eq. (12) to (14), of the corrected sample
//!   against the true field; azimuth counts only where sin(theta) >= 0.5, because near the poles it is unbounded for
//!   any estimator.

use super::Spread;
use super::step_course::Course;
use super::step_trace::{BEFORE, Trace};
use crate::parameters::NAMES;
use crate::random::{Purpose, Random};
use magcomp::Normalisation;
use serde::Serialize;

/// Samples after it.
pub const AFTER: usize = 4000;
/// The last samples, which count as steady state.
pub const STEADY: usize = 1000;
/// A parameter has settled below this relative error.
const SETTLED: f64 = 0.05;
/// Resamplings of the runs for the spread of a transient.
const RESAMPLINGS: usize = 30;

/// Peak errors over some samples, degrees; mean and spread over runs.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Peaks {
    /// Largest azimuth error where sin(theta) >= 0.5.
    pub azimuth_deg: Spread,
    /// Largest elevation error.
    pub elevation_deg: Spread,
}

/// One parameter through the step.
#[derive(Clone, Debug, Serialize)]
pub struct ParameterResult {
    pub name: &'static str,
    /// Samples after the step until the rms over runs of the relative error stays below 5 % for good; none when never.
    pub transient_samples: Option<usize>,
    /// Standard deviation of that over resampled runs (bootstrap), samples.
    pub transient_sd: f64,
    /// Relative error over the last 1000 samples, rms, percent: mean and spread over runs.
    pub steady_percent: Spread,
}

/// One normalisation of sigma_T.
#[derive(Clone, Debug, Serialize)]
pub struct NormalisationResult {
    /// `HalfRange` or `EvenSphere`.
    pub normalisation: Normalisation,
    /// sigma_T over the last 1000 samples.
    pub sigma_t: Spread,
    /// Window N over the last 1000 samples.
    pub window: Spread,
    pub parameters: Vec<ParameterResult>,
    /// Longest transient of the nine, samples; none when one never settles.
    pub transient_samples: Option<usize>,
    /// The constant-field parameters kept, after the step.
    pub kept: Peaks,
    /// The method, from the step until the longest transient ends.
    pub during: Peaks,
    /// The method, after it.
    pub after: Peaks,
    /// The same without the sensor's noise: the calibration's own error.
    pub after_clean: Peaks,
    /// All runs over time, for the figures.
    #[serde(skip)]
    pub course: Course,
}

/// Runs of one normalisation.
#[derive(Clone, Debug)]
pub struct Score {
    pub normalisation: Normalisation,
    pub seed: u64,
    pub runs: Vec<Trace>,
}

impl Score {
    pub fn add(&mut self, mut run: Trace) {
        if !self.runs.is_empty() {
            run.truth = Vec::new();
        }
        self.runs.push(run);
    }

    pub fn finish(self) -> NormalisationResult {
        let parameters: Vec<ParameterResult> = (0..9).map(|i| self.parameter(i)).collect();
        let transient_samples = parameters.iter().map(|p| p.transient_samples).collect::<Option<Vec<_>>>();
        let transient_samples = transient_samples.and_then(|all| all.into_iter().max());
        let end = BEFORE + transient_samples.unwrap_or(AFTER - STEADY);
        let steady = |value: fn(&Trace) -> &Vec<f64>| {
            let means = self.runs.iter().map(|run| Spread::of(&value(run)[BEFORE + AFTER - STEADY..]).mean);
            Spread::of(&means.collect::<Vec<_>>())
        };
        NormalisationResult {
            normalisation: self.normalisation,
            sigma_t: steady(|run| &run.sigma_t),
            window: steady(|run| &run.window),
            parameters,
            transient_samples,
            kept: self.peaks(|run| &run.kept_deg[BEFORE..]),
            during: self.peaks(|run| &run.method_deg[BEFORE..end]),
            after: self.peaks(|run| &run.method_deg[end..]),
            after_clean: self.peaks(|run| &run.clean_deg[end..]),
            course: Course::of(&self.runs),
        }
    }

    fn parameter(&self, i: usize) -> ParameterResult {
        let everyone: Vec<usize> = (0..self.runs.len()).collect();
        let mut random = Random::new(self.seed, Purpose::Bootstrap);
        let resampled = (0..RESAMPLINGS).map(|_| {
            let drawn: Vec<usize> = everyone.iter().map(|_| random.index(everyone.len())).collect();
            self.transient(&drawn, i).unwrap_or(AFTER) as f64
        });
        let transient_sd = Spread::of(&resampled.collect::<Vec<_>>()).sd;
        let steady = self.runs.iter().map(|run| {
            let squares = (AFTER - STEADY..AFTER).map(|k| run.relative(k, i).powi(2)).sum::<f64>();
            100.0 * (squares / STEADY as f64).sqrt()
        });
        ParameterResult {
            name: NAMES[i],
            transient_samples: self.transient(&everyone, i),
            transient_sd,
            steady_percent: Spread::of(&steady.collect::<Vec<_>>()),
        }
    }

    /// Samples after the step from which on the rms over these runs stays below 5 %; None when not even at the end.
    fn transient(&self, runs: &[usize], i: usize) -> Option<usize> {
        let rms = |k: usize| {
            let squares: f64 = runs.iter().map(|run| self.runs[*run].relative(k, i).powi(2)).sum();
            (squares / runs.len() as f64).sqrt()
        };
        match (0..AFTER).rev().find(|k| rms(*k) >= SETTLED) {
            Some(last) if last + 1 == AFTER => None,
            Some(last) => Some(last + 1),
            None => Some(0),
        }
    }

    fn peaks(&self, errors: impl Fn(&Trace) -> &[(f64, f64)]) -> Peaks {
        let peak = |part: fn(&(f64, f64)) -> f64| {
            let of = |run| errors(run).iter().map(part).fold(0.0_f64, |peak, error| peak.max(error.abs()));
            Spread::of(&self.runs.iter().map(of).collect::<Vec<_>>())
        };
        Peaks { azimuth_deg: peak(|error| error.0), elevation_deg: peak(|error| error.1) }
    }
}
