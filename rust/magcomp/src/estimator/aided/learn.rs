//! One sample with a known rotation. The gyroscope turns the field at every sample. When a frame is full the filter predicts, tests the innovation,
//! then compares hypotheses or updates, and learns the noise.
//!
//! ```text
//! v = raw - h(x);  gated when v^T S^-1 v > 16, or |d|^2 > 16 max(U_q, 2 uT)^2        U_q^2: what the quick mean leaves, the first part of U^2 (`adapt`)
//! at rest: no magnetometer update, the rate measures the bias
//! undecided or disturbed: the calibration holds, the hypotheses run
//! else update, unless gated; learn the noises
//! ```

use super::Aided;
use super::events::Began;
use super::measure::{Innovation, NONE};
use super::phase::Phase;
use super::propagate::ProcessNoise;
use super::quarantine::Quarantine;
use super::running::Running;
use super::state::{DELAY, FIELD, LOCAL};
use super::step::{FrameStep, Step};
use crate::estimator::answer::Answer;
use crate::explanation::{InnovationTest, SampleUse};
use crate::math::elementary::exp;
use crate::math::turn::Turn;
use crate::reading::Status;
use crate::sensing::frame::Piece;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;

impl Aided {
    /// One sample with a rotation.
    #[inline(always)]
    pub(super) fn with_rotation(&mut self, step: &Step, answer: &mut Answer) -> Status {
        match self.phase {
            Phase::Starting(_) => self.collect(step),
            Phase::Running(..) | Phase::Undecided(..) => self.learn(step),
        }
        if let Some(running) = self.phase.running_mut() {
            // the first sample of a new chain of rotations has told where the field points; it is as strong as it was before
            if let Some(strength_ut) = running.lost_strength_ut.take_if(|_| !step.is_blank) {
                running.filter.update_strength(strength_ut, self.tuning.adopt_sd_ut.powi(2));
            }
            // a sample turns m, and a frame alone changes the rest
            let is_finite = if self.frame.is_empty() {
                running.filter.is_finite()
            } else {
                running.filter.part(FIELD).sum().is_finite()
            };
            if !is_finite {
                self.begin(None);
            }
        }
        self.publish(step, answer);
        self.status()
    }

    /// The start's part of one sample.
    #[inline(never)]
    fn collect(&mut self, step: &Step) {
        let Phase::Starting(first) = &mut self.phase else { return };
        first.turn(step);
        // nothing else is known of the mean of several
        self.adaptation.mean = self.senses.white.clone();
        if let Some(variance) = step.bias_variance {
            first.rest(&step.rate_rad_s, variance);
        }
        let is_pooled = !step.is_blank && (!step.resting || (first.given.is_some() && first.is_blind()));
        if is_pooled {
            first.add(step, self.senses.motion.up.as_ref(), &self.tuning);
        }
        self.judged = Some((if is_pooled { SampleUse::Pooled } else { SampleUse::AtRest }, None));
        self.settle();
    }

    /// A start ends where the samples alone know enough.
    #[inline(never)]
    fn settle(&mut self) {
        let Phase::Starting(first) = &mut self.phase else { return };
        if let Some(filter) = first.answer.take_if(|_| first.is_settled) {
            self.phase = Phase::Running(Running { filter, ..Running::default() }, Quarantine::default());
        }
    }

    /// The filter's part of one sample.
    fn learn(&mut self, step: &Step) {
        let Some(running) = self.phase.running_mut() else { return };
        if step.dt_s > self.tuning.gap_s {
            running.drift(step.dt_s, &self.tuning);
        }
        let filter = &mut running.filter;
        if let Some(earth) = &mut running.earth {
            earth.step(step, filter, &self.tuning);
        }
        filter.turn(&step.turn, exp(-step.dt_s / step.noise.local_time_s));
        let delay_s = filter.part(DELAY).x;
        let piece = Piece {
            increment_rad: step.increment_rad,
            dt_s: step.dt_s,
            bridged_rad2: step.noise.bridged_rad2,
            raw_ut: (!step.is_blank).then_some(step.raw_ut),
            late_s: step.late_s,
            up_m_s2: None,
        };
        let Some(whole) = self.frame.add(&piece, running.lost_strength_ut.is_some()) else { return };
        let delayed_rad_s = self.senses.mean_rad_s(delay_s + whole.late_s, &self.tuning);
        let rate_rad_s = whole.increment_rad / whole.length_s;
        self.learn_frame(&FrameStep {
            time_ns: step.time_ns,
            raw_ut: whole.raw_ut.unwrap_or_default(),
            is_blank: whole.raw_ut.is_none(),
            rate_rad_s,
            delayed_rad_s: delayed_rad_s.unwrap_or(rate_rad_s),
            increment_rad: whole.increment_rad,
            angle_rad: whole.increment_rad.norm(),
            dt_s: whole.length_s,
            noise: ProcessNoise { bridged_rad2: whole.bridged_rad2, ..step.noise },
            sigma_ut: self.adaptation.mean.sigma_ut(),
            late_s: whole.late_s,
            resting: step.resting,
            bias_variance: step.bias_variance.map(|variance| variance * step.dt_s / whole.length_s),
            motion: step.motion,
        });
    }

