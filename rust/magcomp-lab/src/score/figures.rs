//! The figures of a run.

use super::errors::{Mode, Sample, samples};
use super::stretch::{self, Begin, Stretch, explains};
use crate::simulate::{Change, ChangeKind, Simulation};
use magcomp::{Event, EventKind};
use magcomp_replay::Step;
use magcomp_replay::statistics::{median, rms};
use serde::Serialize;

/// From here on a run is judged, s.
const WARM_S: f64 = 20.0;
/// How long before the first change an error counts as before it, s, and when where there is none.
const BEFORE_S: f64 = 10.0;
const BEFORE_NOTHING_S: (f64, f64) = (20.0, 45.0);
/// A pause so long does not end a lie, s.
const LIE_PAUSE_S: f64 = 0.2;
/// An error that an app must be told of, degrees.
const BLIND_DEG: f64 = 10.0;
/// Steps whose onset is before this belong to the start, s.
const STARTED_S: f64 = 15.0;
/// Changes of this size must be declared, uT.
const DUE_UT: f64 = 5.0;

/// One error, as four figures.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Errors {
    /// Of the published heading.
    pub heading_deg: Option<f64>,
    /// Of f.
    pub carried_deg: Option<f64>,
    /// Of c.
    pub corrected_deg: Option<f64>,
    /// Of the calibration.
    pub calibration_deg: Option<f64>,
}

impl Errors {
    /// Root mean squares over these samples.
    fn rms<'a>(samples: impl Iterator<Item = &'a Sample> + Clone) -> Self {
        let of = |error: fn(&Sample) -> Option<f64>| rms(samples.clone().filter_map(error));
        Self {
            heading_deg: of(|sample| sample.heading_deg),
            carried_deg: of(|sample| sample.carried_deg),
            corrected_deg: of(|sample| sample.corrected_deg),
            calibration_deg: of(|sample| sample.calibration_deg),
        }
    }
}

/// One run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figures {
    /// First corrected sample.
    pub first_s: Option<f64>,
    /// Errors before the first change.
    pub before: Errors,
    /// Errors from 20 s on.
    pub error: Errors,
    /// Share of judged samples with a heading; none where none is judged.
    pub answered: Option<f64>,
    /// Share of heading errors within one and two sigmas; none without a heading.
    pub within: Option<[f64; 2]>,
    /// Mean square of error over sigma.
    pub z2: Option<f64>,
    /// Median sigma of the heading.
    pub sigma_deg: Option<f64>,
    /// Share of samples whose status is `Tracking`.
    pub tracking: f64,
    /// Longest lie.
    pub lie_s: f64,
    /// Largest error in it.
    pub lie_deg: f64,
    /// Time without a warning.
    pub blind_s: f64,
    /// Steps that no change explains.
    pub false_steps: usize,
    /// The same an hour.
    pub false_per_h: f64,
    /// Steps that a change explains which another step has told.
    pub again: usize,
    /// Changes that must be declared.
    pub due: usize,
    /// Those that were not.
    pub missed: usize,
    /// From the start to the first change, then from each change to the next.
    pub stretches: Vec<Stretch>,
}

impl Figures {
    /// Of a run; `steps` are those of the simulation's samples.
    pub fn of(simulation: &Simulation, steps: &[Step]) -> Self {
        let events = steps.iter().filter_map(|step| step.reading.event);
        Self::judged(&samples(simulation, steps), events, &simulation.changes, simulation.rate_hz, WARM_S)
    }

