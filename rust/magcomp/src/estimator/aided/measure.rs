//! The measurement: a raw sample is the field as it was tau ago, through the device's own disturbance.
//!
//! ```text
//! h0 = m + d,   h = h0 + tau (w x h0),   raw = M h + b + n,   n ~ sigma^2 I,   w = (1 - s) gyroscope rate - g
//! dr/dm = dr/dd = M (I + tau [w]x),  dr/db = I,  dr/de = D(h),  dr/dg = tau M [h0]x,  dr/ds = dr/dg diag(rate),
//! dr/dtau = M (w x h0)
//! S = H P H^T + sigma^2 I + B
//! ```
//! B is the second-order term of the bilinear E h. The update is P <- P - V V^T with V = P H^T L^-T, S = L L^T: symmetric by
//! construction. A `Consider` update (Schmidt) corrects m and d only and leaves b, e, g, tau, s as they are, yet counts
//! their uncertainty. Source: docs/METHOD.md.

// index arithmetic is the mathematics here
#![allow(clippy::needless_range_loop)]

use nalgebra::{Matrix3, Vector3};

use super::state::{BIAS, DELAY, Dense, FIELD, IRON, LOCAL, OFFSET, SCALE, STATES, cross, iron_rows};

/// What a raw sample says about the state, before it is used.
#[derive(Clone, Copy)]
pub(crate) struct Innovation {
    /// raw minus what the state foretells, uT.
    pub(crate) v: Vector3<f64>,
    /// v^T S^-1 v.
    pub(crate) nis: f64,
    /// ln det S.
    pub(crate) ln_det: f64,
    /// tr S, uT^2.
    pub(crate) trace: f64,
    /// L^-1, lower triangle.
    l_inverse: Matrix3<f64>,
    /// H P, three rows.
    hp: [[f64; STATES]; 3],
}

/// Which states an update may correct.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(crate) enum Correct {
    /// All of them.
    All,
    /// m and d only: the calibration holds.
    FieldOnly,
}

/// h(x), uT.
pub(crate) fn foretell(x: &Dense, rate_rad_s: &Vector3<f64>) -> Vector3<f64> {
    let h0 = x.vector(FIELD) + x.vector(LOCAL);
    let w = x.true_rate(rate_rad_s);
    x.soft_iron() * (h0 + w.cross(&h0) * x.x[DELAY]) + x.vector(OFFSET)
}

/// dh/dx, three rows.
pub(crate) fn jacobian(x: &Dense, rate_rad_s: &Vector3<f64>) -> [[f64; STATES]; 3] {
    let h0 = x.vector(FIELD) + x.vector(LOCAL);
    let w = x.true_rate(rate_rad_s);
    let tau = x.x[DELAY];
    let wh = w.cross(&h0);
    let m = x.soft_iron();
    let to_field = m * (Matrix3::identity() + cross(&w) * tau);
    let to_bias = m * cross(&h0) * tau;
    let to_delay = m * wh;
    let to_iron = iron_rows(&(h0 + wh * tau));
    let mut rows = [[0.0; STATES]; 3];
    for (i, row) in rows.iter_mut().enumerate() {
        for k in 0..3 {
            row[FIELD + k] = to_field[(i, k)];
            row[LOCAL + k] = to_field[(i, k)];
            row[BIAS + k] = to_bias[(i, k)];
            row[SCALE + k] = to_bias[(i, k)] * rate_rad_s[k];
        }
        row[OFFSET + i] = 1.0;
        row[IRON..IRON + 6].copy_from_slice(&to_iron[i]);
        row[DELAY] = to_delay[i];
    }
    rows
}

/// Index of E_ij in e.
const ELEMENT: [[usize; 3]; 3] =
    [[IRON, IRON + 3, IRON + 4], [IRON + 3, IRON + 1, IRON + 5], [IRON + 4, IRON + 5, IRON + 2]];

impl Dense {
    /// B_i = sum_jl P(E_ij, E_il) (P_mm + P_dd)_jl + P(E_ij, m_l) P(m_j, E_il), not below zero.
    fn second_order(&self) -> Vector3<f64> {
        let field = self.block(FIELD, FIELD) + self.block(LOCAL, LOCAL);
        let mut b = Vector3::zeros();
        for i in 0..3 {
            let mut sum = 0.0;
            for j in 0..3 {
                for l in 0..3 {
                    let (ij, il) = (ELEMENT[i][j], ELEMENT[i][l]);
                    sum += (self.p[ij][il] * field[(j, l)] + self.p[ij][FIELD + l] * self.p[FIELD + j][il]).max(0.0);
                }
            }
            b[i] = sum;
        }
        b
    }

