//! What was learned just before a misfit is not trusted: a magnet in the room is neared over a second or two, and its field grows from
//! nothing, so that m, b and the gyroscope's bias have followed it before a sample is gated.
//!
//! ```text
//! proven <- pending <- filter, every second of samples that fit;   at a misfit the filter goes back to proven, brought to now
//! turn <- r turn,  G <- r G + (dt, increment') (x) I:    m <- exp([G (g, s)]x) turn m,   dm/d(g, s) = -[m]x G
//! ```
//! The turns are added up as those of a group of a start are (`groups`), so that a copy costs little until it is needed. A copy is used once: were
//! it kept, a filter whose samples misfit every second would learn nothing. Source: docs/METHOD-AIDED.md, Bursts.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::propagate::{ProcessNoise, StepNoise};
use super::state::{Filter, Parts};
use super::step::Step;
use super::tuning::Tuning;
use crate::math::turn::Turn;

/// The filter without what the samples of the last one to two seconds have told it.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Quarantine {
    proven: Option<Earlier>,
    pending: Option<Earlier>,
    /// Seconds since `pending` was taken.
    age_s: f64,
}

impl Quarantine {
    /// The device turned.
    pub(super) fn turn(&mut self, step: &Step<'_>) {
        for it in [&mut self.proven, &mut self.pending].into_iter().flatten() {
            it.since.step(step);
        }
    }

    /// The filter after a sample that fits.
    pub(super) fn learned(&mut self, filter: &Filter, dt_s: f64, tuning: &Tuning) {
        self.age_s += dt_s;
        if self.age_s > tuning.quarantine_s || self.pending.is_none() {
            self.age_s = 0.0;
            self.proven = self.pending.take();
            self.pending = Some(Earlier { filter: filter.clone(), since: Since::default() });
        }
    }

    /// The filter to go on from at a misfit, if there is one.
    pub(super) fn take_back(&mut self, noise: &ProcessNoise) -> Option<Filter> {
        let Self { proven, pending, .. } = std::mem::take(self);
        proven.or(pending).map(|it| it.now(noise))
    }
}

/// A filter of before, and the way since.
#[derive(Clone, Debug, PartialEq)]
struct Earlier {
    filter: Filter,
    since: Since,
}

/// How the device turned, and what the process noise has added up to, since a moment.
#[derive(Clone, Debug, PartialEq)]
struct Since {
    turn: Matrix3<f64>,
    /// G: what bias and axes of the gyroscope add to the turn.
    by_gyroscope: SMatrix<f64, 3, 12>,
    turn_rad2: f64,
    hard_iron_ut2: f64,
    seconds: f64,
}

impl Default for Since {
    fn default() -> Self {
        Self {
            turn: Matrix3::identity(),
            by_gyroscope: SMatrix::zeros(),
            turn_rad2: 0.0,
            hard_iron_ut2: 0.0,
            seconds: 0.0,
        }
    }
}

impl Since {
    fn step(&mut self, step: &Step<'_>) {
        let r = Turn::by(&-step.increment_rad).rotation;
        let errors = step.increment_rad.transpose().insert_column(0, step.dt_s);
        self.turn = r * self.turn;
        self.by_gyroscope = r * self.by_gyroscope + errors.kronecker(&Matrix3::identity());
        self.turn_rad2 += step.noise.turn_rad2(step.dt_s);
        self.hard_iron_ut2 += step.noise.offset_ut.powi(2) * step.dt_s;
        self.seconds += step.dt_s;
    }

    /// By what (g, S) adds to the turn, rad.
    fn added(&self, x: &Parts) -> Vector3<f64> {
        let mut errors = SVector::<f64, 12>::zeros();
        errors.fixed_rows_mut::<3>(0).copy_from(&x.bias);
        errors.fixed_rows_mut::<9>(3).copy_from_slice(x.axes.as_slice());
        self.by_gyroscope * errors
    }
}

impl Earlier {
    /// That filter, predicted to now.
    fn now(&self, noise: &ProcessNoise) -> Filter {
        let (mut filter, since) = (self.filter.clone(), &self.since);
        let own = Turn::by(&since.added(&filter.parts())).rotation;
        let fade = (-since.seconds / noise.local_time_s).exp();
        filter.carry(&(own * since.turn), fade, |dx| since.added(dx));
        filter.widen(&StepNoise {
            turn_rad2: since.turn_rad2,
            hard_iron_ut2: since.hard_iron_ut2,
            local_ut2: noise.local_ut.powi(2) * (1.0 - fade * fade),
            seconds: since.seconds,
        });
        filter
    }
}
