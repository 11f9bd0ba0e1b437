//! Without a usable gyroscope: the constant magnitude F = |W (raw - b)|, W = M^-1, and the constant vertical part
//! v = u . W (raw - b) against gravity's direction u (the dip, since F is constant too).
//!
//! Start: least squares sphere (Kasa) over the first samples: |raw|^2 = 2 b . raw + (F^2 - |b|^2), from moments.
//! Then an extended Kalman filter on (b, e, v, F), two scalar measurements a sample:
//! ```text
//! z = F - |h|,        h = W (raw - b),  n = h / |h|,   d|h|/db = -W^T n,    d|h|/de = -(W^T n)^T D(h)
//! z = v - u . h,                                      d(u.h)/db = -W^T u,  d(u.h)/de = -(W^T u)^T D(h)
//! S = gradient P gradient^T + sigma^2 |W^T n|^2 + (tr P_bb,across / F)^2 / 2,   gate 16
//! S of the second: sigma^2 |W^T u|^2 + k |h across u|^2 (s_u^2 + (|a| / G - 1)^2), the tilt that a hand's acceleration feigns
//! ```
//! A share of gated samples above 0.25 is suspect, until b is settled again; one above 0.45 is a step: P_bb += 25^2,
//! P_ee += T 0.08^2; v and F hold. E is traceless, so F has a value. The dip is only used once b is settled and never gates: it makes b
//! surer where the directions are few. It needs diverse directions to start; with hand motion and no gyroscope the
//! ellipsoid methods are better. Source: docs/METHOD.md.

// index arithmetic is the mathematics here
#![allow(clippy::needless_range_loop)]

use crate::snapshot::{checked, is_covariance};
use nalgebra::{Matrix3, Matrix4, SMatrix, SVector, Vector3, Vector4};
use serde::{Deserialize, Serialize};

use super::state::{iron_rows, packed_index as index};

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
/// Error of gravity's direction in a quiet hand, rad.
pub(crate) const TILT_SD: f64 = 0.02;
/// Samples over which a hand's acceleration stays the same: its error is no white noise.
pub(crate) const TILT_CORRELATION: f64 = 20.0;
/// The vertical part is not known at the start, uT.
const VERTICAL_SD_UT: f64 = 100.0;
/// A sphere through what is an ellipsoid has a radius this wrong, uT.
const STRENGTH_SD_UT: f64 = 2.0;
/// States: b, e, v, F.
const STATES: usize = 11;
const VERTICAL: usize = 9;
const STRENGTH: usize = 10;
const PACKED: usize = STATES * (STATES + 1) / 2;

/// Hard and soft iron from the magnitude alone.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(crate) struct Magnitude {
    samples: u32,
    /// Sums of x x^T (xx yy zz xy xz yz), x |x|^2 and x of raw less the first raw.
    xx: SVector<f64, 6>,
    xq: Vector3<f64>,
    x: Vector3<f64>,
    pub(crate) started: bool,
    /// b; before the start the first raw.
    pub(crate) offset_ut: Vector3<f64>,
    pub(super) iron: SVector<f64, 6>,
    pub(crate) strength_ut: f64,
    /// v, uT.
    vertical_ut: f64,
    /// Covariance of (b, e, v, F), packed lower triangle.
    packed: SVector<f64, PACKED>,
    share: f64,
    /// Since when much does not fit.
    pub(crate) since_ns: Option<i64>,
}

checked!(Magnitude, |it| {
    it.samples <= 20 * START_SAMPLES
        && (0.0..=1.0).contains(&it.share)
        && is_covariance(&SMatrix::<f64, STATES, STATES>::from_fn(|i, j| it.packed[index(i, j)]))
});

