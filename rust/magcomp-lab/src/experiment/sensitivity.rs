//! The worth of each choice of the estimators, and of each mechanism: a part of the catalogue with the choice halved and doubled, with the
//! mechanism off.
//!
//! * error: the heading's, from 20 s on, as `score` says, 30 degrees at most and where there is no heading; geometric mean over variants and
//!   seeds, 0.1 deg at the least;
//! * z2: the mean square of error over sigma, geometric mean, 0.01 at the least;
//! * noise: how far the change of a figure strays between two halves of the seeds, over two: that is the standard deviation of what is shown. Root mean
//!   square over all that change anything. A choice that moves no figure by more than twice that is not seen here.

use super::Spread;
use crate::catalogue::{Variant, find};
use crate::error::LabError;
use crate::parallel::{cores, map};
use crate::progress;
use crate::recording::Recording;
use crate::replay::{Player, Step};
use crate::score::{Figures, rms};
use crate::simulate::Simulation;
use crate::table::Table;
use magcomp::{Choice, Mechanism, Method, Tunings};
use std::ops::RangeInclusive;

/// Seeds of development.
pub const SEEDS: RangeInclusive<u64> = 1..=8;
/// What each estimator is tried on: motions, a step, a place, a drift, sensors, nothing at all.
const AIDED: [&str; 6] =
    ["motion.walk", "steps.b50-m", "places.uneven5", "places.room10s", "sensors.late40-game", "phone-walk-drift"];
/// A walker who turns seldom is no task without a gyroscope.
const ADAPTIVE: [&str; 4] = ["alone.step", "alone.stroll-steady", "alone.place", "alone.drift"];
/// No error counts more, or less, degrees; no z2 less.
const MOST_DEG: f64 = 30.0;
const LEAST_DEG: f64 = 0.1;
const LEAST_Z2: f64 = 0.01;
/// A choice changes nothing when the logarithm of a figure changes by no more than this.
const NOTHING: f64 = 1e-3;

/// The streams of one estimator, each with the half of the seeds that it belongs to.
struct Benchmark {
    estimator: &'static str,
    method: Method,
    streams: Vec<(Variant, Simulation, Recording, usize)>,
}

/// Logarithms of error and z2, the mean of each half of the seeds.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Score {
    error: [f64; 2],
    z2: [f64; 2],
}

impl Benchmark {
    fn new(
        estimator: &'static str,
        method: Method,
        names: &[&str],
        seeds: RangeInclusive<u64>,
    ) -> Result<Self, LabError> {
        let mut streams = Vec::new();
        for name in names {
            let variant = find(name).map_err(LabError::Usage)?;
            for (k, seed) in seeds.clone().enumerate() {
                let simulation = variant.stream(seed);
                let recording = Recording::of(&simulation, name);
                streams.push((variant.clone(), simulation, recording, k % 2));
            }
        }
        Ok(Self { estimator, method, streams })
    }

    fn score(&self, tunings: Tunings) -> Result<Score, LabError> {
        let mut score = Score::default();
        let each = self.streams.len() as f64 / 2.0;
        for (variant, simulation, recording, half) in &self.streams {
            let mut player = Player::tuned(variant.config(), self.method, tunings)?;
            let steps: Vec<Step> = recording.rows.iter().map(|row| player.play(row)).collect();
            let figures = Figures::of(simulation, &steps);
            let answered = figures.error.heading_deg.unwrap_or(MOST_DEG).min(MOST_DEG);
            // where there is no heading the error counts in full
            let share = figures.answered.unwrap_or(1.0);
            let error = (share * answered.powi(2) + (1.0 - share) * MOST_DEG.powi(2)).sqrt();
            score.error[*half] += error.max(LEAST_DEG).ln() / each;
            score.z2[*half] += figures.z2.unwrap_or(1.0).max(LEAST_Z2).ln() / each;
        }
        Ok(score)
    }
}

