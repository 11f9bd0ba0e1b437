//! `magcomp demo`: a magnet put on a real sensor, then simulated phones, then the paper's experiment, and a report of all.

use super::common::SEED;
use crate::experiment::follow::{self, FollowOptions, FollowResult};
use crate::experiment::put_on::{middle_s, with_magnet};
use crate::experiment::step::{StepOptions, StepResult, run as run_step};
use crate::experiment::story::{Story, Told};
use crate::motion::Motion;
use clap::{Args, value_parser};
use magcomp::Config;
use magcomp_recordings::recording::{self, Recording};
use magcomp_replay::command::Common;
use magcomp_replay::error::RunError;
use magcomp_replay::report::Report;
use magcomp_replay::table::{Table, number};
use magcomp_replay::{Ignore, Step, figures, offset_picture, replay};
use serde::Serialize;
use std::ops::Range;
use std::path::Path;

/// A recording that is part of the program.
struct Shown {
    name: &'static str,
    bytes: &'static [u8],
    about: &'static str,
}

const PUT_ON: Shown = Shown {
    name: "broad_01_slow_rotation_A.csv.gz",
    bytes: include_bytes!("../../../../tests/recordings/broad_01_slow_rotation_A.csv.gz"),
    about: "A wireless sensor that its maker has calibrated is turned about, with an optical reference (BROAD, CC BY 4.0). From the middle of the \
            recording on a constant field of 27 uT is added to its samples: a magnet by arithmetic, while everything else is real.",
};
const REAL: Shown = Shown {
    name: "broad_33_attached_magnet_2cm.csv.gz",
    bytes: include_bytes!("../../../../tests/recordings/broad_33_attached_magnet_2cm.csv.gz"),
    about: "The same sensor. It lies still, and a real magnet is put on it at 42 s, before it has turned and magcomp has a heading; it is turned about \
            until 134 s, and at 99 s the magnet is taken off.",
};
/// From when to when the real magnet sat there, s after the first row; and without and with it, the hand away.
const REAL_S: Range<f64> = 42.5..98.7;
const STRETCHES: [(Range<f64>, &str); 2] = [(102.0..200.0, "without the magnet"), (46.0..90.0, "with it")];
/// The plane in which the magnet's field shows: x and z of the sensor.
const PLANE: (usize, usize) = (0, 2);
/// The line that opens all pictures of a recording.
const OVER_TIME: &str = "Everything over time, and the sphere to turn";
/// Runs of an aided step: they agree well, the paper's do not.
const AIDED_RUNS: usize = 10;
/// Where the report is written when no other folder is named, below the current one.
const FOLDER: &str = "magcomp-report";

/// Show what it does on one page: a magnet put on a real sensor, simulated phones, the paper's experiment.
///
/// The report is written into magcomp-report below the current folder, or where --report says. The recordings are part of the
/// program.
#[derive(Debug, Args)]
pub(super) struct Demo {
    /// Runs of the paper's step experiment
    #[arg(long, default_value_t = 60, value_parser = value_parser!(u32).range(1..))]
    runs: u32,
    #[arg(long, default_value_t = 1, help = SEED)]
    seed: u64,
    #[command(flatten)]
    common: Common,
}

/// What it comes to: rms heading errors from the magnet on, about the constant before it.
#[derive(Serialize)]
struct Headline {
    /// In a few sentences.
    text: String,
    raw_deg: f64,
    vqf_deg: f64,
    magcomp_deg: f64,
}

#[derive(Serialize)]
struct Everything {
    headline: Headline,
    recordings: [Story; 3],
    aided: Vec<FollowResult>,
    step: StepResult,
}

impl Demo {
    pub fn run(mut self) -> Result<(), RunError> {
        self.common.report.get_or_insert_with(|| FOLDER.into());
        let say = |what: &str| eprintln!("magcomp: {what} ...");
        say("1 of 3, recordings of a real sensor");
        let quiet = recording::read_from(Path::new(PUT_ON.name), PUT_ON.bytes)?;
        let real = recording::read_from(Path::new(REAL.name), REAL.bytes)?;
        let real_steps = replay(&real, &Config::default(), Ignore::default())?;
        let put_on = with_magnet_put_on(&quiet);
        let put_on_steps = replay(&put_on, &Config::default(), Ignore::default())?;
        let stories = [Story::of(&quiet, true)?, Story::of(&quiet, false)?, Story::of(&real, false)?];
        say("2 of 3, simulated phones");
        let options = [Motion::Tumble, Motion::Walk].into_iter().filter_map(FollowOptions::of);
        let follow = |own| follow::run(&FollowOptions { seed: self.seed, runs: AIDED_RUNS, ..own });
        let aided = options.map(follow).collect::<Result<Vec<FollowResult>, _>>()?;
        say("3 of 3, the paper's experiment");
        let step = run_step(&StepOptions { runs: self.runs as usize, seed: self.seed, ..StepOptions::default() })?;
        let headline = Headline::of(&stories[0], &aided);
        let table = heading_table(&headline.text, &stories);

        let mut report = Report::new("magcomp: it keeps pointing north when a magnet is put on", &headline.text);
        show_put_on(&mut report, &stories[0], &table)?;
        report.folded(OVER_TIME, |report| figures(report, "put_on", &put_on, &put_on_steps))?;
        show_real(&mut report, &stories[2], &real, &real_steps)?;
        report.folded(OVER_TIME, |report| figures(report, &real.name().replace(".csv.gz", ""), &real, &real_steps))?;
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

        let everything = Everything { headline, recordings: stories, aided, step };
        self.common.finish(&[table], &everything, || Ok(report))
    }
}

