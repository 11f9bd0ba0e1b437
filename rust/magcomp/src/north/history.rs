//! How the device turned in the last seconds, so that a heading that comes late is used at the time it was true.

use crate::math::elementary::rotation_vector;
use crate::math::turn::Turn;
use crate::sample::seconds;
use arrayvec::ArrayVec;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// Limit: a heading may come so late, s: a GNSS fix that a system has batched.
pub(super) const LATEST_S: f64 = 5.0;
/// Choice: turns held over that time.
const TURNS: usize = 64;

/// Turns since the chain of rotations began.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct History {
    turns: ArrayVec<Turned, TURNS>,
    latest: Option<Turned>,
}

/// C: takes a vector of the device frame at the chain's beginning to that at `time_ns`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Turned {
    time_ns: i64,
    turn: Matrix3<f64>,
}

impl History {
    /// The device turned.
    pub fn turn(&mut self, time_ns: i64, turn: &Matrix3<f64>) {
        let so_far = self.latest.map_or_else(Matrix3::identity, |latest| turn * latest.turn);
        let latest = Turned { time_ns, turn: so_far };
        let least_s = LATEST_S / TURNS as f64;
        if self.turns.last().is_none_or(|last| seconds(last.time_ns, time_ns) >= least_s) {
            if self.turns.is_full() {
                self.turns.remove(0);
            }
            self.turns.push(latest);
        }
        self.latest = Some(latest);
    }

    /// A vector of the device frame at `time_ns` in that of the latest sample; `None` where no turn is known from then to now.
    pub fn brought(&self, vector: &Vector3<f64>, time_ns: i64) -> Option<Vector3<f64>> {
        let latest = self.latest?;
        let after = self.turns.partition_point(|it| it.time_ns <= time_ns);
        let from = self.turns.get(after.checked_sub(1)?)?;
        let to = self.turns.get(after).unwrap_or(&latest);
        let share = (time_ns - from.time_ns) as f64 / ((to.time_ns - from.time_ns) as f64).max(1.0);
        let whole = Rotation3::from_matrix_unchecked(to.turn * from.turn.transpose());
        let whole_rad = rotation_vector(&UnitQuaternion::from_rotation_matrix(&whole));
        let between = Turn::by(&(whole_rad * share.clamp(0.0, 1.0))).rotation;
        Some(latest.turn * (between * from.turn).transpose() * vector)
    }
}