impl Magnitude {
    pub(crate) fn new() -> Self {
        Self {
            samples: 0,
            xx: SVector::zeros(),
            xq: Vector3::zeros(),
            x: Vector3::zeros(),
            started: false,
            offset_ut: Vector3::zeros(),
            iron: SVector::zeros(),
            strength_ut: 0.0,
            vertical_ut: 0.0,
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

    /// Covariance of (b, e) with F, and the variance of F.
    pub(crate) fn strength_covariance(&self) -> (SVector<f64, 9>, f64) {
        (SVector::from_fn(|i, _| self.packed[index(i, STRENGTH)]), self.packed[index(STRENGTH, STRENGTH)])
    }

    /// tr P_bb, uT^2.
    pub(crate) fn offset_variance_ut2(&self) -> f64 {
        (0..3).map(|i| self.packed[index(i, i)]).sum()
    }

    /// One sample, and what the accelerometer says with it in units of gravity.
    pub(crate) fn push(&mut self, time_ns: i64, raw_ut: &Vector3<f64>, up_g: Option<&Vector3<f64>>, sigma_ut: f64) {
        if self.started {
            self.track(raw_ut, sigma_ut);
            if let Some(up_g) = up_g.filter(|_| self.since_ns.is_none() && self.offset_variance_ut2() < SETTLED_UT2) {
                self.level(raw_ut, up_g, sigma_ut);
            }
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
            self.offset_ut = *raw_ut;
        }
        let x = raw_ut - self.offset_ut;
        let q = x.norm_squared();
        self.xx += SVector::from([x.x * x.x, x.y * x.y, x.z * x.z, x.x * x.y, x.x * x.z, x.y * x.z]);
        self.xq += x * q;
        self.x += x;
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
        let s = &self.xx;
        let xx = Matrix3::new(s[0], s[3], s[4], s[3], s[1], s[5], s[4], s[5], s[2]);
        let mut normal = Matrix4::zeros();
        normal.fixed_view_mut::<3, 3>(0, 0).copy_from(&(xx * 4.0));
        normal.fixed_view_mut::<3, 1>(0, 3).copy_from(&(self.x * 2.0));
        normal.fixed_view_mut::<1, 3>(3, 0).copy_from(&(self.x.transpose() * 2.0));
        normal[(3, 3)] = n;
        let right = Vector4::new(2.0 * self.xq.x, 2.0 * self.xq.y, 2.0 * self.xq.z, xx.trace());
        let scatter = xx / n - self.x * self.x.transpose() / (n * n);
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
        self.offset_ut += centre;
        self.strength_ut = strength_ut;
        self.iron = SVector::zeros();
        self.packed = SVector::zeros();
        self.widen(5.0, 0.06);
        self.vertical_ut = 0.0;
        self.packed[index(VERTICAL, VERTICAL)] = VERTICAL_SD_UT * VERTICAL_SD_UT;
        self.packed[index(STRENGTH, STRENGTH)] = STRENGTH_SD_UT * STRENGTH_SD_UT;
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
        // of the size F, not |h|: noise along h, which is in z too, would pull E at every sample
        let mut gradient = self.gradient(&wn, &(h * (self.strength_ut / size)));
        gradient[STRENGTH] = -1.0;
        self.widen(OFFSET_WALK_UT, IRON_WALK);
        let across: f64 = self.offset_variance_ut2() * (2.0 / 3.0);
        let variance = sigma_ut * sigma_ut * wn.norm_squared() + 0.5 * (across / self.strength_ut).powi(2);
        let (pg, s) = self.foretold(&gradient, variance);
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
        self.correct(&pg, z, s);
    }

    /// The vertical part is constant.
    fn level(&mut self, raw_ut: &Vector3<f64>, up_g: &Vector3<f64>, sigma_ut: f64) {
        let Some(w) = self.soft_iron().try_inverse() else { return };
        let (h, size_g) = (w * (raw_ut - self.offset_ut), up_g.norm());
        if !(size_g > 0.1 && size_g.is_finite()) {
            return;
        }
        let up = up_g / size_g;
        let wu = w.transpose() * up;
        let mut gradient = self.gradient(&wu, &h);
        gradient[VERTICAL] = -1.0;
        let tilt = TILT_SD.powi(2) + (size_g - 1.0).powi(2);
        let across_ut2 = (h - up * up.dot(&h)).norm_squared() + self.strength_ut.powi(2) * 0.01;
        let variance = sigma_ut * sigma_ut * wu.norm_squared() + TILT_CORRELATION * across_ut2 * tilt;
        let (pg, s) = self.foretold(&gradient, variance);
        let z = self.vertical_ut - up.dot(&h);
        if z * z <= GATE * s {
            self.correct(&pg, z, s);
        }
    }

    /// Gradient of y . h to the states, for `wy` = W^T y and a y that does not change.
    pub(super) fn gradient(&self, wy: &Vector3<f64>, h: &Vector3<f64>) -> SVector<f64, STATES> {
        let rows = iron_rows(h);
        let mut gradient = SVector::zeros();
        for i in 0..3 {
            gradient[i] = -wy[i];
            for k in 0..6 {
                gradient[3 + k] -= wy[i] * rows[i][k];
            }
        }
        gradient
    }

    /// P g and g^T P g + variance.
    fn foretold(&self, gradient: &SVector<f64, STATES>, variance: f64) -> (SVector<f64, STATES>, f64) {
        let p = SMatrix::<f64, STATES, STATES>::from_fn(|i, j| self.packed[index(i, j)]);
        let pg = p * gradient;
        (pg, gradient.dot(&pg) + variance)
    }

    /// x += P g z / S,  P -= P g (P g)^T / S
    fn correct(&mut self, pg: &SVector<f64, STATES>, z: f64, s: f64) {
        let dx = pg * (z / s);
        let mut packed = self.packed;
        for i in 0..STATES {
            for j in 0..=i {
                packed[index(i, j)] -= pg[i] * pg[j] / s;
            }
        }
        if !dx.iter().chain(packed.iter()).all(|v| v.is_finite()) {
            *self = Self::new();
            return;
        }
        self.offset_ut += dx.fixed_rows::<3>(0);
        self.iron += dx.fixed_rows::<6>(3);
        self.vertical_ut += dx[VERTICAL];
        self.strength_ut += dx[STRENGTH];
        self.packed = packed;
    }
}
