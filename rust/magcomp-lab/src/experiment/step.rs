//! Figs. 4 and 5: all nine parameters step by 50 %, and the paper's windowed method follows.
//!
//! Each run: a constant-field compensation of 4000 even orientations gives M_0, b_0 (section III); then a stream whose
//! parameters step after 2500 samples goes through the compensator, once for each normalisation of sigma_T.

use super::bound::fit_options;
use super::step_score::{AFTER, NormalisationResult, Score};
use super::step_trace::{BEFORE, FIELD_UT, Trace};
use crate::course::{Course, DevicePart};
use crate::motion::Motion;
use crate::parameters::{ParameterSet, Parameters, TrueParameters};
use crate::random::{Purpose, Random};
use crate::simulate::{Magnetometer, Noise, Scenario, Simulation, world_field_ut};
use magcomp::{Calibration, Compensator, Config, Method, Normalisation, WindowedConfig, fit_ellipsoid};
use magcomp_replay::command::{ResidualChoice, as_typed};
use magcomp_replay::error::RunError;
use magcomp_replay::progress;
use serde::Serialize;

/// Dip of that field, degrees.
const DIP_DEG: f64 = 60.0;
/// Samples a second.
pub const RATE_HZ: f64 = 100.0;
/// Orientations of the constant-field compensation (the paper's, P = 1).
const CONSTANT_FIELD_SAMPLES: usize = 4000;
/// All parameters times this, unless another factor is given: the paper's step of 50 %.
pub const FACTOR: f64 = 1.5;

/// Options of the experiment.
#[derive(Clone, Debug)]
pub struct StepOptions {
    /// Parameters before the step.
    pub truth: TrueParameters,
    /// How the device turns.
    pub motion: Motion,
    /// Signal-to-noise ratio, dB.
    pub snr_db: f64,
    /// The residual that the fits minimise.
    pub residual: ResidualChoice,
    /// All nine parameters step by this factor.
    pub factor: f64,
    /// Readings of the normalisation of sigma_T, one column each.
    pub normalisations: Vec<Normalisation>,
    /// Smallest window N_min, samples.
    pub n_min: usize,
    /// Largest window N_max, samples.
    pub n_max: usize,
    /// Threshold of sigma_T.
    pub sigma_th: f64,
    /// Runs.
    pub runs: usize,
    /// Names the random numbers; run k uses seed + k.
    pub seed: u64,
}

impl Default for StepOptions {
    fn default() -> Self {
        Self {
            truth: TrueParameters::default(),
            motion: Motion::Uniform,
            snr_db: 30.0,
            residual: ResidualChoice::Corrected,
            factor: FACTOR,
            normalisations: vec![Normalisation::HalfRange, Normalisation::EvenSphere],
            n_min: 100,
            n_max: 2000,
            sigma_th: WindowedConfig::default().sigma_th,
            runs: 60,
            seed: 1,
        }
    }
}

/// Figs. 4 and 5 as numbers.
#[derive(Clone, Debug, Serialize)]
pub struct StepResult {
    /// Runs that were averaged.
    pub runs: usize,
    /// Signal-to-noise ratio, dB.
    pub snr_db: f64,
    /// All nine parameters step by this factor.
    pub factor: f64,
    /// Motion and parameter set, for titles.
    pub scenario: String,
    /// Both readings of the paper's normalisation.
    pub normalisations: Vec<NormalisationResult>,
}

/// Runs the experiment.
pub fn run(options: &StepOptions) -> Result<StepResult, RunError> {
    let truth = options.truth.parameters(ParameterSet::Ref)?;
    let choices = options.normalisations.iter();
    let score =
        |normalisation: &Normalisation| Score { normalisation: *normalisation, seed: options.seed, runs: Vec::new() };
    let mut scores: Vec<Score> = choices.map(score).collect();
    let bar = progress::bar(options.runs * scores.len(), "step");
    for k in 0..options.runs {
        let seed = options.seed.wrapping_add(k as u64);
        let stream = scenario(options, &truth, seed).run();
        let constant = constant_field(options, &truth, seed)?;
        for score in &mut scores {
            let config = config(options, constant, score.normalisation);
            score.add(follow(&stream, constant, config)?);
            bar.inc(1);
        }
    }
    bar.finish_and_clear();
    Ok(StepResult {
        runs: options.runs,
        snr_db: options.snr_db,
        factor: options.factor,
        scenario: format!(
            "{}, {} motion, {} residual",
            options.truth.name(ParameterSet::Ref),
            as_typed(&options.motion),
            as_typed(&options.residual)
        ),
        normalisations: scores.into_iter().map(Score::finish).collect(),
    })
}

/// The stream of a run.
fn scenario(options: &StepOptions, before: &Parameters, seed: u64) -> Scenario {
    let duration_s = (BEFORE + AFTER) as f64 / RATE_HZ;
    let step = Course::step(BEFORE as f64 / RATE_HZ);
    let mut random = Random::new(seed, Purpose::Motion);
    Scenario {
        seed,
        duration_s,
        trajectory: options.motion.trajectory(duration_s, 1.0 / RATE_HZ, &mut random),
        earth_ut: world_field_ut(FIELD_UT, DIP_DEG),
        surroundings: Vec::new(),
        device: *before,
        device_parts: vec![DevicePart::between(step, before, &before.times(options.factor), FIELD_UT)],
        other_changes: Vec::new(),
        magnetometer: Magnetometer::plain(RATE_HZ, Noise::SnrDb(options.snr_db)),
        gyroscope: None,
        accelerometer: None,
        pause_s: None,
    }
}

/// Section III: M_0 and b_0 from even orientations in a constant field.
fn constant_field(options: &StepOptions, truth: &Parameters, seed: u64) -> Result<Calibration, RunError> {
    let sigma_ut = Noise::SnrDb(options.snr_db).sigma_ut(FIELD_UT);
    let mut random = Random::new(seed, Purpose::ConstantField);
    let points: Vec<_> = (0..CONSTANT_FIELD_SAMPLES)
        .map(|_| (truth.soft_iron * random.direction() + truth.hard_iron) * FIELD_UT + random.normal3() * sigma_ut)
        .collect();
    fit_ellipsoid(&points, &fit_options(options.residual.into()))
        .map(|fit| fit.calibration)
        .map_err(|error| RunError::Experiment(format!("constant-field compensation: {error}")))
}

/// The paper's method, |h| known.
fn config(options: &StepOptions, constant: Calibration, normalisation: Normalisation) -> Config {
    let StepOptions { n_min, n_max, sigma_th, .. } = *options;
    let residual = options.residual.into();
    Config {
        method: Method::Windowed,
        initial: Some(constant),
        field_strength_ut: Some(FIELD_UT),
        windowed: WindowedConfig { n_min, n_max, sigma_th, normalisation, residual, ..WindowedConfig::default() },
        ..Config::default()
    }
}

/// One stream through one compensator.
fn follow(stream: &Simulation, constant: Calibration, config: Config) -> Result<Trace, RunError> {
    let mut compensator = Compensator::new(config)?;
    let mut trace = Trace::default();
    for (sample, truth) in stream.magnetic.iter().zip(&stream.truth) {
        let reading = compensator.push(*sample);
        let calibration = compensator.calibration().unwrap_or(constant);
        trace.add(sample, truth, &reading, &calibration, &constant);
    }
    Ok(trace)
}
