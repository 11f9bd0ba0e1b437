//! What is sensed before anything is believed of it: how the device turned and moves, where up is, how noisy the magnetometer is.
//!
//! ```text
//! turn = (I - S) increment - g dt      with what is known of g and S so far
//! ```

use crate::math::elementary::hypot;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

use super::Aided;
use super::phase::Phase;
use super::propagate::ProcessNoise;
use super::recent::Entry;
use super::step::{Known, SAMPLE_S, Step};
use crate::math::turn::Turn;
use crate::sensing::pairing::Rotation;

impl Aided {
    /// What a rotation says of a sample.
    pub(super) fn sense<'a>(
        &mut self,
        time_ns: i64,
        (sample, late_s): &'a (Entry, f64),
        rotation: &'a Rotation,
        up: Option<Vector3<f64>>,
        dt_s: f64,
    ) -> Step<'a> {
        let tuning = &self.tuning;
        let known = match &self.phase {
            Phase::Starting(first) => first.known(tuning),
            Phase::Running(it) | Phase::Undecided(it, _) => Known::of(&it.filter),
        };
        let turned_rad = known.x.turned(&rotation.increment_rad, dt_s);
        let turn = Turn::by(&-turned_rad).rotation;
        self.motion.step(&rotation.rate_rad_s, &known, dt_s, tuning);
        self.motion.carry_up(&turn, up, &known, rotation.variance_rad2, dt_s, tuning);
        let Entry { raw_ut, is_blank, .. } = sample;
        let seen = (!is_blank).then_some(raw_ut);
        self.adaptation.sample.step(seen, &known.x, &turn, dt_s, tuning.memory_s, tuning);
        let rest_sd_rad_s = tuning.unknown_bias_rad_s() * (SAMPLE_S / dt_s).sqrt();
        let delayed_rad_s = self.recent.mean_rad_s(known.x.delay + late_s).filter(|_| tuning.recent);
        Step {
            time_ns,
            raw_ut,
            is_blank: *is_blank,
            rate_rad_s: &rotation.rate_rad_s,
            delayed_rad_s: delayed_rad_s.unwrap_or(rotation.rate_rad_s),
            increment_rad: &rotation.increment_rad,
            turn,
            dt_s,
            noise: self.process_noise(rotation),
            sigma_ut: self.adaptation.sample.sigma_ut(),
            late_s: *late_s,
            bias_sd_rad_s: known.bias_sd_rad_s,
            resting: self.motion.at_rest(),
            bias_variance: (self.motion.rest_s > tuning.memory_s).then_some(rest_sd_rad_s.powi(2)),
            motion: self.motion.amount(tuning),
        }
    }

    /// What may have changed meanwhile.
    fn process_noise(&self, rotation: &Rotation) -> ProcessNoise {
        let tuning = &self.tuning;
        ProcessNoise {
            bridged_rad2: rotation.variance_rad2,
            offset_ut: if tuning.hard_iron_walk { tuning.offset_walk_ut } else { 0.0 },
            local_ut: hypot(self.adaptation.local_ut, self.bursts.left_ut2(tuning).sqrt()),
            local_time_s: tuning.place_correlation_s,
        }
    }
}
