//! The verbs of the command.

mod check;
mod common;
mod compare;
mod compare_folder;
mod crb;
mod demo;
mod evaluate;
mod evaluate_recordings;
mod import;
mod replay;
mod sensitivity;
mod simulate;
mod step;

use crate::error::LabError;
use clap::{Parser, Subcommand};

/// Frees a smartphone magnetometer from the phone's own disturbance: replays recordings, runs the paper's experiments.
#[derive(Debug, Parser)]
#[command(
    name = "magcomp",
    version,
    after_help = "Exit codes: 0 all went well; 1 the input or the run failed (one line on standard error says where and \
                  why; no output file is left half written); 2 wrong usage, or a recording without rows; \
                  3 the recording is bad, and the first line of the summary says why."
)]
pub struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

// each verb's own documentation is its help
#[derive(Debug, Subcommand)]
enum Verb {
    Demo(demo::Demo),
    Import(import::Import),
    Check(check::Check),
    Replay(Box<replay::Replay>),
    Step(step::Step),
    Crb(crb::Crb),
    Compare(compare::Compare),
    Evaluate(evaluate::Evaluate),
    Sensitivity(sensitivity::Sensitivity),
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
            Verb::Import(verb) => verb.run(),
            Verb::Check(verb) => verb.run(),
            Verb::Replay(verb) => verb.run(),
            Verb::Step(verb) => verb.run(),
            Verb::Crb(verb) => verb.run(),
            Verb::Compare(verb) => verb.run(),
            Verb::Evaluate(verb) => verb.run(),
            Verb::Sensitivity(verb) => verb.run(),
            Verb::Simulate(verb) => verb.run(),
        }
    }
}
