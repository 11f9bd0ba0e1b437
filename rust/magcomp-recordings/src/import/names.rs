//! What a header in words and a file's name say: sensors, axes, units, and the time.

use super::document::Document;
use super::layout::{Layout, SECOND_NS, Taken, Time};
use super::sheet::Sheet;
use super::units::{GRAVITY_M_S2, Kind, LeftOver, Units, parted, sensor_of_unit, written_factor};

/// Ends of a sensor's word, behind which its axis may stand without a mark.
const SENSOR_ENDS: [&str; 9] = ["mag", "magn", "meter", "field", "acc", "accel", "gyr", "gyro", "scope"];

/// Names of one or two letters before the axis: sensor, factor where the name implies one, and rank. The acceleration in g of `gFx` has gravity in
/// it, that of `ax` beside it has none.
const SHORT: [(&str, Kind, Option<f64>, u8); 6] = [
    ("gf", Kind::Up, Some(GRAVITY_M_S2), 3),
    ("m", Kind::Field, None, 2),
    ("a", Kind::Up, None, 2),
    ("g", Kind::Rate, None, 2),
    ("w", Kind::Rate, None, 2),
    ("b", Kind::Field, None, 1),
];
/// The rank of a name with the word of an uncalibrated sensor.
const BEST: u8 = 8;
/// A name that holds one of these is of no sensor that is read, or of something that was made of one.
const OTHERS: [&str; 11] =
    ["linear", "user", "heading", "orient", "bias", "offset", "drift", "accuracy", "time", "norm", "total"];

/// What a column's name says: a sensor and its axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Named {
    pub kind: Kind,
    pub axis: usize,
    /// uT, m/s^2 or rad/s in its unit; none where the name has no unit that is known.
    pub factor: Option<f64>,
    /// The more, the better it is among columns of one sensor and axis.
    rank: u8,
    is_uncalibrated: bool,
}

/// What the name of a column says: by the sensor's word in it, else by its unit, else by its letter.
pub(super) fn named(name: &str) -> Option<Named> {
    let (text, unit) = parted(name);
    let unit = unit.unwrap_or_default();
    if OTHERS.iter().any(|word| text.contains(word)) {
        return None;
    }
    let last = text.chars().last()?;
    let axis = ['x', 'y', 'z'].iter().position(|axis| *axis == last)?;
    let before = &text[..text.len() - 1];
    let is_uncalibrated = text.contains("uncal");
    if let Some((_, kind, implied, rank)) = SHORT.into_iter().find(|(letters, ..)| *letters == before) {
        let factor = written_factor(kind, &unit).or(implied);
        return Some(Named { kind, axis, factor, rank, is_uncalibrated });
    }
    let by_word = sensor_in(&text);
    let kind = by_word.or_else(|| sensor_of_unit(&unit))?;
    // "x" alone, the capital of "magnetometerX", or right behind the sensor's word, but not the end of "mag_max"
    let capital = name.trim().split(['(', '[']).next()?.trim().ends_with(['X', 'Y', 'Z']);
    let is_behind_word = SENSOR_ENDS.iter().any(|end| before.ends_with(end));
    if before.ends_with(char::is_alphabetic) && !capital && !is_behind_word {
        return None;
    }
    let rank = match by_word {
        None => 4,
        Some(_) => {
            5 + u8::from(is_uncalibrated) + u8::from(!text.contains("grav")) + u8::from(!text.starts_with("motion"))
        }
    };
    Some(Named { kind, axis, factor: written_factor(kind, &unit), rank, is_uncalibrated })
}

