//! Whether gravity turns the way the gyroscope says: axes that an app flips, degrees for radians, or a dead axis make a gyroscope that is sure and wrong. No
//! magnet has a part in this.
//!
//! ```text
//! a <- R a + up dt      over a window of T, so that motion averages out; the window before is turned on likewise: a' <- R a'
//! D = sum |a - a'|^2    over pairs of windows, forgotten over 50 of them (n): how much gravity moves in a frame that is at rest
//! R: by the turn as it is read, and by each rival's: the signs of a set of axes turned over (7), degrees taken for radians
//! a rival explains gravity better where   n ln((D_read + n B) / (D_rival + n B)) > 4^2 / 2 + ln 100      B: what the largest bias moves gravity by
//! ```
//! Two numbers a pair are across gravity, and their noise is not known: that is the log of the likelihood ratio. The bound is that of four standard deviations,
//! for one gyroscope in a hundred that is wrong. Of 45 walks and runs with sound gyroscopes the most was 5.
//! A device that is carried turns about the vertical, where gravity does not turn: a flipped axis then shows since gravity would have to turn. Of axes that
//! were hardly turned about all rivals say the same. A device that is tilted to and fro and moved in step with it looks flipped to gravity alone: it takes the
//! field, too, to put a gyroscope out of use (`turning`).
//!
//! To gravity an arm that swings hardly turns: an accelerometer at the end of a string reads the string. It turns to and fro. So degrees are told only where
//! the device would have turned on by more than a whole turn a second, root mean square of all windows; arms and runners have 1.4 rad.
//!
//! An axis is dead where it has read one value, to the last bit, 50 times on end while both others and gravity changed: noise lets no axis that lives do so.
//! All three are dead where they repeat one value each through two windows, and gravity moves from one to the next by more than the largest bias turns it.
//! An accelerometer that repeats its reading while the gyroscope turns hangs (`hang`): it is asked again with every sample.
//! (A made up stream without noise may have such an axis, where the device turns about the vertical: gravity stays then.)

use super::hang::{Turned, hangs};
use super::pairing::Rotation;
use super::tilt::{GRAVITY_M_S2, TILT_S};
use super::turning::{KEPT, LARGEST_BIAS_RAD_S, is_no_chance};
use crate::math::elementary::ln;
use crate::math::turn::Turn;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// Choice: readings on end that a living axis does not repeat: 5 was the most in 57 recordings.
const REPEATS: u32 = 50;
/// Choice: rounding moves what a made up stream reads of gravity by less, the noise of a sensor by more, m/s^2.
const MOVED_M_S2: f64 = 1e-3;
/// Choice: the turn of a second, rad, root mean square, above which no hand turns a device: a whole one; arms that swing have 1.4, degrees taken for radians 20.
const WHOLE_TURN_RAD: f64 = core::f64::consts::TAU;

/// Mathematics: sets of axes whose signs may be turned over, the empty one among them.
const SETS: usize = 8;
/// Mathematics: the sets, and degrees.
const WAYS: usize = SETS + 1;
/// Mathematics: signs of the axes for the sets of an even number of them; those of the others are the opposite.
#[rustfmt::skip]
const SIGNS: [f64; 12] = [
    1.0, 1.0, 1.0,
    -1.0, -1.0, 1.0,
    -1.0, 1.0, -1.0,
    1.0, -1.0, -1.0,
];

/// A vector of gravity as each of the ways turns it.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct Carried {
    /// In rows, of the sets with the signs turned over: those of an even number of axes, and the opposite of those of an odd one.
    sets: [SMatrix<f64, 4, 3>; 2],
    degrees: Vector3<f64>,
}

impl Carried {
    /// With the signs S of a set turned over the device turns by S R S, or by S R' S where their number is odd: S a is carried.
    fn turn(&mut self, read: &Matrix3<f64>, degrees: &Matrix3<f64>) {
        self.sets[0] *= read.transpose();
        self.sets[1] *= read;
        self.degrees = degrees * self.degrees;
    }

