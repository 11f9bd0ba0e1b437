//! What is told of changes.

use super::bank::Bank;
use super::filter::{Filter, HardIron, Kind};
use super::parameters::{Tau, beyond_earth, centre};
use super::tuning::Tuning;
use crate::estimator::answer::{LEAST_TOLD_UT, Told};
use crate::priors::{RARE, SETTLED_S};
use crate::reading::{Event, EventKind, ModelOrder};
use crate::sample::seconds;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

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
    moved: Option<Told>,
    pub suspected_ns: Option<i64>,
    pub order: ModelOrder,
    pub event: Option<Event>,
}

impl Decision {
    pub fn review(&mut self, bank: &Bank, time_ns: i64, unit_ut: f64, tuning: &Tuning) {
        let Some(best) = bank.best() else { return };
        self.find_elsewhere(best, time_ns, unit_ut, tuning);
        let Some(before) = self.told.filter(|_| best.kind != Kind::Cold) else {
            self.take(best);
            return;
        };
        let least = LEAST_TOLD_UT / unit_ut;
        let moved = |it: &Tau| (centre(it) - centre(&before)).norm() > least;
        // those that began while the change took place say the same
        let began_ns = |onset_ns: i64| onset_ns.saturating_sub((tuning.ramp_s * 1e9) as i64);
        let same = |(kind, ns): (Kind, i64)| {
            kind == best.kind && ns >= began_ns(best.onset_ns) && best.onset_ns >= began_ns(ns)
        };
        if self.change.is_some_and(same) {
            self.id = best.id;
        }
        // until b rests, a magnet that slides on may as well be iron that the device is carried past
        let slides = best.hard_iron == HardIron::Slides;
        if let Some(told) = self.moved.as_mut().filter(|it| slides && seconds(it.decided_ns, time_ns) < SETTLED_S) {
            // what was told goes on, whichever way
            (told.decided_ns, told.moved) = (time_ns, Vector3::zeros());
        }
        let matters = !best.is_known() || moved(&best.now.tau());
        self.suspected_ns =
            if best.id != self.id && matters { Some(best.onset_ns) } else { (best.now.odd > 0).then_some(time_ns) };
        self.tell_place(bank, best, time_ns, tuning);
        if best.id == self.id {
            self.told = Some(best.now.tau());
            return;
        }
        let is_of_it = |h: &Filter| h.onset_ns >= began_ns(best.onset_ns) && h.id != self.id;
        if !slides
            && seconds(best.onset_ns, time_ns) >= tuning.change_s
            && best.is_shown(tuning)
            && bank.probability(is_of_it) >= 1.0 - RARE
        {
            self.take(best);
            self.order = if best.kind == Kind::Former { ModelOrder::Former } else { ModelOrder::All };
            self.tell_device(best, centre(&best.now.tau()) - centre(&before), least, time_ns, tuning);
        }
    }

    /// Since when the place is not as usual: its field differs by half of what another place's does, or is none of the Earth's.
    fn find_elsewhere(&mut self, best: &Filter, time_ns: i64, unit_ut: f64, tuning: &Tuning) {
        let least = 0.5 * tuning.place;
        let (level, tilted, variance) = best.now.level();
        let off = level.abs().max(tilted.abs()) > least && variance.sqrt() < 0.5 * least;
        let beyond = beyond_earth(&best.now.tau(), unit_ut) > least;
        self.elsewhere = best
            .now
            .place_ns
            .filter(|ns| off && seconds(*ns, time_ns) < tuning.new_place_s)
            .or(beyond.then_some(best.onset_ns));
    }

    /// Another place is told once, when it has lasted and hardly anything speaks against it.
    fn tell_place(&mut self, bank: &Bank, best: &Filter, time_ns: i64, tuning: &Tuning) {
        if let Some(ns) = self.elsewhere
            && best.now.place_ns == Some(ns)
            && self.told_place != Some(ns)
            && seconds(ns, time_ns) >= tuning.change_s
            && bank.probability(|it| it.now.place_ns == best.now.place_ns) > 1.0 - RARE
        {
            self.told_place = Some(ns);
            self.event = Some(Event { kind: EventKind::PlaceChanged, since_ns: ns, decided_ns: time_ns });
        }
    }

    /// A change of the device is told where b moved, unless it goes on with the one before: a slide is told once.
    fn tell_device(&mut self, best: &Filter, moved: Vector3<f64>, least: f64, decided_ns: i64, tuning: &Tuning) {
        if moved.norm() <= least {
            return;
        }
        let onset_ns = best.onset_ns;
        let is_of = |it: &Told| seconds(it.since_ns, onset_ns) < tuning.change_s || it.goes_on(onset_ns, &moved);
        let before = self.moved.filter(is_of);
        let since_ns = before.map_or(onset_ns, |before| before.since_ns);
        self.moved = Some(Told { since_ns, decided_ns, moved });
        if before.is_none() {
            let kind = if best.kind == Kind::Former { EventKind::DeviceStepBack } else { EventKind::DeviceStep };
            self.event = Some(Event { kind, since_ns, decided_ns });
        }
    }

    /// The change in force is that of a hypothesis.
    fn take(&mut self, best: &Filter) {
        (self.id, self.change, self.told) = (best.id, Some((best.kind, best.onset_ns)), Some(best.now.tau()));
    }
}

#[cfg(test)]
mod tests;
