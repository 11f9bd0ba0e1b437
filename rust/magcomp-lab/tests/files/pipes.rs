//! Pipes are read once, from their first byte.

use crate::bag::bag;
use crate::{GNSS, TABLE, field, folder, run_in, session};
use std::fs;
use std::io::{Cursor, Write as _};
use std::process::{Command, Stdio};

#[test]
fn a_pipe_is_read_from_its_first_byte_and_never_waits() {
    let m = field(50);
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("MagnetometerUncalibrated.csv", zip::write::SimpleFileOptions::default()).unwrap();
    zip.write_all(m.as_bytes()).unwrap();
    let recording = "t_s,mx,my,mz\n0,1,2,3\n0.01,1,2,3\n".as_bytes().to_vec();
    let inputs: [(&str, Vec<u8>, &[&str]); 5] = [
        ("gnss.txt", GNSS.repeat(5), &[]),
        ("s.zip", zip.finish().unwrap().into_inner(), &[]),
        ("b.mcap", bag(30, None, 0), &[]),
        ("t.parquet", session("table.parquet"), &TABLE),
        ("r.csv", recording, &[]),
    ];
    for (name, bytes, options) in inputs {
        let folder = folder(&[(name, &bytes)]);
        let (pipe, output) = (folder.path().join("pipe"), folder.path().join("out.csv"));
        assert!(Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let import = |input: &str| {
            let arguments = [&["import", input, "-o", "out.csv"], options].concat();
            let (code, _, error) = run_in(folder.path(), &arguments);
            // a field of 3 uT is refused in the same way from a file and from a pipe
            (code, error.replace(input, "IN"), fs::read_to_string(&output).ok())
        };
        let expected = import(name);
        let _ = fs::remove_file(&output);
        let (found, replayed) = std::thread::scope(|scope| {
            let writer = scope.spawn(|| fs::write(&pipe, &bytes));
            let found = import("pipe");
            writer.join().unwrap().unwrap();
            scope.spawn(|| fs::write(&pipe, &bytes));
            (found, run_in(folder.path(), &[&["replay", "pipe"], options].concat()))
        });
        assert_eq!(found, expected, "{name}");
        assert_eq!(replayed.0, Some(0), "{name}: {}", replayed.2);
        // standard input
        let mut child = Command::new(env!("CARGO_BIN_EXE_magcomp"))
            .args([&["replay", "/dev/stdin"], options].concat())
            .stdin(Stdio::piped())
            .stdout(Stdio::null())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(&bytes).unwrap();
        assert!(child.wait().unwrap().success(), "{name}");
    }
}

#[test]
fn a_pipe_that_hides_the_name_which_tells_the_sensor_is_refused() {
    let folder = folder(&[("MagnetometerUncalibrated.csv", field(50).as_bytes())]);
    let mut child = Command::new("sh");
    child.args(["-c", "cat MagnetometerUncalibrated.csv | \"$0\" import /dev/stdin -o out.csv"]);
    let output = child.arg(env!("CARGO_BIN_EXE_magcomp")).current_dir(folder.path()).output().unwrap();
    let error = String::from_utf8(output.stderr).unwrap();
    assert!(output.status.code() == Some(2) && error.contains("which a pipe does not have"), "{error}");
    assert!(!folder.path().join("out.csv").exists());
}
