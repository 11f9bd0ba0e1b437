//! Replay's summary agrees with its output.

use crate::{run, text};
use std::fs;
use std::path::Path;

/// The committed recording with a reference, and its replay's output: for each row t_s, q, c, heading; NaN where a cell is empty.
pub(crate) fn replayed(recording: &str, output: &Path) -> Vec<(f64, [f64; 4], [f64; 3], f64)> {
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
    // why: the panels of the estimator's inside
    let picture = std::fs::read_to_string(pages.join("replay_why.svg")).unwrap();
    assert!(["test ratio", "log odds", "noise as it is learned"].iter().all(|title| picture.contains(title)));
    // the magnet came off at 99.8 s; INDEX of the recordings: its field was 13.5 uT
    let change = &value["device_changes"][0];
    assert!((change["since_s"].as_f64().unwrap() - 99.8).abs() < 1.0, "{change}");
    assert!((change["hard_iron_change_ut"].as_f64().unwrap() - 13.5).abs() < 1.0, "{change}");
    assert_eq!(value["events"][0]["kind"], "DeviceStep");

    let (_, table, _) = run(&["replay", recording]);
    assert!(table.lines().nth(1).unwrap().starts_with("  Heading: known to +-"), "{table}");
    let sentence = table.lines().find(|line| line.contains("Reference: ")).unwrap().trim();
    let (ours, raw) = (of("/published_heading/rms_deg"), of("/raw_heading/rms_deg"));
    let expected = format!(
        "Reference: the heading is {ours:.1} deg rms off; raw {raw:.0}; constant angle {constant_deg:+.1} deg taken out."
    );
    assert_eq!(sentence, expected);
    let page = fs::read_to_string(pages.join("index.html")).unwrap();
    assert!(page.contains(&format!("<p>{sentence}")), "{page}");
}

#[test]
fn without_a_reference_the_summary_judges_by_field_dip_and_turns() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("in.csv");
    assert_eq!(run(&["simulate", text(&path), "--seconds", "60", "--motion", "walk", "--field", "47,61"]).0, 0);
    // all but the reference and the truth
    let bare: String = fs::read_to_string(&path)
        .unwrap()
        .lines()
        .fold(String::new(), |bare, line| bare + &line.split(',').take(10).collect::<Vec<_>>().join(",") + "\n");
    fs::write(&path, bare).unwrap();
    let (code, table, error) = run(&["replay", text(&path), "--place", "45.1878,5.7269,200", "--date", "2025-05-31"]);
    assert_eq!((code, error.as_str()), (0, ""));
    let lines: Vec<&str> = table.lines().collect();
    let line = |start: &str| lines.iter().find(|line| line.starts_with(start)).unwrap_or_else(|| panic!("{table}"));
    assert!(line("  Total field: spread ").ends_with("model has 47.5 for the place."), "{table}");
    assert!(line("  Dip: spread ").ends_with("; the model has 61.2."), "{table}");
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
    // nobody tells it: after some samples it is found
    let (found, rejected) = counted(&[]);
    assert!(found == rejected && (at_rail * 3 / 4..=at_rail).contains(&found), "{found} of {at_rail}");
    let (_, table, _) = run(&["replay", text(&path), "--rail", "60"]);
    let sentence = format!("{at_rail} of 2000 samples had a component at the sensor's rail and were left out.");
    assert!(table.contains(&sentence), "{table}");
    let (code, _, error) = run(&["replay", text(&path), "--rail", "0"]);
    assert!(code == 2 && error.contains("expected a number from 1 to 100000"), "{error}");
}

/// The magnet of broad_33 was put on at 42.5 s and taken off at 98.7 s; the sensor lies still at the end, and its reference tells the bearing.
#[test]
fn what_a_tester_noted_stands_beside_what_was_told() {
    let folder = tempfile::tempdir().unwrap();
    let recording = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/recordings/broad_33_attached_magnet_2cm.csv.gz");
    let [output, pages] = ["out.csv", "pages"].map(|name| folder.path().join(name));
    let (_, _, _) = run(&["replay", recording, "--output", text(&output)]);
    let (_, [w, x, y, z], _, _) = replayed(recording, &output).into_iter().rfind(|row| row.0 < 150.0).unwrap();
    let bearing_deg = (2.0 * (x * y - w * z)).atan2(1.0 - 2.0 * (x * x + z * z)).to_degrees();
    let noted = ["--mark", "98.7=magnet off", "--mark", "140=nothing", "--bearing", &format!("150={bearing_deg:.1}")];
    let (code, json, _) = run(&[&["replay", recording, "--json", "--report", text(&pages)], noted.as_slice()].concat());
    assert_eq!(code, 0);
    let value: serde_json::Value = serde_json::from_str(&json).unwrap();
    let after_s = value.pointer("/marks/0/decided_after_s").and_then(serde_json::Value::as_f64).unwrap();
    assert!((0.5..6.0).contains(&after_s) && value.pointer("/marks/1/event").unwrap().is_null(), "{after_s}");
    let of = |path: &str| value.pointer(path).and_then(serde_json::Value::as_f64).unwrap();
    let off_deg = (of("/bearings/0/heading_deg") - bearing_deg + 540.0).rem_euclid(360.0) - 180.0;
    assert!(off_deg.abs() < 2.0 * of("/bearings/0/sigma_deg"), "{off_deg}");
    let page = fs::read_to_string(pages.join("index.html")).unwrap();
    assert!(
        page.contains("magnet off at 98.7 s: DeviceStep, told ")
            && page.contains("nothing at 140.0 s: no change was told")
    );
    assert!(fs::read_to_string(pages.join("replay.svg")).unwrap().contains("noted: magnet off"));
    let (code, _, error) = run(&["replay", recording, "--mark", "cover"]);
    assert!(code == 2 && error.contains("such as 52=cover"), "{error}");
}
