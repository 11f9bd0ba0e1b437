//! The verdict that a replay begins with.

use crate::{run, text};
use std::fs;

/// The same recording, each row's cells of these columns changed.
fn changed(input: &str, columns: &[&str], change: impl Fn(f64) -> f64) -> String {
    let header: Vec<&str> = input.lines().next().unwrap().split(',').collect();
    let row = |line: &str| {
        let cells = line.split(',').zip(&header).map(|(cell, name)| {
            if columns.contains(name) { change(cell.parse().unwrap()).to_string() } else { cell.to_owned() }
        });
        cells.collect::<Vec<_>>().join(",")
    };
    let rows = input.lines().skip(1).map(row);
    std::iter::once(header.join(",")).chain(rows).collect::<Vec<_>>().join("\n") + "\n"
}

#[test]
fn a_replay_begins_with_its_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let good = folder.path().join("good.csv");
    assert_eq!(run(&["simulate", text(&good), "--seconds", "90", "--motion", "text", "--seed", "7"]).0, 0);
    let (code, table, error) = run(&["replay", text(&good)]);
    assert_eq!((code, error.as_str()), (0, ""));
    let lines: Vec<&str> = table.lines().map(str::trim).collect();
    assert!(lines[1] == "Verdict: good.", "{table}");
    // the published heading is the first row, and no time of a busy machine is there
    let rule = lines.iter().position(|line| line.starts_with("---")).unwrap();
    assert!(lines[rule + 1].starts_with("published heading") && !table.contains("push"), "{table}");

    let input = fs::read_to_string(&good).unwrap();
    let bad = folder.path().join("bad.csv");
    fs::write(&bad, changed(&input, &["mx"], |value| -value)).unwrap();
    let pages = folder.path().join("pages");
    let (code, table, error) = run(&["replay", text(&bad), "--report", text(&pages)]);
    assert!(
        code == 3 && table.contains("Verdict: bad: the field turns as if the magnetometer's axes were others"),
        "{table}"
    );
    assert!(table.contains("Next: replay it again with the option that is named"), "{table}");
    assert!(error.lines().last().unwrap().starts_with("magcomp: bad.csv is bad: the field turns"), "{error}");
    let page = fs::read_to_string(pages.join("index.html")).unwrap();
    assert!(page.contains("<section class=\"card bad\"") && page.contains("magnetometer's axes"), "no card");
    let (code, json, _) = run(&["replay", text(&bad), "--json"]);
    let told: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(code == 3 && told["verdict"]["grade"] == "bad" && told["rows"].as_u64() > Some(1000), "{json}");
    assert_eq!(run(&["replay", text(&bad), "--frame", "m=-x,y,z"]).0, 0);

    // too short to answer is no fault of the recording
    let short = folder.path().join("short.csv");
    assert_eq!(run(&["simulate", text(&short), "--seconds", "1", "--motion", "text"]).0, 0);
    let (code, table, _) = run(&["replay", text(&short)]);
    assert!(code == 0 && table.contains("Verdict: doubtful: no row was answered"), "{table}");
}
