//! The loggers, each in the ways it writes.

use crate::{HEADER, RAW, folder, imported, refused, run};
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;

const CALIBRATED: &str = "time,seconds_elapsed,z,y,x\n1700000000010000100,0.01,-41,2,21\n";

/// Flat on a table, in g with Apple's sign.
const APPLE: &str = "time,seconds_elapsed,z,y,x\n1700000000004000000,0.004,-1,0,0.5\n";

#[test]
fn sensor_logger_from_a_folder_and_from_a_zip() {
    let gyro = format!("{HEADER}1700000000002000000,0.002,0.3,0.2,0.1\n1700000000006000000,0.006,0.6,0.5,0.4\n");
    let files = [
        ("MagnetometerUncalibrated.csv", RAW),
        ("Magnetometer.csv", CALIBRATED),
        ("AccelerometerUncalibrated.csv", APPLE),
        ("GyroscopeUncalibrated.csv", &gyro),
        ("Metadata.csv", "version,device name,platform\n3,iPhone 13,ios\n"),
        ("Location.csv", "time,seconds_elapsed,latitude\n1,0,52\n"),
    ];
    let folder = folder(&files);
    let expected = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz,sys_mx,sys_my,sys_mz\n\
                    0.000000000,200,30,-400,,,,,,,,,\n\
                    0.002000000,,,,,,,0.1,0.2,0.3,,,\n\
                    0.004000000,,,,-4.903325,0,9.80665,,,,,,\n\
                    0.006000000,,,,,,,0.4,0.5,0.6,,,\n\
                    0.010000100,201,31,-401,,,,,,,21,2,-41\n";
    assert_eq!(imported(&[folder.path()], &[]), expected);

    let path = folder.path().join("session.zip");
    let mut zip = zip::ZipWriter::new(fs::File::create(&path).unwrap());
    for (name, text) in files {
        zip.start_file(format!("session/{name}"), zip::write::SimpleFileOptions::default()).unwrap();
        zip.write_all(text.as_bytes()).unwrap();
    }
    zip.finish().unwrap();
    assert_eq!(imported(&[&path], &[]), expected);
    // an error within a zip names the file in it
    let mut zip = zip::ZipWriter::new(fs::File::create(&path).unwrap());
    zip.start_file("MagnetometerUncalibrated.csv", zip::write::SimpleFileOptions::default()).unwrap();
    zip.write_all(format!("{HEADER}1700000000000000000,0.0,-400,thirty,200\n").as_bytes()).unwrap();
    zip.finish().unwrap();
    let error = refused(&[&path], &[]);
    let place = format!("{}/MagnetometerUncalibrated.csv: line 2, column 4 (y)", path.display());
    assert_eq!(error, format!("magcomp: {place}: expected a number, found 'thirty'\n"));
}

/// Only while it moves, and with the accuracy that the phone tells.
#[test]
fn courses_of_fixes_become_columns() {
    let location = "time,seconds_elapsed,bearingAccuracy,speed,bearing,latitude\n1700000000005000000,0.005,4.5,12,271.5,52\n\
                    1700000000006000000,0.006,4.5,0.2,90,52\n1700000000007000000,0.007,-1,12,-1,52\n";
    let folder = folder(&[("MagnetometerUncalibrated.csv", RAW), ("Location.csv", location)]);
    let expected = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz,course_deg,course_sigma_deg\n0.000000000,200,30,-400,,,,,,,,\n\
                    0.005000000,,,,,,,,,,271.5,4.5\n0.010000100,201,31,-401,,,,,,,,\n";
    assert_eq!(imported(&[folder.path()], &[]), expected);
    let elsewhere = tempfile::tempdir().unwrap();
    let out = elsewhere.path().join("out.csv");
    let (code, told, _) = crate::run(&["import", folder.path().to_str().unwrap(), "--output", out.to_str().unwrap()]);
    assert!(code == 0 && told.contains("2 of 3 fixes have no course"), "{code}: {told}");
    let (code, told, _) = crate::run(&["replay", folder.path().to_str().unwrap()]);
    assert!(code == 0 && told.contains("2 of 3 fixes have no course"), "{code}: {told}");
    // a file without directions, and a fix whose time is on another clock
    let folder = self::folder(&[
        ("MagnetometerUncalibrated.csv", RAW),
        ("Location.csv", "time,seconds_elapsed,latitude\n5,0.005,52\n6,0.006,52\n"),
    ]);
    let (_, told, _) = crate::run(&["import", folder.path().to_str().unwrap(), "--output", out.to_str().unwrap()]);
    assert!(told.contains("2 of 2 fixes have no course"), "{told}");

    let log = "# Fix,Provider,LatitudeDegrees,...\nUncalMag,1700000000000,1000000,200,30,-400,0,0,0\n\
               Fix,GPS,52.5,13.4,40,12.0,3.0,271.5,1700000000001,0.3,4.5,1500000,2.0,0\n\
               Fix,NLP,52.5,13.4,40,,20.0,,1700000000001,,,1600000,,0\nUncalMag,1700000000001,2000000,201,31,-401,0,0,0\n";
    let folder = self::folder(&[("gnss_log.txt", log)]);
    let text = imported(&[folder.path()], &[]);
    assert!(text.lines().any(|line| line.starts_with("0.001500000,,,") && line.ends_with(",271.5,4.5")), "{text}");
    assert_eq!(text.lines().count(), 4, "{text}");
    let late = self::folder(&[("gnss_log.txt", &log.replace(",1500000,2.0,0", ",,2.0,0"))]);
    let (_, told, _) = crate::run(&["import", late.path().to_str().unwrap(), "--output", out.to_str().unwrap()]);
    assert!(told.contains("2 of 2 fixes have no course"), "{told}");
}

