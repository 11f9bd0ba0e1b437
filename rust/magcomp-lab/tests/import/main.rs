//! Phone loggers' sessions, from files written by hand after the loggers' documentation: units, axes, order, errors, and that a
//! session of three sensors at three rates is the events pushed by hand.

#[cfg(feature = "formats")]
mod bags;
mod conventions;
mod forms;
mod loggers;
mod loss;
mod merged;
mod plain;
mod several;
mod simulated;
#[cfg(feature = "formats")]
mod tables;

use assert_cmd::Command;
use std::fs;
use std::path::Path;

/// Runs it; exit code, standard output, standard error.
fn run(arguments: &[&str]) -> (i32, String, String) {
    let output = Command::cargo_bin("magcomp").unwrap().args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

/// Writes files into a new folder.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    files.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).unwrap());
    folder
}

/// Runs the import; its exit code, standard output, standard error, and the recording if one was written.
fn import(inputs: &[&Path], options: &[&str]) -> (i32, String, String, Option<String>) {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out.csv");
    let inputs = inputs.iter().map(|input| input.to_str().unwrap());
    let arguments: Vec<&str> = ["import"]
        .into_iter()
        .chain(inputs)
        .chain(["-o", output.to_str().unwrap()])
        .chain(options.iter().copied())
        .collect();
    let (code, out, error) = run(&arguments);
    (code, out, error, fs::read_to_string(output).ok())
}

/// The recording that a session is made into.
fn imported(inputs: &[&Path], options: &[&str]) -> String {
    let (code, _, error, recording) = import(inputs, options);
    assert_eq!((code, error.as_str()), (0, ""), "{inputs:?} {options:?}");
    recording.unwrap()
}

fn refused(inputs: &[&Path], options: &[&str]) -> String {
    let (code, out, error, recording) = import(inputs, options);
    assert!(code != 0 && out.is_empty() && recording.is_none(), "{inputs:?} {options:?} was taken: {out}");
    assert_eq!(error.lines().count(), 1, "{error}");
    error
}

const HEADER: &str = "time,seconds_elapsed,z,y,x\n";

const RAW: &str =
    "time,seconds_elapsed,z,y,x\n1700000000000000000,0.0,-400,30,200\n1700000000010000100,0.0100001,-401,31,201\n";

/// A file of `tests/sessions` of the importers' crate, which `make.py` there made with other people's writers.
#[cfg(feature = "formats")]
fn session(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../magcomp-recordings/tests/sessions").join(name)
}
