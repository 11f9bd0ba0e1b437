//! Neighbouring samples as one: what they say together costs one correction of the filter and one look at the axes.
//!
//! ```text
//! raw = mean raw_k,   up = mean up_k,   late = t_n - mean t_k,   turn = R_n ... R_1,   for up to 40 ms and 0.2 rad
//! between = (turn of the frame before + turn) / 2:   from the middle of the one to that of the other
//! ```
//! A turn of 0.2 rad shortens the mean by 0.08 uT. Source: docs/dev/METHOD-AIDED.md.

use nalgebra::{UnitQuaternion, Vector3};

use crate::math::elementary::{quaternion, rotation_vector};

/// Choice: a frame is no longer, s: the interval of a phone's magnetometer at its slowest, of which none is averaged.
const LONGEST_S: f64 = 0.04;
/// Choice: the sine of half a frame's largest turn, 0.2 rad: its mean is off by 0.2 % (sinc).
const LARGEST_HALF: f64 = 0.1;

/// The samples so far.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Frame {
    raw_ut: Sum,
    up_m_s2: Sum,
    /// Sum of the times between a frame's beginning and its fields, less what these have waited.
    times_s: f64,
    turn: UnitQuaternion<f64>,
    bridged_rad2: f64,
    length_s: f64,
    /// Turn of the frame before, rad.
    before_rad: Vector3<f64>,
}

/// Of vectors, and how many they are.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct Sum {
    sum: Vector3<f64>,
    count: f64,
}

/// What a sample adds.
#[derive(Clone, Copy)]
pub(crate) struct Piece {
    pub(crate) increment_rad: Vector3<f64>,
    pub(crate) dt_s: f64,
    pub(crate) bridged_rad2: f64,
    /// The field, uT, where it says something, and for how long it has waited, s.
    pub(crate) raw_ut: Option<Vector3<f64>>,
    pub(crate) late_s: f64,
    pub(crate) up_m_s2: Option<Vector3<f64>>,
}

/// A frame that is full.
pub(crate) struct Whole {
    /// Mean of the fields that say something, uT, and of those at whose time the vertical is known, m/s^2.
    pub(crate) raw_ut: Option<Vector3<f64>>,
    pub(crate) up_m_s2: Option<Vector3<f64>>,
    pub(crate) increment_rad: Vector3<f64>,
    pub(crate) between_rad: Vector3<f64>,
    pub(crate) bridged_rad2: f64,
    pub(crate) length_s: f64,
    pub(crate) late_s: f64,
}

impl Sum {
    fn add(&mut self, value: Option<Vector3<f64>>) {
        if let Some(value) = value {
            self.sum += value;
            self.count += 1.0;
        }
    }

    fn mean(&self) -> Option<Vector3<f64>> {
        (self.count > 0.0).then(|| self.sum / self.count)
    }
}

impl Frame {
    pub(crate) fn is_empty(&self) -> bool {
        self.length_s == 0.0
    }

    /// One more sample; the frame where it is full, or the sample waits for none.
    pub(crate) fn add(&mut self, piece: &Piece, is_alone: bool) -> Option<Whole> {
        self.turn *= quaternion(&piece.increment_rad);
        self.bridged_rad2 += piece.bridged_rad2;
        self.length_s += piece.dt_s;
        self.up_m_s2.add(piece.up_m_s2);
        self.raw_ut.add(piece.raw_ut);
        if piece.raw_ut.is_some() {
            self.times_s += self.length_s - piece.late_s;
        }
        // the sample that comes nearest to the longest is the last
        let is_full =
            is_alone || self.length_s + 0.5 * piece.dt_s > LONGEST_S || self.turn.imag().norm() > LARGEST_HALF;
        is_full.then(|| {
            let increment_rad = rotation_vector(&self.turn);
            let Self { raw_ut, up_m_s2, times_s, bridged_rad2, length_s, before_rad, .. } =
                core::mem::replace(self, Self { before_rad: increment_rad, ..Self::default() });
            Whole {
                raw_ut: raw_ut.mean(),
                up_m_s2: up_m_s2.mean(),
                increment_rad,
                between_rad: (before_rad + increment_rad) * 0.5,
                bridged_rad2,
                length_s,
                late_s: length_s - times_s / raw_ut.count.max(1.0),
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Samples 1, 2, 3.. along x at a rate, in a device that turns so fast, until a frame is full: how many, and the frame. Each second one is blank, or each.
    fn full(rate_hz: f64, rate_rad_s: Vector3<f64>, is_alone: bool, blanks: [bool; 2]) -> (usize, Whole) {
        let (mut frame, dt_s) = (Frame::default(), 1.0 / rate_hz);
        let increment_rad = rate_rad_s * dt_s;
        for k in 1..100 {
            let raw_ut = (!blanks[k % 2]).then(|| Vector3::x() * k as f64);
            let up_m_s2 = Some(Vector3::z() * k as f64);
            let piece = Piece { increment_rad, dt_s, bridged_rad2: 1e-6, raw_ut, late_s: 0.0, up_m_s2 };
            if let Some(whole) = frame.add(&piece, is_alone) {
                assert_eq!(frame, Frame { before_rad: whole.increment_rad, ..Frame::default() });
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
            let (raw_ut, up_m_s2) = (whole.raw_ut.unwrap(), whole.up_m_s2.unwrap());
            assert!((raw_ut.x - (n + 1.0) / 2.0).abs() < 1e-12 && (up_m_s2.z - (n + 1.0) / 2.0).abs() < 1e-12);
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
        assert_eq!((count, whole.raw_ut, whole.up_m_s2), (8, Some(Vector3::x() * 4.0), Some(Vector3::z() * 4.5)));
        assert!((whole.late_s - 0.02).abs() < 1e-12 && (whole.length_s - 0.04).abs() < 1e-12);
        let (_, whole) = full(200.0, Vector3::zeros(), false, [true; 2]);
        assert_eq!(whole.raw_ut, None);
    }

    #[test]
    fn a_fast_turn_ends_a_frame_and_its_turn_is_that_of_its_samples() {
        let rate_rad_s = Vector3::new(3.0, -6.0, 2.0);
        let (count, whole) = full(100.0, rate_rad_s, false, [false; 2]);
        // 7 rad/s: three samples turn by more than 0.2 rad
        assert_eq!(count, 3);
        assert!((whole.increment_rad - rate_rad_s * 0.03).norm() < 1e-12);
        // the frame before is none: to the middle of this one
        assert!((whole.between_rad - rate_rad_s * 0.015).norm() < 1e-12);
    }
}
