//! Sessions that phone loggers recorded, made into recordings: each sensor keeps its own times and rates, nothing is resampled.
//!
//! The readers follow the loggers' documentation and were tried on files written by hand after it; that of Sensor Logger
//! also on an iPhone's real session. Parquet, Arrow and ROS 2 were tried on files that other people's writers made
//! (`tests/sessions/make.py`). No real file of the other loggers was at hand.

mod arrow_lengths;
mod columnar;
mod document;
mod gnss_logger;
mod guard;
mod input;
mod matlab;
mod parquet_lengths;
mod phyphox;
mod plain;
mod plausible;
mod ros;
mod sensor_logger;
mod session;
mod sheet;
mod units;

pub use plain::ColumnNames;
pub use session::Sensor;
pub use units::{Frame, Units};

use crate::error::{LabError, Place};
use crate::place::Day;
use crate::recording::{Source, unzipped};
use crate::table::{Table, number};
use clap::Args;
use document::{Document, Documents, documents};
use input::Input;
use serde::Serialize;
use session::Session;
use sheet::Sheet;
use std::io::{self, BufWriter, Read, Write};
use std::path::{Path, PathBuf};

/// Bytes at the beginning of a file that show its form.
const START: u64 = 4096;
/// Rows of a recording that tell its units: at least, and at most.
const FEWEST: usize = 20;
const LOOKED_AT: usize = 5000;
/// The loggers that are accepted, for messages.
const LOGGERS: &str = "Sensor Logger, phyphox, GnssLogger, MATLAB Mobile";

/// How plain CSV, Parquet and Arrow are read; the loggers' own files need none of it.
#[derive(Clone, Debug, Default, PartialEq, Args)]
pub struct ImportOptions {
    /// Plain CSV, Parquet, Arrow: names of the columns, of t, mx,my,mz (field), ax,ay,az, gx,gy,gz, sx,sy,sz (the system's field), qw,qx,qy,qz
    #[arg(long, value_name = "t=NAME,mx=NAME,...")]
    pub columns: Option<ColumnNames>,
    /// Plain CSV, Parquet, Arrow, ROS: units of time (s, ms, us, ns), m field (uT, nT, mT, T, G, mG), g gyroscope (rad/s, deg/s), a accelerometer (m/s2, g; with a minus for Apple's sign)
    #[arg(long, value_name = "t=ns,m=uT,...")]
    pub units: Option<Units>,
    /// Which of the file's axes point right, up along the screen, and out of it
    #[arg(long, value_name = "x,y,z", allow_hyphen_values = true)]
    pub frame: Option<Frame>,
    /// ROS: topics to take, where several have the same sensor
    #[arg(long, value_name = "TOPIC,...", value_delimiter = ',')]
    pub topics: Vec<String>,
}

/// The content of a session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The logger, or plain CSV.
    pub logger: &'static str,
    /// Its sensors.
    pub sensors: Vec<Sensor>,
    /// Notes for the user.
    pub notes: Vec<String>,
    /// Parts that were left out, or may be wrong.
    pub warnings: Vec<String>,
    /// The day of the first event (UTC), where the session says so.
    #[serde(skip)]
    pub day: Option<Day>,
}

impl Summary {
    /// As a table.
    #[must_use]
    pub fn table(&self) -> Table {
        let mut table =
            Table::new(&format!("{} session", self.logger), &["sensor", "events", "rate Hz", "longest pause s"]);
        for sensor in &self.sensors {
            let (rate, pause) = (number(sensor.rate_hz, 1), number(sensor.longest_pause_s, 3));
            table.row(vec![sensor.sensor.to_owned(), sensor.events.to_string(), rate, pause]);
        }
        self.notes.iter().for_each(|note| table.note(note));
        table
    }
}

/// A recording to replay.
#[derive(Debug)]
pub struct Opened {
    /// Its rows.
    pub source: Source,
    /// The content of the session that it was made from; none where the input is a recording already.
    pub session: Option<Summary>,
    /// Parts that were left out, or may be wrong.
    pub warnings: Vec<String>,
    /// The day of its first row (UTC), where its times say so.
    pub day: Option<Day>,
}

