//! What the filter learns about its own noise while it runs.
//!
//! Magnetometer noise, from what one step of the chain does not explain (independent of the filter's covariance):
//! ```text
//! e_k = raw_k - b - M R M^-1 (raw_{k-1} - b),   sigma^2 += (dt / t_n) (min(|e|^2 / 6, 6 sigma^2) - sigma^2)
//! ```
//! A gyroscope that explains nothing: |e| beyond what any offset could do to a turn of |theta| (|e| > 17 uT and
//! |e| > 150 uT |theta|) in most samples.
//! Local field: s_d grows with (NIS/3 - 1), capped, per second of motion; and with what the innovations have in common
//! over 0.25 s beyond white noise (less than white: s_d is too large, the corrections go too far).
//! Random walk of b, from its own corrections D_k = sum db over T seconds: a true drift keeps their direction, noise and
//! an uneven field do not (after Myers and Tapley 1976, with the lagged product in place of the square):
//! ```text
//! seen = (D_k . D_{k-1} + max(0, tr P_bb,end - tr P_bb,start)) / (3 T),   q_b^2 += gain (seen - q_b^2),
//! ```
//! so that q_b falls while nothing drifts, rises with a drift, and stays when nothing is seen (P_bb grows by 3 q_b^2 T).
//! The share of the walk that was seen to happen, rho = mean (D_k . D_{k-1}) / mean (3 q_b^2 T - unseen), says how far P may
//! be believed: a filter that allows for a walk that does not happen errs by P / 2, one that happens by P (steady state:
//! dPi/dt = -2 K Pi + K^2 r + rho q^2 = 0 with K = q / sqrt(r), P = q sqrt(r)); after a step all of P is true.
//! Most of P_mm comes through b, e, g and s, whose walks and errors a good stream hardly has; what m would err were all
//! those known, A per axis, does happen (gyroscope noise against that of the samples, in even rotation):
//! ```text
//! A += |m|^2 (angle variance of the step)    A <- A v / (A + v),   v = sigma^2 + 2 s_d^2 tau_d / dt
//! P_f = share P_mm + (1 - share) A I,   share = (1 + 2 rho) / 4
//! ```
//! (the quarter is measured: the bound of one state in steady state is a half, but P starts from priors that are wide too).
//! Unevenness of the field, for the sigmas: rooms bend the field over distances that a hand covers in a second or more;
//! then c and f differ slowly, which white noise does not do:
//! ```text
//! s += (dt / t_s) (c - f - s),  U^2 = mean |s|^2 / 3 - sigma^2 dt / (2 t_s),   floor = gain U
//! ```
//! and what else c differs from f by, beyond white noise, is variance of c:
//! ```text
//! L^2 = (mean |c - f|^2 - tr (sigma^2 W W^T)) / 3 - U^2
//! ```
//! Source: docs/METHOD.md, but for the walk of b, which the prototype held at one value.

use crate::sound::checked;
use nalgebra::{Matrix3, Vector3};

use super::measure::Innovation;
use super::tuning::Tuning;

/// Variance of a field that is not known at all, uT^2.
const UNKNOWN_UT2: f64 = 1e4;

/// One step of the chain from sample to sample.
pub(crate) struct Increment {
    pub(crate) offset_ut: Vector3<f64>,
    pub(crate) soft_iron: Matrix3<f64>,
    /// R of `propagate`.
    pub(crate) turn: Matrix3<f64>,
    pub(crate) angle_rad: f64,
    pub(crate) dt_s: f64,
}

/// Noise levels, learned.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub(crate) struct Adaptation {
    variance_ut2: f64,
    pub(crate) local_ut: f64,
    pub(crate) offset_walk_ut: f64,
    walked_ut: Vector3<f64>,
    walked_before_ut: Vector3<f64>,
    walk_start_ut2: f64,
    walk_time_s: f64,
    /// Low-passed over windows, in units of q_b^2: the walk seen to happen, and the walk that could have been seen.
    walk_seen: f64,
    walk_given: f64,
    /// A: variance of m per axis were all else known, uT^2.
    carried_ut2: f64,
    previous_raw_ut: Option<Vector3<f64>>,
    slow_ut: Vector3<f64>,
    slow_innovation_ut: Vector3<f32>,
    slow_power_ut2: f64,
    /// Mean square of c - f per axis, uT^2.
    power_ut2: f64,
    slow_age_s: f64,
    useless_share: f64,
    pub(crate) useless: bool,
}

checked!(Adaptation, |it| {
    [it.variance_ut2, it.local_ut, it.offset_walk_ut, it.slow_age_s].iter().all(|v| *v > 0.0)
        && [it.walk_time_s, it.walk_given, it.carried_ut2, it.power_ut2].iter().all(|v| *v >= 0.0)
        && (0.0..=1.0).contains(&it.useless_share)
});

