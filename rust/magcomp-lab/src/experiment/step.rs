//! Figs. 4 and 5: all nine parameters step by 50 %, and the paper's windowed method follows.
//!
//! Each run: a constant-field compensation of 4000 even orientations gives M_0, b_0 (section III); then a stream whose
//! parameters step after 2500 samples goes through the compensator, once for each normalisation of sigma_T.

use super::Spread;
use super::bound::fit_options;
use super::step_score::{Score, Trace};
use crate::error::LabError;
use crate::motion::Motion;
use crate::parameters::{ParameterSet, Parameters};
use crate::progress;
use crate::random::{Purpose, Random};
use crate::schedule::Schedule;
use crate::simulate::{Noise, Scenario, Simulation, world_field_ut};
use clap::ValueEnum;
use magcomp::{
    Calibration, Compensator, Config, FitOptions, Method, Normalisation, Residual, WindowedConfig, fit_ellipsoid,
};
use serde::Serialize;

/// Field of the simulation, uT: so that 1.5 M is still a plausible sensor.
pub const FIELD_UT: f64 = 40.0;
/// Dip of that field, degrees.
const DIP_DEG: f64 = 60.0;
/// Samples a second.
pub const RATE_HZ: f64 = 100.0;
/// Samples before the step.
pub const BEFORE: usize = 2500;
/// Samples after it.
pub const AFTER: usize = 4000;
/// The last samples, which count as steady state.
pub const STEADY: usize = 1000;
/// Orientations of the constant-field compensation (the paper's, P = 1).
const CONSTANT_FIELD_SAMPLES: usize = 4000;
/// All parameters times this.
pub const FACTOR: f64 = 1.5;

/// Which residual the windowed fits use, as the command line names it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ResidualChoice {
    /// Divided by its own gradient, free of the noise bias
    #[default]
    Corrected,
    /// Eq. (10) as written
    Algebraic,
}

impl From<ResidualChoice> for Residual {
    fn from(choice: ResidualChoice) -> Self {
        match choice {
            ResidualChoice::Corrected => Self::Corrected,
            ResidualChoice::Algebraic => Self::Algebraic,
        }
    }
}

/// What to run.
#[derive(Clone, Debug)]
pub struct StepOptions {
    /// Parameters before the step.
    pub set: ParameterSet,
    /// How the device turns.
    pub motion: Motion,
    /// Signal-to-noise ratio, dB.
    pub snr_db: f64,
    /// What the fits minimise.
    pub residual: ResidualChoice,
    /// Runs.
    pub runs: usize,
    /// Names the random numbers; run k uses seed + k.
    pub seed: u64,
}

impl Default for StepOptions {
    fn default() -> Self {
        Self {
            set: ParameterSet::Ref,
            motion: Motion::Uniform,
            snr_db: 30.0,
            residual: ResidualChoice::Corrected,
            runs: 60,
            seed: 1,
        }
    }
}

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
    /// Its name.
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
    /// The nine parameters.
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
    /// The first run, for the figures.
    #[serde(skip)]
    pub trace: Trace,
}

/// Figs. 4 and 5 as numbers.
#[derive(Clone, Debug, Serialize)]
pub struct StepResult {
    /// Runs that were averaged.
    pub runs: usize,
    /// Signal-to-noise ratio, dB.
    pub snr_db: f64,
    /// Motion and parameter set, for titles.
    pub scenario: String,
    /// Both readings of the paper's normalisation.
    pub normalisations: Vec<NormalisationResult>,
}

/// Runs the experiment.
///
/// # Errors
/// [`LabError`] when the constant-field compensation fails or a config is refused.
pub fn run(options: &StepOptions) -> Result<StepResult, LabError> {
    let choices = [Normalisation::HalfRange, Normalisation::EvenSphere];
    let mut scores = choices.map(|normalisation| Score::new(normalisation, options.seed));
    let bar = progress::bar(options.runs * choices.len(), "step");
    for k in 0..options.runs {
        let seed = options.seed.wrapping_add(k as u64);
        let stream = scenario(options, seed).run();
        let constant = constant_field(options, seed)?;
        for score in &mut scores {
            let config = config(options, constant, score.normalisation());
            score.add(follow(&stream, constant, config)?);
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    let name =
        |value: Option<clap::builder::PossibleValue>| value.map_or_else(String::new, |v| v.get_name().to_owned());
    Ok(StepResult {
        runs: options.runs,
        snr_db: options.snr_db,
        scenario: format!(
            "set {}, {} motion, {} residual",
            name(options.set.to_possible_value()).to_uppercase(),
            name(options.motion.to_possible_value()),
            name(options.residual.to_possible_value())
        ),
        normalisations: scores.into_iter().map(Score::finish).collect(),
    })
}

/// The stream of a run.
fn scenario(options: &StepOptions, seed: u64) -> Scenario {
    let before = options.set.parameters();
    Scenario {
        seed,
        samples: BEFORE + AFTER,
        rate_hz: RATE_HZ,
        motion: options.motion,
        world_ut: Schedule::constant(world_field_ut(FIELD_UT, DIP_DEG)),
        parameters: Schedule::step(before, BEFORE as f64 / RATE_HZ, before.times(FACTOR)),
        noise: Noise::SnrDb(options.snr_db),
        spikes: None,
        gyroscope: None,
        accelerometer: None,
    }
}

/// Section III: M_0 and b_0 from even orientations in a constant field.
fn constant_field(options: &StepOptions, seed: u64) -> Result<Calibration, LabError> {
    let truth: Parameters = options.set.parameters();
    let sigma_ut = Noise::SnrDb(options.snr_db).sigma_ut(FIELD_UT);
    let mut random = Random::new(seed, Purpose::ConstantField);
    let points: Vec<_> = (0..CONSTANT_FIELD_SAMPLES)
        .map(|_| (truth.soft_iron * random.direction() + truth.hard_iron) * FIELD_UT + random.normal3() * sigma_ut)
        .collect();
    fit_ellipsoid(&points, &fit_options(options.residual.into()))
        .map(|fit| fit.calibration)
        .map_err(|error| LabError::Experiment(format!("constant-field compensation: {error}")))
}

/// The paper's method with its numbers: N_min 100, N_max 2000, |h| known.
fn config(options: &StepOptions, constant: Calibration, normalisation: Normalisation) -> Config {
    let fit = fit_options(options.residual.into());
    // with the paper's residual its method is followed as written: whatever the window holds is fitted
    let max_residual_share = if fit.residual == Residual::Algebraic { 1000.0 } else { fit.max_residual_share };
    Config {
        method: Method::Windowed,
        initial: Some(constant),
        fit: FitOptions { max_residual_share, ..fit },
        windowed: WindowedConfig { n_min: 100, n_max: 2000, normalisation, ..WindowedConfig::default() },
        ..Config::default()
    }
}

/// One stream through one compensator.
fn follow(stream: &Simulation, constant: Calibration, config: Config) -> Result<Trace, LabError> {
    let mut compensator = Compensator::new(config)?;
    let mut trace = Trace::default();
    for (sample, truth) in stream.magnetic.iter().zip(&stream.truth) {
        let reading = compensator.push(*sample);
        let calibration = compensator.calibration().unwrap_or(constant);
        trace.add(sample, truth, &reading, &calibration, &constant);
    }
    Ok(trace)
}
