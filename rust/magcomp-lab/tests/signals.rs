//! A signal in the middle of writing: the process ends by it, no temporary file stays, the output of before does.
#![cfg(unix)]

use nix::sys::signal::{Signal, kill};
use nix::unistd::Pid;
use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::sleep;
use std::time::Duration;

const BEFORE: &str = "what was there before";
const STEP: Duration = Duration::from_millis(10);

/// A recording that takes far longer to replay than a test waits for its first rows.
fn recording(folder: &Path) {
    let rows = (0..60_000).map(|k| {
        let (sin, cos) = (f64::from(k) * 0.03).sin_cos();
        format!("{},{},{},{}\n", f64::from(k) * 0.01, 40.0 * sin, 40.0 * cos, 20.0 * (f64::from(k) * 0.007).sin())
    });
    fs::write(folder.join("in.csv"), format!("t_s,mx,my,mz\n{}", rows.collect::<String>())).unwrap();
    fs::write(folder.join("out.csv"), BEFORE).unwrap();
}

/// Starts to replay, `set_up` being shell commands before, and returns when rows have been written.
fn writing(folder: &Path, set_up: &str) -> Child {
    let script = format!("{set_up} exec \"$0\" replay in.csv --output out.csv --passes 8");
    let mut command = Command::new("sh");
    command.args(["-c", &script, env!("CARGO_BIN_EXE_magcomp")]).current_dir(folder).stdout(Stdio::null());
    let mut child = command.spawn().unwrap();
    let begun = || {
        let files = fs::read_dir(folder).unwrap().map(Result::unwrap);
        files.filter(|file| file.file_name().to_string_lossy().ends_with(".tmp")).any(|file| {
            // it may be gone since it was listed
            file.metadata().is_ok_and(|file| file.len() > 0)
        })
    };
    while !begun() {
        assert_eq!(child.try_wait().unwrap(), None, "it ended before it was signalled");
        sleep(STEP);
    }
    child
}

fn send(child: &Child, signal: Signal) {
    kill(Pid::from_raw(child.id() as i32), signal).unwrap();
}

fn assert_nothing_is_left(folder: &Path) {
    let mut files: Vec<_> = fs::read_dir(folder).unwrap().map(|file| file.unwrap().file_name()).collect();
    files.sort();
    assert_eq!(files, ["in.csv", "out.csv"]);
    assert_eq!(fs::read_to_string(folder.join("out.csv")).unwrap(), BEFORE);
}

/// Whether this test itself was started with the signal ignored, as a job in the background is: then the command ignores it too.
fn ignored(signal: Signal) -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| u64::from_str_radix(line.strip_prefix("SigIgn:")?.trim(), 16).ok());
    mask.unwrap_or(0) >> (signal as i32 - 1) & 1 == 1
}

#[test]
fn a_signal_leaves_no_temporary_file() {
    for signal in [Signal::SIGINT, Signal::SIGTERM, Signal::SIGHUP].into_iter().filter(|signal| !ignored(*signal)) {
        let folder = tempfile::tempdir().unwrap();
        recording(folder.path());
        let mut child = writing(folder.path(), "");
        send(&child, signal);
        assert_eq!(child.wait().unwrap().signal(), Some(signal as i32));
        assert_nothing_is_left(folder.path());
    }
}

#[test]
#[cfg(target_os = "linux")]
fn a_signal_that_is_ignored_from_the_start_stays_ignored() {
    let folder = tempfile::tempdir().unwrap();
    recording(folder.path());
    let mut child = writing(folder.path(), "trap '' HUP;");
    send(&child, Signal::SIGHUP);
    sleep(20 * STEP);
    send(&child, Signal::SIGTERM);
    // the one that was heard ended it
    assert_eq!(child.wait().unwrap().signal(), Some(Signal::SIGTERM as i32));
    assert_nothing_is_left(folder.path());
}
