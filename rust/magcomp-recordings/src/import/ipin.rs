//! GetSensorData, the logger of the IPIN competitions: rows such as `MAGN;AppTimestamp(s);SensorTimestamp(s);Mag_X(uT);Mag_Y(uT);Mag_Z(uT);
//! Accuracy`, of which `MAGN`, `ACCE`, `GYRO` and `GNSS` are read; comments begin with `%`. The field is the one that the system calibrates.
//! A fix is `GNSS;AppTimestamp(s);SensorTimestamp(s);Latit(deg);Long(deg);Alt(m);Bearing(deg);Accuracy(m);Speed(m/s);...`; its time is the
//! app's, so it is set against the sensors' clock by the row of a sensor before it.

use super::document::Document;
use super::fix::course;
use super::layout::SECOND_NS;
use super::session::Session;
use super::sheet::Sheet;
use crate::error::RecordingError;
use crate::recording::Delimiter;
use crate::time::MOST_NS;

const APP: usize = 1;
const TIME: usize = 2;
const VALUE: [usize; 3] = [3, 4, 5];
/// Columns of a fix: latitude and longitude, degrees, and height, m; bearing, degrees; speed, m/s.
const PLACE: [usize; 3] = [3, 4, 5];
const BEARING: usize = 6;
const SPEED: usize = 8;
const KINDS: [&str; 3] = ["MAGN", "ACCE", "GYRO"];

/// Whether some row of the first few hundred kilobytes is of this form.
pub(super) fn is_log(document: &Document) -> bool {
    document.has_row_of(&KINDS, b';')
}

pub(super) fn read(documents: &[Document]) -> Result<Session, RecordingError> {
    let mut session = Session { is_time_told: true, ..Session::default() };
    let mut first: Option<&Document> = None;
    for document in documents {
        let (sheet, before) = (Sheet::of_lines(document, Delimiter::Mark(b';')), session.raw.events.len());
        let mut ahead_ns = 0;
        let cut = sheet.lines(|cells| {
            let kind = cells.text(0);
            if kind == "GNSS" {
                let known = |column: usize| cells.number(column).unwrap_or(f64::NAN);
                session.stand_at(known(PLACE[0]), known(PLACE[1]), known(PLACE[2]));
                let found = course(known(BEARING), f64::NAN, known(SPEED));
                session.without_course += usize::from(found.is_none());
                if let (Some(course), Ok(app_ns)) = (found, cells.time_ns(APP, SECOND_NS)) {
                    let time_ns = app_ns.saturating_add(ahead_ns).clamp(1 - MOST_NS, MOST_NS - 1);
                    session.course.add(time_ns, course, || [cells.place(APP), cells.place(BEARING)])?;
                }
                return Ok(());
            }
            if !KINDS.contains(&kind.as_str()) {
                return Ok(());
            }
            let time_ns = cells.time_ns(TIME, SECOND_NS)?;
            ahead_ns = time_ns - cells.time_ns(APP, SECOND_NS)?;
            let Some(value) = cells.vector(VALUE)? else { return Ok(()) };
            let stream = match kind.as_str() {
                "MAGN" => &mut session.raw,
                "GYRO" => &mut session.rate,
                _ => &mut session.up,
            };
            stream.add(time_ns, value, || [cells.place(TIME), cells.place(VALUE[0])])
        })?;
        session.notes.extend(cut);
        if session.raw.events.len() > before
            && let Some(first) = first.replace(document)
        {
            return Err(RecordingError::several(&first.path, &document.path));
        }
    }
    session.notes.push("the magnetometer is the one that the system calibrates".to_owned());
    Ok(session)
}
