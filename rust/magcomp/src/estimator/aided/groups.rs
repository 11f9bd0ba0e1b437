//! The samples of a start, averaged in groups, so that all of them can be fitted at once and anew.
//!
//! ```text
//! R      turns the field from the device frame of one sample to that of the next:  h <- R h
//! group: turn = product of R,  back = sum of R' from the group's end to each sample,  raw = sum of samples
//!        G = sum of R_end ((dt, increment') (x) I)      (R_end: from the step to the group's end)
//! with the gyroscope's bias g and scale error s:  turn' = exp([G (g, s)]x) turn
//! ```
//! The model is linear in `back`, so a mean over a group loses nothing; what g and s do within a group is taken to first order.
//! While a fit leaves more than a place does, the oldest groups go: a device that changed during its start is known soon after.
//! Source: docs/dev/METHOD-AIDED.md, Start.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::state::Parts;
use super::tuning::Tuning;
use crate::math::turn::Turn;

/// Choice: groups held.
const GROUPS: usize = 32;
/// Seconds of motion in a group at last: the groups then hold 16 s. Longer ones would not tell motions of a second.
const LONGEST_S: f64 = Tuning::USED.memory_s;
/// Choice: and at first, before groups have been joined in pairs twice: a fit is made after each.
const SHORTEST_S: f64 = LONGEST_S / 4.0;

/// Sums over the samples of a group, or their means as seen from the latest sample with the gyroscope's errors taken out.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Group {
    turn: Matrix3<f64>,
    /// R' to the samples: their mean field is `back` h.
    pub(super) back: Matrix3<f64>,
    /// Of a sum: what g and s add to the turn; of a mean: derivative of the mean field by g and s.
    pub(super) by_gyroscope: SMatrix<f64, 3, 12>,
    pub(super) raw_ut: Vector3<f64>,
    pub(super) rate_rad_s: Vector3<f64>,
    pub(super) count: f64,
    pub(super) moved_s: f64,
}

impl Group {
    fn new() -> Self {
        Self { turn: Matrix3::identity(), ..Self::default() }
    }

    /// The sums of this group and of the one that follows it.
    fn joined(&self, next: &Self) -> Self {
        Self {
            turn: next.turn * self.turn,
            back: self.back * next.turn.transpose() + next.back,
            by_gyroscope: next.turn * self.by_gyroscope + next.by_gyroscope,
            raw_ut: self.raw_ut + next.raw_ut,
            rate_rad_s: self.rate_rad_s + next.rate_rad_s,
            count: self.count + next.count,
            moved_s: self.moved_s + next.moved_s,
        }
    }
}

/// The groups, the oldest first; the last one is being filled.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Groups {
    groups: [Group; GROUPS],
    used: usize,
    longest_s: f64,
}

impl Default for Groups {
    fn default() -> Self {
        Self { groups: [Group::new(); GROUPS], used: 1, longest_s: SHORTEST_S }
    }
}

impl Groups {
    /// All groups are used, at their longest: a new one replaces the oldest.
    pub(super) fn is_full(&self) -> bool {
        self.used == GROUPS && self.longest_s >= LONGEST_S
    }

    /// A step of the gyroscope, its errors not removed.
    pub(super) fn turn(&mut self, increment_rad: &Vector3<f64>, dt_s: f64) {
        let r = Turn::by(&-increment_rad).rotation;
        let group = &mut self.groups[self.used - 1];
        group.turn = r * group.turn;
        group.back *= r.transpose();
        let errors = increment_rad.transpose().insert_column(0, dt_s);
        group.by_gyroscope = r * group.by_gyroscope + errors.kronecker(&Matrix3::identity());
    }

    /// A sample after that step. Returns whether a group is full.
    pub(super) fn add(&mut self, raw_ut: &Vector3<f64>, rate_rad_s: &Vector3<f64>, dt_s: f64) -> bool {
        let group = &mut self.groups[self.used - 1];
        group.back += Matrix3::identity();
        group.raw_ut += raw_ut;
        group.rate_rad_s += rate_rad_s;
        group.count += 1.0;
        group.moved_s += dt_s;
        group.moved_s >= self.longest_s
    }

    /// Drops the oldest quarter.
    pub(super) fn forget(&mut self) {
        let gone = self.used / 4;
        self.groups.copy_within(gone.., 0);
        self.used -= gone;
    }

    /// Begins another group.
    pub(super) fn close(&mut self) {
        if self.used == GROUPS {
            if self.longest_s < LONGEST_S {
                self.longest_s *= 2.0;
                for k in 0..GROUPS / 2 {
                    self.groups[k] = self.groups[2 * k].joined(&self.groups[2 * k + 1]);
                }
                self.used = GROUPS / 2;
            } else {
                self.groups.copy_within(1.., 0);
                self.used -= 1;
            }
        }
        self.groups[self.used] = Group::new();
        self.used += 1;
    }

    /// Means over each group, from the latest back to the first, for the field now, and bias and scale error, of `x`.
    pub(super) fn means<'a>(&'a self, x: &Parts) -> impl Iterator<Item = Group> + use<'a> {
        let h = x.field;
        let mut errors = SVector::<f64, 12>::zeros();
        errors.fixed_rows_mut::<3>(0).copy_from(&x.bias);
        errors.fixed_rows_mut::<9>(3).copy_from_slice(x.axes.as_slice());
        // from now to the group's end, and what g and s do to the field there
        let mut back = Matrix3::identity();
        let mut by_gyroscope = SMatrix::<f64, 3, 12>::zeros();
        self.groups[..self.used].iter().rev().filter_map(move |group| {
            let off = group.by_gyroscope * errors;
            let leads = (back * h).cross_matrix() * group.by_gyroscope;
            // on average half of a group's error lies between its end and a sample
            let half = Turn::by(&(-off * 0.5)).rotation;
            let mean = group.back * half / group.count;
            let seen = Group {
                raw_ut: group.raw_ut / group.count,
                rate_rad_s: group.rate_rad_s / group.count,
                back: mean * back,
                by_gyroscope: mean * (by_gyroscope + leads * 0.5),
                ..*group
            };
            let whole = Turn::by(&-off).rotation;
            let to_start = group.turn.transpose() * whole;
            by_gyroscope = to_start * (by_gyroscope + leads);
            back = to_start * back;
            (group.count > 0.0).then_some(seen)
        })
    }
}