    fn add(&mut self, up: &Vector3<f64>) {
        let signed = SMatrix::<f64, 4, 3>::from_row_slice(&SIGNS) * Matrix3::from_diagonal(up);
        self.sets.iter_mut().for_each(|it| *it += signed);
        self.degrees += up;
    }

    fn ways(&self) -> impl Iterator<Item = Vector3<f64>> {
        self.sets.iter().flat_map(|it| it.row_iter()).map(|row| row.transpose()).chain([self.degrees])
    }
}

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Axes {
    /// a and a', for the turn as it is read and each rival's; of the sets with the signs of their axes turned over.
    sum: Carried,
    before: Option<Carried>,
    length_s: f64,
    /// D and n.
    moved: [f64; WAYS],
    pairs: f64,
    /// Turn of the window in the making, rad, and the sum of squares over those before, rad^2.
    net_rad: Vector3<f64>,
    net_rad2: f64,
    /// Gravity says that axes turn the other way, or are read in degrees. Of axes that were hardly turned about nothing is known.
    pub is_contradicted: bool,
    /// What the axes read, and how many times each repeated it while both others changed.
    rate_rad_s: Vector3<f64>,
    repeats: [u32; 3],
    up_m_s2: Vector3<f64>,
    /// Since the accelerometer last read something else.
    turned: Turned,
    /// Seconds since any of them changed, and whether gravity has moved meanwhile.
    frozen_s: f64,
    is_frozen: bool,
}

impl Axes {
    /// What a sample's sensors read, to the last bit: the rotation since the one before, and how long it took, s; the accelerometer, m/s^2.
    pub fn read(&mut self, rotation: &Rotation, span_s: f64, up_m_s2: &Vector3<f64>) {
        if *up_m_s2 == self.up_m_s2 {
            self.turned.add(rotation, span_s);
        } else {
            self.turned = Turned::default();
        }
        let has_moved = (up_m_s2 - self.up_m_s2).norm() > MOVED_M_S2;
        self.up_m_s2 = *up_m_s2;
        let changed: [bool; 3] = core::array::from_fn(|axis| rotation.rate_rad_s[axis] != self.rate_rad_s[axis]);
        if changed == [false; 3] {
            self.frozen_s += span_s;
        } else {
            (self.frozen_s, self.is_frozen) = (0.0, false);
        }
        for (axis, repeats) in self.repeats.iter_mut().enumerate() {
            if changed[axis] {
                *repeats = 0;
            } else if has_moved && changed[(axis + 1) % 3] && changed[(axis + 2) % 3] {
                *repeats = repeats.saturating_add(1);
            }
        }
        self.rate_rad_s = rotation.rate_rad_s;
        if self.is_gravity_frozen() {
            // it is no witness
            self.pause();
        }
    }

    /// The mean of some samples' accelerometer, m/s^2: the turn since that before, rad, and how long they took, s.
    pub fn see(&mut self, up_m_s2: &Vector3<f64>, turn_rad: &Vector3<f64>, span_s: f64) {
        let turned = |turn_rad: Vector3<f64>| Turn::by(&-turn_rad).rotation;
        let (read, degrees) = (turned(*turn_rad), turned(turn_rad.map(f64::to_radians)));
        self.sum.turn(&read, &degrees);
        self.sum.add(&(up_m_s2 * span_s));
        if let Some(before) = &mut self.before {
            before.turn(&read, &degrees);
        }
        self.net_rad += turn_rad;
        self.length_s += span_s;
        if self.length_s >= TILT_S {
            self.compare();
        }
    }

