//! What was learned just before a misfit is not trusted: a magnet in the room is neared over a second or two, and its field grows from
//! nothing, so that m, b and the gyroscope's bias have followed it before a sample is gated.
//!
//! ```text
//! proven <- pending <- filter, every second of samples that fit;   at a misfit the filter goes back to proven, brought to now
//! turn <- r turn,  G <- r G + (dt, increment') (x) I:    m <- exp([G (g, s)]x) turn m,   dm/d(g, s) = -[m]x G
//! ```
//! The turns are added up as those of a group of a start are (`groups`), so that a copy costs little until it is needed. A copy is used once: were
//! it kept, a filter whose samples misfit every second would learn nothing. Source: docs/dev/METHOD-AIDED.md, Bursts.

use crate::math::elementary::exp;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::propagate::{ProcessNoise, StepNoise};
use super::state::{Filter, Parts};
use super::step::Step;
use super::tuning::Tuning;
use crate::math::turn::Turn;

/// The filter without what the samples of the last one to two seconds have told it.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Quarantine {
    /// Proven, and the way from there to `pending`.
    proven: Option<Earlier>,
    pending: Option<Filter>,
    /// The way since `pending` was taken.
    since: Way,
    /// Seconds of it with samples that fit.
    age_s: f64,
}

impl Quarantine {
    /// The device turned.
    pub(super) fn turn(&mut self, step: &Step<'_>) {
        self.since.step(step);
    }

    /// The filter after a sample that fits.
    pub(super) fn learned(&mut self, filter: &Filter, dt_s: f64, tuning: &Tuning) {
        self.age_s += dt_s;
        if self.age_s > tuning.local_time_s || self.pending.is_none() {
            self.age_s = 0.0;
            let way = std::mem::take(&mut self.since);
            self.proven = self.pending.take().map(|filter| Earlier { filter, way });
            self.pending = Some(filter.clone());
        }
    }

    /// The filter to go on from at a misfit, if there is one.
    pub(super) fn take_back(&mut self, noise: &ProcessNoise) -> Option<Filter> {
        let Self { proven, pending, since, .. } = std::mem::take(self);
        match proven {
            Some(Earlier { filter, way }) => Some(way.joined(&since).bring(filter, noise)),
            None => pending.map(|filter| since.bring(filter, noise)),
        }
    }
}

/// A filter of before, and the way from it.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Earlier {
    filter: Filter,
    way: Way,
}

/// How the device turned, and what the process noise has added up to.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Way {
    turn: Matrix3<f64>,
    /// G: what bias and axes of the gyroscope add to the turn.
    by_gyroscope: SMatrix<f64, 3, 12>,
    turn_rad2: f64,
    hard_iron_ut2: f64,
    seconds: f64,
}

impl Default for Way {
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

impl Way {
    fn step(&mut self, step: &Step<'_>) {
        let errors = step.increment_rad.transpose().insert_column(0, step.dt_s);
        *self = self.joined(&Self {
            turn: Turn::by(&-step.increment_rad).rotation,
            by_gyroscope: errors.kronecker(&Matrix3::identity()),
            turn_rad2: step.noise.turn_rad2(step.dt_s),
            hard_iron_ut2: step.noise.offset_ut.powi(2) * step.dt_s,
            seconds: step.dt_s,
        });
    }

    /// This way, and then the next.
    fn joined(&self, next: &Self) -> Self {
        Self {
            turn: next.turn * self.turn,
            by_gyroscope: next.turn * self.by_gyroscope + next.by_gyroscope,
            turn_rad2: self.turn_rad2 + next.turn_rad2,
            hard_iron_ut2: self.hard_iron_ut2 + next.hard_iron_ut2,
            seconds: self.seconds + next.seconds,
        }
    }

    /// By what (g, S) adds to the turn, rad.
    fn added(&self, x: &Parts) -> Vector3<f64> {
        let mut errors = SVector::<f64, 12>::zeros();
        errors.fixed_rows_mut::<3>(0).copy_from(&x.bias);
        errors.fixed_rows_mut::<9>(3).copy_from_slice(x.axes.as_slice());
        self.by_gyroscope * errors
    }

    /// A filter, predicted along this way.
    fn bring(&self, mut filter: Filter, noise: &ProcessNoise) -> Filter {
        let own = Turn::by(&self.added(&filter.parts()));
        let turn = Turn { rotation: own.rotation * self.turn, ..own };
        let fade = exp(-self.seconds / noise.local_time_s);
        filter.carry(&turn, fade, |dx| self.added(dx));
        filter.widen(&StepNoise {
            turn_rad2: self.turn_rad2,
            hard_iron_ut2: self.hard_iron_ut2,
            local_ut2: noise.local_ut.powi(2) * (1.0 - fade * fade),
            seconds: self.seconds,
        });
        filter
    }
}
