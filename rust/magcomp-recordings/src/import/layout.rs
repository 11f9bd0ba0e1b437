//! Where a table's sensors are, and how they are read.

use super::document::Document;
use super::session::Session;
use super::sheet::{Cells, Sheet};
use super::units::Kind;
use crate::error::{Place, RecordingError};
use crate::recording::Course;
use crate::time::MOST_NS;
use magcomp::nalgebra::{Quaternion, UnitQuaternion};

pub(super) const SECOND_NS: i64 = 1_000_000_000;

/// When a row was.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Time {
    /// The sum of columns, each in units of so many nanoseconds.
    Columns(Vec<(usize, i64)>),
    Rate(f64),
}

impl Time {
    fn read(&self, cells: &Cells<'_>, row: usize) -> Result<i64, RecordingError> {
        match self {
            Self::Columns(parts) => {
                let mut time_ns: i64 = 0;
                for (column, unit_ns) in parts {
                    time_ns = time_ns.saturating_add(cells.time_ns(*column, *unit_ns)?);
                }
                if time_ns.unsigned_abs() < MOST_NS as u64 {
                    return Ok(time_ns);
                }
                Err(cells.wrong(self.column(), "a sum of times within 146 years of zero"))
            }
            Self::Rate(hz) => Ok((row as f64 * 1e9 / hz).round() as i64),
        }
    }

    fn has(&self, column: usize) -> bool {
        matches!(self, Self::Columns(parts) if parts.iter().any(|(part, _)| *part == column))
    }

    /// The column that an error names.
    fn column(&self) -> usize {
        match self {
            Self::Columns(parts) => parts.first().map_or(0, |(column, _)| *column),
            Self::Rate(_) => 0,
        }
    }
}

/// One sensor's columns, what a unit of them is, and a time of its own.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Taken {
    pub kind: Kind,
    pub columns: [usize; 3],
    pub factor: f64,
    pub time: Option<Time>,
}

/// What of a table is taken.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Layout {
    pub time: Time,
    /// The unit of the times is known and not taken for granted.
    pub is_time_told: bool,
    pub sensors: Vec<Taken>,
    pub attitude: Option<[usize; 4]>,
    pub course: Option<[usize; 2]>,
}

impl Layout {
    /// Whether this column is read.
    pub fn takes(&self, column: usize) -> bool {
        let in_sensor =
            |taken: &Taken| taken.columns.contains(&column) || taken.time.as_ref().is_some_and(|time| time.has(column));
        self.time.has(column) || self.sensors.iter().any(in_sensor)
    }
}

/// Reads a table into a session.
pub(super) fn read(document: &Document, layout: &Layout, session: &mut Session) -> Result<(), RecordingError> {
    let sheet = Sheet::new(document);
    let (mut row, mut before_ns) = (0, vec![None; layout.sensors.len()]);
    let cut = sheet.rows(|cells| {
        let shared_ns = layout.time.read(cells, row);
        row += 1;
        let time = layout.time.column();
        for (taken, before_ns) in layout.sensors.iter().zip(&mut before_ns) {
            let Taken { kind, columns, factor, time: own } = taken;
            let Some(value) = cells.vector(*columns)? else { continue };
            let time_ns = match (own, &shared_ns) {
                // a row repeats what the sensor said last
                (Some(own), _) => match own.read(cells, row)? {
                    time_ns if before_ns.replace(time_ns) == Some(time_ns) => continue,
                    time_ns => time_ns,
                },
                (None, Ok(time_ns)) => *time_ns,
                (None, Err(_)) => layout.time.read(cells, row)?,
            };
            let stream = session.stream(*kind);
            stream.add(time_ns, value * *factor, || [cells.place(time), cells.place(columns[0])])?;
        }
        if let Some([w, x, y, z]) = layout.attitude.filter(|[w, ..]| !cells.is_nothing(*w)) {
            let q = Quaternion::new(cells.number(w)?, cells.number(x)?, cells.number(y)?, cells.number(z)?);
            if let Some(q) = UnitQuaternion::try_new(q, 1e-6).filter(|_| q.norm().is_finite()) {
                session.attitude.add(layout.time.read(cells, row - 1)?, q, || [cells.place(time), cells.place(w)])?;
            }
        }
        if let Some([heading, sigma]) = layout.course.filter(|[heading, _]| !cells.is_nothing(*heading)) {
            let course = Course { heading_deg: cells.number(heading)?, sigma_deg: cells.number(sigma)? };
            let places = || [cells.place(time), cells.place(heading)];
            session.course.add(layout.time.read(cells, row - 1)?, course, places)?;
        }
        // a time that cannot be read is an error even in a row without events
        shared_ns.map(|_| ())
    })?;
    session.notes.extend(cut);
    Ok(())
}

