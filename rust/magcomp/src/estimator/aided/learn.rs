//! One sample with a known rotation: the field turns, and once a frame of them is full: predict, gate, rest, hypotheses or update, adopt.
//!
//! ```text
//! v = raw - h(x);  gated when v^T S^-1 v > 16, or |d|^2 > 16 max(U, 2 uT)^2
//! at rest: no magnetometer update, the rate measures the bias
//! undecided or disturbed: the calibration holds, the hypotheses run
//! else update, unless gated; learn the noises
//! ```
//! Source: docs/dev/METHOD-AIDED.md.

use nalgebra::Vector3;

use super::Aided;
use super::measure::{Innovation, Judged, NONE};
use super::phase::{Phase, Running};
use super::state::{FIELD, HARD_IRON, LOCAL, Parts};
use super::step::Step;
use crate::estimator::answer::Answer;
use crate::explanation::SampleUse;
use crate::math::elementary::exp;
use crate::math::turn::Turn;
use crate::reading::Status;

impl Aided {
    /// One sample with a rotation.
    #[inline(always)]
    pub(super) fn with_rotation(&mut self, step: &Step<'_>) -> (Status, Answer) {
        match self.phase {
            Phase::Starting(_) => self.collect(step),
            Phase::Running(_) | Phase::Undecided(..) => self.learn(step),
        }
        if let Phase::Running(running) | Phase::Undecided(running, _) = &mut self.phase {
            running.regain_strength(&self.tuning);
            if !running.filter.is_finite() {
                self.begin(None);
            }
        }
        (self.status(), self.published(step).unwrap_or_default())
    }

    /// The start's part of one sample.
    fn collect(&mut self, step: &Step<'_>) {
        let Phase::Starting(first) = &mut self.phase else { return };
        first.turn(step);
        // nothing else is known of the mean of several
        self.adaptation.mean = self.adaptation.sample.clone();
        if let Some(variance) = step.bias_variance {
            first.rest(step.rate_rad_s, variance);
        }
        let is_pooled = !step.is_blank && (!step.resting || (first.given.is_some() && first.is_blind()));
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
        let (Phase::Running(running) | Phase::Undecided(running, _)) = &mut self.phase else { return };
        if step.dt_s > self.tuning.walk_s {
            running.drift(step.dt_s, &self.tuning);
        }
        let filter = &mut running.filter;
        if let Some(earth) = &mut running.earth {
            earth.step(step, filter, &self.tuning);
        }
        filter.turn(&step.turn, exp(-step.dt_s / step.noise.local_time_s));
        let delay_s = filter.delay_s();
        if let Some(whole) = self.frame.add(&step.piece(), running.is_lost()) {
            let delayed_rad_s = self.recent.mean_rad_s(delay_s + whole.late_s).filter(|_| self.tuning.recent);
            let rate_rad_s = whole.increment_rad / whole.length_s;
            self.learn_whole(&step.of_frame(&whole, &whole.raw_ut.unwrap_or_default(), &rate_rad_s, delayed_rad_s));
        }
    }

    /// The filter's part of a frame.
    fn learn_whole(&mut self, step: &Step<'_>) {
        let is_open = self.phase.trial().is_some();
        let (Phase::Running(running) | Phase::Undecided(running, _)) = &mut self.phase else { return };
        let filter = &mut running.filter;
        let x = filter.parts();
        let turn = Turn::by(&-x.turned(step.increment_rad, step.dt_s));
        filter.spread(&turn, step.increment_rad, step.dt_s, &step.noise);
        let sigma_ut = self.adaptation.mean.sigma_ut();
        let step = &Step { sigma_ut, ..*step };
        if step.is_blank {
            self.adaptation.mean.pass(&turn.rotation);
        } else {
            let memory_s = self.tuning.settled_s;
            self.adaptation.mean.step(step.raw_ut, &x, &turn.rotation, step.dt_s, memory_s, &self.tuning);
        }
        self.quarantine.turn(step);
        if step.is_blank {
            if let Phase::Undecided(_, trial) = &mut self.phase {
                trial.turn(step);
            }
            self.judged = Some(Judged::alone(SampleUse::Unused));
            return;
        }
        let Some(innovation) = filter.innovation(step, &self.tuning) else {
            self.judged = Some(Judged::alone(SampleUse::Unused));
            return;
        };
        // the local deviation swallows what changes slowly: beyond what is left to a place, it is none
        let local_ut = filter.part(LOCAL);
        let gated = innovation.nis > self.tuning.gate
            || self.tuning.local_gate
                && local_ut.norm_squared() > self.tuning.gate * self.adaptation.largest_local_ut2(&self.tuning);
        let unexplained_ut = innovation.v + local_ut;
        let field = filter.part(FIELD);
        let former = self.former.as_ref().map(|f| f.residual(step.raw_ut, &field));
        running.watch.step(step, gated.then_some(&unexplained_ut), former, is_open, &self.tuning);
        if !step.resting {
            self.bursts.pass(gated, step.dt_s, &self.tuning);
        }
        let filter = &mut running.filter;
        if let Some(variance) = step.bias_variance {
            filter.update_bias(step.rate_rad_s, variance);
        }
        // after a pause it is not known where the field points: both are tried
        let is_blind = running.is_lost();
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
            running.watch.begin(step.time_ns, innovation.v.norm());
            self.begin_trial(true);
            return self.run_trial(step);
        }
        if is_open {
            return self.run_trial(step);
        }
        if usage != SampleUse::AtRest {
            self.absorb(step, &innovation, usage);
        }
        let Phase::Running(running) = &mut self.phase else { return };
        if running.watch.share > self.tuning.suspect_share {
            if self.tuning.quarantine
                && !step.resting
                && let Some(proven) = self.quarantine.take_back(&step.noise)
            {
                running.filter = proven;
            }
            self.begin_trial(false);
        } else if running.watch.share < 0.5 * self.tuning.suspect_share {
            self.quarantine.learned(&running.filter, step.dt_s, &self.tuning);
        }
    }

    /// A sample in motion while nothing is in doubt: it corrects the filter unless it is gated, and shows the noises.
    fn absorb(&mut self, step: &Step<'_>, innovation: &Innovation, usage: SampleUse) {
        let Phase::Running(Running { filter, .. }) = &mut self.phase else { return };
        if usage == SampleUse::Used {
            let before_ut = filter.part(HARD_IRON);
            filter.update(innovation, NONE);
            let variance_ut2 = filter.variances(HARD_IRON).sum();
            let correction_ut = filter.part(HARD_IRON) - before_ut;
            self.adaptation.walk(&correction_ut, variance_ut2, step.dt_s, &self.tuning);
            if let Some(difference_ut) = unevenness(step, &filter.parts()) {
                self.adaptation.uneven(&difference_ut, step.dt_s, &self.tuning);
            }
        }
        self.adaptation.local(innovation, step.motion, step.dt_s, &self.tuning);
    }
}

/// What c and f differ by.
fn unevenness(step: &Step<'_>, x: &Parts) -> Option<Vector3<f64>> {
    let still = x.corrected(step.raw_ut)?.field_ut;
    Some(Turn::by(&-(x.true_rate(&step.delayed_rad_s) * (x.delay + step.late_s))).rotation * still - x.field)
}
