//! `magcomp demo`: real recordings compensated, then the aided method's steps, then the paper's, and a report of all.

use super::common::Common;
use crate::error::LabError;
use crate::experiment::follow::{self, FollowOptions, FollowResult};
use crate::experiment::step::{StepOptions, StepResult, run as run_step};
use crate::motion::Motion;
use crate::recording::{self, Recording};
use crate::replay::{Ignore, Judgement, figures, judge, replay, usual_part};
use crate::report::Report;
use crate::table::{Table, number};
use clap::{Args, value_parser};
use magcomp::{Config, Method, ReferenceAxis};
use serde::Serialize;
use std::path::Path;

/// The recordings shown, which are part of the program, and their stories.
const RECORDINGS: [(&str, &[u8], &str); 2] = [
    (
        "broad_34_attached_magnet_3cm.csv.gz",
        include_bytes!("../../../../tests/recordings/broad_34_attached_magnet_3cm.csv.gz"),
        "A magnet is attached to the sensor at 45 s and removed again at 100 s. A calibration that is kept can be right for \
         one of the two only; one that is re-estimated follows.",
    ),
    (
        "broad_01_slow_rotation_A.csv.gz",
        include_bytes!("../../../../tests/recordings/broad_01_slow_rotation_A.csv.gz"),
        "Slow rotations of a sensor that its maker has calibrated well: there is nothing to gain, and little must be lost.",
    ),
];
/// The methods shown, the sensors they go without, and whether they are drawn.
const METHODS: [(&str, Method, Ignore, bool); 4] = [
    ("constant", Method::Constant, Ignore { gyroscope: true, accelerometer: false }, false),
    ("windowed", Method::Windowed, Ignore { gyroscope: true, accelerometer: false }, false),
    ("adaptive (--ignore gyro)", Method::Auto, Ignore { gyroscope: true, accelerometer: false }, false),
    ("aided", Method::Auto, Ignore { gyroscope: false, accelerometer: false }, true),
];
/// Runs of an aided step: they agree well, the paper's do not.
const AIDED_RUNS: usize = 10;
/// Where the report is written when no other folder is named, below the current one.
const FOLDER: &str = "magcomp-report";

/// Show compensated recordings, then the step experiments: with the gyroscope, then the paper's.
///
/// The report is written into magcomp-report below the current folder, or where --report says. The recordings are part of the
/// program.
#[derive(Debug, Args)]
pub(super) struct Demo {
    /// Runs of the paper's step experiment
    #[arg(long, default_value_t = 60, value_parser = value_parser!(u32).range(1..))]
    runs: u32,
    #[command(flatten)]
    common: Common,
}

#[derive(Serialize)]
struct Shown {
    recording: String,
    method: &'static str,
    judgement: Judgement,
}

#[derive(Serialize)]
struct Everything {
    recordings: Vec<Shown>,
    aided: Vec<FollowResult>,
    step: StepResult,
}

impl Demo {
    pub fn run(mut self) -> Result<(), LabError> {
        self.common.report.get_or_insert_with(|| FOLDER.into());
        let mut report = Report::new(
            "magcomp: a magnetometer freed from its phone",
            "Real recordings first, then simulated phones, then the paper's experiment. Every answer uses nothing later than \
             its own sample.",
        );
        let mut recordings = Vec::new();
        for (name, bytes, story) in RECORDINGS {
            let recording = recording::read_from(Path::new(name), bytes)?;
            report.section(name, story);
            recordings.extend(show(&recording, &mut report)?);
        }
        let table = recording_table(&recordings);
        report.table(&table);

        let mut aided = Vec::new();
        for (motion, figure) in [(Motion::Tumble, "step_tumble"), (Motion::Pedestrian, "step_pedestrian")] {
            let Some(options) = FollowOptions::of(motion) else { continue };
            let result = follow::run(&FollowOptions { seed: self.common.seed, runs: AIDED_RUNS, ..options })?;
            report.section(&result.scenario, "A simulated phone from a cold start; the picture shows the first run.");
            result.add_to(&mut report, figure)?;
            aided.push(result);
        }

        let step =
            run_step(&StepOptions { runs: self.runs as usize, seed: self.common.seed, ..StepOptions::default() })?;
        report.section(
            "All nine parameters step by 50 %",
            "The paper's simulation (its figs. 4 and 5): even orientations, 30 dB, windows of 100 to 2000 samples.",
        );
        step.add_to(&mut report)?;

        let [parameters, angles] = step.tables();
        let mut tables = vec![table];
        tables.extend(aided.iter().flat_map(FollowResult::tables));
        tables.extend([parameters, angles]);
        let everything = Everything { recordings, aided, step };
        self.common.finish(&tables, &everything, || Ok(report))
    }
}

/// One recording with every method; one of them is drawn.
fn show(recording: &Recording, report: &mut Report) -> Result<Vec<Shown>, LabError> {
    let mut shown = Vec::new();
    for (name, method, ignore, drawn) in METHODS {
        let config = Config { method, ..Config::default() };
        let steps = replay(recording, &config, ignore)?;
        if drawn {
            let figure = recording.name().replace(".csv.gz", "");
            figures(report, &figure, recording, &steps)?;
        }
        shown.push(Shown {
            recording: recording.name(),
            method: name,
            judgement: judge(recording, &steps, usual_part(&recording.extent()), ReferenceAxis::default()),
        });
    }
    Ok(shown)
}

fn recording_table(shown: &[Shown]) -> Table {
    let mut table = Table::new(
        "Real recordings (BROAD, CC BY 4.0)",
        &[
            "recording, method",
            "rows",
            "answered %",
            "spread of total field uT",
            "heading c rms deg",
            "p95 deg",
            "f rms deg",
            "ns per push",
        ],
    );
    let mut before = String::new();
    for Shown { recording, method, judgement } in shown {
        if *recording != before {
            before.clone_from(recording);
            let raw = judgement.raw_heading;
            table.row(vec![
                format!("{recording}: raw"),
                judgement.rows.to_string(),
                String::new(),
                number(judgement.total_field_ut.raw.map(|field| field.spread), 2),
                number(raw.map(|raw| raw.rms_deg), 2),
                number(raw.map(|raw| raw.p95_deg), 2),
                String::new(),
                String::new(),
            ]);
        }
        let heading = judgement.heading;
        table.row(vec![
            format!("  {method}"),
            judgement.rows.to_string(),
            number(Some(100.0 * judgement.answered), 1),
            number(judgement.total_field_ut.compensated.map(|field| field.spread), 2),
            number(heading.map(|heading| heading.rms_deg), 2),
            number(heading.map(|heading| heading.p95_deg), 2),
            number(judgement.carried_heading.map(|heading| heading.rms_deg), 2),
            number(Some(judgement.mean_push_ns), 0),
        ]);
    }
    table.note(
        "Spread: standard deviation. c: the corrected sample; f: the field that the gyroscope carries. \
         Headings are judged by the optical reference, up to one constant. The first 20 s do not count.",
    );
    table.note(
        "constant: one calibration, kept. windowed: the paper's method. adaptive: the magnetometer alone. aided: with gyroscope and \
         gravity. Each is judged on the samples that it answered, raw on those of the first method.",
    );
    table
}
