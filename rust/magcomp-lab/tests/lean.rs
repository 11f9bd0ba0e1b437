//! The usual build, without the importers that bring large dependencies: `cargo test -p magcomp-lab --test lean`.

#![cfg(not(feature = "formats"))]

use assert_cmd::Command;
use std::fs;
use std::path::Path;

#[test]
fn an_importer_that_was_left_out_says_how_to_get_it() {
    let sessions = Path::new(env!("CARGO_MANIFEST_DIR")).join("../magcomp-recordings/tests/sessions");
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out.csv");
    for (name, form) in [
        ("table.parquet", "Parquet and Arrow"),
        ("table.feather", "Parquet and Arrow"),
        ("table.arrow", "Parquet and Arrow"),
        ("ros2.mcap", "a bag of ROS 2 (mcap)"),
    ] {
        for verb in [["import", "--output"], ["replay", "--output"]] {
            let mut command = Command::cargo_bin("magcomp").unwrap();
            let run = command.arg(verb[0]).arg(sessions.join(name)).arg(verb[1]).arg(&output).output().unwrap();
            let error = String::from_utf8(run.stderr).unwrap();
            let expected = format!(
                "{name}: this build does not read {form}; cargo install --path rust/magcomp-lab --features formats makes a command that does"
            );
            assert!(error.contains(&expected) && error.lines().count() == 1, "{error}");
            assert_eq!(run.status.code(), Some(1), "{error}");
            assert!(!output.exists(), "{name}");
        }
    }
    // text is read as ever
    let text = folder.path().join("m.csv");
    fs::write(&text, "t,mx,my,mz\n0,20,30,40\n0.01,20,30,41\n").unwrap();
    let mut command = Command::cargo_bin("magcomp").unwrap();
    let run = command.arg("import").arg(text).args(["--columns", "t=t", "-o"]).arg(&output).output().unwrap();
    assert!(run.status.success() && output.exists());
}
