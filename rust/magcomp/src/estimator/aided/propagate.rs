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
//! P_mm += (q_g^2 dt + v) (|m|^2 I - m m^T)     (gyroscope noise; v: bridged)
//! P_bb += q_b^2 dt I,  P_gg += q_w^2 dt I,  P_dd += s_d^2 (1 - a^2) I
//! ```
//! Only the rows and columns of m and d change in F P F^T. Source: docs/METHOD-AIDED.md.

use nalgebra::{Matrix3, Vector3, Vector6};

use super::state::{BIAS, FIELD, Filter, HARD_IRON, LOCAL, Parts, covariance};
use crate::math::turn::Turn;

/// q_g, angle random walk of a gyroscope, rad/s^0.5: data sheets have 1e-4 to 3e-4.
const ANGLE_WALK_RAD: f64 = 3e-4;
/// q_w, random walk of its bias as it warms, rad/s^1.5.
const BIAS_WALK_RAD_S: f64 = 5e-5;

/// Process noise of one step; densities per square root of a second.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ProcessNoise {
    /// Variance (not density) of this step's increment per axis, for what the gyroscope did between its events, rad^2.
    pub(crate) bridged_rad2: f64,
    pub(crate) offset_ut: f64,
    /// Standard deviation (not density) of the local field, uT.
    pub(crate) local_ut: f64,
    pub(crate) local_time_s: f64,
}

/// F's rows of m and d: dm'/dm, dd'/dd, and what both lose with theta.
struct Transition<'a> {
    m_by_m: Matrix3<f64>,
    d_by_d: Matrix3<f64>,
    m_by_theta: Matrix3<f64>,
    d_by_theta: Matrix3<f64>,
    increment_rad: &'a Vector3<f64>,
    dt_s: f64,
}

impl Transition<'_> {
    /// F dx, of m and d; `less` is what dx takes from theta.
    #[inline(always)]
    fn times(&self, dx: &Parts) -> Vector6<f64> {
        let less = dx.axes * self.increment_rad + dx.bias * self.dt_s;
        let m = self.m_by_m * dx.field - self.m_by_theta * less;
        let d = self.d_by_d * dx.local - self.d_by_theta * less;
        Vector6::new(m.x, m.y, m.z, d.x, d.y, d.z)
    }
}

impl ProcessNoise {
    /// Variance of a step's turn per axis, rad^2.
    pub(crate) fn turn_rad2(&self, dt_s: f64) -> f64 {
        ANGLE_WALK_RAD.powi(2) * dt_s + self.bridged_rad2
    }
}

impl Filter {
    /// One step of `dt_s`; `increment_rad` is what the gyroscope says, its bias not removed.
    pub(crate) fn propagate(&mut self, increment_rad: &Vector3<f64>, dt_s: f64, noise: &ProcessNoise) {
        let x = self.parts();
        let Turn { rotation: r, left_jacobian: j } = Turn::by(&-x.turned(increment_rad, dt_s));
        let fade = (-dt_s / noise.local_time_s).exp();
        let (m_by_m, d_by_d) = (r, r * fade);
        let (m, d) = (m_by_m * x.field, d_by_d * x.local);
        self.set_part(FIELD, &m);
        self.set_part(LOCAL, &d);

        let (m_by_theta, d_by_theta) = (m.cross_matrix() * j, d.cross_matrix() * j);
        let f = Transition { m_by_m, d_by_d, m_by_theta, d_by_theta, increment_rad, dt_s };
        // of P F^T and of F (P F^T) the columns of m and d
        let mut columns = covariance(&self.covariance, |dx| f.times(dx));
        let rows = covariance(&columns.transpose(), |dx| f.times(dx));
        columns.fixed_rows_mut::<3>(FIELD.start()).tr_copy_from(&rows.fixed_columns::<3>(0));
        columns.fixed_rows_mut::<3>(LOCAL.start()).tr_copy_from(&rows.fixed_columns::<3>(3));
        for (column, i) in columns.column_iter().zip(FIELD.range().chain(LOCAL.range())) {
            self.covariance.set_column(i, &column);
            self.covariance.row_mut(i).tr_copy_from(&column);
        }

        let turn2 = noise.turn_rad2(dt_s);
        self.add(FIELD, &((Matrix3::identity() * m.norm_squared() - m * m.transpose()) * turn2));
        self.add_variance(HARD_IRON, noise.offset_ut.powi(2) * dt_s);
        self.add_variance(BIAS, BIAS_WALK_RAD_S.powi(2) * dt_s);
        self.add_variance(LOCAL, noise.local_ut.powi(2) * (1.0 - fade * fade));
    }
}