/// The sensor that a text in small letters names.
pub(super) fn sensor_in(text: &str) -> Option<Kind> {
    // angular velocity as `ang_vel`, `ang. vel.` or `angVel`
    let letters: String = text.chars().filter(|letter| letter.is_alphanumeric()).collect();
    let letters = letters.replace("magnitude", "");
    let has = |words: &[&str]| words.iter().any(|word| letters.contains(word));
    if has(&["linear", "user", "heading", "orient"]) {
        None
    } else if has(&["mag"]) {
        Some(Kind::Field)
    } else if has(&["gyr", "angular", "angvel", "angrate", "rotationrate", "rotrate", "turnrate"]) {
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

/// Sensors of a table whose columns were not taken: the sensor, the first such column, and how many there are of it.
pub(super) fn left_over(header: &[String], is_taken: impl Fn(usize) -> bool) -> Vec<LeftOver> {
    let mut found: Vec<LeftOver> = Vec::new();
    for (_, name) in header.iter().enumerate().filter(|(column, _)| !is_taken(*column)) {
        let Some(named) = named(name) else { continue };
        match found.iter_mut().find(|(kind, ..)| *kind == named.kind) {
            Some((.., count)) => *count += 1,
            None => found.push((named.kind, name.clone(), 1)),
        }
    }
    // an axis alone is no sensor
    found.retain(|(.., count)| *count >= 3);
    found
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
    let factor_of = |kind, column: usize, implied: Option<f64>| {
        let written = || sheet.unit(column).and_then(|unit| written_factor(kind, &unit));
        units.factor(kind).or_else(written).or(implied).unwrap_or(1.0)
    };
    let mut sensors = Vec::new();
    for (kind, start) in [(Kind::Field, "magnetometer"), (Kind::Up, "accelerometer"), (Kind::Rate, "gyro")] {
        let Some((columns, best)) = triple(header, |named| named.kind == kind) else { continue };
        let sign = if is_ios && kind == Kind::Up && units.acceleration.is_none() { -1.0 } else { 1.0 };
        let factor = sign * factor_of(kind, columns[0], best.factor);
        let time = if is_ios { own_time(start) } else { None };
        sensors.push(Taken { kind, columns, factor, time });
        if kind == Kind::Field
            && best.is_uncalibrated
            && let Some((columns, best)) = triple(header, |named| named.kind == kind && !named.is_uncalibrated)
        {
            let factor = factor_of(kind, columns[0], best.factor);
            sensors.push(Taken { kind: Kind::System, columns, factor, time: None });
        }
    }
    if sensors.is_empty() {
        let axis = |axis: &str| header.iter().position(|name| parted(name).0 == axis);
        let columns = [axis("x")?, axis("y")?, axis("z")?];
        let kind = sensor_of_stem(&document.stem())?;
        sensors.push(Taken { kind, columns, factor: factor_of(kind, columns[0], None), time: None });
    }
    let (time, is_time_told) = match (rate_hz, sensors.iter().find_map(|taken| taken.time.clone())) {
        (Some(hz), _) => (Time::Rate(hz), true),
        (None, Some(own)) => (own, true),
        (None, None) => {
            let column = time_column(header)?;
            let told_ns = units.time_ns.or_else(|| sheet.time_unit(column));
            let unit_ns = told_ns.or_else(|| step_unit(&sheet, column)).unwrap_or(SECOND_NS);
            (Time::Columns(vec![(column, unit_ns)]), told_ns.is_some() || sheet.has_dates(column))
        }
    };
    Some(Layout { time, is_time_told, sensors, attitude: None, course: None })
}

/// The best of the columns of a sensor whose three axes are all there, and what its name says; of equal ones the first.
fn triple(header: &[String], fits: impl Fn(&Named) -> bool) -> Option<([usize; 3], Named)> {
    let all = header.iter().enumerate().filter_map(|(column, name)| Some((column, named(name)?)));
    let fitting: Vec<(usize, Named)> = all.filter(|(_, named)| fits(named)).collect();
    let of_rank = |rank: u8| {
        let axis = |axis: usize| fitting.iter().find(|(_, named)| named.rank == rank && named.axis == axis);
        let (x, y, z) = (axis(0)?, axis(1)?, axis(2)?);
        Some(([x.0, y.0, z.0], x.1))
    };
    (0..=BEST).rev().find_map(of_rank)
}

/// The column of the time: the one that is named so most plainly.
fn time_column(header: &[String]) -> Option<usize> {
    let rank = |name: &String| {
        let (text, _) = parted(name);
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

/// The unit in which the first steps of a table's time are those of a sensor; none of a date.
fn step_unit(sheet: &Sheet<'_>, column: usize) -> Option<i64> {
    let mut times = Vec::new();
    let _ = sheet.rows(|cells| {
        let time = cells.number(column)?;
        times.push(time);
        if times.len() < 200 { Ok(()) } else { Err(cells.wrong(column, "enough")) }
    });
    unit_of_steps(&times)
}

/// The unit in which the usual step of these times comes nearest to 10 ms; none where no time is later than the one before.
pub(super) fn unit_of_steps(times: &[f64]) -> Option<i64> {
    let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).filter(|step| *step > 0.0).collect();
    steps.sort_by(f64::total_cmp);
    let step = *steps.get(steps.len() / 2)?;
    let off = |unit_ns: &i64| (step * *unit_ns as f64 / 1e7).ln().abs();
    [SECOND_NS, 1_000_000, 1000, 1].into_iter().min_by(|a, b| off(a).total_cmp(&off(b)))
}

#[cfg(test)]
mod tests {
    use super::super::units::time_unit;
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
