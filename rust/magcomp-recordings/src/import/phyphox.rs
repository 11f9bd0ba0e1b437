//! phyphox (RWTH Aachen): a zip with one CSV for each sensor, or one CSV; `Time (s)` counts from the start of the experiment. The
//! app writes commas, semicolons or tabs, a decimal point or a decimal comma, and names the columns in the user's language. So
//! the unit in a column's name tells the sensor, and the last letter before it the axis. Accelerations are taken to have
//! Android's sign on both platforms. phyphox does not say whether the system calibrated the field.

use super::document::Document;
use super::fix::course;
use super::layout::SECOND_NS;
use super::names::{Named, left_over, named};
use super::session::Session;
use super::sheet::Sheet;
use super::units::Kind;
use crate::error::RecordingError;
use std::path::Path;

/// Parts of the names of files that sensors have in any language.
const SENSORS: [&str; 3] = ["magn", "gyro", "accel"];

/// The sensor and axis that a column's name says: `Gyroscope y (rad/s)`.
fn column(name: &str) -> Option<(Kind, usize)> {
    let Named { kind, axis, factor, .. } = named(name)?;
    // its units are those of this library
    (factor == Some(1.0) && name.ends_with(')')).then_some((kind, axis))
}

/// Whether the acceleration in this column or file is without gravity.
fn is_linear(name: &str) -> bool {
    name.to_lowercase().contains("linear")
}

/// The columns of fixes, by their units in any language: `Latitude (°)`, `Longitude (°)`, `Height (m)`, `Velocity (m/s)`, `Direction (°)`.
struct Location {
    angles: [usize; 3],
    height: Option<usize>,
    speed: usize,
}

impl Location {
    fn of(header: &[String]) -> Option<Self> {
        let unit = |name: &String| Some(name.strip_suffix(')')?.rsplit_once('(')?.1.to_owned());
        let of = |wanted: &[&str]| {
            let is = move |name: &String| unit(name).is_some_and(|unit| wanted.contains(&unit.as_str()));
            header.iter().enumerate().filter(|(_, name)| is(name)).map(|(column, _)| column).collect::<Vec<_>>()
        };
        // a degree sign in another encoding is one character that is no letter
        let degrees: Vec<usize> = (header.iter().enumerate())
            .filter(|(_, name)| unit(name).is_some_and(|unit| unit.chars().count() == 1 && !unit.is_ascii()))
            .map(|(column, _)| column)
            .collect();
        let [latitude, longitude, direction, ..] = degrees[..] else { return None };
        header.first().filter(|name| name.ends_with("(s)"))?;
        let speed = *of(&["m/s"]).first()?;
        Some(Self { angles: [latitude, longitude, direction], height: of(&["m"]).first().copied(), speed })
    }

    fn read(&self, sheet: &Sheet<'_>, session: &mut Session) -> Result<(), RecordingError> {
        let [latitude, longitude, direction] = self.angles;
        sheet.rows(|cells| {
            let known = |column: usize| cells.number(column).unwrap_or(f64::NAN);
            session.stand_at(known(latitude), known(longitude), self.height.map_or(f64::NAN, known));
            let found = course(known(direction), f64::NAN, known(self.speed));
            session.without_course += usize::from(found.is_none());
            if let Some(course) = found {
                let time_ns = cells.time_ns(0, SECOND_NS)?;
                session.course.add(time_ns, course, || [cells.place(0), cells.place(direction)])?;
            }
            Ok(())
        })?;
        Ok(())
    }
}

/// Whether a table has a time and sensors as phyphox writes them, and no sensor in another way.
pub(super) fn is_header(header: &[String]) -> bool {
    header.first().is_some_and(|name| name.ends_with("(s)"))
        && header.iter().any(|name| column(name).is_some())
        && header.iter().all(|name| named(name).is_none() || column(name).is_some())
}

pub(super) fn read(documents: &[Document]) -> Result<Session, RecordingError> {
    let mut session = Session { is_time_told: true, ..Session::default() };
    let mut linear = false;
    for document in documents {
        let sheet = Sheet::new(document);
        if !is_header(&sheet.header) {
            if let Some(began) = sheet.column("system time") {
                let began = sheet.first_row().and_then(|cells| cells.time_ns(began, SECOND_NS).ok());
                session.start_unix_ns = session.start_unix_ns.or(began);
            } else if let Some(location) = Location::of(&sheet.header) {
                if let Err(why) = location.read(&sheet, &mut session) {
                    session.leave_out(&document.stem(), why);
                }
            } else if sheet.header.iter().any(|name| is_linear(name)) {
                linear = true;
            } else if SENSORS.iter().any(|name| document.stem().contains(name))
                || !left_over(&sheet.header, |_| false).is_empty()
            {
                session.leave_out(
                    &document.stem(),
                    format!("{}: no header of phyphox, but {}", document.path.display(), sheet.shown()),
                );
            }
            continue;
        }
        let mut taken = Vec::new();
        for sensor in [Kind::Field, Kind::Rate, Kind::Up] {
            let axis = |wanted: usize| {
                let has = |name: &String| column(name) == Some((sensor, wanted)) && !is_linear(name);
                sheet.header.iter().position(has)
            };
            let Some(axes) = axis(0).zip(axis(1)).zip(axis(2)).map(|((x, y), z)| [x, y, z]) else {
                linear |= sensor == Kind::Up && sheet.header.iter().any(|name| is_linear(name));
                continue;
            };
            if sensor == Kind::Up && is_linear(&document.stem()) {
                linear = true;
                continue;
            }
            taken.extend(axes);
            let stream = session.stream(sensor);
            if !stream.events.is_empty() {
                let before = stream.first.as_ref().map_or(Path::new("another file"), |[place, _]| &place.path);
                return Err(RecordingError::several(before, &document.path));
            }
            match sheet.stream(0, axes, |cells| cells.time_ns(0, SECOND_NS)) {
                Err(why) if sensor != Kind::Field => session.leave_out(&document.stem(), why),
                found => *stream = found?,
            }
        }
        if !is_linear(&document.stem()) {
            let left = left_over(&sheet.header, |column| taken.contains(&column));
            session.tell_left_over(&document.path, &left);
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
