//! A mean square that outliers hardly move.
//!
//! ```text
//! v <- v + (min(x^2, 9 v) / 0.995 - v) / n,     n = 10, 11, ... 300
//! ```
//! 0.995 is the mean of min(z^2, 9) of a normal z.

use super::memory::{MEMORY, START};
use crate::priors::BEYOND_CHANCE;

/// Mathematics: the mean of a normal's squares that are cut there.
const CLIPPED_MEAN: f64 = 0.995;

#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct MeanSquare {
    value: f64,
    count: f64,
}

impl MeanSquare {
    pub fn new(value: f64) -> Self {
        Self { value, count: START }
    }

    pub fn add(&mut self, square: f64) {
        self.count = (self.count + 1.0).min(MEMORY);
        self.value += (square.min(BEYOND_CHANCE * BEYOND_CHANCE * self.value) / CLIPPED_MEAN - self.value) / self.count;
    }

    pub fn value(&self) -> f64 {
        self.value
    }
}
