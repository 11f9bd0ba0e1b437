//! Several recordings are several recordings, and never one session.

use crate::simulated::{Phone, rows};
use crate::{folder, import, refused, run};
use std::fs;
use std::io::Write as _;
use std::path::Path;

/// Verdicts by recording, as `replay --json` of several has them.
fn lines(arguments: &[&str]) -> (i32, Vec<(String, Option<String>)>) {
    let (code, out, error) = run(&[&["replay", "--json"], arguments].concat());
    let found: serde_json::Value = serde_json::from_str(&out).unwrap_or_else(|_| panic!("{out} {error}"));
    let line = |line: &serde_json::Value| {
        let word = |value: &serde_json::Value| value.as_str().map(str::to_owned);
        (word(&line["recording"]).unwrap(), word(&line["verdict"]["grade"]))
    };
    (code, found.as_array().unwrap().iter().map(line).collect())
}

#[test]
fn two_recordings_are_a_line_each_and_never_one_session() {
    let [first, second] = [rows(&Phone::new(7)), rows(&Phone::new(8))];
    let folder = folder(&[("a.csv", &first), ("b.csv", &second), ("notes.txt", "rain, and a blue phone\n")]);
    let [a, b] = ["a.csv", "b.csv"].map(|name| folder.path().join(name));
    let text = |path: &Path| path.to_str().unwrap().to_owned();
    let (_, found) = lines(&[&text(&a), &text(&b)]);
    assert_eq!(found.iter().map(|line| line.0.as_str()).collect::<Vec<_>>(), ["a.csv", "b.csv"]);
    assert!(found.iter().all(|line| line.1.is_some()), "{found:?}");
    // a folder of recordings, of which one file is none
    let (_, found) = lines(&[&text(folder.path())]);
    assert!(found.len() == 3 && found[2].1.is_none(), "{found:?}");
    // or one that is damaged, before the others are compared
    fs::write(folder.path().join("0.csv"), "t_s,mx,my,mz\n0,1,2,three\n1,1,2,3\n").unwrap();
    let (_, found) = lines(&[&text(folder.path())]);
    assert!(found.len() == 4 && found[0] == ("0.csv".to_owned(), None) && found[1].1.is_some(), "{found:?}");
    fs::remove_file(folder.path().join("0.csv")).unwrap();
    let pages = tempfile::tempdir().unwrap();
    let (_, table, _) = run(&["replay", &text(&a), &text(&b), "--report", &text(pages.path())]);
    assert!(table.contains("2 recordings, a line each"), "{table}");
    let index = fs::read_to_string(pages.path().join("index.html")).unwrap();
    for page in ["01_a.csv/index.html", "02_b.csv/index.html"] {
        assert!(index.contains(page) && pages.path().join(page).exists(), "{page}");
    }
    // what belongs to one recording is not written for several, nor is a session made of them
    let out = text(&pages.path().join("o.csv"));
    let (code, _, error) = run(&["replay", &text(&a), &text(&b), "--output", &out]);
    assert!(code == 2 && error.contains("are of the same sensor: these are several recordings"), "{error}");
    assert!(refused(&[&a, &b], &[]).contains("these are several recordings"));
    assert!(refused(&[folder.path()], &[]).contains("these are several recordings"));
}

#[test]
fn no_form_takes_two_files_of_one_sensor() {
    let gnss = "UncalMag,1663164669191,65972055195160,221.5,89.5,-21.25,213.5,180.25,5.5\n";
    let ipin = "% a comment\nMAGN;0.1;100.1;20;30;-40;3\n";
    let phyphox = "\"Time (s)\",\"Field x (µT)\",\"Field y (µT)\",\"Field z (µT)\"\n0,20,30,-40\n";
    let plain = "t_s,mx,my,mz\n0,20,30,-40\n";
    for text in [gnss, ipin, phyphox, plain] {
        let folder = folder(&[("one.csv", text), ("two.csv", text)]);
        let error = refused(&[&folder.path().join("one.csv"), &folder.path().join("two.csv")], &[]);
        assert!(error.contains("one.csv and ") && error.contains("these are several recordings"), "{error}");
    }
    // a recording beside a logger's files was lost without a word
    let folder = folder(&[("Magnetometer.csv", crate::RAW), ("r.csv", plain)]);
    assert!(refused(&[folder.path()], &[]).contains("these are several recordings"));
    // tables of other things may have one name
    let others = self::folder(&[("Magnetometer.csv", crate::RAW)]);
    fs::write(others.path().join("Notes.csv"), "a,b\n1,2\n").unwrap();
    fs::write(others.path().join("Notes.txt"), "c,d\n1,2\n").unwrap();
    assert_eq!(import(&[others.path()], &[]).0, 0);
}

#[test]
fn two_zip_entries_of_one_name_and_too_many_entries_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("session.zip");
    let zipped = |names: &[String]| {
        let mut zip = zip::ZipWriter::new(std::io::Cursor::new(Vec::new()));
        for name in names {
            zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
            zip.write_all(crate::RAW.as_bytes()).unwrap();
        }
        zip.finish().unwrap().into_inner()
    };
    // the writer refuses a name that it has, so the second is renamed in the bytes
    let mut bytes = zipped(&["Magnetometer.csv".to_owned(), "Magnetometex.csv".to_owned()]);
    let found: Vec<usize> = (0..bytes.len() - 16).filter(|at| &bytes[*at..at + 16] == b"Magnetometex.csv").collect();
    found.iter().for_each(|at| bytes[at + 11] = b'r');
    fs::write(&path, bytes).unwrap();
    let error = refused(&[&path], &[]);
    assert!(error.contains("two of its entries have the same name"), "{error}");
    fs::write(&path, zipped(&(0..2500).map(|k| format!("{k}.csv")).collect::<Vec<_>>())).unwrap();
    let error = refused(&[&path], &[]);
    assert!(error.contains("2500 files are in it, and a session has at most 2000"), "{error}");
}

#[test]
fn time_that_runs_back_ends_a_session_and_one_can_be_picked() {
    let mut text = "t_s,mx,my,mz,gx,gy,gz\n".to_owned();
    for (session, count) in [(0, 300), (1, 200)] {
        for k in 0..count {
            text += &format!("{},{},30,{},0,0,0.1\n", f64::from(k) * 0.02, 20 + 50 * session, k % 7);
        }
    }
    let folder = folder(&[("r.csv", &text)]);
    let path = folder.path().join("r.csv");
    let error = refused(&[&path], &[]);
    assert!(
        error.contains("holds 2 sessions (1: 0.0 to 6.0 s, 300 magnetometer events; 2: 0.0 to 4.0 s, 200"),
        "{error}"
    );
    let picked = |number: &str| import(&[&path], &["--session", number]).3.unwrap();
    assert_eq!([picked("1").lines().count(), picked("2").lines().count()], [301, 201]);
    assert!(picked("2").lines().skip(1).all(|line| line.split(',').nth(1) == Some("70")));
    assert!(refused(&[&path], &["--session", "3"]).contains("--session 3: it holds 2 sessions"));
    let (_, found) = lines(&[path.to_str().unwrap()]);
    assert_eq!(found.iter().map(|line| line.0.as_str()).collect::<Vec<_>>(), ["r.csv, session 1", "r.csv, session 2"]);
}
