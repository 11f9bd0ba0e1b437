//! How the device moves: turning, at rest, and where up is.
//!
//! ```text
//! rate += (dt / 0.5 s) (|w - g| - rate),   motion = min((rate / 0.3 rad/s)^2, 1)
//! up <- R up,   up += (dt / T) (a - up),   a: accelerometer / G, low-passed for a second and turned likewise
//! s += (dt / T_0) (accelerometer / G - up - s),   l += (dt / T_0) (s - l),   L = mean |s - l|^2 across up,   T_0 = 5 s
//! D^2 = s_g^2 + P_ss |net rate|^2,   N^2: variance a second of what the gyroscope did between its events
//! T = max(T_0, min(cbrt(L T_0 / (2 D^2)), sqrt(2 L T_0) / N)),   t^2 = L T_0 / T + D^2 T^2 + N^2 T / 2
//! C = t^2 p / (t^2 + p) / 2                what the errors of `up` and of m have in common, for a variance p of m's direction per axis
//! up <- up + (C / p) turn x up             when samples turn m
//! sigma_tilt^2 = t^2 / 2 + C + |l|^2 across up / 2
//! ```
//! Two sums of one noise of density q that leak over T_u and T_m have variances q T / 2 and the covariance q T_u T_m / (T_u + T_m). At the best T half of
//! t^2, and of p, is the gyroscope's, so that q T_u = t^2 and q T_m = p; half of that covariance is counted, as both have other parts. Where `up` follows m,
//! the gyroscope's half of t^2 falls to C, what two witnesses of one error know together.
//! Averaged over T, what lasts of the motion leaves L T_0 / T in `up`; the gyroscope tilts it by D T and N sqrt(T / 2) meanwhile. What lasts longer, l, is
//! an error of `up` or of the accelerometer: it says nothing of the motion, so it is not in L. Source: docs/dev/METHOD-AIDED.md.

use crate::math::elementary::{cbrt, gain};
use crate::priors::TILT_RAD;
use crate::sensing::tilt::GRAVITY_M_S2;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

use super::propagate::ANGLE_WALK_RAD;
use super::step::Known;
use super::tuning::Tuning;

/// Choice: share of gravity below which an accelerometer falls with the device, and shows no vertical.
const LEAST_PULL: f64 = 0.5;

/// Mathematics: least variance a second of a turn, rad^2/s: that of a gyroscope's own noise, so that none is divided by.
const LEAST_BRIDGED_RAD2_S: f64 = ANGLE_WALK_RAD * ANGLE_WALK_RAD;

/// Motion statistics.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Motion {
    rate_rad_s: f64,
    mean_rad_s: Vector3<f64>,
    scatter_rad2_s2: f64,
    /// Seconds at rest, 0 while moving.
    pub(crate) rest_s: f64,
    /// Low-passed rate over 5 s: how much has been turned of late, rad/s.
    pub(crate) lately_rad_s: f64,
    /// Low-passed rotation over 5 s, device frame: turns to and fro cancel, rad/s.
    net_rad_s: Vector3<f64>,
    pub(crate) up: Option<Vector3<f64>>,
    up_age_s: f64,
    /// t^2: variance of `up` about a horizontal axis for motion and gyroscope, before it follows m, rad^2.
    drawn_rad2: f64,
    /// The same for what lasts, rad^2.
    lasting_rad2: f64,
    /// a: the accelerometer, low-passed, in g.
    felt: Vector3<f64>,
    /// s: what the accelerometer reads beside gravity, low-passed, in g.
    slow: Vector3<f64>,
    /// l: that, low-passed again.
    lasting: Vector3<f64>,
    /// N^2, per axis, rad^2/s.
    bridged_rad2_s: f64,
    /// L, g^2.
    leaning: f64,
}

impl Motion {
    pub(crate) fn new() -> Self {
        Self {
            // from 0 the first motion would be taken for bias
            rate_rad_s: 1.0,
            scatter_rad2_s2: 1.0,
            ..Self::default()
        }
    }

    /// How much of the process noise and of the learning applies.
    pub(crate) fn amount(&self, tuning: &Tuning) -> f64 {
        (self.rate_rad_s / tuning.full_motion_rad_s).powi(2).min(1.0)
    }

    pub(crate) fn at_rest(&self) -> bool {
        self.rest_s > 0.0
    }

