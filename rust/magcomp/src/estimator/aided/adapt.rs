//! What the filter learns about the place's field while it runs, beside the magnetometer's `white` noise.
//!
//! ```text
//! s_d grows with (NIS/3 - 1), capped, per second of motion; and with the slow innovations beyond white noise
//! s += (dt / t_s) (c - f - s),  t_s = 0.25 s,   U^2 = max(mean |s|^2 / 3 - sigma^2 dt / (2 t_s), (1 + t_w / tau_d) |s_w|^2 / 3)
//! s_w: as s, t_w = 2.5 s: the field of a place, correlated over tau_d, leaves 1 / (1 + t_w / tau_d) of its power in it
//! F^2 = U^2 + (U^2 - s_d^2)+,   L^2 = (mean |c - f|^2 - tr (sigma^2 W W^T)) / 3        F^2 + L^2 is variance of c, which has the place's field in it
//! U_f: U, which fades over 5 s,   rho = max(1, (2 tau_d U_f^2 + sigma^2 dt) / (2 tau_d s_d^2 + sigma^2 dt)),   G^2 = 2 (U_f^2 - (1.3 uT)^2)+
//! rho P_mm + G^2 is variance of f, an average: its error grows with the density of what is slow; what is too uneven does not average out.
//! ```
//! Source: docs/dev/METHOD-AIDED.md.

use crate::math::elementary::{exp, gain};
use crate::priors::BEYOND_CHANCE;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

use super::measure::Innovation;
use super::propagate::ProcessNoise;
use super::tuning::Tuning;
use super::white::White;

/// Noise levels, learned.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Adaptation {
    /// Noise of a frame's mean.
    pub(super) mean: White,
    /// s_d, uT.
    pub(super) local_ut: f64,
    slow_ut: Vector3<f64>,
    slow_innovation_ut: Vector3<f64>,
    slow_power_ut2: f64,
    /// c - f, low-passed for longer than the field of a place lasts.
    lasting_ut: Vector3<f64>,
    /// Mean square of c - f per axis, uT^2.
    power_ut2: f64,
    slow_age_s: f64,
    /// U_f^2, uT^2.
    followed_power_ut2: f64,
}

impl Adaptation {
    pub(crate) fn new(tuning: &Tuning) -> Self {
        Self {
            mean: White::new(tuning),
            local_ut: if tuning.unevenness { tuning.local_most_ut } else { 0.0 },
            power_ut2: tuning.even_ut.powi(2),
            // what is assumed at the start counts as one value
            slow_age_s: tuning.quick_s,
            ..Self::default()
        }
    }

    /// The slow difference between the corrected sample and the carried field.
    pub(crate) fn add_difference(&mut self, difference_ut: &Vector3<f64>, dt_s: f64, tuning: &Tuning) {
        let quick = gain(dt_s, tuning.quick_s);
        self.slow_ut += (difference_ut - self.slow_ut) * quick;
        // what white noise alone would leave after this low-pass
        let white = self.mean.variance_ut2() * quick / (2.0 - quick);
        let seen = (self.slow_ut.norm_squared() / 3.0 - white)
            .min(BEYOND_CHANCE.powi(2) * self.slow_power_ut2.max(self.mean.variance_ut2()));
        self.slow_age_s = (self.slow_age_s + dt_s).min(tuning.settled_s);
        let share = gain(dt_s, self.slow_age_s);
        self.slow_power_ut2 += share * (seen - self.slow_power_ut2);
        self.lasting_ut += (difference_ut - self.lasting_ut) * gain(dt_s, tuning.lasting_s);
        let power = (difference_ut.norm_squared() / 3.0)
            .min(BEYOND_CHANCE.powi(2) * self.power_ut2.max(self.mean.variance_ut2()));
        self.power_ut2 += share * (power - self.power_ut2);
        // f remembers what it has followed
        self.followed_power_ut2 = self.uneven_ut2(tuning).max(self.followed_power_ut2 * exp(-dt_s / tuning.settled_s));
    }

    /// U^2, uT^2.
    fn uneven_ut2(&self, tuning: &Tuning) -> f64 {
        if !tuning.unevenness {
            return 0.0;
        }
        let lasts = 1.0 + tuning.lasting_s / tuning.place_correlation_s;
        self.slow_power_ut2.max(lasts * self.lasting_ut.norm_squared() / 3.0)
    }

    /// rho: by how much the variance of f, an average, is larger than the filter, which expects s_d, believes.
    pub(crate) fn factor(&self, noise: &ProcessNoise, dt_s: f64, tuning: &Tuning) -> f64 {
        if !tuning.followed {
            return 1.0;
        }
        let density = |local_ut2: f64| 2.0 * tuning.place_correlation_s * local_ut2 + self.mean.variance_ut2() * dt_s;
        (density(self.followed_power_ut2) / density(noise.local_ut.powi(2))).max(1.0)
    }

    /// G^2, variance per axis of f in a place so uneven that it does not average out, uT^2.
    pub(crate) fn unaveraged_ut2(&self, tuning: &Tuning) -> f64 {
        if !tuning.followed {
            return 0.0;
        }
        2.0 * (self.followed_power_ut2 - tuning.even_ut.powi(2)).max(0.0)
    }

    /// F^2, variance per axis of a corrected sample for what the filter does not know of the place, uT^2.
    pub(crate) fn floor_ut2(&self, tuning: &Tuning) -> f64 {
        let uneven_ut2 = self.uneven_ut2(tuning);
        let unexplained_ut2 = (uneven_ut2 - self.local_ut.powi(2)).max(0.0);
        uneven_ut2.max(0.0) + unexplained_ut2
    }

    /// Largest variance per axis that a place may explain, uT^2.
    pub(crate) fn largest_local_ut2(&self, tuning: &Tuning) -> f64 {
        self.slow_power_ut2.max(tuning.local_most_ut.powi(2))
    }

    /// L^2, variance per axis of a corrected sample about the carried field beyond white noise of `noise_ut2`, uT^2.
    pub(crate) fn local_ut2(&self, noise_ut2: f64, tuning: &Tuning) -> f64 {
        if tuning.unevenness { (self.power_ut2 - noise_ut2).max(0.0) } else { 0.0 }
    }

    /// The local field's standard deviation, from the size of an innovation and of its slow part.
    ///
    /// An innovation that the filter's own ignorance dominates (the start) says little about it: hence the share.
    pub(crate) fn add_innovation(&mut self, innovation: &Innovation, motion: f64, dt_s: f64, tuning: &Tuning) {
        if !tuning.unevenness || !tuning.local_learning {
            return;
        }
        let trace_ut2 = innovation.variance_ut2.sum();
        let share = (3.0 * (self.mean.variance_ut2() + self.local_ut * self.local_ut) / trace_ut2).min(1.0);
        let excess = ((innovation.nis / 3.0).min(3.0) - 1.0) * share;
        let quick = gain(dt_s, tuning.quick_s);
        self.slow_innovation_ut += (innovation.v - self.slow_innovation_ut) * quick;
        let slow = self.slow_innovation_ut.norm_squared() * (2.0 - quick) / (quick * trace_ut2);
        let excess = excess + tuning.slow_weight * (slow.min(3.0) - 1.0);
        let excess = if excess < 0.0 { excess * motion } else { excess };
        let grown_ut = self.local_ut * (1.0 + (excess * dt_s).clamp(-0.5, 0.5));
        self.local_ut = grown_ut.clamp(tuning.local_least_ut, tuning.local_most_ut);
    }
}

#[cfg(test)]
mod tests;
