//! `replay` and `compare` do not keep the rows of a recording: what grows with them is what the check of conventions holds of the sensors. A test program of
//! its own, because the system tells the largest memory of all children so far.
#![cfg(unix)]

use nix::sys::resource::{UsageWho, getrusage};
use std::fs::File;
use std::io::{BufWriter, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

const FEW: u32 = 10_000;
const MANY: u32 = 60_000;
/// What a row may take, kB. Rows that are kept take over 1 kB each in `replay`; the check holds times and values of three sensors.
const ALLOWED_KB: f64 = 0.45;

/// A recording of a device that turns about all axes, with every column.
fn recording(folder: &Path, rows: u32) -> PathBuf {
    let path = folder.join(format!("{rows}.csv"));
    let mut out = BufWriter::new(File::create(&path).unwrap());
    writeln!(out, "t_s,mx,my,mz,ax,ay,az,gx,gy,gz,qw,qx,qy,qz,true_bx,true_by,true_bz").unwrap();
    for k in 0..rows {
        let time_s = f64::from(k) * 0.01;
        let ((sin, cos), (up, across)) = (time_s.sin_cos(), (0.37 * time_s).sin_cos());
        let field = [50.0 * sin * across + 10.0, 50.0 * cos * across - 20.0, 50.0 * up];
        let [x, y, z] = field;
        writeln!(out, "{time_s},{x},{y},{z},{sin},{cos},9.8,0.1,0.2,0.3,{cos},{sin},{across},{up},10,-20,0").unwrap();
    }
    out.flush().unwrap();
    path
}

/// Runs the command and returns the largest memory of any child so far, in the system's unit.
fn peak(arguments: &[&str]) -> f64 {
    let mut command = Command::new(env!("CARGO_BIN_EXE_magcomp"));
    let status = command.args(arguments).stdout(Stdio::null()).status().unwrap();
    // the recording is made up, and `replay` finds it bad
    assert!(matches!(status.code(), Some(0 | 3)), "{status}");
    getrusage(UsageWho::RUSAGE_CHILDREN).unwrap().max_rss() as f64
}

#[test]
fn memory_grows_by_less_than_rows_that_are_kept() {
    let folder = tempfile::tempdir().unwrap();
    let [few, many] = [FEW, MANY].map(|rows| recording(folder.path(), rows));
    let (output, pages) = (folder.path().join("out.csv"), folder.path().join("pages"));
    // the cheapest methods, since it is not they that are looked at
    let replay = |input: &Path| {
        let files = ["--output", output.to_str().unwrap(), "--report", pages.to_str().unwrap()];
        let method = ["--method", "constant"];
        peak(&[&["replay", input.to_str().unwrap()], &method[..], &files].concat())
    };
    let compare = |input: &Path| peak(&["compare", input.to_str().unwrap(), "--method", "none,network"]);
    // `compare` first, because it takes less memory and the largest so far is what is told
    for (what, command) in [("compare", &compare as &dyn Fn(&Path) -> f64), ("replay", &replay)] {
        let (small, large) = (command(&few), command(&many));
        // the system counts in kB, a Mac in bytes
        let unit_kb = if cfg!(target_vendor = "apple") { 1.0 / 1024.0 } else { 1.0 };
        let row_kb = (large - small) * unit_kb / f64::from(MANY - FEW);
        assert!(row_kb < ALLOWED_KB, "{what}: {row_kb} kB a row; {small} for {FEW} rows, {large} for {MANY}");
    }
}
