//! Options, help and exit codes.

use crate::rows::without_times;
use crate::{magcomp, run, simulated, text};
use std::fs;

#[test]
fn wrong_usage_is_exit_code_two_and_help_names_the_codes() {
    for arguments in [
        &["replay"][..],
        &["nonsense"],
        &["paper", "bound", "--runs", "0"],
        &["replay", "x", "--place", "1"],
        &["replay", "x", "--declination", "400"],
        &["simulate", "x", "--change", "repeated", "--at", "1e-9"],
        &["paper", "bound", "--p", "0"],
        &["paper", "step", "--rate", "50"],
        &["paper", "phone", "--set", "mid"],
        &["paper", "phone", "--motion", "stroll"],
        &["replay", "x", "--seed", "1"],
        &[],
    ] {
        assert_eq!(run(arguments).0, 2, "{arguments:?}");
    }
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (simulated(folder.path(), "5"), folder.path().join("out.csv"));
    for part in [&["--from", "30"][..], &["--from", "4", "--to", "2"]] {
        let (code, _, error) = run(&[&["replay", text(&input), "--output", text(&output)], part].concat());
        assert_eq!((code, error.lines().count()), (2, 1), "{error}");
        assert!(error.contains("leave no row to count: the recording lasts 5.0 s"), "{error}");
        assert!(!output.exists());
    }
    let (code, help, _) = run(&["--help"]);
    assert_eq!(code, 0);
    assert!(help.contains("Exit codes: 0"), "{help}");
}

#[test]
fn the_help_of_replay_says_what_a_recording_is() {
    let (code, help, _) = run(&["replay", "--help"]);
    assert_eq!(code, 0);
    assert!(help.contains("t_s,mx,my,mz[,ax,ay,az][,gx,gy,gz][,qw,qx,qy,qz]"), "{help}");
}

#[test]
fn the_papers_numbers_can_be_chosen() {
    let window = |options: &[&str]| {
        let (code, json, error) =
            run(&[&["paper", "step", "--runs", "1", "--normalisation", "half-range", "--json"], options].concat());
        assert_eq!((code, error.as_str()), (0, ""));
        let value: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!(value["normalisations"].as_array().unwrap().len(), 1);
        value["normalisations"][0]["window"]["mean"].as_f64().unwrap()
    };
    // (16) with sigma_T 0.72 of even orientations
    assert!((window(&[]) - 632.0).abs() < 40.0 && (window(&["--n-max", "4000"]) - 1190.0).abs() < 80.0);
    assert!((window(&["--n-min", "600"]) - 993.0).abs() < 40.0);
    // no even set of 100 samples has sigma_T 2: nothing is updated, the window shrinks to N_min
    assert!(window(&["--sigma-th", "2"]) <= 100.0);
    let folder = tempfile::tempdir().unwrap();
    let input = simulated(folder.path(), "12");
    let rows = |options: &[&str]| {
        let output = folder.path().join("out.csv");
        let arguments = ["replay", text(&input), "--method", "windowed", "--output", text(&output)];
        assert_eq!(run(&[&arguments, options].concat()).0, 0);
        without_times(&fs::read_to_string(&output).unwrap())
    };
    let usual = rows(&[]);
    assert!(usual != rows(&["--residual", "algebraic"]) && usual != rows(&["--normalisation", "even-sphere"]));
    assert!(usual == rows(&["--residual", "corrected", "--normalisation", "half-range"]));
}

#[test]
fn own_parameters_take_the_place_of_the_sets() {
    let steady = |options: &[&str]| {
        let (code, json, error) =
            run(&[&["paper", "step", "--runs", "1", "--normalisation", "half-range", "--json"], options].concat());
        assert_eq!((code, error.as_str()), (0, ""));
        serde_json::from_str::<serde_json::Value>(&json).unwrap()
    };
    // the set `ref` in own numbers is the set `ref`, up to rounding
    let own = ["--soft-iron", "1.05,0.95,1,0.06,-0.05,0.08", "--hard-iron=0.3,-0.2,1.32"];
    let (set, own) = (steady(&[]), steady(&own));
    assert!(set["scenario"].as_str().unwrap().contains("set REF") && own["scenario"].as_str().unwrap().contains("own"));
    let error = |value: &serde_json::Value| {
        value["normalisations"][0]["parameters"][0]["steady_percent"]["mean"].as_f64().unwrap()
    };
    assert!((error(&set) - error(&own)).abs() < 1e-6, "{} {}", error(&set), error(&own));
    // a scale of 1.3 along x stretches the raw field there, and only there
    let folder = tempfile::tempdir().unwrap();
    let widest = |options: &[&str]| {
        let path = folder.path().join("s.csv");
        let arguments =
            ["simulate", text(&path), "--seconds", "60", "--hard-iron", "0,0,0", "--soft-iron", "1,1,1,0,0,0"];
        assert_eq!(run(&[&arguments, options].concat()).0, 0);
        let written = fs::read_to_string(path).unwrap();
        let row = |line: &str| [1, 2].map(|k| line.split(',').nth(k).unwrap().parse::<f64>().unwrap().abs());
        written.lines().skip(1).map(row).fold([0.0_f64; 2], |most, v| [most[0].max(v[0]), most[1].max(v[1])])
    };
    let (even, scaled) = (widest(&[]), widest(&["--scale", "1.3,1,1"]));
    assert!(
        (scaled[0] / even[0] - 1.3).abs() < 0.02 && (scaled[1] / even[1] - 1.0).abs() < 0.02,
        "{even:?} {scaled:?}"
    );
    // three axes in one plane measure no field
    let (code, _, error) = run(&["paper", "bound", "--axes", "1,0,0,0,1,0,1,1,0"]);
    assert!(code == 2 && error.contains("the true parameters: "), "{error}");
}

