//! A Gaussian over the N numbers of a state, the parts of that state, and the correction by what is measured of it.
//!
//! ```text
//! v = measured - expected,   P_v = H P H^T + noise = root root^T,   gain = P H^T root^-T,   white = root^-1 v
//! mean <- mean + gain white,   P <- P - gain gain^T + held held^T
//! ```
//! `held` is the part of `gain` that belongs to states which a correction holds (Schmidt 1966): they stay as they are, yet their uncertainty
//! counts. P stays symmetric by construction.

#[cfg(test)]
mod tests;

use core::ops::Range;
use nalgebra::{ArrayStorage, Const, MatrixView, MatrixViewMut, SMatrix, SVector};

/// A part of a state: `LEN` numbers in a row.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Part<const LEN: usize> {
    first: usize,
    least_variance: f64,
}

impl<const LEN: usize> Part<LEN> {
    /// The first part of a state. No variance of it is below `least_variance`, which is what rounding can carry.
    pub const fn first(least_variance: f64) -> Self {
        Self { first: 0, least_variance }
    }

    /// The part that comes after this one.
    pub const fn then<const NEXT: usize>(self, least_variance: f64) -> Part<NEXT> {
        Part { first: self.end(), least_variance }
    }

    /// This part and what follows it, `ALL` numbers in all.
    pub const fn with_next<const ALL: usize>(self) -> Part<ALL> {
        assert!(ALL > LEN);
        Part { first: self.first, least_variance: self.least_variance }
    }

    /// What rounding can carry, and so the variance of what is as good as known.
    pub const fn least_variance(self) -> f64 {
        self.least_variance
    }

    /// Where it begins.
    pub const fn start(self) -> usize {
        self.first
    }

    /// Where the next one begins.
    pub const fn end(self) -> usize {
        self.first + LEN
    }

    /// This part and those that follow it, up to but without `other`.
    pub const fn until<const NEXT: usize>(self, other: Part<NEXT>) -> Range<usize> {
        self.first..other.first
    }

    pub const fn range(self) -> Range<usize> {
        self.first..self.end()
    }

    /// Its numbers in a state.
    #[inline(always)]
    pub fn of<const N: usize>(self, state: &SVector<f64, N>) -> SVector<f64, LEN> {
        SVector::from(core::array::from_fn(|k| state[self.first + k]))
    }

    /// Sets its numbers in a state.
    #[inline(always)]
    pub fn set<const N: usize>(self, state: &mut SVector<f64, N>, to: &SVector<f64, LEN>) {
        state.fixed_rows_mut::<LEN>(self.first).copy_from(to);
    }

    /// Its block of a covariance or a precision.
    #[inline(always)]
    pub fn block<const N: usize>(self, of: &SMatrix<f64, N, N>) -> SMatrix<f64, LEN, LEN> {
        let column = |k| core::array::from_fn(|i| of[(self.first + i, k)]);
        SMatrix::from_data(ArrayStorage(core::array::from_fn(|k| column(self.first + k))))
    }

    /// The same, where it is.
    #[inline(always)]
    pub fn view<const N: usize>(
        self,
        of: &SMatrix<f64, N, N>,
    ) -> MatrixView<'_, f64, Const<LEN>, Const<LEN>, Const<1>, Const<N>> {
        of.fixed_view::<LEN, LEN>(self.first, self.first)
    }

    /// The same, to be changed.
    #[inline(always)]
    pub fn block_mut<const N: usize>(
        self,
        of: &mut SMatrix<f64, N, N>,
    ) -> MatrixViewMut<'_, f64, Const<LEN>, Const<LEN>, Const<1>, Const<N>> {
        of.fixed_view_mut::<LEN, LEN>(self.first, self.first)
    }
}

/// States that a correction holds.
pub(crate) type Held<'a> = &'a [Range<usize>];

/// Mean and covariance, which is symmetric.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Gaussian<const N: usize> {
    pub mean: SVector<f64, N>,
    pub covariance: SMatrix<f64, N, N>,
}

impl<const N: usize> Default for Gaussian<N> {
    /// Zero, and known to be.
    fn default() -> Self {
        Self { mean: SVector::zeros(), covariance: SMatrix::zeros() }
    }
}

