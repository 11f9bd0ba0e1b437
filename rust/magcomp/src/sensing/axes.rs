//! Whether the axes of the gyroscope turn the way gravity does: an axis that an app flips, or that is dead, makes a gyroscope that is sure and wrong. No magnet
//! has a part in this.
//!
//! ```text
//! du/dt = -w x u   for gravity u in the device;   ū: means over windows of T, A and then B, so that motion averages out
//! ū_B - ū_A = -sum_i k_i C_i + noise,   C_i = integral of tri(t) w_i (e_i x u) dt         tri rises over A and falls over B, 0 to 1 to 0
//! for each set of axes:   c = -sum of the C_i of the set,   y = ū_B - ū_A + the other C_i
//! k = sum c.y / sum |c|^2,   its variance n / (n - 1) sum (c.y - k |c|^2)^2 / (sum |c|^2)^2,   n = (sum |c|^2)^2 / sum |c|^4    1: sound, -1: flipped
//! ```
//! The axes outside the set are taken for sound. A device that is carried turns about the vertical, where gravity does not turn: a flipped axis then shows since
//! gravity would have to turn. A pair counts where |c| / g is above 0.1 rad: no bias of the gyroscope can turn the sign of its k. The variance is that of White
//! (1980): the noise of a window in motion is not that at rest. So many pairs n count. Motion that goes with the turns, as a runner's, does not average out.
//! Were all of it turned alike, k would be off by at most sum |c| A / sum |c|^2: A^2 is twice what the mean size of the acceleration differs from g by, in
//! squares (`across`).
//! A set is flipped where k lies below 0, half way between sound and flipped, by that and as many of its standard deviations as Student's t asks for: once in
//! 30 000 by chance. A set that is not turned about leaves its k unknown.
//!
//! An axis is dead where it has read one value, to the last bit, 50 times on end while both others and gravity changed: noise lets no axis that lives do so.
//! (A made up stream without noise may have such an axis, where the device turns about the vertical: gravity stays then.)

use super::pairing::Rotation;
use super::tilt::GRAVITY_M_S2;
use super::tuning::Tuning;
use crate::math::student::student;
use crate::priors::OUTLYING;
use nalgebra::{Matrix3, Vector3};

/// Data sheet: the largest bias of a phone's gyroscope, rad/s: 0.095 was found.
const LARGEST_BIAS_RAD_S: f64 = 0.1;
/// Data sheet: readings on end that a living axis does not repeat: 5 was the most in 57 recordings.
const REPEATS: u32 = 50;
/// Mathematics: rounding moves what a made up stream reads of gravity by less, the noise of a sensor by more, m/s^2.
const MOVED_M_S2: f64 = 1e-3;
/// Mathematics: pairs of windows that tell the noise at all.
const FEWEST: f64 = 2.0;

/// See the module.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Axes {
    window: Window,
    /// A, once it is full: its mean, and C as it rises.
    before: Option<(Vector3<f64>, Matrix3<f64>)>,
    /// One for each set of axes, by the bits of its number less one: x, y, xy, z, ...
    sets: [Turning; 7],
    is_flipped: bool,
    /// What the axes read, and how many times each repeated it while both others changed.
    rate_rad_s: Vector3<f64>,
    repeats: [u32; 3],
    up_m_s2: Vector3<f64>,
}

/// How a set of axes turns beside gravity: sums over pairs.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Turning {
    /// |c|^2 and c.y, the squares and the product of these, and |c| A.
    weight: f64,
    along: f64,
    weight_squares: f64,
    along_squares: f64,
    products: f64,
    aligned: f64,
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
    /// One sample: the rotation since the one before, and how long it took, s; what the accelerometer reads, m/s^2.
    pub fn see(&mut self, rotation: &Rotation, span_s: f64, up_m_s2: &Vector3<f64>) {
        let turn_rad = &rotation.increment_rad;
        let has_moved = (up_m_s2 - self.up_m_s2).norm() > MOVED_M_S2;
        self.up_m_s2 = *up_m_s2;
        self.read(&rotation.rate_rad_s, has_moved);
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

    fn read(&mut self, rate_rad_s: &Vector3<f64>, has_moved: bool) {
        let changed: [bool; 3] = std::array::from_fn(|axis| rate_rad_s[axis] != self.rate_rad_s[axis]);
        for (axis, repeats) in self.repeats.iter_mut().enumerate() {
            if changed[axis] {
                *repeats = 0;
            } else if has_moved && changed[(axis + 1) % 3] && changed[(axis + 2) % 3] {
                *repeats = repeats.saturating_add(1);
            }
        }
        self.rate_rad_s = *rate_rad_s;
    }

    /// A pair of windows: -C, how gravity changed, and A.
    fn compare(&mut self, lever: Matrix3<f64>, change: Vector3<f64>, beyond: f64) {
        let unexplained = change - lever.column_sum();
        for (set, number) in self.sets.iter_mut().zip(1_u8..) {
            let turned = lever * Vector3::from_fn(|axis, _| f64::from(number >> axis & 1));
            set.see(&turned, &(unexplained + turned), beyond);
        }
        self.is_flipped = self.sets.iter().any(Turning::is_flipped);
    }

    /// The chain of rotations broke: no window reaches across.
    pub fn pause(&mut self) {
        (self.window, self.before) = (Window::default(), None);
    }

    /// Whether axes turn the other way, or one not at all. Of axes that were hardly turned about nothing is known.
    pub fn is_wrong(&self) -> bool {
        self.is_flipped || self.repeats.iter().any(|repeats| *repeats >= REPEATS)
    }
}