    /// A window is full.
    fn compare(&mut self) {
        let sum = core::mem::take(&mut self.sum);
        let means = Carried { sets: sum.sets.map(|it| it / self.length_s), degrees: sum.degrees / self.length_s };
        if let Some(before) = self.before.replace(means) {
            let by_bias = LARGEST_BIAS_RAD_S * TILT_S * GRAVITY_M_S2;
            let as_read = |it: &Carried| it.sets[0].row(0).transpose();
            let has_moved = (as_read(&means) - as_read(&before)).norm() > by_bias;
            self.is_frozen |= self.frozen_s > 2.0 * self.length_s && has_moved;
            let changes = means.ways().zip(before.ways()).map(|(mean, before)| (mean - before).norm_squared());
            for (moved, change_m2_s4) in self.moved.iter_mut().zip(changes) {
                *moved = *moved * KEPT + change_m2_s4;
            }
            self.net_rad2 = self.net_rad2 * KEPT + self.net_rad.norm_squared();
            self.pairs = self.pairs * KEPT + 1.0;
        }
        (self.length_s, self.net_rad) = (0.0, Vector3::zeros());
        let spins = self.net_rad2 > self.pairs * (WHOLE_TURN_RAD * TILT_S).powi(2);
        self.is_contradicted = (1..SETS).any(|set| self.explains_better(set)) || spins && self.explains_better(SETS);
    }

    /// The chain of rotations broke: no window reaches across.
    pub fn pause(&mut self) {
        (self.sum, self.before, self.length_s) = (Carried::default(), None, 0.0);
        self.net_rad = Vector3::zeros();
    }

    /// Whether the accelerometer hangs: it repeats a reading to the last bit while the gyroscope turns.
    pub fn is_gravity_frozen(&self) -> bool {
        hangs(self.turned.angle_rad())
    }

    /// Whether an axis is dead, or all hang: that needs no other witness.
    pub fn is_dead(&self) -> bool {
        self.is_frozen || self.repeats.iter().any(|repeats| *repeats >= REPEATS)
    }

