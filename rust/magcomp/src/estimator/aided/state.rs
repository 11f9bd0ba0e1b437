//! The state and its covariance: x = [m, b, e, g, d, tau, s], 22 numbers, P symmetric.
//!
//! ```text
//! m    field of the place in the device frame at the gyroscope's time, uT
//! b    hard iron, uT
//! e    soft iron M = I + E, e = (E_xx, E_yy, E_zz, E_xy, E_xz, E_yz), trace E = 0
//! g    gyroscope bias, rad/s
//! d    local deviation of the field (rooms are not uniform), device frame, uT
//! tau  how late the magnetometer is against the gyroscope, s
//! s    scale error of the gyroscope, per axis: true rate = (1 - s) reading - g
//! ```
//!
//! The gauge: raw = M h + b leaves the scale between M and |h| free, so E is held traceless: every variance given to e
//! (prior, process noise, step) has the pattern T, in which the trace has variance zero. Without it |m| walks away.
//! Stored as the packed lower triangle (253 numbers), worked on as a dense matrix on the stack.
//! Source: docs/METHOD.md.

// index arithmetic is the mathematics here
#![allow(clippy::needless_range_loop)]

use crate::sound::{checked, is_covariance};
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// Length of the state.
pub(crate) const STATES: usize = 22;
/// Numbers in the packed lower triangle of the covariance.
const PACKED: usize = STATES * (STATES + 1) / 2;
/// The states that a hypothesis keeps: all before tau.
const SHORT: usize = DELAY;
const SHORT_PACKED: usize = SHORT * (SHORT + 1) / 2;
/// First index of m.
pub(crate) const FIELD: usize = 0;
/// First index of b.
pub(crate) const OFFSET: usize = 3;
/// First index of e.
pub(crate) const IRON: usize = 6;
/// First index of g.
pub(crate) const BIAS: usize = 12;
/// First index of d.
pub(crate) const LOCAL: usize = 15;
/// Index of tau.
pub(crate) const DELAY: usize = 18;
/// First index of s.
pub(crate) const SCALE: usize = 19;

/// Share of the soft iron's variance that is left to its trace: none would make P singular, much would untie the gauge.
const TRACE_SHARE: f64 = 1e-6;

/// The first N states and their covariance as they are kept between samples; K = N (N + 1) / 2.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub(crate) struct Kept<const N: usize, const K: usize> {
    pub(crate) mean: SVector<f64, N>,
    packed: SVector<f64, K>,
}

checked!(Kept<const N, const K>, |it| is_covariance(&SMatrix::<f64, N, N>::from_fn(|i, j| it.packed[packed_index(i, j)])));

/// Place of element (i, j) in the packed lower triangle.
pub(super) fn packed_index(i: usize, j: usize) -> usize {
    let (row, column) = if i >= j { (i, j) } else { (j, i) };
    row * (row + 1) / 2 + column
}

/// All states: the filter.
pub(crate) type Gaussian = Kept<STATES, PACKED>;
/// Without tau and s, which are not learned in the second or two that hypotheses run: the filter lends its own.
pub(crate) type Hypothesis = Kept<SHORT, SHORT_PACKED>;

/// State and covariance as they are worked on.
#[derive(Clone)]
pub(crate) struct Dense {
    pub(crate) x: [f64; STATES],
    pub(crate) p: [[f64; STATES]; STATES],
}

impl<const N: usize, const K: usize> Kept<N, K> {
    pub(crate) fn zero() -> Self {
        Self { mean: SVector::zeros(), packed: SVector::zeros() }
    }

    pub(crate) fn open(&self) -> Dense {
        let mut dense = Dense { x: [0.0; STATES], p: [[0.0; STATES]; STATES] };
        dense.x[..N].copy_from_slice(self.mean.as_slice());
        let mut rest = self.packed.as_slice();
        for i in 0..N {
            let (row, next) = rest.split_at(i + 1);
            dense.p[i][..row.len()].copy_from_slice(row);
            for (j, &value) in row.iter().enumerate() {
                dense.p[j][i] = value;
            }
            rest = next;
        }
        dense
    }

    /// Keeps `dense`, unless a number in it is not finite: then the former state stays and `false` is returned.
    pub(crate) fn keep(&mut self, dense: &Dense) -> bool {
        // no early end: the loop over a row is one of vectors
        let finite = |values: &[f64]| values.iter().fold(true, |all, v| all & v.is_finite());
        if !finite(&dense.x[..N]) || !(0..N).all(|i| finite(&dense.p[i][..i + 1])) {
            return false;
        }
        self.mean.as_mut_slice().copy_from_slice(&dense.x[..N]);
        let mut rest = self.packed.as_mut_slice();
        for i in 0..N {
            let (row, next) = rest.split_at_mut(i + 1);
            row.copy_from_slice(&dense.p[i][..i + 1]);
            rest = next;
        }
        true
    }
}