    /// Of samples, wherever they come from, and what was told meanwhile; judged from `from_s` on.
    pub(crate) fn judged(
        samples: &[Sample],
        events: impl Iterator<Item = Event>,
        changes: &[Change],
        rate_hz: f64,
        from_s: f64,
    ) -> Self {
        let end_s = samples.last().map_or(0.0, |sample| sample.time_s);
        let changes: Vec<Change> = changes.iter().copied().filter(|change| change.begins_s < end_s - 3.0).collect();
        let between = |from_s: f64, to_s: f64| {
            samples.iter().filter(move |sample| sample.time_s > from_s && sample.time_s < to_s)
        };
        let warm = || between(from_s, f64::INFINITY);
        let before_s = changes.first().map_or(BEFORE_NOTHING_S, |first| (first.begins_s - BEFORE_S, first.begins_s));
        let judged: Vec<&Sample> = warm().filter(|sample| sample.is_level).collect();
        let sigmas: Vec<f64> = judged.iter().filter_map(|sample| sample.sigmas()).collect();
        let share = |count: usize, of: usize| count as f64 / of.max(1) as f64;
        let within = |limit: f64| share(sigmas.iter().filter(|sigmas| **sigmas < limit).count(), sigmas.len());
        let (lie_s, lie_deg) = lie(warm());
        let is_carried = samples.iter().any(|sample| sample.carried_deg.is_some());
        let is_blind = |sample: &&Sample| {
            matches!(sample.mode, Mode::Tracking | Mode::Held) && sample.main(is_carried).is_some_and(|e| e > BLIND_DEG)
        };
        let steps_told = device_steps(events);
        let false_steps = steps_told.iter().filter(|event| is_false(event, &changes)).count();
        let again = again(&steps_told, &changes);
        let stretches = stretch::all(samples, &changes, &steps_told, rate_hz, is_carried);
        let due: Vec<&Stretch> =
            stretches.iter().filter(|one| one.begin == Begin::Device && one.size_ut >= DUE_UT).collect();
        Self {
            first_s: samples.iter().find(|sample| sample.corrected_deg.is_some()).map(|sample| sample.time_s),
            before: Errors::rms(between(before_s.0, before_s.1)),
            error: Errors::rms(warm()),
            answered: (!judged.is_empty())
                .then(|| share(judged.iter().filter(|sample| sample.heading_deg.is_some()).count(), judged.len())),
            within: (!sigmas.is_empty()).then(|| [within(1.0), within(2.0)]),
            z2: rms(sigmas.iter().copied()).map(|rms| rms * rms),
            sigma_deg: median(warm().filter_map(|sample| sample.sigma_deg).collect()),
            tracking: share(warm().filter(|sample| sample.mode == Mode::Tracking).count(), warm().count()),
            lie_s,
            lie_deg,
            blind_s: warm().filter(is_blind).count() as f64 / rate_hz,
            false_steps,
            false_per_h: false_steps as f64 * 3600.0 / end_s.max(1.0),
            again,
            due: due.len(),
            missed: due.iter().filter(|one| one.declared_s.is_none()).count(),
            stretches,
        }
    }
}

/// Device steps, there and back, each once.
fn device_steps(events: impl Iterator<Item = Event>) -> Vec<Event> {
    let mut events: Vec<Event> = events.collect();
    events.dedup();
    events.retain(|event| matches!(event.kind, EventKind::DeviceStep | EventKind::DeviceStepBack));
    events
}

fn is_false(event: &Event, changes: &[Change]) -> bool {
    let mut steps = changes.iter().filter(|change| change.kind != ChangeKind::Vehicle);
    event.since_ns as f64 / 1e9 > STARTED_S && !steps.any(|change| explains((change.begins_s, change.ends_s), event))
}

/// Steps that changes explain, less one for each change that any of them tells.
fn again(steps: &[Event], changes: &[Change]) -> usize {
    let tells = |event: &Event, change: &Change| {
        change.kind != ChangeKind::Vehicle && explains((change.begins_s, change.ends_s), event)
    };
    let explained = steps.iter().filter(|event| changes.iter().any(|change| tells(event, change))).count();
    let told = changes.iter().filter(|change| steps.iter().any(|event| tells(event, change))).count();
    explained.saturating_sub(told)
}

