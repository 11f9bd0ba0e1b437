//! A sensor hangs that repeats a reading, to the last bit, while the device turns. At rest one without noise, or with a coarse last bit, repeats it for hours.
//!
//! ```text
//! s <- max(0, s + turn - B dt),   t <- max(0, t - turn - B dt)     for each axis, since the sensor last read something else
//! the device has turned where one of them is above 0.3 rad         B: the largest bias, which turns a device at rest either way
//! ```
//! Trembling goes to and fro and adds up to nothing. In the Earth's weakest field 0.3 rad are 6 uT, more than the last bit of any magnetometer; but a device
//! that turns slower than B, or about the field's own direction, shows nothing.

use super::pairing::Rotation;
use super::turning::LARGEST_BIAS_RAD_S;
use crate::priors::HAND_RAD;
use nalgebra::Vector3;

/// How far the gyroscope has turned the device, by more than a bias could: s and t.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Turned {
    forth_rad: Vector3<f64>,
    back_rad: Vector3<f64>,
}

impl Turned {
    /// A rotation, and how long it took, s.
    pub fn add(&mut self, rotation: &Rotation, span_s: f64) {
        let left = |rad: f64| (rad - LARGEST_BIAS_RAD_S * span_s).max(0.0);
        self.forth_rad = (self.forth_rad + rotation.increment_rad).map(left);
        self.back_rad = (self.back_rad - rotation.increment_rad).map(left);
    }

    /// About the axis that it turned most about, rad.
    pub fn angle_rad(&self) -> f64 {
        self.forth_rad.max().max(self.back_rad.max())
    }
}

/// Whether a sensor that repeats its reading hangs where the device has turned by so much meanwhile, rad.
pub(crate) fn hangs(turned_rad: f64) -> bool {
    turned_rad > HAND_RAD
}

#[cfg(test)]
mod tests {
    use super::*;

    /// At 100 Hz; what has to be true of the turn after so many seconds.
    fn turned(seconds: f64, rate_rad_s: impl Fn(f64) -> Vector3<f64>) -> bool {
        let mut turned = Turned::default();
        for k in 0..(seconds * 100.0) as i32 {
            let rate_rad_s = rate_rad_s(f64::from(k) * 0.01);
            turned.add(&Rotation { increment_rad: rate_rad_s * 0.01, rate_rad_s, variance_rad2: 0.0 }, 0.01);
        }
        hangs(turned.angle_rad())
    }

    #[test]
    fn a_turn_is_seen_about_each_axis_either_way() {
        for axis in 0..3 {
            for sign in [-1.0, 1.0] {
                let rate_rad_s = Vector3::ith(axis, sign * 0.6);
                assert!(!turned(0.5, |_| rate_rad_s) && turned(0.7, |_| rate_rad_s), "{axis}, {sign}");
            }
        }
    }

    /// A data sheet's worst bias for an hour, and a phone that trembles by half a degree at 8 Hz.
    #[test]
    fn neither_a_bias_nor_a_tremble_is_a_turn() {
        assert!(!turned(3600.0, |_| Vector3::new(0.0999, -0.0999, 0.05)));
        assert!(!turned(600.0, |t| Vector3::new(0.09 + 0.45 * (50.0 * t).cos(), 0.0, -0.02)));
    }
}
