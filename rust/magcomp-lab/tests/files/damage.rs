//! Damaged files end in an error of one line, and ask for no memory that they do not need.

use crate::{TABLE, field, folder, refused, run_in, session};
use magcomp_recordings::import::{ImportOptions, import};
use nix::sys::resource::{Resource, getrlimit, setrlimit};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::fmt::Write as _;
use std::fs;
use std::io::{Cursor, Write as _};

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
pub(crate) fn damage(files: &[(&str, Vec<u8>)]) {
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
            let made = import(std::slice::from_ref(&path), &options);
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
    for (text, why) in [
        (waiting, "1048576 rows of other sensors"),
        (quoted, "line 2, column 4 (mz): expected a number"),
        (line, "has more than"),
    ] {
        fs::write(bomb.path().join("r.csv"), text).unwrap();
        let (code, _, error) = run_in(bomb.path(), &["replay", "r.csv"]);
        assert!(code == Some(1) && error.lines().count() == 1 && error.contains(why), "{error}");
    }
}
