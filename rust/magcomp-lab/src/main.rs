//! The command `magcomp`: reads the arguments, runs a verb, turns its result into an exit code.

use clap::Parser;
use magcomp_lab::command::Cli;
use magcomp_replay::atomic::remove_unfinished_on_signals;
use magcomp_replay::error::RunError;
use std::process::ExitCode;

/// The input or the run failed.
const FAILED: u8 = 1;
/// Wrong usage, or several recordings at once.
const USAGE: u8 = 2;
/// A recording is bad.
const BAD: u8 = 3;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(message) => {
            // help and version go to standard output and are no failure
            let _ = message.print();
            return if message.use_stderr() { ExitCode::from(USAGE) } else { ExitCode::SUCCESS };
        }
    };
    if let Err(error) = remove_unfinished_on_signals() {
        eprintln!("magcomp: signals cannot be heard, so one may leave a temporary file: {error}");
    }
    match cli.run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) if error.is_broken_pipe() => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("magcomp: {error}");
            if matches!(error, RunError::Bad(_)) {
                return ExitCode::from(BAD);
            }
            ExitCode::from(if error.is_usage() { USAGE } else { FAILED })
        }
    }
}
