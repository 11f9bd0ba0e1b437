//! Methods side by side on the same samples of a scenario, from a cold start, each answered before the next is seen.
//!
//! Direction error: the angle between the true field and the method's correction of the noise-free raw sample, so that it is
//! the calibration that is judged; 90 deg where it has no answer. Held: the calibration that the method
//! itself had before the latest change. Settled is what `score` says.
//!
//! Methods with gyroscope and accelerometer are judged by the heading: the angle between the azimuths that the true attitude gives
//! what they answer and the true field.

use crate::baseline::{Baseline, Contestant, Known};
use crate::catalogue::Variant;
use crate::crb::FisherInformation;
use crate::parameters::{GROUPS, Parameters};
use crate::score::{Runs, settled};
use crate::simulate::Simulation;
use magcomp::Calibration;
use magcomp::nalgebra::{UnitQuaternion, Vector3};
use magcomp_replay::error::RunError;
use magcomp_replay::statistics::{self, percentile};
use serde::Serialize;
use std::time::Instant;

/// The error of no answer, degrees: that of a direction drawn at random.
pub(super) const NO_ANSWER_DEG: f64 = 90.0;
/// Samples before the change that count as steady.
const STEADY: usize = 1000;
/// Samples after which the error is compared with the bound.
pub const BOUND_AT: [usize; 5] = [30, 100, 300, 1000, 3000];
/// Samples after the change at which the rms over the runs is shown.
pub const TOLD_AT: [usize; 5] = [100, 300, 700, 1500, 3000];
/// How far the seeds for tuning are from those that are judged, and how many there are.
const TUNING_SEEDS: u64 = 1_000_000;
const TUNING_RUNS: u64 = 6;
/// Samples over which errors are averaged before they are compared with holding.
const COMPARED: usize = 50;
/// Samples before the change that the picture shows, and samples a point.
const SHOWN_BEFORE: usize = 500;
const SHOWN_STRIDE: usize = 10;
/// Errors below this do not count as harm, degrees.
const HARMLESS_DEG: f64 = 0.5;

/// One run of one method.
#[derive(Clone, Debug, Default)]
pub struct Run {
    /// Direction error at every sample, degrees.
    pub errors_deg: Vec<f32>,
    /// That of the calibration held since before the latest change.
    pub held_deg: Vec<f32>,
    /// Squared errors of theta at [`BOUND_AT`], and the bounds.
    bound: Vec<([f64; 9], [f64; 9])>,
    times_ns: Vec<u64>,
    rate_hz: f64,
}

/// A method on a scenario over all runs.
#[derive(Clone, Debug, Serialize)]
pub struct MethodScore {
    /// Its name.
    pub name: String,
    /// The value of its free number, tuned on other seeds; none without one.
    pub tuned: Option<f64>,
    /// Direction error rms over the last 1000 samples before the change, degrees.
    pub before_deg: f64,
    /// Over all samples after it.
    pub after_deg: f64,
    /// From 1000 samples after it.
    pub steady_deg: f64,
    /// Rms over the runs at [`TOLD_AT`] (the 50 samples that end there), degrees.
    pub told_deg: Vec<f64>,
    /// Seconds after the change until the 95th percentile over the trailing second stays below 5, 2 and 1 deg.
    pub settled_s: [Runs; 3],
    /// Largest ratio of the rms over runs and 50 samples to that of holding.
    pub worst_over_held: f64,
    /// The same over single runs, its 99th percentile.
    pub p99_over_held: f64,
    /// Error over the bound at [`BOUND_AT`], for M's diagonal, M's off-diagonal, b; none without parameters.
    pub over_bound: Option<Vec<[f64; 3]>>,
    /// Mean, 99.9th percentile and maximum of the time for a sample, ns.
    pub push_ns: [f64; 3],
    /// Rms over the runs and ten samples, from 500 samples before the change on: for the picture.
    #[serde(skip)]
    pub course_deg: Vec<(f64, f64)>,
}

