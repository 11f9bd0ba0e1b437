//! Sizes of any number of rows in bounded memory: a histogram with five significant digits.

use hdrhistogram::Histogram;

/// Significant digits: below 262144 steps every step has a bin of its own.
const DIGITS: u8 = 5;
/// Number of steps; larger sizes all count as the largest.
const MOST: f64 = 1e12;

/// Counted sizes, 0 or more.
#[derive(Clone, Debug)]
pub(super) struct Sizes {
    step: f64,
    counts: Histogram<u64>,
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
