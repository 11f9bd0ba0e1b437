//! One sample with a known rotation: predict, gate, rest, hypotheses, update, adopt.
//!
//! ```text
//! predict always;  v = raw - h(x);  gated when v^T S^-1 v > 16, or |d|^2 > 16 max(U, 2 uT)^2
//! at rest: no magnetometer update, the rate measures the bias
//! undecided or disturbed: the calibration holds, the hypotheses run
//! else update, unless gated; learn the noises
//! ```
//! Source: docs/METHOD-AIDED.md.

use nalgebra::Vector3;

use super::earth::Earth;
use super::events::{Phase, Trial, Verdict};
use super::measure::NONE;
use super::propagate::ProcessNoise;
use super::start::drift;
use super::state::{DELAY, FIELD, Gaussian, LOCAL, OFFSET};
use super::step::{Known, Step};
use super::watch::{Former, Watch};
use super::{Aided, AidedOutput, propagate};
use crate::reading::{Event, EventKind, Missing, SensorMode, Status};
use crate::sensing::pairing::Rotation;

impl Aided {
    pub(super) fn with_rotation(
        &mut self,
        time_ns: i64,
        raw_ut: &Vector3<f64>,
        rotation: &Rotation,
        up: Option<Vector3<f64>>,
        dt_s: f64,
    ) -> AidedOutput {
        let known = self.filter.as_ref().map_or_else(|| self.first.known(&self.tuning), Known::of);
        let turned_rad = known.x.turned(&rotation.increment_rad, dt_s);
        let (turn, _) = propagate::turn(&turned_rad);
        let angle_rad = turned_rad.norm();
        self.motion.step(&rotation.rate_rad_s, &known, dt_s, &self.tuning);
        self.motion.carry_up(&turn, up, &known, dt_s, &self.tuning);
        self.adaptation.step(raw_ut, &known, &turn, angle_rad, dt_s, &self.tuning);
        self.mode = match up {
            Some(_) => SensorMode::GyroscopeAndGravity,
            None => SensorMode::GyroscopeOnly,
        };
        if self.adaptation.useless {
            return self.without_rotation(time_ns, raw_ut, up, Some(dt_s));
        }
        let noise = self.process_noise(rotation.variance_rad2);
        let step = Step {
            time_ns,
            raw_ut,
            rate_rad_s: &rotation.rate_rad_s,
            increment_rad: &rotation.increment_rad,
            turn,
            angle_rad,
            dt_s,
            noise: &noise,
            sigma_ut: self.adaptation.sigma_ut(),
            resting: self.motion.at_rest(),
            motion: self.motion.amount(&self.tuning),
        };
        if self.filter.is_some() { self.follow(&step) } else { self.collect(&step) }
    }

    /// One sample from the first calibration on.
    fn follow(&mut self, step: &Step<'_>) -> AidedOutput {
        self.learn(step);
        if let (Some(filter), Some(strength_ut)) = (&mut self.filter, self.lost_strength_ut.take()) {
            filter.update_strength(strength_ut, self.tuning.adopt_sd_ut.powi(2));
        }
        let Some(filter) = self.filter.as_ref().filter(|filter| filter.is_finite()) else {
            self.begin(None);
            return self.blank(step.time_ns, Status::Collecting(Missing::Rotation));
        };
        self.published(step, filter)
    }

    /// One sample of a start.
    fn collect(&mut self, step: &Step<'_>) -> AidedOutput {
        self.first.turn(step);
        if self.motion.rest_s > self.tuning.memory_s {
            self.first.rest(step.rate_rad_s, self.rest_variance(step.dt_s));
        }
        if !step.resting || (self.first.given.is_some() && self.first.is_blind()) {
            self.first.add(step, self.motion.up.as_ref(), &self.tuning);
        }
        self.filter = self.first.take();
        if !self.first.is_blind() {
            self.lost_strength_ut = None;
        }
        match self.filter.as_ref().or(self.first.answer.as_ref()) {
            Some(filter) => self.published(step, filter),
            None => self.blank(step.time_ns, Status::Collecting(self.first.missing())),
        }
    }

    /// Variance of a rate at rest about the bias, (rad/s)^2.
    fn rest_variance(&self, dt_s: f64) -> f64 {
        (self.tuning.unknown_bias_rad_s * (0.01 / dt_s).sqrt().clamp(0.3, 3.0)).powi(2)
    }

