//! Situations through the default config: published headings against the truth, and events against the changes.
//!
//! * A heading is that of the top edge in the place's undisturbed field. Samples whose top edge is more than 60 degrees off the horizontal
//!   are passed over: a heading means little there.
//! * answered: the share of these samples that have a heading;
//! * settled: seconds from the change (or the start) until the 95th percentile over 100 such samples stays below 5 degrees for good;
//! * error: root mean square of the headings' errors in a run, from the change (or the start) to the end;
//! * an event belongs to a change when it is of the right kind and decided within 20 s after the change; any other event is false.

use super::Spread;
use super::aided_score::{events, settled};
use super::situation::{Group, Situation, Stream};
use crate::error::LabError;
use crate::progress;
use crate::recording::Recording;
use crate::replay::{Ignore, Step, replay};
use crate::time::time_ns;
use magcomp::nalgebra::Vector3;
use magcomp::{ReferenceAxis, ScreenRotation, Status, heading};
use serde::Serialize;

/// Sine of the top edge's elevation above which a heading is passed over: 60 degrees.
const STEEP: f64 = 0.866;
/// Error of a sample without a heading, degrees.
const NO_ANSWER_DEG: f64 = 180.0;
/// Below this error a heading is settled, degrees.
const SETTLED_DEG: f64 = 5.0;
/// Errors beyond this many sigmas, while the status says that all is well, are the worst fault.
const BEYOND_SIGMAS: f64 = 3.0;
/// Samples that lie further apart than this are not one stretch of time, s.
const APART_S: f64 = 0.1;

/// Options of the experiment.
#[derive(Clone, Debug)]
pub struct EvaluateOptions {
    /// Tables.
    pub groups: Vec<Group>,
    /// Runs of each situation; run k has the seed `seed + k`.
    pub runs: usize,
    /// The first seed.
    pub seed: u64,
    /// Skew of every gyroscope, degrees rms ([`crate::phone::Phone::gyro_skew_deg`]).
    pub gyro_skew_deg: f64,
}

/// Median and worst run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Runs {
    /// Upper median; none where half of the runs have none.
    pub median: Option<f64>,
    /// Worst; none where a run has none.
    pub worst: Option<f64>,
}

impl Runs {
    fn of(values: impl Iterator<Item = Option<f64>>) -> Self {
        let mut values: Vec<f64> = values.map(|value| value.unwrap_or(f64::INFINITY)).collect();
        values.sort_by(f64::total_cmp);
        let known = |value: Option<&f64>| value.copied().filter(|value| value.is_finite());
        Self { median: known(values.get(values.len() / 2)), worst: known(values.last()) }
    }
}

/// A line of the table.
#[derive(Clone, Debug, Serialize)]
pub struct SituationResult {
    /// The situation in a few words.
    pub name: String,
    /// Share of judged samples with a heading, mean over the runs.
    pub answered: f64,
    /// Seconds until the error stays below 5 degrees.
    pub settled_s: Runs,
    /// Error of the headings, rms in a run, degrees, over the runs that have headings.
    pub error_deg: Runs,
    /// Share of errors within one and two of their sigmas, over all runs; none without a heading.
    pub within_sigma: Option<[f64; 2]>,
    /// Longest time without a break in which the status is `Tracking` and the error beyond three sigmas, s, worst run.
    pub tracking_beyond_s: f64,
    /// Changes in all runs, and how many of them no event reported.
    pub changes: usize,
    /// See `changes`.
    pub missed: usize,
    /// Events in all runs that belong to no change.
    pub false_events: usize,
}

/// A table.
#[derive(Clone, Debug, Serialize)]
pub struct GroupResult {
    /// Its title.
    pub title: &'static str,
    /// Its lines.
    pub situations: Vec<SituationResult>,
}

/// All tables.
#[derive(Clone, Debug, Serialize)]
pub struct EvaluateResult {
    /// Runs of each situation.
    pub runs: usize,
    /// The first seed.
    pub seed: u64,
    /// Skew of every gyroscope, degrees rms.
    pub gyro_skew_deg: f64,
    /// The tables.
    pub groups: Vec<GroupResult>,
}

