//! Solves H x = g for a symmetric positive definite H by H = L D L^T, in place: on the path of every sample, where a
//! general factorisation of so small a matrix costs several times as much.

#[cfg(test)]
mod tests;

use nalgebra::{SMatrix, SVector};

/// H = L D L^T, L with ones on its diagonal.
pub(crate) struct Ldl<const N: usize> {
    /// Columns of L; what stands on and above the diagonal has no meaning.
    columns: [[f64; N]; N],
    /// D^-1.
    inverse: [f64; N],
}

impl<const N: usize> Ldl<N> {
    /// Only the lower triangle of `h` is read. None unless H is positive definite.
    #[inline]
    pub fn new(h: &SMatrix<f64, N, N>) -> Option<Self> {
        let mut columns = h.data.0;
        let mut inverse = [0.0; N];
        for j in 0..N {
            let (done, rest) = columns.split_at_mut(j + 1);
            let column = &mut done[j];
            let pivot = column[j];
            // also false for NaN
            if !(pivot > 0.0 && pivot < f64::INFINITY) {
                return None;
            }
            inverse[j] = 1.0 / pivot;
            for (i, next) in (j + 1..).zip(rest) {
                add(next, -column[i] * inverse[j], column);
            }
            column.iter_mut().for_each(|value| *value *= inverse[j]);
        }
        Some(Self { columns, inverse })
    }

    /// x with H x = g.
    #[inline]
    pub fn solve(&self, g: &SVector<f64, N>) -> SVector<f64, N> {
        let mut x = *g;
        for i in 0..N {
            for k in 0..i {
                x[i] -= self.columns[k][i] * x[k];
            }
        }
        for i in (0..N).rev() {
            let mut value = x[i] * self.inverse[i];
            for k in i + 1..N {
                value -= self.columns[i][k] * x[k];
            }
            x[i] = value;
        }
        x
    }
}

/// sum += factor row
#[inline(always)]
pub(crate) fn add<const N: usize>(sum: &mut [f64; N], factor: f64, row: &[f64; N]) {
    // written at once, so that the compiler need not ask whether `row` changes with `sum`
    *sum = core::array::from_fn(|i| sum[i] + factor * row[i]);
}

/// x with H x = g. Only the lower triangle of `h` is read. None unless H is positive definite.
#[inline]
pub(crate) fn solve<const N: usize>(h: &SMatrix<f64, N, N>, g: &SVector<f64, N>) -> Option<SVector<f64, N>> {
    Some(Ldl::new(h)?.solve(g))
}
