//! Neighbouring samples as one: what they say together costs one correction of the filter, and their mean is a sample that is late by its mean age.
//!
//! ```text
//! raw = mean raw_k,   late = t_n - mean t_k,   turn = R_n ... R_1,   for up to 40 ms and 0.2 rad
//! ```
//! A turn of 0.2 rad shortens the mean by 0.08 uT. Between two frames the field is carried (`learn`). Source: docs/dev/METHOD-AIDED.md.

use nalgebra::{UnitQuaternion, Vector3};

use super::propagate::ProcessNoise;
use super::step::Step;
use crate::math::elementary::{quaternion, rotation_vector};

/// Data sheet: the interval of a phone's magnetometer at its slowest, s.
const LONGEST_S: f64 = 0.04;
/// Mathematics: the sine of half a frame's turn, 0.2 rad, whose sinc is off by 0.2 %.
const LARGEST_HALF: f64 = 0.1;

/// The samples so far.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Frame {
    /// Those that say something, and all.
    samples: f64,
    rows: f64,
    raw_ut: Vector3<f64>,
    /// Sum of the times between a frame's beginning and its samples, less what these have waited.
    times_s: f64,
    turn: UnitQuaternion<f64>,
    bridged_rad2: f64,
    length_s: f64,
}

/// A frame that is full, in place of a sample.
pub(super) struct Whole {
    pub(super) raw_ut: Vector3<f64>,
    pub(super) increment_rad: Vector3<f64>,
    pub(super) rate_rad_s: Vector3<f64>,
    pub(super) bridged_rad2: f64,
    pub(super) length_s: f64,
    pub(super) late_s: f64,
    /// None of its samples says anything.
    pub(super) is_blank: bool,
}

impl Frame {
    pub(super) fn is_empty(&self) -> bool {
        self.rows == 0.0
    }

    /// One more sample; the frame where it is full, or the sample waits for none.
    pub(super) fn add(&mut self, step: &Step<'_>, is_alone: bool) -> Option<Whole> {
        self.turn *= quaternion(step.increment_rad);
        self.bridged_rad2 += step.noise.bridged_rad2;
        self.length_s += step.dt_s;
        self.rows += 1.0;
        if !step.is_blank {
            self.samples += 1.0;
            self.raw_ut += step.raw_ut;
            self.times_s += self.length_s - step.late_s;
        }
        // the sample that comes nearest to the longest is the last
        let is_full = is_alone || self.length_s + 0.5 * step.dt_s > LONGEST_S || self.turn.imag().norm() > LARGEST_HALF;
        is_full.then(|| {
            let Self { samples, raw_ut, times_s, turn, bridged_rad2, length_s, .. } = std::mem::take(self);
            let increment_rad = rotation_vector(&turn);
            let count = samples.max(1.0);
            Whole {
                raw_ut: raw_ut / count,
                increment_rad,
                rate_rad_s: increment_rad / length_s,
                bridged_rad2,
                length_s,
                late_s: length_s - times_s / count,
                is_blank: samples == 0.0,
            }
        })
    }
}

