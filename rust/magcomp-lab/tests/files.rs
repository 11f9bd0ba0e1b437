//! Files as loggers, robots and hostile senders make them: what is readable is taken with a warning, the rest is refused with an error
//! of one line; nothing ends the process, fills the memory, waits for ever or is overwritten.

#![cfg(unix)]

use magcomp_lab::import::{ImportOptions, import};
use nix::sys::resource::{Resource, getrlimit, setrlimit};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::io::{Cursor, Write as _};
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Memory that the command may ask for in these tests, KiB.
const MEMORY_KIB: u64 = 700_000;

/// Runs it in little memory; exit code (none after a signal), standard output, standard error.
fn run_in(folder: &Path, arguments: &[&str]) -> (Option<i32>, String, String) {
    let limited = format!("ulimit -v {MEMORY_KIB}; exec \"$0\" \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &limited, env!("CARGO_BIN_EXE_magcomp")]).args(arguments).current_dir(folder);
    let output = command.output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code(), text(&output.stdout), text(&output.stderr))
}

fn folder(files: &[(&str, &[u8])]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    files.iter().for_each(|(name, bytes)| fs::write(folder.path().join(name), bytes).unwrap());
    folder
}

/// The recording that `IN` in `folder` is made into, and the warnings.
fn imported(folder: &Path, input: &str, options: &[&str]) -> (String, String) {
    let out = tempfile::tempdir().unwrap();
    let output = out.path().join("out.csv");
    let arguments = [&["import", input, "-o", output.to_str().unwrap()], options].concat();
    let (code, _, error) = run_in(folder, &arguments);
    assert_eq!(code, Some(0), "{input}: {error}");
    assert!(error.lines().all(|line| line.starts_with("magcomp: warning: ")), "{error}");
    (fs::read_to_string(output).unwrap(), error)
}

/// The error, of one line, with which `IN` is refused.
fn refused(folder: &Path, input: &str, options: &[&str]) -> String {
    let out = tempfile::tempdir().unwrap();
    let output = out.path().join("out.csv");
    let arguments = [&["import", input, "-o", output.to_str().unwrap()], options].concat();
    let (code, stdout, error) = run_in(folder, &arguments);
    assert!(matches!(code, Some(1 | 2)) && stdout.is_empty() && !output.exists(), "{input}: {code:?} {stdout} {error}");
    assert_eq!(error.lines().count(), 1, "{error}");
    error
}

/// A row of GnssLogger.
const GNSS: &[u8] = b"UncalMag,1663164669191,65972055195160,221.5,89.5,-21.25,213.5,180.25,5.5\n";

/// Rows of a Sensor Logger file at 100 Hz.
fn logged(rows: usize, row: impl Fn(usize) -> [f64; 3]) -> String {
    let mut text = "time,seconds_elapsed,z,y,x\n".to_owned();
    for k in 0..rows {
        let [x, y, z] = row(k);
        writeln!(text, "{},{},{z},{y},{x}", 1_700_000_000_000_000_000 + k as u64 * 10_000_000, k as f64 / 100.0)
            .unwrap();
    }
    text
}

fn field(rows: usize) -> String {
    logged(rows, |k| [20.0 + k as f64 % 7.0, 30.0, -40.0])
}

/// Sizes of a run's acceleration, m/s^2: a fifth is below 16, half below 23.
fn of_a_run(k: usize) -> f64 {
    8.0 + (k % 100) as f64 * 0.3
}

