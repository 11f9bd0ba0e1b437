//! The turn of a vector that is fixed in the world, against the gyroscope.
//!
//! Seen from the device such a vector v turns by v' = -w x v, w being the rotation rate; the raw field by m' = -w x (m - b). Over a window
//! that is an identity of sums, right for any angle: the change of m is -(sum of w dt x m) + (sum of w dt) x b. With the matrix
//! W = sum of w m^T dt it holds for any linear change G of the rates too (other axes, another unit), so each is tried at no cost.
//! Both sides may be averaged over the windows' beginnings, which takes the noise off the two ends.

use magcomp::nalgebra::{Matrix3, Vector3};

/// One event of a sensor: s, and value.
pub(super) type Event = (f64, Vector3<f64>);
/// Events of one sensor.
pub(super) type Series = Vec<Event>;

/// A pause of the gyroscope of this many of its steps ends the windows.
const PAUSE: f64 = 10.0;
/// Rounds of the weights that make outliers count less.
const ROUNDS: usize = 6;

/// One window.
#[derive(Clone, Copy, Debug)]
pub(super) struct Window {
    change: Vector3<f64>,
    turned: Matrix3<f64>,
    /// The angle turned through, rad.
    pub angle: Vector3<f64>,
}

/// The windows of so many seconds, of a vector whose times are changed by `shift_s`; averaged over beginnings of `average_s`.
pub(super) fn windows(vector: &[Event], turns: &Turns, span_s: f64, average_s: f64, shift_s: f64) -> Vec<Window> {
    let mut points: Vec<(f64, usize, Vector3<f64>, Vector3<f64>)> = Vec::with_capacity(vector.len());
    let mut at = vector.first().map_or(0, |(time_s, _)| turns.before(time_s + shift_s));
    for (time_s, value) in vector {
        let time_s = time_s + shift_s;
        if let Some((pauses, angle)) = turns.at(time_s, &mut at) {
            points.push((time_s, pauses, *value, angle));
        }
    }
    let step_s = median(points.windows(2).map(|pair| pair[1].0 - pair[0].0).collect());
    if step_s <= 0.0 {
        return Vec::new();
    }
    let mut sum = Matrix3::zeros();
    let mut sums = Vec::with_capacity(points.len());
    sums.push(sum);
    for pair in points.windows(2) {
        sum += (pair[1].3 - pair[0].3) * ((pair[0].2 + pair[1].2) / 2.0).transpose();
        sums.push(sum);
    }
    let (span, average) = ((span_s / step_s).round().max(1.0) as usize, (average_s / step_s).round().max(1.0) as usize);
    let mean = |begin: usize| {
        let part = begin..begin + average;
        let scale = 1.0 / average as f64;
        let value = points[part.clone()].iter().map(|point| point.2).sum::<Vector3<f64>>() * scale;
        let angle = points[part.clone()].iter().map(|point| point.3).sum::<Vector3<f64>>() * scale;
        let turned = sums[part].iter().sum::<Matrix3<f64>>() * scale;
        (value, angle, turned)
    };
    let mut found = Vec::new();
    let mut begin = 0;
    while begin + span + average <= points.len() {
        let (first, last) = (&points[begin], &points[begin + span + average - 1]);
        let is_whole = first.1 == last.1 && last.0 - first.0 < 2.0 * (span + average) as f64 * step_s;
        if is_whole {
            let (before, after) = (mean(begin), mean(begin + span));
            found.push(Window { change: after.0 - before.0, angle: after.1 - before.1, turned: after.2 - before.2 });
        }
        begin += span;
    }
    found
}

/// The angle that the gyroscope has turned through, from event to event.
pub(super) struct Turns {
    /// s, pauses so far, rad.
    points: Vec<(f64, usize, Vector3<f64>)>,
}

