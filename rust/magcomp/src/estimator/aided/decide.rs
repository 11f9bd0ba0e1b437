//! While samples do not fit: the hypotheses begin, run, and end.
//!
//! ```text
//! device     the filter goes on as `device`, on `probation`; told, if b moved by half of the least step
//! place      told; the filter stays as it was, for 30 s or until the samples fit it again
//! new place  the filter goes on as `place`, and the Earth's field is carried beside it
//! ```
//! Source: docs/dev/METHOD-AIDED.md, Changes.

use super::Aided;
use super::earth::Earth;
use super::events::{Began, Trial, Verdict};
use super::phase::Phase;
use super::probation::Probation;
use super::quarantine::Quarantine;
use super::state::Filter;
use super::step::FrameStep;
use crate::reading::{Event, EventKind};

impl Aided {
    /// The hypotheses start from the filter.
    pub(super) fn begin_trial(&mut self, began: Began) {
        let Phase::Running(running) = &self.phase else { return };
        // after a pause the turn alone may have been wrong: it is no time to recall
        let former = self.former.as_ref().filter(|_| began != Began::Pause);
        let mut trial = Trial::start(running, &running.filter, former, &self.tuning);
        (trial.began, trial.hold_s) = (began, self.bursts.hold_s(&self.tuning));
        self.bursts.begin();
        if let Phase::Running(running) = self.phase.take() {
            self.phase = Phase::Undecided(running, trial);
        }
    }

    /// One sample while the hypotheses run; the filter is as it was, predicted.
    pub(super) fn run_trial(&mut self, step: &FrameStep) {
        let Phase::Undecided(running, trial) = &mut self.phase else { return };
        match trial.step(step, running, self.former.as_ref(), &self.tuning) {
            Verdict::Device => return self.take_device(step.time_ns),
            Verdict::Unchanged => {
                self.bursts.was_the_place();
                return self.go_on_with(|trial| trial.place);
            }
            Verdict::Place => {
                let (kind, since_ns) = (EventKind::PlaceChanged, trial.onset_ns);
                self.event = Some(Event { kind, since_ns, decided_ns: step.time_ns });
                if self.take_place(false) {
                    return;
                }
            }
            Verdict::NewPlace => {
                self.take_place(true);
                return;
            }
            Verdict::Neither => {
                self.bursts.begin();
                self.bursts.was_the_place();
                trial.hold_s = self.bursts.hold_s(&self.tuning);
            }
            Verdict::Open => {}
        }
        let Phase::Undecided(running, trial) = &self.phase else { return };
        if trial.began != Began::Pause && running.watch.share < 0.5 * self.tuning.suspect_share {
            self.bursts.was_the_place();
            self.phase.decide(None); // nothing happened, or it is over
        }
    }

    /// `device` has won. After a pause, or a change of the place, the filter as it was is nothing to go back to: it is told at once.
    fn take_device(&mut self, time_ns: i64) {
        let Phase::Undecided(running, trial) = &mut self.phase else { return };
        let (began, since_ns) = (trial.began, trial.onset_ns);
        let told = trial.device_event(&running.filter, &self.tuning);
        let told = told.map(|kind| Event { kind, since_ns, decided_ns: time_ns });
        self.probation = Some(Probation::new(running, told, since_ns));
        if began == Began::ChangedPlace {
            running.carry_earth(since_ns, &self.tuning);
        }
        self.go_on_with(|trial| trial.device);
        if began != Began::Misfit || !self.tuning.probation {
            self.confirm(time_ns);
        }
    }

    /// `place` has won; whether the filter goes on as it: where it has lasted, or is the usual place again.
    fn take_place(&mut self, is_new: bool) -> bool {
        let Phase::Undecided(running, trial) = &mut self.phase else { return false };
        self.bursts.was_the_place();
        let is_earth = |earth: &mut Earth| earth.is_that_of(&trial.place, &running.filter, &self.tuning);
        let is_back = running.earth.take_if(is_earth).is_some();
        if is_new && !is_back {
            running.carry_earth(trial.onset_ns, &self.tuning);
        }
        if is_new || is_back {
            self.go_on_with(|trial| trial.place);
        }
        is_new || is_back
    }

    /// A change that is on probation has held, or nothing more will be seen of it: it is told.
    pub(super) fn confirm(&mut self, time_ns: i64) {
        let Some(probation) = self.probation.take() else { return };
        self.bursts.was_the_device();
        let Some(now) = self.phase.running().map(|it| &it.filter) else { return };
        if let Some((told, event)) = probation.held(now, self.told, time_ns) {
            self.told = Some(told);
            self.event = event.or(self.event);
            self.former = self.tuning.recall.then(|| probation.former());
        }
    }

    /// The same at the time of the latest sample.
    pub(super) fn confirm_latest(&mut self) {
        if let Some(time_ns) = self.last_ns {
            self.confirm(time_ns);
        }
    }

    /// A hypothesis has won: it is the filter from here on.
    fn go_on_with(&mut self, winner: fn(Trial) -> Filter) {
        self.phase.decide(Some(winner));
        self.quarantine = Quarantine::default();
    }
}
