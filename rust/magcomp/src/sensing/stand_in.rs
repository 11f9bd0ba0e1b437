//! The turns of a camera's pose in place of a gyroscope that is missing.

#[cfg(test)]
mod tests;

use crate::math::elementary::rotation_vector;
use crate::sample::seconds;
use crate::sensing::pairing::{EventRejection, InertialPairing, STALE_S};
use nalgebra::UnitQuaternion;

/// The latest pose, and when the gyroscope itself last spoke.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct StandIn {
    pose: Option<(i64, UnitQuaternion<f64>)>,
    pub gyroscope_ns: Option<i64>,
}

impl StandIn {
    /// Time passed that the clock does not show: no turn reaches across it.
    pub fn pause(&mut self) {
        self.pose = None;
    }

    /// Whether a pose of this time can be taken.
    pub fn check(&self, time_ns: i64) -> Result<(), EventRejection> {
        let is_late = self.pose.is_some_and(|(before_ns, _)| time_ns <= before_ns);
        if is_late { Err(EventRejection::Late) } else { Ok(()) }
    }

    /// A pose that was checked. Its turn since the pose before goes to the pairing, unless the gyroscope speaks or that pose is too old.
    pub fn take(&mut self, time_ns: i64, to_world: UnitQuaternion<f64>, pairing: &mut InertialPairing) {
        let since_s = |then_ns: i64| seconds(then_ns, time_ns);
        let speaks = self.gyroscope_ns.is_some_and(|it| since_s(it) <= STALE_S);
        let before = self.pose.replace((time_ns, to_world));
        let before = before.filter(|(before_ns, _)| !speaks && since_s(*before_ns) <= STALE_S);
        let Some((before_ns, before)) = before else { return };
        // the mean rate of the time between is that of its middle; a turn that comes too late for its sample is missing, as any event of a gyroscope
        let rate_rad_s = rotation_vector(&(before.inverse() * to_world)) / since_s(before_ns);
        _ = pairing.push_rotation_rate(before_ns + (time_ns - before_ns) / 2, rate_rad_s);
    }
}