/// The columns of a time such as `t`, `#1` or `secs+1e-9*nsecs`, in the unit that was given; else in the one that a name tells, else in seconds.
pub(super) fn time(sheet: &Sheet<'_>, name: &str, given_ns: Option<i64>) -> Result<Time, RecordingError> {
    if sheet.column(name).is_some() || !name.contains(['+', '*']) {
        let column = sheet.required(name)?;
        let unit_ns = given_ns.or_else(|| sheet.time_unit(column)).unwrap_or(SECOND_NS);
        return Ok(Time::Columns(vec![(column, unit_ns)]));
    }
    let unit_ns = given_ns.unwrap_or(SECOND_NS);
    let mut parts = Vec::new();
    for part in split_sum(name) {
        let (factor, column) = match part.split_once('*') {
            Some((factor, column)) => (factor.trim().parse().unwrap_or(f64::NAN), column.trim()),
            None => (1.0, part.trim()),
        };
        let factor_ns = factor * unit_ns as f64;
        if !(0.5..1e18).contains(&factor_ns) {
            let place = Place { path: sheet.path().to_owned(), line: 1, column: None };
            let expected = "a time such as t=secs+1e-9*nsecs, factor by factor at least a nanosecond".to_owned();
            return Err(RecordingError::Form { place, expected, found: format!("'{name}'") });
        }
        parts.push((sheet.required(column)?, factor_ns.round() as i64));
    }
    Ok(Time::Columns(parts))
}

/// The parts of a sum; the plus of an exponent is none between them.
fn split_sum(text: &str) -> Vec<&str> {
    let mut parts = Vec::new();
    let (mut begin, bytes) = (0, text.as_bytes());
    for (k, byte) in bytes.iter().enumerate() {
        let exponent = k > 1 && bytes[k - 1].eq_ignore_ascii_case(&b'e') && bytes[k - 2].is_ascii_digit();
        if *byte == b'+' && !exponent {
            parts.push(&text[begin..k]);
            begin = k + 1;
        }
    }
    parts.push(&text[begin..]);
    parts
}

/// What was guessed, in words that can be typed.
pub(super) fn told(document: &Document, layout: &Layout) -> String {
    let header = Sheet::new(document).header;
    let name = |column: usize| header.get(column).map_or("", String::as_str).to_owned();
    let time = match &layout.time {
        Time::Columns(parts) => {
            let unit = match parts[0].1 {
                SECOND_NS => "s",
                1_000_000 => "ms",
                1000 => "us",
                _ => "ns",
            };
            format!("time '{}' in {unit}", name(parts[0].0))
        }
        Time::Rate(hz) => format!("{hz} rows a second"),
    };
    let sensors = layout.sensors.iter().map(|taken| format!("{} '{}'", taken.kind.word(), name(taken.columns[0])));
    let told: Vec<String> = std::iter::once(time).chain(sensors).collect();
    format!("{}: taken by its names: {}", document.path.display(), told.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sum_of_times_is_split_between_its_parts() {
        assert_eq!(split_sum("secs+1e-9*nsecs"), ["secs", "1e-9*nsecs"]);
        assert_eq!(split_sum("a+1e+3*b"), ["a", "1e+3*b"]);
    }
}
