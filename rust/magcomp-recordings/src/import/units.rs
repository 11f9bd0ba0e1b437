//! Units and axes of a file, as options, names of columns and rows of units have them.

use magcomp::nalgebra::{Matrix3, Rotation3, Vector3};
use std::str::FromStr;

pub(super) const GRAVITY_M_S2: f64 = 9.80665;
const MILLI: f64 = 1e-3;
const DEGREE: f64 = std::f64::consts::PI / 180.0;

/// Names and factors to nanoseconds.
const TIMES: [(&str, f64); 4] = [("s", 1e9), ("ms", 1e6), ("us", 1e3), ("ns", 1.0)];
/// Names and factors to microtesla.
const FIELDS: [(&str, f64); 6] = [("uT", 1.0), ("nT", MILLI), ("mT", 1e3), ("T", 1e6), ("G", 100.0), ("mG", 0.1)];
/// Names and factors to rad/s.
const RATES: [(&str, f64); 2] = [("rad/s", 1.0), ("deg/s", DEGREE)];
/// Names and factors to m/s^2 with Android's sign; Apple's sign is the other one.
const ACCELERATIONS: [(&str, f64); 4] = [("m/s2", 1.0), ("g", GRAVITY_M_S2), ("-m/s2", -1.0), ("-g", -GRAVITY_M_S2)];

/// The sensors of a session, in the order of a table's columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Field,
    Up,
    Rate,
    System,
}

impl Kind {
    pub fn word(self) -> &'static str {
        match self {
            Self::Field => "field",
            Self::Up => "acceleration",
            Self::Rate => "rotation rate",
            Self::System => "the system's field",
        }
    }
}

/// A sensor whose columns were not taken: the first of them, and how many there are.
pub(super) type LeftOver = (Kind, String, usize);

/// The name of a column in small letters without its unit, and the unit: `gyro y` and `deg/s` of `Gyro y [deg/s]`.
pub(super) fn parted(name: &str) -> (String, Option<String>) {
    let name = name.trim().to_lowercase();
    let closing = [('(', ')'), ('[', ']')];
    let found = closing.iter().find_map(|(open, close)| {
        let (before, rest) = name.split_once(*open)?;
        Some((before.trim().to_owned(), rest.split(*close).next()?.trim().to_owned()))
    });
    found.map_or((name, None), |(before, unit)| (before, Some(unit)))
}

/// uT, m/s^2 or rad/s in a unit in small letters, as names of columns and rows of units write it; none where it is no unit of that sensor.
/// Signs that a file's encoding broke are one character that is no letter.
pub(super) fn written_factor(kind: Kind, unit: &str) -> Option<f64> {
    let ends_broken = |end: &str| {
        let before = unit.strip_suffix(end);
        before.is_some_and(|sign| sign.chars().count() == 1 && !sign.is_ascii())
    };
    match kind {
        Kind::Field | Kind::System => match unit {
            "ut" | "microtesla" => Some(1.0),
            "nt" => Some(MILLI),
            "mt" => Some(1e3),
            "t" | "tesla" => Some(1e6),
            "g" | "gauss" => Some(100.0),
            "mg" | "mgauss" => Some(0.1),
            // the micro sign has two code points
            _ => ends_broken("t").then_some(1.0),
        },
        Kind::Rate => match unit {
            "rad/s" | "rad/sec" => Some(1.0),
            "deg/s" | "deg/sec" | "degrees/s" | "dps" => Some(DEGREE),
            _ => ends_broken("/s").then_some(DEGREE),
        },
        Kind::Up => match unit {
            "m/s2" | "m/s^2" | "m/s/s" | "m/s**2" | "ms-2" => Some(1.0),
            "g" => Some(GRAVITY_M_S2),
            "mg" => Some(MILLI * GRAVITY_M_S2),
            _ => unit.strip_prefix("m/s").filter(|sign| sign.chars().count() == 1 && !sign.is_ascii()).map(|_| 1.0),
        },
    }
}

/// The only sensor that has this unit; none of `g` and `mg`, which are an acceleration's and a field's, and of `t`.
pub(super) fn sensor_of_unit(unit: &str) -> Option<Kind> {
    if ["g", "mg", "t"].contains(&unit) {
        return None;
    }
    [Kind::Field, Kind::Up, Kind::Rate].into_iter().find(|kind| written_factor(*kind, unit).is_some())
}

/// Nanoseconds in a unit of time in small letters.
pub(super) fn written_time_ns(unit: &str) -> Option<i64> {
    match unit {
        "s" | "sec" | "secs" | "second" | "seconds" => Some(1_000_000_000),
        "ms" | "msec" | "millis" | "milliseconds" => Some(1_000_000),
        "us" | "usec" | "\u{b5}s" | "\u{3bc}s" | "micros" | "microseconds" => Some(1000),
        "ns" | "nsec" | "nanos" | "nanoseconds" => Some(1),
        _ => None,
    }
}

