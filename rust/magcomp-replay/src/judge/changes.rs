//! What changed in a replay, as a user would tell it: when the device did and by how much hard iron, and when the place differed.

use crate::play::Step;
use magcomp::nalgebra::Vector3;
use magcomp::{Event, EventKind, Status};
use serde::Serialize;
use std::collections::VecDeque;

/// Time between two kept hard irons, ns, and the longest time that they are kept: decisions come sooner.
const KEPT_STEP_NS: i64 = 500_000_000;
const KEPT_NS: i64 = 300_000_000_000;
/// The hard iron after a change is the one in force so long after its decision, ns, or just before the next change.
const SETTLED_NS: i64 = 10_000_000_000;
/// Two times of another place with less than this in between are one, ns.
const TOGETHER_NS: i64 = 2_000_000_000;

/// The device changed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DeviceChange {
    /// When it began, s after the first row.
    pub since_s: f64,
    /// When it was decided, s after the first row.
    pub decided_s: f64,
    /// Whether the device became again as it was before.
    pub back: bool,
    /// Size of the difference between the hard irons in force at its beginning and 10 s after the decision (or just before the
    /// next change), uT; none where no calibration was in force before.
    pub hard_iron_change_ut: Option<f64>,
}

/// The field of the place was not the usual one: the status was `disturbed`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PlaceDiffered {
    /// From when, s after the first row.
    pub from_s: f64,
    /// To when, s after the first row.
    pub to_s: f64,
}

/// Something that the compensator declared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Declared {
    /// The kind of the event.
    pub kind: String,
    /// When it began, s after the first row.
    pub since_s: f64,
    /// When it was decided, s after the first row.
    pub decided_s: f64,
}

/// A device event, and the hard irons before and after it, uT.
#[derive(Clone, Copy, Debug)]
struct Change {
    event: Event,
    before_ut: Option<Vector3<f64>>,
    after_ut: Option<Vector3<f64>>,
}

/// Changes, row by row.
#[derive(Clone, Debug, Default)]
pub(super) struct Changes {
    kept: VecDeque<(i64, Vector3<f64>)>,
    devices: Vec<Change>,
    places: Vec<(i64, i64)>,
}

impl Changes {
    /// The next step; `event` is one that was not told before.
    pub fn add(&mut self, time_ns: i64, step: &Step, event: Option<&Event>) {
        let hard_iron_ut = step.calibration.map(|calibration| *calibration.hard_iron_ut());
        if let Some(event) = event.filter(|event| event.kind != EventKind::PlaceChanged) {
            // the latest before the onset; one that is younger than every kept one began with the first
            let before = self.kept.iter().rev().find(|(at_ns, _)| *at_ns < event.since_ns).or(self.kept.front());
            let before_ut = before.map(|(_, hard_iron_ut)| *hard_iron_ut);
            self.devices.push(Change { event: *event, before_ut, after_ut: hard_iron_ut });
        }
        if let Some(change) = self.devices.last_mut()
            && time_ns - change.event.decided_ns <= SETTLED_NS
        {
            change.after_ut = hard_iron_ut.or(change.after_ut);
        }
        if let Some(hard_iron_ut) = hard_iron_ut
            && self.kept.back().is_none_or(|(at_ns, _)| time_ns - at_ns >= KEPT_STEP_NS)
        {
            self.kept.push_back((time_ns, hard_iron_ut));
            while self.kept.front().is_some_and(|(at_ns, _)| time_ns - at_ns > KEPT_NS) {
                self.kept.pop_front();
            }
        }
        if let Status::Disturbed { since_ns } = step.reading.status {
            match self.places.last_mut() {
                Some((_, to_ns)) if since_ns - *to_ns <= TOGETHER_NS => *to_ns = time_ns,
                _ => self.places.push((since_ns, time_ns)),
            }
        }
    }

    /// The changes, in order, with times from `start_ns` on.
    pub fn finish(&self, start_ns: i64) -> (Vec<DeviceChange>, Vec<PlaceDiffered>) {
        let seconds = |time_ns: i64| (time_ns - start_ns) as f64 / 1e9;
        let device = |Change { event, before_ut, after_ut }: &Change| DeviceChange {
            since_s: seconds(event.since_ns),
            decided_s: seconds(event.decided_ns),
            back: event.kind == EventKind::DeviceStepBack,
            hard_iron_change_ut: before_ut.zip(*after_ut).map(|(before, after)| (after - before).norm()),
        };
        let place = |(from_ns, to_ns): &(i64, i64)| PlaceDiffered { from_s: seconds(*from_ns), to_s: seconds(*to_ns) };
        (self.devices.iter().map(device).collect(), self.places.iter().map(place).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ignore, replay};
    use magcomp::nalgebra::Matrix3;
    use magcomp::{Calibration, Config};
    use magcomp_recordings::recording::{Recording, Row};

    #[test]
    fn a_change_is_told_with_its_hard_iron_and_a_place_with_its_time() {
        let row = |k: u32| Row {
            time_s: f64::from(k) * 0.1,
            time_ns: i64::from(k) * 100_000_000,
            field_ut: Vector3::new(f64::from(k % 7), 20.0, -40.0),
            ..Row::default()
        };
        let recording = Recording { path: "r.csv".into(), rows: (0..1000).map(row).collect() };
        let mut steps = replay(&recording, &Config::default(), Ignore::default()).unwrap();
        let ns = |s: f64| (s * 1e9) as i64;
        let (before, magnet) = (Vector3::new(1.0, 2.0, 3.0), Vector3::new(-2.0, 0.0, 13.0));
        let mut changes = Changes::default();
        for (row, step) in recording.rows.iter().zip(&mut steps) {
            let s = row.time_s;
            // learned from 46 s on, the last of it by 50 s; restored at 81 s
            let share = if s > 81.0 { 0.0 } else { ((s - 46.0) / 4.0).clamp(0.0, 1.0) };
            let hard_iron = before + magnet * share;
            step.calibration = Some(Calibration::new(Matrix3::identity(), hard_iron, 50.0).unwrap());
            let event = |kind, since: f64, decided: f64| {
                (row.time_ns == ns(decided)).then_some(Event { kind, since_ns: ns(since), decided_ns: ns(decided) })
            };
            let event = event(EventKind::DeviceStep, 45.2, 47.0)
                .or_else(|| event(EventKind::PlaceChanged, 60.0, 61.0))
                .or_else(|| event(EventKind::DeviceStepBack, 80.0, 81.0));
            if (61.0..70.05).contains(&s) && !(64.95..66.05).contains(&s) {
                step.reading.status = Status::Disturbed { since_ns: ns(60.0) };
            }
            changes.add(row.time_ns, step, event.as_ref());
        }
        let (devices, places) = changes.finish(0);
        let told: Vec<_> = devices.iter().map(|change| (change.since_s, change.decided_s, change.back)).collect();
        assert_eq!(told, [(45.2, 47.0, false), (80.0, 81.0, true)]);
        for change in &devices {
            assert!((change.hard_iron_change_ut.unwrap() - magnet.norm()).abs() < 1e-9, "{change:?}");
        }
        assert_eq!(places, [PlaceDiffered { from_s: 60.0, to_s: 70.0 }]);
    }
}
