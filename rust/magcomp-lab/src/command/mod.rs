//! The verbs of the command and what all of them share.

mod compare;
mod crb;
mod demo;
mod replay;
mod simulate;
mod step;

use crate::error::LabError;
use crate::report::Report;
use crate::table::Table;
use clap::{Args, Parser, Subcommand};
use serde::Serialize;
use std::io::Write;
use std::path::PathBuf;

/// Frees a smartphone magnetometer from the phone's own disturbance: replays recordings, runs the paper's experiments.
#[derive(Debug, Parser)]
#[command(
    name = "magcomp",
    version,
    after_help = "Exit codes: 0 all went well; 1 the input or the run failed (one line on standard error says where and \
                  why; no output file is left half written); 2 wrong usage, or a recording without rows."
)]
pub struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

// each verb's own documentation is its help
#[derive(Debug, Subcommand)]
enum Verb {
    Demo(demo::Demo),
    Replay(replay::Replay),
    Step(step::Step),
    Crb(crb::Crb),
    Compare(compare::Compare),
    Simulate(simulate::Simulate),
}

impl Cli {
    /// Runs the verb.
    ///
    /// # Errors
    /// [`LabError`] for the one line on standard error.
    pub fn run(self) -> Result<(), LabError> {
        match self.verb {
            Verb::Demo(verb) => verb.run(),
            Verb::Replay(verb) => verb.run(),
            Verb::Step(verb) => verb.run(),
            Verb::Crb(verb) => verb.run(),
            Verb::Compare(verb) => verb.run(),
            Verb::Simulate(verb) => verb.run(),
        }
    }
}

/// Options of every verb.
#[derive(Clone, Debug, Args)]
struct Common {
    /// Names the random numbers: the same seed gives the same result (replay draws none)
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Print the numbers as JSON instead of a table
    #[arg(long)]
    json: bool,
    /// Write pictures (SVG) and one HTML page that shows them into this folder
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
}

impl Common {
    /// Prints tables, or `json` where it was asked for; then writes the report where it was asked for.
    fn finish(
        &self,
        tables: &[Table],
        json: &impl Serialize,
        report: impl FnOnce() -> Result<Report, LabError>,
    ) -> Result<(), LabError> {
        let page = self.report.as_ref().map(|folder| report()?.write(folder)).transpose()?;
        let mut out = std::io::stdout().lock();
        if self.json {
            serde_json::to_writer_pretty(&mut out, json).map_err(std::io::Error::from)?;
            writeln!(out)?;
        } else {
            for (k, table) in tables.iter().enumerate() {
                if k > 0 {
                    writeln!(out)?;
                }
                write!(out, "{table}")?;
            }
            if let Some(page) = page {
                writeln!(out, "\nreport: {}", page.display())?;
            }
        }
        out.flush()?;
        Ok(())
    }
}

/// A number, neither NaN nor infinite.
fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| "expected a number".to_owned())
}

/// A number from `low` to `high`.
fn between(text: &str, low: f64, high: f64) -> Result<f64, String> {
    let inside = finite(text).ok().filter(|v| (low..=high).contains(v));
    inside.ok_or_else(|| format!("expected a number from {low} to {high}"))
}