#[test]
fn lists_have_commas_or_blanks_and_a_number_may_be_negative() {
    for samples in [&["100,200"][..], &["100", "200"]] {
        let (code, json, error) =
            run(&[&["paper", "bound", "--runs", "2", "--snr", "35", "--json", "--samples"], samples].concat());
        let value: serde_json::Value = serde_json::from_str(&json).unwrap();
        assert_eq!((code, value["rows"].as_array().unwrap().len()), (0, 2), "{error}");
    }
    let (code, _, error) = run(&["simulate", "x.csv", "--seconds", "-3"]);
    assert!(code == 2 && error.contains("expected a number from"), "{error}");
}

#[cfg(unix)]
#[test]
fn a_dash_is_the_standard_input_and_output() {
    let folder = tempfile::tempdir().unwrap();
    let input = simulated(folder.path(), "5");
    let recording = fs::read(&input).unwrap();
    let found = magcomp().args(["replay", "-", "--output", "-"]).write_stdin(recording).output().unwrap();
    let (out, error) = (String::from_utf8(found.stdout).unwrap(), String::from_utf8(found.stderr).unwrap());
    assert_eq!(found.status.code(), Some(0), "{error}");
    assert!(out.starts_with("t_s,cx,cy,cz") && !out.contains("Heading:"), "{out}");
    assert!(error.contains("Heading:"), "{error}");
    let output = folder.path().join("out.csv");
    assert_eq!(run(&["replay", text(&input), "--output", text(&output)]).0, 0);
    assert_eq!(without_times(&out), without_times(&fs::read_to_string(&output).unwrap()));
}

#[test]
fn what_is_no_recording_has_one_exit_code() {
    let folder = tempfile::tempdir().unwrap();
    let write = |name: &str, content: &[u8]| {
        let path = folder.path().join(name);
        fs::write(&path, content).unwrap();
        path
    };
    let zipped = {
        let input = simulated(folder.path(), "5");
        let mut zip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
        std::io::Write::write_all(&mut zip, &fs::read(&input).unwrap()).unwrap();
        zip.finish().unwrap()
    };
    let logs = folder.path().join("logs");
    fs::create_dir(&logs).unwrap();
    fs::write(logs.join("a.csv"), "a,b\n1,2\n").unwrap();
    fs::write(logs.join("b.csv"), "c,d\n1,2\n").unwrap();
    for (path, why) in [
        (write("other.csv", b"a,b\n1,2\n"), "expected a header of"),
        (write("empty.csv", b""), "this file has nothing in it"),
        (write("rows.csv", b"t_s,mx,my,mz\n"), "a header but no rows"),
        (write("program", b"\x7fELF\0\0\0\0"), "this is no text file"),
        (write("cut.csv.gz", &zipped[..5]), "the file is cut off"),
        (logs, "; not in "),
    ] {
        let (code, _, error) = run(&["replay", text(&path)]);
        assert!(code == 1 && error.contains(why) && error.lines().count() == 1, "{code}: {error}");
    }
    let (code, _, error) = run(&["simulate", text(&folder.path().join("none/x.csv"))]);
    assert!(code == 1 && error.contains("there is no folder ") && !error.contains("magcomp-"), "{error}");
}

#[test]
fn completions_and_a_manual_page_are_printed() {
    let (code, script, _) = run(&["completions", "bash"]);
    assert!(code == 0 && script.contains("complete -F _magcomp"), "{script}");
    let (code, page, _) = run(&["manual"]);
    assert!(
        code == 0 && page.contains(".TH magcomp") && page.contains("REPLAY") && page.contains("Exit codes"),
        "{page}"
    );
}
