//! A recording as it is, or made of a session.

use super::document::Document;
use super::forms::is_packed;
use super::input::Input;
use super::make::{import_found, logger};
use super::options::ImportOptions;
use super::plausible;
use super::session::Session;
use super::sheet::Sheet;
use super::summary::Summary;
use crate::conventions::Conventions;
use crate::error::LabError;
use crate::place::{Day, GeoPoint};
use crate::recording::{Content, Source, unzipped};
use std::io::{BufWriter, Read, Write};
use std::path::{Path, PathBuf};

/// Bytes at the beginning of a file that show its form.
const START: u64 = 4096;
/// Rows of a recording that tell its units: at least, and at most.
const FEWEST: usize = 20;
const LOOKED_AT: usize = 60_000;

/// A recording to replay.
#[derive(Debug)]
pub struct Opened {
    /// Its rows.
    pub source: Source,
    /// The content of the session that it was made from; none where the input is a recording already.
    pub session: Option<Summary>,
    /// Parts that were left out, or may be wrong.
    pub warnings: Vec<String>,
    /// Whether units, signs, axes and clocks are what they are taken for.
    pub conventions: Conventions,
    /// The day of its first row (UTC), where its times say so.
    pub day: Option<Day>,
    /// Where it was recorded, where the session says so.
    pub position: Option<GeoPoint>,
}

/// Opens a recording, or makes a session into one.
///
/// # Errors
/// Those of [`crate::import::import`] and of [`Source::of`].
pub fn open(inputs: &[PathBuf], options: &ImportOptions) -> Result<Opened, LabError> {
    open_found(&Input::all(inputs)?, options)
}

/// As [`open`], of files that are in memory: name and content of each. Nothing is written anywhere.
///
/// # Errors
/// Those of [`open`].
pub fn open_bytes(files: Vec<(String, Vec<u8>)>, options: &ImportOptions) -> Result<Opened, LabError> {
    let found: Vec<Input> = files.into_iter().map(|(name, bytes)| Input::of_bytes(&name, bytes)).collect();
    open_found(&found, options)
}

fn open_found(found: &[Input], options: &ImportOptions) -> Result<Opened, LabError> {
    let [input] = found else { return open_session(found, options) };
    if is_session(input, options)? {
        return open_session(found, options);
    }
    match open_recording(input) {
        // rows out of order, rounded times, a last row that is cut: the importer tells what it mends
        Err(why @ LabError::Recording { .. }) => match open_session(found, options) {
            Ok(opened) => Ok(opened),
            Err(several @ LabError::Several { .. }) => Err(several),
            // what was lost, and how to take it all the same
            Err(LabError::Usage(loss)) if loss.contains("--force") => Err(LabError::Usage(loss)),
            Err(_) => Err(why),
        },
        opened => opened,
    }
}

/// A recording as it is.
fn open_recording(input: &Input) -> Result<Opened, LabError> {
    let mut source = Source::of(&input.path, input.open()?)?;
    let beginning = beginning(&mut source)?;
    let warnings = plausible::check(&beginning)?;
    let conventions = beginning.conventions();
    let day = Day::of_unix_ns(source.extent().start_ns);
    Ok(Opened { source, session: None, warnings, conventions, day, position: None })
}

/// A session as a recording, in memory where it was given so, else in a temporary file.
fn open_session(found: &[Input], options: &ImportOptions) -> Result<Opened, LabError> {
    let failed = || LabError::write(Path::new("a temporary file"));
    let (summary, content) = if found.iter().all(Input::is_in_memory) {
        let mut out = Vec::new();
        let summary = import_found(found, options, |write| write(&mut out).map_err(failed()))?;
        (summary, Content::from(out))
    } else {
        let file = tempfile::tempfile().map_err(failed())?;
        let copy = file.try_clone().map_err(failed())?;
        let mut out = BufWriter::new(file);
        let summary = import_found(found, options, |write| write(&mut out).map_err(failed()))?;
        out.flush().map_err(failed())?;
        (summary, Content::from(copy))
    };
    let (warnings, day, position) = (summary.warnings.clone(), summary.day, summary.position);
    let conventions = summary.conventions.clone();
    Ok(Opened {
        source: Source::of(&found[0].path, content)?,
        session: Some(summary),
        warnings,
        conventions,
        day,
        position,
    })
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
        if let Some(attitude) = row.attitude {
            session.attitude.add(row.time_ns, attitude, || [time.clone(), raw.clone()])?;
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
    if !text.contains(&b'\n') && text.contains(&b'\r') {
        return Ok(true);
    }
    let document = Document::of_text(input.path.clone(), text);
    let sheet = Sheet::new(&document);
    let header = &sheet.header;
    Ok(is_packed(&document.text)
        || logger(std::slice::from_ref(&document)).is_some()
        // a recording's own form has commas between cells, plain CSV may have others
        || sheet.has_decimal_commas()
        || !header.iter().any(|name| name == "t_s") && !header.is_empty())
}
