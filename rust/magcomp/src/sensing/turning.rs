//! Whether the field turns the way the gyroscope says: an app that mixes two frames up gives a magnetometer whose axes are not the gyroscope's. An ellipsoid
//! fits those samples as well, so that only turns tell.
//!
//! ```text
//! (m - b)' = -w x (m - b)                 a field that is fixed in the world, seen from a device that turns
//! d = W^ - A x b                          its sum over a time: d: change of m, A: sum of the turns,   W^ = sum of m x turn   (linear in W = sum of turn m')
//! d, A, W: from the mean over a window to that over the next;   turn: 2 tan(angle / 2) about its axis, m: mean of two of them: exact for any angle
//! S_G = min over b of sum |d - W^ + A x b|^2, forgotten over 50 windows (n), with W and A replaced by G W and G A: the sensors' frames differ by G
//! G explains the field better where   n ln((min(S_1, sum |d|^2) + n B) / (S_G + n B)) > 4^2 / 2 + ln 100      B: what the largest bias moves the field by
//! the field contradicts the gyroscope where   n ln((S_1 + n B) / (min(S of all 48 frames, sum |d|^2) + n B))   does
//! ```
//! A mirrored vector turns alike, so each of the 24 right-handed G stands for a magnetometer's axes and for their mirror. None of them is believed that explains
//! no more than a field that does not care for turns: that of a magnet one walks by. A window in which the field changes by more than the turn moves the
//! Earth's strongest field says nothing of axes, either. The misfit of a window as read is capped, so that two windows alone never convict: a device that steps
//! does so between two windows. Axes that are wrong are so in every window.
//! Of 52 recordings of sound phones, and 180 simulated ones with steps, magnets and cars, none is refused; of the 52 with their fields' axes swapped, mirrored
//! or turned all are, half of them within 9 s.

use crate::math::elementary::{ln, turn_factors};
use crate::priors::{OUTLYING, RARE};
use crate::strength::EARTH_UT;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// Data sheet: the largest bias of a phone's gyroscope, rad/s: 0.095 was found.
pub(super) const LARGEST_BIAS_RAD_S: f64 = 0.1;
/// Choice: length of a window, s: a hand turns by far more than noise in it, and a place changes by less.
const WINDOW_S: f64 = 0.5;
/// Choice: what a window keeps of those before it.
pub(super) const KEPT: f64 = 0.98;

/// d, the rows of W, A.
type Changes = SVector<f64, 15>;

/// A frame along the axes of another: which of its components each is, and its sign.
pub(super) type Frame = [(usize, f64); 3];
/// Mathematics: the other frame itself.
pub(super) const AS_READ: Frame = [(0, 1.0), (1, 1.0), (2, 1.0)];

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Turning {
    /// m, W and A up to the latest sample, counted from the window's beginning; their sum over the window's samples, how many those are, and how long it is, s.
    now: Changes,
    sum: Changes,
    samples: f64,
    length_s: f64,
    /// Means of the window before.
    before: Option<Changes>,
    moments: SMatrix<f64, 15, 15>,
    windows: f64,
    pub verdict: Verdict,
}

/// What the field says of the gyroscope's turns.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Verdict {
    /// It does not turn as the gyroscope says: with other axes, or not at all, it is explained better.
    pub contradicts: bool,
    /// The components of the field along the gyroscope's x, y and z, 1 to 3, negative where it points the other way, where that explains its turns better.
    pub axes: Option<[i8; 3]>,
}

