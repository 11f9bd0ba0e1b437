//! `magcomp step`.

use crate::catalogue::{PhoneChange, Sensors, Variant, find, phone};
use crate::experiment::follow::{self, FollowOptions};
use crate::experiment::step::{StepOptions, run};
use crate::motion::Motion;
use crate::parameters::TrueParameters;
use crate::simulate::Noise;
use clap::{Args, ValueEnum, value_parser};
use magcomp::Method;
use magcomp_replay::command::{Common, NormalisationChoice, ResidualChoice, between, finite};
use magcomp_replay::error::RunError;
use magcomp_replay::report::Report;

/// The device's disturbance steps while it turns, and the methods follow.
///
/// --motion uniform: the paper's figs. 4 and 5 (also planar, stroll and still), with the true parameters of --set or one's own. --motion tumble and walk: the aided method
/// beside the paper's, with the gyroscope and accelerometer that belong to the motion. --method adaptive: the magnetometer
/// alone, on the scenario that belongs to the motion (30 dB uniform, 40 dB others) or on the one named.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Step {
    /// Runs to average; 60 for figs. 4 and 5, 20 for tumble and walk when not given
    #[arg(long, value_parser = value_parser!(u32).range(1..))]
    runs: Option<u32>,
    /// How the device turns
    #[arg(long, value_enum, default_value_t)]
    motion: Motion,
    /// Signal-to-noise ratio, dB; 30 for figs. 4 and 5, 40 for tumble and walk when not given
    #[arg(long, value_parser = finite)]
    snr: Option<f64>,
    // of figs. 4 and 5, as all that follows up to --sigma-th
    #[command(flatten)]
    truth: TrueParameters,
    /// Figs. 4 and 5: the residual that the fits minimise; corrected when not given
    #[arg(long, value_enum)]
    residual: Option<ResidualChoice>,
    /// Figs. 4 and 5: all nine parameters step by this factor; 1.5 when not given
    #[arg(long, value_parser = |text: &str| between(text, 0.1, 10.0))]
    factor: Option<f64>,
    /// Figs. 4 and 5: how sigma_T is normalised; both, a column each, when not given
    #[arg(long, value_enum)]
    normalisation: Option<NormalisationChoice>,
    /// Figs. 4 and 5: smallest window N_min, samples; 100 when not given
    #[arg(long, value_name = "N")]
    n_min: Option<usize>,
    /// Figs. 4 and 5: largest window N_max, samples; 2000 when not given
    #[arg(long, value_name = "N")]
    n_max: Option<usize>,
    /// Figs. 4 and 5: threshold of sigma_T; 0.1 when not given
    #[arg(long, value_name = "SIGMA_T", value_parser = |text: &str| between(text, 0.0, 10.0))]
    sigma_th: Option<f64>,
    /// Tumble, walk: the change; parameters for tumble and offset for walk when not given
    #[arg(long, value_enum)]
    change: Option<PhoneChange>,
    /// Tumble, walk: samples per second of every sensor; 100 when not given
    #[arg(long, value_name = "HZ", value_parser = |text: &str| between(text, 25.0, 400.0))]
    rate: Option<f64>,
    /// Tumble, walk: gyroscope bias, deg/s, in a random direction
    #[arg(long, value_name = "DEG_S", value_parser = |text: &str| between(text, 0.0, 20.0))]
    gyro_bias: Option<f64>,
    /// Tumble, walk: error of the gyroscope's scale, percent
    #[arg(long, value_name = "PERCENT", allow_negative_numbers = true, value_parser = |text: &str| between(text, -20.0, 20.0))]
    gyro_scale: Option<f64>,
    /// Tumble, walk: how late the gyroscope's events are stamped, ms
    #[arg(long, value_name = "MS", allow_negative_numbers = true, value_parser = |text: &str| between(text, -100.0, 100.0))]
    gyro_late: Option<f64>,
    /// Tumble, walk: how far each axis of the gyroscope is off along each axis, degrees rms: errors drawn for each run
    #[arg(long, value_name = "DEG", value_parser = |text: &str| between(text, 0.0, 5.0))]
    gyro_skew: Option<f64>,
    /// Tumble, walk: samples hit by a spike of 30 to 150 uT, percent
    #[arg(long, value_name = "PERCENT", value_parser = |text: &str| between(text, 0.0, 50.0))]
    spikes: Option<f64>,
    /// Which methods; those that belong to the motion when not given
    #[arg(long, value_enum)]
    method: Option<StepMethod>,
    /// Adaptive: a variant of the catalogue, instead of the one that belongs to the motion
    #[arg(long, value_name = "VARIANT", requires = "method", conflicts_with = "motion", value_parser = |name: &str| find(name).map(Box::new))]
    scenario: Option<Box<Variant>>,
    #[command(flatten)]
    common: Common,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum StepMethod {
    /// From the magnetometer alone
    Adaptive,
}

