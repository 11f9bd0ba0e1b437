//! The command from outside: columns, rows, errors, exit codes, and no half files.

use assert_cmd::Command;
use std::fs;
use std::path::{Path, PathBuf};

const COLUMNS: &str = "t_s,cx,cy,cz,fx,fy,fz,heading_deg,heading_sigma_deg,inclination_deg,sigma_t,window,coverage,\
                       status,bx,by,bz,w00,w01,w02,w10,w11,w12,w20,w21,w22,ns";

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

#[test]
fn replay_writes_one_row_for_every_row() {
    let folder = tempfile::tempdir().unwrap();
    let input = simulated(folder.path(), "12");
    let output = folder.path().join("out.csv");
    let (code, table, error) = run(&["replay", text(&input), "--output", text(&output)]);
    assert_eq!((code, error.as_str()), (0, ""));
    assert!(table.contains("spread of total field"), "{table}");

    let written = fs::read_to_string(&output).unwrap();
    let (mut lines, recording) = (written.lines(), fs::read_to_string(&input).unwrap());
    assert_eq!(lines.next().unwrap(), COLUMNS);
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), recording.lines().count() - 1);
    for (row, raw) in rows.iter().zip(recording.lines().skip(1)) {
        assert_eq!(row.len(), COLUMNS.split(',').count());
        assert_eq!(row[0], raw.split(',').next().unwrap());
    }
    // nothing is known at first: empty cells, no NaN, and no correction in force
    assert_eq!((rows[0][1], rows[0][7], rows[0][13]), ("", "", "collecting"));
    assert_eq!((rows[0][14], rows[0][17], rows[0][18]), ("0.000000", "1.000000000", "0.000000000"));
    assert_eq!(rows[1199][13], "tracking");
    assert!(!written.contains("NaN") && !written.contains("inf"));
}

#[test]
fn corrected_is_w_times_raw_less_b() {
    let folder = tempfile::tempdir().unwrap();
    let input = simulated(folder.path(), "5");
    let output = folder.path().join("out.csv");
    assert_eq!(run(&["replay", text(&input), "--output", text(&output)]).0, 0);
    let last = |path: &Path| -> Vec<f64> {
        let text = fs::read_to_string(path).unwrap();
        text.lines().last().unwrap().split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
    };
    let (raw, ours) = (last(&input), last(&output));
    for i in 0..3 {
        let corrected: f64 = (0..3).map(|j| ours[17 + 3 * i + j] * (raw[1 + j] - ours[14 + j])).sum();
        assert!((corrected - ours[1 + i]).abs() < 1e-5, "{corrected} against {}", ours[1 + i]);
    }
}

#[test]
fn true_heading_is_a_column_of_its_own() {
    let folder = tempfile::tempdir().unwrap();
    let input = simulated(folder.path(), "5");
    let output = folder.path().join("out.csv");
    for declination in [&["--declination", "-10.5"][..], &["--place", "-33.9,18.4", "--date", "2026-01-15"]] {
        let arguments = [&["replay", text(&input), "--output", text(&output)], declination].concat();
        let (code, _, error) = run(&arguments);
        assert_eq!((code, error.as_str()), (0, ""));
        let written = fs::read_to_string(&output).unwrap();
        assert_eq!(written.lines().next().unwrap(), format!("{COLUMNS},true_heading_deg"));
        let last: Vec<&str> = written.lines().last().unwrap().split(',').collect();
        let turned: f64 = last[27].parse::<f64>().unwrap() - last[7].parse::<f64>().unwrap();
        let declination = (turned + 540.0).rem_euclid(360.0) - 180.0;
        // Cape Town's declination is about -26 deg
        assert!((declination + 10.5).abs() < 1e-3 || (declination + 26.0).abs() < 1.5, "{declination}");
    }
}

/// `magcomp replay --explain` of `input`: the rows by their columns.
fn explained(folder: &Path, input: &Path) -> (Vec<String>, Vec<Vec<String>>) {
    let output = folder.join("explained.csv");
    let (code, _, error) = run(&["replay", text(input), "--explain", text(&output)]);
    assert_eq!((code, error.as_str()), (0, ""));
    let written = fs::read_to_string(&output).unwrap();
    assert!(!written.contains("NaN") && !written.contains("inf"));
    let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
    let mut lines = written.lines();
    let columns = cells(lines.next().unwrap());
    let rows: Vec<_> = lines.map(cells).collect();
    assert!(rows.iter().all(|row| row.len() == columns.len()));
    (columns, rows)
}

