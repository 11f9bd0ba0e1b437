//! A mean square that outliers hardly move.
//!
//! ```text
//! v <- v + (min(x^2, 4 v) / 0.92 - v) / n,     n = 20, 21, ... 1000
//! ```
//! 0.92 is the mean of min(z^2, 4) of a normal z.

/// Choice: samples that the value at the start is worth.
const START: f64 = 20.0;
/// Choice: samples that are remembered: 3 % of scatter.
const MEMORY: f64 = 1000.0;
/// Choice: squares count as at most so many mean ones.
const CLIP: f64 = 4.0;
/// Mathematics: the mean of a normal's squares that are cut there.
const CLIPPED_MEAN: f64 = 0.9205;

/// See the module.
#[derive(Clone, Copy, Debug, PartialEq)]
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
        self.value += (square.min(CLIP * self.value) / CLIPPED_MEAN - self.value) / self.count;
    }

    pub fn value(&self) -> f64 {
        self.value
    }
}
