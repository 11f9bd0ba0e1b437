//! `magcomp import`.

use super::common::{Common, input, output, refuse_outputs, warn, warn_of};
use crate::atomic::write_atomically;
use crate::error::RunError;
use crate::report::Report;
use crate::session_table;
use clap::Args;
use magcomp_recordings::import::{ColumnNames, Frames, ImportOptions, Shifts, Units, import};
use std::path::{Path, PathBuf};

/// Make a phone logger's session into a recording; `replay` takes the same inputs.
///
/// IN is a zip, a folder, or CSV files of Sensor Logger, phyphox, GnssLogger (and loggers of its form), GetSensorData, MATLAB Mobile, AndroSensor or
/// SensorLog, lines that begin with a time and the name of their sensor, or plain CSV whose columns are named in words or by --columns; with the feature formats (cargo install --path rust/magcomp-lab --features formats) also a bag of
/// ROS 2 (mcap), Parquet or Arrow (a file, Feather 2, or a stream). Each sensor keeps its own times and rate: a row leaves the cells of
/// the others empty. The field that the operating system calibrated is kept as sys_mx,sys_my,sys_mz.
#[derive(Debug, Args)]
pub struct Import {
    /// The session: a zip, a folder, or its files
    #[arg(value_name = "IN", required = true, value_parser = input)]
    inputs: Vec<PathBuf>,
    /// The recording to write; gzipped when the name ends in .gz
    #[arg(short, long, value_name = "OUT.csv.gz", value_parser = output)]
    output: PathBuf,
    #[command(flatten)]
    options: ImportArguments,
    #[command(flatten)]
    common: Common,
}

impl Import {
    /// Runs the verb.
    pub fn run(self) -> Result<(), RunError> {
        let inputs: Vec<&Path> = self.inputs.iter().map(PathBuf::as_path).collect();
        refuse_outputs(&inputs, &[("--output", &self.output)], self.common.report.as_deref())?;
        let (events, summary) = import(&self.inputs, &self.options.into())?;
        write_atomically(&self.output, |out| events.write(out))?;
        warn(&summary.warnings);
        warn_of(&summary.conventions);
        let table = session_table(&summary);
        self.common.finish_beside(Some(&self.output), std::slice::from_ref(&table), &summary, || {
            let mut report = Report::new("A session imported", "What the logger recorded.");
            report.table(&table);
            summary.warnings.iter().for_each(|warning| report.section("Warning", warning));
            let findings = &summary.conventions.findings;
            findings.iter().for_each(|finding| report.section("Conventions", &finding.text));
            Ok(report)
        })
    }
}

/// How plain CSV, Parquet and Arrow are read; the loggers' own files need none of it.
#[derive(Clone, Debug, Args)]
pub struct ImportArguments {
    /// Plain CSV, Parquet, Arrow: names of the columns, of t, mx,my,mz (field), ax,ay,az, gx,gy,gz, sx,sy,sz (the system's field), qw,qx,qy,qz
    ///
    /// `#4` is the fourth column, for a file without header; `t=secs+1e-9*nsecs` a time in two columns. A time may also be a date, such as
    /// 2026-11-22T10:11:12.345Z. Names behind `FILE:` are of that file, until another one is named: t=time,mx=x,my=y,mz=z,turn.csv:gx=x,gy=y,gz=z. Units
    /// in the names, or in a row below them, are read.
    #[arg(long, value_name = "t=NAME,mx=NAME,...")]
    columns: Option<ColumnNames>,
    /// Plain CSV, Parquet, Arrow, ROS: units of time (s, ms, us, ns), m field (uT, nT, mT, T, G, mG), g gyroscope (rad/s, deg/s), a accelerometer (m/s2, g; with a minus for Apple's sign); or numbers: how many s, uT, rad/s, m/s2 a unit is
    #[arg(long, value_name = "t=ns,m=uT,...", allow_hyphen_values = true)]
    units: Option<Units>,
    /// Which of the file's axes point right, up along the screen, and out of it; of one sensor alone by m=, a= or g= (m=-x,y,z;g=y,-x,z); degrees behind them where it is askew (m=x,y,z,-12)
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true)]
    frame: Option<Frames>,
    /// Seconds that are added to the times of a sensor (m field, a accelerometer, g gyroscope), where its clock is another or its times are late
    #[arg(long, value_name = "m=-0.03,...")]
    shift: Option<Shifts>,
    /// Plain CSV without times: so many rows a second
    #[arg(long, value_name = "HZ", value_parser = rate)]
    rate: Option<f64>,
    /// Lines at the beginning of each text file that are passed over
    #[arg(long, value_name = "N", default_value_t = 0)]
    skip: u64,
    /// Which of several sessions that follow one another in one file, counted from 1
    #[arg(long, value_name = "N", value_parser = session)]
    session: Option<usize>,
    /// Take what is left of a sensor, even where most of its events are lost
    #[arg(long)]
    force: bool,
    /// ROS: topics to take, where several have the same sensor
    #[arg(long, value_name = "TOPIC,...", value_delimiter = ',')]
    topics: Vec<String>,
}

impl From<ImportArguments> for ImportOptions {
    fn from(given: ImportArguments) -> Self {
        let ImportArguments { columns, units, frame, shift, rate, skip, session, force, topics } = given;
        Self { columns, units, frame, shift, rate, skip, session, force, topics }
    }
}

fn rate(text: &str) -> Result<f64, String> {
    let rate = text.parse().ok().filter(|rate: &f64| (0.01..=100_000.0).contains(rate));
    rate.ok_or_else(|| "expected rows a second, 0.01 to 100000".to_owned())
}

fn session(text: &str) -> Result<usize, String> {
    text.parse().ok().filter(|number| *number > 0).ok_or_else(|| "expected a number from 1".to_owned())
}