/// The longest lie, s, and the largest error in it, degrees.
fn lie<'a>(samples: impl Iterator<Item = &'a Sample>) -> (f64, f64) {
    let (mut longest, mut from_s, mut latest_s, mut largest_deg) = ((0.0, 0.0), 0.0, f64::NEG_INFINITY, 0.0);
    for sample in samples {
        let Some(error_deg) = sample.lie_deg() else { continue };
        if sample.time_s - latest_s > LIE_PAUSE_S {
            (from_s, largest_deg) = (sample.time_s, 0.0);
        }
        latest_s = sample.time_s;
        largest_deg = f64::max(largest_deg, error_deg);
        if latest_s - from_s >= longest.0 {
            longest = (latest_s - from_s, largest_deg);
        }
    }
    longest
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sample(k: usize, error_deg: f64) -> Sample {
        Sample {
            time_s: k as f64 / 100.0,
            mode: Mode::Tracking,
            is_level: true,
            heading_deg: Some(error_deg),
            sigma_deg: Some(2.0),
            ..Sample::default()
        }
    }

    #[test]
    fn a_lie_bridges_short_pauses_and_needs_tracking() {
        let mut samples: Vec<Sample> = (0..300).map(|k| sample(k, 8.0)).collect();
        samples[120].heading_deg = Some(-9.0);
        assert_eq!(lie(samples.iter()), (2.99, 9.0));
        // 0.1 s of honesty is none, 0.3 s of it are
        samples[40..50].iter_mut().for_each(|sample| sample.heading_deg = Some(5.9));
        assert!((lie(samples.iter()).0 - 2.99).abs() < 1e-9);
        samples[100..130].iter_mut().for_each(|sample| sample.mode = Mode::Other);
        let (longest_s, largest_deg) = lie(samples.iter());
        assert!((longest_s - 1.69).abs() < 1e-9 && largest_deg == 8.0, "{longest_s} {largest_deg}");
    }

    #[test]
    fn a_step_near_a_change_is_explained_and_others_are_not() {
        let event = |since_s: f64, decided_s: f64| Event {
            kind: EventKind::DeviceStep,
            since_ns: (since_s * 1e9) as i64,
            decided_ns: (decided_s * 1e9) as i64,
        };
        let change = |kind| [Change { begins_s: 40.0, ends_s: 41.0, size_ut: 20.0, kind }];
        let device = change(ChangeKind::Device);
        assert!(!is_false(&event(36.0, 40.5), &device) && !is_false(&event(52.0, 55.0), &device));
        assert!(is_false(&event(36.0, 39.9), &device) && is_false(&event(54.0, 55.0), &device));
        assert!(!is_false(&event(14.0, 15.5), &device));
        assert!(is_false(&event(40.0, 41.0), &change(ChangeKind::Vehicle)));
        assert!(!is_false(&event(40.0, 41.0), &change(ChangeKind::Unseen)));
    }

    /// Two covers within seconds are told by two steps; a third says one of them again. One slide that is told thrice is told twice too often.
    #[test]
    fn a_change_that_is_told_more_than_once_is_told_again() {
        let event = |at_s: f64| Event {
            kind: EventKind::DeviceStep,
            since_ns: (at_s * 1e9) as i64,
            decided_ns: ((at_s + 1.0) * 1e9) as i64,
        };
        let change = |begins_s, ends_s, kind| Change { begins_s, ends_s, size_ut: 20.0, kind };
        let covers = [40.0, 43.0].map(|at_s| change(at_s, at_s, ChangeKind::Device));
        let told = |steps: &[f64], changes: &[Change]| {
            again(&steps.iter().map(|at_s| event(*at_s)).collect::<Vec<_>>(), changes)
        };
        assert_eq!((told(&[40.0, 43.0], &covers), told(&[40.0, 43.0, 45.0], &covers)), (0, 1));
        let slide = [change(40.0, 50.0, ChangeKind::Device)];
        assert_eq!((told(&[41.0, 45.0, 61.0], &slide), told(&[41.0, 70.0], &slide), told(&[], &slide)), (2, 0, 0));
        assert_eq!(told(&[41.0, 42.0], &[change(40.0, 42.0, ChangeKind::Vehicle)]), 0);
    }

    #[test]
    fn medians_and_root_mean_squares_of_nothing_are_none() {
        assert_eq!((median(Vec::new()), rms(std::iter::empty())), (None, None));
        assert_eq!(median(vec![3.0, 1.0]), Some(2.0));
        assert_eq!(median(vec![f64::INFINITY, 1.0, f64::INFINITY]), Some(f64::INFINITY));
        assert_eq!(rms([3.0, 4.0, 0.0, 0.0].into_iter()), Some(2.5));
    }
}
