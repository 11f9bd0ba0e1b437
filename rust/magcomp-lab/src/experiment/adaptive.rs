//! The adaptive method alone on a scenario: how soon it is right again, whether its sigmas are honest, how often it calls a
//! change that was none, and what a sample costs.
//!
//! * sigma: the heading error of each reading, of the noisy sample, in its own sigmas, up being known exactly;
//! * NEES: of b, and of all parameters (see `nees`), 1 on average where the covariance given is right;
//! * false alarms: device steps declared before the change, and afterwards more than there were;
//! * cost: the least over repeated runs of the same stream, sample by sample, so that it is ours and not the scheduler's.

use super::compare::{MethodScore, Run, follow};
use super::compare_view::{Given, case_table};
use super::config;
use super::nees::Nees;
use crate::error::LabError;
use crate::progress;
use crate::scenario::Case;
use crate::table::{Table, number};
use magcomp::nalgebra::Vector3;
use magcomp::{Compensator, Config, Event, Method, Status, UpSample};
use serde::Serialize;

/// Samples after the change at which a new period of the sigmas begins; the first ends there, the last at the end.
const PERIODS: [usize; 3] = [100, 1000, usize::MAX];
/// Names of the periods.
const PERIOD_NAMES: [&str; 4] = ["before", "0 to 100", "100 to 1000", "later"];
/// Readings before this many samples do not count: collecting.
const WARM_UP: usize = 500;

/// Options of the experiment.
#[derive(Clone, Copy, Debug)]
pub struct AdaptiveOptions {
    /// The scenario.
    pub case: Case,
    /// Runs.
    pub runs: usize,
    /// Names the random numbers; run k uses seed + k.
    pub seed: u64,
    /// Signal-to-noise ratio, dB; the scenario's own when none.
    pub snr_db: Option<f64>,
    /// Runs of each stream for the cost.
    pub repeats: usize,
}

/// Sigmas over a period.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct Honesty {
    /// Which.
    pub period: &'static str,
    /// Share of heading errors within one and two of their sigmas; NaN where there was no heading.
    pub within_sigma: [f64; 2],
    /// Mean NEES of b, and of all parameters.
    pub nees: Option<[f64; 2]>,
}

/// The result.
#[derive(Clone, Debug, Serialize)]
pub struct AdaptiveResult {
    /// The scenario.
    pub scenario: String,
    /// Runs.
    pub runs: usize,
    /// Samples in all runs.
    pub samples: usize,
    /// Errors.
    pub score: MethodScore,
    /// Sigmas.
    pub honesty: Vec<Honesty>,
    /// Device steps declared before the change, in all runs.
    pub false_alarms: usize,
    /// Share of the samples before the change whose status was suspect or disturbed.
    pub suspected_before: f64,
    /// Device steps declared after the change, mean over runs.
    pub declared: f64,
    /// Samples from the change to the first declaration, median; none where there was none.
    pub delay_samples: Option<usize>,
}

#[derive(Default)]
struct Tally {
    sigmas: [Vec<f64>; 4],
    nees: [Vec<Nees>; 4],
    false_alarms: usize,
    suspected: usize,
    before: usize,
    declared: usize,
    delays: Vec<usize>,
}

/// Runs the adaptive method on a scenario.
///
/// # Errors
/// [`LabError::Config`].
pub fn run(options: &AdaptiveOptions) -> Result<AdaptiveResult, LabError> {
    let bar = progress::bar(options.runs, "adaptive");
    let (mut runs, mut tally, mut before, mut samples) = (Vec::new(), Tally::default(), 0, 0);
    for k in 0..options.runs {
        let plan = options.case.plan(options.seed.wrapping_add(k as u64), options.snr_db);
        let stream = plan.scenario.run();
        let field_ut = plan.scenario.world_ut.start.norm();
        let initial = options.case.initial(&plan);
        let config = Config { initial, ..config(Method::Adaptive) };
        before = plan.before;
        samples += stream.magnetic.len();
        let mut best: Option<Run> = None;
        for _ in 0..options.repeats.max(1) {
            let mut ours = crate::baseline::Ours::new(config.clone())?;
            let run = follow(&stream, &plan, &mut ours, field_ut, false);
            match &mut best {
                Some(best) => best.keep_fastest(&run),
                None => best = Some(run),
            }
        }
        runs.extend(best);
        tally.add(&stream, before, config)?;
        bar.inc(1);
    }
    bar.finish_and_clear();
    tally.delays.sort_unstable();
    let share = |values: &[f64], limit: f64| {
        values.iter().filter(|value| **value <= limit).count() as f64 / values.len() as f64
    };
    let honesty = (0..4).map(|period| Honesty {
        period: PERIOD_NAMES[period],
        within_sigma: [1.0, 2.0].map(|limit| share(&tally.sigmas[period], limit)),
        nees: (!tally.nees[period].is_empty()).then(|| {
            [|nees: &Nees| nees.hard_iron, |nees: &Nees| nees.mean_square]
                .map(|of| tally.nees[period].iter().map(of).sum::<f64>() / tally.nees[period].len() as f64)
        }),
    });
    Ok(AdaptiveResult {
        scenario: options.case.name(),
        runs: options.runs,
        samples,
        score: MethodScore::of("adaptive", None, before, &runs),
        honesty: honesty.collect(),
        false_alarms: tally.false_alarms,
        suspected_before: tally.suspected as f64 / tally.before.max(1) as f64,
        declared: tally.declared as f64 / options.runs.max(1) as f64,
        delay_samples: tally.delays.get(tally.delays.len() / 2).copied(),
    })
}

