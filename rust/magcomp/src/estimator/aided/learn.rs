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

use super::Aided;
use super::earth::Earth;
use super::events::{Trial, Verdict};
use super::measure::{Judged, NONE};
use super::phase::{Phase, Running};
use super::propagate::ProcessNoise;
use super::start::drift;
use super::state::{FIELD, Filter, HARD_IRON, LOCAL, Parts};
use super::step::{Known, Step};
use super::watch::Former;
use crate::estimator::answer::Answer;
use crate::explanation::SampleUse;
use crate::math::turn::Turn;
use crate::reading::{Event, EventKind, Status};
use crate::sensing::pairing::Rotation;

impl Aided {
    /// What a rotation says of a sample; `None` while the gyroscope explains nothing.
    pub(super) fn sense<'a>(
        &mut self,
        time_ns: i64,
        raw_ut: &'a Vector3<f64>,
        rotation: &'a Rotation,
        up: Option<Vector3<f64>>,
        dt_s: f64,
    ) -> Option<Step<'a>> {
        let tuning = &self.tuning;
        let known = match &self.phase {
            Phase::Starting(first) => first.known(tuning),
            Phase::Running(it) | Phase::Undecided(it, _) => Known::of(&it.filter),
        };
        let turned_rad = known.x.turned(&rotation.increment_rad, dt_s);
        let turn = Turn::by(&-turned_rad).rotation;
        let angle_rad = turned_rad.norm();
        self.motion.step(&rotation.rate_rad_s, &known, dt_s, tuning);
        self.motion.carry_up(&turn, up, &known, dt_s, tuning);
        self.adaptation.step(raw_ut, &known, &turn, angle_rad, dt_s, tuning);
        let motion = self.motion.amount(tuning);
        // warming goes on at rest; what else is learned shows in motion only
        let least_ut2 = tuning.offset_walk_ut.powi(2);
        let noise = ProcessNoise {
            bridged_rad2: rotation.variance_rad2,
            offset_ut: (least_ut2 + (self.adaptation.walk_ut.powi(2) - least_ut2) * motion).sqrt(),
            local_ut: self.adaptation.local_ut,
            local_time_s: tuning.local_time_s,
        };
        let rest_sd_rad_s = tuning.unknown_bias_rad_s * (0.01 / dt_s).sqrt().clamp(0.3, 3.0);
        (!self.is_gyroscope_useless()).then_some(Step {
            time_ns,
            raw_ut,
            rate_rad_s: &rotation.rate_rad_s,
            increment_rad: &rotation.increment_rad,
            turn,
            angle_rad,
            dt_s,
            noise,
            sigma_ut: self.adaptation.sigma_ut(),
            resting: self.motion.at_rest(),
            bias_variance: (self.motion.rest_s > tuning.memory_s).then_some(rest_sd_rad_s.powi(2)),
            motion,
        })
    }

    /// One sample with a rotation.
    pub(super) fn with_rotation(&mut self, step: &Step<'_>) -> (Status, Answer) {
        match self.phase {
            Phase::Starting(_) => self.collect(step),
            Phase::Running(_) | Phase::Undecided(..) => self.learn(step),
        }
        if let Phase::Running(running) | Phase::Undecided(running, _) = &mut self.phase {
            if let Some(strength_ut) = running.lost_strength_ut.take() {
                running.filter.update_strength(strength_ut, self.tuning.adopt_sd_ut.powi(2));
            }
            if !running.filter.is_finite() {
                self.begin(None);
            }
        }
        match self.phase.known() {
            Some(filter) => (self.status(), self.published(step, filter).unwrap_or_default()),
            None => (self.status(), Answer::default()),
        }
    }

    /// The start's part of one sample.
    fn collect(&mut self, step: &Step<'_>) {
        let Phase::Starting(first) = &mut self.phase else { return };
        first.turn(step);
        if let Some(variance) = step.bias_variance {
            first.rest(step.rate_rad_s, variance);
        }
        let is_pooled = !step.resting || (first.given.is_some() && first.is_blind());
        if is_pooled {
            first.add(step, self.motion.up.as_ref(), &self.tuning);
        }
        self.judged = Some(Judged::alone(if is_pooled { SampleUse::Pooled } else { SampleUse::AtRest }));
        if let Some(filter) = first.take() {
            self.phase = Phase::Running(Running::of(filter));
        }
    }

    /// The filter's part of one sample.
    fn learn(&mut self, step: &Step<'_>) {
        let is_open = self.phase.trial().is_some();
        let (Phase::Running(running) | Phase::Undecided(running, _)) = &mut self.phase else { return };
        let filter = &mut running.filter;
        if step.dt_s > self.tuning.gap_s {
            drift(filter, step.dt_s, &self.tuning);
        }
        if let Some(earth) = &mut running.earth {
            earth.step(step, filter, &self.tuning);
        }
        filter.propagate(step.increment_rad, step.dt_s, &step.noise);
        let Some(innovation) = filter.innovation(step.raw_ut, step.rate_rad_s, step.sigma_ut) else {
            self.judged = Some(Judged::alone(SampleUse::Unused));
            return;
        };
        // the local deviation swallows what changes slowly: beyond what is left to a place, it is none
        let local_ut = filter.part(LOCAL);
        let gated = innovation.nis > self.tuning.gate
            || local_ut.norm_squared() > self.tuning.gate * self.adaptation.largest_local_ut2(&self.tuning);
        let unexplained_ut = innovation.v + local_ut;
        let field = filter.part(FIELD);
        let former = self.former.as_ref().map(|f| f.residual(step.raw_ut, &field));
        running.watch.step(step, gated.then_some(&unexplained_ut), former, is_open, &self.tuning);
        if !step.resting {
            running.moved_s += step.dt_s;
        }
        if let Some(variance) = step.bias_variance {
            filter.update_bias(step.rate_rad_s, variance);
        }
        // after a pause the field is known no better than a step of the device is large: both are tried
        let is_blind = filter.variances(FIELD).sum() > 3.0 * self.tuning.smallest_step_ut.powi(2);
        let usage = if step.resting {
            SampleUse::AtRest
        } else if is_open || is_blind {
            SampleUse::Compared
        } else if gated {
            SampleUse::Gated
        } else {
            SampleUse::Used
        };
        self.judged = Some(Judged::by(&innovation, usage));
        if is_blind && !is_open {
            running.watch.since_ns = step.time_ns;
            running.watch.misfit_ut = innovation.v.norm();
            self.begin_trial(true);
            return self.run_trial(step);
        }
        if is_open {
            return self.run_trial(step);
        }
        if !step.resting {
            if !gated {
                let before_ut = filter.part(HARD_IRON);
                filter.update(&innovation, NONE);
                let variance_ut2 = filter.variances(HARD_IRON).sum();
                let correction_ut = filter.part(HARD_IRON) - before_ut;
                self.adaptation.walk(&correction_ut, variance_ut2, step.dt_s, &self.tuning);
                if let Some(difference_ut) = unevenness(step, &filter.parts()) {
                    self.adaptation.uneven(&difference_ut, step.dt_s, &self.tuning);
                }
            }
            self.adaptation.local(&innovation, step.motion, step.dt_s, &self.tuning);
        }
        if running.watch.share > self.tuning.suspect_share {
            self.begin_trial(false);
        }
    }

    /// The hypotheses start from the filter, after a pause (`blind`) without a former calibration.
    fn begin_trial(&mut self, blind: bool) {
        let Some(running) = self.phase.running() else { return };
        let former = self.former.as_ref().filter(|_| !blind);
        let mut trial = Trial::start(&running.filter, &running.watch, former, &self.tuning);
        trial.blind = blind;
        trial.young = running.moved_s < self.tuning.settled_s;
        self.phase.doubt(trial);
    }

    /// One sample while the hypotheses run; the filter is as it was, predicted.
    fn run_trial(&mut self, step: &Step<'_>) {
        let Phase::Undecided(Running { filter, watch, earth, .. }, trial) = &mut self.phase else { return };
        let verdict = trial.step(step, filter, watch, self.former.as_ref(), &self.tuning);
        let since_ns = trial.onset_ns;
        let event = |kind| Some(Event { kind, since_ns, decided_ns: step.time_ns });
        match verdict {
            Verdict::Device => {
                let winner = &trial.device;
                let moved_ut = winner.part(HARD_IRON) - filter.part(HARD_IRON);
                // less than half a step is an error of one's own; after a pause b may have walked
                let least_ut = self.tuning.smallest_step_ut * if trial.blind { 1.0 } else { 0.5 };
                if !trial.young && moved_ut.norm() > least_ut {
                    let kind = if trial.recalled { EventKind::DeviceStepBack } else { EventKind::DeviceStep };
                    self.event = event(kind);
                    self.former = Some(Former::of(filter));
                }
                if trial.was_place {
                    *earth = Some(Earth::of(filter, earth.as_ref(), trial.onset_ns));
                }
                return self.go_on_with(|trial| trial.device);
            }
            Verdict::Unchanged => return self.go_on_with(|trial| trial.place),
            Verdict::NewPlace | Verdict::Place => {
                if verdict == Verdict::Place {
                    self.event = event(EventKind::PlaceChanged);
                }
                let back = earth.as_ref().is_some_and(|it| it.is_that_of(&trial.place, filter, &self.tuning));
                if back {
                    *earth = None;
                } else if verdict == Verdict::NewPlace {
                    *earth = Some(Earth::of(filter, earth.as_ref(), trial.onset_ns));
                }
                if back || verdict == Verdict::NewPlace {
                    return self.go_on_with(|trial| trial.place);
                }
            }
            Verdict::Open => {}
        }
        if !trial.blind && watch.share < 0.5 * self.tuning.suspect_share {
            if trial.is_place {
                // it fits again, perhaps by chance: the field is not trusted to be even at once
                self.adaptation.local_ut = self.tuning.local_max_ut;
            }
            self.phase.decide(None); // nothing happened, or it is over
        }
    }

    /// A hypothesis has won: it is the filter from here on.
    fn go_on_with(&mut self, winner: fn(Trial) -> Filter) {
        self.phase.decide(Some(winner));
        self.adaptation.restart_walk(Vector3::zeros(), f64::MAX);
    }
}

/// What c and f differ by.
fn unevenness(step: &Step<'_>, x: &Parts) -> Option<Vector3<f64>> {
    let still = x.corrected(step.raw_ut)?.field_ut;
    let rate = x.true_rate(step.rate_rad_s);
    Some(still - rate.cross(&still) * x.delay - x.field)
}