impl<const N: usize> Gaussian<N> {
    /// Whether mean and variances are; what is not finite elsewhere comes there with the next correction.
    pub fn is_finite(&self) -> bool {
        (self.mean.sum() + self.covariance.trace()).is_finite()
    }

    /// The mean of a part.
    #[inline(always)]
    pub fn part<const LEN: usize>(&self, part: Part<LEN>) -> SVector<f64, LEN> {
        part.of(&self.mean)
    }

    /// Sets the mean of a part.
    #[inline(always)]
    pub fn set_part<const LEN: usize>(&mut self, part: Part<LEN>, to: &SVector<f64, LEN>) {
        part.set(&mut self.mean, to);
    }

    /// The covariance of a part.
    #[inline(always)]
    pub fn own<const LEN: usize>(&self, part: Part<LEN>) -> SMatrix<f64, LEN, LEN> {
        part.block(&self.covariance)
    }

    /// The variance of each number of a part.
    #[inline(always)]
    pub fn variances<const LEN: usize>(&self, part: Part<LEN>) -> SVector<f64, LEN> {
        SVector::from(core::array::from_fn(|k| self.covariance[(part.first + k, part.first + k)]))
    }

    /// The covariance of all states with those of a part.
    #[inline(always)]
    pub fn columns<const LEN: usize>(&self, part: Part<LEN>) -> SMatrix<f64, N, LEN> {
        self.covariance.fixed_columns::<LEN>(part.first).into_owned()
    }

    /// The Gaussian of a part alone.
    pub fn marginal<const LEN: usize>(&self, part: Part<LEN>) -> Gaussian<LEN> {
        Gaussian { mean: self.part(part), covariance: self.own(part) }
    }

    /// Adds an independent error of a part.
    pub fn add<const LEN: usize>(&mut self, part: Part<LEN>, covariance: &SMatrix<f64, LEN, LEN>) {
        let mut own = part.block_mut(&mut self.covariance);
        own += covariance;
    }

    /// Adds an independent error of each number of a part.
    pub fn add_variance<const LEN: usize>(&mut self, part: Part<LEN>, variance: f64) {
        part.range().for_each(|k| self.covariance[(k, k)] += variance);
    }

    /// Makes a part independent of all others, with the covariance `own`.
    pub fn isolate<const LEN: usize>(&mut self, part: Part<LEN>, own: &SMatrix<f64, LEN, LEN>) {
        self.covariance.fixed_rows_mut::<LEN>(part.first).fill(0.0);
        self.covariance.fixed_columns_mut::<LEN>(part.first).fill(0.0);
        part.block_mut(&mut self.covariance).copy_from(own);
    }

    /// Raises the variances of a part to its least.
    #[inline(always)]
    pub fn raise<const LEN: usize>(&mut self, part: Part<LEN>) {
        for i in part.range() {
            self.covariance[(i, i)] = self.covariance[(i, i)].max(part.least_variance);
        }
    }

    /// Corrects by R measured numbers, but for what is `held`. See the module for `gain` and `white`.
    #[inline(always)]
    pub fn correct<const R: usize>(&mut self, gain: &SMatrix<f64, N, R>, white: &SVector<f64, R>, held: Held<'_>) {
        let mut add = |v: &SMatrix<f64, N, R>, sign: f64| {
            let own = v * sign;
            // the lower half of P alone, columns in fours as vector units take them
            for (first, columns) in (0..N).step_by(4).zip(self.covariance.data.0.chunks_mut(4)) {
                for i in first..N {
                    for (j, column) in (first..).zip(&mut *columns) {
                        for r in 0..R {
                            column[i] += v[(i, r)] * own[(j, r)];
                        }
                    }
                }
            }
        };
        add(gain, -1.0);
        let before = self.mean;
        self.mean += gain * white;
        if !held.is_empty() {
            let mut kept = SMatrix::<f64, N, R>::zeros();
            for k in held.iter().cloned().flatten() {
                kept.set_row(k, &gain.row(k));
                self.mean[k] = before[k];
            }
            add(&kept, 1.0);
        }
        self.covariance.fill_upper_triangle_with_lower_triangle();
    }
}
