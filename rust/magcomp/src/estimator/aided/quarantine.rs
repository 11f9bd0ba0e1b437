//! What was learned just before a misfit is not trusted: a magnet in the room is neared over a second or two, and its field grows from
//! nothing, so that m, b and the gyroscope's bias have followed it before a sample is gated.
//!
//! ```text
//! proven <- pending <- filter, every second of samples that fit;   at a misfit the filter goes back to proven, brought to now
//! m <- exp([G (g, s)]x) turn m,   dm/d(g, s) = -[m]x G                turn and G: `turned`
//! ```
//! The turns are added up, so that a copy costs little until it is needed. A copy is used once: were
//! it kept, a filter whose samples misfit every second would learn nothing. Source: docs/dev/METHOD-AIDED.md, Bursts.

use super::propagate::ProcessNoise;
use super::state::Filter;
use super::step::FrameStep;
use super::tuning::Tuning;
use super::turned::Turned;
use crate::math::elementary::exp;
use crate::math::turn::Turn;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;

/// The filter without what the samples of the last one to two seconds have told it.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Quarantine {
    /// Proven, and the way from there to `pending`.
    proven: Option<(Filter, Way)>,
    pending: Option<Filter>,
    /// The way since `pending` was taken.
    since: Way,
    /// Seconds of it with samples that fit.
    age_s: f64,
}

impl Quarantine {
    /// The device turned.
    pub(super) fn turn(&mut self, step: &FrameStep) {
        let way = &mut self.since;
        way.turned.step(&step.increment_rad, step.dt_s);
        way.turn_rad2 += step.noise.turn_rad2(step.dt_s);
        way.hard_iron_ut2 += step.noise.offset_ut.powi(2) * step.dt_s;
    }

    /// The filter after a sample that fits.
    pub(super) fn learned(&mut self, filter: &Filter, dt_s: f64, tuning: &Tuning) {
        self.age_s += dt_s;
        if self.age_s > tuning.quarantine_s || self.pending.is_none() {
            self.age_s = 0.0;
            let way = core::mem::take(&mut self.since);
            self.proven = self.pending.take().map(|filter| (filter, way));
            self.pending = Some(filter.clone());
        }
    }

    /// The filter to go on from at a misfit, if there is one.
    pub(super) fn take_back(&mut self, noise: &ProcessNoise) -> Option<Filter> {
        let Self { proven, pending, since, .. } = core::mem::take(self);
        match proven {
            Some((filter, way)) => Some(way.joined(&since).bring(filter, noise)),
            None => pending.map(|filter| since.bring(filter, noise)),
        }
    }
}

/// How the device turned, and what the process noise has added up to.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct Way {
    turned: Turned,
    turn_rad2: f64,
    hard_iron_ut2: f64,
}

impl Way {
    /// This way, and then the next.
    fn joined(&self, next: &Self) -> Self {
        Self {
            turned: self.turned.joined(&next.turned),
            turn_rad2: self.turn_rad2 + next.turn_rad2,
            hard_iron_ut2: self.hard_iron_ut2 + next.hard_iron_ut2,
        }
    }

    /// A filter, predicted along this way.
    fn bring(&self, mut filter: Filter, noise: &ProcessNoise) -> Filter {
        let Turned { turn, seconds, .. } = self.turned;
        let own = Turn::by(&self.turned.added(&filter.parts()));
        let turn = Turn { rotation: own.rotation * turn, ..own };
        let fade = exp(-seconds / noise.local_time_s);
        let local_ut2 = noise.local_ut.powi(2) * (1.0 - fade * fade);
        filter.turn(&turn.rotation, fade);
        filter.carry_covariance(&turn, fade, |dx| self.turned.added(dx));
        filter.widen(self.turn_rad2, self.hard_iron_ut2, local_ut2, seconds);
        filter
    }
}