#[test]
fn the_sign_of_gravity_is_the_platforms() {
    let gravity = format!("{HEADER}1700000000004000000,0.004,9.8,0,0.5\n");
    let session = |more: &[(&'static str, &'static str)]| {
        let files =
            [[("MagnetometerUncalibrated.csv", RAW), ("Gravity.csv", gravity.as_str())].as_slice(), more].concat();
        folder(&files)
    };
    let up = |folder: &tempfile::TempDir, options: &[&str]| {
        let text = imported(&[folder.path()], options);
        text.lines().nth(2).unwrap().split(',').nth(6).unwrap().parse::<f64>().unwrap()
    };
    assert_eq!(up(&session(&[("Metadata.csv", "platform\nandroid\n")]), &[]), 9.8);
    assert_eq!(up(&session(&[("Metadata.csv", "platform\nios\n")]), &[]), -9.8);
    assert_eq!(up(&session(&[("Metadata.csv", "platform,standardisation\nios,true\n")]), &[]), 9.8);
    let unknown = session(&[]);
    let error = refused(&[unknown.path()], &[]);
    assert!(
        error.contains("Gravity.csv: the sign of gravity depends on the platform") && error.contains("--units a=m/s2"),
        "{error}"
    );
    assert_eq!(up(&unknown, &["--units", "a=-m/s2"]), -9.8);
    // without gravity in it: left out, and said
    let linear = folder(&[("MagnetometerUncalibrated.csv", RAW), ("Accelerometer.csv", &gravity)]);
    let (code, text, _) = run(&["replay", linear.path().to_str().unwrap()]);
    assert!(code == 0 && text.contains("Accelerometer has no gravity in it"), "{text}");
    // m/s^2 on Android, where it is not calibrated either
    let android = folder(&[("MagnetometerUncalibrated.csv", RAW), ("AccelerometerUncalibrated.csv", &gravity)]);
    assert_eq!(up(&android, &[]), 9.8);
}