/// Opens a recording, or makes a session into one.
///
/// # Errors
/// Those of [`import`] and of [`Source::of`].
pub fn open(inputs: &[PathBuf], options: &ImportOptions) -> Result<Opened, LabError> {
    let found = Input::all(inputs)?;
    if let [input] = &found[..]
        && !is_session(input, options)?
    {
        let mut source = Source::of(&input.path, input.open()?)?;
        let warnings = plausible::check(&beginning(&mut source)?)?;
        let day = Day::of_unix_ns(source.extent().start_ns);
        return Ok(Opened { source, session: None, warnings, day });
    }
    let file = tempfile::tempfile().map_err(LabError::write(Path::new("a temporary file")))?;
    let failed = || LabError::write(Path::new("a temporary file"));
    let copy = file.try_clone().map_err(failed())?;
    let mut out = BufWriter::new(file);
    let summary = import_found(&found, options, |write| write(&mut out).map_err(failed()))?;
    out.flush().map_err(failed())?;
    let (warnings, day) = (summary.warnings.clone(), summary.day);
    Ok(Opened { source: Source::of(&inputs[0], copy)?, session: Some(summary), warnings, day })
}

/// The first rows of a recording, to look at its units; none of a recording that is too short to tell.
fn beginning(source: &mut Source) -> Result<Session, LabError> {
    let mut session = Session::default();
    if source.extent().rows < FEWEST {
        return Ok(session);
    }
    let rows = source.rows()?;
    let [time, raw, up, rate, system] = ["t_s", "mx", "ax", "gx", "sys_mx"].map(|name| rows.first_place(name));
    for row in rows.take(LOOKED_AT) {
        let row = row?;
        session.raw.add(row.time_ns, row.field_ut, || [time.clone(), raw.clone()])?;
        for event in row.inertial() {
            if let Some(value) = event.up_m_s2 {
                session.up.add(event.time_ns, value, || [time.clone(), up.clone()])?;
            }
            if let Some(value) = event.rate_rad_s {
                session.rate.add(event.time_ns, value, || [time.clone(), rate.clone()])?;
            }
        }
        if let Some(value) = row.system_ut {
            session.system.add(row.time_ns, value, || [time.clone(), system.clone()])?;
        }
    }
    Ok(session)
}

/// Whether the input must be imported.
fn is_session(input: &Input, options: &ImportOptions) -> Result<bool, LabError> {
    if input.is_dir || *options != ImportOptions::default() {
        return Ok(true);
    }
    let mut text = Vec::new();
    // a cut gzip shows itself when it is read whole
    let _ = unzipped(input.open()?).map_err(LabError::read(&input.path))?.take(START).read_to_end(&mut text);
    let document = Document { path: input.path.clone(), text };
    let sheet = Sheet::new(&document);
    let header = &sheet.header;
    Ok([b"PK".as_slice(), ros::MCAP].iter().any(|form| document.text.starts_with(form))
        || columnar::is_columnar(&document.text)
        || logger(std::slice::from_ref(&document)).is_some()
        // a recording's own form has commas between cells, plain CSV may have others
        || sheet.has_decimal_commas()
        || !header.iter().any(|name| name == "t_s") && !header.is_empty())
}

#[derive(Clone, Copy)]
enum App {
    SensorLogger,
    Phyphox,
    GnssLogger,
    Matlab,
}

fn logger(documents: &[Document]) -> Option<App> {
    let any = |is: fn(&[String]) -> bool| documents.iter().any(|document| is(&Sheet::new(document).header));
    if documents.iter().any(gnss_logger::is_log) {
        Some(App::GnssLogger)
    } else if any(sensor_logger::is_header) {
        Some(App::SensorLogger)
    } else if any(phyphox::is_header) {
        Some(App::Phyphox)
    } else if any(matlab::is_header) {
        Some(App::Matlab)
    } else {
        None
    }
}