/// Follows the stream of a plan; `aided`: with the events of gyroscope and accelerometer, judged by the heading.
pub fn follow(stream: &Simulation, before: usize, method: &mut dyn Baseline, field_ut: f64, aided: bool) -> Run {
    let mut run = Run { rate_hz: stream.rate_hz, ..Run::default() };
    let sample_at = |at_s: f64| (at_s * stream.rate_hz).round() as usize;
    let changes_at = |k: usize| stream.changes.iter().any(|change| sample_at(change.begins_s) == k);
    let mut held: Option<Calibration> = None;
    let (mut rates, mut ups) = (stream.rotation_rates.iter().peekable(), stream.ups.iter().peekable());
    for (k, (sample, truth)) in stream.magnetic.iter().zip(&stream.truth).enumerate() {
        if k == before || changes_at(k) {
            held = method.calibration();
        }
        if k < before {
            method.teach(truth.field_ut.normalize());
        }
        while let Some(rate) = rates.next_if(|rate| aided && rate.time_ns <= sample.time_ns) {
            method.push_rate(rate);
        }
        while let Some(up) = ups.next_if(|up| aided && up.time_ns <= sample.time_ns) {
            method.push_up(up);
        }
        let started = Instant::now();
        method.push(sample);
        run.times_ns.push(started.elapsed().as_nanos() as u64);
        let error = |found: Option<Vector3<f64>>| {
            let off_deg = |found: Vector3<f64>| match aided {
                true => heading_error_deg(&truth.attitude, &found, &truth.field_ut),
                false => found.angle(&truth.field_ut).to_degrees(),
            };
            found.map_or(NO_ANSWER_DEG, off_deg) as f32
        };
        run.errors_deg.push(error(method.correct(&truth.clean_ut)));
        let kept = || error(held.map(|held| held.correct(&truth.clean_ut)));
        run.held_deg.push(if k < before { 0.0 } else { kept() });
        if k >= before && BOUND_AT.contains(&(k + 1 - before)) {
            run.bound.extend(bound(stream, before, k, method.calibration(), field_ut));
        }
    }
    run
}

/// Angle between the azimuths of two vectors of the device.
fn heading_error_deg(attitude: &UnitQuaternion<f64>, found: &Vector3<f64>, field: &Vector3<f64>) -> f64 {
    let [found, field] = [found, field].map(|vector| (attitude * vector).xy());
    found.perp(&field).atan2(found.dot(&field)).to_degrees().abs()
}

/// Squared error of theta at sample k, and its bound from the samples since the change.
fn bound(
    stream: &Simulation,
    before: usize,
    k: usize,
    found: Option<Calibration>,
    field_ut: f64,
) -> Option<([f64; 9], [f64; 9])> {
    let truth = &stream.truth[k];
    let parameters = Parameters { soft_iron: truth.soft_iron, hard_iron: truth.hard_iron_ut / field_ut };
    let noise: f64 = (stream.magnetic.iter().zip(&stream.truth).filter(|(_, t)| !t.spike))
        .map(|(sample, truth)| (sample.field_ut - truth.clean_ut).norm_squared() / 3.0)
        .sum::<f64>();
    let count = stream.truth.iter().filter(|t| !t.spike).count() as f64;
    let mut information = FisherInformation::new(&parameters, (noise / count).sqrt() / field_ut)?;
    stream.truth[before..=k].iter().filter(|t| !t.spike).for_each(|t| information.add(&t.field_ut.normalize()));
    let variances = information.smallest_variances()?;
    let found = found?;
    let found = Parameters {
        soft_iron: found.soft_iron() * (found.field_strength_ut() / field_ut),
        hard_iron: found.hard_iron_ut() / field_ut,
    };
    let (found, truth) = (found.theta(), parameters.theta());
    Some((std::array::from_fn(|i| (found[i] - truth[i]).powi(2)), variances))
}

/// A stream of a variant, and the facts that a method is given.
fn prepare(variant: &Variant, seed: u64) -> (Simulation, Known) {
    let scenario = variant.scenario(seed);
    let field_ut = scenario.earth_ut.norm();
    let known = Known {
        seed,
        noise_ut: scenario.magnetometer.noise.sigma_ut(field_ut),
        field_ut,
        parameters: Some(scenario.device),
        reference: variant.change_s > 0.0,
        initial: variant.initial(&scenario),
    };
    (scenario.run(), known)
}

/// Runs a method over seeds; none where it cannot take part.
pub fn run_variant(
    variant: &Variant,
    seeds: std::ops::Range<u64>,
    contestant: Contestant,
    value: f64,
) -> Result<Option<(usize, Vec<Run>)>, RunError> {
    let before = (variant.change_s * variant.sensors.magnetometer.rate_hz).round() as usize;
    let takes_part = !contestant.is_aided() || variant.sensors.has_gyroscope;
    let mut runs = Vec::new();
    for seed in seeds {
        let (stream, known) = prepare(variant, seed);
        let Some(mut method) = contestant.make(value, &known)?.filter(|_| takes_part) else { return Ok(None) };
        runs.push(follow(&stream, before, method.as_mut(), known.field_ut, contestant.is_aided()));
    }
    Ok(Some((before, runs)))
}

