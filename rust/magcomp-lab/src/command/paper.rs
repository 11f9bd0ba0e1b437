//! `magcomp paper`.

use super::common::SEED;
use crate::catalogue::{PhoneChange, Sensors, phone};
use crate::experiment::bound::{self, BoundOptions, SAMPLES, SNR_DB};
use crate::experiment::follow::{self, FollowOptions};
use crate::experiment::step::{self, FACTOR, StepOptions};
use crate::motion::Motion;
use crate::parameters::{ParameterSet, TrueParameters};
use crate::simulate::Noise;
use clap::{Args, Subcommand, value_parser};
use magcomp_replay::command::{Common, NormalisationChoice, ResidualChoice, between, finite};
use magcomp_replay::error::RunError;
use magcomp_replay::report::Report;

// each experiment's own documentation is its help
#[derive(Debug, Subcommand)]
pub(super) enum Paper {
    Bound(Bound),
    Step(Step),
    Phone(Phone),
}

impl Paper {
    pub fn run(self) -> Result<(), RunError> {
        match self {
            Self::Bound(experiment) => experiment.run(),
            Self::Step(experiment) => experiment.run(),
            Self::Phone(experiment) => experiment.run(),
        }
    }
}

/// Fig. 2: error of the ellipsoid fit over the Cramer-Rao bound.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Bound {
    /// Runs for every N and SNR; the ratios' own error is about 1 / sqrt(6 runs)
    #[arg(long, default_value_t = 400, value_parser = value_parser!(u32).range(1..))]
    runs: u32,
    #[command(flatten)]
    truth: TrueParameters,
    /// Samples P that are averaged at each orientation
    #[arg(long, value_name = "P", default_value_t = 1, value_parser = value_parser!(u32).range(1..=1000))]
    p: u32,
    /// Sample counts N
    #[arg(long, num_args = 1.., value_delimiter = ',', default_values_t = SAMPLES.map(|n| n as u32), value_parser = value_parser!(u32).range(9..=100_000))]
    samples: Vec<u32>,
    /// Signal-to-noise ratios, dB
    #[arg(long, num_args = 1.., value_delimiter = ',', default_values_t = SNR_DB, value_parser = finite)]
    snr: Vec<f64>,
    #[arg(long, default_value_t = 1, help = SEED)]
    seed: u64,
    #[command(flatten)]
    common: Common,
}

impl Bound {
    fn run(self) -> Result<(), RunError> {
        let options = BoundOptions {
            truth: self.truth.parameters(ParameterSet::Ref)?,
            runs: self.runs as usize,
            averaged: self.p as usize,
            seed: self.seed,
            samples: self.samples.iter().map(|n| *n as usize).collect(),
            snr_db: self.snr,
        };
        let result = bound::run(&options)?;
        self.common.finish(&[result.table()], &result, || {
            Report::new(
                "How close the ellipsoid fit comes to the bound",
                "The paper's fig. 2: root mean square error of the fit over the Cramer-Rao bound, computed from the Fisher \
                 information of h_m = M h + b with the orientations unknown.",
            ).with(|report| result.add_to(report))
        })
    }
}

/// Figs. 4 and 5: all nine parameters step while the device turns, and the windowed method follows.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Step {
    /// Runs to average
    #[arg(long, default_value_t = 60, value_parser = value_parser!(u32).range(1..))]
    runs: u32,
    /// How the device turns
    #[arg(long, value_enum, default_value_t)]
    motion: Motion,
    /// Signal-to-noise ratio, dB
    #[arg(long, default_value_t = 30.0, value_parser = finite)]
    snr: f64,
    #[command(flatten)]
    truth: TrueParameters,
    /// The residual that the fits minimise
    #[arg(long, value_enum, default_value_t)]
    residual: ResidualChoice,
    /// All nine parameters step by this factor
    #[arg(long, default_value_t = FACTOR, value_parser = |text: &str| between(text, 0.1, 10.0))]
    factor: f64,
    /// How sigma_T is normalised; both, a column each, when not given
    #[arg(long, value_enum)]
    normalisation: Option<NormalisationChoice>,
    /// Smallest window N_min, samples
    #[arg(long, value_name = "N", default_value_t = 100)]
    n_min: usize,
    /// Largest window N_max, samples
    #[arg(long, value_name = "N", default_value_t = 2000)]
    n_max: usize,
    /// Threshold of sigma_T
    #[arg(long, value_name = "SIGMA_T", default_value_t = 0.1, value_parser = |text: &str| between(text, 0.0, 10.0))]
    sigma_th: f64,
    #[arg(long, default_value_t = 1, help = SEED)]
    seed: u64,
    #[command(flatten)]
    common: Common,
}

