//! While samples do not fit: the hypotheses begin, run, and end.
//!
//! ```text
//! device     the filter goes on as `device`, on `probation`; told, if b moved by half of the least step, after a pause by all of it
//! place      told; the filter stays as it was, for 30 s or until the samples fit it again
//! new place  the filter goes on as `place`, and the Earth's field is carried beside it
//! unchanged  after a pause: the filter goes on as `place`, nothing is told
//! neither    both hypotheses start anew
//! ```
//! A trial ends where `device`, a new place or unchanged wins, where the Earth's field that is carried is found again, and where the filter as it was fits again
//! (not after a pause). The chain of rotations ends it too (`start`), and a filter that is not finite (`learn`). Source: docs/dev/METHOD-AIDED.md, Changes.

use super::bursts::Bursts;
use super::earth::Earth;
use super::events::{Began, Trial, Verdict};
use super::phase::Phase;
use super::probation::Probation;
use super::quarantine::Quarantine;
use super::running::Running;
use super::state::{FIELD, Filter};
use super::step::FrameStep;
use super::tuning::Tuning;
use super::watch::Former;
use crate::estimator::answer::Told;
use crate::reading::{Event, EventKind};
use nalgebra::Vector3;

/// What is known of changes beside the hypotheses themselves.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Changes {
    /// The latest that was told.
    pub(super) event: Option<Event>,
    told: Option<Told>,
    /// The calibration from before it.
    pub(super) former: Option<Former>,
    pub(super) probation: Option<Probation>,
    pub(super) bursts: Bursts,
}

impl Changes {
    /// A start, which carries no filter from before it.
    pub(super) fn start(&mut self) {
        self.probation = None;
    }

    /// The chain of rotations broke before this sample: no later one can test a change on probation, so it is told now.
    pub(super) fn break_chain(&mut self, phase: &Phase, latest_ns: Option<i64>, tuning: &Tuning) {
        if let Some(time_ns) = latest_ns {
            self.confirm(phase, time_ns, tuning);
        }
    }

    /// Predicts the kept filters over a frame; a change whose probation ends is told.
    pub(super) fn turn(&mut self, phase: &mut Phase, step: &FrameStep, tuning: &Tuning) {
        if self.probation.as_mut().is_some_and(|it| it.step(step, tuning)) {
            self.confirm(phase, step.time_ns, tuning);
        }
        if let Phase::Running(_, quarantine) = phase {
            quarantine.turn(step);
        }
    }

    /// What the calibration from before the latest change leaves of a frame, uT.
    pub(super) fn former_residual(&self, step: &FrameStep, filter: &Filter) -> Option<Vector3<f64>> {
        self.former.as_ref().map(|former| former.residual(&step.raw_ut, &filter.part(FIELD)))
    }

    /// A frame was gated, or not.
    pub(super) fn pass(&mut self, is_gated: bool, step: &FrameStep, tuning: &Tuning) {
        if !step.resting {
            self.bursts.pass(is_gated, step.dt_s, tuning);
        }
    }

    /// Variance per axis of what bursts leave in samples that fit, uT^2.
    pub(super) fn left_ut2(&self, tuning: &Tuning) -> f64 {
        self.bursts.left_ut2(tuning)
    }

    /// Where many samples of late were misfits what was learned last is taken back, and the hypotheses begin.
    pub(super) fn look_at_misfits(&mut self, phase: &mut Phase, step: &FrameStep, tuning: &Tuning) {
        let Phase::Running(running, quarantine) = phase else { return };
        if running.watch.share > tuning.suspect_share {
            self.take_back(running, quarantine, step, tuning);
            self.begin_trial(phase, Began::Misfit, tuning);
        } else if running.watch.share < 0.5 * tuning.suspect_share {
            quarantine.learned(&running.filter, step.dt_s, tuning);
        }
    }

    fn take_back(&mut self, running: &mut Running, quarantine: &mut Quarantine, step: &FrameStep, tuning: &Tuning) {
        if let Some(probation) = self.probation.take() {
            probation.take_back(running);
            self.bursts.was_the_place();
        } else if tuning.quarantine
            && !step.resting
            && let Some(proven) = quarantine.take_back(&step.noise)
        {
            running.filter = proven;
        }
    }