#[test]
fn a_replay_explains_every_row() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("in.csv");
    assert_eq!(run(&["simulate", text(&input), "--seconds", "30", "--change", "step", "--at", "20"]).0, 0);
    let (columns, rows) = explained(folder.path(), &input);
    let recording = fs::read_to_string(&input).unwrap();
    assert_eq!(rows.len(), recording.lines().count() - 1);
    for (row, raw) in rows.iter().zip(recording.lines().skip(1)) {
        assert_eq!(row[0], raw.split(',').next().unwrap());
    }
    let cell = |row: usize, name: &str| rows[row][columns.iter().position(|column| column == name).unwrap()].as_str();
    let number = |row: usize, name: &str| cell(row, name).parse::<f64>().unwrap();
    assert_eq!((cell(50, "phase"), cell(50, "tries_both"), cell(50, "innovation_x_ut")), ("starting", "true", ""));
    assert_eq!((cell(1999, "phase"), cell(1999, "sample"), cell(2000, "sample")), ("running", "used", "gated"));
    assert!(number(1999, "test_ratio") < 1.0 && number(2000, "test_ratio") > 1.0);
    // its story ends in the row of the decision
    let decided = (0..rows.len()).find(|row| !cell(*row, "event").is_empty()).unwrap();
    assert_eq!((cell(decided, "event"), cell(decided, "phase")), ("device_step", "running"));
    assert!((number(decided, "event_onset_s") - 20.0).abs() < 0.1);
    let before = decided - 1;
    assert_eq!((cell(before, "phase"), cell(before, "sample")), ("undecided", "compared"));
    assert_eq!((cell(before, "hypothesis_1_kind"), cell(before, "hypothesis_2_kind")), ("device", "place"));
    assert_eq!(cell(before, "hypothesis_1_onset_s"), cell(decided, "event_onset_s"));
    assert!(number(before, "hypothesis_2_log_odds") < -20.0);
    assert_eq!((decided + 1..rows.len()).find(|row| !cell(*row, "event").is_empty()), None);
}

#[test]
fn a_rejected_row_is_explained_as_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("in.csv");
    fs::write(&input, "t_s,mx,my,mz\n0,1,2,3\n0.01,nan,2,3\n0.02,2,2,3\n").unwrap();
    let (columns, rows) = explained(folder.path(), &input);
    let sample = columns.iter().position(|column| column == "sample").unwrap();
    assert_eq!(rows.iter().map(|row| row[sample].as_str()).collect::<Vec<_>>(), ["pooled", "rejected", "pooled"]);
}

#[test]
fn rejected_samples_keep_their_row() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("in.csv");
    fs::write(&input, "t_s,mx,my,mz\n0,1,2,3\n0.01,nan,2,3\n0.02,1,2,9999\n").unwrap();
    let output = folder.path().join("out.csv");
    assert_eq!(run(&["replay", text(&input), "--output", text(&output)]).0, 0);
    let written = fs::read_to_string(&output).unwrap();
    let status: Vec<&str> = written.lines().skip(1).map(|line| line.split(',').nth(13).unwrap()).collect();
    assert_eq!(status, ["collecting", "rejected", "rejected"]);
}

