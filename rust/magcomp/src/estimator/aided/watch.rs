//! What is kept of the samples that do not fit: their share, size and beginning.
//!
//! ```text
//! share += (1 - exp(-dt / t)) ([NIS > gate] - share),   t = 0.5 s, falling with 0.25 s while hypotheses run
//! |v|:  low-passed over gated samples (0.125 s)
//! ```
//! Source: docs/dev/METHOD-AIDED.md.

use nalgebra::Vector3;

use super::step::{Step, gain};
use super::tuning::Tuning;

/// Watches the share of samples that the filter does not explain.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Watch {
    /// Low-passed share of gated samples.
    share: f64,
    /// When the present run of gated samples began.
    since_ns: i64,
    /// Low-passed |v| over gated samples, uT.
    misfit_ut: f64,
}

impl Watch {
    /// Low-passed share of gated samples.
    pub(crate) fn share(&self) -> f64 {
        self.share
    }

    /// When the present run of gated samples began.
    pub(crate) fn since_ns(&self) -> i64 {
        self.since_ns
    }

    /// Low-passed size of what did not fit, uT.
    pub(crate) fn misfit_ut(&self) -> f64 {
        self.misfit_ut
    }

    /// A run of misfits begins here, whatever the share is.
    pub(crate) fn begin(&mut self, time_ns: i64, misfit_ut: f64) {
        self.since_ns = time_ns;
        self.misfit_ut = misfit_ut;
    }

    /// One sample: its innovation if it was gated.
    pub(crate) fn step(&mut self, step: &Step<'_>, gated: Option<&Vector3<f64>>, clearing: bool, tuning: &Tuning) {
        let time_s = if clearing && gated.is_none() { tuning.quick_s } else { tuning.memory_s };
        if let Some(v) = gated {
            if self.share < 0.5 * tuning.suspect_share {
                self.begin(step.time_ns, v.norm());
            }
            // short against a change
            let gain = gain(step.dt_s, 0.5 * tuning.quick_s);
            self.misfit_ut += gain * (v.norm() - self.misfit_ut);
        }
        self.share += gain(step.dt_s, time_s) * (f64::from(gated.is_some()) - self.share);
    }
}
