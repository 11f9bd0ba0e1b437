//! What the estimator is doing: one owner for the start, the filter and the hypotheses, so that there is never more than belongs together.
//!
//! ```text
//! Starting  --the samples alone know b-->  Running  --samples do not fit, or a pause-->  Undecided
//! Running   <--decided, or it was nothing--  Undecided
//! Starting  <--a long gap, a state that is not finite--  Running, Undecided
//! ```

use nalgebra::{Matrix3, Vector3};

use super::earth::Earth;
use super::events::Trial;
use super::first_fit::FirstFit;
use super::state::{FIELD, Filter, HARD_IRON, LOCAL};
use super::tuning::Tuning;
use super::watch::Watch;
use crate::strength::STRONGEST_AXIS_UT;

/// See the module.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[expect(clippy::large_enum_variant, reason = "it is overwritten in place: a box would allocate")]
pub(super) enum Phase {
    /// No calibration that live samples have confirmed.
    Starting(FirstFit),
    /// The filter follows the samples.
    Running(Running),
    /// Samples do not fit the filter, which stays as it was while the hypotheses run.
    Undecided(Running, Trial),
}

/// The filter and what belongs to it.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Running {
    pub(super) filter: Filter,
    pub(super) watch: Watch,
    /// The Earth's field, while that of the place is another.
    pub(super) earth: Option<Earth>,
    /// |m| before the chain of rotations broke, while it is not known where the field points.
    pub(super) lost_strength_ut: Option<f64>,
}

impl Phase {
    /// The filter and what belongs to it.
    pub(super) fn running(&self) -> Option<&Running> {
        match self {
            Self::Starting(_) => None,
            Self::Running(running) | Self::Undecided(running, _) => Some(running),
        }
    }

    /// The filter, or what a start knows so far.
    pub(super) fn known(&self) -> Option<&Filter> {
        if let Self::Starting(first) = self { first.answer.as_ref() } else { self.running().map(|it| &it.filter) }
    }

    /// The hypotheses.
    pub(super) fn trial(&self) -> Option<&Trial> {
        if let Self::Undecided(_, trial) = self { Some(trial) } else { None }
    }

    /// |m| while it is not known where the field points: that of before the chain of rotations broke, or of a given calibration.
    pub(super) fn lost_strength_ut(&self) -> Option<f64> {
        match self {
            Self::Starting(first) => first.given.as_ref().filter(|_| first.is_blind()).map(|given| given.strength_ut),
            Self::Running(running) | Self::Undecided(running, _) => running.lost_strength_ut,
        }
    }

    /// Goes from `Running` to `Undecided`.
    pub(super) fn doubt(&mut self, trial: Trial) {
        *self = match self.take() {
            Self::Running(running) | Self::Undecided(running, _) => Self::Undecided(running, trial),
            starting @ Self::Starting(_) => starting,
        };
    }

    /// Goes from `Undecided` to `Running`, with the filter that `winner` is, if one has won.
    pub(super) fn decide(&mut self, winner: Option<fn(Trial) -> Filter>) {
        *self = match self.take() {
            Self::Undecided(running, trial) => Self::Running(match winner {
                Some(winner) => Running { filter: winner(trial), watch: Watch::default(), ..running },
                None => running,
            }),
            other => other,
        };
    }

    /// What is there, for a moment in which nothing is.
    pub(super) fn take(&mut self) -> Self {
        std::mem::replace(self, Self::Starting(FirstFit::default()))
    }
}

impl Running {
    /// The field of the place is another since then: the Earth's is carried beside it.
    pub(super) fn carry_earth(&mut self, since_ns: i64, tuning: &Tuning) {
        self.earth = tuning.new_place.then(|| Earth::of(&self.filter, self.earth.as_ref(), since_ns));
    }

    /// The chain of rotations is broken: where the field points is lost, and the sample is the best guess of it.
    pub(super) fn lose_field(&mut self, raw_ut: &Vector3<f64>, local_ut: f64) {
        let filter = &mut self.filter;
        let m = filter.part(FIELD);
        self.lost_strength_ut.get_or_insert(m.norm());
        if let Some((_, c)) = filter.parts().corrected(raw_ut) {
            if let Some(earth) = &mut self.earth {
                earth.lose(&m, &c);
            }
            filter.set_part(FIELD, &c);
        }
        filter.set_part(LOCAL, &Vector3::zeros());
        filter.isolate(FIELD, &Matrix3::from_diagonal_element(STRONGEST_AXIS_UT.powi(2)));
        filter.isolate(LOCAL, &Matrix3::from_diagonal_element(local_ut.powi(2)));
    }

    /// No sample is seen for so long: the hard iron drifts, up to what a first sample says of it.
    pub(super) fn drift(&mut self, dt_s: f64, tuning: &Tuning) {
        let room_ut2 = STRONGEST_AXIS_UT.powi(2) - self.filter.variances(HARD_IRON).sum() / 3.0;
        let walk_ut2 = tuning.largest_walk_ut.powi(2) * dt_s;
        self.filter.add_variance(HARD_IRON, walk_ut2.min(room_ut2).max(0.0));
    }
}
