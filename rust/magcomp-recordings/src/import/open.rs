//! A recording as it is, or made of a session.

use super::document::Document;
use super::forms::is_packed;
use super::input::Input;
use super::make::{import_found, logger};
use super::names::left_over;
use super::options::ImportOptions;
use super::plausible;
use super::session::{Session, Summary};
use super::sheet::Sheet;
use crate::conventions::Conventions;
use crate::error::RecordingError;
use crate::place::{Day, GeoPoint};
use crate::recording::{Events, Line, Row, Source, Text, text, unzipped};
use std::io::{self, Read};
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

/// A recording in memory.
#[derive(Debug)]
pub struct Loaded {
    /// Its events.
    pub events: Events,
    /// Parts that were left out, or may be wrong.
    pub warnings: Vec<String>,
    /// Whether units, signs, axes and clocks are what they are taken for.
    pub conventions: Conventions,
}

/// Opens a recording, or makes a session into one.
pub fn open(inputs: &[PathBuf], options: &ImportOptions) -> Result<Opened, RecordingError> {
    open_found(&Input::all(inputs)?, options)
}

/// As [`open`], of files that are in memory: name and content of each. Nothing is written anywhere.
pub fn open_bytes(files: Vec<(String, Vec<u8>)>, options: &ImportOptions) -> Result<Opened, RecordingError> {
    let found: Vec<Input> = files.into_iter().map(|(name, bytes)| Input::of_bytes(&name, bytes)).collect();
    open_found(&found, options)
}

/// Reads the events of a recording or of a session, all into memory.
pub fn load(inputs: &[PathBuf], options: &ImportOptions) -> Result<Loaded, RecordingError> {
    let session = |found: &[Input]| {
        let (events, Summary { warnings, conventions, .. }) = import_found(found, options)?;
        Ok(Loaded { events, warnings, conventions })
    };
    either(&Input::all(inputs)?, options, session, load_recording)
}

fn open_found(found: &[Input], options: &ImportOptions) -> Result<Opened, RecordingError> {
    either(found, options, |found| open_session(found, options), open_recording)
}

/// A recording by `recording`, and what is none, or has to be mended, by `session`.
fn either<T>(
    found: &[Input],
    options: &ImportOptions,
    session: impl Fn(&[Input]) -> Result<T, RecordingError>,
    recording: impl Fn(&Input) -> Result<T, RecordingError>,
) -> Result<T, RecordingError> {
    let [input] = found else { return session(found) };
    if is_session(input, options)? {
        return session(found);
    }
    match recording(input) {
        Err(why) if is_mended(&why) => match session(found) {
            Ok(opened) => Ok(opened),
            Err(several @ RecordingError::Several { .. }) => Err(several),
            // what was lost, and how to take it all the same
            Err(RecordingError::Usage(loss)) if loss.contains("--force") => Err(RecordingError::Usage(loss)),
            Err(_) => Err(why),
        },
        opened => opened,
    }
}

/// Rows out of order, rounded times, an end that is cut: the importer tells what it mends.
fn is_mended(why: &RecordingError) -> bool {
    match why {
        RecordingError::Form { .. } => true,
        RecordingError::Read { source, .. } => source.kind() == io::ErrorKind::UnexpectedEof,
        _ => false,
    }
}

fn open_recording(input: &Input) -> Result<Opened, RecordingError> {
    let content = input.open()?;
    let mut beginning = Session::default();
    let source = Source::of(&input.path, content.again().map_err(RecordingError::read(&input.path))?)?;
    read_lines(&mut text(&input.path, &content)?, &mut beginning, LOOKED_AT)?;
    let (warnings, conventions) = checked(&input.path, &mut beginning)?;
    let day = Day::of_unix_ns(source.extent().start_ns);
    Ok(Opened { source, session: None, warnings, conventions, day, position: None })
}

/// The events of a recording as it is.
fn load_recording(input: &Input) -> Result<Loaded, RecordingError> {
    let mut text = text(&input.path, &input.open()?)?;
    let mut session = Session::default();
    read_lines(&mut text, &mut session, LOOKED_AT)?;
    let checked = checked(&input.path, &mut session);
    read_lines(&mut text, &mut session, usize::MAX)?;
    if session.raw.events.is_empty() {
        return Err(RecordingError::Empty { path: input.path.clone(), what: "a header but no rows" });
    }
    let (warnings, conventions) = checked?;
    Ok(Loaded { events: session.into_events(), warnings, conventions })
}

fn open_session(found: &[Input], options: &ImportOptions) -> Result<Opened, RecordingError> {
    let (events, summary) = import_found(found, options)?;
    let source = Source::of_events(&found[0].path, events)?;
    let Summary { warnings, conventions, day, position, .. } = summary.clone();
    Ok(Opened { source, session: Some(summary), warnings, conventions, day, position })
}

/// Reads lines of a recording until it has so many samples of the magnetometer.
fn read_lines(text: &mut Text, session: &mut Session, most: usize) -> Result<(), RecordingError> {
    let [time, raw, up, rate, system] = ["t_s", "mx", "ax", "gx", "sys_mx"].map(|name| text.first_place(name));
    session.raw.first.get_or_insert([time.clone(), raw]);
    session.up.first.get_or_insert([time.clone(), up]);
    session.rate.first.get_or_insert([time.clone(), rate]);
    session.system.first.get_or_insert([time, system]);
    session.left_over.get_or_insert_with(|| left_over(text.header(), |column| text.takes(column)));
    while session.raw.events.len() < most {
        let Some(line) = text.line()? else { break };
        let Line { field_ut, row } = line;
        let Row { time_ns, up_m_s2, rate_rad_s, system_ut, attitude, course, .. } = row;
        session.raw.events.extend(field_ut.map(|value| (time_ns, value)));
        session.up.events.extend(up_m_s2.map(|value| (time_ns, value)));
        session.rate.events.extend(rate_rad_s.map(|value| (time_ns, value)));
        session.system.events.extend(system_ut.map(|value| (time_ns, value)));
        session.attitude.events.extend(attitude.map(|value| (time_ns, value)));
        session.course.events.extend(course.map(|value| (time_ns, value)));
    }
    Ok(())
}

/// Warnings of a recording's first rows and its conventions; none where it is too short to tell.
fn checked(path: &Path, beginning: &mut Session) -> Result<(Vec<String>, Conventions), RecordingError> {
    if beginning.raw.events.len() < FEWEST {
        return Ok(Default::default());
    }
    let mut warnings = plausible::check(beginning)?;
    let left = beginning.left_over.take().unwrap_or_default();
    beginning.tell_left_over(path, &left);
    warnings.append(&mut beginning.warnings);
    Ok((warnings, beginning.conventions()))
}

/// Whether the input must be imported.
fn is_session(input: &Input, options: &ImportOptions) -> Result<bool, RecordingError> {
    if input.is_dir || *options != ImportOptions::default() {
        return Ok(true);
    }
    let mut text = Vec::new();
    // a cut gzip shows itself when it is read whole
    let _ = unzipped(input.open()?).map_err(RecordingError::read(&input.path))?.take(START).read_to_end(&mut text);
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
