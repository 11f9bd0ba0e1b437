//! What is kept of the samples that do not fit: their share, size and beginning; and the calibration before the last step.
//!
//! ```text
//! share += (1 - exp(-dt / t)) ([NIS > gate] - share),   t = 0.5 s, falling with 0.25 s while hypotheses run
//! |v|, raw - (M h + b)_former:  low-passed over gated samples (0.125 s)
//! ```
//! Source: docs/dev/METHOD-AIDED.md; the recall of a former calibration is new.

use crate::math::elementary::gain;
use nalgebra::Vector3;

use super::state::{CALIBRATION, Filter, HARD_IRON, HARD_IRON_ALONE, SOFT_IRON_ALONE};
use super::step::FrameStep;
use super::tuning::Tuning;
use crate::calibration::iron_rows;
use crate::math::gaussian::Gaussian;

/// A calibration that was in force before a step.
pub(crate) type Former = Gaussian<9>;

impl Former {
    /// raw - (M h + b) of this calibration, uT.
    pub(crate) fn residual(&self, raw_ut: &Vector3<f64>, h: &Vector3<f64>) -> Vector3<f64> {
        raw_ut - h - self.part(HARD_IRON_ALONE) - iron_rows(h) * self.part(SOFT_IRON_ALONE)
    }

    /// Puts this calibration into a filter, apart from all else in it.
    pub(crate) fn put_into(&self, filter: &mut Filter, tuning: &Tuning) {
        filter.isolate(CALIBRATION, &self.covariance);
        filter.set_part(CALIBRATION, &self.mean);
        filter.add_variance(HARD_IRON, tuning.noise_start_ut * tuning.noise_start_ut);
    }
}

/// Watches the share of samples that the filter does not explain.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Watch {
    /// Low-passed share of gated samples.
    pub(super) share: f64,
    /// When the present run of gated samples began.
    pub(super) since_ns: i64,
    /// Low-passed |v| over gated samples, uT.
    pub(super) misfit_ut: f64,
    /// Low-passed residual of the former calibration over gated samples, uT.
    former_ut: Vector3<f64>,
}

impl Watch {
    /// A run of misfits begins here, whatever the share is.
    pub(crate) fn begin(&mut self, time_ns: i64, misfit_ut: f64) {
        self.since_ns = time_ns;
        self.misfit_ut = misfit_ut;
    }

    /// Whether the samples that do not fit now fit the calibration from before the last step.
    pub(crate) fn fits_former(&self, tuning: &Tuning) -> bool {
        self.former_ut.norm() < 0.5 * tuning.smallest_step_ut
    }

    /// One sample: its innovation if it was gated, and the residual of the former calibration.
    pub(crate) fn step(
        &mut self,
        step: &FrameStep,
        gated: Option<&Vector3<f64>>,
        former: Option<Vector3<f64>>,
        clearing: bool,
        tuning: &Tuning,
    ) {
        let time_s = if clearing && gated.is_none() { tuning.quick_s } else { tuning.memory_s };
        if let Some(v) = gated {
            if self.share < 0.5 * tuning.suspect_share {
                self.begin(step.time_ns, v.norm());
                self.former_ut = former.unwrap_or_default();
            }
            // short against a change
            let gain = gain(step.dt_s, 0.5 * tuning.quick_s);
            self.misfit_ut += gain * (v.norm() - self.misfit_ut);
            if let Some(former) = former {
                self.former_ut += (former - self.former_ut) * gain;
            }
        }
        self.share += gain(step.dt_s, time_s) * (f64::from(gated.is_some()) - self.share);
    }
}

#[cfg(test)]
mod tests;
