//! What is sensed before anything is believed of it: how the device turned and moves, where up is, how noisy the magnetometer is.
//!
//! ```text
//! turn = (I - S) increment - g dt      with what is known of g and S so far
//! ```

#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

use super::motion::Motion;
use super::phase::Phase;
use super::propagate::ProcessNoise;
use super::recent::{Entry, Recent};
use super::state::DELAY;
use super::step::{Known, SAMPLE_S, Step};
use super::tuning::Tuning;
use super::white::White;
use crate::math::turn::Turn;
use crate::sample::seconds;
use crate::sensing::pairing::Rotation;

/// A sample as it came, so many seconds after the one before, or only its time where it is blank.
#[derive(Clone, Copy)]
pub(super) struct Taken {
    pub(super) time_ns: i64,
    pub(super) dt_s: f64,
    pub(super) raw_ut: Vector3<f64>,
    pub(super) is_blank: bool,
}

/// What the sensors have told of late.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Senses {
    pub(super) latest_ns: Option<i64>,
    pub(super) motion: Motion,
    recent: Recent,
    /// Noise of a sample.
    pub(super) white: White,
    /// Seconds since the chain of rotations began, and whether there was one before.
    chain_s: f64,
    was_broken: bool,
}

impl Senses {
    pub(super) fn new(tuning: &Tuning) -> Self {
        Self {
            latest_ns: None,
            motion: Motion::new(),
            recent: Recent::default(),
            white: White::new(tuning),
            chain_s: 0.0,
            was_broken: false,
        }
    }

    /// Whether the chain of rotations broke not long ago: it is younger than this.
    pub(super) fn broke_within(&self, seconds: f64) -> bool {
        self.was_broken && self.chain_s < seconds
    }

    /// Seconds since the sample before.
    pub(super) fn next(&mut self, time_ns: i64) -> Option<f64> {
        self.latest_ns.replace(time_ns).map(|latest_ns| seconds(latest_ns, time_ns))
    }

    /// What a rotation says of a sample.
    pub(super) fn step(
        &mut self,
        taken: &Taken,
        rotation: &Rotation,
        up: Option<Vector3<f64>>,
        phase: &Phase,
        noise: ProcessNoise,
        tuning: &Tuning,
    ) -> Step {
        let dt_s = taken.dt_s;
        self.chain_s += dt_s;
        self.recent.add(&rotation.increment_rad, dt_s, &taken.raw_ut, taken.is_blank);
        let wait_s = phase.running().map_or(0.0, |it| -it.filter.part(DELAY).x);
        let (Entry { raw_ut, is_blank, .. }, late_s) = self.recent.waited(wait_s);
        let known = match phase {
            Phase::Starting(first) => first.known(tuning),
            Phase::Running(it, _) | Phase::Undecided(it, _) => Known::of(&it.filter),
        };
        let turned_rad = known.x.turned(&rotation.increment_rad, dt_s);
        let turn = Turn::by(&-turned_rad).rotation;
        self.motion.step(&rotation.rate_rad_s, &known, dt_s, tuning);
        self.motion.carry_up(&turn, up, &known, rotation.variance_rad2, dt_s, tuning);
        let seen = (!is_blank).then_some(&raw_ut);
        self.white.step(seen, &known.x, &turn, dt_s, tuning.memory_s, tuning);
        let rest_sd_rad_s = tuning.unknown_bias_rad_s() * (SAMPLE_S / dt_s).sqrt();
        Step {
            time_ns: taken.time_ns,
            raw_ut,
            is_blank,
            rate_rad_s: rotation.rate_rad_s,
            delayed_rad_s: self.mean_rad_s(known.x.delay + late_s, tuning).unwrap_or(rotation.rate_rad_s),
            increment_rad: rotation.increment_rad,
            turn,
            dt_s,
            noise,
            sigma_ut: self.white.sigma_ut(),
            late_s,
            bias_sd_rad_s: known.bias_sd_rad_s,
            resting: self.motion.at_rest(),
            bias_variance: (self.motion.rest_s > tuning.memory_s).then_some(rest_sd_rad_s.powi(2)),
            motion: self.motion.amount(tuning),
        }
    }

    /// Mean reading of the gyroscope over the latest `delay_s`, rad/s; `None` where the sample is not late, or this is switched off.
    pub(super) fn mean_rad_s(&self, delay_s: f64, tuning: &Tuning) -> Option<Vector3<f64>> {
        self.recent.mean_rad_s(delay_s).filter(|_| tuning.recent)
    }

    /// The chain of rotations is broken.
    pub(super) fn without_rotation(&mut self, up: Option<Vector3<f64>>) {
        self.was_broken |= self.chain_s > 0.0;
        self.chain_s = 0.0;
        self.white.previous = None;
        self.motion.without_rotation(up);
        self.recent = Recent::default();
    }
}