/// Runs the situations.
///
/// # Errors
/// [`LabError`] when a config is refused.
pub fn run(options: &EvaluateOptions) -> Result<EvaluateResult, LabError> {
    let groups: Vec<(Group, Vec<Situation>)> =
        options.groups.iter().map(|group| (*group, group.situations())).collect();
    let count: usize = groups.iter().map(|(_, situations)| situations.len()).sum();
    let bar = progress::bar(count * options.runs, "evaluate");
    let mut result = Vec::new();
    for (group, situations) in &groups {
        let mut lines = Vec::new();
        for situation in situations {
            let mut runs = Vec::new();
            for k in 0..options.runs {
                let stream = situation.stream(options.seed.wrapping_add(k as u64), options.gyro_skew_deg);
                let recording = Recording::of(&stream.simulation, "simulated");
                let steps = replay(&recording, &situation.config(), Ignore::default())?;
                runs.push(Outcome::of(&stream, &steps));
                bar.inc(1);
            }
            lines.push(SituationResult::of(situation.name(), &runs));
        }
        result.push(GroupResult { title: group.title(), situations: lines });
    }
    bar.finish_and_clear();
    let EvaluateOptions { runs, seed, gyro_skew_deg, .. } = *options;
    Ok(EvaluateResult { runs, seed, gyro_skew_deg, groups: result })
}

/// A judged sample.
struct Judged {
    time_s: f64,
    /// None without a heading.
    error_deg: Option<f64>,
    /// The same over its sigma.
    sigmas: Option<f64>,
    is_tracking: bool,
}

/// One run.
struct Outcome {
    answered: f64,
    settled_s: Option<f64>,
    error_deg: Option<f64>,
    sigmas: Vec<f64>,
    tracking_beyond_s: f64,
    changes: usize,
    missed: usize,
    false_events: usize,
}

impl Outcome {
    fn of(stream: &Stream, steps: &[Step]) -> Self {
        let judged = judged(stream, steps);
        let errors: Vec<f64> = judged.iter().filter_map(|one| one.error_deg).collect();
        let all: Vec<f64> = judged.iter().map(|one| one.error_deg.unwrap_or(NO_ANSWER_DEG)).collect();
        let squares: f64 = errors.iter().map(|error| error * error).sum();
        let due = stream.expected.iter().filter(|expected| expected.is_due).count();
        let (missed, false_events) = compare(stream, steps);
        Self {
            answered: errors.len() as f64 / all.len().max(1) as f64,
            settled_s: settled(&all, SETTLED_DEG).map(|count| judged[count - 1].time_s - stream.happens_s),
            error_deg: (!errors.is_empty()).then(|| (squares / errors.len() as f64).sqrt()),
            sigmas: judged.iter().filter_map(|one| one.sigmas).collect(),
            tracking_beyond_s: longest_beyond_s(&judged),
            changes: due,
            missed,
            false_events,
        }
    }
}

fn judged(stream: &Stream, steps: &[Step]) -> Vec<Judged> {
    let from_ns = time_ns(stream.judged_from_s);
    let rows = steps.iter().zip(&stream.simulation.truth).filter(|(step, _)| step.reading.time_ns >= from_ns);
    rows.filter_map(|(step, truth)| {
        let to_device = truth.attitude.inverse();
        let up = to_device * Vector3::z();
        let expected =
            heading(&(to_device * stream.earth_ut), &up, ReferenceAxis::TopEdge, ScreenRotation::Deg0)?.heading_deg;
        (up.y.abs() < STEEP).then(|| {
            let found = step.reading.heading;
            let error_deg = found.map(|found| ((found.heading_deg - expected + 540.0).rem_euclid(360.0) - 180.0).abs());
            let sigma_deg = found.and_then(|found| found.heading_sigma_deg).filter(|sigma| *sigma > 0.0);
            Judged {
                time_s: step.reading.time_ns as f64 / 1e9,
                error_deg,
                sigmas: error_deg.zip(sigma_deg).map(|(error, sigma)| error / sigma),
                is_tracking: step.reading.status == Status::Tracking,
            }
        })
    })
    .collect()
}

