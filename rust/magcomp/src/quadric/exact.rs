//! Sums without rounding: what enters and leaves again leaves nothing behind, in whatever order.

/// An exact running sum: `high` counts units of 2^-20, `low` units of 2^-60.
///
/// `low` stays in [0, 2^40), so that it never overflows and a value has one form only.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(from = "(i64, i64)", into = "(i64, i64)")
)]
pub(super) struct ExactSum {
    high: i64,
    low: i64,
}

impl From<ExactSum> for (i64, i64) {
    fn from(sum: ExactSum) -> Self {
        (sum.high, sum.low)
    }
}

impl From<(i64, i64)> for ExactSum {
    fn from((high, low): (i64, i64)) -> Self {
        Self { high, low: low & LOW_MASK }
    }
}

const HIGH_UNIT: f64 = (1u64 << 20) as f64;
const LOW_BITS: u32 = 40;
const LOW_UNIT: f64 = (1u64 << LOW_BITS) as f64;
const LOW_MASK: i64 = (1 << LOW_BITS) - 1;
const LARGEST: f64 = (1u64 << 40) as f64;

impl ExactSum {
    #[inline]
    pub(super) fn split(value: f64) -> (i64, i64) {
        // far beyond any field: only keeps absurd input from overflowing
        let scaled = value.clamp(-LARGEST, LARGEST) * HIGH_UNIT;
        let high = scaled as i64;
        (high, ((scaled - high as f64) * LOW_UNIT) as i64)
    }

    #[inline]
    fn add(&mut self, (high, low): (i64, i64)) {
        let low = self.low + low;
        self.high = self.high.wrapping_add(high).wrapping_add(low >> LOW_BITS);
        self.low = low & LOW_MASK;
    }

    #[inline]
    fn add_times(&mut self, value: f64, times: i64) {
        let (high, low) = Self::split(value);
        self.add((high.wrapping_mul(times), low * times));
    }

    #[inline]
    fn value(self) -> f64 {
        (self.high as f64 + self.low as f64 / LOW_UNIT) / HIGH_UNIT
    }
}

/// Exact running sums of so many values at once.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(
    feature = "serde",
    derive(serde::Serialize, serde::Deserialize),
    serde(try_from = "Vec<ExactSum>", into = "Vec<ExactSum>")
)]
pub(crate) struct ExactSums<const N: usize>([ExactSum; N]);

impl<const N: usize> From<ExactSums<N>> for Vec<ExactSum> {
    fn from(sums: ExactSums<N>) -> Self {
        sums.0.to_vec()
    }
}

impl<const N: usize> TryFrom<Vec<ExactSum>> for ExactSums<N> {
    type Error = &'static str;
    fn try_from(sums: Vec<ExactSum>) -> Result<Self, Self::Error> {
        sums.try_into().map(Self).map_err(|_| "another number of sums expected")
    }
}

impl<const N: usize> ExactSums<N> {
    pub const ZERO: Self = Self([ExactSum { high: 0, low: 0 }; N]);

    /// Values that were split enter.
    #[inline]
    pub fn add(&mut self, parts: [(i64, i64); N]) {
        self.0.iter_mut().zip(parts).for_each(|(sum, part)| sum.add(part));
    }

    /// Values enter as often as `times` says; they leave where that is negative.
    #[inline]
    pub fn add_times(&mut self, values: [f64; N], times: i64) {
        self.0.iter_mut().zip(values).for_each(|(sum, value)| sum.add_times(value, times));
    }

    pub fn values(&self) -> [f64; N] {
        self.0.map(ExactSum::value)
    }
}
