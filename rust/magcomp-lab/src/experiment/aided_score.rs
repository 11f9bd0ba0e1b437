//! Figures of one run of the aided experiment.
//!
//! * direction error: the angle between an answer and the true field. f as it is given, against the field of the
//!   undisturbed place, which it carries; c as the calibration in force
//!   makes it of the noise-free sample, so that it is the calibration that is judged;
//! * settled: the first sample from which on the 95th percentile over the trailing 100, all after the step, stays below
//!   a limit up to the end;
//! * sigma: the azimuth of the answer by the true attitude, against the sigma that was given with it.

use super::Spread;
use crate::phone::CHANGE_S;
use crate::replay::Step;
use crate::simulate::{Simulation, Truth};
use crate::time::time_ns;
use magcomp::nalgebra::Vector3;
use magcomp::{Event, EventKind};
use serde::Serialize;

/// Samples over which the percentile is taken.
const TRAILING: usize = 100;
/// That percentile of them, as an index of the sorted.
const NINETY_FIFTH: usize = TRAILING * 95 / 100;
/// Time before the step that counts as steady, s.
const STEADY_S: f64 = 10.0;
/// Sigmas count from here, s.
const WARM_UP_S: f64 = 20.0;
/// Samples after the step at which b is compared.
const COMPARED_AT: usize = 300;
/// The error of no answer, degrees.
const NO_ANSWER_DEG: f64 = 180.0;

/// Over the runs. There is no median where half of them never get there, and no worst where one does not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Settling {
    /// Median, samples.
    pub median: Option<usize>,
    /// Worst, samples.
    pub worst: Option<usize>,
}

/// One answer of one method.
#[derive(Clone, Debug, Serialize)]
pub struct MethodResult {
    /// Method and answer.
    pub name: &'static str,
    /// Direction error over the last 10 s before the step, rms, degrees; none without an answer.
    pub before_rms_deg: Option<Spread>,
    /// Samples after the step until the 95th percentile of the trailing 100 stays below 5 deg for good.
    pub below_5_deg: Settling,
    /// The same for 2 deg.
    pub below_2_deg: Settling,
    /// |b - true b|, 300 samples after the step, uT.
    pub hard_iron_error_ut: Option<Spread>,
    /// Share of heading errors within one and two of their sigmas, from 20 s on.
    pub within_sigma: Option<[f64; 2]>,
    /// NEES of b per axis over the last 10 s before the step: 1 where its covariance is right. For f not given.
    pub nees: Option<f64>,
    /// Device steps declared in a run, mean.
    pub device_events: f64,
    /// Other events declared in a run, mean.
    pub other_events: f64,
}

/// Which of a reading's vectors is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Answer {
    /// f, the carried field.
    Carried,
    /// c, the corrected sample.
    Corrected,
}

impl Answer {
    fn of(self, step: &Step) -> Option<Vector3<f64>> {
        match self {
            Self::Carried => step.reading.filtered_field_ut,
            Self::Corrected => step.reading.field_ut,
        }
    }
}

/// One answer of one method in one run.
#[derive(Clone, Debug)]
pub struct Outcome {
    before_rms_deg: f64,
    settled: [Option<usize>; 2],
    hard_iron_error_ut: f64,
    /// Heading errors in sigmas.
    sigmas: Vec<f64>,
    nees: Option<f64>,
    events: Vec<Event>,
}

/// Scores a run in a place whose undisturbed field is `earth_ut`, east-north-up: f should carry that one.
pub fn score(
    stream: &Simulation,
    steps: &[Step],
    nees: &[Option<f64>],
    answer: Answer,
    earth_ut: Vector3<f64>,
) -> Outcome {
    let expected = |truth: &Truth| match answer {
        Answer::Carried => truth.attitude.inverse() * earth_ut,
        Answer::Corrected => truth.field_ut,
    };
    let at = |time_s: f64| stream.magnetic.partition_point(|sample| sample.time_ns < time_ns(time_s));
    let (steady, step) = (at(CHANGE_S - STEADY_S), at(CHANGE_S));
    let errors_deg: Vec<f64> = (steps.iter().zip(&stream.truth))
        .map(|(step, truth)| direction_error_deg(step, truth, answer, &expected(truth)).unwrap_or(NO_ANSWER_DEG))
        .collect();
    let before: Vec<f64> = errors_deg[steady..step].iter().copied().filter(|error| *error < NO_ANSWER_DEG).collect();
    let squares: f64 = before.iter().map(|error| error * error).sum();
    let compared = (step + COMPARED_AT - 1).min(steps.len() - 1);
    let found = steps[compared].calibration.map(|calibration| *calibration.hard_iron_ut());
    let truth = stream.truth[compared].hard_iron_ut;
    let warm = at(WARM_UP_S);
    let sigmas = (steps.iter().zip(&stream.truth).skip(warm))
        .filter_map(|(step, truth)| sigmas(step, truth, answer, &expected(truth)));
    let nees: Vec<f64> = nees.get(steady..step).unwrap_or_default().iter().flatten().copied().collect();
    Outcome {
        before_rms_deg: (squares / before.len() as f64).sqrt(),
        settled: [5.0, 2.0].map(|limit| settled(&errors_deg[step..], limit)),
        hard_iron_error_ut: found.map_or(f64::NAN, |found| (found - truth).norm()),
        sigmas: sigmas.collect(),
        nees: (!nees.is_empty()).then(|| Spread::of(&nees).mean),
        events: events(steps),
    }
}