#[test]
fn a_run_is_no_other_unit() {
    let rows = |unit: f64| {
        let mut text = "t_s,mx,my,mz,ax,ay,az\n".to_owned();
        for k in 0..400 {
            writeln!(text, "{},20,{},-40,0,0,{}", k as f64 / 100.0, k % 5, of_a_run(k) * unit).unwrap();
        }
        text
    };
    let folder = folder(&[
        ("run.csv", rows(1.0).as_bytes()),
        ("rest.csv", rows(0.5).as_bytes()),
        ("run_in_g.csv", rows(1.0 / 9.80665).as_bytes()),
        ("run_in_mg.csv", rows(1e3 / 9.80665).as_bytes()),
        ("linear.csv", rows(0.002).as_bytes()),
    ]);
    let replay = |name: &str, more: &[&str]| run_in(folder.path(), &[&["replay", name], more].concat());
    let (code, _, error) = replay("run.csv", &[]);
    assert_eq!(code, Some(0), "{error}");
    assert!(
        error.starts_with("magcomp: warning: run.csv: acceleration is mostly 23.") && error.lines().count() == 1,
        "{error}"
    );
    assert_eq!(replay("rest.csv", &[]).2, "");
    // the units that occur are told apart, however lively it is
    let (code, _, error) = replay("run_in_g.csv", &[]);
    assert!(code == Some(1) && error.contains("looks like g: --units a=g, or a=-g for Apple's sign"), "{error}");
    assert_eq!(replay("run_in_g.csv", &["--units", "a=g"]).0, Some(0));
    for (name, hint) in [("run_in_mg.csv", "mostly 23"), ("linear.csv", "is it an acceleration without gravity?")] {
        let (code, _, error) = replay(name, &[]);
        assert!(code == Some(1) && error.contains(hint), "{error}");
    }
    // an iPhone's run in g with Apple's sign
    let apple = logged(400, |k| [0.0, 0.0, -of_a_run(k) / 6.0]);
    let session = self::folder(&[
        ("MagnetometerUncalibrated.csv", field(400).as_bytes()),
        ("AccelerometerUncalibrated.csv", apple.as_bytes()),
    ]);
    let (text, _) = imported(session.path(), ".", &[]);
    let up: f64 = text.lines().nth(1).unwrap().split(',').nth(6).unwrap().parse().unwrap();
    assert!((up - 8.0 / 6.0 * 9.80665).abs() < 1e-9, "{up}");
}

