//! Without a usable gyroscope: the constant magnitude alone, F = |W (raw - b)|, W = M^-1.
//!
//! Start: least squares sphere (Kasa) over the first samples: |raw|^2 = 2 b . raw + (F^2 - |b|^2), from moments.
//! Then an extended Kalman filter on (b, e):
//! ```text
//! z = |W (raw - b)| - F,   n = unit(W (raw - b)),   dz/db = -W n,   dz/de = -(W n)^T D(h)
//! S = gradient P gradient^T + sigma^2 |W n|^2 + (tr P_bb,across / F)^2 / 2,   gate 16
//! ```
//! A share of gated samples above 0.25 is suspect, until b is settled again; one above 0.45 is a step: P_bb += 25^2, P_ee += T 0.08^2. F is held, E is traceless.
//! It needs diverse directions; with hand motion and no gyroscope the ellipsoid methods are better. Source: docs/METHOD.md.md
//! section 6.

// index arithmetic is the mathematics here
#![allow(clippy::needless_range_loop)]

use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector3, Vector4};
use serde::{Deserialize, Serialize};

use super::state::iron_rows;

const START_SAMPLES: u32 = 80;
const GATE: f64 = 16.0;
const STEP_SHARE: f64 = 0.45;
const SHARE_GAIN: f64 = 0.08;
/// Share of gated samples from which the status is `Suspect`, the share and tr P_bb below which it is over.
const SUSPECT_SHARE: f64 = 0.25;
const CLEAR_SHARE: f64 = 0.1;
const SETTLED_UT2: f64 = 36.0;
const STEP_OFFSET_UT: f64 = 25.0;
const STEP_IRON: f64 = 0.08;
const OFFSET_WALK_UT: f64 = 0.03;
const IRON_WALK: f64 = 0.0001;
/// The smallest eigenvalue of the scatter of the directions that a sphere can be found from, times the largest.
const SMALLEST_SPREAD: f64 = 0.15;

/// Hard and soft iron from the magnitude alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Magnitude {
    samples: u32,
    origin_ut: Vector3<f64>,
    /// Sums of x x^T, x |x|^2, x, |x|^2 of raw - origin.
    xx: Matrix3<f64>,
    xq: Vector3<f64>,
    x: Vector3<f64>,
    q: f64,
    pub(crate) started: bool,
    pub(crate) offset_ut: Vector3<f64>,
    iron: SVector<f64, 6>,
    pub(crate) strength_ut: f64,
    /// Covariance of (b, e), packed lower triangle.
    packed: SVector<f64, 45>,
    share: f64,
    /// Since when much does not fit.
    pub(crate) since_ns: Option<i64>,
}

impl Magnitude {
    pub(crate) fn new() -> Self {
        Self {
            samples: 0,
            origin_ut: Vector3::zeros(),
            xx: Matrix3::zeros(),
            xq: Vector3::zeros(),
            x: Vector3::zeros(),
            q: 0.0,
            started: false,
            offset_ut: Vector3::zeros(),
            iron: SVector::zeros(),
            strength_ut: 0.0,
            packed: SVector::zeros(),
            share: 0.0,
            since_ns: None,
        }
    }

    pub(crate) fn soft_iron(&self) -> Matrix3<f64> {
        let e = &self.iron;
        Matrix3::new(1.0 + e[0], e[3], e[4], e[3], 1.0 + e[1], e[5], e[4], e[5], 1.0 + e[2])
    }

    /// Covariance of (b, e).
    pub(crate) fn covariance(&self) -> SMatrix<f64, 9, 9> {
        SMatrix::from_fn(|i, j| self.packed[index(i, j)])
    }

    /// tr P_bb, uT^2.
    pub(crate) fn offset_variance_ut2(&self) -> f64 {
        (0..3).map(|i| self.packed[index(i, i)]).sum()
    }

    fn keep(&mut self, p: &SMatrix<f64, 9, 9>) {
        for i in 0..9 {
            for j in 0..=i {
                self.packed[index(i, j)] = p[(i, j)];
            }
        }
    }

    pub(crate) fn push(&mut self, time_ns: i64, raw_ut: &Vector3<f64>, sigma_ut: f64) {
        if self.started {
            self.track(raw_ut, sigma_ut)
        } else {
            self.gather(raw_ut)
        }
        if self.share > SUSPECT_SHARE {
            self.since_ns.get_or_insert(time_ns);
        } else if self.share < CLEAR_SHARE && self.offset_variance_ut2() < SETTLED_UT2 {
            self.since_ns = None;
        }
    }

