//! Whether each axis of the gyroscope turns the way gravity does: an app that flips an axis, or takes one for another, makes a gyroscope that is sure and
//! wrong. No magnet has a part in this.
//!
//! ```text
//! du/dt = -w x u   for gravity u in the device;   ū: means over windows of T, A and then B, so that motion averages out
//! ū_B - ū_A = -sum_i k_i C_i + noise,   C_i = integral of tri(t) w_i (e_i x u) dt         tri rises over A and falls over B, 0 to 1 to 0
//! k = (sum C^T C)^-1 sum C^T d,   its covariance (sum C^T C)^-1 (sum C^T r r^T C) (sum C^T C)^-1,   r = d - C k       1: a sound axis, -1: a flipped one
//! ```
//! r is taken with the k of before. The covariance is that of White (1980): the noise of a window in motion is not that at rest. The pairs of windows count
//! as (sum |C|^2)^2 / sum |C|^4. Motion that goes with the turns, as a runner's, does not average out. Were all of it turned alike, k would be off by at
//! most sum |C_i| A / sum |C_i|^2: A^2 is twice what the mean size of the acceleration differs from g by, in squares (`across`).
//! An axis is flipped where k lies below 0 by that and as many of its standard deviations as Student's t asks for: once in 30 000 by chance. What is not turned about, or turns about the vertical alone, leaves
//! its k unknown.

use super::tilt::GRAVITY_M_S2;
use super::tuning::Tuning;
use nalgebra::{Matrix3, Vector3};

/// Mathematics: a normal variable is so many standard deviations below its mean once in 30 000.
const NORMAL: f64 = 4.0;
/// Mathematics: pairs of windows that tell the noise at all.
const FEWEST: f64 = 2.0;

/// See the module.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Axes {
    window: Window,
    /// A, once it is full: its mean, and C as it rises.
    before: Option<(Vector3<f64>, Matrix3<f64>)>,
    /// Sums over pairs: C^T C, C^T d, C^T r r^T C, |C_i| A, |C|^2 and |C|^4.
    information: Matrix3<f64>,
    seen: Vector3<f64>,
    left: Matrix3<f64>,
    aligned: Vector3<f64>,
    weight: f64,
    weight_squares: f64,
    is_flipped: bool,
}

/// Sums over the window in the making.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Window {
    length_s: f64,
    up: Vector3<f64>,
    size: f64,
    /// Columns: w_i (e_i x u), weighted rising and falling over the window.
    rising: Matrix3<f64>,
    falling: Matrix3<f64>,
}

impl Axes {
    /// One sample: the turn since the one before, rad, and how long it took, s; what the accelerometer reads, m/s^2.
    pub fn see(&mut self, turn_rad: &Vector3<f64>, span_s: f64, up_m_s2: &Vector3<f64>) {
        let share = ((self.window.length_s + 0.5 * span_s) / Tuning::USED.tilt_s).min(1.0);
        let levers = Matrix3::from_columns(&[
            Vector3::x().cross(up_m_s2) * turn_rad.x,
            Vector3::y().cross(up_m_s2) * turn_rad.y,
            Vector3::z().cross(up_m_s2) * turn_rad.z,
        ]);
        let window = &mut self.window;
        window.length_s += span_s;
        window.up += up_m_s2 * span_s;
        window.size += up_m_s2.norm() * span_s;
        window.rising += levers * share;
        window.falling += levers * (1.0 - share);
        if window.length_s < Tuning::USED.tilt_s {
            return;
        }
        let Window { length_s, up, size, rising, falling } = std::mem::take(window);
        let mean = up / length_s;
        if let Some((before, was_rising)) = self.before.replace((mean, rising)) {
            let beyond = Tuning::USED.across.sqrt() * (size / length_s - GRAVITY_M_S2).abs();
            self.compare(-(was_rising + falling), mean - before, beyond);
        }
    }

    /// A pair of windows: C, d and A.
    fn compare(&mut self, lever: Matrix3<f64>, change: Vector3<f64>, beyond: f64) {
        let factors = self.information.try_inverse().map_or_else(Vector3::zeros, |inverse| inverse * self.seen);
        let left = lever.transpose() * (change - lever * factors);
        self.information += lever.transpose() * lever;
        self.seen += lever.transpose() * change;
        self.left += left * left.transpose();
        self.aligned += Vector3::from_fn(|i, _| lever.column(i).norm() * beyond);
        self.weight += lever.norm_squared();
        self.weight_squares += lever.norm_squared().powi(2);
        self.is_flipped = self.has_flipped();
    }

