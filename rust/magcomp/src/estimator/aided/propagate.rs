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
//! Only the rows and columns of m and d change in F P F^T. Source: docs/dev/METHOD-AIDED.md.

use crate::math::elementary::exp;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3, Vector6};

use super::state::{BIAS, FIELD, Filter, HARD_IRON, LOCAL, Parts, STATES};
use crate::math::turn::Turn;

/// Data sheet: q_g, angle random walk of a gyroscope, rad/s^0.5: 1e-4 to 3e-4.
pub(super) const ANGLE_WALK_RAD: f64 = 3e-4;
/// Choice: q_w, random walk of its bias as it warms, rad/s^1.5.
const BIAS_WALK_RAD_S: f64 = 5e-5;

/// Mathematics: smaller numbers are as good as none, and below 1e-307 a processor takes a hundred times as long for each.
const FADED: f64 = 1e-200;

/// A number that fades, or nothing.
fn faded(number: f64) -> f64 {
    if number.abs() < FADED { 0.0 } else { number }
}

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

/// F dx, of m and d: dm'/dm, dd'/dd, and what both lose with what is added to the turn.
#[inline(always)]
fn changed(f: [Matrix3<f64>; 4], dx: &Parts, added: &Vector3<f64>) -> Vector6<f64> {
    let [m_by_m, d_by_d, m_by_turn, d_by_turn] = f;
    let m = m_by_m * dx.field - m_by_turn * added;
    // what d has in common with others fades, and ends before it costs more than a number
    let d = (d_by_d * dx.local - d_by_turn * added).map(faded);
    Vector6::new(m.x, m.y, m.z, d.x, d.y, d.z)
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
        let turn = Turn::by(&-x.turned(increment_rad, dt_s));
        self.turn(&turn.rotation, exp(-dt_s / noise.local_time_s));
        self.spread(&turn, increment_rad, dt_s, noise);
    }

    /// m and d turn, d fades; what is known of them stays behind until `spread`.
    pub(super) fn turn(&mut self, rotation: &Matrix3<f64>, fade: f64) {
        let x = self.parts();
        self.set_part(FIELD, &(rotation * x.field));
        self.set_part(LOCAL, &(rotation * x.local * fade).map(faded));
    }

    /// What is known follows m and d, which have turned.
    pub(super) fn spread(&mut self, turn: &Turn, increment_rad: &Vector3<f64>, dt_s: f64, noise: &ProcessNoise) {
        let fade = exp(-dt_s / noise.local_time_s);
        self.carry_covariance(turn, fade, |dx| dx.axes * increment_rad + dx.bias * dt_s);
        let local_ut2 = noise.local_ut.powi(2) * (1.0 - fade * fade);
        self.widen(noise.turn_rad2(dt_s), noise.offset_ut.powi(2) * dt_s, local_ut2, dt_s);
    }

    /// P of m and d that turned and faded so. `added` is what an error dx of the gyroscope adds to the vector of the turn, rad.
    #[inline(always)]
    pub(super) fn carry_covariance(&mut self, turn: &Turn, fade: f64, added: impl Fn(&Parts) -> Vector3<f64>) {
        let (m_by_m, d_by_d) = (turn.rotation, turn.rotation * fade);
        let Parts { field: m, local: d, .. } = self.parts();
        let (m_by_turn, d_by_turn) = (m.cross_matrix() * turn.left_jacobian, d.cross_matrix() * turn.left_jacobian);
        let times = |dx: Parts| changed([m_by_m, d_by_d, m_by_turn, d_by_turn], &dx, &added(&dx));
        let p = &mut self.covariance;
        let places = || FIELD.range().chain(LOCAL.range());
        // P F^T: in each row the numbers of m and d
        for k in 0..STATES {
            let row = times(Parts::of(|i| p[(k, i)]));
            places().zip(&row).for_each(|(i, value)| p[(k, i)] = *value);
        }
        // F (P F^T): the rows of m and d, which but for their own columns are the columns mirrored; so is m with d
        for k in FIELD.range() {
            let column = times(Parts::of(|i| p[(i, k)]));
            FIELD.range().zip(&column).for_each(|(i, value)| p[(i, k)] = *value);
        }
        for k in LOCAL.range() {
            let column = times(Parts::of(|i| p[(i, k)]));
            places().zip(&column).for_each(|(i, value)| p[(i, k)] = *value);
        }
        for i in places().rev() {
            (0..STATES).for_each(|k| p[(i, k)] = p[(k, i)]);
        }
    }

    /// Adds process noise: variances of the turn (rad^2), of b and of d (uT^2), each per axis, and what g does in so many seconds.
    pub(super) fn widen(&mut self, turn_rad2: f64, hard_iron_ut2: f64, local_ut2: f64, seconds: f64) {
        let m = self.part(FIELD);
        self.add(FIELD, &((Matrix3::identity() * m.norm_squared() - m * m.transpose()) * turn_rad2));
        self.add_variance(HARD_IRON, hard_iron_ut2);
        self.add_variance(BIAS, BIAS_WALK_RAD_S.powi(2) * seconds);
        self.add_variance(LOCAL, local_ut2);
    }
}
