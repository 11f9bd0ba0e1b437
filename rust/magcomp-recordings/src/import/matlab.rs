//! MATLAB Mobile: its logs are timetables `Acceleration`, `AngularVelocity` and `MagneticField` with `Timestamp`, `X`, `Y`, `Z` in
//! m/s^2, rad/s and uT (mathworks.com/help, "Sensor Data Collection with MATLAB Mobile"). MATLAB's
//! `writetimetable(MagneticField, "MagneticField.csv")` makes the CSV of one. The field is the one that the system calibrates
//! where the app takes that one; accelerations are taken to have Android's sign on both platforms.

use super::dates;
use super::document::Document;
use super::names::sensor_of_stem;
use super::plain::which_sensor;
use super::session::Session;
use super::sheet::{Cells, Sheet};
use super::stream::Stream;
use super::units::Kind;
use crate::error::RecordingError;
use magcomp::nalgebra::Vector3;

/// Tables of the app that are no sensor's.
const NO_SENSORS: [&str; 3] = ["orient", "position", "lin"];

pub(super) fn is_header(header: &[String]) -> bool {
    ["Timestamp", "X", "Y", "Z"].iter().all(|name| header.iter().any(|column| column == name))
}

pub(super) fn read(documents: &[Document]) -> Result<Session, RecordingError> {
    let mut session = Session { is_time_told: true, ..Session::default() };
    let mut owners: [Option<&Document>; 4] = [None; 4];
    for document in documents {
        let stem = document.stem();
        let Some(kind) = sensor_of_stem(&stem) else {
            let is_table = is_header(&Sheet::new(document).header);
            if is_table && !NO_SENSORS.iter().any(|name| stem.contains(name)) {
                session.leave_out("unknown", which_sensor(document));
            }
            continue;
        };
        if let Some(before) = owners[kind as usize].replace(document) {
            return Err(RecordingError::several(&before.path, &document.path));
        }
        match stream(document) {
            Err(why) if kind != Kind::Field => session.leave_out(kind.word(), why),
            found => *session.stream(kind) = found?,
        }
    }
    if !session.raw.events.is_empty() {
        session.notes.push("MATLAB Mobile does not say whether the system calibrated the field".to_owned());
    }
    Ok(session)
}

fn stream(document: &Document) -> Result<Stream<Vector3<f64>>, RecordingError> {
    let sheet = Sheet::new(document);
    let time = sheet.required("Timestamp")?;
    let axes = [sheet.required("X")?, sheet.required("Y")?, sheet.required("Z")?];
    let stream = sheet.stream(time, axes, |cells| timestamp_ns(cells, time))?;
    require_milliseconds(&stream)?;
    Ok(stream)
}

/// Refuses times of whole seconds, where all events of a second but one would be lost.
fn require_milliseconds(stream: &Stream<Vector3<f64>>) -> Result<(), RecordingError> {
    let repeated = stream.events.windows(2).filter(|pair| pair[0].0 == pair[1].0).count();
    let (Some([place, _]), true) = (&stream.first, 2 * repeated > stream.events.len()) else { return Ok(()) };
    let table = place.path.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Err(RecordingError::Form {
        place: place.clone(),
        expected: "times with milliseconds".to_owned(),
        found: format!(
            "{repeated} of {} rows at the same time as the row before; in MATLAB, {table}.Timestamp.Format = \
             \"dd-MMM-yyyy HH:mm:ss.SSS\" before writetimetable({table}, \"{table}.csv\") writes the milliseconds that MATLAB Mobile recorded",
            stream.events.len()
        ),
    })
}

fn timestamp_ns(cells: &Cells<'_>, column: usize) -> Result<i64, RecordingError> {
    let expected = "a time such as 22-Nov-2026 10:11:12.345 or 2026-11-22 10:11:12.345";
    dates::parse_ns(&cells.text(column)).ok_or_else(|| cells.wrong(column, expected))
}