impl Tally {
    /// A stream once more, with up and with a look at every reading.
    fn add(&mut self, stream: &crate::simulate::Simulation, before: usize, config: Config) -> Result<(), LabError> {
        let mut compensator = Compensator::new(config)?;
        let mut latest: Option<Event> = None;
        for (k, (sample, truth)) in stream.magnetic.iter().zip(&stream.truth).enumerate() {
            let up_m_s2 = truth.attitude.inverse() * Vector3::z() * 9.81;
            let _ = compensator.push_up(UpSample { time_ns: sample.time_ns, up_m_s2 });
            let reading = compensator.push(*sample);
            if reading.event != latest {
                latest = reading.event;
                if k < before {
                    self.false_alarms += 1;
                } else {
                    self.declared += 1;
                    self.delays.push(k - before);
                }
            }
            if k < before {
                self.before += 1;
                self.suspected +=
                    usize::from(matches!(reading.status, Status::Suspect { .. } | Status::Disturbed { .. }));
            }
            if k < WARM_UP {
                continue;
            }
            let period = if k < before {
                0
            } else {
                1 + PERIODS.iter().position(|end| k - before < *end).unwrap_or(PERIODS.len() - 1)
            };
            if !truth.spike
                && let (Some(heading), Some(field)) = (reading.heading, reading.field_ut)
                && let Some(sigma) = heading.heading_sigma_deg.filter(|sigma| *sigma > 0.0)
            {
                let azimuth = |v: Vector3<f64>| v.x.atan2(v.y).to_degrees();
                let off = azimuth(truth.attitude * field) - azimuth(truth.attitude * truth.field_ut);
                let error = (off + 540.0).rem_euclid(360.0) - 180.0;
                self.sigmas[period].push(error.abs() / sigma);
            }
            if k % 100 == 50 {
                self.nees[period].extend(Nees::of(&compensator, truth));
            }
        }
        Ok(())
    }
}

impl AdaptiveResult {
    /// Two tables.
    #[must_use]
    pub fn tables(&self) -> Vec<Table> {
        let score = std::slice::from_ref(&self.score);
        let mut tables = case_table(&self.scenario, self.runs as u32, score, Given::Magnetometer);
        let columns = ["", "within 1 sigma %", "within 2 sigma %", "NEES of b", "of all"];
        let mut table = Table::new(&format!("{}: are the sigmas honest?", self.scenario), &columns);
        for honesty in &self.honesty {
            table.row(vec![
                honesty.period.to_owned(),
                number(Some(100.0 * honesty.within_sigma[0]), 1),
                number(Some(100.0 * honesty.within_sigma[1]), 1),
                number(honesty.nees.map(|[b, _]| b), 2),
                number(honesty.nees.map(|[_, all]| all), 2),
            ]);
        }
        table.note("Sigma: share of the heading errors within one and two of their own sigmas; 68 and 95 % are right. In their covariance: mean square error of b, and of all parameters; 1 is right.");
        table.note(&format!(
            "The method declared {} device steps before the change in all runs, and {:.2} a run after it, the first {} samples late. Before the change {:.3} % of the samples were suspect or disturbed.",
            self.false_alarms,
            self.declared,
            self.delay_samples.map_or_else(|| "-".to_owned(), |delay| delay.to_string()),
            100.0 * self.suspected_before,
        ));
        tables.push(table);
        tables
    }
}
