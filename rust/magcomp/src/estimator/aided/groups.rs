//! The samples of a start, averaged in groups, so that all of them can be fitted at once and anew.
//!
//! ```text
//! group: back = sum of r' from the group's end to each sample,  raw = sum of samples,  turn and G: `turned`
//! ```
//! The model is linear in `back`, so a mean over a group loses nothing; what g and s do within a group is taken to first order.
//! While a fit leaves more than a place does, the oldest groups go: a device that changed during its start is known soon after.
//! Source: docs/dev/METHOD-AIDED.md, Start.

use arrayvec::ArrayVec;
use nalgebra::{Matrix3, SMatrix, Vector3};

use super::state::Parts;
use super::tuning::Tuning;
use super::turned::Turned;
use crate::math::turn::Turn;

/// Choice: groups held.
const GROUPS: usize = 32;
/// Seconds of motion in a group at last: the groups then hold 16 s. Longer ones would not tell motions of a second.
const LONGEST_S: f64 = Tuning::USED.memory_s;
/// Choice: and at first, before groups have been joined in pairs twice: a fit is made after each.
const SHORTEST_S: f64 = LONGEST_S / 4.0;

/// Sums over the samples of a group.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Group {
    turned: Turned,
    /// r' to the samples: their mean field is `back` h.
    pub(super) back: Matrix3<f64>,
    pub(super) raw_ut: Vector3<f64>,
    pub(super) rate_rad_s: Vector3<f64>,
    pub(super) count: f64,
    pub(super) moved_s: f64,
}

/// The means of a group as seen from the latest sample, with the gyroscope's errors taken out.
pub(super) struct Seen {
    pub(super) back: Matrix3<f64>,
    /// Derivative of the mean field by g and s.
    pub(super) by_gyroscope: SMatrix<f64, 3, 12>,
    pub(super) raw_ut: Vector3<f64>,
    pub(super) rate_rad_s: Vector3<f64>,
    pub(super) count: f64,
    pub(super) moved_s: f64,
}

impl Group {
    /// The sums of this group and of the one that follows it.
    fn joined(&self, next: &Self) -> Self {
        Self {
            turned: self.turned.joined(&next.turned),
            back: self.back * next.turned.turn.transpose() + next.back,
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
    groups: ArrayVec<Group, GROUPS>,
    longest_s: f64,
}

impl Default for Groups {
    fn default() -> Self {
        Self { groups: [Group::default()].into_iter().collect(), longest_s: SHORTEST_S }
    }
}

impl Groups {
    /// All groups are used, at their longest: a new one replaces the oldest.
    pub(super) fn is_full(&self) -> bool {
        self.groups.is_full() && self.longest_s >= LONGEST_S
    }

    /// A step of the gyroscope, its errors not removed.
    pub(super) fn turn(&mut self, increment_rad: &Vector3<f64>, dt_s: f64) {
        let latest = self.groups.len() - 1;
        let group = &mut self.groups[latest];
        group.back *= group.turned.step(increment_rad, dt_s).transpose();
    }

    /// A sample after that step. Returns whether a group is full.
    pub(super) fn add(&mut self, raw_ut: &Vector3<f64>, rate_rad_s: &Vector3<f64>, dt_s: f64) -> bool {
        let latest = self.groups.len() - 1;
        let group = &mut self.groups[latest];
        group.back += Matrix3::identity();
        group.raw_ut += raw_ut;
        group.rate_rad_s += rate_rad_s;
        group.count += 1.0;
        group.moved_s += dt_s;
        group.moved_s >= self.longest_s
    }

    /// Drops the oldest quarter.
    pub(super) fn forget(&mut self) {
        self.groups.drain(..self.groups.len() / 4);
    }

    /// Begins another group.
    pub(super) fn close(&mut self) {
        if self.is_full() {
            self.groups.remove(0);
        } else if self.groups.is_full() {
            self.longest_s *= 2.0;
            for k in 0..GROUPS / 2 {
                self.groups[k] = self.groups[2 * k].joined(&self.groups[2 * k + 1]);
            }
            self.groups.truncate(GROUPS / 2);
        }
        self.groups.push(Group::default());
    }

    /// Means over each group, from the latest back to the first, for the field now, and bias and scale error, of `x`.
    pub(super) fn means<'a>(&'a self, x: &Parts) -> impl Iterator<Item = Seen> + use<'a> {
        let x = *x;
        // from now to the group's end, and what g and s do to the field there
        let mut back = Matrix3::identity();
        let mut by_gyroscope = SMatrix::<f64, 3, 12>::zeros();
        self.groups.iter().rev().filter_map(move |group| {
            let Turned { turn, by_gyroscope: of_group, .. } = group.turned;
            let off = group.turned.added(&x);
            let leads = (back * x.field).cross_matrix() * of_group;
            // on average half of a group's error lies between its end and a sample
            let half = Turn::by(&(-off * 0.5)).rotation;
            let mean = group.back * half / group.count;
            let seen = Seen {
                by_gyroscope: mean * (by_gyroscope + leads * 0.5),
                back: mean * back,
                raw_ut: group.raw_ut / group.count,
                rate_rad_s: group.rate_rad_s / group.count,
                count: group.count,
                moved_s: group.moved_s,
            };
            let whole = Turn::by(&-off).rotation;
            let to_start = turn.transpose() * whole;
            by_gyroscope = to_start * (by_gyroscope + leads);
            back = to_start * back;
            (group.count > 0.0).then_some(seen)
        })
    }
}