#[test]
fn phyphox_in_every_way_it_writes() {
    let rows = [[0.0, 200.5, 30.0, -400.0], [0.0101, 201.0, 31.25, -401.0]];
    let table = |names: [&str; 4], delimiter: char, comma: bool| {
        let mut text = names.map(|name| format!("\"{name}\"")).join(&delimiter.to_string()) + "\n";
        for row in rows {
            let cells = row.map(|value| format!("{value:E}"));
            let cells = cells.map(|cell| if comma { cell.replace('.', ",") } else { cell });
            writeln!(text, "{}", cells.join(&delimiter.to_string())).unwrap();
        }
        text
    };
    let english = ["Time (s)", "Magnetic field x (µT)", "Magnetic field y (µT)", "Magnetic field z (µT)"];
    let german = ["Zeit (s)", "Magnetfeld x (μT)", "Magnetfeld y (μT)", "Magnetfeld z (μT)"];
    let expected = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n\
                    0.000000000,200.5,30,-400,,,,,,\n\
                    0.010100000,201,31.25,-401,,,,,,\n";
    for (names, delimiter, comma) in [
        (english, ',', false),
        (english, ';', false),
        (english, ';', true),
        (german, '\t', false),
        (german, '\t', true),
    ] {
        let folder = folder(&[("Magnetometer.csv", &table(names, delimiter, comma))]);
        assert_eq!(imported(&[folder.path()], &[]), expected, "{delimiter:?}, comma {comma}");
    }
    // all sensors; linear acceleration is not gravity's
    let all = folder(&[
        ("Magnetometer.csv", &table(english, ',', false)),
        (
            "Gyroscope.csv",
            "\"Time (s)\",\"Gyroscope x (rad/s)\",\"Gyroscope y (rad/s)\",\"Gyroscope z (rad/s)\"\n0.005,0.1,0.2,0.3\n",
        ),
        (
            "Accelerometer.csv",
            "\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\",\"Acceleration z (m/s^2)\"\n0.002,1,2,9\n",
        ),
        (
            "Linear Accelerometer.csv",
            "\"Time (s)\",\"Linear Acceleration x (m/s^2)\",\"Linear Acceleration y (m/s^2)\",\"Linear Acceleration z (m/s^2)\"\n0.002,7,7,7\n",
        ),
    ]);
    let lines = imported(&[all.path()], &[]);
    let lines: Vec<&str> = lines.lines().collect();
    assert_eq!(lines[2..4], ["0.002000000,,,,1,2,9,,,", "0.005000000,,,,,,,0.1,0.2,0.3"]);
}

#[test]
fn gnss_logger_rows_among_others() {
    // the sensors' rows are those of LOGGING_FORMAT.md
    let text = "# Header Description:\n# \n# UncalMag,utcTimeMillis,elapsedRealtimeNanos,UncalMagXMicroT\n\
                Fix,GPS,28.1435263000,-82.2971356000,-14.2,0.09,5.857,108.3,1663712656000,,,445420306913617,11.185,0\n\
                UncalMag,1663164669191,65972055195160,221.5,89.5,-21.25,213.5,180.25,5.5\n\
                UncalGyro,1663164669189,65972053803181,0.0006108648,-0.020769402,0.023518294,-0.0094,0.0000077,-0.008\n\
                UncalAccel,1663164669190,65972054923181,0.4642076,7.7742805,5.8707905,0.0,0.0,0.0\n\
                OrientationDeg,1663164669209,65972073175160,201.0,-5.0,-52.0\n\
                UncalMag,1663164669211,65972075195160,222.5,89.5,-21.25,213.5,180.25,5.5\n";
    let folder = folder(&[("gnss_log.txt", text)]);
    let expected = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz,sys_mx,sys_my,sys_mz\n\
                    65972.053803181,,,,,,,0.0006108648,-0.020769402,0.023518294,,,\n\
                    65972.054923181,,,,0.4642076,7.7742805,5.8707905,,,,,,\n\
                    65972.055195160,221.5,89.5,-21.25,,,,,,,8,-90.75,-26.75\n\
                    65972.075195160,222.5,89.5,-21.25,,,,,,,9,-90.75,-26.75\n";
    assert_eq!(imported(&[folder.path()], &[]), expected);
    assert_eq!(imported(&[&folder.path().join("gnss_log.txt")], &[]), expected);
}

#[test]
fn matlab_mobile_timetables() {
    let rows = |values: &str| {
        format!("Timestamp,X,Y,Z\n22-Nov-2026 10:11:12.340,{values}\n22-Nov-2026 10:11:12.350,{values}\n")
    };
    let folder = folder(&[("MagneticField.csv", &rows("20,30,-40")), ("Acceleration.csv", &rows("0.1,0.2,9.8"))]);
    let expected = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n\
                    0.000000000,20,30,-40,0.1,0.2,9.8,,,\n\
                    0.010000000,20,30,-40,0.1,0.2,9.8,,,\n";
    assert_eq!(imported(&[folder.path()], &[]), expected);
    fs::write(folder.path().join("MagneticField.csv"), "Timestamp,X,Y,Z\nyesterday,1,2,3\n").unwrap();
    let error = refused(&[folder.path()], &[]);
    assert!(
        error.contains("MagneticField.csv: line 2, column 1 (Timestamp): expected a time such as 22-Nov-2026"),
        "{error}"
    );
}