#[test]
fn what_is_missing_is_said_when_no_row_is_answered() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("in.csv");
    fs::write(&input, "t_s,mx,my,mz\n0,1,2,9999\n").unwrap();
    let (code, table, _) = run(&["replay", text(&input)]);
    assert_eq!(code, 0);
    assert!(table.contains("The last one says: rejected: field component 9999.0 uT"), "{table}");
    let (_, table, _) = run(&["replay", text(&simulated(folder.path(), "12"))]);
    assert!(!table.contains("The last one says"), "{table}");
}

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
fn a_cut_gzip_is_one_line() {
    let folder = tempfile::tempdir().unwrap();
    let whole = folder.path().join("in.csv.gz");
    assert_eq!(run(&["simulate", text(&whole), "--seconds", "5"]).0, 0);
    let (code, ..) = run(&["replay", text(&whole)]);
    assert_eq!(code, 0);
    let bytes = fs::read(&whole).unwrap();
    let cut = folder.path().join("cut.csv.gz");
    fs::write(&cut, &bytes[..bytes.len() / 2]).unwrap();
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
            assert_eq!((code, out.as_str()), (2, ""), "{arguments:?}");
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

#[test]
#[cfg(unix)]
fn rows_and_summary_can_share_standard_output() {
    let folder = tempfile::tempdir().unwrap();
    let (input, output) = (simulated(folder.path(), "5"), folder.path().join("out.txt"));
    // a file, and a pipe
    let file = fs::File::create(&output).unwrap();
    let mut command = std::process::Command::new(env!("CARGO_BIN_EXE_magcomp"));
    let arguments = ["replay", text(&input), "--output", "/dev/stdout"];
    assert!(command.args(arguments).stdout(file).status().unwrap().success());
    for written in [fs::read_to_string(&output).unwrap(), run(&arguments).1] {
        assert!(written.starts_with(COLUMNS), "{written}");
        let lines: Vec<&str> = written.lines().collect();
        assert!(lines[500].starts_with("4.99,") && lines[501] == "in.csv, method auto", "{}", lines[501]);
    }
}

#[test]
fn more_passes_change_the_times_alone() {
    let folder = tempfile::tempdir().unwrap();
    // more rows than are played at once
    let input = simulated(folder.path(), "50");
    let rows = |passes: &str| {
        let output = folder.path().join("out.csv");
        assert_eq!(run(&["replay", text(&input), "--passes", passes, "--output", text(&output)]).0, 0);
        without_times(&fs::read_to_string(&output).unwrap())
    };
    assert!(rows("1") == rows("3"));
}

/// The rows of an output without the time of each push, its last column.
fn without_times(output: &str) -> String {
    output.lines().map(|line| format!("{}\n", line.rsplit_once(',').unwrap().0)).collect()
}

#[test]
fn demo_needs_nothing_but_an_empty_folder() {
    let folder = tempfile::tempdir().unwrap();
    let found = magcomp().current_dir(folder.path()).args(["demo", "--runs", "1"]).output().unwrap();
    let (out, error) = (String::from_utf8(found.stdout).unwrap(), String::from_utf8(found.stderr).unwrap());
    assert_eq!((found.status.code(), error.as_str()), (Some(0), ""));
    assert!(out.contains("broad_34") && out.ends_with("report: magcomp-report/index.html\n"), "{out}");
    let pages = folder.path().join("magcomp-report");
    let html = fs::read_to_string(pages.join("index.html")).unwrap();
    let pictures = fs::read_dir(&pages).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    let pictures: Vec<String> = pictures.filter(|name| name.ends_with(".svg")).collect();
    assert!(pictures.len() > 4 && pictures.iter().all(|name| html.contains(name)), "{pictures:?}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn wrong_usage_is_exit_code_two_and_help_names_the_codes() {
    for arguments in [
        &["replay"][..],
        &["nonsense"],
        &["crb", "--runs", "0"],
        &["replay", "x", "--place", "1"],
        &["replay", "x", "--declination", "400"],
        &["simulate", "x", "--change", "repeated", "--at", "1e-9"],
        &["step", "--rate", "50"],
        &["step", "--motion", "tumble", "--set", "mid"],
        &["step", "--motion", "tumble", "--n-min", "50"],
        &["step", "--method", "adaptive", "--factor", "2"],
        &["crb", "--p", "0"],
        &["step", "--method", "adaptive", "--spikes", "2"],
        &["step", "--method", "adaptive", "--motion", "tumble", "--scenario", "ramp"],
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
            run(&[&["step", "--runs", "1", "--normalisation", "half-range", "--json"], options].concat());
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
            run(&[&["step", "--runs", "1", "--normalisation", "half-range", "--json"], options].concat());
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
    // three axes in one plane measure no field; own parameters belong to figs. 4 and 5
    let (code, _, error) = run(&["crb", "--axes", "1,0,0,0,1,0,1,1,0"]);
    assert!(code == 2 && error.contains("the true parameters: "), "{error}");
    let (code, _, error) = run(&["step", "--motion", "tumble", "--offset", "0,0,1"]);
    assert!(code == 2 && error.starts_with("magcomp: --offset: no such choice"), "{error}");
}

#[test]
fn simulate_is_reproducible_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let written = |name: &str, seed: &str| {
        let path = folder.path().join(name);
        let arguments =
            ["simulate", text(&path), "--seed", seed, "--seconds", "10", "--change", "step", "--spikes", "0.02"];
        assert_eq!(run(&arguments).0, 0);
        fs::read(path).unwrap()
    };
    let (first, again, other) = (written("a.csv", "5"), written("b.csv", "5"), written("c.csv", "6"));
    assert!(first == again && first != other);
    assert!(first.starts_with(b"t_s,mx,my,mz,ax,ay,az,gx,gy,gz,qw,qx,qy,qz,true_bx,true_by,true_bz\n"));
}

#[test]
fn json_parses_and_the_report_shows_its_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("pages");
    let (code, json, _) =
        run(&["crb", "--runs", "5", "--samples", "100,200", "--snr", "35", "--json", "--report", text(&pages)]);
    assert_eq!(code, 0);
    let value: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(value["rows"].as_array().unwrap().len(), 2);
    let html = fs::read_to_string(pages.join("index.html")).unwrap();
    assert!(html.contains("fig2_bound.svg") && html.contains("magcomp crb --runs 5"));
    assert!(fs::read_to_string(pages.join("fig2_bound.svg")).unwrap().starts_with("<svg"));
}

#[test]
fn compare_says_who_is_better_as_markdown() {
    let methods = ["--method", "adaptive,none", "--scenario", "constant,pulse", "--runs", "1"];
    let (code, text, error) = run(&[&["compare", "--markdown"], methods.as_slice()].concat());
    assert_eq!((code, error.as_str()), (0, ""));
    assert!(text.contains("|  | adaptive | none |\n|---|---|---|\n| constant | **"), "{text}");
    assert!(text.contains("adaptive is the best or as good in all of them."), "{text}");
}

#[test]
fn compare_judges_methods_with_gyroscope_by_themselves() {
    let given = |arguments: &[&str]| {
        let (code, text, error) = run(&[&["compare", "--json"], arguments].concat());
        assert_eq!(code, 0, "{error}");
        serde_json::from_str::<serde_json::Value>(&text).unwrap()
    };
    let named = |value: &serde_json::Value, name: &str| {
        value.as_array().unwrap().iter().find(|method| method["name"] == name).unwrap().clone()
    };
    let methods = ["--method", "none,aided,aided-sample,vqf-raw,vqf-ours,fusion"];
    let phone = given(&[&["--scenario", "phone-walk,step", "--runs", "1"], methods.as_slice()].concat());
    assert_eq!((phone[0]["methods"].as_array().unwrap().len(), phone[0]["aided"].as_array().unwrap().len()), (1, 5));
    // no gyroscope there
    assert_eq!(phone[1]["aided"].as_array().unwrap().len(), 0);
    let after_deg = |name: &str| named(&phone[0]["aided"], name)["after_deg"].as_f64().unwrap();
    assert!(after_deg("aided") < 2.0 && after_deg("vqf-ours") < 2.0, "{phone}");
    assert!(after_deg("fusion") > 3.0 && after_deg("vqf-raw") > 3.0, "{phone}");

    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/recordings/broad_34_attached_magnet_3cm.csv.gz");
    let recorded = given(&[&[path], methods.as_slice()].concat());
    let rms = |name: &str| named(&recorded[0]["aided"], name)["vectors"]["heading"]["rms_deg"].as_f64().unwrap();
    assert!(rms("aided") < rms("vqf-raw") && rms("vqf-raw") < rms("fusion"), "{recorded}");
    // the same figure as `replay` has for c
    let (_, text, _) = run(&["replay", "--json", path]);
    let replayed = serde_json::from_str::<serde_json::Value>(&text).unwrap()["heading"]["rms_deg"].as_f64().unwrap();
    assert!((rms("aided-sample") - replayed).abs() < 1e-6, "{} {replayed}", rms("aided-sample"));
    assert!(named(&recorded[0]["aided"], "vqf-raw")["vectors"]["spread_percent"].is_null());
}

#[test]
fn compare_on_a_recording_has_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let (input, pages) = (simulated(folder.path(), "30"), folder.path().join("pages"));
    let (code, table, error) =
        run(&["compare", text(&input), "--method", "adaptive,network", "--report", text(&pages)]);
    assert_eq!((code, error.as_str()), (0, ""));
    assert!(table.contains("adaptive") && table.contains("network"), "{table}");
    let picture = fs::read_to_string(pages.join("compare_in.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("adaptive"), "{picture}");
}

/// docs/EVALUATION.md has the lines that the command prints.
#[test]
fn the_page_of_situations_has_the_lines_of_the_command() {
    let page = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/EVALUATION.md")).unwrap();
    let lines = |page: &str| {
        let rows = page.lines().filter(|line| line.starts_with("| ") && !line.starts_with("|  |"));
        rows.map(|line| line.split(" | ").next().unwrap().to_owned()).collect::<Vec<_>>()
    };
    let (code, printed, error) = run(&["evaluate", "--runs", "1", "--markdown"]);
    assert_eq!(code, 0, "{error}");
    assert_eq!(
        lines(&printed),
        lines(&page),
        "run `cargo run --release -- evaluate --runs 10 --markdown > docs/EVALUATION.md`"
    );
    assert_eq!(lines(&page).len(), 51);
}

/// The committed recording with a reference, and its replay's output: for each row t_s, q, c, heading; NaN where a cell is empty.
fn replayed(recording: &str, output: &Path) -> Vec<(f64, [f64; 4], [f64; 3], f64)> {
    use std::io::Read;
    let mut text = String::new();
    flate2::read::GzDecoder::new(fs::File::open(recording).unwrap()).read_to_string(&mut text).unwrap();
    let cells = |line: &str| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect::<Vec<f64>>();
    let out = fs::read_to_string(output).unwrap();
    let rows = text.lines().skip(1).zip(out.lines().skip(1));
    rows.map(|(row, out)| {
        let (row, out) = (cells(row), cells(out));
        (row[0], [row[10], row[11], row[12], row[13]], [out[1], out[2], out[3]], out[7])
    })
    .collect()
}

#[test]
fn the_summary_agrees_with_the_output_and_opens_the_report() {
    let folder = tempfile::tempdir().unwrap();
    let [output, pages] = ["out.csv", "pages"].map(|name| folder.path().join(name));
    let recording = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/recordings/broad_34_attached_magnet_3cm.csv.gz");
    let (code, json, error) =
        run(&["replay", recording, "--json", "--output", text(&output), "--report", text(&pages)]);
    assert_eq!((code, error.as_str()), (0, ""));
    let value: serde_json::Value = serde_json::from_str(&json).unwrap();
    let of = |path: &str| value.pointer(path).and_then(serde_json::Value::as_f64).unwrap();

    // the same figures from the rows of the output, after 20 s
    let rows = replayed(recording, &output);
    let live: Vec<_> = rows.iter().filter(|row| row.0 - rows[0].0 > 20.0).collect();
    let lengths: Vec<f64> =
        live.iter().map(|(_, _, [x, y, z], _)| x.hypot(*y).hypot(*z)).filter(|length| length.is_finite()).collect();
    let mean = lengths.iter().sum::<f64>() / lengths.len() as f64;
    let spread = (lengths.iter().map(|length| (length - mean).powi(2)).sum::<f64>() / lengths.len() as f64).sqrt();
    assert!((of("/total_field_ut/compensated/mean") - mean).abs() < 1e-4, "{mean}");
    assert!((of("/total_field_ut/compensated/spread") - spread).abs() < 1e-4, "{spread}");
    // top edge in the world: y; within 60 deg of the horizontal
    let errors = live.iter().filter_map(|(_, [w, x, y, z], _, heading_deg)| {
        let (east, north) = (2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z));
        let off_deg = heading_deg - east.atan2(north).to_degrees();
        (east.hypot(north) > 0.5 && off_deg.is_finite()).then_some(off_deg)
    });
    let errors: Vec<f64> = errors.collect();
    let median = |part: fn(f64) -> f64| {
        let mut values: Vec<f64> = errors.iter().map(|error| part(error.to_radians())).collect();
        values.sort_by(f64::total_cmp);
        values[values.len() / 2]
    };
    let constant_deg = median(f64::sin).atan2(median(f64::cos)).to_degrees();
    let squares = errors.iter().map(|error| ((error - constant_deg + 540.0).rem_euclid(360.0) - 180.0).powi(2));
    let rms_deg = (squares.sum::<f64>() / errors.len() as f64).sqrt();
    assert!((of("/published_heading/constant_deg") - constant_deg).abs() < 0.01, "{constant_deg}");
    assert!((of("/published_heading/rms_deg") - rms_deg).abs() < 0.01, "{rms_deg}");
    // the magnet came off at 99.8 s; INDEX of the recordings: its field was 13.5 uT
    let change = &value["device_changes"][0];
    assert!((change["since_s"].as_f64().unwrap() - 99.8).abs() < 1.0, "{change}");
    assert!((change["hard_iron_change_ut"].as_f64().unwrap() - 13.5).abs() < 1.0, "{change}");
    assert_eq!(value["events"][0]["kind"], "DeviceStep");

    let (_, table, _) = run(&["replay", recording]);
    let sentence = table.lines().nth(1).unwrap().trim();
    let (ours, raw) = (of("/published_heading/rms_deg"), of("/raw_heading/rms_deg"));
    let expected = format!(
        "Heading: {ours:.1} deg rms of the reference; raw {raw:.0}; constant angle {constant_deg:+.1} deg taken out."
    );
    assert_eq!(sentence, expected);
    let page = fs::read_to_string(pages.join("index.html")).unwrap();
    assert!(page.contains(&format!("<p class=\"lead\">{sentence}")), "{page}");
}

#[test]
fn without_a_reference_the_summary_judges_by_field_dip_and_turns() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("in.csv");
    assert_eq!(run(&["simulate", text(&path), "--seconds", "60", "--motion", "pedestrian", "--field", "47,61"]).0, 0);
    // all but the reference and the truth
    let bare: String = fs::read_to_string(&path)
        .unwrap()
        .lines()
        .fold(String::new(), |bare, line| bare + &line.split(',').take(10).collect::<Vec<_>>().join(",") + "\n");
    fs::write(&path, bare).unwrap();
    let (code, table, error) = run(&["replay", text(&path), "--place", "45.1878,5.7269,200", "--date", "2025-05-31"]);
    assert_eq!((code, error.as_str()), (0, ""));
    let lines: Vec<&str> = table.lines().collect();
    assert!(
        lines[1].starts_with("  Total field: spread ") && lines[1].ends_with("model has 47.5 for the place."),
        "{table}"
    );
    assert!(lines[2].starts_with("  Dip: spread ") && lines[2].ends_with("; the model has 61.2."), "{table}");
    let (_, json, _) = run(&["replay", text(&path), "--json"]);
    let value: serde_json::Value = serde_json::from_str(&json).unwrap();
    let of = |path: &str| value.pointer(path).and_then(serde_json::Value::as_f64).unwrap();
    assert!(value["heading"].is_null() && value["dip_deg"]["raw"].is_null());
    assert!((of("/dip_deg/compensated/mean") - 61.0).abs() < 3.0, "{json}");
    assert!((of("/total_field_ut/compensated/mean") - 47.0).abs() < 3.0, "{json}");
    assert!(of("/total_field_ut/compensated/spread") < 0.5 * of("/total_field_ut/raw/spread"), "{json}");
    assert!(of("/full_turns/turns") >= 1.0, "{json}");
    assert!(of("/full_turns/rms_deg/compensated") < 0.5 * of("/full_turns/rms_deg/raw"), "{json}");
}