    /// The chain of rotations broke: no window reaches across.
    pub fn pause(&mut self) {
        (self.window, self.before) = (Window::default(), None);
    }

    /// Whether an axis turns the other way. Of axes that were hardly turned about nothing is known.
    pub fn is_flipped(&self) -> bool {
        self.is_flipped
    }

    fn has_flipped(&self) -> bool {
        let Some(inverse) = self.information.try_inverse() else { return false };
        let pairs = self.weight * self.weight / self.weight_squares;
        // not a number where there are none
        if pairs.is_nan() || pairs <= FEWEST {
            return false;
        }
        let sigmas = student(3.0 * pairs - 3.0);
        let (factors, covariance) = (inverse * self.seen, inverse * self.left * inverse);
        (0..3).any(|i| {
            let most_off = self.aligned[i] / self.information[(i, i)];
            factors[i] + most_off + sigmas * covariance[(i, i)].max(0.0).sqrt() < 0.0
        })
    }
}

/// As rare as [`NORMAL`] where the noise is known from so many degrees of freedom: Student's t by its expansion about the normal distribution.
fn student(freedom: f64) -> f64 {
    let z = NORMAL;
    let first = (z.powi(3) + z) / 4.0;
    let second = (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / 96.0;
    z + first / freedom + second / (freedom * freedom)
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    /// A hand turns the device about for so many seconds, shaken by 1 m/s^2; each axis of its gyroscope reads so much of what it should.
    fn turned(seconds: f64, reads: Vector3<f64>) -> Axes {
        turned_in(seconds, reads, 9.81)
    }

    /// The same where the acceleration is so large in the mean, m/s^2.
    fn turned_in(seconds: f64, reads: Vector3<f64>, size_m_s2: f64) -> Axes {
        let mut axes = Axes::default();
        let mut attitude = Rotation3::identity();
        for k in 0..(seconds * 100.0) as i32 {
            let t = f64::from(k) * 0.01;
            let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin()) * 0.6;
            attitude *= Rotation3::new(rate * 0.01);
            let shaken = Vector3::new((11.9 * t).sin(), (12.3 * t).cos(), (23.0 * t).sin());
            let up = attitude.inverse() * Vector3::new(0.0, 0.0, size_m_s2) + shaken;
            axes.see(&(rate.component_mul(&reads) * 0.01), 0.01, &up);
        }
        axes
    }

    #[test]
    fn a_flipped_axis_is_found_and_a_sound_one_is_not() {
        for axis in 0..3 {
            let mut reads = Vector3::repeat(1.0);
            assert!(!turned(60.0, reads).is_flipped());
            reads[axis] = -1.0;
            assert!(turned(20.0, reads).is_flipped(), "{axis}");
            // a scale that is off by half is no flip
            reads[axis] = 0.5;
            assert!(!turned(60.0, reads).is_flipped(), "{axis}");
        }
    }

    /// By a numerical integral of the density; 3.167e-5 beyond.
    #[test]
    fn the_fewer_pairs_the_more_sigmas() {
        for (freedom, exact) in [(9.0, 7.00), (21.0, 4.98), (60.0, 4.30), (1e9, 4.0)] {
            assert!((student(freedom) / exact - 1.0).abs() < 0.06, "{freedom}: {}", student(freedom));
        }
    }

    /// An acceleration that is no gravity may go with the turns: a runner's has 2 g in the mean.
    #[test]
    fn in_a_run_nothing_is_told() {
        let reads = Vector3::new(1.0, -1.0, 1.0);
        assert!(turned_in(60.0, reads, 9.81).is_flipped());
        assert!(!turned_in(60.0, reads, 19.62).is_flipped());
    }

    #[test]
    fn the_factors_are_those_of_the_axes() {
        let reads = Vector3::new(0.8, 1.0, 1.25);
        let axes = turned(120.0, reads);
        let factors = axes.information.try_inverse().unwrap() * axes.seen;
        assert!((factors - reads.map(f64::recip)).amax() < 0.05, "{factors}");
    }

    #[test]
    fn at_rest_or_about_the_vertical_nothing_is_known() {
        let mut axes = Axes::default();
        for k in 0..6000 {
            let noise = Vector3::new(f64::from(k % 7), f64::from(k % 5), f64::from(k % 3)) * 1e-3;
            axes.see(&(Vector3::z() * -0.01 + noise * 0.01), 0.01, &(Vector3::z() * 9.81 + noise));
        }
        assert!(!axes.is_flipped());
    }
}