impl Turning {
    /// The mean of some samples, uT: the turn since that before, rad, and how long they took, s.
    pub fn see(&mut self, field_ut: &Vector3<f64>, turn_rad: &Vector3<f64>, span_s: f64) {
        let half2 = (turn_rad * 0.5).norm_squared();
        let [sine, cosine, _] = turn_factors(half2);
        let turn = turn_rad * (sine / (1.0 - half2 * cosine));
        let last = self.now.fixed_rows::<3>(0).into_owned();
        if self.samples > 0.0 || self.before.is_some() {
            let mean = (last + field_ut) * 0.5;
            for axis in 0..3 {
                let mut row = self.now.fixed_rows_mut::<3>(3 + 3 * axis);
                row += mean * turn[axis];
            }
            let mut turned = self.now.fixed_rows_mut::<3>(12);
            turned += turn;
        }
        self.now.fixed_rows_mut::<3>(0).copy_from(field_ut);
        self.sum += self.now;
        self.samples += 1.0;
        self.length_s += span_s;
        if self.length_s >= WINDOW_S {
            self.close();
        }
    }

    /// The chain of rotations broke: no window reaches across.
    pub fn pause(&mut self) {
        (self.now, self.sum, self.before) = (Changes::zeros(), Changes::zeros(), None);
        (self.samples, self.length_s) = (0.0, 0.0);
    }

    /// A window is full.
    fn close(&mut self) {
        let mut mean = self.sum / self.samples;
        if let Some(before) = self.before {
            let changes = mean - before;
            let turned_rad = changes.fixed_rows::<3>(12).norm();
            if changes.fixed_rows::<3>(0).norm() < EARTH_UT.end * turned_rad {
                self.moments = self.moments * KEPT + changes * changes.transpose() * self.share(&changes);
                self.windows = self.windows * KEPT + 1.0;
                self.verdict = self.judge();
            }
        }
        // W and A count from here on
        let mut counted = mean.fixed_rows_mut::<12>(3);
        counted -= self.now.fixed_rows::<12>(3);
        self.now.fixed_rows_mut::<12>(3).fill(0.0);
        self.before = Some(mean);
        (self.sum, self.samples, self.length_s) = (Changes::zeros(), 0.0, 0.0);
    }

    /// By what a window counts: two of them, all that a step of the field is seen in, can't reach the bound, whatever explains them.
    fn share(&self, changes: &Changes) -> f64 {
        let (as_read, b_ut) = self.fit(AS_READ, &self.by_turns());
        let w = |i: usize, k: usize| changes[3 + 3 * i + k];
        let of_turns = Vector3::new(w(1, 2) - w(2, 1), w(2, 0) - w(0, 2), w(0, 1) - w(1, 0));
        let left = changes.fixed_rows::<3>(0) + of_turns + changes.fixed_rows::<3>(12).cross(&b_ut);
        let usual = (as_read + self.by_bias()) / self.windows.max(1.0);
        (0.5 * no_chance() * usual / left.norm_squared()).min(1.0)
    }

    /// n B.
    fn by_bias(&self) -> f64 {
        self.windows.max(1.0) * (LARGEST_BIAS_RAD_S * WINDOW_S * EARTH_UT.end).powi(2)
    }

    fn judge(&self) -> Verdict {
        let by_bias = self.by_bias();
        let explains = |left: f64, other: f64| is_no_chance(self.windows * ln((other + by_bias) / (left + by_bias)));
        let unmoved = self.moments.fixed_view::<3, 3>(0, 0).trace();
        let by_turns = self.by_turns();
        let left = |frame| self.fit(frame, &by_turns).0;
        let as_read = left(AS_READ);
        if !explains(0.0, as_read) {
            // no rival could
            return Verdict::default();
        }
        let (least, frame) = frames(1.0)
            .map(|frame| (left(frame), Some(frame)))
            .fold((as_read, None), |best, next| if next.0 < best.0 { next } else { best });
        let mirrored = frames(-1.0).map(left).fold(least, f64::min);
        let is_other = explains(least, as_read.min(unmoved));
        Verdict {
            contradicts: explains(mirrored.min(unmoved), as_read),
            axes: frame.filter(|_| is_other).map(components),
        }
    }

