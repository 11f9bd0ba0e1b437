//! `magcomp demo`: a magnet on a real sensor, then simulated phones, then the paper's experiment, and a report of all.

use super::common::Common;
use crate::error::LabError;
use crate::experiment::follow::{self, FollowOptions, FollowResult};
use crate::experiment::step::{StepOptions, StepResult, run as run_step};
use crate::experiment::story::Story;
use crate::motion::Motion;
use crate::replay::{Ignore, Step, figures, offset_picture, replay};
use crate::report::Report;
use crate::table::{Table, number};
use clap::{Args, value_parser};
use magcomp::Config;
use magcomp_recordings::recording::{self, Recording};
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

/// What it comes to: rms heading errors up to one constant, of a sensor that a magnet was put on.
#[derive(Serialize)]
struct Headline {
    /// In a few sentences.
    text: String,
    raw_deg: f64,
    papers_deg: f64,
    magcomp_deg: f64,
}

#[derive(Serialize)]
struct Everything {
    headline: Headline,
    recordings: [Story; 2],
    aided: Vec<FollowResult>,
    step: StepResult,
}

impl Demo {
    pub fn run(mut self) -> Result<(), LabError> {
        self.common.report.get_or_insert_with(|| FOLDER.into());
        let say = |what: &str| eprintln!("magcomp: {what} ...");
        say("1 of 3, recordings of a real sensor");
        let [(magnet, magnet_steps, story), (quiet, quiet_steps, quiet_story)] = [played(&MAGNET)?, played(&QUIET)?];
        say("2 of 3, simulated phones");
        let options = [Motion::Tumble, Motion::Walk].into_iter().filter_map(FollowOptions::of);
        let follow = |own| follow::run(&FollowOptions { seed: self.common.seed, runs: AIDED_RUNS, ..own });
        let aided = options.map(follow).collect::<Result<Vec<FollowResult>, _>>()?;
        say("3 of 3, the paper's experiment");
        let step =
            run_step(&StepOptions { runs: self.runs as usize, seed: self.common.seed, ..StepOptions::default() })?;
        let headline = Headline::of(&story, &aided);
        let table = heading_table(&headline.text, [&story, &quiet_story]);

        let mut report = Report::new("magcomp: a magnetometer freed from its phone", &headline.text);
        report.section("A magnet on a real sensor", MAGNET.about);
        report.figure(
            "heading_error",
            story.picture(&MAGNET_S)?,
            "Rms over a second, up to one constant, against the optical reference; at most 60 degrees are shown.",
        );
        report.figure(
            "offset",
            offset_picture(&magnet, &magnet_steps, PLANE, &STRETCHES),
            "Raw samples (grey) lie about the device's own field b (red line and ring: where it was found), corrected ones (blue) about the \
             middle. The last calibration of each stretch.",
        );
        report.table(&Table { lead: Vec::new(), ..table.clone() });
        report.folded("Everything over time, and the sphere to turn", |report| {
            figures(report, &magnet.name().replace(".csv.gz", ""), &magnet, &magnet_steps)
        })?;
        report.folded("A recording in which nothing disturbs", |report| {
            report.text(QUIET.about);
            figures(report, &quiet.name().replace(".csv.gz", ""), &quiet, &quiet_steps)
        })?;
        for (result, figure) in aided.iter().zip(["step_tumble", "step_walk"]) {
            report.section(&format!("Simulated phones, {}", result.scenario), "Each from a cold start.");
            result.tables().iter().take(1).for_each(|table| report.table(table));
            report.folded("The first of them over time, and headings and events", |report| {
                result.add_to(report, figure)
            })?;
        }
        report.section(
            "The paper's experiment: M - I and b grow by half",
            "Its simulation (figs. 4 and 5): even orientations, 30 dB, windows of 100 to 2000 samples.",
        );
        report.folded("Its figures and tables made again", |report| step.add_to(report))?;

        let everything = Everything { headline, recordings: [story, quiet_story], aided, step };
        self.common.finish(&[table], &everything, || Ok(report))
    }
}

impl Headline {
    fn of(story: &Story, aided: &[FollowResult]) -> Self {
        let [raw_deg, papers_deg, magcomp_deg] = story.drawn_deg();
        let answer = |result: &FollowResult| {
            let answer = result.answers.iter().find(|answer| answer.name == "aided, c")?;
            answer.below_2_deg.median
        };
        let told = aided.first().and_then(answer).map_or_else(|| "never".to_owned(), |s| format!("after {s:.1} s"));
        let text = format!(
            "A magnet of 27 uT is put on a sensor: its raw heading is {raw_deg:.0} degrees off, that of the paper's real-time method \
             {papers_deg:.0}, magcomp's {magcomp_deg:.1} (rms up to one constant). When the disturbance of a simulated phone in a hand grows \
             by half, the corrected samples are right to 2 degrees {told} (median). Every answer uses nothing later than its own sample."
        );
        Self { text, raw_deg, papers_deg, magcomp_deg }
    }
}

/// A recording, the steps of the best method that its sensors allow, and all methods beside each other.
fn played(shown: &Shown) -> Result<(Recording, Vec<Step>, Story), LabError> {
    let recording = recording::read_from(Path::new(shown.name), shown.bytes)?;
    let steps = replay(&recording, &Config::default(), Ignore::default())?;
    let story = Story::of(&recording)?;
    Ok((recording, steps, story))
}

/// What it comes to, then a line for each method.
fn heading_table(text: &str, [magnet, quiet]: [&Story; 2]) -> Table {
    let title = "Heading errors of a real sensor, degrees: a magnet is put on it and taken off, and no magnet";
    let mut table = Table::new(title, &["", "magnet", "no magnet", "answered %"]);
    table.lead.push(text.to_owned());
    for (with, without) in magnet.methods.iter().zip(&quiet.methods) {
        let [magnet, none] = [with, without].map(|told| number(told.heading.map(|heading| heading.rms_deg), 1));
        table.row(vec![with.method.to_owned(), magnet, none, number(Some(100.0 * with.answered), 0)]);
    }
    let names = [magnet, quiet].map(|story| story.recording.trim_end_matches(".csv.gz").to_owned());
    table.note(&format!(
        "Recordings: {} and {} (BROAD, CC BY 4.0). Root mean squares against the optical reference, up to one constant, from 20 s on; \
         answered: with the magnet. docs/COMPARISON.md has more recordings and methods.",
        names[0], names[1]
    ));
    table
}
