//! phyphox (RWTH Aachen): a zip with one CSV for each sensor, or one CSV; `Time (s)` counts from the start of the experiment. The
//! app writes commas, semicolons or tabs, a decimal point or a decimal comma, and names the columns in the user's language. So
//! the unit in a column's name tells the sensor, and the last letter before it the axis. Accelerations are taken to have
//! Android's sign on both platforms. phyphox does not say whether the system calibrated the field.

use super::document::Document;
use super::session::Session;
use super::sheet::Sheet;
use crate::error::LabError;

/// Nanoseconds of a second.
const SECOND_NS: i64 = 1_000_000_000;

/// Parts of the names of files that sensors have in any language.
const SENSORS: [&str; 3] = ["magn", "gyro", "accel"];

#[derive(Clone, Copy, PartialEq)]
enum Sensor {
    Field,
    Rate,
    Acceleration,
}

/// The sensor and axis that a column's name says: `Gyroscope y (rad/s)`.
fn column(name: &str) -> Option<(Sensor, usize)> {
    let (what, unit) = name.strip_suffix(')')?.rsplit_once('(')?;
    let axis =
        ["x", "y", "z"].iter().position(|axis| what.to_lowercase().split_whitespace().next_back() == Some(axis))?;
    // the micro sign has two code points, and one more in files of other encodings
    let sensor = match unit {
        "rad/s" => Sensor::Rate,
        "m/s^2" | "m/s²" => Sensor::Acceleration,
        _ if unit.ends_with('T') && unit.chars().count() == 2 => Sensor::Field,
        _ => return None,
    };
    Some((sensor, axis))
}

/// Whether the acceleration in this column or file is without gravity.
fn is_linear(name: &str) -> bool {
    name.to_lowercase().contains("linear")
}

pub(super) fn is_header(header: &[String]) -> bool {
    header.first().is_some_and(|name| name.ends_with("(s)")) && header.iter().any(|name| column(name).is_some())
}

pub(super) fn read(documents: &[Document]) -> Result<Session, LabError> {
    let mut session = Session::default();
    let mut linear = false;
    for document in documents {
        let sheet = Sheet::new(document);
        if !is_header(&sheet.header) {
            if let Some(began) = sheet.column("system time") {
                let began =
                    sheet.rows().next().and_then(Result::ok).and_then(|cells| cells.time_ns(began, SECOND_NS).ok());
                session.start_unix_ns = session.start_unix_ns.or(began);
            } else if SENSORS.iter().any(|name| document.stem().contains(name)) {
                session.leave_out(
                    &document.stem(),
                    format!("{}: no header of phyphox, but {}", document.path.display(), sheet.shown()),
                );
            }
            continue;
        }
        for sensor in [Sensor::Field, Sensor::Rate, Sensor::Acceleration] {
            let axis = |wanted: usize| {
                let has = |name: &String| column(name) == Some((sensor, wanted)) && !is_linear(name);
                sheet.header.iter().position(has)
            };
            let Some(axes) = axis(0).zip(axis(1)).zip(axis(2)).map(|((x, y), z)| [x, y, z]) else {
                linear |= sensor == Sensor::Acceleration && sheet.header.iter().any(|name| is_linear(name));
                continue;
            };
            if sensor == Sensor::Acceleration && is_linear(&document.stem()) {
                linear = true;
                continue;
            }
            let stream = match sensor {
                Sensor::Field => &mut session.raw,
                Sensor::Rate => &mut session.rate,
                Sensor::Acceleration => &mut session.up,
            };
            if !stream.events.is_empty() {
                let path = document.path.display();
                return Err(LabError::Usage(format!(
                    "{path}: another file has this sensor too; import one session at a time"
                )));
            }
            match sheet.stream(0, axes, |cells| cells.time_ns(0, SECOND_NS)) {
                Err(why) if sensor != Sensor::Field => session.leave_out(&document.stem(), why),
                found => *stream = found?,
            }
        }
    }
    if !session.raw.events.is_empty() {
        let note = "phyphox does not say whether the system calibrated the field: switch its magnetometer to uncalibrated where it can";
        session.notes.push(note.to_owned());
    }
    if linear && session.up.events.is_empty() {
        session
            .notes
            .push("linear acceleration has no gravity in it and was left out; record acceleration with g".to_owned());
    }
    Ok(session)
}