    /// S_G, and the b of it.
    fn fit(&self, frame: Frame, by_turns: &Matrix3<f64>) -> (f64, Vector3<f64>) {
        // never larger: so the compiler sees that it stays within the moments
        let frame = frame.map(|(from, sign)| (from.min(2), sign));
        let moment = |(i, s): (usize, f64), (k, t): (usize, f64)| s * t * self.moments[(i, k)];
        // G W: row i, column k
        let w = |i: usize, k: usize, sign: f64| (3 + 3 * frame[i].0 + k, sign * frame[i].1);
        let left = [0, 1, 2].map(|i| {
            let (a, b) = ((i + 1) % 3, (i + 2) % 3);
            [(i, 1.0), w(a, b, 1.0), w(b, a, -1.0)]
        });
        let square = |(i, _): (usize, f64)| self.moments[(i, i)];
        let of_one = |[a, b, c]: [(usize, f64); 3]| {
            square(a) + square(b) + square(c) + 2.0 * (moment(a, b) + moment(a, c) + moment(b, c))
        };
        let sum: f64 = left.map(of_one).iter().sum();
        let cross = |i: usize, k: usize| -> f64 { left[k].map(|part| moment((12 + i, 1.0), part)).iter().sum() };
        // G' of what b is found from: both stand along the axes of the rates
        let mut right = Vector3::zeros();
        for (i, (from, sign)) in frame.into_iter().enumerate() {
            let (a, b) = (frame[(i + 1) % 3], frame[(i + 2) % 3]);
            right[from] = sign * (b.1 * cross(b.0, (i + 1) % 3) - a.1 * cross(a.0, (i + 2) % 3));
        }
        let b_ut = by_turns * right;
        (sum - right.dot(&b_ut), -Vector3::from(frame.map(|(from, sign)| sign * b_ut[from])))
    }

    /// What b follows by from what changes of the field and turns have in common: the inverse of sum (|A|^2 I - A A^T). A turn about one axis alone leaves a part of
    /// b open.
    fn by_turns(&self) -> Matrix3<f64> {
        let square: Matrix3<f64> = self.moments.fixed_view::<3, 3>(12, 12).into();
        let normal = Matrix3::identity() * (square.trace() + 1e-6) - square * (1.0 - 1e-6);
        normal.cholesky().map_or_else(Matrix3::zeros, |it| it.inverse())
    }
}

/// Whether a log likelihood ratio is beyond that of four standard deviations, for one sensor in a hundred that is wrong.
pub(super) fn is_no_chance(log_ratio: f64) -> bool {
    log_ratio > no_chance()
}

fn no_chance() -> f64 {
    0.5 * OUTLYING * OUTLYING - ln(RARE)
}

/// The 24 frames of one hand along the axes of another: right-handed for 1, mirrored for -1.
pub(super) fn frames(hand: f64) -> impl Iterator<Item = Frame> {
    let even = [[0, 1, 2], [1, 2, 0], [2, 0, 1]].map(|order| (order, hand));
    let odd = [[0, 2, 1], [1, 0, 2], [2, 1, 0]].map(|order| (order, -hand));
    even.into_iter().chain(odd).flat_map(|([a, b, c], hand)| {
        [[1.0, 1.0], [1.0, -1.0], [-1.0, 1.0], [-1.0, -1.0]].map(|[x, y]| [(a, x), (b, y), (c, x * y * hand)])
    })
}

