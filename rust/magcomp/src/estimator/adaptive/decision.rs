//! What is told of changes.

use super::bank::Bank;
use super::filter::{Filter, Kind};
use super::parameters::{Tau, beyond_earth, centre};
use super::tuning::Tuning;
use crate::estimator::answer::LEAST_TOLD_UT;
use crate::priors::RARE;
use crate::reading::{Event, EventKind, ModelOrder};
use crate::sample::seconds;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;

/// The latest decision.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Decision {
    id: u32,
    /// Kind and onset of the change that is in force.
    change: Option<(Kind, i64)>,
    told: Option<Tau>,
    /// The place is not as usual, since.
    pub elsewhere: Option<i64>,
    told_place: Option<i64>,
    pub suspected_ns: Option<i64>,
    pub order: ModelOrder,
    pub event: Option<Event>,
}

impl Decision {
    pub fn review(&mut self, bank: &Bank, time_ns: i64, unit_ut: f64, tuning: &Tuning) {
        let since = |ns: i64| seconds(ns, time_ns);
        let Some(best) = bank.best() else { return };
        // the place
        // half of what another place usually is
        let told = 0.5 * tuning.place;
        let (level, tilted, variance) = best.now.level();
        let off = level.abs().max(tilted.abs()) > told && variance.sqrt() < 0.5 * told;
        let beyond = beyond_earth(&best.now.tau(), unit_ut) > told;
        self.elsewhere =
            best.now.place_ns.filter(|ns| off && since(*ns) < tuning.new_place_s).or(beyond.then_some(best.onset_ns));
        // the device
        let known = best.now.tau();
        let Some(before) = self.told.filter(|_| best.kind != Kind::Cold) else {
            self.take(best);
            return;
        };
        self.suspected_ns = None;
        // those that began while the change took place say the same
        let began_ns = |onset_ns: i64| onset_ns.saturating_sub((tuning.ramp_s * 1e9) as i64);
        let same = |(kind, ns): (Kind, i64)| {
            kind == best.kind && ns >= began_ns(best.onset_ns) && best.onset_ns >= began_ns(ns)
        };
        if self.change.is_some_and(same) {
            self.id = best.id;
        }
        let least = LEAST_TOLD_UT / unit_ut;
        let moved = |it: &Tau| (centre(it) - centre(&before)).norm() > least;
        let matters = |it: &Filter| !it.is_known() || moved(&it.now.tau());
        if best.id != self.id && matters(best) {
            self.suspected_ns = Some(best.onset_ns);
        } else if best.now.odd > 0 {
            self.suspected_ns = Some(time_ns);
        }
        if let Some(ns) = self.elsewhere
            && best.now.place_ns == Some(ns)
            && self.told_place != Some(ns)
            && since(ns) >= tuning.change_s
            && bank.probability(|it| it.now.place_ns == best.now.place_ns) > 1.0 - RARE
        {
            self.told_place = Some(ns);
            self.event = Some(Event { kind: EventKind::PlaceChanged, since_ns: ns, decided_ns: time_ns });
        }
        if best.id == self.id {
            self.told = Some(known);
            return;
        }
        let own = |h: &Filter| h.onset_ns >= began_ns(best.onset_ns) && h.id != self.id;
        if since(best.onset_ns) < tuning.change_s || !best.is_shown(tuning) || bank.probability(own) < 1.0 - RARE {
            return;
        }
        self.take(best);
        self.order = if best.kind == Kind::Former { ModelOrder::Former } else { ModelOrder::All };
        let is_told = |told: Event| {
            (best.onset_ns.saturating_sub(told.since_ns) as f64) < tuning.change_s * 1e9
                && told.kind != EventKind::PlaceChanged
        };
        if moved(&known) && !self.event.is_some_and(is_told) {
            let kind = if best.kind == Kind::Former { EventKind::DeviceStepBack } else { EventKind::DeviceStep };
            self.event = Some(Event { kind, since_ns: best.onset_ns, decided_ns: time_ns });
        }
    }

    /// The change in force is that of a hypothesis.
    fn take(&mut self, best: &Filter) {
        (self.id, self.change, self.told) = (best.id, Some((best.kind, best.onset_ns)), Some(best.now.tau()));
    }
}

#[cfg(test)]
mod tests;