    /// The hypotheses start from the filter.
    pub(super) fn begin_trial(&mut self, phase: &mut Phase, began: Began, tuning: &Tuning) {
        let Phase::Running(running, _) = phase else { return };
        // after a pause the turn alone may have been wrong: it is no time to recall
        let former = self.former.as_ref().filter(|_| began != Began::Pause);
        let mut trial = Trial::start(running, &running.filter, former, tuning);
        (trial.began, trial.hold_s) = (began, self.bursts.hold_s(tuning));
        if began != Began::Pause {
            self.bursts.begin();
        }
        *phase = Phase::Undecided(core::mem::take(running), trial);
    }

    /// One frame while the hypotheses run; the filter is as it was, predicted.
    pub(super) fn run_trial(&mut self, phase: &mut Phase, step: &FrameStep, tuning: &Tuning) {
        let Phase::Undecided(running, trial) = phase else { return };
        match trial.step(step, running, self.former.as_ref(), tuning) {
            Verdict::Device => return self.take_device(phase, step.time_ns, tuning),
            Verdict::Unchanged => {
                self.bursts.was_the_place();
                return phase.decide(Some(|trial| &trial.place));
            }
            Verdict::Place => {
                let (kind, since_ns) = (EventKind::PlaceChanged, trial.onset_ns);
                self.event = Some(Event { kind, since_ns, decided_ns: step.time_ns });
                if self.take_place(phase, false, tuning) {
                    return;
                }
            }
            Verdict::NewPlace => {
                self.take_place(phase, true, tuning);
                return;
            }
            Verdict::Neither => {
                // what did not fit so far was the place's doing; what does not from here on is open
                self.bursts.was_the_place();
                self.bursts.begin();
                trial.hold_s = self.bursts.hold_s(tuning);
            }
            Verdict::Open => {}
        }
        let Phase::Undecided(running, trial) = &*phase else { return };
        if trial.began != Began::Pause && running.watch.share < 0.5 * tuning.suspect_share {
            self.bursts.was_the_place();
            phase.decide(None); // nothing happened, or it is over
        }
    }

    /// `device` has won. After a pause, or a change of the place, the filter as it was is nothing to go back to: it is told at once.
    fn take_device(&mut self, phase: &mut Phase, time_ns: i64, tuning: &Tuning) {
        let Phase::Undecided(running, trial) = phase else { return };
        let (began, since_ns) = (trial.began, trial.onset_ns);
        let told = trial.device_event(&running.filter, tuning);
        let told = told.map(|kind| Event { kind, since_ns, decided_ns: time_ns });
        self.probation = Some(Probation::new(running, told, since_ns));
        if began == Began::ChangedPlace {
            running.carry_earth(since_ns, tuning);
        }
        phase.decide(Some(|trial| &trial.device));
        if began != Began::Misfit || !tuning.probation {
            self.confirm(phase, time_ns, tuning);
        }
    }

    /// `place` has won; whether the filter goes on as it: where it has lasted, or is the usual place again.
    fn take_place(&mut self, phase: &mut Phase, is_new: bool, tuning: &Tuning) -> bool {
        let Phase::Undecided(running, trial) = phase else { return false };
        self.bursts.was_the_place();
        let is_earth = |earth: &mut Earth| earth.is_that_of(&trial.place, &running.filter, tuning);
        let is_back = running.earth.take_if(is_earth).is_some();
        if is_new && !is_back {
            running.carry_earth(trial.onset_ns, tuning);
        }
        if is_new || is_back {
            phase.decide(Some(|trial| &trial.place));
        }
        is_new || is_back
    }

    /// A change that is on probation has held, or nothing more will be seen of it: the change is told.
    pub(super) fn confirm(&mut self, phase: &Phase, time_ns: i64, tuning: &Tuning) {
        let Some(probation) = self.probation.take() else { return };
        self.bursts.was_the_device();
        let Some(now) = phase.running().map(|it| &it.filter) else { return };
        if let Some((told, event)) = probation.held(now, self.told, time_ns) {
            self.told = Some(told);
            self.event = event.or(self.event);
            self.former = tuning.recall.then(|| probation.former());
        }
    }
}