#[test]
fn samples_at_the_rail_are_rejected_and_counted() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("in.csv");
    assert_eq!(run(&["simulate", text(&path), "--seconds", "20", "--motion", "tumble"]).0, 0);
    // a sensor that reads up to 60 uT
    let (mut clipped, mut at_rail) = (String::new(), 0);
    for (k, line) in fs::read_to_string(&path).unwrap().lines().enumerate() {
        let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
        if k > 0 {
            let field: Vec<f64> = cells[1..4].iter().map(|cell| cell.parse().unwrap()).collect();
            at_rail += usize::from(field.iter().any(|value| value.abs() >= 60.0));
            for (cell, value) in cells[1..4].iter_mut().zip(field) {
                *cell = value.clamp(-60.0, 60.0).to_string();
            }
        }
        clipped += &(cells.join(",") + "\n");
    }
    assert!(at_rail > 20, "{at_rail}");
    fs::write(&path, clipped).unwrap();
    let counted = |arguments: &[&str]| {
        let (code, json, error) = run(&[&["replay", text(&path), "--json"], arguments].concat());
        assert_eq!((code, error.as_str()), (0, ""));
        let value: serde_json::Value = serde_json::from_str(&json).unwrap();
        (
            value["samples_at_rail"].as_u64().unwrap() as usize,
            value["status"]["rejected"].as_u64().unwrap_or(0) as usize,
        )
    };
    assert_eq!(counted(&["--rail", "60"]), (at_rail, at_rail));
    assert_eq!(counted(&[]), (0, 0));
    let (_, table, _) = run(&["replay", text(&path), "--rail", "60"]);
    let sentence = format!("{at_rail} of 2000 samples had a component at the sensor's rail and were left out.");
    assert!(table.contains(&sentence), "{table}");
    let (code, _, error) = run(&["replay", text(&path), "--rail", "0"]);
    assert!(code == 2 && error.contains("expected a number from 1 to 100000"), "{error}");
}