/// The unit of time that a name tells, ns.
pub(super) fn time_unit(name: &str) -> Option<i64> {
    let (text, unit) = parted(name);
    let last = text.rsplit(|c: char| !c.is_alphanumeric()).find(|word| !word.is_empty()).unwrap_or_default();
    let ending = ["nanos", "millis", "micros"].into_iter().find(|ending| text.ends_with(ending));
    unit.as_deref().and_then(written_time_ns).or_else(|| written_time_ns(last)).or_else(|| written_time_ns(ending?))
}

/// Units of a file's columns; a unit that was not given is none.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Units {
    /// Nanoseconds in a unit of time.
    pub(super) time_ns: Option<i64>,
    /// Microtesla in a unit of the field.
    pub(super) field: Option<f64>,
    /// rad/s in a unit of the rotation rate.
    pub(super) rate: Option<f64>,
    /// m/s^2 in a unit of the acceleration, negative for Apple's sign.
    pub(super) acceleration: Option<f64>,
}

impl Units {
    /// The factor of a sensor's unit, where it was given.
    pub(super) fn factor(&self, kind: Kind) -> Option<f64> {
        match kind {
            Kind::Field | Kind::System => self.field,
            Kind::Up => self.acceleration,
            Kind::Rate => self.rate,
        }
    }
}

impl FromStr for Units {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut units = Self::default();
        for part in text.split(',') {
            let (name, unit) = part.trim().split_once('=').ok_or("expected such as t=ms,m=uT,g=deg/s,a=g")?;
            match name {
                "t" => {
                    // a number is one of seconds
                    let named = TIMES.iter().any(|(name, _)| *name == unit);
                    let ns = factor(&TIMES, unit)? * if named { 1.0 } else { 1e9 };
                    let whole = (1.0..=1e18).contains(&ns).then_some(ns.round() as i64);
                    units.time_ns = Some(whole.ok_or("a unit of time is 1e-9 to 1e9 seconds")?);
                }
                "m" => units.field = Some(factor(&FIELDS, unit)?),
                "g" => units.rate = Some(factor(&RATES, unit)?),
                "a" => units.acceleration = Some(factor(&ACCELERATIONS, unit)?),
                _ => return Err(format!("'{name}' is none of t (time), m (field), g (gyroscope), a (accelerometer)")),
            }
        }
        Ok(units)
    }
}

/// The factor of a unit: one of those that have a name, or any number but 0.
fn factor(units: &[(&str, f64)], name: &str) -> Result<f64, String> {
    let names = || units.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    let found = units.iter().find(|(unit, _)| *unit == name).map(|(_, factor)| *factor);
    let number = || name.parse().ok().filter(|factor: &f64| factor.is_finite() && *factor != 0.0);
    found.or_else(number).ok_or_else(|| format!("'{name}' is no number and none of {}", names()))
}

/// Which of a file's axes point right, up along the screen, and out of it; a fourth number turns them about the screen's normal, degrees, anticlockwise
/// seen from the front.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame(Matrix3<f64>);

impl Default for Frame {
    fn default() -> Self {
        Self(Matrix3::identity())
    }
}

impl Frame {
    /// A vector in the device's axes.
    pub(super) fn turn(&self, v: &Vector3<f64>) -> Vector3<f64> {
        self.0 * v
    }

    fn is_mirror(&self) -> bool {
        self.0.determinant() < 0.0
    }
}

impl FromStr for Frame {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected =
            || "expected three axes such as x,y,z or y,-x,z, and degrees where they are askew: x,y,z,-12".to_owned();
        let mut matrix: Matrix3<f64> = Matrix3::zeros();
        let mut axes: Vec<&str> = text.split(',').map(str::trim).collect();
        let mut askew_deg = 0.0;
        if axes.len() == 4 {
            let degrees = axes.pop().and_then(|text| text.parse().ok()).filter(|deg: &f64| deg.abs() <= 180.0);
            askew_deg = degrees.ok_or_else(expected)?;
        }
        if axes.len() != 3 {
            return Err(expected());
        }
        for (row, axis) in axes.iter().enumerate() {
            let (sign, name) = axis.strip_prefix('-').map_or((1.0, *axis), |name| (-1.0, name));
            let column = ["x", "y", "z"].iter().position(|known| *known == name).ok_or_else(expected)?;
            matrix[(row, column)] = sign;
        }
        if matrix.determinant() == 0.0 {
            return Err("each axis must come once".to_owned());
        }
        // `x,y,z` stays exact
        if askew_deg != 0.0 {
            matrix = Rotation3::from_axis_angle(&Vector3::z_axis(), f64::to_radians(askew_deg)) * matrix;
        }
        Ok(Self(matrix))
    }
}

