//! The state and its covariance: x = [m, b, e, g, tau, s, d], 28 numbers, P symmetric.
//!
//! ```text
//! m    field of the place in the device frame at the gyroscope's time, uT
//! b    hard iron, uT
//! e    soft iron M = I + E, e = (E_xx, E_yy, E_zz, E_xy, E_xz, E_yz), trace E = 0
//! g    gyroscope bias, rad/s
//! tau  how late the magnetometer is against the gyroscope, s
//! s    S by columns: scale and axes of the gyroscope against the magnetometer's, true rate = (I - S) reading - g
//! d    local deviation of the field (rooms are not uniform), device frame, uT
//! ```
//!
//! raw = M h + b leaves the scale between M and |h| free, so E is held traceless. Source: docs/METHOD-AIDED.md.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// Length of the state.
pub(crate) const STATES: usize = 28;
// the first index of each of its parts, in that order
pub(crate) const FIELD: usize = 0;
pub(crate) const OFFSET: usize = 3;
pub(crate) const IRON: usize = 6;
pub(crate) const BIAS: usize = 12;
pub(crate) const DELAY: usize = 15;
pub(crate) const SCALE: usize = 16;
pub(crate) const LOCAL: usize = 25;

/// Offset of a phone before anything is known, uT: several hundred at the most.
pub(crate) const OFFSET_SD_UT: f64 = 150.0;

/// Index of E_ij in e.
pub(crate) const ELEMENT: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];

/// Share of the soft iron's variance that is left to its trace: none would make P singular, much would untie the gauge.
const TRACE_SHARE: f64 = 1e-6;

/// State and covariance.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Gaussian {
    pub(crate) x: SVector<f64, STATES>,
    pub(crate) p: SMatrix<f64, STATES, STATES>,
}

impl Gaussian {
    /// Whether mean and variances are; what is not finite elsewhere comes there with the next step.
    pub(crate) fn is_finite(&self) -> bool {
        (self.x.sum() + self.p.trace()).is_finite()
    }

    /// The 3x3 block of the covariance whose first indices are given.
    pub(crate) fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        self.p.fixed_view::<3, 3>(i, j).into_owned()
    }

    /// The covariance of (b, e).
    pub(crate) fn calibration_block(&self) -> SMatrix<f64, 9, 9> {
        self.p.fixed_view::<9, 9>(OFFSET, OFFSET).into_owned()
    }

    pub(crate) fn vector(&self, i: usize) -> Vector3<f64> {
        self.x.fixed_rows::<3>(i).into_owned()
    }

    pub(crate) fn set_vector(&mut self, i: usize, v: &Vector3<f64>) {
        self.x.fixed_rows_mut::<3>(i).copy_from(v);
    }

    pub(crate) fn parts(&self) -> Parts {
        Parts::of(|i| self.x[i])
    }

    /// Adds a symmetric 3x3 block on the diagonal.
    pub(crate) fn add_block(&mut self, i: usize, block: &Matrix3<f64>) {
        let mut to = self.p.fixed_view_mut::<3, 3>(i, i);
        to += block;
    }

    /// Adds variance to three states on the diagonal.
    pub(crate) fn add_variance(&mut self, i: usize, variance: f64) {
        self.add_block(i, &Matrix3::from_diagonal_element(variance));
    }

    /// Adds variance to the soft iron by the traceless pattern T.
    pub(crate) fn add_iron_variance(&mut self, variance: f64) {
        let own = Matrix3::from_diagonal_element(1.0 + TRACE_SHARE) - Matrix3::repeat(1.0 / 3.0);
        self.add_block(IRON, &(own * variance));
        self.add_variance(IRON + 3, 0.5 * variance);
    }

    /// Sets the covariances between the N states from `i` on and all others to zero, and their own block to `own`.
    pub(crate) fn isolate<const N: usize>(&mut self, i: usize, own: &SMatrix<f64, N, N>) {
        self.p.fixed_rows_mut::<N>(i).fill(0.0);
        self.p.fixed_columns_mut::<N>(i).fill(0.0);
        self.p.fixed_view_mut::<N, N>(i, i).copy_from(own);
    }
}

/// A state, or a small change of one, by its parts: E and S as matrices.
#[derive(Clone, Copy)]
pub(crate) struct Parts {
    pub(crate) field: Vector3<f64>,
    pub(crate) offset: Vector3<f64>,
    pub(crate) iron: Matrix3<f64>,
    pub(crate) bias: Vector3<f64>,
    pub(crate) delay: f64,
    pub(crate) scale: Matrix3<f64>,
    pub(crate) local: Vector3<f64>,
}

impl Parts {
    #[inline(always)]
    pub(crate) fn of(x: impl Fn(usize) -> f64) -> Self {
        let vector = |i| Vector3::new(x(i), x(i + 1), x(i + 2));
        Self {
            field: vector(FIELD),
            offset: vector(OFFSET),
            iron: Matrix3::from(ELEMENT.map(|column| column.map(|i| x(IRON + i)))),
            bias: vector(BIAS),
            delay: x(DELAY),
            scale: Matrix3::from_columns(&[vector(SCALE), vector(SCALE + 3), vector(SCALE + 6)]),
            local: vector(LOCAL),
        }
    }

    /// M of a state.
    pub(crate) fn soft_iron(&self) -> Matrix3<f64> {
        Matrix3::identity() + self.iron
    }

    /// W = M^-1, and c of a raw sample at its own time: W (raw - b). `None` while M has no inverse.
    pub(crate) fn corrected(&self, raw_ut: &Vector3<f64>) -> Option<(Matrix3<f64>, Vector3<f64>)> {
        let w = self.soft_iron().try_inverse()?;
        Some((w, w * (raw_ut - self.offset)))
    }

    /// How the device turned in `dt_s` in which the gyroscope's readings add up to `increment`: (I - S) increment - g dt.
    pub(crate) fn turned(&self, increment: &Vector3<f64>, dt_s: f64) -> Vector3<f64> {
        increment - self.scale * increment - self.bias * dt_s
    }

    /// The device's rate for a gyroscope's reading.
    pub(crate) fn true_rate(&self, reading: &Vector3<f64>) -> Vector3<f64> {
        self.turned(reading, 1.0)
    }
}

/// The covariance of N states with R numbers that are linear in the state; `p` has the rows of P of those states.
#[inline(always)]
pub(crate) fn covariance<const N: usize, const R: usize>(
    p: &SMatrix<f64, N, STATES>,
    linear: impl Fn(&Parts) -> SVector<f64, R>,
) -> SMatrix<f64, N, R> {
    let mut to = SMatrix::<f64, N, R>::zeros();
    for k in 0..N {
        to.row_mut(k).tr_copy_from(&linear(&Parts::of(|i| p[(k, i)])));
    }
    to
}