#[test]
fn an_optional_file_that_cannot_be_read_is_left_out_with_a_warning() {
    let (m, a, unknown) = (field(30), logged(30, |_| [0.0, 0.0, 9.8]), "time,seconds_elapsed,a,b\n1,2,3,4\n");
    let files: [(&str, &[u8]); 6] = [
        ("MagnetometerUncalibrated.csv", m.as_bytes()),
        // as the app writes for a sensor that the phone lacks
        ("AccelerometerUncalibrated.csv", b""),
        ("Annotation.csv", b""),
        ("TotalAcceleration.csv", a.as_bytes()),
        ("Gyroscope.csv", unknown.as_bytes()),
        ("Magnetometer.csv.gz", b"\x1f\x8b\x08\x00 no more"),
    ];
    let session = folder(&files);
    let check = |(text, warnings): (String, String)| {
        assert_eq!(text.lines().nth(1).unwrap(), "0.000000000,20,30,-40,0,0,9.8,,,");
        assert_eq!(warnings.lines().count(), 3, "{warnings}");
        for (name, why) in [
            ("AccelerometerUncalibrated.csv", "found an empty file"),
            ("Gyroscope.csv", "expected a header with the column 'x'"),
            ("Magnetometer.csv.gz", "cannot be read"),
        ] {
            let line =
                warnings.lines().find(|line| line.contains(name)).unwrap_or_else(|| panic!("{name}: {warnings}"));
            assert!(line.starts_with("magcomp: warning: a file was left out (") && line.contains(why), "{line}");
        }
    };
    check(imported(session.path(), ".", &[]));
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, bytes) in files {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(bytes).unwrap();
    }
    fs::write(session.path().join("session.zip"), zip.finish().unwrap().into_inner()).unwrap();
    check(imported(session.path(), "session.zip", &[]));
    let (code, json, _) = run_in(session.path(), &["import", "session.zip", "-o", "/dev/null", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(code == Some(0) && json["warnings"].as_array().unwrap().len() == 3, "{json}");

    // the system's field stands in for an empty raw one; without any, or with one that is damaged, nothing can be done
    fs::write(session.path().join("MagnetometerUncalibrated.csv"), "").unwrap();
    assert!(refused(session.path(), ".", &[]).contains("MagnetometerUncalibrated.csv: line 1: expected a header"));
    fs::remove_file(session.path().join("MagnetometerUncalibrated.csv")).unwrap();
    assert!(refused(session.path(), ".", &[]).contains("Magnetometer.csv.gz: cannot be read"));
    fs::write(session.path().join("MagnetometerUncalibrated.csv"), "").unwrap();
    fs::remove_file(session.path().join("Magnetometer.csv.gz")).unwrap();
    assert!(refused(session.path(), ".", &[]).contains("MagnetometerUncalibrated.csv: line 1: expected a header"));
    fs::write(session.path().join("Magnetometer.csv"), &m).unwrap();
    let (_, warnings) = imported(session.path(), ".", &[]);
    assert!(warnings.contains("MagnetometerUncalibrated.csv: line 1: expected a header"), "{warnings}");
    fs::write(session.path().join("MagnetometerUncalibrated.csv"), m.replace("-40", "forty")).unwrap();
    assert!(refused(session.path(), ".", &[]).contains("MagnetometerUncalibrated.csv: line 2, column 3 (z)"));
}

#[test]
fn every_loggers_optional_files_are_left_out_alike() {
    let rows = |header: &str| format!("{header}\n0.0,20,30,-40\n0.01,20,31,-40\n0.02,20,30,-41\n");
    let phyphox = rows("\"Time (s)\",\"Magnetic field x (µT)\",\"Magnetic field y (µT)\",\"Magnetic field z (µT)\"");
    let broken = "\"Time (s)\",\"Gyroscope x (rad/s)\",\"Gyroscope y (rad/s)\",\"Gyroscope z (rad/s)\"\n0,1,2,x\n";
    let matlab = "Timestamp,X,Y,Z\n22-Nov-2026 10:11:12.340,20,30,-40\n22-Nov-2026 10:11:12.350,20,30,-41\n";
    let plain = rows("t_s,mx,my,mz");
    type Files<'a> = &'a [(&'a str, &'a [u8])];
    let sessions: [(Files<'_>, &str, &str); 3] = [
        (
            &[
                ("Magnetometer.csv", phyphox.as_bytes()),
                ("Accelerometer.csv", b""),
                ("Gyroscope.csv", broken.as_bytes()),
            ],
            "Accelerometer.csv",
            "Gyroscope.csv: line 2, column 4",
        ),
        (
            &[
                ("MagneticField.csv", matlab.as_bytes()),
                ("Acceleration.csv", b""),
                ("AngularVelocity.csv", b"a,b\n1,2\n"),
            ],
            "Acceleration.csv: line 1: expected a header",
            "AngularVelocity.csv: line 1: expected a header",
        ),
        (
            &[("m.csv", plain.as_bytes()), ("a.csv", b""), ("g.csv", b"t_s,gx,gy,gz\n0,1,2,x\n")],
            "a.csv: line 1: expected a header",
            "g.csv: line 2, column 4",
        ),
    ];
    for (files, first, second) in sessions {
        let session = folder(files);
        let (text, warnings) = imported(session.path(), ".", &[]);
        assert!(text.lines().count() > 2 && warnings.lines().count() == 2, "{warnings}");
        assert!(warnings.contains(first) && warnings.contains(second), "{warnings}");
    }
}

/// All files below a folder, with their content.
fn content(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.is_symlink() {
            found.extend(content(&path));
        } else {
            found.insert(path.clone(), fs::read(&path).unwrap_or_default());
        }
    }
    found
}

#[test]
fn no_output_goes_into_the_session_or_onto_another_output() {
    let place = tempfile::tempdir().unwrap();
    let path = |name: &str| place.path().join(name);
    fs::create_dir_all(path("F/deep")).unwrap();
    fs::create_dir(path("other")).unwrap();
    let (m, a) = (field(30), logged(30, |_| [0.0, 0.0, 9.8]));
    fs::write(path("F/MagnetometerUncalibrated.csv"), &m).unwrap();
    fs::write(path("F/TotalAcceleration.csv"), &a).unwrap();
    fs::write(path("r.csv"), "t_s,mx,my,mz\n0,1,2,3\n0.01,1,2,3\n").unwrap();
    symlink(path("F"), path("link")).unwrap();
    symlink("F/TotalAcceleration.csv", path("file_link.csv")).unwrap();
    symlink("F", path("other/up")).unwrap();
    symlink(path("F/deep"), path("into")).unwrap();
    let before = content(place.path());
    let inside = [
        "F/TotalAcceleration.csv",
        "F/new.csv",
        "F/deep/new.csv",
        "F",
        "link/new.csv",
        "link/TotalAcceleration.csv",
        "file_link.csv",
        "other/../F/new.csv",
        "into/../new.csv",
        "into/new.csv",
        "./F/./new.csv",
        "F/none/new.csv",
    ];
    let refuse = |arguments: &[&str], why: &str| {
        let (code, out, error) = run_in(place.path(), arguments);
        assert!(code == Some(2) && out.is_empty() && error.lines().count() == 1, "{arguments:?}: {code:?} {error}");
        assert!(error.contains(why), "{arguments:?}: {error}");
        assert_eq!(content(place.path()), before, "{arguments:?}");
    };
    for output in inside {
        for input in ["F", "link", "other/../F"] {
            refuse(&["import", input, "-o", output], "in the input");
            refuse(&["replay", input, "--output", output], "in the input");
            refuse(&["replay", input, "--explain", output], "in the input");
        }
        refuse(&["replay", "F", "--calibration", output], "--calibration");
    }
    for verb in ["replay", "compare"] {
        refuse(&[verb, "F", "--report", "F/pages"], "--report F/pages lies in the input F");
        refuse(&[verb, "F", "--report", "link"], "--report link lies in the input F");
    }
    refuse(&["import", "F", "-o", "out.csv", "--report", "F"], "--report F lies in the input F");
    // two outputs
    refuse(&["replay", "r.csv", "--output", "x.csv", "--calibration", "other/../x.csv"], "is --output too");
    refuse(&["replay", "r.csv", "--output", "x.csv", "--explain", "other/../x.csv"], "is --output too");
    for output in ["pages/index.html", "pages/replay_sphere.svg"] {
        refuse(&["replay", "r.csv", "--output", output, "--report", "pages"], "may be a page of --report");
        refuse(&["simulate", output, "--seconds", "1", "--report", "pages"], "may be a page of --report");
    }
    // a folder beside it, and one whose name only begins alike, are fine
    fs::create_dir(path("F2")).unwrap();
    for output in ["F2/out.csv", "out.csv", "/dev/null"] {
        assert_eq!(run_in(place.path(), &["import", "F", "-o", output]).0, Some(0), "{output}");
    }
    assert_eq!(run_in(place.path(), &["replay", "F", "--output", "/dev/null", "--report", "pages"]).0, Some(0));
}

/// A file of `tests/sessions`.
fn session(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/sessions").join(name)).unwrap()
}

const TABLE: [&str; 4] = ["--columns", "t=time,mx=bx,my=by,mz=bz,gx=rate_x,gy=rate_y,gz=rate_z", "--units", "t=ns"];

/// A bag of so many field messages, a few in each chunk, packed or not.
fn bag(messages: u32, compression: Option<mcap::Compression>, log_time: u64) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    let options = mcap::WriteOptions::new().chunk_size(Some(2048)).compression(compression);
    let mut writer = options.create(&mut bytes).unwrap();
    let schema = writer.add_schema("sensor_msgs/msg/MagneticField", "ros2msg", b"").unwrap();
    let channel = writer.add_channel(schema, "/mag", "cdr", &BTreeMap::new()).unwrap();
    for k in 0..messages {
        let mut data = vec![0, 1, 0, 0];
        let stamp = if log_time > 0 { [0, 0] } else { [1_700_000_000, k * 10_000_000] };
        stamp.iter().for_each(|word| data.extend(word.to_le_bytes()));
        data.extend(4_u32.to_le_bytes());
        data.extend(b"mag\0");
        let numbers = [2e-5, 3e-5, -4e-5 - 1e-7 * f64::from(k)].into_iter().chain([0.0; 9]);
        numbers.for_each(|number| data.extend(number.to_le_bytes()));
        let time = log_time + u64::from(k);
        let header =
            mcap::records::MessageHeader { channel_id: channel, sequence: k, log_time: time, publish_time: time };
        writer.write_to_known_channel(&header, &data).unwrap();
    }
    writer.finish().unwrap();
    drop(writer);
    bytes.into_inner()
}

