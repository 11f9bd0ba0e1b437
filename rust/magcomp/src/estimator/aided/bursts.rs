//! How often the field of the place bursts: quiet for seconds, then tens of microtesla, as a magnet is passed.
//!
//! ```text
//! n, t   misfits, and seconds of motion, both forgotten over T = 30 s       p   share of samples that were gated meanwhile
//! hold = hold_s ln(1 + (n / (t + T)) / device rate)     how long a change must hold before it is believed: in a place that misfits often, for
//!                                                       so long that it is no field that is passed; 0 in a quiet place
//! s^2 = p R^2 / 5,   R^2 = 16 (2 uT)^2                  what may be left in a sample that passed the gate: a field of any size within R
//! ```
//! What was found to be the device's doing counts as none of it. Source: docs/dev/METHOD-AIDED.md, Bursts.

use super::tuning::Tuning;
use crate::math::elementary::{exp, ln};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;

/// See the module.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Bursts {
    /// t.
    seconds: f64,
    /// The place's doing, and what is not yet known to be.
    known: Misfits,
    open: Misfits,
}

/// Misfits, forgotten over T.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct Misfits {
    count: f64,
    /// Share of samples that were gated.
    gated_share: f64,
}

impl Bursts {
    /// A sample in motion.
    pub(super) fn pass(&mut self, is_gated: bool, dt_s: f64, tuning: &Tuning) {
        let keep = exp(-dt_s / tuning.burst_memory_s);
        self.seconds = self.seconds * keep + dt_s;
        for misfits in [&mut self.known, &mut self.open] {
            misfits.count *= keep;
            misfits.gated_share *= keep;
        }
        self.open.gated_share += (1.0 - keep) * f64::from(is_gated);
    }

    /// A misfit began.
    pub(super) fn begin(&mut self) {
        self.open.count += 1.0;
    }

    /// It was the place's doing, or nothing.
    pub(super) fn was_the_place(&mut self) {
        let Misfits { count, gated_share } = core::mem::take(&mut self.open);
        self.known.count += count;
        self.known.gated_share += gated_share;
    }

    /// It was the device's doing.
    pub(super) fn was_the_device(&mut self) {
        self.open = Misfits::default();
    }

    /// How long a change must hold, s.
    pub(super) fn hold_s(&self, tuning: &Tuning) -> f64 {
        if !tuning.hold {
            return 0.0;
        }
        let rate_h = 3600.0 * (self.known.count + self.open.count) / (self.seconds + tuning.burst_memory_s);
        tuning.hold_s * ln(1.0 + rate_h / tuning.device_rate_h)
    }

    /// Variance per axis of what bursts leave in samples that fit, uT^2.
    pub(super) fn left_ut2(&self, tuning: &Tuning) -> f64 {
        if !tuning.left || !tuning.unevenness {
            return 0.0;
        }
        self.known.gated_share * tuning.gate * tuning.local_most_ut.powi(2) / (3.0 + 2.0)
    }
}