impl Whole {
    /// In place of its last sample; `delayed_rad_s`: the mean rate over the delay and its mean age, where it is known.
    pub(super) fn step<'a>(&'a self, last: &Step<'a>, delayed_rad_s: Option<Vector3<f64>>) -> Step<'a> {
        Step {
            raw_ut: &self.raw_ut,
            rate_rad_s: &self.rate_rad_s,
            delayed_rad_s: delayed_rad_s.unwrap_or(self.rate_rad_s),
            increment_rad: &self.increment_rad,
            angle_rad: self.increment_rad.norm(),
            dt_s: self.length_s,
            noise: ProcessNoise { bridged_rad2: self.bridged_rad2, ..last.noise },
            late_s: self.late_s,
            is_blank: self.is_blank,
            bias_variance: last.bias_variance.map(|variance| variance * last.dt_s / self.length_s),
            ..*last
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Matrix3;

    const NOISE: ProcessNoise = ProcessNoise { bridged_rad2: 1e-6, offset_ut: 0.0, local_ut: 0.0, local_time_s: 1.0 };

    /// Samples 1, 2, 3.. along x at a rate, in a device that turns so fast, until a frame is full: how many, and the frame. Each second one is blank, or each.
    fn full(rate_hz: f64, rate_rad_s: Vector3<f64>, is_alone: bool, blanks: [bool; 2]) -> (usize, Whole) {
        let (mut frame, dt_s) = (Frame::default(), 1.0 / rate_hz);
        let increment_rad = rate_rad_s * dt_s;
        for k in 1..100 {
            let raw_ut = Vector3::x() * k as f64;
            let step = Step {
                time_ns: 0,
                raw_ut: &raw_ut,
                is_blank: blanks[k % 2],
                rate_rad_s: &rate_rad_s,
                delayed_rad_s: rate_rad_s,
                increment_rad: &increment_rad,
                turn: Matrix3::identity(),
                angle_rad: 0.0,
                dt_s,
                noise: NOISE,
                sigma_ut: 0.5,
                bias_sd_rad_s: 0.0,
                late_s: 0.0,
                resting: false,
                bias_variance: None,
                motion: 1.0,
            };
            if let Some(whole) = frame.add(&step, is_alone) {
                assert_eq!(frame, Frame::default());
                return (k, whole);
            }
        }
        panic!("no frame was full");
    }

    #[test]
    fn a_frame_has_the_samples_that_come_nearest_to_forty_milliseconds() {
        let still = Vector3::zeros();
        for (rate_hz, samples) in [(5.0, 1), (25.0, 1), (38.0, 2), (49.7, 2), (50.0, 2), (100.0, 4), (200.0, 8)] {
            let (count, whole) = full(rate_hz, still, false, [false; 2]);
            let n = samples as f64;
            assert_eq!(count, samples, "{rate_hz}");
            assert!((whole.raw_ut.x - (n + 1.0) / 2.0).abs() < 1e-12 && !whole.is_blank);
            // the mean of samples at 1, 2.. n steps is (n - 1) / 2 steps old at the end of the last
            assert!((whole.length_s - n / rate_hz).abs() < 1e-12, "{rate_hz}");
            assert!((whole.late_s - (n - 1.0) / 2.0 / rate_hz).abs() < 1e-12, "{rate_hz}: {}", whole.late_s);
            assert!((whole.bridged_rad2 - n * 1e-6).abs() < 1e-18);
        }
        assert_eq!(full(100.0, still, true, [false; 2]).0, 1);
    }

    #[test]
    fn a_frame_is_the_mean_of_those_that_say_something() {
        // of eight samples at 200 Hz 1, 3, 5 and 7 count, whose mean is 4 samples older than the end
        let (count, whole) = full(200.0, Vector3::zeros(), false, [true, false]);
        assert_eq!((count, whole.raw_ut.x, whole.is_blank), (8, 4.0, false));
        assert!((whole.late_s - 0.02).abs() < 1e-12 && (whole.length_s - 0.04).abs() < 1e-12);
        let (_, whole) = full(200.0, Vector3::zeros(), false, [true; 2]);
        assert!(whole.is_blank && whole.raw_ut == Vector3::zeros());
    }

    #[test]
    fn a_fast_turn_ends_a_frame_and_its_turn_is_that_of_its_samples() {
        let rate_rad_s = Vector3::new(3.0, -6.0, 2.0);
        let (count, whole) = full(100.0, rate_rad_s, false, [false; 2]);
        // 7 rad/s: three samples turn by more than 0.2 rad
        assert_eq!(count, 3);
        assert!((whole.increment_rad - rate_rad_s * 0.03).norm() < 1e-12);
        assert!((whole.rate_rad_s - rate_rad_s).norm() < 1e-9);
    }
}
