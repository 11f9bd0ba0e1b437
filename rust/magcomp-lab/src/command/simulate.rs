//! `magcomp simulate`.

use super::common::SEED;
use crate::course::{Course, DevicePart};
use crate::inertial::InertialSensor;
use crate::motion::Motion;
use crate::parameters::{Numbers, ParameterSet, TrueParameters};
use crate::random::{Purpose, Random};
use crate::simulate::{Magnetometer, Noise, Scenario, Simulation, Spikes, world_field_ut};
use crate::surroundings::Surrounding;
use clap::{Args, ValueEnum};
use magcomp::nalgebra::Vector3;
use magcomp_recordings::recording::write_recording;
use magcomp_replay::atomic::write_atomically;
use magcomp_replay::command::{Common, between, finite, refuse_outputs};
use magcomp_replay::error::RunError;
use magcomp_replay::plot::{Colour, Panel, Series, draw};
use magcomp_replay::report::Report;
use magcomp_replay::table::Table;
use serde::Serialize;
use std::path::PathBuf;

/// Write a simulated recording with its reference orientation.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Simulate {
    /// The recording to write; gzipped when the name ends in .gz
    #[arg(value_name = "OUT.csv")]
    output: PathBuf,
    /// Length, s, at most an hour
    #[arg(long, default_value_t = 60.0, value_parser = |text: &str| between(text, 0.1, 3600.0))]
    seconds: f64,
    /// Samples per second of every sensor
    #[arg(long, default_value_t = 100.0, value_parser = |text: &str| between(text, 1.0, 1000.0))]
    rate: f64,
    /// How the device turns
    #[arg(long, value_enum, default_value_t = Motion::Tumble)]
    motion: Motion,
    /// Field of the place: strength in uT and dip in degrees
    #[arg(long, value_name = "UT,DIP", default_value = "50,60", allow_hyphen_values = true)]
    field: Numbers<2>,
    /// The place's field becomes this at --at, over --over
    #[arg(long, value_name = "UT,DIP", allow_hyphen_values = true)]
    field_to: Option<Numbers<2>>,
    // before any change
    #[command(flatten)]
    truth: TrueParameters,
    /// How the parameters of the device change
    #[arg(long, value_enum, default_value_t)]
    change: ChangeKind,
    /// When they begin to change, s; the period of repeated steps; half of the length when not given
    #[arg(long, value_parser = |text: &str| between(text, 0.001, 3600.0))]
    at: Option<f64>,
    /// How long a ramp or a pulse takes, s
    #[arg(long, default_value_t = 10.0, value_parser = positive)]
    over: f64,
    /// All nine parameters change by this factor
    #[arg(long, default_value_t = 1.5, value_parser = positive)]
    factor: f64,
    /// Noise of the magnetometer per axis, dB below the field
    #[arg(long, default_value_t = 40.0, conflicts_with = "noise_ut", value_parser = finite)]
    snr: f64,
    /// Noise of the magnetometer per axis, uT
    #[arg(long, value_parser = |text: &str| between(text, 0.0, 1000.0))]
    noise_ut: Option<f64>,
    /// Share of samples hit by a spike of 30 to 150 uT, 0 to 1
    #[arg(long, default_value_t = 0.0, value_parser = |text: &str| between(text, 0.0, 1.0))]
    spikes: f64,
    /// Gyroscope bias, rad/s
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true)]
    gyro_bias: Numbers<3>,
    /// Gyroscope noise per axis, rad/s
    #[arg(long, default_value_t = 0.003, value_parser = |text: &str| between(text, 0.0, 10.0))]
    gyro_noise: f64,
    /// How late the gyroscope's events are stamped, s
    #[arg(long, default_value_t = 0.0, value_parser = finite, allow_negative_numbers = true)]
    gyro_delay: f64,
    /// Accelerometer bias, m/s^2
    #[arg(long, value_name = "X,Y,Z", default_value = "0,0,0", allow_hyphen_values = true)]
    accel_bias: Numbers<3>,
    /// Accelerometer noise per axis, m/s^2
    #[arg(long, default_value_t = 0.05, value_parser = |text: &str| between(text, 0.0, 100.0))]
    accel_noise: f64,
    #[arg(long, default_value_t = 1, help = SEED)]
    seed: u64,
    #[command(flatten)]
    common: Common,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum ChangeKind {
    /// Not at all
    #[default]
    None,
    /// At once
    Step,
    /// Slowly, over --over
    Ramp,
    /// There and back every --at seconds
    Repeated,
    /// For --over seconds only
    Pulse,
}

/// What was written.
#[derive(Serialize)]
struct Summary {
    output: String,
    rows: usize,
    seconds: f64,
    noise_ut: f64,
    spikes: usize,
}

