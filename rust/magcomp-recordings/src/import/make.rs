//! A session of any logger, read as the events of its sensors.

use super::document::{Document, Documents, documents};
use super::forms::bags;
use super::input::Input;
use super::options::ImportOptions;
use super::ros::read_bags;
use super::session::{Session, Summary};
use super::sheet::{Sheet, header_of};
use super::{gnss_logger, ipin, matlab, names, phyphox, plain, plausible, sensor_logger, typed};
use crate::error::{Place, RecordingError};
use crate::place::Day;
use crate::recording::{Events, name_of};
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// The loggers that are accepted, for messages.
const LOGGERS: &str = "Sensor Logger, phyphox, GnssLogger, GetSensorData, MATLAB Mobile, AndroSensor, SensorLog";

#[derive(Clone, Copy)]
pub(super) enum App {
    SensorLogger,
    Phyphox,
    GnssLogger,
    Ipin,
    Typed,
    Matlab,
}

pub(super) fn logger(documents: &[Document]) -> Option<App> {
    let any = |is: fn(&[String]) -> bool| documents.iter().any(|document| is(&Sheet::new(document).header));
    if documents.iter().any(gnss_logger::is_log) {
        Some(App::GnssLogger)
    } else if documents.iter().any(ipin::is_log) {
        Some(App::Ipin)
    } else if documents.iter().any(typed::is_log) {
        Some(App::Typed)
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

/// Reads a session: its events, and what it had.
pub fn import(inputs: &[PathBuf], options: &ImportOptions) -> Result<(Events, Summary), RecordingError> {
    import_found(&Input::all(inputs)?, options)
}

pub(super) fn import_found(inputs: &[Input], options: &ImportOptions) -> Result<(Events, Summary), RecordingError> {
    let units = options.units.unwrap_or_default();
    let paths: Vec<PathBuf> = inputs.iter().map(|input| input.path.clone()).collect();
    let bags = bags(inputs)?;
    if !bags.is_empty() {
        let session = read_bags(bags, &options.topics, &units)?;
        return finish("ROS 2", session, &paths, options);
    }
    // a folder and a zip hold a whole session each
    if let [first, second, ..] = inputs
        && inputs.iter().any(|input| input.is_dir || input.is_zip())
    {
        return Err(RecordingError::several(&first.path, &second.path));
    }
    let Documents { read: mut documents, unreadable } = documents(inputs)?;
    documents.iter_mut().for_each(|document| document.skip_lines(options.skip));
    let found = if options.columns.is_some() || options.rate.is_some() { None } else { logger(&documents) };
    let is_fixed = !matches!(found, None | Some(App::Typed));
    if is_fixed && (units.time_ns.is_some() || units.field.is_some() || units.rate.is_some()) {
        let why = "the units of a logger's files are known; only a=... can be given, for the sign of the accelerometer";
        return Err(RecordingError::Usage(format!("--units: {why}")));
    }
    if let Some(app) = found {
        refuse_twice(&documents, app)?;
    }
    let (name, mut session) = match found {
        Some(App::SensorLogger) => ("Sensor Logger", sensor_logger::read(&documents, &units)?),
        Some(App::Phyphox) => ("phyphox", phyphox::read(&documents)?),
        Some(App::GnssLogger) => ("GnssLogger", gnss_logger::read(&documents)?),
        Some(App::Ipin) => ("GetSensorData", ipin::read(&documents)?),
        Some(App::Typed) => ("typed lines", typed::read(&documents, &units)?),
        Some(App::Matlab) => ("MATLAB Mobile", matlab::read(&documents)?),
        None => (plain_name(&documents), plain_session(&mut documents, options)?),
    };
    for document in documents.iter().filter(|document| document.is_cut) {
        let text =
            "the file is cut off, as that of an app that was ended while it wrote; what is before the cut was read";
        session.notes.push(format!("{}: {text}", document.path.display()));
    }
    for why in unreadable {
        if session.raw.events.is_empty() {
            return Err(why);
        }
        session.leave_out("unreadable", why);
    }
    finish(name, session, &paths, options)
}

/// The logger that a table's header tells.
fn plain_name(documents: &[Document]) -> &'static str {
    let any =
        |is: &dyn Fn(&String) -> bool| documents.iter().any(|document| Sheet::new(document).header.iter().any(is));
    if any(&|name| name.starts_with("magnetometerTimestamp_sinceReboot")) {
        "SensorLog"
    } else if any(&|name| name.starts_with("MAGNETIC FIELD X")) {
        "AndroSensor"
    } else {
        "plain CSV"
    }
}

fn finish(
    name: &'static str,
    mut session: Session,
    inputs: &[PathBuf],
    options: &ImportOptions,
) -> Result<(Events, Summary), RecordingError> {
    session.require_magnetometer(name, inputs)?;
    session.tell_fixes();
    session.shift(&options.shift.unwrap_or_default());
    session.order(&options.frame.unwrap_or_default(), options.session, options.force)?;
    let more = plausible::check(&mut session)?;
    session.warnings.extend(more);
    let conventions = session.conventions();
    let day = session.begun_unix_ns().and_then(Day::of_unix_ns);
    let mut summary = Summary {
        logger: name,
        sensors: session.sensors(),
        notes: std::mem::take(&mut session.notes),
        warnings: std::mem::take(&mut session.warnings),
        conventions,
        day,
        position: session.position,
    };
    let mut events = session.into_events();
    if events.count_from_start() {
        summary.notes.push("times count from the first event".to_owned());
    }
    Ok((events, summary))
}

/// Refuses two files of one sensor: they are of two sessions, or one file named twice. Tables that are no sensor's do not count, but a whole
/// recording beside a logger's files does.
fn refuse_twice(documents: &[Document], app: App) -> Result<(), RecordingError> {
    let mut seen: BTreeMap<String, &Document> = BTreeMap::new();
    for document in documents.iter().filter(|document| !document.text.is_empty()) {
        let header = Sheet::new(document).header;
        let name = match app {
            App::SensorLogger if sensor_logger::is_header(&header) => document.stem(),
            App::Matlab if matlab::is_header(&header) => document.stem(),
            _ if plain::is_recording(&header) => "a recording".to_owned(),
            _ => continue,
        };
        if name == "a recording"
            && let Some(other) = documents.iter().find(|other| other.path != document.path)
        {
            return Err(RecordingError::several(&other.path, &document.path));
        }
        if let Some(before) = seen.insert(name, document) {
            return Err(RecordingError::several(&before.path, &document.path));
        }
    }
    Ok(())
}

/// The other files that have no such header either, some by name.
fn others(documents: &[Document], nearest: &Path) -> String {
    let others = documents.iter().map(|document| document.path.as_path()).filter(|path| *path != nearest);
    let names: Vec<String> = others.map(name_of).collect();
    match names.as_slice() {
        [] => String::new(),
        few @ ([_] | [_, _] | [_, _, _]) => format!("; not in {} either", few.join(", ")),
        many => format!("; not in {} others either", many.len()),
    }
}

fn plain_session(documents: &mut [Document], options: &ImportOptions) -> Result<Session, RecordingError> {
    if documents.iter().all(|document| Sheet::new(document).header.is_empty()) {
        return Err(RecordingError::Empty { path: documents[0].path.clone(), what: "nothing in it" });
    }
    let names = options.columns.clone().unwrap_or_default();
    let units = options.units.unwrap_or_default();
    for document in documents.iter_mut() {
        // titles before a table whose header is in words
        document.begin_at(|line| {
            let header = header_of(line);
            names::likeness(&header) >= 3 || plain::is_header(&header, &names, options.rate.is_some())
        });
    }
    let known = |document: &Document| {
        let header = Sheet::new(document).header;
        plain::is_header(&header, &names, options.rate.is_some())
            || names::guess(document, &units, options.rate).is_some()
    };
    if options.columns.is_none() && !documents.iter().any(known) {
        // the file that comes nearest
        let nearest = documents.iter().rev().max_by_key(|document| {
            let header = Sheet::new(document).header;
            (names::likeness(&header), names::sensor_of_stem(&document.stem()).is_some(), !header.is_empty())
        });
        let nearest = nearest.unwrap_or(&documents[0]);
        let sheet = Sheet::new(nearest);
        let how = if sheet.has_header() {
            "other names by --columns t=NAME,mx=NAME,my=NAME,mz=NAME"
        } else {
            "columns without names by --columns t=#1,mx=#2,my=#3,mz=#4 (and --rate HZ where there is no time)"
        };
        return Err(RecordingError::Form {
            place: Place { path: nearest.path.clone(), line: nearest.first_line_number(), column: None },
            expected: format!("a header of {LOGGERS}, or a recording's t_s,mx,my,mz; {how}"),
            found: format!("{}{}", sheet.shown(), others(documents, &nearest.path)),
        });
    }
    plain::read(documents, options)
}
