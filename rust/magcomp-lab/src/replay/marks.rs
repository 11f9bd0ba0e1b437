//! Events as marks on a time axis.

use magcomp::Event;

/// Events whose onsets are closer than this share a mark, ns: the later decision is about the same change.
const TOGETHER_NS: i64 = 500_000_000;

/// The onsets of events, s from the start, each with the kinds that were decided for it, in order.
pub(super) fn marks(events: &[Event], start_ns: i64) -> Vec<(f64, String)> {
    let mut marks: Vec<(i64, Vec<String>)> = Vec::new();
    for event in events {
        let kind = format!("{:?}", event.kind);
        match marks.last_mut() {
            Some((since_ns, kinds)) if (event.since_ns - *since_ns).abs() < TOGETHER_NS => {
                if kinds.last() != Some(&kind) {
                    kinds.push(kind);
                }
            }
            _ => marks.push((event.since_ns, vec![kind])),
        }
    }
    let seconds = |since_ns: i64| (since_ns - start_ns) as f64 / 1e9;
    marks.into_iter().map(|(since_ns, kinds)| (seconds(since_ns), kinds.join(", then "))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use magcomp::EventKind;

    #[test]
    fn decisions_about_one_change_share_a_mark() {
        let event = |kind, since_s: f64, decided_s: f64| Event {
            kind,
            since_ns: (since_s * 1e9) as i64,
            decided_ns: (decided_s * 1e9) as i64,
        };
        let events = [
            event(EventKind::PlaceChanged, 11.0, 12.0),
            event(EventKind::PlaceChanged, 11.0, 14.0),
            event(EventKind::DeviceStep, 11.1, 18.0),
            event(EventKind::DeviceStepBack, 30.0, 31.0),
        ];
        let found = marks(&events, 1_000_000_000);
        let expected = [(10.0, "PlaceChanged, then DeviceStep"), (29.0, "DeviceStepBack")];
        assert_eq!(found, expected.map(|(s, name)| (s, name.to_owned())));
    }
}