/// A magnet by arithmetic, and the table of all.
fn show_put_on(report: &mut Report, story: &Story, table: &Table) -> Result<(), RunError> {
    report.section("A magnet put on a real sensor", PUT_ON.about);
    report.figure(
        "heading_error",
        story.picture(&[(story.magnet_s.unwrap_or_default(), "a magnet is put on")])?,
        "Heading error of each second against the optical reference, about the constant before the magnet. The number beside a name is its \
         root mean square from the magnet on. The band is two sigmas wide on both sides: as far as magcomp says it may be off. Errors \
         beyond 60 degrees are drawn there.",
    );
    report.table(&Table { lead: Vec::new(), ..table.clone() });
    Ok(())
}

/// What a real magnet did.
fn show_real(report: &mut Report, story: &Story, real: &Recording, steps: &[Step]) -> Result<(), RunError> {
    report.section("A real magnet on the same sensor", REAL.about);
    report.figure(
        "real_magnet",
        story.picture(&[(REAL_S.start, "a magnet is put on"), (REAL_S.end, "and taken off")])?,
        "Heading error of each second against the optical reference, about one constant of all rows from 20 s on.",
    );
    report.figure(
        "offset",
        offset_picture(real, steps, PLANE, &STRETCHES),
        "Raw samples (grey) lie about the device's own field b (red line and ring: where it was found), corrected ones (blue) about the \
         middle. The last calibration of each stretch.",
    );
    Ok(())
}

impl Headline {
    fn of(story: &Story, aided: &[FollowResult]) -> Self {
        let [raw_deg, vqf_deg, magcomp_deg] =
            ["raw field", "VQF on the raw field", "magcomp: heading"].map(|method| story.rms_deg(method));
        let answer = |result: &FollowResult| {
            let answer = result.answers.iter().find(|answer| answer.name == "aided, c")?;
            answer.below_2_deg.median
        };
        let told = aided.first().and_then(answer).map_or_else(|| "never".to_owned(), |s| format!("after {s:.1} s"));
        let text = format!(
            "A magnet of 27 uT is put on a turning sensor, by arithmetic. From then on the raw heading is {raw_deg:.0} degrees off, that of the \
             filter VQF {vqf_deg:.1}, magcomp's {magcomp_deg:.1} (rms about the constant before). When the disturbance of a simulated phone in a \
             hand grows by half, the corrected samples are right to 2 degrees {told} (median). Every answer uses nothing later than its own sample."
        );
        Self { text, raw_deg, vqf_deg, magcomp_deg }
    }
}

/// The recording with a magnet put on in its middle.
fn with_magnet_put_on(quiet: &Recording) -> Recording {
    let on_s = middle_s(&quiet.extent());
    Recording { rows: quiet.rows.iter().cloned().map(|row| with_magnet(row, on_s)).collect(), ..quiet.clone() }
}

/// What it comes to, then a line for each method.
fn heading_table(text: &str, [put_on, quiet, real]: &[Story; 3]) -> Table {
    let title = "Heading errors of a real sensor, degrees";
    let columns = ["", "magnet put on", "answered %", "no magnet", "real magnet", "answered %"];
    let mut table = Table::new(title, &columns);
    table.lead.push(text.to_owned());
    for ((put_on, quiet), real) in put_on.methods.iter().zip(&quiet.methods).zip(&real.methods) {
        let rms = |told: &Told| number(told.heading.map(|heading| heading.rms_deg), 1);
        let answered = |told: &Told| number(told.heading.map(|heading| 100.0 * heading.answered), 0);
        table.row(vec![put_on.method.to_owned(), rms(put_on), answered(put_on), rms(quiet), rms(real), answered(real)]);
    }
    let names = [quiet, real].map(|story| story.recording.trim_end_matches(".csv.gz"));
    table.note(&format!(
        "Recordings: {} with and without a magnet added in the middle, and {} (BROAD, CC BY 4.0). Root mean squares against the optical reference: \
         from the added magnet on, about the constant of the rows before; else from 20 s on, about one constant. docs/COMPARISON.md has more \
         recordings and methods.",
        names[0], names[1]
    ));
    table
}
