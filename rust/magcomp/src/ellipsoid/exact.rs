//! Sums without rounding: what enters and leaves again leaves nothing behind, in whatever order.

use nalgebra::{ArrayStorage, SVector};

/// Exact running sums of so many values at once, in units of 2^-60.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct ExactSums<const N: usize>(SVector<i128, N>);

/// Mathematics: units of 2^-20, and of 2^-40 of those.
const HIGH_UNIT: f64 = (1u64 << 20) as f64;
/// Mathematics: see `HIGH_UNIT`.
const LOW_BITS: u32 = 40;
/// Mathematics: see `HIGH_UNIT`.
const LOW_UNIT: f64 = (1u64 << LOW_BITS) as f64;
/// Limit: far beyond any field: only keeps absurd input from overflowing.
const LARGEST: f64 = (1u64 << 40) as f64;

/// A value in units of 2^-60, cut: whole units of 2^-20 first, because a conversion to 128 bits at once is slow.
#[inline]
fn fixed(value: f64) -> i128 {
    let scaled = value.clamp(-LARGEST, LARGEST) * HIGH_UNIT;
    let high = scaled as i64;
    (i128::from(high) << LOW_BITS) + i128::from(((scaled - high as f64) * LOW_UNIT) as i64)
}

impl<const N: usize> ExactSums<N> {
    /// Mathematics: of nothing.
    pub const ZERO: Self = Self(SVector::from_array_storage(ArrayStorage([[0; N]])));

    /// Values enter as often as `times` says; they leave where that is negative.
    #[inline]
    pub fn add_times(&mut self, values: [f64; N], times: i64) {
        for (sum, value) in self.0.iter_mut().zip(values) {
            *sum = sum.wrapping_add(fixed(value).wrapping_mul(times.into()));
        }
    }

    /// The sums, rounded.
    pub fn values(&self) -> [f64; N] {
        let low = |sum| (sum & ((1 << LOW_BITS) - 1)) as i64 as f64;
        let [values] = self.0.map(|sum| ((sum >> LOW_BITS) as i64 as f64 + low(sum) / LOW_UNIT) / HIGH_UNIT).data.0;
        values
    }
}
