//! Where a table's sensors are: by names that are known or given, or guessed from a header in words and from a file's name.

use super::document::Document;
use super::session::Session;
use super::sheet::{Cells, Sheet, numbered};
use super::units::{GRAVITY_M_S2, Units};
use crate::error::{LabError, Place};
use crate::recording::Course;
use crate::time::MOST_NS;
use magcomp::nalgebra::{Quaternion, UnitQuaternion};

pub(super) const SECOND_NS: i64 = 1_000_000_000;

/// The sensors of a table, in the order of their columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Field,
    Up,
    Rate,
    System,
}

impl Kind {
    /// In words.
    pub fn word(self) -> &'static str {
        match self {
            Self::Field => "field",
            Self::Up => "acceleration",
            Self::Rate => "rotation rate",
            Self::System => "the system's field",
        }
    }
}

/// When a row was.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Time {
    /// The sum of columns, each in units of so many nanoseconds.
    Columns(Vec<(usize, i64)>),
    /// So many rows a second.
    Rate(f64),
}

impl Time {
    fn read(&self, cells: &Cells<'_>, row: usize) -> Result<i64, LabError> {
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
    pub sensors: Vec<Taken>,
    pub attitude: Option<[usize; 4]>,
    pub course: Option<[usize; 2]>,
}

/// Reads a table into a session.
pub(super) fn read(document: &Document, layout: &Layout, session: &mut Session) -> Result<(), LabError> {
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
            let stream = match kind {
                Kind::Field => &mut session.raw,
                Kind::Up => &mut session.up,
                Kind::Rate => &mut session.rate,
                Kind::System => &mut session.system,
            };
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
    cut.iter().for_each(|why| session.cut_off(why));
    Ok(())
}

/// The columns of a time such as `t`, `#1` or `secs+1e-9*nsecs`.
pub(super) fn time(sheet: &Sheet<'_>, name: &str, unit_ns: i64) -> Result<Time, LabError> {
    if sheet.column(name).is_some() || !name.contains(['+', '*']) {
        return Ok(Time::Columns(vec![(sheet.required(name)?, unit_ns)]));
    }
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
            return Err(LabError::Recording { place, expected, found: format!("'{name}'") });
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

/// Ends of a sensor's word, behind which its axis may stand without a mark.
const SENSOR_ENDS: [&str; 9] = ["mag", "magn", "meter", "field", "acc", "accel", "gyr", "gyro", "scope"];

/// What a column's name says: a sensor and its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Named {
    kind: Kind,
    axis: usize,
    /// uT, m/s^2 or rad/s in its unit; none where the name has no unit that is known.
    factor: Option<f64>,
    /// The more, the better it is among columns of one sensor and axis.
    rank: u8,
}

/// A name in small letters, without its unit, and the unit.
fn unit_of(name: &str) -> (String, Option<String>) {
    let name = name.trim().to_lowercase();
    let closing = [('(', ')'), ('[', ']')];
    let found = closing.iter().find_map(|(open, close)| {
        let (before, rest) = name.split_once(*open)?;
        Some((before.trim().to_owned(), rest.split(*close).next()?.trim().to_owned()))
    });
    found.map_or((name, None), |(before, unit)| (before, Some(unit)))
}

fn named(name: &str) -> Option<Named> {
    let (text, unit) = unit_of(name);
    let kind = sensor_in(&text)?;
    if ["bias", "offset", "drift", "accuracy", "time", "norm", "total"].iter().any(|word| text.contains(word)) {
        return None;
    }
    let last = text.chars().last()?;
    let axis = ['x', 'y', 'z'].iter().position(|axis| *axis == last)?;
    // "x" alone, the capital of "magnetometerX", or right behind the sensor's word, but not the end of "mag_max"
    let before = &text[..text.len() - 1];
    let capital = name.trim().split(['(', '[']).next()?.trim().ends_with(['X', 'Y', 'Z']);
    let is_behind_word = SENSOR_ENDS.iter().any(|end| before.ends_with(end));
    if before.ends_with(char::is_alphabetic) && !capital && !is_behind_word {
        return None;
    }
    let unit = unit.unwrap_or_default();
    let factor = match kind {
        Kind::Field | Kind::System => match unit.as_str() {
            "nt" => Some(1e-3),
            "mt" => Some(1e3),
            "t" => Some(1e6),
            "g" | "gauss" => Some(100.0),
            "mg" | "mgauss" => Some(0.1),
            // the micro sign has two code points, and one more in files of other encodings
            _ if unit.ends_with('t') && unit.chars().count() == 2 => Some(1.0),
            _ => None,
        },
        Kind::Rate => match unit.as_str() {
            "rad/s" => Some(1.0),
            "deg/s" | "dps" | "°/s" => Some(std::f64::consts::PI / 180.0),
            _ => None,
        },
        Kind::Up => match unit.as_str() {
            "m/s²" | "m/s^2" | "m/s2" | "m/s/s" => Some(1.0),
            "g" => Some(GRAVITY_M_S2),
            _ if unit.starts_with("m/s") => Some(1.0),
            _ => None,
        },
    };
    let rank =
        u8::from(text.contains("uncal")) + u8::from(!text.contains("grav")) + u8::from(!text.starts_with("motion"));
    Some(Named { kind, axis, factor, rank })
}

/// The sensor that a text names.
fn sensor_in(text: &str) -> Option<Kind> {
    let has = |words: &[&str]| words.iter().any(|word| text.contains(word));
    if has(&["linear", "user", "heading", "orient"]) {
        None
    } else if has(&["mag"]) {
        Some(Kind::Field)
    } else if has(&["gyr", "angular", "angvel", "rotationrate", "rotation_rate", "rotation rate"]) {
        Some(Kind::Rate)
    } else if has(&["acc", "grav"]) {
        Some(Kind::Up)
    } else {
        None
    }
}

/// The sensor that a file's name tells, of a table with columns x, y, z.
pub(super) fn sensor_of_stem(stem: &str) -> Option<Kind> {
    if stem.contains("lin") { None } else { sensor_in(stem) }
}

/// Units of time that a name tells, ns.
fn time_unit(name: &str) -> Option<i64> {
    let (text, unit) = unit_of(name);
    let of = |unit: &str| match unit {
        "s" | "sec" | "secs" | "seconds" => Some(SECOND_NS),
        "ms" | "millis" | "milliseconds" => Some(1_000_000),
        "us" | "µs" | "μs" | "micros" | "microseconds" => Some(1000),
        "ns" | "nanos" | "nanoseconds" | "nsec" => Some(1),
        _ => None,
    };
    let last = text.rsplit(|c: char| !c.is_alphanumeric()).find(|word| !word.is_empty()).unwrap_or_default();
    let ending = ["nanos", "millis", "micros"].into_iter().find(|ending| text.ends_with(ending));
    unit.as_deref().and_then(of).or_else(|| of(last)).or_else(|| of(ending?))
}

/// How much of a table a header tells: the columns of sensors.
pub(super) fn likeness(header: &[String]) -> usize {
    let axes = header.iter().filter(|name| named(name).is_some()).count();
    let xyz = ["x", "y", "z"].iter().all(|axis| header.iter().any(|name| name.eq_ignore_ascii_case(axis)));
    axes + if xyz { 1 } else { 0 }
}

/// What a header in words tells, of a file of that stem; none where it tells no sensor or no time.
pub(super) fn guess(document: &Document, units: &Units, rate_hz: Option<f64>) -> Option<Layout> {
    let sheet = Sheet::new(document);
    if !sheet.has_header() {
        return None;
    }
    let header = &sheet.header;
    let is_ios = header.iter().any(|name| name.starts_with("accelerometerTimestamp_sinceReboot"));
    let own_time = |start: &str| {
        let column = header.iter().position(|name| name.starts_with(&format!("{start}Timestamp_sinceReboot")))?;
        Some(Time::Columns(vec![(column, SECOND_NS)]))
    };
    let mut sensors = Vec::new();
    for (kind, start) in [(Kind::Field, "magnetometer"), (Kind::Up, "accelerometer"), (Kind::Rate, "gyro")] {
        let axis = |axis: usize| {
            let columns = header.iter().enumerate().filter_map(|(column, name)| Some((column, named(name)?)));
            let fitting = columns.filter(|(_, named)| named.kind == kind && named.axis == axis);
            // of equal ones the first
            fitting.min_by_key(|(column, named)| (u8::MAX - named.rank, *column))
        };
        let Some(axes) = axis(0).zip(axis(1)).zip(axis(2)).map(|((x, y), z)| [x, y, z]) else { continue };
        let named_factor = axes[0].1.factor.unwrap_or(1.0) * if is_ios && kind == Kind::Up { -1.0 } else { 1.0 };
        let given = match kind {
            Kind::Field | Kind::System => units.field,
            Kind::Up => units.acceleration,
            Kind::Rate => units.rate,
        };
        let time = if is_ios { own_time(start) } else { None };
        let columns = axes.map(|(column, _)| column);
        sensors.push(Taken { kind, columns, factor: given.unwrap_or(named_factor), time });
    }
    if sensors.is_empty() {
        let axis = |axis: &str| header.iter().position(|name| unit_of(name).0 == axis);
        let columns = [axis("x")?, axis("y")?, axis("z")?];
        let kind = sensor_of_stem(&document.stem())?;
        let factor = match kind {
            Kind::Field | Kind::System => units.field,
            Kind::Up => units.acceleration,
            Kind::Rate => units.rate,
        };
        sensors.push(Taken { kind, columns, factor: factor.unwrap_or(1.0), time: None });
    }
    let time = match (rate_hz, sensors.iter().find_map(|taken| taken.time.clone())) {
        (Some(hz), _) => Time::Rate(hz),
        (None, Some(own)) => own,
        (None, None) => {
            let column = time_column(header)?;
            let unit_ns = units.time_ns.or_else(|| time_unit(&header[column]));
            Time::Columns(vec![(column, unit_ns.or_else(|| step_unit(&sheet, column)).unwrap_or(SECOND_NS))])
        }
    };
    Some(Layout { time, sensors, attitude: None, course: None })
}

/// The column of the time: the one that is named so most plainly.
fn time_column(header: &[String]) -> Option<usize> {
    let rank = |name: &String| {
        let (text, _) = unit_of(name);
        match text.as_str() {
            "t" | "time" | "timestamp" | "t_s" | "time_s" | "seconds_elapsed" => Some(0),
            _ if text.contains("elapsed")
                || text.contains("since start")
                || text.contains("sensor") && text.contains("time") =>
            {
                Some(1)
            }
            _ if text.contains("timestamp") => Some(2),
            _ if text.starts_with("time") || text.ends_with("time") => Some(3),
            _ if text == "stamp" || text.starts_with("unix") => Some(4),
            _ => None,
        }
    };
    let ranked = header.iter().enumerate().filter_map(|(column, name)| Some((rank(name)?, column)));
    ranked.min().map(|(_, column)| column)
}

/// The unit in which the first steps of a time are those of a sensor: the one nearest to 10 ms; none of a date.
fn step_unit(sheet: &Sheet<'_>, column: usize) -> Option<i64> {
    let mut times = Vec::new();
    let _ = sheet.rows(|cells| {
        let time = cells.number(column)?;
        times.push(time);
        if times.len() < 200 { Ok(()) } else { Err(cells.wrong(column, "enough")) }
    });
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    let step = *steps.get(steps.len() / 2)?;
    let off = |unit_ns: &i64| (step * *unit_ns as f64 / 1e7).ln().abs();
    [SECOND_NS, 1_000_000, 1000, 1].into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))
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

