//! Units and axes of a file, as options name them.

use magcomp::nalgebra::{Matrix3, Vector3};
use std::str::FromStr;

/// Standard gravity, m/s^2.
pub(super) const GRAVITY_M_S2: f64 = 9.80665;
const MILLI: f64 = 1e-3;

/// Names and factors to nanoseconds.
const TIMES: [(&str, i64); 4] = [("s", 1_000_000_000), ("ms", 1_000_000), ("us", 1000), ("ns", 1)];
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
                "t" => units.time_ns = Some(factor(&TIMES, unit)?),
                "m" => units.field = Some(factor(&FIELDS, unit)?),
                "g" => units.rate = Some(factor(&RATES, unit)?),
                "a" => units.acceleration = Some(factor(&ACCELERATIONS, unit)?),
                _ => return Err(format!("'{name}' is none of t (time), m (field), g (gyroscope), a (accelerometer)")),
            }
        }
        Ok(units)
    }
}

fn factor<T: Copy>(units: &[(&str, T)], name: &str) -> Result<T, String> {
    let names = || units.iter().map(|(name, _)| *name).collect::<Vec<_>>().join(", ");
    let found = units.iter().find(|(unit, _)| *unit == name);
    found.map(|(_, factor)| *factor).ok_or_else(|| format!("'{name}' is none of {}", names()))
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
        match matrix.determinant().round() as i32 {
            1 => Ok(Self(matrix)),
            -1 => Err("these axes mirror the device; a right-handed frame changes the sign of one or three".to_owned()),
            _ => Err("each axis must come once".to_owned()),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_and_axes_are_read_or_refused_with_a_reason() {
        let units: Units = "t=ms,a=-g".parse().unwrap();
        assert_eq!((units.time_ns, units.acceleration), (Some(1_000_000), Some(-GRAVITY_M_S2)));
        assert_eq!("m=gauss".parse::<Units>().unwrap_err(), "'gauss' is none of uT, nT, mT, T, G, mG");
        assert!("x=1".parse::<Units>().is_err() && "t".parse::<Units>().is_err());
        let frame: Frame = "y,-x,z".parse().unwrap();
        assert_eq!(frame.turn(&Vector3::new(1.0, 2.0, 3.0)), Vector3::new(2.0, -1.0, 3.0));
        for wrong in ["x,y", "x,x,z", "y,x,z", "x,y,w"] {
            assert!(wrong.parse::<Frame>().is_err(), "{wrong}");
        }
    }
}