impl Simulate {
    pub fn run(self) -> Result<(), RunError> {
        refuse_outputs(&[], &[("OUT.csv", &self.output)], self.common.report.as_deref())?;
        let scenario = self.scenario()?;
        let stream = scenario.run();
        write_atomically(&self.output, |out| write_recording(out, &stream.recording("simulated")))?;
        let summary = Summary {
            output: self.output.display().to_string(),
            rows: stream.magnetic.len(),
            seconds: self.seconds,
            noise_ut: scenario.magnetometer.noise.sigma_ut(scenario.earth_ut.norm()),
            spikes: stream.truth.iter().filter(|truth| truth.spike).count(),
        };
        let mut table = Table::new("simulated recording", &["file", "rows", "seconds", "noise uT", "spikes"]);
        table.row(vec![
            summary.output.clone(),
            summary.rows.to_string(),
            format!("{}", summary.seconds),
            format!("{:.3}", summary.noise_ut),
            summary.spikes.to_string(),
        ]);
        self.common.finish(std::slice::from_ref(&table), &summary, || {
            let mut report =
                Report::new("A simulated recording", "What the sensor reads, and the hard iron that is in it.");
            report.figure(
                "simulated",
                draw(&panels(&stream), 1, (1100, 260))?,
                "Raw field and true hard iron over time.",
            );
            report.table(&table);
            Ok(report)
        })
    }

    fn scenario(&self) -> Result<Scenario, RunError> {
        let at_s = self.at.unwrap_or(self.seconds / 2.0);
        let start = self.truth.parameters(ParameterSet::Mid)?;
        let changed = start.times(self.factor);
        let world = |numbers: Numbers<2>| world_field_ut(numbers.0[0], numbers.0[1]);
        let earth_ut = world(self.field);
        let held = |at_s, over_s, until_s| Course::Held { at_s, over_s, until_s };
        let courses = match self.change {
            ChangeKind::None => Vec::new(),
            ChangeKind::Step => vec![Course::step(at_s)],
            ChangeKind::Ramp => vec![Course::Even { from_s: at_s, over_s: self.over }],
            ChangeKind::Pulse => vec![held(at_s, 0.0, Some(at_s + self.over))],
            ChangeKind::Repeated => {
                let there = (0..).map(|k| (2 * k + 1) as f64 * at_s).take_while(|from_s| *from_s < self.seconds);
                there.map(|from_s| held(from_s, 0.0, Some(from_s + at_s))).collect()
            }
        };
        let part = |course| DevicePart::between(course, &start, &changed, earth_ut.norm());
        let surroundings = self.field_to.map(|to| Surrounding::Shift {
            course: Course::Even { from_s: at_s, over_s: self.over },
            field_ut: world(to) - earth_ut,
        });
        let spikes = (self.spikes > 0.0).then_some(Spikes { share: self.spikes, size_ut: (30.0, 150.0) });
        let noise = self.noise_ut.map_or(Noise::SnrDb(self.snr), Noise::Ut);
        let mut random = Random::new(self.seed, Purpose::Motion);
        Ok(Scenario {
            seed: self.seed,
            duration_s: self.seconds,
            trajectory: self.motion.trajectory(self.seconds, 1.0 / self.rate, &mut random),
            earth_ut,
            surroundings: surroundings.into_iter().collect(),
            device: start,
            device_parts: courses.into_iter().map(part).collect(),
            other_changes: Vec::new(),
            pause_s: None,
            magnetometer: Magnetometer { spikes, ..Magnetometer::plain(self.rate, noise) },
            // from one random attitude to the next no gyroscope follows
            gyroscope: (self.motion != Motion::Uniform).then(|| InertialSensor {
                rate_hz: self.rate,
                noise: self.gyro_noise,
                bias: self.gyro_bias.vector(),
                delay_s: self.gyro_delay,
                ..InertialSensor::gyroscope()
            }),
            accelerometer: Some(InertialSensor {
                rate_hz: self.rate,
                noise: self.accel_noise,
                bias: self.accel_bias.vector(),
                ..InertialSensor::accelerometer()
            }),
        })
    }
}

fn panels(stream: &Simulation) -> [Panel; 2] {
    let axes = [("x", Colour::Blue), ("y", Colour::Orange), ("z", Colour::Green)];
    let panel = |title: &str, value: &dyn Fn(usize) -> Vector3<f64>| {
        let line = |(i, (name, colour)): (usize, &(&str, Colour))| {
            let time_s = |k: usize| stream.magnetic[k].time_ns as f64 / 1e9;
            Series::new(name, *colour, (0..stream.magnetic.len()).map(|k| (time_s(k), value(k)[i])))
        };
        Panel::new(title, "time, s", "uT", axes.iter().enumerate().map(line))
    };
    [panel("raw field", &|k| stream.magnetic[k].field_ut), panel("true hard iron", &|k| stream.truth[k].hard_iron_ut)]
}

fn positive(text: &str) -> Result<f64, String> {
    finite(text).ok().filter(|v| *v > 0.0).ok_or_else(|| "expected a number above 0".to_owned())
}
