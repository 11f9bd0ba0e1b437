//! What a header in words and a file's name say: sensors, axes, units, and the time.

use super::document::Document;
use super::layout::{Layout, SECOND_NS, Taken, Time};
use super::session::Kind;
use super::sheet::Sheet;
use super::units::{GRAVITY_M_S2, Units};

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
        let given = factor_of(kind, units);
        let time = if is_ios { own_time(start) } else { None };
        let columns = axes.map(|(column, _)| column);
        sensors.push(Taken { kind, columns, factor: given.unwrap_or(named_factor), time });
    }
    if sensors.is_empty() {
        let axis = |axis: &str| header.iter().position(|name| unit_of(name).0 == axis);
        let columns = [axis("x")?, axis("y")?, axis("z")?];
        let kind = sensor_of_stem(&document.stem())?;
        sensors.push(Taken { kind, columns, factor: factor_of(kind, units).unwrap_or(1.0), time: None });
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

/// The factor of a sensor's unit that was given.
pub(super) fn factor_of(kind: Kind, units: &Units) -> Option<f64> {
    match kind {
        Kind::Field | Kind::System => units.field,
        Kind::Up => units.acceleration,
        Kind::Rate => units.rate,
    }
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
    }
}