impl Step {
    pub fn run(self) -> Result<(), RunError> {
        let adaptive = self.method == Some(StepMethod::Adaptive);
        let of_figures = [
            ("--set", self.truth.set.is_some()),
            ("--soft-iron", self.truth.soft_iron.is_some()),
            ("--hard-iron", self.truth.hard_iron.is_some()),
            ("--scale", self.truth.scale.is_some()),
            ("--axes", self.truth.axes.is_some()),
            ("--offset", self.truth.offset.is_some()),
            ("--residual", self.residual.is_some()),
            ("--factor", self.factor.is_some()),
            ("--normalisation", self.normalisation.is_some()),
            ("--n-min", self.n_min.is_some()),
            ("--n-max", self.n_max.is_some()),
            ("--sigma-th", self.sigma_th.is_some()),
        ];
        let of_phones = [
            ("--change", self.change.is_some()),
            ("--rate", self.rate.is_some()),
            ("--gyro-bias", self.gyro_bias.is_some()),
            ("--gyro-scale", self.gyro_scale.is_some()),
            ("--gyro-late", self.gyro_late.is_some()),
            ("--gyro-skew", self.gyro_skew.is_some()),
            ("--spikes", self.spikes.is_some()),
        ];
        let phone = FollowOptions::of(self.motion).filter(|_| !adaptive);
        let strange = of_figures.iter().filter(|_| adaptive || phone.is_some());
        let strange = strange.chain(of_phones.iter().filter(|_| phone.is_none()));
        let given: Vec<&str> = strange.filter(|(_, given)| *given).map(|(name, _)| *name).collect();
        if !given.is_empty() {
            let why = "no such choice with this --motion and --method (see --help)";
            return Err(RunError::Usage(format!("{}: {why}", given.join(", "))));
        }
        match phone {
            Some(options) => self.aided(options),
            None if adaptive => self.adaptive(),
            None => self.windowed(),
        }
    }

    fn adaptive(self) -> Result<(), RunError> {
        let of_motion = match self.motion {
            Motion::Tumble => "phone-hand",
            Motion::Walk => "phone-walk-known",
            Motion::Stroll => "step-walk",
            Motion::Planar => "phone-planar",
            Motion::Still => "phone-still",
            _ => "step",
        };
        let variant = match self.scenario {
            Some(variant) => *variant,
            None => find(of_motion).map_err(RunError::Usage)?.in_an_even_place(),
        };
        Self::follow(
            &self.common,
            FollowOptions {
                variant: variant.with_noise(self.snr.map(Noise::SnrDb)),
                methods: vec![Method::Adaptive],
                runs: self.runs.map_or(50, |runs| runs as usize),
                seed: self.common.seed,
            },
        )
    }

    fn aided(self, options: FollowOptions) -> Result<(), RunError> {
        let mut variant =
            self.change.map_or(options.variant, |change| phone("step", self.motion, change).in_an_even_place());
        let exactly = |deg_s: f64| (deg_s, deg_s);
        // an even distribution of the same root mean square as was asked for
        let lean_deg = self.gyro_skew.unwrap_or(0.0) * 3f64.sqrt();
        variant.sensors = Sensors {
            gyro_bias_deg_s: exactly(self.gyro_bias.unwrap_or(0.0)),
            gyro_scale: self.gyro_scale.unwrap_or(0.0) / 100.0,
            gyro_late_s: self.gyro_late.unwrap_or(0.0) / 1000.0,
            gyro_lean_deg: lean_deg,
            gyro_axis_scale: lean_deg.to_radians(),
            ..variant.sensors.at_rate(self.rate.unwrap_or(100.0))
        };
        let variant = variant.with_noise(self.snr.map(Noise::SnrDb)).with_spikes(self.spikes.unwrap_or(0.0) / 100.0);
        let runs = self.runs.map_or(options.runs, |runs| runs as usize);
        Self::follow(&self.common, FollowOptions { variant, runs, seed: self.common.seed, ..options })
    }

    fn follow(common: &Common, options: FollowOptions) -> Result<(), RunError> {
        let result = follow::run(&options)?;
        common.finish(&result.tables(), &result, || {
            let lead = "Something changes for a simulated phone. Below the tables: the first method in the first run.";
            Report::new("Following a change", lead).with(|report| result.add_to(report, "step_first_run"))
        })
    }

    fn windowed(self) -> Result<(), RunError> {
        let defaults = StepOptions::default();
        let options = StepOptions {
            truth: self.truth,
            motion: self.motion,
            snr_db: self.snr.unwrap_or(defaults.snr_db),
            residual: self.residual.unwrap_or_default(),
            factor: self.factor.unwrap_or(defaults.factor),
            normalisations: self.normalisation.map_or(defaults.normalisations, |choice| vec![choice.into()]),
            n_min: self.n_min.unwrap_or(defaults.n_min),
            n_max: self.n_max.unwrap_or(defaults.n_max),
            sigma_th: self.sigma_th.unwrap_or(defaults.sigma_th),
            runs: self.runs.map_or(defaults.runs, |runs| runs as usize),
            seed: self.common.seed,
        };
        let result = run(&options)?;
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
