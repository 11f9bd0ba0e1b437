//! Whether a sample can be used, and what rejected samples tell together.

use super::Compensator;
use crate::reading::RejectReason;
use crate::sample::MagneticSample;

/// So many samples in a row whose time follows that of one another, but not that of the latest: the clock is another one.
const ANOTHER_CLOCK: u32 = 50;

impl Compensator {
    /// Whether a sample rejected for `reason` is the first of another clock; all but the calibration begins anew then.
    pub(super) fn begins_another_clock(&mut self, time_ns: i64, reason: RejectReason) -> bool {
        if !matches!(reason, RejectReason::TimeNotAfter { .. } | RejectReason::TimeJump { .. }) {
            return false;
        }
        let inputs = &mut self.inputs;
        let step_s = (i128::from(time_ns) - i128::from(inputs.astray_ns)) as f64 * 1e-9;
        let follows = inputs.astray > 0 && step_s > 0.0 && step_s <= self.config.sensor.max_gap_s;
        (inputs.astray, inputs.astray_ns) = (if follows { inputs.astray + 1 } else { 1 }, time_ns);
        if inputs.astray < ANOTHER_CLOCK {
            return false;
        }
        self.begin_with(self.calibration());
        true
    }

    /// Whether [`Self::push`] would use this sample now.
    ///
    /// # Errors
    /// [`RejectReason`] says why it would not.
    pub fn check(&self, sample: &MagneticSample) -> Result<(), RejectReason> {
        let limits = &self.config.sensor;
        let field = &sample.field_ut;
        if !field.iter().all(|v| v.is_finite()) {
            return Err(RejectReason::NotFinite);
        }
        let value_ut = field[field.iamax()];
        if let Some(rail_ut) = limits.rail_ut.filter(|rail| value_ut.abs() >= *rail) {
            return Err(RejectReason::Saturated { value_ut, rail_ut });
        }
        if value_ut.abs() > limits.range_ut {
            return Err(RejectReason::OutOfRange { value_ut, limit_ut: limits.range_ut });
        }
        let Some(latest) = self.inputs.latest else { return Ok(()) };
        if sample.time_ns <= latest.time_ns {
            return Err(RejectReason::TimeNotAfter { time_ns: sample.time_ns, latest_ns: latest.time_ns });
        }
        let gap_s = (i128::from(sample.time_ns) - i128::from(latest.time_ns)) as f64 * 1e-9;
        if gap_s > limits.max_gap_s {
            return Err(RejectReason::TimeJump { gap_s, limit_s: limits.max_gap_s });
        }
        let repeats = self.inputs.repeats + 1;
        if limits.stuck_samples > 0 && latest.field_ut == *field && repeats >= limits.stuck_samples {
            return Err(RejectReason::Stuck { repeats });
        }
        Ok(())
    }
}