#[test]
fn a_cut_bag_gives_what_precedes_the_cut() {
    for compression in [None, Some(mcap::Compression::Zstd), Some(mcap::Compression::Lz4)] {
        let whole = bag(90, compression, 0);
        let folder = folder(&[("whole.mcap", &whole)]);
        let (expected, warnings) = imported(folder.path(), "whole.mcap", &[]);
        assert_eq!((expected.lines().count(), warnings.as_str()), (91, ""));
        let mut rows = Vec::new();
        for part in [2, 5, 9] {
            fs::write(folder.path().join("cut.mcap"), &whole[..whole.len() * part / 10]).unwrap();
            let (text, warnings) = imported(folder.path(), "cut.mcap", &[]);
            assert!(expected.starts_with(&text) && text.lines().count() > 1, "{text}");
            assert!(
                warnings.contains("cut.mcap: cannot be read: ") && warnings.contains("what is before that place"),
                "{warnings}"
            );
            rows.push(text.lines().count());
        }
        assert!(rows.is_sorted() && rows[0] < 40 && rows[2] > 40, "{rows:?}");
        // nothing before the cut
        fs::write(folder.path().join("cut.mcap"), &whole[..60]).unwrap();
        assert!(refused(folder.path(), "cut.mcap", &[]).contains("cut.mcap: cannot be read: "));
    }
}