/// Reads a session and writes it as a recording through `write`.
///
/// # Errors
/// [`LabError::Recording`] names file, line, column and what to do; [`LabError::Read`]; [`LabError::Usage`]; those of `write`.
pub fn import(
    inputs: &[PathBuf],
    options: &ImportOptions,
    write: impl FnOnce(&mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<(), LabError>,
) -> Result<Summary, LabError> {
    import_found(&Input::all(inputs)?, options, write)
}

fn import_found(
    inputs: &[Input],
    options: &ImportOptions,
    write: impl FnOnce(&mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<(), LabError>,
) -> Result<Summary, LabError> {
    let units = options.units.unwrap_or_default();
    let paths: Vec<PathBuf> = inputs.iter().map(|input| input.path.clone()).collect();
    let bags = ros::bags(inputs)?;
    if !bags.is_empty() {
        let session = ros::read(bags, &options.topics, &units)?;
        return finish("ROS 2", session, &paths, options, write);
    }
    let Documents { read: documents, unreadable } = documents(inputs)?;
    let found = if options.columns.is_some() { None } else { logger(&documents) };
    if found.is_some() && (units.time_ns.is_some() || units.field.is_some() || units.rate.is_some()) {
        let why = "the units of a logger's files are known; only a=... can be given, for the sign of the accelerometer";
        return Err(LabError::Usage(format!("--units: {why}")));
    }
    if matches!(found, Some(App::SensorLogger | App::Phyphox | App::Matlab)) {
        refuse_twice(&documents)?;
    }
    let (name, mut session) = match found {
        Some(App::SensorLogger) => ("Sensor Logger", sensor_logger::read(&documents, &units)?),
        Some(App::Phyphox) => ("phyphox", phyphox::read(&documents)?),
        Some(App::GnssLogger) => ("GnssLogger", gnss_logger::read(&documents)?),
        Some(App::Matlab) => ("MATLAB Mobile", matlab::read(&documents)?),
        None => ("plain CSV", plain_session(&documents, options, &units)?),
    };
    for why in unreadable {
        if session.raw.events.is_empty() {
            return Err(why);
        }
        session.leave_out("unreadable", why);
    }
    finish(name, session, &paths, options, write)
}

/// Puts a session in order and writes it.
fn finish(
    name: &'static str,
    mut session: Session,
    inputs: &[PathBuf],
    options: &ImportOptions,
    write: impl FnOnce(&mut dyn FnMut(&mut dyn Write) -> io::Result<()>) -> Result<(), LabError>,
) -> Result<Summary, LabError> {
    session.require_magnetometer(name, inputs)?;
    session.sort(&options.frame.unwrap_or_default());
    let more = plausible::check(&session)?;
    session.warnings.extend(more);
    let day = session.begun_unix_ns().and_then(Day::of_unix_ns);
    let mut counted = false;
    write(&mut |out| {
        counted = session.write(out)?;
        Ok(())
    })?;
    if counted {
        session.notes.push("times count from the first event".to_owned());
    }
    let sensors = session.sensors();
    Ok(Summary { logger: name, sensors, notes: session.notes, warnings: session.warnings, day })
}

/// Refuses two files of one sensor: they are of two sessions, or one file named twice.
fn refuse_twice(documents: &[Document]) -> Result<(), LabError> {
    let twice = documents.iter().enumerate().find_map(|(k, document)| {
        let same = |before: &&Document| before.stem() == document.stem() && !before.text.is_empty();
        let before = documents[..k].iter().find(same).filter(|_| !document.text.is_empty())?;
        Some((before.path.display(), document.path.display()))
    });
    let Some((first, second)) = twice else { return Ok(()) };
    Err(LabError::Usage(format!("{first} and {second} are of the same sensor; import one session at a time")))
}

fn plain_session(documents: &[Document], options: &ImportOptions, units: &Units) -> Result<Session, LabError> {
    let names = options.columns.clone().unwrap_or_default();
    let Some(first) = documents.iter().find(|document| !Sheet::new(document).header.is_empty()) else {
        return Err(LabError::Empty { path: documents[0].path.clone(), what: "nothing in it" });
    };
    let known = |document: &Document| plain::is_header(&Sheet::new(document).header, &names);
    if options.columns.is_none() && !documents.iter().any(known) {
        return Err(LabError::Recording {
            place: Place { path: first.path.clone(), line: 1, column: None },
            expected: format!(
                "a header of {LOGGERS}, or a recording's t_s,mx,my,mz; other names by --columns t=NAME,mx=NAME,my=NAME,mz=NAME"
            ),
            found: Sheet::new(first).shown(),
        });
    }
    plain::read(documents, &names, units)
}
