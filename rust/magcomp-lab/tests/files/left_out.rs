//! Files that a session can do without are left out, each with a warning.

use crate::{field, folder, imported, logged, refused, run_in};
use std::fs;
use std::io::{Cursor, Write as _};

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