/// The value of its free number with which a method does best after the change, on seeds that are not judged.
pub fn tune(variant: &Variant, seed: u64, contestant: Contestant) -> Result<f64, RunError> {
    let grid = contestant.grid();
    let mut best = (f64::INFINITY, grid[0]);
    for value in grid.iter().filter(|_| grid.len() > 1) {
        let first = seed.wrapping_add(TUNING_SEEDS);
        let Some((before, runs)) = run_variant(variant, first..first + TUNING_RUNS, contestant, *value)? else { break };
        let after = rms(runs.iter().flat_map(|run| &run.errors_deg[before..]));
        if after < best.0 {
            best = (after, *value);
        }
    }
    Ok(best.1)
}

fn rms<'a>(errors: impl Iterator<Item = &'a f32>) -> f64 {
    statistics::rms(errors.map(|error| f64::from(*error))).unwrap_or(0.0)
}

impl MethodScore {
    /// Many runs in a line.
    pub fn of(name: &str, tuned: Option<f64>, before: usize, runs: &[Run]) -> Self {
        let over = |range: std::ops::Range<usize>| rms(runs.iter().flat_map(|run| &run.errors_deg[range.clone()]));
        let end = runs.first().map_or(0, |run| run.errors_deg.len());
        let below = |run: &Run, limit: f64| {
            let since = run.errors_deg[before..].iter().enumerate();
            let errors: Vec<_> = since.map(|(k, error)| ((k + 1) as f64 / run.rate_hz, f64::from(*error))).collect();
            settled(&errors, run.rate_hz as usize, limit)
        };
        let settled_s = [5.0, 2.0, 1.0].map(|limit| Runs::of(runs.iter().map(|run| below(run, limit))));
        let windows = || (before..end.saturating_sub(COMPARED)).step_by(COMPARED / 2);
        let ratio = |error: f64, held: f64| error.max(HARMLESS_DEG) / held.max(HARMLESS_DEG);
        let worst = windows().map(|k| {
            let held = rms(runs.iter().flat_map(|run| &run.held_deg[k..k + COMPARED]));
            ratio(over(k..k + COMPARED), held)
        });
        let single = runs.iter().flat_map(|run| {
            windows()
                .map(|k| ratio(rms(run.errors_deg[k..k + COMPARED].iter()), rms(run.held_deg[k..k + COMPARED].iter())))
        });
        let over_bound = (0..BOUND_AT.len()).map(|n| {
            let at: Vec<_> = runs.iter().filter_map(|run| run.bound.get(n)).collect();
            GROUPS.map(|(_, group)| {
                let (mut error, mut least) = (0.0, 0.0);
                for (squares, variances) in &at {
                    error += squares[group.clone()].iter().sum::<f64>();
                    least += variances[group.clone()].iter().sum::<f64>();
                }
                (error / least).sqrt()
            })
        });
        let has_bound = runs.iter().all(|run| run.bound.len() == BOUND_AT.len());
        let times: Vec<f64> = runs.iter().flat_map(|run| run.times_ns.iter().map(|ns| *ns as f64)).collect();
        let mean = times.iter().sum::<f64>() / times.len().max(1) as f64;
        Self {
            name: name.to_owned(),
            tuned,
            before_deg: over(before - STEADY..before),
            after_deg: over(before..end),
            steady_deg: over(before + STEADY..end),
            told_deg: TOLD_AT.map(|k| over(before + k - COMPARED..(before + k).min(end))).to_vec(),
            settled_s,
            worst_over_held: worst.fold(0.0, f64::max),
            p99_over_held: percentile(single.collect(), 0.99),
            over_bound: has_bound.then(|| over_bound.collect()),
            push_ns: [mean, percentile(times.clone(), 0.999), percentile(times, 1.0)],
            course_deg: (before.saturating_sub(SHOWN_BEFORE)..end.saturating_sub(SHOWN_STRIDE))
                .step_by(SHOWN_STRIDE)
                .map(|k| (k as f64 - before as f64, over(k..k + SHOWN_STRIDE)))
                .collect(),
        }
    }
}
