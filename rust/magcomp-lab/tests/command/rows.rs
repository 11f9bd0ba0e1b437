//! Replay's output: a row for every row.

use crate::{run, simulated, text};
use std::fs;
use std::path::Path;

const COLUMNS: &str = "t_s,cx,cy,cz,fx,fy,fz,heading_deg,heading_sigma_deg,inclination_deg,sigma_t,window,coverage,\
                       status,bx,by,bz,w00,w01,w02,w10,w11,w12,w20,w21,w22,ns";

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

#[test]
fn a_course_of_the_recording_turns_north() {
    let folder = tempfile::tempdir().unwrap();
    let plain = folder.path().join("plain.csv");
    assert_eq!(run(&["simulate", text(&plain), "--seconds", "12", "--motion", "text"]).0, 0);
    let (aided, output) = (folder.path().join("aided.csv"), folder.path().join("out.csv"));
    let read = fs::read_to_string(&plain).unwrap();
    let (header, rows) = read.split_once('\n').unwrap();
    let at = |name: &str| header.split(',').position(|column| column == name).unwrap();
    let (w, x, y, z) = (at("qw"), at("qx"), at("qy"), at("qz"));
    // each second of the last half a heading of the top edge, 10 degrees too large
    let rows = rows.lines().enumerate().map(|(k, row)| {
        let cells: Vec<f64> = row.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        let (w, x, y, z) = (cells[w], cells[x], cells[y], cells[z]);
        let (east, north) = (2.0 * (x * y - w * z), 1.0 - 2.0 * (x * x + z * z));
        let course_deg = (east.atan2(north).to_degrees() + 10.0).rem_euclid(360.0);
        if k > 600 && k % 100 == 0 { format!("{row},{course_deg},0.5\n") } else { format!("{row},,\n") }
    });
    fs::write(&aided, format!("{header},course_deg,course_sigma_deg\n{}", rows.collect::<String>())).unwrap();
    let headings = |arguments: &[&str]| -> Vec<f64> {
        let all = [&["replay", text(&aided), "--declination", "0", "--output", text(&output)], arguments].concat();
        let (code, _, error) = run(&all);
        assert_eq!((code, error.as_str()), (0, ""));
        let written = fs::read_to_string(&output).unwrap();
        written.lines().skip(1).map(|row| row.split(',').nth(7).unwrap().parse().unwrap_or(f64::NAN)).collect()
    };
    let (alone, with) = (headings(&[]), headings(&["--course", "top"]));
    assert!(alone[..600].iter().zip(&with).all(|(one, other)| one == other || one.is_nan() && other.is_nan()));
    let turned = (with.last().unwrap() - alone.last().unwrap() + 540.0).rem_euclid(360.0) - 180.0;
    // between the magnetometer's north and that of the courses
    assert!((1.0..11.0).contains(&turned), "{turned}");
    let explained = folder.path().join("explained.csv");
    let (code, _, error) =
        run(&["replay", text(&aided), "--declination", "0", "--course", "top", "--explain", text(&explained)]);
    assert_eq!((code, error.as_str()), (0, ""));
    let written = fs::read_to_string(&explained).unwrap();
    let outside =
        |row: usize| written.lines().nth(row + 1).unwrap().rsplit(',').take(4).map(str::to_owned).collect::<Vec<_>>();
    assert!(outside(600).iter().all(String::is_empty));
    let [_, expected_deg, off_deg, word] = &outside(705)[..] else { panic!("four columns") };
    let (expected_deg, off_deg) = (expected_deg.parse::<f64>().unwrap(), off_deg.parse::<f64>().unwrap());
    assert!(
        word == "leads" && (0.5..11.0).contains(&off_deg) && expected_deg >= 0.5,
        "{word} {off_deg} {expected_deg}"
    );
    let (code, _, error) = run(&["replay", text(&aided), "--course", "sideways"]);
    assert!(code == 2 && error.contains("vehicle"), "{error}");
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
    assert!(table.contains("no heading, because after 0 s it says: rejected: field component 9999.0 uT"), "{table}");
    let (_, table, _) = run(&["replay", text(&simulated(folder.path(), "12"))]);
    assert!(!table.contains("it says: "), "{table}");
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
pub(crate) fn without_times(output: &str) -> String {
    output.lines().map(|line| format!("{}\n", line.rsplit_once(',').unwrap().0)).collect()
}