#[test]
fn lengths_beyond_the_file_are_errors() {
    let mut hostile: Vec<(&str, Vec<u8>)> = Vec::new();
    // the first record of a bag, and its chunk
    for (name, at) in [("header.mcap", 9), ("chunk.mcap", 9 + 8 + 53 + 1)] {
        let mut bytes = session("ros2.mcap");
        bytes[at..at + 8].copy_from_slice(&(8_u64 << 60).to_le_bytes());
        hostile.push((name, bytes));
    }
    // the footer of an Arrow file
    let mut bytes = session("table.feather");
    let end = bytes.len() - 10;
    bytes[end..end + 4].copy_from_slice(&i32::MAX.to_le_bytes());
    hostile.push(("footer.feather", bytes));
    // a message of an Arrow stream
    let mut bytes = session("table.arrow");
    bytes[4..8].copy_from_slice(&i32::MAX.to_le_bytes());
    hostile.push(("message.arrow", bytes));
    for (name, bytes) in &hostile {
        let folder = folder(&[(name, bytes)]);
        assert!(refused(folder.path(), name, &TABLE[..2]).contains(&format!("{name}: cannot be read: ")), "{name}");
    }
}

/// Imports each file many times, damaged in another way each time: `MAGCOMP_FUZZ` times, or few enough to take seconds.
///
/// An abort, or memory that is asked for by a damaged length, ends this very process; the file is then left in the temporary folder.
fn damage(files: &[(&str, Vec<u8>)]) {
    let (_, most) = getrlimit(Resource::RLIMIT_AS).unwrap();
    setrlimit(Resource::RLIMIT_AS, most.min(4_096_000_000), most).unwrap();
    let rounds: u64 = std::env::var("MAGCOMP_FUZZ").map_or(60, |rounds| rounds.parse().unwrap());
    let place = tempfile::tempdir().unwrap();
    for (name, whole) in files {
        let path = place.path().join(name);
        let options = if name.starts_with("table") {
            ImportOptions {
                columns: Some(TABLE[1].parse().unwrap()),
                units: Some("t=ns".parse().unwrap()),
                ..ImportOptions::default()
            }
        } else {
            ImportOptions::default()
        };
        let take = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            let mut out = Vec::new();
            let made = import(std::slice::from_ref(&path), &options, |write| {
                write(&mut out).map_err(|_| unreachable!("a Vec can be written"))
            });
            made.map(|_| ()).map_err(|why| why.to_string())
        };
        assert_eq!(take(whole), Ok(()), "{name}");
        let mut refused = 0;
        for seed in 0..rounds {
            if let Err(why) = take(&mutated(whole, &mut ChaCha8Rng::seed_from_u64(seed))) {
                refused += 1;
                assert!(!why.contains('\n'), "{name}, {seed}: {why}");
            }
        }
        assert!(refused > 0, "{name}: no damage was noticed");
    }
}

