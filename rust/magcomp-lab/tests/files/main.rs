//! Files as loggers, robots and hostile senders make them: what is readable is taken with a warning, the rest is refused with an error
//! of one line; nothing ends the process, fills the memory, waits for ever or is overwritten.

#![cfg(all(unix, feature = "formats"))]

#[path = "../../../magcomp-recordings/tests/bag/mod.rs"]
mod bag;
mod bags;
mod damage;
mod left_out;
mod outputs;
mod pipes;
mod times;
mod units;

use std::fmt::Write as _;
use std::fs;
use std::path::Path;
use std::process::Command;

/// Memory that the command may ask for in these tests, KiB.
const MEMORY_KIB: u64 = 700_000;

/// Runs it in little memory; exit code (none after a signal), standard output, standard error.
fn run_in(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let limited = format!("ulimit -v {MEMORY_KIB}; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &limited, env!("CARGO_BIN_EXE_magcomp")]).args(arguments).current_dir(folder);
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

fn folder(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    files.iter().for_each(|(name, bytes)| fs::write(folder.path().join(name), bytes).unwrap());
    folder
}

/// The recording that `IN` in `folder` is made into, and the warnings.
fn imported(folder: &Path, input: &str, options: &[&str]) -> (String, String) {
    let out = tempfile::tempdir().unwrap();
    let output = out.path().join("out.csv");
    let arguments = [&["import", input, "-o", output.to_str().unwrap()], options].concat();
    let (code, _, error) = run_in(folder, &arguments);
    assert_eq!(code, Some(0), "{input}: {error}");
    assert!(error.lines().all(|line| line.starts_with("magcomp: warning: ")), "{error}");
    (fs::read_to_string(output).unwrap(), error)
}

/// The error, of one line, with which `IN` is refused.
fn refused(folder: &Path, input: &str, options: &[&str]) -> String {
    let out = tempfile::tempdir().unwrap();
    let output = out.path().join("out.csv");
    let arguments = [&["import", input, "-o", output.to_str().unwrap()], options].concat();
    let (code, stdout, error) = run_in(folder, &arguments);
    assert!(matches!(code, Some(1 | 2)) && stdout.is_empty() && !output.exists(), "{input}: {code:?} {stdout} {error}");
    assert_eq!(error.lines().count(), 1, "{error}");
    error
}

/// A row of GnssLogger.
const GNSS: &[u8] = b"UncalMag,1663164669191,65972055195160,221.5,89.5,-21.25,213.5,180.25,5.5\n";

/// Rows of a Sensor Logger file at 100 Hz.
fn logged(rows: usize, row: impl Fn(usize) -> [f64; 3]) -> String {
    let mut text = "time,seconds_elapsed,z,y,x\n".to_owned();
    for k in 0..rows {
        let [x, y, z] = row(k);
        writeln!(text, "{},{},{z},{y},{x}", 1_700_000_000_000_000_000 + k as u64 * 10_000_000, k as f64 / 100.0)
            .unwrap();
    }
    text
}

fn field(rows: usize) -> String {
    logged(rows, |k| [20.0 + k as f64 % 7.0, 30.0, -40.0])
}

/// A file of the importers' tests.
fn session(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("../magcomp-recordings/tests/sessions").join(name)).unwrap()
}

const TABLE: [&str; 4] = ["--columns", "t=time,mx=bx,my=by,mz=bz,gx=rate_x,gy=rate_y,gz=rate_z", "--units", "t=ns"];