/// The axes of each sensor: `y,-x,z` for all of them; `m=-x,y,z` for the magnetometer alone, with `a=` and `g=` for accelerometer and
/// gyroscope, more of them behind semicolons.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Frames {
    /// Of the magnetometer, and of the field that the system calibrated.
    pub(super) field: Frame,
    pub(super) up: Frame,
    pub(super) rate: Frame,
}

impl FromStr for Frames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut frames = Self::default();
        for part in text.split(';') {
            let (sensor, axes) =
                part.split_once('=').map_or((None, part), |(sensor, axes)| (Some(sensor.trim()), axes));
            let frame: Frame = axes.parse()?;
            match sensor {
                None if frame.is_mirror() => {
                    let why = "these axes mirror the device; a right-handed frame changes the sign of one or three";
                    return Err(format!("{why} (one sensor alone may be mirrored: m={axes})"));
                }
                None => frames = Self { field: frame, up: frame, rate: frame },
                Some("m") => frames.field = frame,
                Some("a") => frames.up = frame,
                Some("g") => frames.rate = frame,
                Some(other) => return Err(format!("'{other}' is none of m (field), a (accelerometer), g (gyroscope)")),
            }
        }
        Ok(frames)
    }
}

/// Seconds that are added to the times of a sensor: `m=-0.03`, with `a=` and `g=` for accelerometer and gyroscope.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shifts {
    /// Of the magnetometer, and of the field that the system calibrated, ns.
    pub(super) field_ns: i64,
    pub(super) up_ns: i64,
    pub(super) rate_ns: i64,
}

impl FromStr for Shifts {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut shifts = Self::default();
        for part in text.split(',') {
            let (sensor, seconds) = part.trim().split_once('=').ok_or("expected such as m=-0.03")?;
            let seconds: f64 = seconds.parse().map_err(|_| format!("'{seconds}' is no number of seconds"))?;
            if seconds.is_nan() || seconds.abs() >= 4e9 {
                return Err(format!("'{seconds}' is no number of seconds"));
            }
            let shift = match sensor {
                "m" => &mut shifts.field_ns,
                "a" => &mut shifts.up_ns,
                "g" => &mut shifts.rate_ns,
                other => return Err(format!("'{other}' is none of m (field), a (accelerometer), g (gyroscope)")),
            };
            *shift = (seconds * 1e9).round() as i64;
        }
        Ok(shifts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_axes_are_read_or_refused_with_a_reason() {
        let units: Units = "t=ms,a=-g".parse().unwrap();
        assert_eq!((units.time_ns, units.acceleration), (Some(1_000_000), Some(-GRAVITY_M_S2)));
        assert_eq!("m=gauss".parse::<Units>().unwrap_err(), "'gauss' is no number and none of uT, nT, mT, T, G, mG");
        let units: Units = "t=1e-6,m=1e-4,a=-0.5".parse().unwrap();
        assert_eq!((units.time_ns, units.field, units.acceleration), (Some(1000), Some(1e-4), Some(-0.5)));
        for wrong in ["m=0", "m=inf", "t=-1", "t=1e-12", "g=nan"] {
            assert!(wrong.parse::<Units>().is_err(), "{wrong}");
        }
        assert!("x=1".parse::<Units>().is_err() && "t".parse::<Units>().is_err());
        let frame: Frame = "y,-x,z".parse().unwrap();
        assert_eq!(frame.turn(&Vector3::new(1.0, 2.0, 3.0)), Vector3::new(2.0, -1.0, 3.0));
        let frame: Frame = "x,y,z,90".parse().unwrap();
        assert!((frame.turn(&Vector3::new(1.0, 2.0, 3.0)) - Vector3::new(-2.0, 1.0, 3.0)).norm() < 1e-12);
        for wrong in ["x,y,z,200", "x,y,z,nan", "x,y,z,1,2", "x,y", "x,x,z", "y,x,z", "x,y,w", "m=x,y", "b=x,y,z"] {
            assert!(wrong.parse::<Frames>().is_err(), "{wrong}");
        }
        let frames: Frames = "m=-x,y,z;g=y,-x,z".parse().unwrap();
        let turned = [frames.field, frames.up, frames.rate].map(|frame| frame.turn(&Vector3::new(1.0, 2.0, 3.0)));
        assert_eq!(turned, [[-1.0, 2.0, 3.0], [1.0, 2.0, 3.0], [2.0, -1.0, 3.0]].map(Vector3::from));
        let shifts: Shifts = "m=-0.03,g=1000".parse().unwrap();
        assert_eq!(shifts, Shifts { field_ns: -30_000_000, up_ns: 0, rate_ns: 1_000_000_000_000 });
        assert!(
            "m".parse::<Shifts>().is_err() && "m=nan".parse::<Shifts>().is_err() && "x=1".parse::<Shifts>().is_err()
        );
    }
}