impl Gaussian {
    /// Covariance of states i and j.
    pub(crate) fn p(&self, i: usize, j: usize) -> f64 {
        self.packed[packed_index(i, j)]
    }

    /// The 3x3 block of the covariance whose first indices are given.
    pub(crate) fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        Matrix3::from_fn(|r, c| self.p(i + r, j + c))
    }

    /// The covariance of (b, e).
    pub(crate) fn calibration_block(&self) -> SMatrix<f64, 9, 9> {
        SMatrix::from_fn(|i, j| self.p(OFFSET + i, OFFSET + j))
    }

    pub(crate) fn vector(&self, i: usize) -> Vector3<f64> {
        Vector3::new(self.mean[i], self.mean[i + 1], self.mean[i + 2])
    }

    /// The device's rate for a gyroscope's reading: (1 - s) reading - g.
    pub(crate) fn true_rate(&self, reading: &Vector3<f64>) -> Vector3<f64> {
        reading - reading.component_mul(&self.vector(SCALE)) - self.vector(BIAS)
    }

    pub(crate) fn soft_iron(&self) -> Matrix3<f64> {
        soft_iron(self.mean.as_slice())
    }
}

impl Dense {
    pub(crate) fn vector(&self, i: usize) -> Vector3<f64> {
        Vector3::new(self.x[i], self.x[i + 1], self.x[i + 2])
    }

    pub(crate) fn set_vector(&mut self, i: usize, v: &Vector3<f64>) {
        self.x[i..i + 3].copy_from_slice(v.as_slice());
    }

    pub(crate) fn block(&self, i: usize, j: usize) -> Matrix3<f64> {
        Matrix3::from_fn(|r, c| self.p[i + r][j + c])
    }

    pub(crate) fn soft_iron(&self) -> Matrix3<f64> {
        soft_iron(&self.x)
    }

    /// The device's rate for a gyroscope's reading: (1 - s) reading - g.
    pub(crate) fn true_rate(&self, reading: &Vector3<f64>) -> Vector3<f64> {
        reading - reading.component_mul(&self.vector(SCALE)) - self.vector(BIAS)
    }

    /// tau and s as another filter has them, independent of all else here.
    pub(crate) fn lend(&mut self, other: &Gaussian) {
        for i in SHORT..STATES {
            self.x[i] = other.mean[i];
            for j in 0..STATES {
                let value = if j < SHORT { 0.0 } else { other.p(i, j) };
                self.p[i][j] = value;
                self.p[j][i] = value;
            }
        }
    }

    /// Adds variance to three states on the diagonal.
    pub(crate) fn add_variance(&mut self, i: usize, variance: f64) {
        for k in i..i + 3 {
            self.p[k][k] += variance;
        }
    }

    /// Adds a symmetric 3x3 block on the diagonal.
    pub(crate) fn add_block(&mut self, i: usize, block: &Matrix3<f64>) {
        for r in 0..3 {
            for c in 0..3 {
                self.p[i + r][i + c] += block[(r, c)];
            }
        }
    }

    /// Adds variance to the soft iron by the traceless pattern T.
    pub(crate) fn add_iron_variance(&mut self, variance: f64) {
        for r in 0..3 {
            for c in 0..3 {
                self.p[IRON + r][IRON + c] +=
                    if r == c { variance * (2.0 / 3.0 + TRACE_SHARE) } else { -variance / 3.0 };
            }
            self.p[IRON + 3 + r][IRON + 3 + r] += 0.5 * variance;
        }
    }

    /// Sets the covariances between states `range` and all others to zero, and their own block to `variance` I.
    pub(crate) fn isolate(&mut self, i: usize, variance: f64) {
        for k in i..i + 3 {
            for j in 0..STATES {
                self.p[k][j] = 0.0;
                self.p[j][k] = 0.0;
            }
            self.p[k][k] = variance;
        }
    }
}

fn soft_iron(x: &[f64]) -> Matrix3<f64> {
    let e = &x[IRON..IRON + 6];
    Matrix3::new(1.0 + e[0], e[3], e[4], e[3], 1.0 + e[1], e[5], e[4], e[5], 1.0 + e[2])
}

/// The matrix [a]x for which [a]x v = a x v.
pub(crate) fn cross(a: &Vector3<f64>) -> Matrix3<f64> {
    Matrix3::new(0.0, -a.z, a.y, a.z, 0.0, -a.x, -a.y, a.x, 0.0)
}

/// D e = E h: the 3x6 matrix that makes M h linear in e.
pub(crate) fn iron_rows(h: &Vector3<f64>) -> [[f64; 6]; 3] {
    [[h.x, 0.0, 0.0, h.y, h.z, 0.0], [0.0, h.y, 0.0, h.x, 0.0, h.z], [0.0, 0.0, h.z, 0.0, h.x, h.y]]
}
