//! The worth of each choice of the estimators: a fixed benchmark with the choice halved and doubled.
//!
//! * error: angle between the truth, corrected, and the field, deg, at most 30; root mean square from 10 s on; the geometric
//!   mean over the streams, 0.05 deg at the least;
//! * beyond: share of corrected samples whose direction is off by more than 2.45 of their sigma per axis, which is one in twenty
//!   where sigma is right.

use crate::error::LabError;
use crate::motion::Motion;
use crate::phone::{Phone, PhoneChange};
use crate::progress;
use crate::simulate::Simulation;
use crate::table::Table;
use magcomp::{Choice, Compensator, Config, Method, Tunings};

/// Errors count from here on, s, and no error counts more, deg.
const FROM_S: f64 = 10.0;
const MOST_DEG: f64 = 30.0;
const LEAST_DEG: f64 = 0.05;
/// 95 % of vectors of two normal components are no longer, in standard deviations of a component.
const LONG: f64 = 2.45;

/// One line of the benchmark.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Score {
    error_deg: f64,
    beyond: f64,
}

/// The streams: seeds of development. A walker who turns seldom is no task without a gyroscope.
fn streams(estimator: &str) -> Vec<Simulation> {
    let motions = [Motion::Tumble, if estimator == "adaptive" { Motion::Stroll } else { Motion::Pedestrian }];
    let changes = [PhoneChange::Parameters, PhoneChange::Offset, PhoneChange::Place, PhoneChange::Drift];
    let each = motions.into_iter().flat_map(|motion| changes.map(|change| (motion, change)));
    each.enumerate()
        .map(|(k, (motion, change))| {
            let spikes = if k % 4 == 1 { 0.01 } else { 0.0 };
            Phone { seed: 1 + k as u64, motion, change, spikes, ..Phone::default() }.scenario().run()
        })
        .collect()
}

/// The benchmark of one estimator.
fn score(streams: &[Simulation], estimator: &str, tunings: Tunings) -> Result<Score, LabError> {
    let (mut log, mut beyond, mut count) = (0.0, 0.0, 0.0);
    for stream in streams {
        let method = if estimator == "adaptive" { Method::Adaptive } else { Method::Auto };
        let mut compensator = Compensator::tuned(Config { method, ..Config::default() }, tunings)?;
        let mut ups = stream.ups.iter().peekable();
        let mut rates = stream.rotation_rates.iter().filter(|_| method == Method::Auto).peekable();
        let (mut square, mut errors) = (0.0, 0.0);
        for (sample, truth) in stream.magnetic.iter().zip(&stream.truth) {
            while let Some(up) = ups.next_if(|up| up.time_ns <= sample.time_ns) {
                let _ = compensator.push_up(*up);
            }
            while let Some(rate) = rates.next_if(|rate| rate.time_ns <= sample.time_ns) {
                let _ = compensator.push_rotation_rate(*rate);
            }
            let reading = compensator.push(*sample);
            if (sample.time_ns as f64) < FROM_S * 1e9 {
                continue;
            }
            let off = |known: magcomp::Calibration| known.correct(&truth.clean_ut).angle(&truth.field_ut).to_degrees();
            square += compensator.calibration().map_or(MOST_DEG, off).min(MOST_DEG).powi(2);
            errors += 1.0;
            if let (Some(field), Some(sigma), false) = (reading.field_ut, reading.field_sigma_ut, truth.spike) {
                beyond += f64::from(u8::from(field.angle(&truth.field_ut) > LONG * sigma / field.norm()));
                count += 1.0;
            }
        }
        log += (square / errors).sqrt().max(LEAST_DEG).ln() / streams.len() as f64;
    }
    Ok(Score { error_deg: log.exp(), beyond: 100.0 * beyond / f64::max(count, 1.0) })
}

/// The figures with a choice halved and doubled.
struct Line {
    estimator: &'static str,
    choice: &'static Choice,
    scores: [Score; 2],
}

/// Every choice, as markdown: docs/TUNING.md.
///
/// # Errors
/// [`LabError::Config`].
pub fn run() -> Result<Table, LabError> {
    let streams = ["adaptive", "aided"].map(|estimator| (estimator, streams(estimator)));
    let of = |estimator: &str, tunings: Tunings| {
        let own = streams.iter().find(|(name, _)| *name == estimator).map_or(&[][..], |(_, own)| own);
        score(own, estimator, tunings)
    };
    let choices: Vec<_> = Tunings::list().collect();
    let bar = progress::bar(choices.len(), "sensitivity");
    let line = |(estimator, choice): &(&'static str, &'static Choice)| {
        let with = |factor: f64| {
            let mut tunings = Tunings::default();
            assert!(tunings.set(estimator, choice.name, choice.value * factor), "a choice that is listed");
            of(estimator, tunings)
        };
        let scores = [with(0.5)?, with(2.0)?];
        bar.inc(1);
        Ok(Line { estimator, choice, scores })
    };
    // two at a time
    let (even, odd): (Vec<Result<Line, LabError>>, Vec<_>) = std::thread::scope(|scope| {
        let halves = [0, 1].map(|half| {
            let (choices, line) = (&choices, &line);
            scope.spawn(move || choices.iter().skip(half).step_by(2).map(line).collect())
        });
        let [even, odd] = halves.map(|half| half.join().expect("no panic"));
        (even, odd)
    });
    bar.finish_and_clear();
    let mut odd = odd.into_iter();
    let lines = even.into_iter().flat_map(|line| std::iter::once(line).chain(odd.next()));
    let mut table = Table::new(
        "# Choices of the estimators, and what each is worth",
        &[
            "estimator",
            "choice",
            "value",
            "unit",
            "error, half",
            "double",
            "beyond, half",
            "double",
            "what it is",
            "source",
        ],
    );
    let mut usual = Vec::new();
    for estimator in ["adaptive", "aided"] {
        let score = of(estimator, Tunings::default())?;
        table.note(&format!("{estimator}: error {:.2} deg, beyond {:.1} %\\", score.error_deg, score.beyond));
        usual.push((estimator, score));
    }
    table.note(
        "Error: what is corrected against the field, root mean square of each stream, geometric mean of all. Beyond: share of \
         corrected samples whose direction is off by more than 2.45 of their sigma, 5 % where it is right; in points. Half and double: the choice \
         half and twice as large. Made by `cargo run --release -- sensitivity`: streams of a phone that is turned about and \
         carried, whose soft and hard iron, hard iron, place or drift changes.",
    );
    for line in lines {
        let Line { estimator, choice, scores } = line?;
        let base = usual.iter().find(|(name, _)| *name == estimator).map_or(scores[0], |(_, score)| *score);
        let error = |score: Score| format!("{:+.0} %", 100.0 * (score.error_deg / base.error_deg - 1.0));
        let beyond = |score: Score| format!("{:+.1}", score.beyond - base.beyond);
        let [half, double] = scores;
        table.row(vec![
            estimator.to_owned(),
            choice.name.to_owned(),
            format!("{}", choice.value),
            choice.unit.to_owned(),
            error(half),
            error(double),
            beyond(half),
            beyond(double),
            choice.meaning.trim().to_owned(),
            choice.source.to_owned(),
        ]);
    }
    Ok(table)
}
