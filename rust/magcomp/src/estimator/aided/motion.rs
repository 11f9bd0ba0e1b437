//! How the device moves: turning, at rest, and where up is.
//!
//! rate = low-pass of |w - g| (0.5 s, starting at 1 rad/s: starting at 0 would take the first motion for bias).
//! motion = min((rate / 0.3)^2, 1): how much of the process noise and of the learning applies.
//! Rest: rate < 0.06 rad/s and |w - g| < 0.12; while the bias is unknown also a rate that is small (bias could be it)
//! and does not scatter, as no hand holds. At rest the rate itself is the bias.
//! up: turned with the gyroscope, drawn to the accelerometer: u += (dt / T) (a - u), where a is what the
//! accelerometer reads in g, low-passed for a second and turned likewise. (The mean of samples that were limited one by one
//! is not gravity.) Carried so, what motion adds to
//! gravity is averaged as the world sees it, where it comes to nothing (a body that stays about where it is). Samples
//! near |a| = G are not better ones: in a turn they are those with a part across gravity. What of it lasts, as in a car that
//! brakes, shows in what is left when it has passed a low-pass of T_0 = 5 s:
//! ```text
//! s += (dt / T_0) (accelerometer / G - u - s),   L = mean |s - u (u . s)|^2 / 2
//! ```
//! Averaged over T it leaves L T_0 / T in u. Meanwhile the gyroscope tilts u by D T, where D has the uncertainty of its bias
//! and what its axes are off, times the rotation that does not cancel: D^2 = s_g^2 + P_ss |net rate|^2. Hence
//! ```text
//! T = max(5 s, cbrt(L T_0 / (2 D^2))),   sigma_tilt^2 = L T_0 / T + D^2 T^2
//! ```
//! Source: docs/METHOD-AIDED.md; the rule for large bias and sigma_tilt are new.

use crate::sensing::tilt::GRAVITY_M_S2;
use crate::sound::checked;
use nalgebra::{Matrix3, Vector3};

use super::step::Known;
use super::tuning::Tuning;

/// Longer than any T, s.
const OLDEST_S: f64 = 1000.0;

/// Motion statistics.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub(crate) struct Motion {
    pub(crate) rate_rad_s: f64,
    mean_rad_s: Vector3<f64>,
    scatter_rad2_s2: f64,
    /// Seconds at rest, 0 while moving.
    pub(crate) rest_s: f64,
    /// Low-passed rate over 5 s: how much has been turned of late, rad/s.
    pub(crate) lately_rad_s: f64,
    /// Low-passed rotation over 5 s, device frame: turns to and fro cancel, rad/s.
    net_rad_s: Vector3<f64>,
    pub(crate) up: Option<Vector3<f64>>,
    up_age_s: f32,
    /// T: the time over which `up` is drawn to the accelerometer, s.
    up_time_s: f64,
    /// Square of the rate at which the gyroscope may tilt `up`, (rad/s)^2.
    drift_rad2_s2: f64,
    /// a: the accelerometer, low-passed, in g.
    felt: Vector3<f32>,
    /// s: what the accelerometer reads beside gravity, low-passed, in g.
    slow: Vector3<f32>,
    /// Mean square of that across `up`, per axis, g^2.
    leaning: f32,
}

checked!(Motion, |it| {
    [it.rate_rad_s, it.scatter_rad2_s2, it.rest_s, it.lately_rad_s].iter().all(|v| *v >= 0.0)
        && it.up.is_none_or(|up| (up.norm() - 1.0).abs() < 1e-3)
        && it.up_age_s >= 0.0
        && it.leaning >= 0.0
        && it.up_time_s > 0.0
        && it.drift_rad2_s2 >= 0.0
});

impl Motion {
    pub(crate) fn new() -> Self {
        Self {
            rate_rad_s: 1.0,
            mean_rad_s: Vector3::zeros(),
            scatter_rad2_s2: 1.0,
            rest_s: 0.0,
            lately_rad_s: 0.0,
            net_rad_s: Vector3::zeros(),
            up: None,
            up_age_s: 0.0,
            up_time_s: 1.0,
            drift_rad2_s2: 0.0,
            felt: Vector3::zeros(),
            slow: Vector3::zeros(),
            leaning: 0.0,
        }
    }

    pub(crate) fn amount(&self, tuning: &Tuning) -> f64 {
        (self.rate_rad_s / tuning.full_motion_rad_s).powi(2).min(1.0)
    }

