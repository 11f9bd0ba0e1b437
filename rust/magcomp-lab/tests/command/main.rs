//! The command from outside: columns, rows, errors, exit codes, and no half files.

mod experiments;
mod explain;
mod refused;
mod rows;
mod summary;
mod usage;
mod verdict;

use assert_cmd::Command;
use std::path::{Path, PathBuf};

fn magcomp() -> Command {
    Command::cargo_bin("magcomp").unwrap()
}

/// Runs it; exit code, standard output, standard error.
fn run(arguments: &[&str]) -> (i32, String, String) {
    let output = magcomp().args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

fn text(path: &Path) -> &str {
    path.to_str().unwrap()
}

/// A simulated recording of `seconds` in `folder`.
fn simulated(folder: &Path, seconds: &str) -> PathBuf {
    let path = folder.join("in.csv");
    assert_eq!(run(&["simulate", text(&path), "--seconds", seconds, "--motion", "uniform"]).0, 0);
    path
}
