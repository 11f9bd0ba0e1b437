//! `magcomp compare`.

use super::common::{Common, finite};
use crate::baseline::Contestant;
use crate::error::LabError;
use crate::experiment::compare::{MethodScore, run_case, tune};
use crate::experiment::compare_recording::{RecordingScore, compare_recording};
use crate::experiment::compare_view::{add_case, case_table, overview, recording_figure, recording_table};
use crate::import::{ImportOptions, open};
use crate::progress;
use crate::recording::name_of;
use crate::report::Report;
use crate::scenario::Case;
use clap::{Args, ValueEnum, value_parser};
use serde::Serialize;
use std::io::Write;
use std::path::PathBuf;

/// Methods side by side on the same samples: scenarios, or recordings.
///
/// Each method answers every sample before it sees the next, from a cold start. A method's one free number (window, process
/// noise, threshold, rate of learning) is tuned for every scenario on other seeds. For the Kalman filters the true noise is given.
#[derive(Debug, Args)]
pub(super) struct Compare {
    /// Recordings instead of scenarios
    #[arg(value_name = "IN")]
    recordings: Vec<PathBuf>,
    /// Scenarios; all when none is named
    #[arg(long, value_enum, value_delimiter = ',', conflicts_with = "recordings")]
    scenario: Vec<Case>,
    /// Methods; all when none is named
    #[arg(long, value_enum, value_delimiter = ',')]
    method: Vec<Contestant>,
    /// Runs of a scenario
    #[arg(long, default_value_t = 50, value_parser = value_parser!(u32).range(1..))]
    runs: u32,
    /// Signal-to-noise ratio of a scenario, dB; 30, or 40 for the phones, when not given
    #[arg(long, value_parser = finite)]
    snr: Option<f64>,
    /// Scenarios: print the overview alone, as markdown
    #[arg(long, conflicts_with_all = ["recordings", "json"])]
    markdown: bool,
    #[command(flatten)]
    common: Common,
}

#[derive(Serialize)]
struct Scenario {
    scenario: String,
    runs: u32,
    methods: Vec<MethodScore>,
}

#[derive(Serialize)]
struct Recorded {
    recording: String,
    methods: Vec<RecordingScore>,
}

impl Compare {
    pub fn run(self) -> Result<(), LabError> {
        if self.recordings.is_empty() { self.scenarios() } else { self.recorded() }
    }

    fn methods(&self) -> Vec<Contestant> {
        if self.method.is_empty() { Contestant::value_variants().to_vec() } else { self.method.clone() }
    }

    fn scenarios(self) -> Result<(), LabError> {
        let cases = if self.scenario.is_empty() { Case::value_variants().to_vec() } else { self.scenario.clone() };
        let methods = self.methods();
        let seeds = self.common.seed..self.common.seed + u64::from(self.runs);
        let bar = progress::bar(cases.len() * methods.len(), "compare");
        let mut all = Vec::new();
        for case in cases {
            let mut scores = Vec::new();
            for contestant in &methods {
                let value = tune(case, self.common.seed, self.snr, *contestant)?;
                if let Some((before, runs)) = run_case(case, seeds.clone(), self.snr, *contestant, value)? {
                    let tuned = (contestant.grid().len() > 1).then_some(value);
                    scores.push(MethodScore::of(&contestant.name(), tuned, before, &runs));
                }
                bar.inc(1);
            }
            all.push(Scenario { scenario: case.name(), runs: self.runs, methods: scores });
        }
        bar.finish_and_clear();
        let overview = overview(all.iter().map(|one| (one.scenario.as_str(), one.methods.as_slice())));
        if self.markdown {
            overview.iter().try_for_each(|table| writeln!(std::io::stdout(), "{}", table.markdown()))?;
            return Ok(());
        }
        let tables = all.iter().flat_map(|one| case_table(&one.scenario, one.runs, &one.methods));
        let tables: Vec<_> = tables.chain(overview.clone()).collect();
        self.common.finish(&tables, &all, || {
            let mut report = Report::new(
                "Methods side by side",
                "Direction error of what each method makes of the noise-free sample, over the samples since the change.",
            );
            overview.iter().for_each(|table| report.table(table));
            for one in &all {
                add_case(&mut report, &one.scenario, one.runs, &one.methods)?;
            }
            Ok(report)
        })
    }

    fn recorded(self) -> Result<(), LabError> {
        let methods = self.methods();
        let mut all = Vec::new();
        for path in &self.recordings {
            let scores = compare_recording(
                &mut open(std::slice::from_ref(path), &ImportOptions::default())?.0,
                &methods,
                self.common.seed,
            )?;
            all.push(Recorded { recording: name_of(path), methods: scores });
        }
        let tables: Vec<_> = all.iter().map(|one| recording_table(&one.recording, &one.methods)).collect();
        self.common.finish(&tables, &all, || {
            let mut report = Report::new("Methods side by side on recordings", "Each on the same samples, causal.");
            for (one, table) in all.iter().zip(&tables) {
                report.section(&one.recording, "Heading error, rms over a second, up to one constant.");
                let name = one.recording.split('.').next().unwrap_or_default();
                report.figure(&format!("compare_{name}"), recording_figure(&one.methods)?, &one.recording);
                report.table(table);
            }
            Ok(report)
        })
    }
}