    /// Variance of `up` about a horizontal axis for what motion adds to gravity, rad^2.
    pub(crate) fn tilt_rad2(&self, tuning: &Tuning) -> f64 {
        f64::from(self.leaning) * tuning.settled_s / self.up_time_s + self.drift_rad2_s2 * self.up_time_s.powi(2)
    }

    pub(crate) fn at_rest(&self) -> bool {
        self.rest_s > 0.0
    }

    /// One sample: `rate` as the gyroscope reads it.
    pub(crate) fn step(&mut self, rate: &Vector3<f64>, known: &Known, dt_s: f64, tuning: &Tuning) {
        let (bias, bias_sd) = (known.x.bias, known.bias_sd_rad_s);
        let now = (rate - bias).norm();
        let gain = 1.0 - (-dt_s / tuning.memory_s).exp();
        self.rate_rad_s += gain * (now - self.rate_rad_s);
        let slow_gain = 1.0 - (-dt_s / tuning.settled_s).exp();
        self.lately_rad_s += slow_gain * (now - self.lately_rad_s);
        self.net_rad_s += (rate - bias - self.net_rad_s) * slow_gain;
        self.mean_rad_s += (rate - self.mean_rad_s) * gain;
        self.scatter_rad2_s2 += gain * ((rate - self.mean_rad_s).norm_squared() - self.scatter_rad2_s2);
        let still = self.rate_rad_s < tuning.rest_rate_rad_s && now < 2.0 * tuning.rest_rate_rad_s;
        let steady = bias_sd > tuning.unknown_bias_rad_s
            && self.mean_rad_s.norm() < 3.0 * tuning.bias_sd_rad_s
            && self.scatter_rad2_s2.sqrt() < tuning.unknown_bias_rad_s;
        self.rest_s = if still || steady { self.rest_s + dt_s } else { 0.0 };
    }

    /// Carries `up` by the rotation `r` and draws it to the accelerometer.
    pub(crate) fn carry_up(
        &mut self,
        r: &Matrix3<f64>,
        measured: Option<Vector3<f64>>,
        known: &Known,
        dt_s: f64,
        tuning: &Tuning,
    ) {
        if let Some(up) = &mut self.up {
            *up = r * *up;
            self.felt = (r * self.felt.cast()).cast();
            self.slow = (r * self.slow.cast()).cast();
        }
        let Some(measured) = measured else { return };
        let size = measured.norm();
        if size < 0.1 * GRAVITY_M_S2 {
            return;
        }
        match &mut self.up {
            None => {
                self.up = Some(measured / size);
                self.felt = (measured / size).cast();
                self.up_age_s = 0.0;
            }
            Some(up) => {
                let felt: Vector3<f64> = self.felt.cast();
                let time_s = tuning.local_time_s.min(f64::from(self.up_age_s) + dt_s);
                let felt = felt + (measured / GRAVITY_M_S2 - felt) * (dt_s / time_s).min(1.0);
                self.felt = felt.cast();
                let off = felt - *up;
                // at the start a plain mean
                self.up_age_s = (f64::from(self.up_age_s) + dt_s).min(OLDEST_S) as f32;
                let age_s = f64::from(self.up_age_s);
                // an unknown bias must not tilt up by more than about 0.03 rad
                let time_s = (0.03 / known.bias_sd_rad_s).max(0.5).min(tuning.settled_s).min(age_s);
                self.drift_rad2_s2 =
                    known.bias_sd_rad_s.powi(2) + known.scale_sd.powi(2) * self.net_rad_s.norm_squared();
                let best_s = (f64::from(self.leaning) * tuning.settled_s / (2.0 * self.drift_rad2_s2)).cbrt();
                self.up_time_s = best_s.max(time_s).min(age_s);
                *up += off * (dt_s / self.up_time_s).min(1.0);
                let gain = (dt_s / time_s).min(1.0);
                let slow: Vector3<f64> = self.slow.cast();
                let slow = slow + (measured / GRAVITY_M_S2 - *up - slow) * gain;
                self.slow = slow.cast();
                let across = (slow.norm_squared() - slow.dot(up).powi(2)).max(0.0) as f32;
                self.leaning += gain as f32 * (0.5 * across - self.leaning);
                let norm = up.norm();
                if norm > 1e-6 {
                    *up /= norm;
                } else {
                    self.up = None;
                }
            }
        }
    }

    /// The gyroscope is gone: nothing is known about motion; `up` is the accelerometer's.
    pub(crate) fn without_rotation(&mut self, measured: Option<Vector3<f64>>) {
        let up = measured.filter(|m| m.norm() > 1.0).map(|m| m.normalize());
        *self = Self { up, ..Self::new() };
    }
}
