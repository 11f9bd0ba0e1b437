//! A change of the device that has won is in force at once, and told once it has gone on to fit: half a second of any smooth field is fitted by twelve
//! free numbers, and what tells a magnet that is passed from one that was put on is the next second.
//!
//! ```text
//! the filter as it was is predicted beside the new one for 1.5 s of motion
//! samples stop fitting the new one:  back to it, the change was the place's        they go on:  the change is told
//! a change that follows one within 5 s, in which b moves on in the same direction, belongs to it: a slide is told once
//! ```
//! Source: docs/dev/METHOD-AIDED.md, Changes.

use super::running::Running;
use super::state::{CALIBRATION, Filter, HARD_IRON};
use super::step::FrameStep;
use super::tuning::Tuning;
use super::watch::Former;
use crate::estimator::answer::Told;
use crate::reading::Event;

/// The filter as it was before the change, to go back to, and what is told if it holds.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Probation {
    filter: Filter,
    event: Option<Event>,
    since_ns: i64,
    /// Seconds of motion.
    age_s: f64,
}

impl Probation {
    pub(super) fn new(before: &Running, event: Option<Event>, since_ns: i64) -> Self {
        Self { filter: before.filter.clone(), event, since_ns, age_s: 0.0 }
    }

    /// One frame; whether the change has held.
    pub(super) fn step(&mut self, step: &FrameStep, tuning: &Tuning) -> bool {
        self.filter.propagate(&step.increment_rad, step.dt_s, &step.noise);
        if let Some(variance) = step.bias_variance {
            self.filter.update_bias(&step.rate_rad_s, variance);
        }
        if !step.resting && !step.is_blank {
            self.age_s += step.dt_s;
        }
        self.age_s > tuning.probation_s
    }

    /// Samples have stopped fitting.
    pub(super) fn take_back(self, running: &mut Running) {
        running.filter = self.filter;
        running.watch.since_ns = self.since_ns;
    }

    /// The change has held. Returns how b moved, and the event unless the change goes on with the one told before; `None` where b moved too little.
    pub(super) fn held(&self, now: &Filter, before: Option<Told>, decided_ns: i64) -> Option<(Told, Option<Event>)> {
        let event = self.event?;
        let moved = now.part(HARD_IRON) - self.filter.part(HARD_IRON);
        let before = before.filter(|before| before.goes_on(event.since_ns, &moved));
        let since_ns = before.map_or(event.since_ns, |before| before.since_ns);
        let event = before.is_none().then_some(Event { decided_ns, ..event });
        Some((Told { since_ns, decided_ns, moved }, event))
    }

    /// The calibration from before the change.
    pub(super) fn former(&self) -> Former {
        self.filter.marginal(CALIBRATION)
    }
}