/// What is tried.
#[derive(Clone, Copy)]
enum Trial {
    /// A choice, times a factor.
    Scaled(&'static Choice, f64),
    /// Without a mechanism.
    Off(&'static Mechanism),
}

impl Trial {
    fn tunings(self, estimator: &str) -> Tunings {
        let mut tunings = Tunings::default();
        let is_there = match self {
            Self::Scaled(choice, factor) => tunings.set(estimator, choice.name, choice.value * factor),
            Self::Off(mechanism) => tunings.switch_off(estimator, mechanism.name),
        };
        assert!(is_there, "it is listed");
        tunings
    }
}

/// How the logarithms change with one trial, in each half of the seeds.
struct Line {
    estimator: &'static str,
    trial: Trial,
    change: Score,
}

/// Mean of both halves, as a change in per cent.
fn percent(halves: [f64; 2]) -> f64 {
    100.0 * ((halves[0] + halves[1]) / 2.0).exp_m1()
}

/// Every choice, as markdown: docs/dev/TUNING.md.
///
/// # Errors
/// [`LabError::Config`].
pub fn run(seeds: RangeInclusive<u64>) -> Result<Table, LabError> {
    let benchmarks = [
        Benchmark::new("adaptive", Method::Adaptive, &ADAPTIVE, seeds.clone())?,
        Benchmark::new("aided", Method::Auto, &AIDED, seeds.clone())?,
    ];
    let scaled = Tunings::list()
        .flat_map(|(estimator, choice)| [0.5, 2.0].map(|factor| (estimator, Trial::Scaled(choice, factor))));
    let off = Tunings::mechanisms().map(|(estimator, mechanism)| (estimator, Trial::Off(mechanism)));
    let trials: Vec<_> = scaled.chain(off).collect();
    let bar = progress::bar(trials.len(), "sensitivity");
    let usual = map(&benchmarks, cores(), |benchmark| benchmark.score(Tunings::default()));
    let usual: Vec<Score> = usual.into_iter().collect::<Result<_, _>>()?;
    let of = |estimator: &str| benchmarks.iter().position(|one| one.estimator == estimator).expect("an estimator");
    let lines = map(&trials, cores(), |&(estimator, trial)| {
        let score = benchmarks[of(estimator)].score(trial.tunings(estimator))?;
        bar.inc(1);
        let usual = usual[of(estimator)];
        let less = |a: [f64; 2], b: [f64; 2]| [a[0] - b[0], a[1] - b[1]];
        let change = Score { error: less(score.error, usual.error), z2: less(score.z2, usual.z2) };
        Ok(Line { estimator, trial, change })
    });
    bar.finish_and_clear();
    let lines = lines.into_iter().collect::<Result<Vec<_>, LabError>>()?;
    Ok(table(&benchmarks, &usual, &lines, &seeds))
}

fn table(benchmarks: &[Benchmark], usual: &[Score], lines: &[Line], seeds: &RangeInclusive<u64>) -> Table {
    let columns = [
        "estimator",
        "choice or mechanism",
        "value",
        "unit",
        "error, half",
        "double",
        "off",
        "z2, half",
        "double",
        "off",
        "what it is",
        "source",
    ];
    let mut table = Table::new("# Choices of the estimators, and what each is worth", &columns);
    for (benchmark, usual) in benchmarks.iter().zip(usual) {
        let own: Vec<&Line> = lines.iter().filter(|line| line.estimator == benchmark.estimator).collect();
        let noise = |halves: fn(&Score) -> [f64; 2]| {
            let all = own.iter().map(|line| halves(&line.change));
            let moved = all.filter(|[even, odd]| even.abs() > NOTHING || odd.abs() > NOTHING);
            100.0 * (rms(moved.map(|[even, odd]| even - odd)).unwrap_or(0.0) / 2.0).exp_m1()
        };
        let mean = |halves: [f64; 2]| Spread::of(&halves).mean.exp();
        table.note(&format!(
            "{}: error {:.2} deg, z2 {:.2}; noise of a change: {:.1} % of the error, {:.1} % of z2\\",
            benchmark.estimator,
            mean(usual.error),
            mean(usual.z2),
            noise(|score| score.error),
            noise(|score| score.z2),
        ));
    }
    table.note(&format!(
        "Error: of the published heading against the truth, root mean square of each run, geometric mean of all. z2: mean square of error over \
         sigma, 1 where sigma is right. Half and double: the change of both with the choice half and twice as large; off: without the mechanism. Noise: what a change strays by \
         between two halves of the seeds, over two, root mean square over all that change anything; a change of less than twice that is none. Made by `cargo run --release -- sensitivity`: seeds {} to {} \
         of {} for aided, of {} for adaptive.",
        seeds.start(),
        seeds.end(),
        AIDED.join(", "),
        ADAPTIVE.join(", "),
    ));
    let shown = |halves: [f64; 2]| format!("{:+.0} %", percent(halves));
    let mut rest = lines.iter();
    while let Some(Line { estimator, trial, change }) = rest.next() {
        let (name, value, unit, what, source) = match trial {
            Trial::Scaled(choice, _) => {
                (choice.name, format!("{}", choice.value), choice.unit, choice.meaning, choice.source)
            }
            Trial::Off(mechanism) => {
                (mechanism.name, "on".to_owned(), "", mechanism.meaning, "docs/dev/METHOD-AIDED.md")
            }
        };
        let changes = match trial {
            Trial::Scaled(..) => {
                let double = &rest.next().expect("half and double follow one another").change;
                let (error, z2) = ([change.error, double.error], [change.z2, double.z2]);
                [shown(error[0]), shown(error[1]), String::new(), shown(z2[0]), shown(z2[1]), String::new()]
            }
            Trial::Off(_) => {
                let none = String::new;
                [none(), none(), shown(change.error), none(), none(), shown(change.z2)]
            }
        };
        let mut row = vec![(*estimator).to_owned(), name.to_owned(), value, unit.to_owned()];
        row.extend(changes);
        row.extend([what.trim().to_owned(), source.to_owned()]);
        table.row(row);
    }
    table
}
