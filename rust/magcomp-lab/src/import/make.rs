//! A session of any logger, read and written as a recording.

use super::document::{Document, Documents, documents};
use super::forms::bags;
use super::input::Input;
use super::options::ImportOptions;
use super::ros::read_bags;
use super::session::Session;
use super::sheet::Sheet;
use super::summary::Summary;
use super::units::Units;
use super::{gnss_logger, matlab, phyphox, plain, plausible, sensor_logger};
use crate::error::{LabError, Place};
use crate::place::Day;
use std::io::{self, Write};
use std::path::PathBuf;

/// The loggers that are accepted, for messages.
const LOGGERS: &str = "Sensor Logger, phyphox, GnssLogger, MATLAB Mobile";

/// Where a recording goes.
type Out<'a> = &'a mut dyn FnMut(&mut dyn Write) -> io::Result<()>;

#[derive(Clone, Copy)]
pub(super) enum App {
    SensorLogger,
    Phyphox,
    GnssLogger,
    Matlab,
}

pub(super) fn logger(documents: &[Document]) -> Option<App> {
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
    write: impl FnOnce(Out<'_>) -> Result<(), LabError>,
) -> Result<Summary, LabError> {
    import_found(&Input::all(inputs)?, options, write)
}

pub(super) fn import_found(
    inputs: &[Input],
    options: &ImportOptions,
    write: impl FnOnce(Out<'_>) -> Result<(), LabError>,
) -> Result<Summary, LabError> {
    let units = options.units.unwrap_or_default();
    let paths: Vec<PathBuf> = inputs.iter().map(|input| input.path.clone()).collect();
    let bags = bags(inputs)?;
    if !bags.is_empty() {
        let session = read_bags(bags, &options.topics, &units)?;
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
    write: impl FnOnce(Out<'_>) -> Result<(), LabError>,
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
