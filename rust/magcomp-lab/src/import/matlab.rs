//! MATLAB Mobile: its logs are timetables `Acceleration`, `AngularVelocity` and `MagneticField` with `Timestamp`, `X`, `Y`, `Z` in
//! m/s^2, rad/s and uT (mathworks.com/help, "Sensor Data Collection with MATLAB Mobile"). MATLAB's
//! `writetimetable(MagneticField, "MagneticField.csv")` makes the CSV of one. The field is the one that the system calibrates
//! where the app takes that one; accelerations are taken to have Android's sign on both platforms.

use super::document::Document;
use super::session::{Session, Stream};
use super::sheet::{Cells, Sheet};
use crate::error::LabError;
use magcomp::nalgebra::Vector3;

const MONTHS: [&str; 12] = ["jan", "feb", "mar", "apr", "may", "jun", "jul", "aug", "sep", "oct", "nov", "dec"];

pub(super) fn is_header(header: &[String]) -> bool {
    ["Timestamp", "X", "Y", "Z"].iter().all(|name| header.iter().any(|column| column == name))
}

pub(super) fn read(documents: &[Document]) -> Result<Session, LabError> {
    let mut session = Session::default();
    let find = |stem: &str| documents.iter().find(|document| document.stem() == stem);
    if let Some(field) = find("magneticfield") {
        session.raw = stream(field)?;
    }
    for (name, stem) in [("gyroscope", "angularvelocity"), ("accelerometer", "acceleration")] {
        if let Some((_, stream)) = session.optional(name, &[find(stem)], stream) {
            *(if name == "gyroscope" { &mut session.rate } else { &mut session.up }) = stream;
        }
    }
    if !session.raw.events.is_empty() {
        session.notes.push("MATLAB Mobile does not say whether the system calibrated the field".to_owned());
    }
    Ok(session)
}

fn stream(document: &Document) -> Result<Stream<Vector3<f64>>, LabError> {
    let sheet = Sheet::new(document);
    let time = sheet.required("Timestamp")?;
    let axes = [sheet.required("X")?, sheet.required("Y")?, sheet.required("Z")?];
    let stream = sheet.stream(time, axes, |cells| timestamp_ns(cells, time))?;
    require_milliseconds(&stream)?;
    Ok(stream)
}

/// Refuses times of whole seconds, where all events of a second but one would be lost.
fn require_milliseconds(stream: &Stream<Vector3<f64>>) -> Result<(), LabError> {
    let repeated = stream.events.windows(2).filter(|pair| pair[0].0 == pair[1].0).count();
    let (Some([place, _]), true) = (&stream.first, 2 * repeated > stream.events.len()) else { return Ok(()) };
    let table = place.path.file_stem().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    Err(LabError::Recording {
        place: place.clone(),
        expected: "times with milliseconds".to_owned(),
        found: format!(
            "{repeated} of {} rows at the same time as the row before; in MATLAB, {table}.Timestamp.Format = \
             \"dd-MMM-yyyy HH:mm:ss.SSS\" before writetimetable({table}, \"{table}.csv\") writes the milliseconds that MATLAB Mobile recorded",
            stream.events.len()
        ),
    })
}

fn timestamp_ns(cells: &Cells<'_>, column: usize) -> Result<i64, LabError> {
    let expected = "a time such as 22-Nov-2026 10:11:12.345 or 2026-11-22 10:11:12.345";
    parse(&cells.text(column)).ok_or_else(|| cells.wrong(column, expected))
}

/// `22-Nov-2026 10:11:12.345` or `2026-11-22 10:11:12.345`, ns since 1970 in the file's own time zone.
fn parse(text: &str) -> Option<i64> {
    let (date, time) = text.trim_end_matches('Z').split_once([' ', 'T'])?;
    let parts: Vec<&str> = date.split('-').collect();
    let [first, month, last] = parts[..] else { return None };
    let named = MONTHS.iter().position(|name| month.to_lowercase().starts_with(name)).map(|month| month as i64 + 1);
    let (year, month, day) = match named {
        Some(month) => (last.parse().ok()?, month, first.parse().ok()?),
        None => (first.parse().ok()?, month.parse().ok()?, last.parse::<i64>().ok()?),
    };
    let clock: Vec<&str> = time.split(':').collect();
    let [hour, minute, second] = clock[..] else { return None };
    let (hour, minute, second): (i64, i64, f64) = (hour.parse().ok()?, minute.parse().ok()?, second.parse().ok()?);
    let inside =
        (1..=12).contains(&month) && (1..=31).contains(&day) && (0..24).contains(&hour) && (0..60).contains(&minute);
    let inside = inside && (0.0..61.0).contains(&second) && (1900..2100).contains(&year);
    let whole_s = ((days(year, month, day) * 24 + hour) * 60 + minute) * 60;
    inside.then(|| whole_s * 1_000_000_000 + (second * 1e9).round() as i64)
}

/// Days from 1970-01-01 to this date of the Gregorian calendar, years counted from March.
fn days(year: i64, month: i64, day: i64) -> i64 {
    let (year, month) = if month > 2 { (year, month - 3) } else { (year - 1, month + 9) };
    let leap_days = year.div_euclid(4) - year.div_euclid(100) + year.div_euclid(400);
    365 * year + leap_days + (153 * month + 2) / 5 + day - 1 - 719_468
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn timestamps_are_those_of_the_calendar() {
        // `date -u -d '2026-11-22 10:11:12' +%s` and so on
        assert_eq!(parse("22-Nov-2026 10:11:12.345"), Some(1_795_342_272_345_000_000));
        assert_eq!(parse("2026-11-22T10:11:12.345Z"), Some(1_795_342_272_345_000_000));
        assert_eq!(parse("29-Feb-2024 23:59:59"), Some(1_709_251_199_000_000_000));
        assert_eq!(parse("1970-01-01 00:00:00"), Some(0));
        for wrong in
            ["", "10:11:12", "2026-13-01 00:00:00", "22-Nov-2026", "2026-11-22 25:00:00", "22-Foo-2026 10:11:12"]
        {
            assert_eq!(parse(wrong), None, "{wrong}");
        }
    }
}