impl Turns {
    /// Of a gyroscope's events.
    pub fn of(rates: &[Event]) -> Self {
        let usual_s = median(rates.windows(2).map(|pair| pair[1].0 - pair[0].0).collect());
        let (mut angle, mut pauses, mut points) = (Vector3::zeros(), 0, Vec::with_capacity(rates.len()));
        for (k, (time_s, rate)) in rates.iter().enumerate() {
            if let Some((before_s, before)) = k.checked_sub(1).map(|before| rates[before]) {
                let step_s = time_s - before_s;
                if step_s > PAUSE * usual_s {
                    pauses += 1;
                } else {
                    angle += (before + rate) / 2.0 * step_s;
                }
            }
            points.push((*time_s, pauses, angle));
        }
        Self { points }
    }

    /// Where to look for a time from.
    fn before(&self, time_s: f64) -> usize {
        self.points.partition_point(|point| point.0 < time_s).saturating_sub(1)
    }

    /// At a time, looked for from `from` on.
    fn at(&self, time_s: f64, from: &mut usize) -> Option<(usize, Vector3<f64>)> {
        while self.points.get(*from + 1).is_some_and(|next| next.0 < time_s) {
            *from += 1;
        }
        let (before, after) = (self.points.get(*from)?, self.points.get(*from + 1)?);
        let share = (time_s - before.0) / (after.0 - before.0);
        if !(0.0..=1.0).contains(&share) || before.1 != after.1 {
            return None;
        }
        Some((before.1, before.2 + (after.2 - before.2) * share))
    }
}

/// How well a change of the rates explains the windows.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fit {
    /// Mean size of what is left over.
    pub left: f64,
    /// The constant part of the vector.
    pub offset: Vector3<f64>,
    /// The least of the three directions' shares in what is known of the offset, of the largest.
    pub roundness: f64,
}

/// With the rates changed by `rates`; the vector has a constant part where `has_offset`.
pub(super) fn fit(windows: &[Window], rates: &Matrix3<f64>, has_offset: bool) -> Fit {
    let residual = |window: &Window| {
        let x = rates * window.turned;
        // the sum of (G w) x m dt
        let cross = Vector3::new(x[(1, 2)] - x[(2, 1)], x[(2, 0)] - x[(0, 2)], x[(0, 1)] - x[(1, 0)]);
        (window.change + cross, (rates * window.angle).cross_matrix())
    };
    let parts: Vec<(Vector3<f64>, Matrix3<f64>)> = windows.iter().map(residual).collect();
    let mut offset = Vector3::zeros();
    let mut roundness = 0.0;
    let sizes =
        |offset: Vector3<f64>| parts.iter().map(|(left, angle)| (left - angle * offset).norm()).collect::<Vec<_>>();
    if has_offset {
        let mut weights = vec![1.0; parts.len()];
        let mut solvable = None;
        for _ in 0..ROUNDS {
            let (mut normal, mut right) = (Matrix3::identity() * 1e-9, Vector3::zeros());
            for ((left, angle), weight) in parts.iter().zip(&weights) {
                normal += angle.transpose() * angle * *weight;
                right += angle.transpose() * left * *weight;
            }
            let Some(solved) = normal.try_inverse() else { break };
            offset = solved * right;
            solvable = Some(normal);
            let left = sizes(offset);
            let usual = median(left.clone()).max(1e-9);
            weights = left.iter().map(|size| 1.0 / size.max(usual / 2.0)).collect();
        }
        if let Some(normal) = solvable {
            let eigen = normal.symmetric_eigenvalues();
            roundness = eigen.min() / eigen.max().max(f64::MIN_POSITIVE);
        }
    }
    let left = sizes(offset);
    Fit { left: left.iter().sum::<f64>() / left.len().max(1) as f64, offset, roundness }
}

/// Mean size of the changes: what is left over where nothing explains them.
pub(super) fn unexplained(windows: &[Window]) -> f64 {
    windows.iter().map(|window| window.change.norm()).sum::<f64>() / windows.len().max(1) as f64
}

/// The middle one; 0 of none.
pub(super) fn median(mut values: Vec<f64>) -> f64 {
    let middle = values.len() / 2;
    if values.is_empty() { 0.0 } else { *values.select_nth_unstable_by(middle, f64::total_cmp).1 }
}
