//! Inputs and outputs that are refused, with one line and no half file.

use crate::rows::without_times;
use crate::{magcomp, run, simulated, text};
use std::fs;
use std::path::Path;

#[test]
fn a_wrong_input_is_one_line_and_leaves_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (folder.path().join("in.csv"), folder.path().join("out.csv"));
    fs::write(&input, "t_s,mx,my,mz\n0,1,2,3\n0.01,1,x,3\n").unwrap();
    fs::write(&output, "what was there before").unwrap();
    let (code, out, error) = run(&["replay", text(&input), "--output", text(&output)]);
    assert_eq!((code, out.as_str()), (1, ""));
    assert_eq!(error, format!("magcomp: {}: line 3, column 3 (my): expected a number, found 'x'\n", input.display()));
    assert_eq!(fs::read_to_string(&output).unwrap(), "what was there before");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 2);
}

#[test]
fn an_output_that_cannot_be_written_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let input = simulated(folder.path(), "1");
    let nowhere = folder.path().join("missing/out.csv");
    let (code, _, error) = run(&["replay", text(&input), "--output", text(&nowhere)]);
    assert_eq!((code, error.lines().count()), (1, 1));
    assert!(error.contains("missing/out.csv: cannot be written"), "{error}");
    // moving onto a folder fails after everything was written: the temporary file must go
    let (code, ..) = run(&["replay", text(&input), "--output", text(folder.path())]);
    assert_eq!(code, 1);
    let (code, _, error) = run(&["replay", "no/such.csv"]);
    assert_eq!((code, error.lines().count()), (1, 1));
}

#[test]
fn a_cut_gzip_gives_what_is_before_the_cut_and_tells_it() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("in.csv.gz");
    assert_eq!(run(&["simulate", text(&whole), "--seconds", "5"]).0, 0);
    let (code, ..) = run(&["replay", text(&whole)]);
    assert_eq!(code, 0);
    let bytes = fs::read(&whole).unwrap();
    let cut = folder.path().join("cut.csv.gz");
    fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
    let (code, table, error) = run(&["replay", text(&cut)]);
    assert!(code == 0 && table.contains("the file is cut off"), "{table}{error}");
    fs::write(&cut, &bytes[..12]).unwrap();
    let (code, _, error) = run(&["replay", text(&cut)]);
    assert_eq!((code, error.lines().count()), (1, 1), "{error}");
}

#[test]
fn an_output_that_is_the_input_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let input = simulated(folder.path(), "1");
    let before = fs::read(&input).unwrap();
    let walk = folder.path().join("walk.csv");
    fs::write(&walk, "t_s,x_m,y_m\n0,0,0\n").unwrap();
    fs::create_dir(folder.path().join("sub")).unwrap();
    let mut outputs =
        vec!["in.csv".to_owned(), "sub/../in.csv".to_owned(), text(&input).to_owned(), "hard.csv".to_owned()];
    fs::hard_link(&input, folder.path().join("hard.csv")).unwrap();
    #[cfg(unix)]
    {
        std::os::unix::fs::symlink("in.csv", folder.path().join("soft.csv")).unwrap();
        outputs.push("soft.csv".to_owned());
    }
    outputs.push("walk.csv".to_owned());
    for output in outputs {
        let arguments = ["replay", "in.csv", "--waypoints", "walk.csv", "--output", &output];
        let found = magcomp().current_dir(folder.path()).args(arguments).output().unwrap();
        let error = String::from_utf8(found.stderr).unwrap();
        assert_eq!((found.status.code(), error.lines().count()), (Some(2), 1), "{output}: {error}");
        let name = if output == "walk.csv" { "walk.csv" } else { "in.csv" };
        assert_eq!(error, format!("magcomp: --output {output} is the input {name}; name another file\n"), "{output}");
    }
    assert!(fs::read(&input).unwrap() == before);
    assert_eq!(fs::read_to_string(&walk).unwrap().lines().count(), 2);
}

#[test]
fn a_recording_without_rows_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out.csv");
    // the last one is nothing, gzipped
    let nothing_zipped = [0x1f, 0x8b, 8, 0, 0, 0, 0, 0, 0, 3, 3, 0, 0, 0, 0, 0, 0, 0, 0, 0];
    for (bytes, has) in [
        (&b"t_s,mx,my,mz\n"[..], "a header but no rows"),
        (b"t_s,mx,my,mz", "a header but no rows"),
        (b"", "nothing in it"),
        (&nothing_zipped, "nothing in it"),
    ] {
        let input = folder.path().join("in.csv");
        fs::write(&input, bytes).unwrap();
        for arguments in [&["replay", text(&input), "--output", text(&output)][..], &["compare", text(&input)]] {
            let (code, out, error) = run(arguments);
            assert_eq!((code, out.as_str()), (1, ""), "{arguments:?}");
            let expected = "a recording has a header t_s,mx,my,mz and rows; this file has";
            assert_eq!(error, format!("magcomp: {}: {expected} {has}\n", input.display()));
        }
    }
    assert!(!output.exists());
}

#[test]
#[cfg(unix)]
fn a_pipe_can_be_the_input() {
    let folder = tempfile::tempdir().unwrap();
    let (input, pipe) = (simulated(folder.path(), "5"), folder.path().join("pipe"));
    assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
    let whole = fs::read(&input).unwrap();
    let rows = |from: &Path| {
        let output = folder.path().join("out.csv");
        assert_eq!(run(&["replay", text(from), "--output", text(&output)]).0, 0);
        without_times(&fs::read_to_string(&output).unwrap())
    };
    let expected = rows(&input);
    let found = std::thread::scope(|scope| {
        scope.spawn(|| fs::write(&pipe, &whole).unwrap());
        rows(&pipe)
    });
    assert!(found == expected && expected.lines().count() == 501);
}
