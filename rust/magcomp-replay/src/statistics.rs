//! What many numbers come to: all at once, or one by one in memory that does not grow with them.

use hdrhistogram::Histogram;
use serde::Serialize;

/// Fewest numbers a figure is formed from.
pub const FEWEST: usize = 50;
/// Significant digits: below 262144 steps every step has a bin of its own.
const DIGITS: u8 = 5;
/// Number of steps; larger sizes all count as the largest.
const MOST: f64 = 1e12;

/// Root mean square; none of nothing.
pub fn rms(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, squares) = values.fold((0_usize, 0.0), |(count, sum), value| (count + 1, sum + value * value));
    (count > 0).then(|| (squares / count as f64).sqrt())
}

/// Middle value, or the mean of the two middle ones; none of nothing.
pub fn median(mut values: Vec<f64>) -> Option<f64> {
    values.sort_by(f64::total_cmp);
    let (low, high) = (values.get(values.len().saturating_sub(1) / 2)?, values.get(values.len() / 2)?);
    Some(if low == high { *low } else { (low + high) / 2.0 })
}

/// The value that this share of them is below; not a number of nothing.
pub fn percentile(mut values: Vec<f64>, share: f64) -> f64 {
    values.sort_by(f64::total_cmp);
    let place = ((values.len() as f64 * share) as usize).min(values.len().saturating_sub(1));
    values.get(place).copied().unwrap_or(f64::NAN)
}

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
pub struct Spread {
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

/// Counted sizes, 0 or more.
#[derive(Clone, Debug)]
pub struct Sizes {
    step: f64,
    counts: Histogram<u64>,
}

impl Default for Sizes {
    /// In steps of a thousandth, far below the noise of every sensor in uT and in degrees.
    fn default() -> Self {
        Self::new(0.001)
    }
}

impl Sizes {
    /// No sizes yet; `step` is the resolution.
    pub fn new(step: f64) -> Self {
        let counts = Histogram::new(DIGITS).expect("at most five digits are allowed");
        Self { step, counts }
    }

    /// One size; not one that is no number.
    pub fn add(&mut self, size: f64) {
        if !size.is_nan() {
            // a histogram that resizes itself takes every value
            let _ = self.counts.record((size / self.step).clamp(0.0, MOST).round() as u64);
        }
    }

    /// How many they are.
    pub fn count(&self) -> usize {
        self.counts.len() as usize
    }

    /// The size with this share of them, thousandths, before it: the upper median for 500; None of none.
    pub fn at(&self, thousandths: u64) -> Option<f64> {
        let before = self.counts.len() * thousandths / 1000;
        // the middle of that size's own place, so that rounding cannot change it
        let place = (before as f64 + 0.5) / self.counts.len() as f64;
        (!self.counts.is_empty()).then(|| self.counts.value_at_quantile(place) as f64 * self.step)
    }

    /// How many lie within these limits.
    pub fn between(&self, low: f64, high: f64) -> usize {
        let (low, high) = ((low / self.step).ceil() as u64, (high / self.step).floor() as u64);
        if low <= high { self.counts.count_between(low, high) as usize } else { 0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_and_counts_are_those_of_the_sorted_sizes() {
        let mut sizes = Sizes::new(1.0);
        assert_eq!((sizes.at(500), sizes.between(0.0, 9.0)), (None, 0));
        (0..2001).rev().for_each(|size| sizes.add(f64::from(size)));
        sizes.add(f64::NAN);
        assert_eq!((sizes.count(), sizes.at(500), sizes.at(999)), (2001, Some(1000.0), Some(1998.0)));
        assert_eq!((sizes.between(10.0, 19.5), sizes.between(10.2, 10.8)), (10, 0));
        sizes.add(f64::INFINITY);
        assert_eq!(sizes.count(), 2002);
    }
}
