//! Replay explains every row.

use crate::{run, text};
use std::fs;
use std::path::{Path, PathBuf};

/// `magcomp replay --explain` of `input`, with these options: the rows by their columns.
fn explained(folder: &Path, input: &Path, options: &[&str]) -> (Vec<String>, Vec<Vec<String>>) {
    let output = folder.join("explained.csv");
    let (code, _, error) = run(&[&["replay", text(input), "--explain", text(&output)], options].concat());
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

/// A recording of so many seconds with a step at 20 s, in a folder.
fn stepped(folder: &Path, seconds: &str, seed: &str) -> PathBuf {
    let input = folder.join("in.csv");
    let simulated =
        run(&["simulate", text(&input), "--seconds", seconds, "--change", "step", "--at", "20", "--seed", seed]);
    assert_eq!(simulated.0, 0);
    input
}

#[test]
fn a_replay_explains_every_row() {
    let folder = tempfile::tempdir().unwrap();
    let input = stepped(folder.path(), "30", "2");
    let (columns, rows) = explained(folder.path(), &input, &[]);
    let recording = fs::read_to_string(&input).unwrap();
    assert_eq!(rows.len(), recording.lines().count() - 1);
    for (row, raw) in rows.iter().zip(recording.lines().skip(1)) {
        assert_eq!(row[0], raw.split(',').next().unwrap());
    }
    let cell = |row: usize, name: &str| rows[row][columns.iter().position(|column| column == name).unwrap()].as_str();
    let number = |row: usize, name: &str| cell(row, name).parse::<f64>().unwrap();
    assert_eq!((cell(50, "phase"), cell(50, "tries_both"), cell(50, "innovation_x_ut")), ("starting", "false", ""));
    // the first frame with a sample of the change, each of up to four
    let gated = (1_990..2_010).find(|row| cell(*row, "sample") == "gated").unwrap();
    assert!((2_000..2_008).contains(&gated), "{gated}");
    assert_eq!((cell(gated - 1, "phase"), cell(gated - 1, "sample")), ("running", "used"));
    assert!(number(gated - 1, "test_ratio") < 1.0 && number(gated, "test_ratio") > 1.0);
    // its story ends in the row of the decision, and is told once it has held
    let told = (0..rows.len()).find(|row| !cell(*row, "event").is_empty()).unwrap();
    assert_eq!((cell(told, "event"), cell(told, "phase")), ("device_step", "running"));
    assert!((number(told, "event_onset_s") - 20.0).abs() < 0.1);
    let before = (0..told).rfind(|row| cell(*row, "phase") == "undecided").unwrap();
    assert!((1.5..3.0).contains(&(number(told, "t_s") - number(before, "t_s"))), "{}", number(before, "t_s"));
    assert_eq!((cell(before, "phase"), cell(before, "sample")), ("undecided", "compared"));
    assert_eq!((cell(before, "hypothesis_1_kind"), cell(before, "hypothesis_2_kind")), ("device", "place"));
    assert_eq!(cell(before, "hypothesis_1_onset_s"), cell(told, "event_onset_s"));
    assert!(number(before, "hypothesis_2_log_odds") < -15.0);
    assert_eq!((told + 1..rows.len()).find(|row| !cell(*row, "event").is_empty()), None);
}

/// Without a gyroscope a change is decided by the samples of a frame that is over.
#[test]
fn each_event_has_one_row_without_a_gyroscope_too() {
    let folder = tempfile::tempdir().unwrap();
    let input = stepped(folder.path(), "40", "5");
    let (columns, rows) = explained(folder.path(), &input, &["--ignore", "gyro"]);
    let (code, summary, _) = run(&["replay", text(&input), "--ignore", "gyro", "--json"]);
    assert_eq!(code, 0);
    let summary: serde_json::Value = serde_json::from_str(&summary).unwrap();
    let told: Vec<f64> =
        summary["events"].as_array().unwrap().iter().map(|event| event["since_s"].as_f64().unwrap()).collect();
    let onset = columns.iter().position(|column| column == "event_onset_s").unwrap();
    let explained: Vec<f64> = rows.iter().filter_map(|row| row[onset].parse().ok()).collect();
    assert!(!told.is_empty() && explained.len() == told.len(), "{explained:?} for {told:?}");
    assert!(
        explained.iter().zip(&told).all(|(at, expected)| (at - expected).abs() < 1e-3),
        "{explained:?} for {told:?}"
    );
}

#[test]
fn a_rejected_row_is_explained_as_rejected() {
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("in.csv");
    fs::write(&input, "t_s,mx,my,mz\n0,1,2,3\n0.01,nan,2,3\n0.02,2,2,3\n").unwrap();
    let (columns, rows) = explained(folder.path(), &input, &[]);
    let sample = columns.iter().position(|column| column == "sample").unwrap();
    assert_eq!(rows.iter().map(|row| row[sample].as_str()).collect::<Vec<_>>(), ["pooled", "rejected", "pooled"]);
}