impl Turning {
    /// A pair of windows: c, y and A.
    fn see(&mut self, turned: &Vector3<f64>, change: &Vector3<f64>, beyond: f64) {
        let (weight, along) = (turned.norm_squared(), turned.dot(change));
        if weight < (LARGEST_BIAS_RAD_S * Tuning::USED.tilt_s * GRAVITY_M_S2).powi(2) {
            return;
        }
        self.weight += weight;
        self.along += along;
        self.weight_squares += weight * weight;
        self.along_squares += along * along;
        self.products += along * weight;
        self.aligned += weight.sqrt() * beyond;
    }

    fn is_flipped(&self) -> bool {
        let pairs = self.weight * self.weight / self.weight_squares;
        // not a number where there are none
        if pairs.is_nan() || pairs <= FEWEST {
            return false;
        }
        let factor = self.along / self.weight;
        let left = self.along_squares - 2.0 * factor * self.products + factor * factor * self.weight_squares;
        let sigma = (left.max(0.0) * pairs / (pairs - 1.0)).sqrt();
        self.along + self.aligned + student(OUTLYING, pairs - 1.0) * sigma < 0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    /// What the gyroscope makes of a rate at 100 Hz, rad/s.
    fn read(rate_rad_s: Vector3<f64>) -> Rotation {
        Rotation { increment_rad: rate_rad_s * 0.01, rate_rad_s, variance_rad2: 0.0 }
    }

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
            axes.see(&read(rate.component_mul(&reads)), 0.01, &up);
        }
        axes
    }

    #[test]
    fn a_flipped_axis_is_found_and_a_sound_one_is_not() {
        for axis in 0..3 {
            let mut reads = Vector3::repeat(1.0);
            assert!(!turned(60.0, reads).is_wrong());
            reads[axis] = -1.0;
            assert!(turned(20.0, reads).is_wrong(), "{axis}");
            // a scale that is off by half is no flip
            reads[axis] = 0.5;
            assert!(!turned(60.0, reads).is_wrong(), "{axis}");
        }
    }

    /// An acceleration that is no gravity may go with the turns: a runner's has 2 g in the mean.
    #[test]
    fn in_a_run_nothing_is_told() {
        let reads = Vector3::new(1.0, -1.0, 1.0);
        assert!(turned_in(60.0, reads, 9.81).is_wrong());
        assert!(!turned_in(60.0, reads, 19.62).is_wrong());
    }

    #[test]
    fn the_factor_of_an_axis_is_the_turn_over_the_reading() {
        for axis in 0..3 {
            let mut reads = Vector3::repeat(1.0);
            reads[axis] = 0.8;
            let axes = turned(120.0, reads);
            let set = axes.sets[(1 << axis) - 1];
            assert!((set.along / set.weight * 0.8 - 1.0).abs() < 0.05, "{axis}");
        }
    }

    /// Readings of a device that is carried, in steps of the gyroscope's last bit; an axis that is `dead` reads its bias.
    fn carried(axes: &mut Axes, readings: usize, last_bit_rad_s: f64, dead: Option<usize>) {
        for k in 0..readings {
            let t = k as f64 * 0.01;
            let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin()) * 0.6;
            let noise = Vector3::new(f64::from(k as u32 % 7), f64::from(k as u32 % 5), f64::from(k as u32 % 3)) * 1e-3;
            let mut read_rad_s = ((rate + noise) / last_bit_rad_s).map(f64::round) * last_bit_rad_s;
            if let Some(axis) = dead {
                read_rad_s[axis] = 0.01;
            }
            axes.see(&read(read_rad_s), 0.01, &Vector3::new(0.0, f64::from(k as u32 % 2), 9.81));
        }
    }

    #[test]
    fn a_dead_axis_is_found_after_fifty_readings_and_is_sound_once_it_reads_something_else() {
        for axis in 0..3 {
            let mut axes = Axes::default();
            carried(&mut axes, 40, 1e-3, Some(axis));
            assert!(!axes.is_wrong(), "{axis}");
            carried(&mut axes, 60, 1e-3, Some(axis));
            assert!(axes.is_wrong(), "{axis}");
            carried(&mut axes, 2, 1e-3, None);
            assert!(!axes.is_wrong(), "{axis}");
        }
    }

    /// Its readings repeat, but not one axis alone, and not on end.
    #[test]
    fn a_gyroscope_with_a_coarse_last_bit_is_sound() {
        let mut axes = Axes::default();
        carried(&mut axes, 6000, 0.02, None);
        assert!(!axes.is_wrong());
    }

    /// A tilted device turns about the vertical: the third axis reads 0, in a made up stream for long. It is dead where gravity changes, if only by noise.
    #[test]
    fn a_stream_without_noise_has_no_dead_axis() {
        for (noise_m_s2, is_wrong) in [(0.0, false), (0.02, true)] {
            let mut axes = Axes::default();
            for k in 0..100 {
                let rate = Vector3::new(0.0, 0.64, 0.77) * (0.02 * f64::from(k)).sin();
                axes.see(&read(rate), 0.01, &Vector3::new(noise_m_s2 * f64::from(k % 2), 0.0, 9.81));
            }
            assert_eq!(axes.is_wrong(), is_wrong);
        }
    }

    /// A made up stream: one axis turns, two say nothing.
    #[test]
    fn two_axes_that_stay_say_nothing() {
        let mut axes = Axes::default();
        for k in 0..1000 {
            axes.see(&read(Vector3::z() * f64::from(k % 11)), 0.01, &Vector3::new(0.0, f64::from(k % 2), 9.81));
        }
        assert!(!axes.is_wrong());
    }

    /// Signs that an app takes from another system: two axes, or all three.
    #[test]
    fn several_flipped_axes_are_found() {
        for reads in [Vector3::new(-1.0, -1.0, 1.0), Vector3::new(1.0, -1.0, -1.0), Vector3::repeat(-1.0)] {
            assert!(turned(20.0, reads).is_wrong(), "{reads}");
        }
    }

    /// A pedestrian with the device in the hand turns left and right about the vertical: gravity stays in the device, and a flipped axis would turn it.
    #[test]
    fn a_walk_round_corners_shows_a_flipped_axis() {
        let up = Vector3::new(0.0, 0.64, 0.77);
        let walked = |reads: Vector3<f64>| {
            let mut axes = Axes::default();
            for k in 0..6000 {
                let t = f64::from(k) * 0.01;
                let rate = up * (0.7 * t).sin();
                let shaken = Vector3::new((11.9 * t).sin(), (12.3 * t).cos(), (23.0 * t).sin());
                let noise = Vector3::new(f64::from(k % 7), f64::from(k % 5), f64::from(k % 3)) * 1e-3;
                axes.see(&read(rate.component_mul(&reads) + noise), 0.01, &(up * 9.81 + shaken));
            }
            axes.is_wrong()
        };
        assert!(!walked(Vector3::repeat(1.0)));
        assert!(walked(Vector3::new(1.0, -1.0, 1.0)) && walked(Vector3::new(1.0, 1.0, -1.0)));
        // gravity says nothing of an axis that was not turned about, nor of turns about itself alone
        assert!(!walked(Vector3::new(-1.0, 1.0, 1.0)) && !walked(Vector3::repeat(-1.0)));
    }

    #[test]
    fn at_rest_or_about_the_vertical_nothing_is_known() {
        let mut axes = Axes::default();
        for k in 0..6000 {
            let noise = Vector3::new(f64::from(k % 7), f64::from(k % 5), f64::from(k % 3)) * 1e-3;
            axes.see(&read(noise - Vector3::z()), 0.01, &(Vector3::z() * 9.81 + noise));
        }
        assert!(!axes.is_wrong());
    }
}