    fn gather(&mut self, raw_ut: &Vector3<f64>) {
        if self.samples == 0 {
            self.origin_ut = *raw_ut;
        }
        let x = raw_ut - self.origin_ut;
        let q = x.norm_squared();
        self.xx += x * x.transpose();
        self.xq += x * q;
        self.x += x;
        self.q += q;
        self.samples += 1;
        if self.samples >= START_SAMPLES && self.samples.is_multiple_of(10) {
            self.start();
        }
        if self.samples > 20 * START_SAMPLES {
            *self = Self::new(); // nothing came of it: look at newer samples
        }
    }

    fn start(&mut self) {
        let n = f64::from(self.samples);
        let mut normal = Matrix4::zeros();
        normal.fixed_view_mut::<3, 3>(0, 0).copy_from(&(self.xx * 4.0));
        normal.fixed_view_mut::<3, 1>(0, 3).copy_from(&(self.x * 2.0));
        normal.fixed_view_mut::<1, 3>(3, 0).copy_from(&(self.x.transpose() * 2.0));
        normal[(3, 3)] = n;
        let right = Vector4::new(2.0 * self.xq.x, 2.0 * self.xq.y, 2.0 * self.xq.z, self.q);
        let scatter = self.xx / n - self.x * self.x.transpose() / (n * n);
        let values = scatter.symmetric_eigenvalues();
        if values.min() < SMALLEST_SPREAD * values.max() {
            return;
        }
        let Some(solution) = normal.cholesky().map(|c| c.solve(&right)) else { return };
        let centre = Vector3::new(solution[0], solution[1], solution[2]);
        let strength_ut = (solution[3] + centre.norm_squared()).max(0.0).sqrt();
        if !(15.0..=100.0).contains(&strength_ut) {
            return;
        }
        self.offset_ut = self.origin_ut + centre;
        self.strength_ut = strength_ut;
        self.iron = SVector::zeros();
        self.packed = SVector::zeros();
        self.widen(5.0, 0.06);
        self.started = true;
        self.share = 0.0;
    }

    fn widen(&mut self, offset_ut: f64, iron: f64) {
        for i in 0..3 {
            self.packed[index(i, i)] += offset_ut * offset_ut;
            for j in 0..=i {
                self.packed[index(3 + i, 3 + j)] += iron * iron * if i == j { 2.0 / 3.0 } else { -1.0 / 3.0 };
            }
            // the trace is nearly, not wholly, held: 0.0003 at the start
            self.packed[index(3 + i, 3 + i)] += 2.5e-5 * iron * iron;
            self.packed[index(6 + i, 6 + i)] += 0.5 * iron * iron;
        }
    }

    fn track(&mut self, raw_ut: &Vector3<f64>, sigma_ut: f64) {
        let Some(w) = self.soft_iron().try_inverse() else { return };
        let h = w * (raw_ut - self.offset_ut);
        let size = h.norm();
        if size < 1.0 {
            return;
        }
        let wn = w.transpose() * (h / size);
        let rows = iron_rows(&h);
        let mut gradient = SVector::<f64, 9>::zeros();
        for i in 0..3 {
            gradient[i] = -wn[i];
            for k in 0..6 {
                gradient[3 + k] -= wn[i] * rows[i][k];
            }
        }
        self.widen(OFFSET_WALK_UT, IRON_WALK);
        let p = self.covariance();
        let pg = p * gradient;
        let across: f64 = self.offset_variance_ut2() * (2.0 / 3.0);
        let s = gradient.dot(&pg) + sigma_ut * sigma_ut * wn.norm_squared() + 0.5 * (across / self.strength_ut).powi(2);
        let z = self.strength_ut - size;
        let gated = z * z > GATE * s;
        self.share += SHARE_GAIN * (f64::from(gated) - self.share);
        if gated {
            if self.share > STEP_SHARE {
                self.widen(STEP_OFFSET_UT, STEP_IRON);
                self.share = 0.0;
            }
            return;
        }
        let dx = pg * (z / s);
        let p = p - pg * pg.transpose() / s;
        if !dx.iter().chain(p.iter()).all(|v| v.is_finite()) {
            *self = Self::new();
            return;
        }
        self.offset_ut += dx.fixed_rows::<3>(0);
        self.iron += dx.fixed_rows::<6>(3);
        self.keep(&p);
    }
}

/// Place of element (i, j) in the packed lower triangle.
fn index(i: usize, j: usize) -> usize {
    let (row, column) = if i >= j { (i, j) } else { (j, i) };
    row * (row + 1) / 2 + column
}