#[test]
fn damaged_bags_end_in_an_error_or_a_shorter_recording() {
    damage(&[("bag.mcap", bag(30, None, 0)), ("ros2.mcap", session("ros2.mcap"))]);
}

#[test]
fn damaged_arrow_files_end_in_an_error_or_other_numbers() {
    damage(&["table.arrow", "table.feather", "table_numbers.feather"].map(|name| (name, session(name))));
}

#[test]
fn damaged_parquet_files_end_in_an_error_or_other_numbers() {
    damage(&["table.parquet", "table_timestamps.parquet"].map(|name| (name, session(name))));
}

#[test]
fn damaged_packed_files_end_in_an_error_or_other_numbers() {
    let m = field(20);
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for (name, text) in [("MagnetometerUncalibrated.csv", m.as_str()), ("Metadata.csv", "platform\nios\n")] {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
    }
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    gzip.write_all(m.as_bytes()).unwrap();
    damage(&[("session.zip", zip.finish().unwrap().into_inner()), ("Magnetometer.csv.gz", gzip.finish().unwrap())]);
}

#[test]
fn damaged_texts_end_in_an_error_or_other_numbers() {
    let gnss =
        (0..5).map(|k| format!("UncalMag,16631646691{k}1,659720{k}5195160,221.5,89.5,-21.25,213.5,180.25,5.5\n"));
    damage(&[
        ("Magnetometer.csv", field(20).into_bytes()),
        (
            "MagneticField.csv",
            b"Timestamp,X,Y,Z\n22-Nov-2026 10:11:12.340,20,30,-40\n22-Nov-2026 10:11:12.350,20,30,-41\n".to_vec(),
        ),
        ("gnss.txt", gnss.collect::<String>().into_bytes()),
    ]);
}

#[test]
fn a_length_beyond_its_record_is_an_error_or_not_read() {
    let whole = bag(3, None, 0);
    let folder = folder(&[("b.mcap", &whole)]);
    let (expected, _) = imported(folder.path(), "b.mcap", &[]);
    // (opcode of the record, bytes before the length of a string in it, whether it is read at all)
    for (opcode, before, read) in [(1, 0, false), (3, 2, true), (4, 4, true), (6, 28, true), (8, 50, false)] {
        let mut bytes = whole.clone();
        let mut records = records(&whole);
        let at = records.find(|(found, _)| *found == opcode).unwrap().1 + before;
        bytes[at..at + 4].copy_from_slice(&(u32::MAX - 9).to_le_bytes());
        fs::write(folder.path().join("b.mcap"), bytes).unwrap();
        if read {
            let error = refused(folder.path(), "b.mcap", &[]);
            assert!(error.contains("b.mcap: cannot be read: "), "{error}");
        } else {
            assert_eq!(imported(folder.path(), "b.mcap", &[]).0, expected, "{opcode}");
        }
    }
}

/// Opcode of each record of a bag, in chunks too, and where its content begins.
fn records(bag: &[u8]) -> impl Iterator<Item = (u8, usize)> {
    let mut at = 8;
    std::iter::from_fn(move || {
        let opcode = *bag.get(at)?;
        let start = at + 9;
        let length = u64::from_le_bytes(bag.get(at + 1..start)?.try_into().unwrap()) as usize;
        // a chunk that is not packed: its records follow times, size, checksum, an empty name and a length
        at = if opcode == 6 { start + 40 } else { start + length };
        Some((opcode, start))
    })
}