impl Adaptation {
    pub(crate) fn new(tuning: &Tuning) -> Self {
        Self {
            variance_ut2: tuning.noise_start_ut.powi(2),
            local_ut: tuning.local_start_ut,
            offset_walk_ut: tuning.offset_walk_ut,
            walked_ut: Vector3::zeros(),
            walked_before_ut: Vector3::zeros(),
            walk_start_ut2: -1.0,
            walk_time_s: 0.0,
            walk_seen: 1.0,
            walk_given: 1.0,
            carried_ut2: UNKNOWN_UT2,
            previous_raw_ut: None,
            slow_ut: Vector3::zeros(),
            slow_innovation_ut: Vector3::zeros(),
            slow_power_ut2: tuning.uneven_start_ut.powi(2),
            power_ut2: tuning.local_start_ut.powi(2),
            // what is assumed at the start counts as one value
            slow_age_s: tuning.quick_s,
            useless_share: 0.0,
            useless: false,
        }
    }

    pub(crate) fn sigma_ut(&self) -> f64 {
        self.variance_ut2.sqrt()
    }

    /// The slow difference between the corrected sample and the carried field.
    pub(crate) fn uneven(&mut self, difference_ut: &Vector3<f64>, dt_s: f64, tuning: &Tuning) {
        let gain = 1.0 - (-dt_s / tuning.quick_s).exp();
        self.slow_ut += (difference_ut - self.slow_ut) * gain;
        // what white noise alone would leave after this low-pass
        let white = self.variance_ut2 * gain / (2.0 - gain);
        let seen = (self.slow_ut.norm_squared() / 3.0 - white).min(9.0 * self.slow_power_ut2.max(self.variance_ut2));
        self.slow_age_s = (self.slow_age_s + dt_s).min(tuning.settled_s);
        let gain = (dt_s / self.slow_age_s).min(1.0);
        self.slow_power_ut2 += gain * (seen - self.slow_power_ut2);
        let power = (difference_ut.norm_squared() / 3.0).min(9.0 * self.power_ut2.max(self.variance_ut2));
        self.power_ut2 += gain * (power - self.power_ut2);
    }

    /// Variance per axis of what the covariance cannot know, uT^2.
    pub(crate) fn floor_ut2(&self, tuning: &Tuning) -> f64 {
        tuning.uneven_gain.powi(2) * self.uneven_ut2()
    }

    /// Largest variance per axis that a place may explain, uT^2.
    pub(crate) fn largest_local_ut2(&self, tuning: &Tuning) -> f64 {
        self.uneven_ut2().max(tuning.local_max_ut.powi(2))
    }

    fn uneven_ut2(&self) -> f64 {
        self.slow_power_ut2.max(0.0)
    }

    /// Variance per axis of a corrected sample about the carried field beyond white noise of `noise_ut2` and beyond the
    /// slow part, which the floor has, uT^2.
    pub(crate) fn local_ut2(&self, noise_ut2: f64) -> f64 {
        (self.power_ut2 - noise_ut2 - self.uneven_ut2()).max(0.0)
    }

    /// Breaks the chain of one-step increments (gap, or no rotation known).
    pub(crate) fn forget_previous(&mut self) {
        self.previous_raw_ut = None;
    }

    /// One sample, with the step from the one before.
    pub(crate) fn step(&mut self, raw_ut: &Vector3<f64>, increment: &Increment, tuning: &Tuning) {
        let Increment { offset_ut, soft_iron, turn, angle_rad, dt_s } = increment;
        if let (Some(previous), Some(w)) = (self.previous_raw_ut, soft_iron.try_inverse()) {
            let e = raw_ut - offset_ut - soft_iron * (turn * (w * (previous - offset_ut)));
            let size = e.norm();
            let surprise = size > tuning.useless_step_ut && size > tuning.useless_lever_ut * angle_rad;
            // a cover or charger moves the field for a second at most
            let gain = 1.0 - (-dt_s / tuning.settled_s).exp();
            self.useless_share += gain * (f64::from(surprise) - self.useless_share);
            self.useless = self.useless_share > tuning.fit_share;
            let gain = (dt_s / tuning.memory_s).min(0.2);
            let variance = self.variance_ut2;
            self.variance_ut2 += gain * ((size * size / 6.0).min(6.0 * variance) - variance);
            self.variance_ut2 = self.variance_ut2.max(tuning.noise_min_ut.powi(2));
        }
        self.previous_raw_ut = Some(*raw_ut);
    }

