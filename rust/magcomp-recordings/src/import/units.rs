//! Units and axes of a file, as options name them.

use magcomp::nalgebra::{Matrix3, Vector3};
use std::str::FromStr;

pub(super) const GRAVITY_M_S2: f64 = 9.80665;
const MILLI: f64 = 1e-3;

/// Names and factors to nanoseconds.
const TIMES: [(&str, f64); 4] = [("s", 1e9), ("ms", 1e6), ("us", 1e3), ("ns", 1.0)];
/// Names and factors to microtesla.
const FIELDS: [(&str, f64); 6] = [("uT", 1.0), ("nT", MILLI), ("mT", 1e3), ("T", 1e6), ("G", 100.0), ("mG", 0.1)];
/// Names and factors to rad/s.
const RATES: [(&str, f64); 2] = [("rad/s", 1.0), ("deg/s", std::f64::consts::PI / 180.0)];
/// Names and factors to m/s^2 with Android's sign; Apple's sign is the other one.
const ACCELERATIONS: [(&str, f64); 4] = [("m/s2", 1.0), ("g", GRAVITY_M_S2), ("-m/s2", -1.0), ("-g", -GRAVITY_M_S2)];

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

/// Which of a file's axes point right, up along the screen, and out of it.
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
        let expected = || "expected three axes such as x,y,z or y,-x,z".to_owned();
        let mut matrix: Matrix3<f64> = Matrix3::zeros();
        let axes: Vec<&str> = text.split(',').map(str::trim).collect();
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
        for wrong in ["x,y", "x,x,z", "y,x,z", "x,y,w", "m=x,y", "b=x,y,z"] {
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