/// Some bytes changed, or cut off, or repeated, or a length among them made huge.
fn mutated(whole: &[u8], rng: &mut ChaCha8Rng) -> Vec<u8> {
    let mut bytes = whole.to_vec();
    for _ in 0..rng.random_range(1..4) {
        let at = rng.random_range(0..bytes.len());
        match rng.random_range(0..6) {
            0 => bytes[at] ^= 1 << rng.random_range(0..8),
            1 => bytes[at] = rng.random(),
            2 => bytes.truncate(at.max(1)),
            3 => {
                let part = bytes[at..].iter().copied().take(rng.random_range(1..200)).collect::<Vec<_>>();
                bytes.splice(at..at, part);
            }
            4 => bytes.iter_mut().skip(at).take(8).for_each(|byte| *byte = 0xff),
            _ => {
                let length = (1_u64 << rng.random_range(8..63)).to_le_bytes();
                let wide = if rng.random() { 4 } else { 8 };
                bytes.iter_mut().skip(at).zip(length).take(wide).for_each(|(byte, part)| *byte = part);
            }
        }
    }
    bytes
}

#[test]
fn what_unpacks_without_end_is_refused_before_memory_is_full() {
    // ten megabytes in a hundred kilobytes, a hundred times
    let mut zip = zip::ZipWriter::new(Cursor::new(Vec::new()));
    zip.start_file("MagnetometerUncalibrated.csv", zip::write::SimpleFileOptions::default()).unwrap();
    let block = b"time,seconds_elapsed,z,y,x\n".repeat(40_000);
    for _ in 0..300 {
        zip.write_all(&block).unwrap();
    }
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    for _ in 0..300 {
        gzip.write_all(&block).unwrap();
    }
    let bomb = folder(&[("bomb.zip", &zip.finish().unwrap().into_inner()), ("bomb.csv.gz", &gzip.finish().unwrap())]);
    for name in ["bomb.zip", "bomb.csv.gz"] {
        let error = refused(bomb.path(), name, &[]);
        assert!(error.contains("it unpacks to more than 100 times its size"), "{error}");
    }
    // a recording without magnetometer, one that is a single line, and one with an open quotation mark
    let mut waiting = "t_s,mx,my,mz,ax,ay,az\n".to_owned();
    (0..1_100_000).for_each(|k| writeln!(waiting, "{k},,,,0,0,9").unwrap());
    let quoted = format!("t_s,mx,my,mz\n0,1,2,\"3\n{}", "0,1,2,3\n".repeat(300_000));
    let line = format!("t_s,mx,my,mz\n0,1,2,{}", "3".repeat(3_000_000));
    for (text, why) in
        [(waiting, "1048576 rows of other sensors"), (quoted, "a line has more than"), (line, "a line has more than")]
    {
        fs::write(bomb.path().join("r.csv"), text).unwrap();
        let (code, _, error) = run_in(bomb.path(), &["replay", "r.csv"]);
        assert!(code == Some(1) && error.lines().count() == 1 && error.contains(why), "{error}");
    }
}

#[test]
fn matlab_times_without_milliseconds_say_how_to_write_them() {
    let rows = |times: &dyn Fn(usize) -> String| {
        let rows = (0..300).map(|k| format!("{},20,{},-40\n", times(k), k % 7));
        format!("Timestamp,X,Y,Z\n{}", rows.collect::<String>())
    };
    let coarse = rows(&|k| format!("22-Nov-2026 10:11:{:02}", k / 100));
    let fine = rows(&|k| format!("22-Nov-2026 10:11:{:02}.{:02}0", k / 100, k % 100));
    let folder = folder(&[("MagneticField.csv", coarse.as_bytes())]);
    let error = refused(folder.path(), ".", &[]);
    assert!(
        error.contains("MagneticField.csv: line 2, column 1 (Timestamp): expected times with milliseconds"),
        "{error}"
    );
    assert!(error.contains("MagneticField.Timestamp.Format = \"dd-MMM-yyyy HH:mm:ss.SSS\""), "{error}");
    fs::write(folder.path().join("MagneticField.csv"), fine).unwrap();
    fs::write(folder.path().join("Acceleration.csv"), coarse).unwrap();
    let (text, warnings) = imported(folder.path(), ".", &[]);
    assert!(text.lines().count() == 301 && warnings.contains("Acceleration.Timestamp.Format"), "{warnings}");
}

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