    /// One sample: `rate` as the gyroscope reads it.
    pub(crate) fn step(&mut self, rate: &Vector3<f64>, known: &Known, dt_s: f64, tuning: &Tuning) {
        let true_rate = rate - known.x.bias;
        let now = true_rate.norm();
        let (quick, slow) = (gain(dt_s, tuning.memory_s), gain(dt_s, tuning.settled_s));
        self.rate_rad_s += quick * (now - self.rate_rad_s);
        self.lately_rad_s += slow * (now - self.lately_rad_s);
        self.net_rad_s += (true_rate - self.net_rad_s) * slow;
        self.mean_rad_s += (rate - self.mean_rad_s) * quick;
        self.scatter_rad2_s2 += quick * ((rate - self.mean_rad_s).norm_squared() - self.scatter_rad2_s2);
        let still = self.rate_rad_s < tuning.bias_sd_rad_s && now < 2.0 * tuning.bias_sd_rad_s;
        // a small rate that scatters less than a hand does may be bias
        let slowest_rad_s = tuning.unknown_bias_rad_s();
        let steady = known.bias_sd_rad_s > slowest_rad_s
            && self.mean_rad_s.norm() < 3.0 * tuning.bias_sd_rad_s
            && self.scatter_rad2_s2.sqrt() < slowest_rad_s;
        self.rest_s = if still || steady { self.rest_s + dt_s } else { 0.0 };
    }

    /// Carries `up` by the rotation `r` and draws it to the accelerometer.
    pub(crate) fn carry_up(
        &mut self,
        r: &Matrix3<f64>,
        measured: Option<Vector3<f64>>,
        known: &Known,
        bridged_rad2: f64,
        dt_s: f64,
        tuning: &Tuning,
    ) {
        self.bridged_rad2_s += gain(dt_s, tuning.settled_s) * (bridged_rad2 / dt_s - self.bridged_rad2_s);
        self.felt = r * self.felt;
        self.slow = r * self.slow;
        self.lasting = r * self.lasting;
        self.up = self.up.map(|up| r * up);
        let Some(reads) = measured.map(|it| it / GRAVITY_M_S2).filter(|it| it.norm() >= LEAST_PULL) else { return };
        let Some(carried) = self.up else {
            self.up = Some(reads.normalize());
            return;
        };
        // at the start a plain mean
        self.up_age_s += dt_s;
        let share = |time_s: f64| gain(dt_s, time_s);
        self.felt += (reads - self.felt) * share(tuning.felt_s.min(self.up_age_s));
        let time_s = (TILT_RAD / known.bias_sd_rad_s).max(0.5).min(tuning.settled_s).min(self.up_age_s);
        let drift_rad2_s2 = known.bias_sd_rad_s.powi(2) + known.axes_sd.powi(2) * self.net_rad_s.norm_squared();
        let density = self.leaning * tuning.settled_s;
        let bridged_rad2_s = self.bridged_rad2_s.max(LEAST_BRIDGED_RAD2_S);
        let best_s = if tuning.long_up {
            cbrt(density / (2.0 * drift_rad2_s2)).min((2.0 * density / bridged_rad2_s).sqrt())
        } else {
            time_s
        };
        let up_time_s = best_s.max(time_s).min(self.up_age_s);
        let up = carried + (self.felt - carried) * share(up_time_s);
        self.slow += (reads - up - self.slow) * share(time_s);
        self.lasting += (self.slow - self.lasting) * share(time_s);
        let across = |v: &Vector3<f64>| (v.norm_squared() - v.dot(&up).powi(2)).max(0.0);
        self.leaning += share(time_s) * (across(&(self.slow - self.lasting)) - self.leaning);
        self.drawn_rad2 = density / up_time_s + 0.5 * bridged_rad2_s * up_time_s + drift_rad2_s2 * up_time_s.powi(2);
        self.lasting_rad2 = 0.5 * across(&self.lasting);
        self.up = up.try_normalize(1e-6);
    }

    /// Samples have turned the carried field, whose direction is known to `field_rad2` per axis, by `turn_rad`: `up` has a part of that error.
    pub(crate) fn follow(&mut self, turn_rad: &Vector3<f64>, field_rad2: f64, tuning: &Tuning) {
        let share = self.common_rad2(field_rad2, tuning) / field_rad2;
        self.up = self.up.and_then(|up| (up + turn_rad.cross(&up) * share).try_normalize(1e-6));
    }

    /// C, for a variance per axis of the carried field's direction, infinite where it is unknown, rad^2.
    pub(crate) fn common_rad2(&self, field_rad2: f64, tuning: &Tuning) -> f64 {
        if !tuning.follow || field_rad2 <= 0.0 {
            return 0.0;
        }
        tuning.common_share * self.drawn_rad2 / (1.0 + self.drawn_rad2 / field_rad2)
    }

    /// sigma_tilt^2, for C, rad^2.
    pub(crate) fn tilt_rad2(&self, common_rad2: f64, tuning: &Tuning) -> f64 {
        let share = if tuning.follow { tuning.common_share } else { 0.0 };
        self.drawn_rad2 * (1.0 - share) + common_rad2 + self.lasting_rad2
    }

    /// The gyroscope is gone: nothing is known about motion; `up` is the accelerometer's.
    pub(crate) fn without_rotation(&mut self, measured: Option<Vector3<f64>>) {
        let up = measured.filter(|m| m.norm() > 1.0).map(|m| m.normalize());
        *self = Self { up, ..Self::new() };
    }
}
