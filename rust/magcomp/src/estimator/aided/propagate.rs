//! Propagation over dt: between two samples the field turns by the inverse of the device's own rotation.
//!
//! ```text
//! theta = (1 - s) (rotation increment of the gyroscope) - g dt,   R = exp(-[theta]x)   (Rodrigues)
//! m <- R m,   d <- a R d,  a = exp(-dt / tau_d),   b, e, g, tau, s constant
//! dm/dm = R,  dd/dd = a R,  dm/dg = -dt [m']x J,  dd/dg = -dt [d']x J,   d/ds = d/dg diag(increment) / dt
//! J = J_l(-theta), the left Jacobian of the rotation: exp([p + dp]x) = exp([J_l(p) dp]x) exp([p]x)
//! ```
//! Process noise:
//! ```text
//! m += ((q_g^2 + q_s^2 |w|^2) dt + v) (|m|^2 I - m m^T)     (gyroscope noise; q_s: scale error; v: bridged)
//! b += q_b^2 dt I,  g += q_w^2 dt I,  d += s_d^2 (1 - a^2) I,  e += q_e^2 dt T
//! ```
//! Only the rows of m and d change, so F P F^T costs two 6 x 22 products. Source: docs/METHOD.md; the Jacobian to g
//! through d and J are exact here (the prototype left them out).

// index arithmetic is the mathematics here
#![allow(clippy::needless_range_loop)]

use nalgebra::{Matrix3, Vector3};

use super::state::{BIAS, Dense, FIELD, LOCAL, OFFSET, SCALE, STATES, cross};

/// Process noise of one step; densities per square root of a second.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProcessNoise {
    pub(crate) angle_rad: f64,
    pub(crate) scale: f64,
    /// Variance (not density) of this step's increment per axis, for what the gyroscope did between its events, rad^2.
    pub(crate) bridged_rad2: f64,
    pub(crate) offset_ut: f64,
    pub(crate) iron: f64,
    pub(crate) bias_rad_s: f64,
    /// Standard deviation (not density) of the local field, uT.
    pub(crate) local_ut: f64,
    pub(crate) local_time_s: f64,
}

impl ProcessNoise {
    /// Variance per axis of a turn by `angle_rad` in `dt_s`, rad^2.
    fn turn_rad2(&self, angle_rad: f64, dt_s: f64) -> f64 {
        self.angle_rad.powi(2) * dt_s + self.scale.powi(2) * angle_rad.powi(2) / dt_s.max(1e-6) + self.bridged_rad2
    }

    /// Variance per axis across a field of `field_ut` that one step adds to m, uT^2.
    pub(crate) fn carried_ut2(&self, field_ut: f64, angle_rad: f64, dt_s: f64) -> f64 {
        field_ut * field_ut * self.turn_rad2(angle_rad, dt_s)
    }
}

/// exp(-[theta]x), and J_l(-theta).
pub(crate) fn turn(theta: &Vector3<f64>) -> (Matrix3<f64>, Matrix3<f64>) {
    let angle2 = theta.norm_squared();
    let angle = angle2.sqrt();
    let (s1, s2, s3) = if angle < 1e-4 {
        (1.0 - angle2 / 6.0, 0.5 - angle2 / 24.0, 1.0 / 6.0 - angle2 / 120.0)
    } else {
        let (sin, cos) = angle.sin_cos();
        (sin / angle, (1.0 - cos) / angle2, (angle - sin) / (angle2 * angle))
    };
    let k = cross(&-theta);
    let k2 = k * k;
    (Matrix3::identity() + k * s1 + k2 * s2, Matrix3::identity() + k * s2 + k2 * s3)
}

impl Dense {
    /// One step of `dt_s`; `increment_rad` is what the gyroscope says, its bias not removed. Returns R.
    pub(crate) fn propagate(&mut self, increment_rad: &Vector3<f64>, dt_s: f64, noise: &ProcessNoise) -> Matrix3<f64> {
        let theta = increment_rad - increment_rad.component_mul(&self.vector(SCALE)) - self.vector(BIAS) * dt_s;
        let (r, j) = turn(&theta);
        let fade = (-dt_s / noise.local_time_s).exp();
        let m = r * self.vector(FIELD);
        let d = r * self.vector(LOCAL) * fade;
        self.set_vector(FIELD, &m);
        self.set_vector(LOCAL, &d);

        let to_g = j * -dt_s;
        let m_g = cross(&m) * to_g;
        let d_g = cross(&d) * to_g;
        let to_s = -j * Matrix3::from_diagonal(increment_rad);
        let (m_s, d_s) = (rows(&(cross(&m) * to_s)), rows(&(cross(&d) * to_s)));
        let (m_g, d_g) = (rows(&m_g), rows(&d_g));
        let rm = rows(&r);
        let rd = rows(&(r * fade));
        // rows of m and d of F P
        let mut fp = [[0.0; STATES]; 6];
        for i in 0..3 {
            for c in 0..STATES {
                let mut sum_m = 0.0;
                let mut sum_d = 0.0;
                for k in 0..3 {
                    let (g, s) = (self.p[BIAS + k][c], self.p[SCALE + k][c]);
                    sum_m += rm[i][k] * self.p[FIELD + k][c] + m_g[i][k] * g + m_s[i][k] * s;
                    sum_d += rd[i][k] * self.p[LOCAL + k][c] + d_g[i][k] * g + d_s[i][k] * s;
                }
                fp[i][c] = sum_m;
                fp[3 + i][c] = sum_d;
            }
        }
        // the 6 x 6 block of (F P) F^T, then everything written to both sides of the diagonal
        const TURNING: [usize; 6] = [FIELD, FIELD + 1, FIELD + 2, LOCAL, LOCAL + 1, LOCAL + 2];
        for a in 0..6 {
            for c in 0..STATES {
                if !(FIELD..FIELD + 3).contains(&c) && !(LOCAL..LOCAL + 3).contains(&c) {
                    self.p[TURNING[a]][c] = fp[a][c];
                    self.p[c][TURNING[a]] = fp[a][c];
                }
            }
            for b in 0..=a {
                let (f, g, s, from) = if b < 3 {
                    (&rm[b], &m_g[b], &m_s[b], FIELD)
                } else {
                    (&rd[b - 3], &d_g[b - 3], &d_s[b - 3], LOCAL)
                };
                let mut sum = 0.0;
                for k in 0..3 {
                    sum += fp[a][from + k] * f[k] + fp[a][BIAS + k] * g[k] + fp[a][SCALE + k] * s[k];
                }
                self.p[TURNING[a]][TURNING[b]] = sum;
                self.p[TURNING[b]][TURNING[a]] = sum;
            }
        }

        let turn2 = noise.turn_rad2(theta.norm(), dt_s);
        let across = Matrix3::identity() * (m.norm_squared() * turn2);
        self.add_block(FIELD, &(across - m * m.transpose() * turn2));
        self.add_variance(OFFSET, noise.offset_ut.powi(2) * dt_s);
        self.add_iron_variance(noise.iron.powi(2) * dt_s);
        self.add_variance(BIAS, noise.bias_rad_s.powi(2) * dt_s);
        self.add_variance(LOCAL, noise.local_ut.powi(2) * (1.0 - fade * fade));
        r
    }
}

fn rows(m: &Matrix3<f64>) -> [[f64; 3]; 3] {
    [[m.m11, m.m12, m.m13], [m.m21, m.m22, m.m23], [m.m31, m.m32, m.m33]]
}