    /// The filter's part of one sample.
    fn learn(&mut self, step: &Step<'_>) {
        let rest_variance = self.rest_variance(step.dt_s);
        let Some(filter) = &mut self.filter else { return };
        if step.dt_s > self.tuning.gap_s {
            drift(filter, step.dt_s, &self.tuning);
        }
        if let Some(earth) = &mut self.earth {
            earth.step(step, filter, &self.tuning);
        }
        filter.propagate(step.increment_rad, step.dt_s, step.noise);
        let Some(innovation) = filter.innovation(step.raw_ut, step.rate_rad_s, step.sigma_ut) else {
            return;
        };
        // the local deviation swallows what changes slowly: beyond what is left to a place, it is none
        let local_ut = filter.vector(LOCAL);
        let gated = innovation.nis > self.tuning.gate
            || local_ut.norm_squared() > self.tuning.gate * self.adaptation.largest_local_ut2(&self.tuning);
        let unexplained_ut = innovation.v + local_ut;
        let field = filter.vector(FIELD);
        let former = self.former.as_ref().map(|f| f.residual(step.raw_ut, &field));
        self.watch.step(step, gated.then_some(&unexplained_ut), former, self.trial.is_some(), &self.tuning);
        if !step.resting {
            self.moved_s += step.dt_s;
        }
        if self.motion.rest_s > self.tuning.memory_s {
            filter.update_bias(step.rate_rad_s, rest_variance);
        }
        // after a pause the field is known no better than a step of the device is large: both are tried
        let is_blind = filter.block(FIELD, FIELD).trace() > 3.0 * self.tuning.smallest_step_ut.powi(2);
        if is_blind && self.trial.is_none() {
            self.watch.since_ns = step.time_ns;
            self.watch.misfit_ut = innovation.v.norm();
            let mut trial = Trial::start(filter, &self.watch, None, &self.tuning);
            trial.blind = true;
            trial.young = self.moved_s < self.tuning.settled_s;
            self.trial = Some(trial);
        }
        if self.trial.is_some() {
            self.run_trial(step);
            return;
        }
        if !step.resting {
            if !gated {
                let before_ut = filter.vector(OFFSET);
                filter.update(&innovation, NONE);
                let variance_ut2 = filter.block(OFFSET, OFFSET).trace();
                let correction_ut = filter.vector(OFFSET) - before_ut;
                self.adaptation.walk(&correction_ut, variance_ut2, step.dt_s, &self.tuning);
                if let Some(difference_ut) = unevenness(step, filter) {
                    self.adaptation.uneven(&difference_ut, step.dt_s, &self.tuning);
                }
            }
            self.adaptation.local(&innovation, step.motion, step.dt_s, &self.tuning);
        }
        if self.watch.share > self.tuning.suspect_share {
            let mut trial = Trial::start(filter, &self.watch, self.former.as_ref(), &self.tuning);
            trial.young = self.moved_s < self.tuning.settled_s;
            self.trial = Some(trial);
        }
    }

    /// One sample while the hypotheses run; `filter` is as it was, predicted.
    fn run_trial(&mut self, step: &Step<'_>) {
        let (Some(filter), Some(trial)) = (&self.filter, &mut self.trial) else { return };
        let verdict = trial.step(step, filter, &self.watch, self.former.as_ref(), &self.tuning);
        let since_ns = trial.onset_ns;
        let event = |kind| Some(Event { kind, since_ns, decided_ns: step.time_ns });
        match verdict {
            Verdict::Device => {
                let winner = &trial.device;
                let moved_ut = winner.vector(OFFSET) - filter.vector(OFFSET);
                if !trial.young && (!trial.blind || moved_ut.norm() > self.tuning.smallest_step_ut) {
                    let kind = if trial.recalled { EventKind::DeviceStepBack } else { EventKind::DeviceStep };
                    self.event = event(kind);
                    self.former = Some(Former::of(filter));
                }
                if trial.was_place {
                    self.earth = Some(Earth::of(filter, self.earth.as_ref(), trial.onset_ns));
                }
                return self.go_on_with(|trial| trial.device);
            }
            Verdict::Unchanged => return self.go_on_with(|trial| trial.place),
            Verdict::NewPlace | Verdict::Place => {
                if verdict == Verdict::Place {
                    self.event = event(EventKind::PlaceChanged);
                }
                let back = self.earth.as_ref().is_some_and(|it| it.is_that_of(&trial.place, filter, &self.tuning));
                if back {
                    self.earth = None;
                } else if verdict == Verdict::NewPlace {
                    self.earth = Some(Earth::of(filter, self.earth.as_ref(), trial.onset_ns));
                }
                if back || verdict == Verdict::NewPlace {
                    return self.go_on_with(|trial| trial.place);
                }
            }
            Verdict::Open => {}
        }
        if !trial.blind && self.watch.share < 0.5 * self.tuning.suspect_share {
            if trial.phase != Phase::Undecided {
                // it fits again, perhaps by chance: the field is not trusted to be even at once
                self.adaptation.local_ut = self.tuning.local_max_ut;
            }
            self.trial = None; // nothing happened, or it is over
        }
    }

    /// A hypothesis has won: it is the filter from here on.
    fn go_on_with(&mut self, winner: fn(Trial) -> Gaussian) {
        self.filter = self.trial.take().map(winner);
        self.watch = Watch::new();
        self.adaptation.restart_walk(Vector3::zeros(), f64::MAX);
    }

    fn process_noise(&self, bridged_rad2: f64) -> ProcessNoise {
        let c = &self.tuning;
        // warming goes on at rest; what else is learned shows in motion only
        let excess = self.adaptation.walk_ut.powi(2) - c.offset_walk_ut.powi(2);
        ProcessNoise {
            angle_rad: c.angle_walk_rad,
            bridged_rad2,
            offset_ut: (c.offset_walk_ut.powi(2) + excess * self.motion.amount(c)).sqrt(),
            bias_rad_s: c.bias_walk_rad_s,
            local_ut: self.adaptation.local_ut,
            local_time_s: self.tuning.local_time_s,
        }
    }
}

/// What c and f differ by.
fn unevenness(step: &Step<'_>, filter: &Gaussian) -> Option<Vector3<f64>> {
    let still = filter.corrected(step.raw_ut)?;
    let rate = filter.true_rate(step.rate_rad_s);
    Some(still - rate.cross(&still) * filter.x[DELAY] - filter.vector(FIELD))
}
