//! Whether a sample can be used, and what rejected samples tell together.

#[cfg(test)]
mod tests;

use super::rails::Rails;
use super::repeats::Repeats;
use super::tuning::Tuning;
use crate::reading::{Axis, RejectReason};
use crate::sample::{MagneticSample, seconds};
use nalgebra::Vector3;

/// Limit: largest step ahead in time, s: a week is longer than an app's pause, and shorter than the jump of a time in the wrong unit.
const LONGEST_GAP_S: f64 = 604_800.0;

/// The samples so far, as the checks of the next one look at them.
#[derive(Clone, Copy, Debug, Default, serde::Serialize, serde::Deserialize)]
pub(super) struct Stream {
    latest: Option<MagneticSample>,
    pub repeats: Repeats,
    rails: Rails,
    /// Samples in a row that were rejected for their time but follow one another, and the time of the latest, ns.
    astray: u32,
    astray_ns: i64,
}

/// Whether two will judge alike, but for samples of another clock that were refused so far.
impl PartialEq for Stream {
    fn eq(&self, other: &Self) -> bool {
        (self.latest, self.repeats, self.rails) == (other.latest, other.repeats, other.rails)
    }
}

impl Stream {
    /// Time of the latest sample that was accepted.
    pub fn latest_ns(&self) -> Option<i64> {
        self.latest.map(|latest| latest.time_ns)
    }

    /// A sample is used; the time of the one before, ns.
    pub fn accept(&mut self, sample: MagneticSample) -> Option<i64> {
        (self.astray, self.astray_ns) = (0, 0);
        self.rails.see(&sample.field_ut);
        let previous = self.latest.replace(sample);
        self.repeats.count(previous.is_some_and(|previous| previous.field_ut == sample.field_ut));
        previous.map(|previous| previous.time_ns)
    }

    /// A sample's field is of no use, but its time is; the time of the one before, ns.
    pub fn pass(&mut self, time_ns: i64) -> Option<i64> {
        (self.astray, self.astray_ns) = (0, 0);
        let field_ut = self.latest.map_or_else(Vector3::zeros, |latest| latest.field_ut);
        self.latest.replace(MagneticSample { time_ns, field_ut }).map(|latest| latest.time_ns)
    }

    /// A sample was rejected: whether there were so many in a row, each for its time, that the clock is another one.
    pub fn stray(&mut self, time_ns: i64, reason: RejectReason) -> bool {
        if !matches!(reason, RejectReason::TimeNotAfter { .. } | RejectReason::TimeJump { .. }) {
            return false;
        }
        let step_s = seconds(self.astray_ns, time_ns);
        let follows = self.astray > 0 && step_s > 0.0 && step_s <= LONGEST_GAP_S;
        (self.astray, self.astray_ns) = (if follows { self.astray + 1 } else { 1 }, time_ns);
        f64::from(self.astray) >= Tuning::USED.run_samples
    }

    /// Whether the sample can be used, for a sensor's range and full scale; `is_told`: gyroscope or gravity speaks.
    pub fn check(
        &self,
        sample: &MagneticSample,
        range_ut: f64,
        rail_ut: Option<f64>,
        tuning: &Tuning,
        is_told: impl FnOnce() -> bool,
    ) -> Result<(), RejectReason> {
        let field = &sample.field_ut;
        if !field.iter().all(|v| v.is_finite()) {
            return Err(RejectReason::NotFinite);
        }
        self.check_time(sample.time_ns)?;
        let largest = field.iamax();
        let value_ut = field[largest];
        if let Some(rail_ut) = rail_ut.filter(|rail| value_ut.abs() >= *rail) {
            return Err(RejectReason::Saturated { axis: [Axis::X, Axis::Y, Axis::Z][largest], value_ut, rail_ut });
        }
        if value_ut.abs() > range_ut {
            return Err(RejectReason::OutOfRange { value_ut, limit_ut: range_ut });
        }
        if tuning.rails {
            self.rails.check(field)?;
        }
        let is_same = self.latest.is_some_and(|latest| latest.field_ut == *field);
        let repeats = if tuning.stuck && is_same { self.repeats.hang(is_told()) } else { None };
        repeats.map_or(Ok(()), |repeats| Err(RejectReason::Stuck { repeats }))
    }

    /// Whether its time can be.
    pub fn check_time(&self, time_ns: i64) -> Result<(), RejectReason> {
        let Some(latest_ns) = self.latest_ns() else { return Ok(()) };
        if time_ns <= latest_ns {
            return Err(RejectReason::TimeNotAfter { time_ns, latest_ns });
        }
        let (gap_s, limit_s) = (seconds(latest_ns, time_ns), LONGEST_GAP_S);
        if gap_s > limit_s { Err(RejectReason::TimeJump { gap_s, limit_s }) } else { Ok(()) }
    }
}