    /// Whether gravity stands still rather where the device turned like this.
    fn explains_better(&self, way: usize) -> bool {
        let by_bias = self.pairs * (LARGEST_BIAS_RAD_S * TILT_S * GRAVITY_M_S2).powi(2);
        is_no_chance(self.pairs * ln((self.moved[0] + by_bias) / (self.moved[way] + by_bias)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Rotation3;

    fn is_out(axes: &Axes) -> bool {
        axes.is_contradicted || axes.is_dead()
    }

    /// A sample at 100 Hz: what the gyroscope (rad/s) and the accelerometer (m/s^2) make of it.
    fn see(axes: &mut Axes, rate_rad_s: Vector3<f64>, up_m_s2: Vector3<f64>) {
        let increment_rad = rate_rad_s * 0.01;
        axes.read(&Rotation { increment_rad, rate_rad_s, variance_rad2: 0.0 }, 0.01, &up_m_s2);
        if !axes.is_gravity_frozen() {
            axes.see(&up_m_s2, &increment_rad, 0.01);
        }
    }

    /// A hand turns the device about for so many seconds, shaken by 1 m/s^2; each axis of its gyroscope reads so much of what it should.
    fn turned(seconds: f64, reads: Vector3<f64>) -> Axes {
        let mut axes = Axes::default();
        let mut attitude = Rotation3::identity();
        for k in 0..(seconds * 100.0) as i32 {
            let t = f64::from(k) * 0.01;
            let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin()) * 0.6;
            attitude *= Rotation3::new(rate * 0.01);
            let shaken = Vector3::new((11.9 * t).sin(), (12.3 * t).cos(), (23.0 * t).sin());
            let up = attitude.inverse() * Vector3::new(0.0, 0.0, 9.81) + shaken;
            see(&mut axes, rate.component_mul(&reads), up);
        }
        axes
    }

    #[test]
    fn a_flipped_axis_is_found_and_a_sound_one_is_not() {
        for axis in 0..3 {
            let mut reads = Vector3::repeat(1.0);
            assert!(!is_out(&turned(60.0, reads)));
            reads[axis] = -1.0;
            assert!(is_out(&turned(20.0, reads)), "{axis}");
            // a scale that is off by half is no flip
            reads[axis] = 0.5;
            assert!(!is_out(&turned(60.0, reads)), "{axis}");
        }
    }

    /// An arm that swings reads hardly any turn of gravity: a pendulum's string points where the pull is.
    #[test]
    fn a_pendulum_is_sound() {
        let mut axes = Axes::default();
        for k in 0..9000 {
            let t = f64::from(k) * 0.01;
            let rate = Vector3::new(3.0 * (5.7 * t).cos(), 0.2 * (11.0 * t).sin(), 0.3 * (0.4 * t).cos());
            let noise = Vector3::new((31.0 * t).sin(), (37.0 * t).sin(), (41.0 * t).sin());
            let tilt = 0.15 * 3.0 / 5.7 * (5.7 * t).sin();
            let up =
                Rotation3::new(-Vector3::x() * tilt) * Vector3::new(0.0, 0.0, 9.81 + 2.0 * (11.4 * t).cos()) + noise;
            see(&mut axes, rate, up);
            assert!(!is_out(&axes), "at {t} s");
        }
    }

    #[test]
    fn degrees_for_radians_are_found_and_half_the_scale_is_not() {
        for (factor, is_wrong) in [(1.0_f64.to_degrees(), true), (0.5, false), (2.0, false)] {
            assert_eq!(is_out(&turned(20.0, Vector3::repeat(factor))), is_wrong, "{factor}");
        }
    }

    /// The judgement is asked again: half a minute of sound readings takes it back.
    #[test]
    fn an_axis_that_is_flipped_for_a_while_is_taken_back() {
        let mut axes = Axes::default();
        let mut attitude = Rotation3::identity();
        let mut wrong = [0, 0];
        for k in 0..12_000 {
            let t = f64::from(k) * 0.01;
            let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin()) * 0.6;
            attitude *= Rotation3::new(rate * 0.01);
            let shaken = Vector3::new((11.9 * t).sin(), (12.3 * t).cos(), (23.0 * t).sin());
            let up = attitude.inverse() * Vector3::new(0.0, 0.0, 9.81) + shaken;
            let sign = if (20.0..60.0).contains(&t) { -1.0 } else { 1.0 };
            see(&mut axes, rate.component_mul(&Vector3::new(1.0, sign, 1.0)), up);
            if is_out(&axes) {
                wrong[usize::from(sign > 0.0)] += 1;
            }
            assert!(!is_out(&axes) || (20.0..120.0).contains(&t), "at {t} s");
        }
        assert!(wrong[0] > 1800 && wrong[1] < 5000, "{wrong:?}");
    }

    /// Readings of a device that is carried, in steps of the gyroscope's last bit; an axis that is `dead` reads its bias.
    fn carried(axes: &mut Axes, readings: usize, last_bit_rad_s: f64, dead: Option<usize>) {
        let mut attitude = Rotation3::identity();
        for k in 0..readings {
            let t = k as f64 * 0.01;
            let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin()) * 0.6;
            let noise = Vector3::new(f64::from(k as u32 % 7), f64::from(k as u32 % 5), f64::from(k as u32 % 3)) * 1e-3;
            let mut read_rad_s = ((rate + noise) / last_bit_rad_s).map(f64::round) * last_bit_rad_s;
            if let Some(axis) = dead {
                read_rad_s[axis] = 0.01;
            }
            attitude *= Rotation3::new(rate * 0.01);
            let up = attitude.inverse() * Vector3::new(0.0, 0.0, 9.81);
            see(axes, read_rad_s, up + Vector3::y() * f64::from(k as u32 % 2));
        }
    }

    #[test]
    fn a_dead_axis_is_found_after_fifty_readings_and_is_sound_once_it_reads_something_else() {
        for axis in 0..3 {
            let mut axes = Axes::default();
            carried(&mut axes, 40, 1e-3, Some(axis));
            assert!(!is_out(&axes), "{axis}");
            carried(&mut axes, 60, 1e-3, Some(axis));
            assert!(is_out(&axes), "{axis}");
            carried(&mut axes, 2, 1e-3, None);
            assert!(!is_out(&axes), "{axis}");
        }
    }