/// Every event, once.
#[must_use]
pub fn events(steps: &[Step]) -> Vec<Event> {
    let mut events: Vec<Event> = steps.iter().filter_map(|step| step.reading.event).collect();
    events.dedup();
    events
}

fn direction_error_deg(step: &Step, truth: &Truth, answer: Answer, field_ut: &Vector3<f64>) -> Option<f64> {
    let given = answer.of(step)?;
    let judged = match answer {
        Answer::Carried => given,
        Answer::Corrected => step.calibration?.correct(&truth.clean_ut),
    };
    Some(judged.angle(field_ut).to_degrees())
}

/// Heading error of an answer in sigmas: f with the heading's, c with its own over its horizontal part.
fn sigmas(step: &Step, truth: &Truth, answer: Answer, field_ut: &Vector3<f64>) -> Option<f64> {
    let (found, field) = (truth.attitude * answer.of(step)?, truth.attitude * field_ut);
    let azimuth = |v: &Vector3<f64>| v.x.atan2(v.y).to_degrees();
    let error = (azimuth(&found) - azimuth(&field) + 540.0).rem_euclid(360.0) - 180.0;
    let sigma = match answer {
        Answer::Carried => step.reading.heading?.heading_sigma_deg?,
        Answer::Corrected => step.reading.field_sigma_ut?.atan2(found.x.hypot(found.y)).to_degrees(),
    };
    (sigma > 0.0).then(|| error.abs() / sigma)
}

/// Samples from which on the 95th percentile of the trailing 100 stays below `limit`; none when not even at the end.
pub(super) fn settled(errors_deg: &[f64], limit: f64) -> Option<usize> {
    let settled = |window: &[f64]| window.iter().filter(|error| **error >= limit).count() < TRAILING - NINETY_FIFTH;
    let windows = errors_deg.windows(TRAILING);
    let count = windows.len();
    let good = windows.rev().take_while(|window| settled(window)).count();
    (good > 0).then(|| count - good + TRAILING)
}

impl MethodResult {
    /// Many runs in a line.
    pub fn of(name: &'static str, runs: &[Outcome]) -> Self {
        // a run without an answer has none
        let spread = |value: fn(&Outcome) -> f64| {
            let values: Vec<f64> = runs.iter().map(value).filter(|value| value.is_finite()).collect();
            (!values.is_empty()).then(|| Spread::of(&values))
        };
        let settling = |limit: usize| {
            let mut times: Vec<usize> = runs.iter().map(|run| run.settled[limit].unwrap_or(usize::MAX)).collect();
            times.sort_unstable();
            let known = |time: Option<&usize>| time.copied().filter(|time| *time < usize::MAX);
            Settling { median: known(times.get(times.len() / 2)), worst: known(times.last()) }
        };
        let all: Vec<f64> = runs.iter().flat_map(|run| &run.sigmas).copied().collect();
        let within = |sigmas: f64| all.iter().filter(|error| **error <= sigmas).count() as f64 / all.len() as f64;
        let nees: Vec<f64> = runs.iter().filter_map(|run| run.nees).collect();
        let is_device = |event: &&Event| matches!(event.kind, EventKind::DeviceStep | EventKind::DeviceStepBack);
        let device = |run: &Outcome| run.events.iter().filter(is_device).count() as f64;
        let per_run = |count: &dyn Fn(&Outcome) -> f64| runs.iter().map(count).sum::<f64>() / runs.len() as f64;
        Self {
            name,
            before_rms_deg: spread(|run| run.before_rms_deg),
            below_5_deg: settling(0),
            below_2_deg: settling(1),
            hard_iron_error_ut: spread(|run| run.hard_iron_error_ut),
            within_sigma: (!all.is_empty()).then(|| [within(1.0), within(2.0)]),
            nees: (!nees.is_empty()).then(|| Spread::of(&nees).mean),
            device_events: per_run(&device),
            other_events: per_run(&|run| run.events.len() as f64 - device(run)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settled_is_for_good() {
        let mut errors = vec![9.0; 50];
        errors.extend([1.0; 400]);
        // the last window with five bad samples ends at sample 45 + 100
        assert_eq!(settled(&errors, 5.0), Some(46 + TRAILING));
        errors[300..310].fill(9.0);
        assert_eq!(settled(&errors, 5.0), Some(306 + TRAILING));
        assert_eq!(settled(&errors, 0.5), None);
        assert_eq!(settled(&[1.0; 200], 5.0), Some(TRAILING));
    }
}