    /// The local field's standard deviation, from the size of an innovation and of its slow part.
    ///
    /// An innovation that the filter's own ignorance dominates (the start) says little about it: hence the share.
    pub(crate) fn local(&mut self, innovation: &Innovation, motion: f64, dt_s: f64, tuning: &Tuning) {
        let share = (3.0 * (self.variance_ut2 + self.local_ut * self.local_ut) / innovation.trace).min(1.0);
        let excess = ((innovation.nis / 3.0).min(3.0) - 1.0) * share;
        let gain = 1.0 - (-dt_s / tuning.quick_s).exp();
        let slow_ut: Vector3<f64> = self.slow_innovation_ut.cast();
        let slow_ut = slow_ut + (innovation.v - slow_ut) * gain;
        self.slow_innovation_ut = slow_ut.cast();
        let slow = slow_ut.norm_squared() * (2.0 - gain) / (gain * innovation.trace);
        let excess = excess + tuning.slow_weight * (slow.min(3.0) - 1.0);
        let excess = if excess < 0.0 { excess * motion } else { excess };
        self.local_ut *= 1.0 + (excess * dt_s).clamp(-0.5, 0.5);
        self.local_ut = self.local_ut.min(tuning.local_max_ut).max(tuning.local_min_ut);
    }

    /// The random walk of b, from one correction of it; `variance_ut2` is tr P_bb after it.
    pub(crate) fn walk(&mut self, correction_ut: &Vector3<f64>, variance_ut2: f64, dt_s: f64, tuning: &Tuning) {
        if self.walk_start_ut2 < 0.0 {
            self.walk_start_ut2 = variance_ut2;
            self.walk_time_s = 0.0;
            self.walked_ut = Vector3::zeros();
            self.walked_before_ut = Vector3::zeros();
            return;
        }
        self.walked_ut += correction_ut;
        self.walk_time_s += dt_s;
        let now = self.offset_walk_ut.powi(2);
        if self.walk_time_s >= tuning.offset_walk_time_s {
            let unseen = (variance_ut2 - self.walk_start_ut2).max(0.0);
            let given = 3.0 * self.walk_time_s * now;
            let kept = self.walked_ut.dot(&self.walked_before_ut) / given;
            let unseen = unseen / given;
            self.walk_seen +=
                tuning.walk_gain * (kept.clamp(-tuning.largest_walk_share, tuning.largest_walk_share) - self.walk_seen);
            self.walk_given += tuning.walk_gain * ((1.0 - unseen).max(0.0) - self.walk_given);
            // from a single window the estimate has three degrees of freedom: it is not believed beyond 9 fold; nor does
            // chance alone (the product is as often negative) keep the walk up
            let next = now * (1.0 + tuning.walk_gain * ((kept + unseen).clamp(-1.0, 9.0) - 1.0));
            self.offset_walk_ut = next.sqrt().min(tuning.offset_walk_max_ut).max(tuning.offset_walk_min_ut);
            self.walk_start_ut2 = variance_ut2;
            self.walk_time_s = 0.0;
            self.walked_before_ut = self.walked_ut;
            self.walked_ut = Vector3::zeros();
        }
    }

    /// rho, the share of the walk of b that was seen to happen: 0 to 3.
    fn walk_share(&self, tuning: &Tuning) -> f64 {
        (self.walk_seen / self.walk_given.max(tuning.walk_gain)).clamp(0.0, tuning.largest_walk_share)
    }

    /// How far P of b and e may be believed, (1 + rho) / 2: 0.5 when the walk in it does not happen, 1 when it does, up to 2.
    pub(crate) fn believed(&self, tuning: &Tuning) -> f64 {
        0.5 * (1.0 + self.walk_share(tuning))
    }

    /// The field is carried on, which adds `variance_ut2` per axis across it.
    pub(crate) fn carry(&mut self, variance_ut2: f64) {
        self.carried_ut2 = (self.carried_ut2 + variance_ut2).min(UNKNOWN_UT2);
    }

    /// A sample with white noise of `variance_ut2` per axis corrects it.
    pub(crate) fn correct(&mut self, variance_ut2: f64, dt_s: f64, tuning: &Tuning) {
        let v = variance_ut2 + 2.0 * self.local_ut.powi(2) * tuning.local_time_s / dt_s;
        self.carried_ut2 *= v / (self.carried_ut2 + v);
    }

    /// The field was lost.
    pub(crate) fn lose(&mut self) {
        self.carried_ut2 = UNKNOWN_UT2;
    }

    /// What may be believed of P_mm, uT^2; all of it while no sample corrects m.
    pub(crate) fn field_ut2(&self, p_mm: &Matrix3<f64>, corrected: bool, tuning: &Tuning) -> Matrix3<f64> {
        if !corrected {
            return *p_mm;
        }
        let share = 0.25 * (1.0 + 2.0 * self.walk_share(tuning));
        let carried = self.carried_ut2.min(p_mm.trace() / 3.0);
        p_mm * share + Matrix3::identity() * (carried * (1.0 - share).max(0.0))
    }

    /// The device stepped: what is not known of b now is no walk.
    pub(crate) fn stepped(&mut self) {
        self.restart_walk();
        self.walk_seen = self.walk_given;
    }

    /// Starts the window of `walk` anew (after a step, a gap or a rest).
    pub(crate) fn restart_walk(&mut self) {
        self.walk_start_ut2 = -1.0;
    }
}