impl Step {
    fn run(self) -> Result<(), RunError> {
        let both = StepOptions::default().normalisations;
        let result = step::run(&StepOptions {
            truth: self.truth,
            motion: self.motion,
            snr_db: self.snr,
            residual: self.residual,
            factor: self.factor,
            normalisations: self.normalisation.map_or(both, |choice| vec![choice.into()]),
            n_min: self.n_min,
            n_max: self.n_max,
            sigma_th: self.sigma_th,
            runs: self.runs as usize,
            seed: self.seed,
        })?;
        self.common.finish(&result.tables(), &result, || {
            let lead = format!(
                "The paper's figs. 4 and 5: soft and hard iron step by the factor {} while the device turns. The windowed method \
                 re-estimates them from the latest samples.",
                result.factor
            );
            Report::new("Following a step of all nine parameters", &lead).with(|report| result.add_to(report))
        })
    }
}

/// Such a step for a simulated phone: the aided method beside the paper's, with the gyroscope and accelerometer that belong to the motion.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Phone {
    /// Runs to average
    #[arg(long, default_value_t = 20, value_parser = value_parser!(u32).range(1..))]
    runs: u32,
    /// How the device turns: tumble or walk
    #[arg(long, value_enum, default_value_t = Motion::Tumble)]
    motion: Motion,
    /// Signal-to-noise ratio, dB; 40 when not given
    #[arg(long, value_parser = finite)]
    snr: Option<f64>,
    /// The change; parameters for tumble and offset for walk when not given
    #[arg(long, value_enum)]
    change: Option<PhoneChange>,
    /// Samples per second of every sensor
    #[arg(long, value_name = "HZ", default_value_t = 100.0, value_parser = |text: &str| between(text, 25.0, 400.0))]
    rate: f64,
    /// Gyroscope bias, deg/s, in a random direction
    #[arg(long, value_name = "DEG_S", default_value_t = 0.0, value_parser = |text: &str| between(text, 0.0, 20.0))]
    gyro_bias: f64,
    /// Error of the gyroscope's scale, percent
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = |text: &str| between(text, -20.0, 20.0))]
    gyro_scale: f64,
    /// How late the gyroscope's events are stamped, ms
    #[arg(long, value_name = "MS", default_value_t = 0.0, value_parser = |text: &str| between(text, -100.0, 100.0))]
    gyro_late: f64,
    /// How far each axis of the gyroscope is off along each axis, degrees rms: errors drawn for each run
    #[arg(long, value_name = "DEG", default_value_t = 0.0, value_parser = |text: &str| between(text, 0.0, 5.0))]
    gyro_skew: f64,
    /// Samples hit by a spike of 30 to 150 uT, percent
    #[arg(long, value_name = "PERCENT", default_value_t = 0.0, value_parser = |text: &str| between(text, 0.0, 50.0))]
    spikes: f64,
    #[arg(long, default_value_t = 1, help = SEED)]
    seed: u64,
    #[command(flatten)]
    common: Common,
}

impl Phone {
    fn run(self) -> Result<(), RunError> {
        let Some(own) = FollowOptions::of(self.motion) else {
            return Err(RunError::Usage("--motion must be tumble or walk: a gyroscope follows these".to_owned()));
        };
        let mut variant =
            self.change.map_or(own.variant, |change| phone("step", self.motion, change).in_an_even_place());
        // an even distribution of the same root mean square as was asked for
        let lean_deg = self.gyro_skew * 3f64.sqrt();
        variant.sensors = Sensors {
            gyro_bias_deg_s: (self.gyro_bias, self.gyro_bias),
            gyro_scale: self.gyro_scale / 100.0,
            gyro_late_s: self.gyro_late / 1000.0,
            gyro_lean_deg: lean_deg,
            gyro_axis_scale: lean_deg.to_radians(),
            ..variant.sensors.at_rate(self.rate)
        };
        let variant = variant.with_noise(self.snr.map(Noise::SnrDb)).with_spikes(self.spikes / 100.0);
        let result = follow::run(&FollowOptions { variant, runs: self.runs as usize, seed: self.seed })?;
        self.common.finish(&result.tables(), &result, || {
            let lead = "Something changes for a simulated phone. Below the tables: the first method in the first run.";
            Report::new("Following a change", lead).with(|report| result.add_to(report, "step_first_run"))
        })
    }
}
