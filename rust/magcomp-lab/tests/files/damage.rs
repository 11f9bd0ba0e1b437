//! Damaged files end in an error of one line, and ask for no memory that they do not need.

use crate::{TABLE, folder, refused, run_in, session};
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