/// Whether all these names are numbers of columns.
pub(super) fn are_numbers<'a>(mut names: impl Iterator<Item = &'a str>) -> bool {
    names.all(|name| numbered(name).is_some())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_columns_tell_sensor_axis_and_unit() {
        for (name, kind, axis, factor) in [
            ("MAGNETIC FIELD Y (\u{3bc}T)", Kind::Field, 1, Some(1.0)),
            ("magnetometerX(\u{b5}T)", Kind::Field, 0, Some(1.0)),
            ("mag_z", Kind::Field, 2, None),
            ("ACCELEROMETER X (m/s\u{b2})", Kind::Up, 0, Some(1.0)),
            ("accelerometerAccelerationZ(G)", Kind::Up, 2, Some(GRAVITY_M_S2)),
            ("GYROSCOPE Z (rad/s)", Kind::Rate, 2, Some(1.0)),
            ("gyroRotationX(rad/s)", Kind::Rate, 0, Some(1.0)),
            ("Gyro y [deg/s]", Kind::Rate, 1, Some(std::f64::consts::PI / 180.0)),
            ("accx", Kind::Up, 0, None),
        ] {
            let found = named(name).unwrap_or_else(|| panic!("{name}"));
            assert_eq!((found.kind, found.axis, found.factor), (kind, axis, factor), "{name}");
        }
        for name in [
            "LINEAR ACCELERATION X (m/s\u{b2})",
            "motionUserAccelerationX(G)",
            "mag_max",
            "magnetometer accuracy",
            "x",
            "UncalMagBiasX",
            "locationHeadingX(\u{b5}T)",
        ] {
            assert_eq!(named(name), None, "{name}");
        }
        assert_eq!(time_unit("Time since start in ms "), Some(1_000_000));
        assert_eq!(time_unit("elapsedRealtimeNanos"), Some(1));
        assert_eq!(
            [time_unit("time (s)"), time_unit("Timestamp [ms]"), time_unit("time")],
            [Some(SECOND_NS), Some(1_000_000), None]
        );
        assert_eq!(split_sum("secs+1e-9*nsecs"), ["secs", "1e-9*nsecs"]);
        assert_eq!(split_sum("a+1e+3*b"), ["a", "1e+3*b"]);
    }
}