/// Longest stretch of samples that are `Tracking` and wrong by more than three sigmas, s.
fn longest_beyond_s(judged: &[Judged]) -> f64 {
    let (mut longest_s, mut stretch_s) = (0.0_f64, 0.0);
    for pair in judged.windows(2) {
        let is_beyond = |one: &Judged| one.is_tracking && one.sigmas.is_some_and(|sigmas| sigmas > BEYOND_SIGMAS);
        let apart_s = pair[1].time_s - pair[0].time_s;
        let goes_on = apart_s < APART_S && pair.iter().all(is_beyond);
        stretch_s = if goes_on { stretch_s + apart_s } else { 0.0 };
        longest_s = longest_s.max(stretch_s);
    }
    longest_s
}

/// Changes that no event reported, and events that belong to no change.
fn compare(stream: &Stream, steps: &[Step]) -> (usize, usize) {
    let mut events = events(steps);
    let mut missed = 0;
    for expected in &stream.expected {
        let belongs = events.iter().position(|event| {
            let decided = time_ns(expected.from_s)..time_ns(expected.until_s);
            decided.contains(&event.decided_ns) && expected.is(event.kind)
        });
        match belongs {
            Some(k) => drop(events.remove(k)),
            None => missed += usize::from(expected.is_due),
        }
    }
    (missed, events.len())
}

impl SituationResult {
    fn of(name: String, runs: &[Outcome]) -> Self {
        let all: Vec<f64> = runs.iter().flat_map(|run| &run.sigmas).copied().collect();
        let within = |sigmas: f64| all.iter().filter(|error| **error <= sigmas).count() as f64 / all.len() as f64;
        Self {
            name,
            answered: Spread::of(&runs.iter().map(|run| run.answered).collect::<Vec<_>>()).mean,
            settled_s: Runs::of(runs.iter().map(|run| run.settled_s)),
            // a run without a heading has no error
            error_deg: Runs::of(runs.iter().map(|run| run.error_deg).filter(Option::is_some)),
            within_sigma: (!all.is_empty()).then(|| [within(1.0), within(2.0)]),
            tracking_beyond_s: runs.iter().map(|run| run.tracking_beyond_s).fold(0.0, f64::max),
            changes: runs.iter().map(|run| run.changes).sum(),
            missed: runs.iter().map(|run| run.missed).sum(),
            false_events: runs.iter().map(|run| run.false_events).sum(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_unbroken_tracking_counts() {
        let at = |k: usize, sigmas, is_tracking| Judged {
            time_s: k as f64 / 100.0,
            error_deg: Some(9.0),
            sigmas: Some(sigmas),
            is_tracking,
        };
        let mut judged: Vec<Judged> = (0..300).map(|k| at(k, 4.0, true)).collect();
        assert!((longest_beyond_s(&judged) - 2.99).abs() < 1e-9);
        judged[100] = at(100, 2.9, true);
        judged[250] = at(250, 4.0, false);
        assert!((longest_beyond_s(&judged) - 1.48).abs() < 1e-9);
        // a pause is no stretch of samples
        judged.iter_mut().skip(180).for_each(|one| one.time_s += 20.0);
        assert!((longest_beyond_s(&judged) - 0.99).abs() < 1e-9);
    }

    #[test]
    fn runs_without_a_value_are_the_worst() {
        assert_eq!(Runs::of([Some(3.0), None, Some(1.0)].into_iter()), Runs { median: Some(3.0), worst: None });
        assert_eq!(Runs::of([None, None, Some(1.0)].into_iter()), Runs { median: None, worst: None });
        assert_eq!(Runs::of([Some(2.0), Some(1.0)].into_iter()), Runs { median: Some(2.0), worst: Some(2.0) });
    }
}
