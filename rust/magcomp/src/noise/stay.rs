//! How much a stay tells: the sensor's own memory at rest.
//!
//! Frames of a device that stays would tell 1/n of their variance in the mean if their noise were white. A sensor's is not: it wanders, and
//! beyond some time a longer mean is no better. Misses of a stay are summed over 2^j frames, and differences of neighbouring means (Allan's
//! variance, 1966) say how good a mean is:
//!
//! ```text
//! A_j = mean of (m - m')^2 / 2 over 2^j frames each:   the variance of a mean of so many
//! ```
//! A stay is told in means of 1, 1, 2, 4, ... frames, as long as the longer mean is better.

use super::memory::{MEMORY, START};
use crate::priors::BEYOND_CHANCE;
use core::f64::consts::FRAC_1_SQRT_2;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;

/// Format: lengths of means, in frames 2^j.
const LENGTHS: usize = 7;

/// Mathematics: a mean of twice as many frames is better where its variance is less than so many times that of the half: midway, in logarithms,
/// between white noise, 0.5, and what lasts, 1.
const BETTER: f64 = FRAC_1_SQRT_2;

#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Length {
    /// The mean that waits for its neighbour.
    pending: Option<f64>,
    allan: f64,
    count: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Stays {
    lengths: [Length; LENGTHS],
}

impl Stays {
    /// Before a stay is seen: noise of this variance a frame; a mean of more than four frames is believed to be no better.
    pub fn new(variance: f64) -> Self {
        let length = |j: usize| Length { pending: None, allan: variance / f64::from(1u32 << j.min(2)), count: START };
        Self { lengths: core::array::from_fn(length) }
    }

    /// The device moves on.
    pub fn end(&mut self) {
        self.lengths.iter_mut().for_each(|length| length.pending = None);
    }

    /// The next miss of a stay.
    pub fn add(&mut self, miss: f64) {
        let mut mean = miss;
        for length in &mut self.lengths {
            let Some(before) = length.pending.take() else {
                length.pending = Some(mean);
                return;
            };
            length.count = (length.count + 1.0).min(MEMORY);
            let square = 0.5 * (mean - before).powi(2);
            length.allan += (square.min(BEYOND_CHANCE * BEYOND_CHANCE * length.allan) - length.allan) / length.count;
            mean = 0.5 * (mean + before);
        }
    }

    /// Variance of a mean of 2^j frames, as far as it is better than that of half as many.
    pub fn variance(&self, j: usize) -> Option<f64> {
        let of = |j: usize| self.lengths.get(j).map(|length| length.allan);
        of(j).filter(|own| j == 0 || of(j - 1).is_some_and(|half| *own < BETTER * half))
    }
}