#[test]
fn times_that_wrap_are_refused() {
    let rows = |first: &str, last: &str| {
        let rows = (0..40).map(|k| format!("{},20,{},-40\n", k * 10_000_000, k % 7)).collect::<String>();
        format!("t,mx,my,mz\n{first},20,30,-40\n{rows}{last},20,30,-40\n")
    };
    let options = ["--columns", "t=t", "--units", "t=ns"];
    for (first, last) in
        [("-9000000000000000000", "1"), ("0", "9000000000000000000"), ("-5000000000000000000", "5000000000000000000")]
    {
        let folder = folder(&[("r.csv", rows(first, last).as_bytes())]);
        let error = refused(folder.path(), "r.csv", &options);
        assert!(error.contains("expected a time within 146 years of zero"), "{error}");
    }
    let folder = folder(&[
        ("r.csv", b"t_s,mx,my,mz\n-8e9,20,30,-40\n0,20,30,-40\n8e9,20,30,-41\n"),
        ("b.mcap", &bag(5, None, u64::MAX - 10)),
        ("MagneticField.csv", b"Timestamp,X,Y,Z\n22-Nov-2190 10:11:12.340,20,30,-40\n"),
    ]);
    let (code, _, error) = run_in(folder.path(), &["replay", "r.csv"]);
    assert!(code == Some(1) && error.contains("r.csv: line 2, column 1 (t_s): expected a time in seconds"), "{error}");
    let error = refused(folder.path(), "b.mcap", &[]);
    assert!(
        error.contains("b.mcap: line 1, column 1 (/mag log_time): expected a time within 146 years of 1970"),
        "{error}"
    );
    assert!(refused(folder.path(), "MagneticField.csv", &[]).contains("expected a time such as"));
}

#[test]
fn a_place_takes_the_sessions_own_date() {
    // `date -u -d @1767225600` and so on; the model of the field begins with 2020
    for (unix_s, day) in [(1_767_225_600_u64, "2026-01-01"), (1_325_376_000, "2012-01-01")] {
        let rows = |from: u64| {
            let rows = (0..50).map(|k| format!("{from}.{k:02},20,{},-40\n", k % 7));
            format!("t_s,mx,my,mz\n{}", rows.collect::<String>())
        };
        let logger =
            format!("time,seconds_elapsed,z,y,x\n{unix_s}000000000,0,-40,30,20\n{unix_s}010000000,0.01,-40,30,20\n");
        let phyphox = "\"Time (s)\",\"Field x (µT)\",\"Field y (µT)\",\"Field z (µT)\"\n0,20,30,-40\n0.01,20,30,-41\n";
        let clock = format!(
            "\"event\",\"experiment time\",\"system time\",\"system time text\"\n\"START\",0,{unix_s}.25,\"\"\n"
        );
        let gnss = format!("UncalMag,{unix_s}000,65972055195160,221.5,89.5,-21.25,213.5,180.25,5.5\n");
        let place = folder(&[
            ("own.csv", rows(unix_s).as_bytes()),
            ("none.csv", rows(100).as_bytes()),
            ("gnss.txt", gnss.as_bytes()),
            ("Magnetometer.csv", logger.as_bytes()),
        ]);
        let inside = place.path().join("phyphox");
        fs::create_dir(&inside).unwrap();
        fs::write(inside.join("Magnetometer.csv"), phyphox).unwrap();
        fs::write(inside.join("time.csv"), clock).unwrap();
        let replay = |input: &str, date: &[&str]| {
            let (code, _, error) = run_in(place.path(), &[&["replay", input, "--place=-33.9,18.4"], date].concat());
            (code, error)
        };
        for input in ["own.csv", "gnss.txt", "phyphox", "Magnetometer.csv"] {
            let (code, error) = replay(input, &[]);
            if day > "2020" {
                assert_eq!((code, error.as_str()), (Some(0), ""), "{input}");
            } else {
                assert!(code == Some(1) && error.contains(&format!("({day}; --date names another day)")), "{error}");
            }
            assert_eq!(replay(input, &["--date", "2025-06-01"]).0, Some(0), "{input}");
        }
        let (code, error) = replay("none.csv", &[]);
        let why = "none.csv: its times do not say the date that --place needs; add --date YYYY-MM-DD";
        assert_eq!((code, error), (Some(2), format!("magcomp: {why}\n")));
        assert_eq!(replay("none.csv", &["--date", "2025-06-01"]).0, Some(0));
    }
}
