//! Whether gravity and the corrected field keep their angle however the device turns. Where they do not, and would with the accelerometer's axes turned or
//! mirrored, an app has mixed up two frames: nobody knows where up is.
//!
//! ```text
//! z = <a' c>: the mean over a window of gravity (in g) along the field's direction;   z_G: with G a in place of a, G one of the 24 right-handed frames
//! G explains it better where   n/2 ln((var z + s^2) / (var z_G + s^2)) > 4^2 / 2 + ln 100        over n windows, forgotten over 50; s: what a tilt makes
//! ```
//! A gravity that points the other way keeps its angle, too: that only a place's known dip tells. Of 43 recordings of sound phones the most is 9; without the
//! gyroscope it is more in three, where magnets had moved c by tens of degrees.

use super::turning::{AS_READ, Frame, KEPT, frames, is_no_chance};
use crate::math::elementary::ln;
use crate::priors::{STEP_S, TILT_RAD};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{SMatrix, SVector, Vector3};

/// The products of gravity's components and the field's: row by row.
type Products = SVector<f64, 9>;

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Dip {
    sum: Products,
    samples: f64,
    length_s: f64,
    windows: f64,
    first: Products,
    second: SMatrix<f64, 9, 9>,
    /// Gravity's axes are not those of the field.
    pub has_other_axes: bool,
}

impl Dip {
    /// One sample: gravity and the corrected field, in g and of any length, and the time since the one before, s.
    pub fn see(&mut self, up: &Vector3<f64>, field: &Vector3<f64>, span_s: f64) {
        self.sum += Products::from_column_slice((field.normalize() * up.transpose()).as_slice());
        self.samples += 1.0;
        self.length_s += span_s;
        if self.length_s >= STEP_S {
            let mean = self.sum / self.samples;
            self.windows = self.windows * KEPT + 1.0;
            self.first = self.first * KEPT + mean;
            self.second = self.second * KEPT + mean * mean.transpose();
            (self.sum, self.samples, self.length_s) = (Products::zeros(), 0.0, 0.0);
            // the device's tilt, and as much again by its motion
            let tilts = (2.0 * TILT_RAD).powi(2);
            let as_read = self.variance(AS_READ);
            let explains = |least: f64| is_no_chance(0.5 * self.windows * ln((as_read + tilts) / (least + tilts)));
            let least = || frames(1.0).map(|frame| self.variance(frame)).fold(f64::INFINITY, f64::min);
            self.has_other_axes = explains(0.0) && explains(least());
        }
    }

    /// Of z_G.
    fn variance(&self, frame: Frame) -> f64 {
        let part = |k: usize| (3 * frame[k].0 + k, frame[k].1);
        let mean: f64 = (0..3).map(|k| part(k).1 * self.first[part(k).0]).sum::<f64>() / self.windows;
        let square = |i: usize, k: usize| part(i).1 * part(k).1 * self.second[(part(i).0, part(k).0)];
        let square: f64 = (0..3).map(|i| (0..3).map(|k| square(i, k)).sum::<f64>()).sum();
        (square / self.windows - mean * mean).max(0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Matrix3, Rotation3};

    /// A hand turns a device about, and moves it; its accelerometer reads `axes` times what it should, its field is off by `left_ut`.
    fn turned(seconds: f64, axes: Matrix3<f64>, left_ut: Vector3<f64>) -> bool {
        let mut dip = Dip::default();
        let mut attitude = Rotation3::identity();
        for k in 0..(seconds * 50.0) as i32 {
            let t = f64::from(k) * 0.02;
            let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin());
            attitude *= Rotation3::new(rate * 0.02);
            let shaken = Vector3::new((11.9 * t).sin(), (12.3 * t).cos(), (23.0 * t).sin()) * 0.3;
            let up = attitude.inverse() * Vector3::new(0.0, 0.0, 1.0) + shaken;
            dip.see(&(axes * up), &(attitude.inverse() * Vector3::new(0.0, 25.0, -43.0) + left_ut), 0.02);
        }
        dip.has_other_axes
    }

    #[test]
    fn an_accelerometer_with_other_axes_is_found_and_a_sound_one_is_not() {
        let none = Vector3::zeros();
        assert!(!turned(60.0, Matrix3::identity(), none));
        // the field is wrong by 10 uT
        assert!(!turned(60.0, Matrix3::identity(), Vector3::new(7.0, 0.0, -7.0)));
        for rows in [
            [0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            [0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0],
            [-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0],
        ] {
            assert!(turned(20.0, Matrix3::from_row_slice(&rows), none), "{rows:?}");
            assert!(!turned(2.0, Matrix3::from_row_slice(&rows), none), "{rows:?}");
        }
    }

    /// Only a place's known dip tells it.
    #[test]
    fn gravity_the_other_way_round_is_not_seen() {
        assert!(!turned(60.0, -Matrix3::identity(), Vector3::zeros()));
    }
}
