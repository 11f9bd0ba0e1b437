//! Damaged files end in an error of one line or in other numbers, whatever their form: never in a panic, an abort, or memory that they do not
//! need. `MAGCOMP_FUZZ=20000 cargo test --release -p magcomp-recordings --features formats --test damage -- --nocapture` damages each file
//! so often, and prints how often it was refused and what the slowest took.

#![cfg(all(unix, feature = "formats"))]

mod bag;

use bag::bag;
use magcomp_recordings::import::{ImportOptions, load};
use nix::sys::resource::{Resource, getrlimit, setrlimit};
use rand::rngs::ChaCha8Rng;
use rand::{RngExt, SeedableRng};
use std::fmt::Write as _;
use std::fs;
use std::io::{Cursor, Write as _};
use std::path::Path;
use std::time::{Duration, Instant};

/// Memory that a file may ask for here, bytes.
const MEMORY: u64 = 1_000_000_000;

fn session(name: &str) -> Vec<u8> {
    fs::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/sessions").join(name)).unwrap()
}

/// Rows of a Sensor Logger file.
fn field(rows: usize) -> String {
    let mut text = "time,seconds_elapsed,z,y,x\n".to_owned();
    for k in 0..rows {
        let time_ns = 1_700_000_000_000_000_000 + k as u64 * 10_000_000;
        writeln!(text, "{time_ns},{},-40,30,{}", k as f64 / 100.0, 20 + k % 7).unwrap();
    }
    text
}

/// Reads each file many times, damaged in another way each time: `MAGCOMP_FUZZ` times, or few enough to take seconds.
///
/// An abort, or memory that is asked for by a damaged length, ends this very process; the file is then left in the temporary folder.
fn damage(files: &[(&str, Vec<u8>)]) {
    let (_, most) = getrlimit(Resource::RLIMIT_AS).unwrap();
    setrlimit(Resource::RLIMIT_AS, most.min(MEMORY), most).unwrap();
    let rounds: u64 = std::env::var("MAGCOMP_FUZZ").map_or(60, |rounds| rounds.parse().unwrap());
    let place = tempfile::tempdir().unwrap();
    for (name, whole) in files {
        let path = place.path().join(name);
        let options = if name.starts_with("table") {
            ImportOptions {
                columns: Some("t=time,mx=bx,my=by,mz=bz,gx=rate_x,gy=rate_y,gz=rate_z".parse().unwrap()),
                units: Some("t=ns".parse().unwrap()),
                ..ImportOptions::default()
            }
        } else {
            ImportOptions::default()
        };
        let take = |bytes: &[u8]| {
            fs::write(&path, bytes).unwrap();
            load(std::slice::from_ref(&path), &options).map(|_| ()).map_err(|why| why.to_string())
        };
        assert_eq!(take(whole), Ok(()), "{name}");
        let (mut refused, mut slowest) = (0, Duration::ZERO);
        for seed in 0..rounds {
            let bytes = mutated(whole, &mut ChaCha8Rng::seed_from_u64(seed));
            let begun = Instant::now();
            if let Err(why) = take(&bytes) {
                refused += 1;
                assert!(!why.contains('\n'), "{name}, {seed}: {why}");
            }
            slowest = slowest.max(begun.elapsed());
        }
        println!("{name}: {refused} of {rounds} refused, the slowest took {} ms", slowest.as_millis());
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
    let typed = (0..20).map(|k| {
        let time_ms = 1_574_572_522_000_i64 + 10 * k;
        format!("{time_ms}\tTYPE_MAGNETIC_FIELD_UNCALIBRATED\t{}\t30\t-40\t1\t2\t3\n{time_ms}\tTYPE_ACCELEROMETER\t0\t0\t9.8\n", 20 + k % 7)
    });
    let rows = |names: &str| {
        (0..20).fold(format!("{names}\n"), |text, k| {
            text + &format!("{},20,{},-40,0.1,0.2,1\n", f64::from(k) / 50.0, 30 + k % 7)
        })
    };
    let phyphox = rows("Time (s),Field x (µT),Field y (µT),Field z (µT),a,b,c");
    let words = rows("time (s),mag x (uT),mag y (uT),mag z (uT),acc x [g],acc y [g],acc z [g]") + "<2>\n1 2\n";
    damage(&[
        ("Magnetometer.csv", field(20).into_bytes()),
        (
            "MagneticField.csv",
            b"Timestamp,X,Y,Z\n22-Nov-2026 10:11:12.340,20,30,-40\n22-Nov-2026 10:11:12.350,20,30,-41\n".to_vec(),
        ),
        ("gnss.txt", gnss.collect::<String>().into_bytes()),
        ("typed.txt", typed.collect::<String>().into_bytes()),
        ("phyphox.csv", phyphox.into_bytes()),
        ("words.csv", words.into_bytes()),
    ]);
}

#[test]
fn damaged_bags_end_in_an_error_or_a_shorter_recording() {
    damage(&[("bag.mcap", bag(30, None, 0)), ("ros2.mcap", session("ros2.mcap"))]);
}

#[test]
fn damaged_recordings_end_in_an_error_or_other_numbers() {
    let mut text = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz,qw,qx,qy,qz\n".to_owned();
    for k in 0..40 {
        let (t, x) = (f64::from(k) / 50.0, 20.0 + f64::from(k));
        writeln!(text, "{t},{x},30,-40,0.1,0.2,9.8,0.1,{t},0,1,0,0,0").unwrap();
    }
    let mut gzip = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::default());
    gzip.write_all(text.as_bytes()).unwrap();
    damage(&[("recording.csv", text.into_bytes()), ("recording.csv.gz", gzip.finish().unwrap())]);
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
