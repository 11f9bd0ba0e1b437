//! Mean and standard deviation of numbers that come one by one.

use super::circle::FEWEST;
use serde::Serialize;

/// Mean and standard deviation, in the unit that the field's name tells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeanSpread {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub spread: f64,
}

/// Mean and standard deviation of numbers that come one by one (Welford's recurrence).
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Spread {
    count: usize,
    mean: f64,
    /// Sum of the squares about the mean.
    squares: f64,
}

impl Spread {
    /// One number; not one that is not finite.
    pub fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.count += 1;
            let off = value - self.mean;
            self.mean += off / self.count as f64;
            self.squares += off * (value - self.mean);
        }
    }

    /// Mean and standard deviation of them all, however few.
    pub fn all(&self) -> MeanSpread {
        MeanSpread { mean: self.mean, spread: (self.squares / self.count as f64).sqrt() }
    }

    /// Mean and standard deviation; none of fewer than 50.
    pub fn mean_spread(&self) -> Option<MeanSpread> {
        (self.count >= FEWEST).then(|| self.all())
    }
}
