//! Which device steps a change explains.

use magcomp::Event;

/// A change explains a step from so long before it until so long after it, s.
const EXPLAINS_S: (f64, f64) = (5.0, 12.0);

/// Whether a step's onset is near enough to a change, and its decision not before it.
pub(super) fn explains(change_s: (f64, f64), event: &Event) -> bool {
    is_explained(change_s, event.since_ns as f64 / 1e9, event.decided_ns as f64 / 1e9)
}

/// The same of a step that began at `since_s` and was decided at `decided_s`.
pub(crate) fn is_explained(change_s: (f64, f64), since_s: f64, decided_s: f64) -> bool {
    let near = change_s.0 - EXPLAINS_S.0..=change_s.1 + EXPLAINS_S.1;
    near.contains(&since_s) && decided_s >= change_s.0
}
