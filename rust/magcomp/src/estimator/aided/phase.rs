//! What the estimator is doing: one owner for the start, the filter and the hypotheses, so that there is never more than belongs together.
//!
//! ```text
//! Starting  --the samples alone know b-->  Running  --samples do not fit, or a pause-->  Undecided
//! Running   <--decided, or it was nothing--  Undecided
//! Running   <--the chain of rotations breaks--  Undecided
//! Starting  <--a long gap, a state that is not finite--  Running, Undecided
//! ```

use super::events::Trial;
use super::first_fit::FirstFit;
use super::quarantine::Quarantine;
use super::running::Running;
use super::state::Filter;
use super::tuning::Tuning;
use super::watch::Watch;

/// See the module.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[expect(clippy::large_enum_variant, reason = "it is overwritten in place: a box would allocate")]
pub(super) enum Phase {
    /// No calibration that live samples have confirmed.
    Starting(FirstFit),
    /// The filter follows the samples. What it has learned last is in quarantine, whose copies are of a filter that hypotheses may refute.
    Running(Running, Quarantine),
    /// Samples do not fit the filter, which is predicted, and learns its bias at rest, while the hypotheses run.
    Undecided(Running, Trial),
}

impl Phase {
    pub(super) fn running(&self) -> Option<&Running> {
        match self {
            Self::Starting(_) => None,
            Self::Running(running, _) | Self::Undecided(running, _) => Some(running),
        }
    }

    pub(super) fn running_mut(&mut self) -> Option<&mut Running> {
        match self {
            Self::Starting(_) => None,
            Self::Running(running, _) | Self::Undecided(running, _) => Some(running),
        }
    }

    /// The filter, or what a start knows so far.
    pub(super) fn known(&self) -> Option<&Filter> {
        if let Self::Starting(first) = self { first.answer.as_ref() } else { self.running().map(|it| &it.filter) }
    }

    pub(super) fn trial(&self) -> Option<&Trial> {
        if let Self::Undecided(_, trial) = self { Some(trial) } else { None }
    }

    /// |m| while it is not known where the field points: that of before the chain of rotations broke, or of a given calibration.
    pub(super) fn lost_strength_ut(&self) -> Option<f64> {
        match self {
            Self::Starting(first) => first.given.as_ref().filter(|_| first.is_blind()).map(|given| given.strength_ut),
            Self::Running(running, _) | Self::Undecided(running, _) => running.lost_strength_ut,
        }
    }

    /// Goes from `Undecided` to `Running`, with the filter that `winner` is, if one has won.
    pub(super) fn decide(&mut self, winner: Option<fn(&Trial) -> &Filter>) {
        let Self::Undecided(running, trial) = self else { return };
        if let Some(winner) = winner {
            running.filter.clone_from(winner(trial));
            running.watch = Watch::default();
        }
        self.run();
    }

    /// Goes to `Starting`, where nothing is known but perhaps the strength of the field, uT. Not inlined, as are others that move much: what they move is off
    /// the stack while a start is worked out.
    #[inline(never)]
    pub(super) fn start(&mut self, known_ut: Option<f64>, tuning: &Tuning) {
        *self = Self::Starting(FirstFit::new(known_ut, tuning));
    }

    /// Goes to `Running`, as the filter is; nothing is in quarantine.
    pub(super) fn run(&mut self) {
        match self {
            Self::Starting(_) => {}
            Self::Running(_, quarantine) => *quarantine = Quarantine::default(),
            Self::Undecided(running, _) => *self = Self::Running(core::mem::take(running), Quarantine::default()),
        }
    }
}