/// The magnetometer's axes for a frame of the rates, or their mirror: what has fewer signs turned.
fn components(frame: Frame) -> [i8; 3] {
    let mut found = [0; 3];
    for (to, (from, sign)) in frame.into_iter().enumerate() {
        found[from] = (to as i8 + 1) * sign as i8;
    }
    if found.iter().filter(|it| **it < 0).count() > 1 { found.map(|it| -it) } else { found }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::{Rotation3, SMatrix};

    /// A device that a hand turns about in a field of 50 uT, with a hard iron; its magnetometer reads `axes` times the field, its gyroscope `rates` times the
    /// rates.
    fn turned(
        seconds: f64,
        axes: Matrix3<f64>,
        rates: Matrix3<f64>,
        place_ut: impl Fn(f64) -> Vector3<f64>,
    ) -> Verdict {
        let mut turning = Turning::default();
        let mut attitude = Rotation3::identity();
        for k in 0..(seconds * 50.0) as i32 {
            let t = f64::from(k) * 0.02;
            let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin());
            attitude *= Rotation3::new(rate * 0.02);
            let noise = Vector3::new((31.0 * t).sin(), (37.0 * t).sin(), (41.0 * t).sin()) * 0.5;
            let field =
                attitude.inverse() * (Vector3::new(0.0, 25.0, -43.0) + place_ut(t)) + Vector3::new(120.0, -80.0, 300.0);
            turning.see(&(axes * field + noise), &(rates * rate * 0.02), 0.02);
        }
        turning.verdict
    }

    fn frame(rows: [f64; 9]) -> Matrix3<f64> {
        Matrix3::from_row_slice(&rows)
    }

    #[test]
    fn a_sound_magnetometer_agrees_whatever_its_soft_iron() {
        let none = |_: f64| Vector3::zeros();
        let sound = Verdict::default();
        assert_eq!(turned(60.0, Matrix3::identity(), Matrix3::identity(), none), sound);
        let soft = frame([1.15, 0.1, 0.05, 0.1, 0.9, -0.1, 0.05, -0.1, 0.95]);
        assert_eq!(turned(60.0, soft, Matrix3::identity(), none), sound);
    }

    #[test]
    fn axes_that_are_mixed_up_are_named_as_one_types_them() {
        for (reads, told) in [
            ([0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0], [2, 1, 3]),
            ([-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], [-1, 2, 3]),
            // x reads y, and y reads -x: so x is -y, and y is x
            ([0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0], [-2, 1, 3]),
            ([0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0], [2, 3, 1]),
        ] {
            let verdict = turned(15.0, frame(reads), Matrix3::identity(), |_| Vector3::zeros());
            assert_eq!(verdict, Verdict { contradicts: true, axes: Some(told) }, "{reads:?}");
            // what is told puts them right: each component where it belongs, or all the other way round
            let mut back = Matrix3::zeros();
            for (row, axis) in told.into_iter().enumerate() {
                back[(row, usize::from(i8::unsigned_abs(axis)) - 1)] = f64::from(i8::signum(axis));
            }
            assert_eq!(back * frame(reads), Matrix3::identity());
        }
    }

    /// A flipped axis mirrors the rates: that is no fault of the magnetometer's.
    #[test]
    fn a_gyroscope_with_a_flipped_axis_is_contradicted_and_the_magnetometer_is_not() {
        let flipped = Matrix3::from_diagonal(&Vector3::new(1.0, -1.0, 1.0));
        let verdict = turned(20.0, Matrix3::identity(), flipped, |_| Vector3::zeros());
        assert_eq!(verdict, Verdict { contradicts: true, axes: None });
    }

    /// It needs turns: half a second of them says nothing, and neither does a device that lies still.
    #[test]
    fn nothing_is_told_without_turns() {
        let swapped = frame([0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        assert_eq!(turned(1.4, swapped, Matrix3::identity(), |_| Vector3::zeros()), Verdict::default());
        let mut turning = Turning::default();
        for k in 0..3000 {
            let noise = Vector3::new(f64::from(k % 7), f64::from(k % 5), f64::from(k % 3)) * 0.1;
            turning.see(&(swapped * noise), &(noise * 1e-4), 0.01);
        }
        assert_eq!(turning.verdict, Verdict::default());
    }

    /// Magnets along the way: the field changes by more than turns explain, and no axes are blamed.
    #[test]
    fn magnets_blame_no_axes() {
        let boards =
            |t: f64| Vector3::new((0.8 * t).sin(), (1.1 * t + 2.0).sin(), (0.6 * t).cos()) * 60.0 * (0.3 * t).sin();
        let verdict = turned(60.0, Matrix3::identity(), Matrix3::identity(), boards);
        assert_eq!(verdict.axes, None);
    }

    /// A hand that hardly turns, and an offset that steps by 50 uT: one change explains nothing of axes, whatever turn it goes with.
    #[test]
    fn a_step_of_the_offset_blames_no_axes() {
        for seed in 0..40 {
            let mut turning = Turning::default();
            let mut attitude = Rotation3::identity();
            for k in 0..2000 {
                let t = f64::from(k) * 0.02;
                let phase = f64::from(seed);
                let wobble = Vector3::new((2.9 * t).sin(), (3.3 * t + phase).cos(), (1.7 * t + phase).sin()) * 0.1;
                let rate = wobble + Vector3::z() * if (19.0..22.0).contains(&t) { 1.5 } else { 0.0 };
                attitude *= Rotation3::new(rate * 0.02);
                let noise = Vector3::new((31.0 * t).sin(), (37.0 * t).sin(), (41.0 * t).sin()) * 0.5;
                let step =
                    Vector3::new(phase.sin(), phase.cos(), 0.3) * if t > 20.1 + 0.1 * phase { 50.0 } else { 0.0 };
                let field = attitude.inverse() * Vector3::new(0.0, 25.0, -43.0) + step + noise;
                turning.see(&field, &(rate * 0.02), 0.02);
                assert_eq!(turning.verdict.axes, None, "{seed} at {t} s");
            }
        }
    }

    /// Asked again: ten seconds with the right axes take it back.
    #[test]
    fn what_is_mended_is_taken_back_within_ten_seconds() {
        let mut turning = Turning::default();
        let mut attitude = Rotation3::identity();
        let mut refused = [0, 0];
        for k in 0..5000 {
            let t = f64::from(k) * 0.02;
            let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin());
            attitude *= Rotation3::new(rate * 0.02);
            let field = attitude.inverse() * Vector3::new(0.0, 25.0, -43.0) + Vector3::new(120.0, -80.0, 300.0);
            let field = if t < 20.0 { field.yxz() } else { field };
            turning.see(&field, &(rate * 0.02), 0.02);
            refused[usize::from(t >= 20.0)] += usize::from(turning.verdict.axes.is_some());
        }
        assert!(refused[0] > 500 && (1..500).contains(&refused[1]), "{refused:?}");
        assert_eq!(turning.verdict.axes, None);
    }

    /// S_G of the sums is that of a direct fit of the windows, for each G.
    #[test]
    fn what_is_left_over_is_that_of_a_direct_fit() {
        let mut turning = Turning::default();
        let windows: Vec<Changes> =
            (0..12).map(|k| Changes::from_fn(|i, _| f64::from((k * 31 + i as i32 * 17) % 23) - 11.0)).collect();
        for changes in &windows {
            turning.moments += changes * changes.transpose();
        }
        for frame in frames(1.0).chain(frames(-1.0)) {
            let change = Matrix3::from_fn(|i, k| if frame[i].0 == k { frame[i].1 } else { 0.0 });
            let mut rows = SMatrix::<f64, 36, 3>::zeros();
            let mut right = SMatrix::<f64, 36, 1>::zeros();
            for (k, window) in windows.iter().enumerate() {
                let sum = change * Matrix3::from_fn(|i, j| window[3 + 3 * i + j]);
                let cross =
                    Vector3::new(sum[(1, 2)] - sum[(2, 1)], sum[(2, 0)] - sum[(0, 2)], sum[(0, 1)] - sum[(1, 0)]);
                rows.fixed_rows_mut::<3>(3 * k).copy_from(&(change * window.fixed_rows::<3>(12)).cross_matrix());
                right.fixed_rows_mut::<3>(3 * k).copy_from(&(window.fixed_rows::<3>(0) + cross));
            }
            let solved = rows.svd(true, true).solve(&right, 1e-12).unwrap();
            let expected = (rows * solved - right).norm_squared();
            let (left, _) = turning.fit(frame, &turning.by_turns());
            assert!((left / expected - 1.0).abs() < 1e-4, "{left} {expected}");
        }
    }
}
