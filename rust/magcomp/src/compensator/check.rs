//! Whether a sample can be used, and what rejected samples tell together.

use super::Compensator;
use crate::config::Config;
use crate::reading::{Axis, RejectReason};
use crate::sample::MagneticSample;

/// So many samples in a row whose time follows that of one another, but not that of the latest: the clock is another one.
const ANOTHER_CLOCK: u32 = 50;
/// So many equal samples in a row mean that the sensor hangs: half a second at 100 Hz. The noise of every phone magnetometer
/// changes the last digit sooner.
const STUCK_SAMPLES: usize = 50;
/// Largest step ahead in time, s: a week, longer pauses than any app's, shorter than the jump of a time in the wrong unit.
const MAX_GAP_S: f64 = 604_800.0;

impl Compensator {
    /// Whether a sample rejected for `reason` is the first of another clock; all but the calibration begins anew then.
    pub(super) fn begins_another_clock(&mut self, time_ns: i64, reason: RejectReason) -> bool {
        if !matches!(reason, RejectReason::TimeNotAfter { .. } | RejectReason::TimeJump { .. }) {
            return false;
        }
        let inputs = &mut self.inputs;
        let step_s = (i128::from(time_ns) - i128::from(inputs.astray_ns)) as f64 * 1e-9;
        let follows = inputs.astray > 0 && step_s > 0.0 && step_s <= MAX_GAP_S;
        (inputs.astray, inputs.astray_ns) = (if follows { inputs.astray + 1 } else { 1 }, time_ns);
        if inputs.astray < ANOTHER_CLOCK {
            return false;
        }
        self.begin_another_clock();
        true
    }

    /// Whether [`Self::push`] would use this sample now.
    ///
    /// # Errors
    /// [`RejectReason`] says why it would not.
    pub fn check(&self, sample: &MagneticSample) -> Result<(), RejectReason> {
        let Config { range_ut, rail_ut, .. } = self.config;
        let field = &sample.field_ut;
        if !field.iter().all(|v| v.is_finite()) {
            return Err(RejectReason::NotFinite);
        }
        let largest = field.iamax();
        let value_ut = field[largest];
        if let Some(rail_ut) = rail_ut.filter(|rail| value_ut.abs() >= *rail) {
            return Err(RejectReason::Saturated { axis: [Axis::X, Axis::Y, Axis::Z][largest], value_ut, rail_ut });
        }
        if value_ut.abs() > range_ut {
            return Err(RejectReason::OutOfRange { value_ut, limit_ut: range_ut });
        }
        let Some(latest) = self.inputs.latest else { return Ok(()) };
        if sample.time_ns <= latest.time_ns {
            return Err(RejectReason::TimeNotAfter { time_ns: sample.time_ns, latest_ns: latest.time_ns });
        }
        let gap_s = (i128::from(sample.time_ns) - i128::from(latest.time_ns)) as f64 * 1e-9;
        if gap_s > MAX_GAP_S {
            return Err(RejectReason::TimeJump { gap_s, limit_s: MAX_GAP_S });
        }
        let repeats = self.inputs.repeats.saturating_add(1);
        if latest.field_ut == *field && repeats >= STUCK_SAMPLES {
            return Err(RejectReason::Stuck { repeats });
        }
        Ok(())
    }
}
