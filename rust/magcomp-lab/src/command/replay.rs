//! `magcomp replay`.

use super::{Common, between};
use crate::error::LabError;
use crate::place::{Day, GeoPoint, declination_deg};
use crate::recording;
use crate::replay::{Ignore, Judgement, figures, judge, judge_legs, read_waypoints, replay, table, usual_part, write};
use crate::report::Report;
use clap::{Args, ValueEnum};
use magcomp::{Config, HeadingConfig, Method, ReferenceAxis};
use std::path::PathBuf;

/// Run a recording through the compensator, one row out for every row in.
///
/// IN is CSV, gzipped or not, with a header: t_s,mx,my,mz[,ax,ay,az][,gx,gy,gz][,qw,qx,qy,qz] (s; uT; m/s^2, Android's
/// sign; rad/s; reference orientation, device to east-north-up). Other columns are ignored. Out: the corrected sample c, the
/// estimator's own estimate f, the heading, and the parameters in force; until there is a calibration c is empty, b = 0, W = 1.
#[derive(Debug, Args)]
pub(super) struct Replay {
    /// The recording
    #[arg(value_name = "IN")]
    input: PathBuf,
    /// How M and b are estimated
    #[arg(long, value_enum, default_value_t)]
    method: MethodChoice,
    /// Sensors of the recording to leave out
    #[arg(long, value_enum, value_delimiter = ',')]
    ignore: Vec<Sensor>,
    /// Where one row for every input row is written; without it only the summary is printed
    #[arg(long, value_name = "OUT.csv")]
    output: Option<PathBuf>,
    /// The axis whose heading it is
    #[arg(long, value_enum, default_value_t)]
    axis: AxisChoice,
    /// Declination, degrees, east positive: adds the column true_heading_deg
    #[arg(long, value_name = "DEG", value_parser = |text: &str| between(text, -180.0, 180.0), allow_negative_numbers = true, conflicts_with_all = ["place", "date"])]
    declination: Option<f64>,
    /// Take the declination of this place (degrees, north and east positive; metres) from the world magnetic model
    #[arg(long, value_name = "LAT,LON[,HEIGHT_M]", requires = "date", allow_hyphen_values = true)]
    place: Option<GeoPoint>,
    /// The date for --place
    #[arg(long, value_name = "YYYY-MM-DD", requires = "place")]
    date: Option<Day>,
    /// Count rows from here on in the figures, s after the first row; 20 s, or half of a shorter recording, when not given
    #[arg(long, value_name = "S", value_parser = |text: &str| between(text, 0.0, 1e9))]
    from: Option<f64>,
    /// Count rows up to here
    #[arg(long, value_name = "S", value_parser = |text: &str| between(text, 0.0, 1e9))]
    to: Option<f64>,
    /// Judge the heading by the legs between surveyed positions: CSV t_s,x_m,y_m (s; m, x right and y up on the map)
    #[arg(long, value_name = "CSV")]
    waypoints: Option<PathBuf>,
    /// Play it so many times; of each row the least time counts, which other work on the machine does not lengthen
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u32).range(1..=1000))]
    passes: u32,
    #[command(flatten)]
    common: Common,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum MethodChoice {
    /// The best that the recording's sensors allow
    #[default]
    Auto,
    /// Gyroscope and gravity beside the magnetometer
    Aided,
    /// The magnetometer alone, changes noticed by themselves
    Adaptive,
    /// The paper's: an ellipsoid over the latest N samples
    Windowed,
    /// The paper's first step alone: one calibration, then kept
    Constant,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Sensor {
    /// Gyroscope
    Gyro,
    /// Accelerometer
    Accel,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
enum AxisChoice {
    /// Top edge of the screen
    #[default]
    Top,
    /// Back camera
    Camera,
    /// The horizontal direction between both
    Auto,
}

impl MethodChoice {
    fn method(self) -> Method {
        match self {
            Self::Auto => Method::Auto,
            Self::Adaptive => Method::Adaptive,
            Self::Windowed => Method::Windowed,
            Self::Constant => Method::Constant,
            Self::Aided => Method::Aided,
        }
    }
}

impl Replay {
    pub fn run(self) -> Result<(), LabError> {
        let method = self.method.method();
        let declination_deg = match (self.declination, self.place, self.date) {
            (None, Some(place), Some(day)) => Some(declination_deg(place, day)?),
            (given, ..) => given,
        };
        let axis = match self.axis {
            AxisChoice::Top => ReferenceAxis::TopEdge,
            AxisChoice::Camera => ReferenceAxis::Camera,
            AxisChoice::Auto => ReferenceAxis::Auto,
        };
        let heading = HeadingConfig { axis, declination_deg, ..HeadingConfig::default() };
        let config = Config { method, heading, ..Config::default() };
        config.validate()?;
        let ignore = Ignore {
            gyroscope: self.ignore.contains(&Sensor::Gyro),
            accelerometer: self.ignore.contains(&Sensor::Accel),
        };

        let recording = recording::read(&self.input)?;
        let usual = usual_part(&recording);
        let part = self.from.unwrap_or(usual.start)..self.to.unwrap_or(usual.end);
        let end_s = recording.duration_s();
        if part.start >= part.end.min(end_s) && end_s > 0.0 {
            let to = self.to.map_or_else(String::new, |to| format!(" and --to {to}"));
            let why = format!("leave no row to count: the recording lasts {end_s:.1} s");
            return Err(LabError::Usage(format!("--from {}{to} {why}", part.start)));
        }
        let mut steps = replay(&recording, &config, ignore)?;
        for _ in 1..self.passes {
            for (step, again) in steps.iter_mut().zip(replay(&recording, &config, ignore)?) {
                step.push_ns = step.push_ns.min(again.push_ns);
            }
        }
        if let Some(output) = &self.output {
            write(output, &recording, &steps, declination_deg.is_some())?;
        }
        let waypoints = self.waypoints.as_deref().map(read_waypoints).transpose()?;
        let legs = waypoints.and_then(|waypoints| judge_legs(&recording, &steps, &waypoints));
        let judgement = Judgement { legs, ..judge(&recording, &steps, part, axis) };
        let name = self.method.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned());
        let mut table = table(&recording, &name, &judgement);
        if let Some(last) = steps.last().filter(|_| judgement.answered == 0.0) {
            table.note(&format!("no row was answered; the last one says: {}", last.reading.status));
        }
        self.common.finish(std::slice::from_ref(&table), &judgement, || {
            let mut report = Report::new(
                &format!("{} replayed", recording.name()),
                "Every sample went through the compensator in order; nothing later than a sample went into its answer.",
            );
            figures(&mut report, "replay", &recording, &steps)?;
            report.table(&table);
            Ok(report)
        })
    }
}