    /// The filter's part of a frame: predict, test, then decide between hypotheses or absorb it.
    fn learn_frame(&mut self, step: &FrameStep) {
        let is_open = self.phase.trial().is_some();
        self.changes.turn(&mut self.phase, step, &self.tuning);
        self.predict(step);
        if step.is_blank {
            if let Phase::Undecided(_, trial) = &mut self.phase {
                trial.turn(step);
            }
            return;
        }
        let Some(running) = self.phase.running_mut() else { return };
        let Some(innovation) = &running.filter.innovation(step, &self.tuning) else { return };
        let is_gated = self.test(step, innovation, is_open);
        let Some(running) = self.phase.running_mut() else { return };
        // after a pause it is not known where the field points: both are tried
        let is_blind = running.lost_strength_ut.is_some();
        let usage = match (step.resting, is_open || is_blind, is_gated) {
            (true, ..) => SampleUse::AtRest,
            (_, true, _) => SampleUse::Compared,
            (.., true) => SampleUse::Gated,
            _ => SampleUse::Used,
        };
        let told = InnovationTest {
            innovation_ut: innovation.v,
            expected_ut: innovation.variance_ut2.map(f64::sqrt),
            ratio: innovation.nis / self.tuning.gate,
        };
        self.judged = Some((usage, Some(told)));
        if is_blind && !is_open {
            running.watch.begin(step.time_ns, innovation.v.norm());
            self.changes.begin_trial(&mut self.phase, Began::Pause, &self.tuning);
        }
        if is_open || is_blind {
            return self.changes.run_trial(&mut self.phase, step, &self.tuning);
        }
        if usage == SampleUse::Used {
            self.absorb(step, innovation);
        }
        if !step.resting {
            self.adaptation.add_innovation(innovation, step.motion, step.dt_s, &self.tuning);
        }
        self.changes.look_at_misfits(&mut self.phase, step, &self.tuning);
    }

    /// What is known follows the device's turn.
    fn predict(&mut self, step: &FrameStep) {
        self.judged = Some((SampleUse::Unused, None));
        let Some(running) = self.phase.running_mut() else { return };
        let filter = &mut running.filter;
        let x = filter.parts();
        let turn = Turn::by(&-x.turned(&step.increment_rad, step.dt_s));
        filter.spread(&turn, &step.increment_rad, step.dt_s, &step.noise);
        let raw_ut = (!step.is_blank).then_some(&step.raw_ut);
        let memory_s = self.tuning.settled_s;
        self.adaptation.mean.step(raw_ut, &x, &turn.rotation, step.dt_s, memory_s, &self.tuning);
    }

    /// Whether the gate refuses a frame of this innovation.
    fn test(&mut self, step: &FrameStep, innovation: &Innovation, is_open: bool) -> bool {
        let Some(running) = self.phase.running_mut() else { return false };
        let filter = &mut running.filter;
        // a slow change hides in d. Once d is larger than a place explains, it is a misfit
        let local_ut = filter.part(LOCAL);
        let most_ut2 = self.tuning.gate * self.adaptation.largest_local_ut2(&self.tuning);
        let is_gated =
            innovation.nis > self.tuning.gate || self.tuning.local_gate && local_ut.norm_squared() > most_ut2;
        let unexplained_ut = innovation.v + local_ut;
        let former = self.changes.former_residual(step, filter);
        running.watch.step(step, is_gated.then_some(&unexplained_ut), former, is_open, &self.tuning);
        self.changes.pass(is_gated, step, &self.tuning);
        if let Some(variance) = step.bias_variance {
            filter.update_bias(&step.rate_rad_s, variance);
        }
        is_gated
    }

    /// Corrects the filter by a frame that fits, and `up` and the noise levels by what that teaches.
    fn absorb(&mut self, step: &FrameStep, innovation: &Innovation) {
        let Phase::Running(Running { filter, .. }, _) = &mut self.phase else { return };
        let carried = filter.part(FIELD);
        filter.update(innovation, NONE);
        let corrected = filter.part(FIELD);
        let field_ut2 = filter.variances(FIELD).sum() / 3.0
            * self.adaptation.factor(&step.noise, step.dt_s, &self.tuning)
            + self.adaptation.unaveraged_ut2(&self.tuning);
        let turn_rad = carried.cross(&corrected) / corrected.norm_squared();
        self.senses.motion.follow(&turn_rad, field_ut2 / corrected.norm_squared(), &self.tuning);
        let x = filter.parts();
        if let Some((_, still)) = x.corrected(&step.raw_ut) {
            let late_rad = x.true_rate(&step.delayed_rad_s) * (x.delay + step.late_s);
            let c = Turn::by(&-late_rad).rotation * still;
            self.adaptation.add_difference(&(c - x.field), step.dt_s, &self.tuning);
        }
    }
}