    /// The innovation of `raw_ut` with white noise `sigma_ut` per axis; `None` when S has no Cholesky factor.
    pub(crate) fn innovation(
        &self,
        raw_ut: &Vector3<f64>,
        rate_rad_s: &Vector3<f64>,
        sigma_ut: f64,
    ) -> Option<Innovation> {
        let h = jacobian(self, rate_rad_s);
        let mut hp = [[0.0; STATES]; 3];
        for r in 0..3 {
            for (k, &weight) in h[r].iter().enumerate() {
                if weight != 0.0 {
                    for c in 0..STATES {
                        hp[r][c] += weight * self.p[k][c];
                    }
                }
            }
        }
        let mut s = Matrix3::from_diagonal(&(self.second_order().add_scalar(sigma_ut * sigma_ut)));
        for r in 0..3 {
            for c in 0..=r {
                let mut sum = 0.0;
                for k in 0..STATES {
                    sum += hp[r][k] * h[c][k];
                }
                s[(r, c)] += sum;
                if c < r {
                    s[(c, r)] += sum;
                }
            }
        }
        let l = s.cholesky()?.unpack();
        let l_inverse = l.solve_lower_triangular(&Matrix3::identity())?;
        let v = raw_ut - foretell(self, rate_rad_s);
        let nis = (l_inverse * v).norm_squared();
        let ln_det = 2.0 * (l.m11 * l.m22 * l.m33).ln();
        (nis.is_finite() && ln_det.is_finite()).then_some(Innovation {
            v,
            nis,
            ln_det,
            trace: s.trace(),
            l_inverse,
            hp,
        })
    }

    /// Corrects the state by an innovation found from this very state.
    pub(crate) fn update(&mut self, innovation: &Innovation, correct: Correct) {
        let z = innovation.l_inverse * innovation.v;
        let mut v = [[0.0; STATES]; 3];
        for r in 0..3 {
            for k in 0..=r {
                let weight = innovation.l_inverse[(r, k)];
                for c in 0..STATES {
                    v[r][c] += weight * innovation.hp[k][c];
                }
            }
        }
        let corrected = |i: usize| correct == Correct::All || i < OFFSET || (LOCAL..DELAY).contains(&i);
        for i in 0..STATES {
            let (a, b, c) = (v[0][i], v[1][i], v[2][i]);
            if corrected(i) {
                self.x[i] += a * z[0] + b * z[1] + c * z[2];
                for j in 0..STATES {
                    self.p[i][j] -= a * v[0][j] + b * v[1][j] + c * v[2][j];
                }
            } else {
                for j in (0..OFFSET).chain(LOCAL..DELAY) {
                    self.p[i][j] -= a * v[0][j] + b * v[1][j] + c * v[2][j];
                }
            }
        }
        self.settle();
    }

    /// The scalar measurement |m| = `strength_ut` with the given variance, m and its companions corrected.
    pub(crate) fn update_strength(&mut self, strength_ut: f64, variance: f64) {
        let m = self.vector(FIELD);
        let size = m.norm();
        if size < 1e-6 {
            return;
        }
        let u = m / size;
        let mut hp = [0.0; STATES];
        for (c, sum) in hp.iter_mut().enumerate() {
            *sum = u.x * self.p[FIELD][c] + u.y * self.p[FIELD + 1][c] + u.z * self.p[FIELD + 2][c];
        }
        let along = u.x * hp[FIELD] + u.y * hp[FIELD + 1] + u.z * hp[FIELD + 2];
        // what the curvature of |m| hides: half the variance across, over |m|
        let across = (self.p[0][0] + self.p[1][1] + self.p[2][2] - along).max(0.0) / size;
        let s = along + variance + 0.5 * across * across;
        let gain = (strength_ut - size) / s;
        for i in 0..STATES {
            self.x[i] += hp[i] * gain;
            for j in 0..STATES {
                self.p[i][j] -= hp[i] * hp[j] / s;
            }
        }
        self.settle();
    }

    /// The measurement g = rate (at rest), with `variance` per axis; b, e, tau and s hold (Schmidt).
    pub(crate) fn update_bias(&mut self, rate_rad_s: &Vector3<f64>, variance: f64) {
        let held = |i: usize| (OFFSET..BIAS).contains(&i) || i >= DELAY;
        for k in 0..3 {
            let column: [f64; STATES] = self.p[BIAS + k];
            let s = column[BIAS + k] + variance;
            let gain = (rate_rad_s[k] - self.x[BIAS + k]) / s;
            for r in 0..STATES {
                if !held(r) {
                    self.x[r] += column[r] * gain;
                }
                for c in 0..STATES {
                    if !(held(r) && held(c)) {
                        self.p[r][c] -= column[r] * column[c] / s;
                    }
                }
            }
        }
        self.settle();
    }

    /// No variance below what rounding can carry: keeps P positive definite for ever.
    fn settle(&mut self) {
        const FLOOR: [f64; STATES] = [
            1e-8, 1e-8, 1e-8, 1e-8, 1e-8, 1e-8, 1e-12, 1e-12, 1e-12, 1e-12, 1e-12, 1e-12, 1e-14, 1e-14, 1e-14, 1e-8,
            1e-8, 1e-8, 1e-12, 1e-12, 1e-12, 1e-12,
        ];
        for i in 0..STATES {
            if self.p[i][i] < FLOOR[i] {
                self.p[i][i] = FLOOR[i];
            }
        }
    }
}