    /// Its readings repeat, but not one axis alone, and not on end.
    #[test]
    fn a_gyroscope_with_a_coarse_last_bit_is_sound() {
        let mut axes = Axes::default();
        carried(&mut axes, 6000, 0.02, None);
        assert!(!is_out(&axes));
    }

    /// A gyroscope that hangs turns no gravity; one that rests on a table repeats its readings too.
    #[test]
    fn a_gyroscope_that_hangs_is_found_where_gravity_moves() {
        for (tilts, is_wrong) in [(0.5, true), (0.0, false)] {
            let mut axes = Axes::default();
            for k in 0..1000 {
                let t = f64::from(k) * 0.01;
                let noise = Vector3::new(f64::from(k % 7), f64::from(k % 5), f64::from(k % 3)) * 1e-2;
                let up = Rotation3::new(Vector3::x() * tilts * (0.8 * t).sin()) * Vector3::new(0.0, 0.0, 9.81);
                see(&mut axes, Vector3::new(0.01, 0.0, -0.02), up + noise);
            }
            assert_eq!(is_out(&axes), is_wrong, "tilted by {tilts}");
            see(&mut axes, Vector3::new(0.01, 0.0, -0.01), Vector3::new(0.0, 0.1, 9.81));
            assert!(!is_out(&axes));
        }
    }

    /// What repeats to the last bit while the device turns is no gravity, until it reads something else.
    #[test]
    fn an_accelerometer_that_hangs_is_found_where_the_device_turns() {
        let mut axes = Axes::default();
        let up = Vector3::new(0.1, 5.0, 8.4);
        for k in 0..200 {
            see(&mut axes, Vector3::new(0.0, 0.5, 0.01 * f64::from(k % 3)), up);
            // 0.3 rad at 0.5 rad/s less the largest bias: the seventy-fifth
            assert!(axes.is_gravity_frozen() == (k > 75) || k == 75, "{k}");
        }
        see(&mut axes, Vector3::zeros(), up + Vector3::x() * 1e-9);
        assert!(!axes.is_gravity_frozen());
    }

    /// A tilted device turns about the vertical: the third axis reads 0, in a made up stream for long. It is dead where gravity changes, if only by noise.
    #[test]
    fn a_stream_without_noise_has_no_dead_axis() {
        for (noise_m_s2, is_wrong) in [(0.0, false), (0.02, true)] {
            let mut axes = Axes::default();
            for k in 0..100 {
                let rate = Vector3::new(0.0, 0.64, 0.77) * (0.02 * f64::from(k)).sin();
                see(&mut axes, rate, Vector3::new(noise_m_s2 * f64::from(k % 2), 0.0, 9.81));
            }
            assert_eq!(is_out(&axes), is_wrong);
        }
    }

    /// A made up stream: one axis turns about the vertical, two say nothing.
    #[test]
    fn two_axes_that_stay_say_nothing() {
        let mut axes = Axes::default();
        for k in 0..1000 {
            see(&mut axes, Vector3::z() * f64::from(k % 11), Vector3::new(0.0, 0.01 * f64::from(k % 2), 9.81));
        }
        assert!(!is_out(&axes));
    }

    /// Signs that an app takes from another system: two axes, or all three.
    #[test]
    fn several_flipped_axes_are_found() {
        for reads in [Vector3::new(-1.0, -1.0, 1.0), Vector3::new(1.0, -1.0, -1.0), Vector3::repeat(-1.0)] {
            assert!(is_out(&turned(20.0, reads)), "{reads}");
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
                see(&mut axes, rate.component_mul(&reads) + noise, up * 9.81 + shaken);
            }
            is_out(&axes)
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
            see(&mut axes, noise - Vector3::z(), Vector3::z() * 9.81 + noise);
        }
        assert!(!is_out(&axes));
    }
}
