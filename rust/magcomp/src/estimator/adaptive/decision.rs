//! What is told of changes. A change is decided when the hypotheses that came with it have nearly all of the probability and it
//! has lasted; what it was is told by how the parameters differ from those at the latest decision: directions that turned are
//! the device, another strength or dip the place.

use super::bank::Bank;
use super::hypothesis::{Hypothesis, Kind};
use super::parameters::{Gaussian, Tau, shape};
use super::tuning::Tuning;
use crate::reading::{Event, EventKind, ModelOrder};

/// The latest decision.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Decision {
    /// The hypothesis that was decided for, and what it says.
    id: u32,
    told: Option<Tau>,
    /// Another place: since when, and what is usual.
    elsewhere: Option<(i64, Tau)>,
    /// Since when something has changed that is not decided yet, ns.
    pub suspected_ns: Option<i64>,
    pub order: ModelOrder,
    pub event: Option<Event>,
}

impl Decision {
    /// Whether the likeliest hypothesis is of a change that is not decided yet, and would be told or is not known well enough.
    pub fn watch(&mut self, bank: &Bank, tuning: &Tuning) {
        let least = tuning.least_change_deg.to_radians().powi(2);
        let matters = |told: &Tau, best: &Hypothesis| {
            best.error > least
                || turned(told, &best.known.mean) > least
                || !is_same_place(told, &best.known.mean, 2.0 * tuning.small_place)
        };
        let best = bank.best().filter(|best| best.id != self.id && best.kind != Kind::Cold);
        self.suspected_ns =
            best.zip(self.told).filter(|(best, told)| matters(told, best)).map(|(best, _)| best.onset_ns);
    }

    /// Since when the place is another one than usual, ns.
    pub fn elsewhere_ns(&self) -> Option<i64> {
        self.elsewhere.map(|(since_ns, _)| since_ns)
    }

    /// Looks at the bank again.
    pub fn review(&mut self, bank: &Bank, time_ns: i64, tuning: &Tuning) {
        let seconds_since = |since_ns: i64| time_ns.saturating_sub(since_ns) as f64 * 1e-9;
        // a place that lasts is what is usual
        self.elsewhere = self.elsewhere.filter(|(since_ns, _)| seconds_since(*since_ns) < tuning.new_place_s);
        let Some(best) = bank.best() else { return };
        let (id, kind, onset_ns, mean) = (best.id, best.kind, best.onset_ns, best.known.mean);
        let Some(before) = self.told.filter(|_| id != self.id && kind != Kind::Cold) else {
            (self.id, self.told) = (id, Some(mean));
            return;
        };
        let own = |h: &Hypothesis| h.onset_ns >= onset_ns && h.id != self.id;
        if seconds_since(onset_ns) < tuning.change_s || bank.probability(own) < tuning.certain {
            return;
        }
        (self.id, self.told) = (id, Some(mean));
        self.order = match kind {
            Kind::Former => ModelOrder::Former,
            Kind::HardIron => ModelOrder::HardIron,
            Kind::All => ModelOrder::All,
            Kind::Cold | Kind::Place => self.order,
        };
        let is_place = |other: &Tau| !is_same_place(other, &mean, 2.0 * tuning.small_place);
        let event = if turned(&before, &mean) > tuning.least_change_deg.to_radians().powi(2) {
            if kind == Kind::Former { EventKind::DeviceStepBack } else { EventKind::DeviceStep }
        } else if is_place(&before) {
            let usual = self.elsewhere.map_or(before, |(_, usual)| usual);
            self.elsewhere = is_place(&usual).then_some((onset_ns, usual));
            EventKind::PlaceChanged
        } else {
            return;
        };
        // what is found out about a change that has been told already is no other change
        let told = self.event.is_some_and(|told| {
            (onset_ns.saturating_sub(told.since_ns) as f64) < tuning.change_s * 1e9
                && (told.kind == EventKind::PlaceChanged) == (event == EventKind::PlaceChanged)
        });
        if !told {
            self.event = Some(Event { kind: event, since_ns: onset_ns, decided_ns: time_ns });
        }
    }
}

/// Mean square angle between directions corrected by the one and by the other, rad^2.
fn turned(a: &Tau, b: &Tau) -> f64 {
    let off = b - a;
    Gaussian { mean: *a, covariance: off * off.transpose() }.error()
}

/// Whether the field is about as strong and as steep.
fn is_same_place(a: &Tau, b: &Tau, least: f64) -> bool {
    let strength = |tau: &Tau| shape(tau).trace();
    (strength(a) / strength(b) - 1.0).abs() < least && (a[9] - b[9]).abs() < least
}
