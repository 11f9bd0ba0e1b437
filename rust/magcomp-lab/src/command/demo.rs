//! `magcomp demo`: a magnet on a real sensor, then simulated phones, then the paper's experiment, and a report of all.

use super::common::Common;
use crate::error::LabError;
use crate::experiment::follow::{self, FollowOptions, FollowResult};
use crate::experiment::step::{StepOptions, StepResult, run as run_step};
use crate::experiment::story::Story;
use crate::motion::Motion;
use crate::recording::{self, Recording};
use crate::replay::{Ignore, Judgement, Step, figures, judge, offset_picture, replay, usual_part};
use crate::report::Report;
use crate::table::{Table, number};
use clap::{Args, value_parser};
use magcomp::{Config, Method, ReferenceAxis};
use serde::Serialize;
use std::ops::Range;
use std::path::Path;

/// A recording that is part of the program.
struct Shown {
    name: &'static str,
    bytes: &'static [u8],
    about: &'static str,
}

const MAGNET: Shown = Shown {
    name: "broad_33_attached_magnet_2cm.csv.gz",
    bytes: include_bytes!("../../../../tests/recordings/broad_33_attached_magnet_2cm.csv.gz"),
    about: "A wireless sensor with an optical reference (BROAD, CC BY 4.0). It lies still; a magnet is put on it at 42 s; it is turned about until \
            134 s, and at 99 s the magnet is taken off.",
};
/// From when to when the magnet sat there, s after the first row; and without and with it, the hand away.
const MAGNET_S: Range<f64> = 42.5..98.7;
const STRETCHES: [(Range<f64>, &str); 2] = [(102.0..200.0, "without the magnet"), (46.0..90.0, "with it")];
/// The plane in which the magnet's field shows: x and z of the sensor.
const PLANE: (usize, usize) = (0, 2);
const QUIET: Shown = Shown {
    name: "broad_01_slow_rotation_A.csv.gz",
    bytes: include_bytes!("../../../../tests/recordings/broad_01_slow_rotation_A.csv.gz"),
    about: "Slow rotations of a sensor that its maker has calibrated well: there is nothing to gain, and little must be lost.",
};
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

/// Show what it does on one page: a magnet on a real sensor, simulated phones, the paper's experiment.
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

/// A method on a recording.
#[derive(Serialize)]
struct Judged {
    recording: String,
    method: &'static str,
    judgement: Judgement,
}

#[derive(Serialize)]
struct Everything {
    recordings: Vec<Judged>,
    aided: Vec<FollowResult>,
    step: StepResult,
}

impl Demo {
    pub fn run(mut self) -> Result<(), LabError> {
        self.common.report.get_or_insert_with(|| FOLDER.into());
        let [(magnet, drawn, mut recordings), (quiet, quiet_drawn, others)] = [played(&MAGNET)?, played(&QUIET)?];
        recordings.extend(others);
        let story = Story::of(&magnet, MAGNET_S)?;
        let follow = |motion| match FollowOptions::of(motion) {
            Some(options) => {
                follow::run(&FollowOptions { seed: self.common.seed, runs: AIDED_RUNS, ..options }).map(Some)
            }
            None => Ok(None),
        };
        let [tumble, walk] = [follow(Motion::Tumble)?, follow(Motion::Walk)?];
        let aided: Vec<FollowResult> = [tumble, walk].into_iter().flatten().collect();
        let step =
            run_step(&StepOptions { runs: self.runs as usize, seed: self.common.seed, ..StepOptions::default() })?;
        let table = recording_table(&recordings);

        let mut report = Report::new("magcomp: a magnetometer freed from its phone", &conclusion(&story, &aided));
        report.section("A magnet on a real sensor", MAGNET.about);
        report.figure(
            "heading_error",
            story.picture()?,
            "Rms over a second, up to one constant, against the optical reference.",
        );
        report.figure(
            "offset",
            offset_picture(&magnet, &drawn, PLANE, &STRETCHES),
            "Raw samples (orange) lie about the device's own field b (red line and ring: where it was found), corrected ones (blue) about the \
             middle. The last calibration of each stretch.",
        );
        report.folded("Everything over time, and the sphere to turn", |report| {
            figures(report, &magnet.name().replace(".csv.gz", ""), &magnet, &drawn)
        })?;
        report.folded("A recording in which nothing disturbs", |report| {
            report.text(QUIET.about);
            figures(report, &quiet.name().replace(".csv.gz", ""), &quiet, &quiet_drawn)
        })?;
        report.table(&table);
        for (result, figure) in aided.iter().zip(["step_tumble", "step_walk"]) {
            report.section(&format!("Simulated phones, {}", result.scenario), "Each from a cold start.");
            result.tables().iter().take(1).for_each(|table| report.table(table));
            report.folded("The first of them over time, and the time of every method", |report| {
                result.add_to(report, figure)
            })?;
        }
        report.section(
            "The paper's experiment: M - I and b grow by half",
            "Its simulation (figs. 4 and 5): even orientations, 30 dB, windows of 100 to 2000 samples.",
        );
        report.folded("Its figures and tables made again", |report| step.add_to(report))?;

        let [parameters, angles] = step.tables();
        let mut tables = vec![table];
        tables.extend(aided.iter().flat_map(FollowResult::tables));
        tables.extend([parameters, angles]);
        let everything = Everything { recordings, aided, step };
        self.common.finish(&tables, &everything, || Ok(report))
    }
}

/// What all of it comes to, in three sentences.
fn conclusion(story: &Story, aided: &[FollowResult]) -> String {
    let [raw, papers, ours] = story.errors_deg()[..] else { return String::new() };
    let seconds = |name: &str| {
        let answer = aided.first()?.answers.iter().find(|answer| answer.name == name)?;
        answer.below_2_deg.median
    };
    let told = |name: &str| seconds(name).map_or_else(|| "never".to_owned(), |s| format!("after {s:.1} s"));
    format!(
        "A magnet of 27 uT is put on a sensor: its raw heading is {raw:.0} degrees off, that of the paper's real-time method \
         {papers:.0}, ours {ours:.1} (rms up to one constant). When the disturbance of a simulated phone in a hand grows by half, our \
         corrected samples are right to 2 degrees {}, the paper's {} (medians). Every answer uses nothing later than its own sample.",
        told("aided, c"),
        told("windowed, c"),
    )
}

/// A recording, the steps of the method that is drawn, and every method judged.
fn played(shown: &Shown) -> Result<(Recording, Vec<Step>, Vec<Judged>), LabError> {
    let recording = recording::read_from(Path::new(shown.name), shown.bytes)?;
    let (mut drawn, mut judged) = (Vec::new(), Vec::new());
    for (method_name, method, ignore, is_drawn) in METHODS {
        let steps = replay(&recording, &Config { method, ..Config::default() }, ignore)?;
        let judgement = judge(&recording, &steps, usual_part(&recording.extent()), ReferenceAxis::default());
        judged.push(Judged { recording: recording.name(), method: method_name, judgement });
        if is_drawn {
            drawn = steps;
        }
    }
    Ok((recording, drawn, judged))
}

fn recording_table(shown: &[Judged]) -> Table {
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
    for Judged { recording, method, judgement } in shown {
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
