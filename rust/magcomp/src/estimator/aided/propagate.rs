//! Propagation over dt: between two samples the field turns by the inverse of the device's own rotation.
//!
//! ```text
//! theta = (I - S) (rotation increment of the gyroscope) - g dt,   R = exp(-[theta]x)   (Rodrigues)
//! m <- R m,   d <- a R d,  a = exp(-dt / tau_d),   b, e, g, tau, s constant
//! dm/dm = R,  dd/dd = a R,  dm/dg = -dt [m']x J,  dd/dg = -dt [d']x J,   d/ds = d/dg (increment' (x) I) / dt
//! J = J_l(-theta), the left Jacobian of the rotation: exp([p + dp]x) = exp([J_l(p) dp]x) exp([p]x)
//! ```
//! Process noise:
//! ```text
//! m += (q_g^2 dt + v) (|m|^2 I - m m^T)     (gyroscope noise; v: bridged)
//! b += q_b^2 dt I,  g += q_w^2 dt I,  d += s_d^2 (1 - a^2) I
//! ```
//! Only the rows and columns of m and d change in F P F^T. Source: docs/METHOD-AIDED.md.

use nalgebra::{Matrix3, SMatrix, Vector3};

use super::state::{BIAS, FIELD, Gaussian, LOCAL, OFFSET, SCALE, STATES, scale_rows};

/// Process noise of one step; densities per square root of a second.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProcessNoise {
    pub(crate) angle_rad: f64,
    /// Variance (not density) of this step's increment per axis, for what the gyroscope did between its events, rad^2.
    pub(crate) bridged_rad2: f64,
    pub(crate) offset_ut: f64,
    pub(crate) bias_rad_s: f64,
    /// Standard deviation (not density) of the local field, uT.
    pub(crate) local_ut: f64,
    pub(crate) local_time_s: f64,
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
    let k = (-theta).cross_matrix();
    let k2 = k * k;
    (Matrix3::identity() + k * s1 + k2 * s2, Matrix3::identity() + k * s2 + k2 * s3)
}

impl Gaussian {
    /// One step of `dt_s`; `increment_rad` is what the gyroscope says, its bias not removed. Returns R.
    pub(crate) fn propagate(&mut self, increment_rad: &Vector3<f64>, dt_s: f64, noise: &ProcessNoise) -> Matrix3<f64> {
        let theta = increment_rad - self.scale() * increment_rad - self.vector(BIAS) * dt_s;
        let (r, j) = turn(&theta);
        let fade = (-dt_s / noise.local_time_s).exp();
        let m = r * self.vector(FIELD);
        let d = r * self.vector(LOCAL) * fade;
        self.set_vector(FIELD, &m);
        self.set_vector(LOCAL, &d);

        let by_bias = j * -dt_s;
        let by_scale = -j * scale_rows(increment_rad);
        let row =
            |turn: Matrix3<f64>, v: &Vector3<f64>| (turn, v.cross_matrix() * by_bias, v.cross_matrix() * by_scale);
        let turning = [(FIELD, row(r, &m)), (LOCAL, row(r * fade, &d))];
        // P F^T first, whose other columns are those of P; then F (P F^T). By columns, as they lie in memory
        let pf: [SMatrix<f64, STATES, 3>; 2] = turning.map(|(i, (f, g, s))| {
            let p = |k| self.p.fixed_columns::<3>(k);
            p(i) * f.transpose() + p(BIAS) * g.transpose() + self.p.fixed_columns::<9>(SCALE) * s.transpose()
        });
        for ((i, _), columns) in turning.iter().zip(&pf) {
            self.p.fixed_columns_mut::<3>(*i).copy_from(columns);
            self.p.fixed_rows_mut::<3>(*i).copy_from(&columns.transpose());
        }
        for ((i, _), columns) in turning.iter().zip(&pf) {
            for (k, (f, g, s)) in &turning {
                let p = |k| columns.fixed_rows::<3>(k);
                let block = f * p(*k) + g * p(BIAS) + s * columns.fixed_rows::<9>(SCALE);
                self.p.fixed_view_mut::<3, 3>(*k, *i).copy_from(&block);
                self.p.fixed_view_mut::<3, 3>(*i, *k).copy_from(&block.transpose());
            }
        }

        let turn2 = noise.angle_rad.powi(2) * dt_s + noise.bridged_rad2;
        self.add_block(FIELD, &((Matrix3::identity() * m.norm_squared() - m * m.transpose()) * turn2));
        self.add_variance(OFFSET, noise.offset_ut.powi(2) * dt_s);
        self.add_variance(BIAS, noise.bias_rad_s.powi(2) * dt_s);
        self.add_variance(LOCAL, noise.local_ut.powi(2) * (1.0 - fade * fade));
        r
    }
}
