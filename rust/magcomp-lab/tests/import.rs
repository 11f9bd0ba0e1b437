//! Phone loggers' sessions, from files written by hand after the loggers' documentation: units, axes, order, errors, and that a
//! session of three sensors at three rates is the events pushed by hand.

use assert_cmd::Command;
use magcomp::{Calibration, Compensator, Config};
use magcomp_lab::inertial::InertialSensor;
use magcomp_lab::motion::Motion;
use magcomp_lab::parameters::ParameterSet;
use magcomp_lab::recording;
use magcomp_lab::replay::{Ignore, replay};
use magcomp_lab::schedule::Schedule;
use magcomp_lab::simulate::{Noise, Scenario, Simulation, world_field_ut};
use std::fmt::Write as _;
use std::fs;
use std::io::Write as _;
use std::path::Path;

/// Runs it; exit code, standard output, standard error.
fn run(arguments: &[&str]) -> (i32, String, String) {
    let output = Command::cargo_bin("magcomp").unwrap().args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    (output.status.code().unwrap(), text(&output.stdout), text(&output.stderr))
}

/// Writes files into a new folder.
fn folder(files: &[(&str, &str)]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    files.iter().for_each(|(name, text)| fs::write(folder.path().join(name), text).unwrap());
    folder
}

/// Runs the import; its exit code, standard output, standard error, and the recording if one was written.
fn import(inputs: &[&Path], options: &[&str]) -> (i32, String, String, Option<String>) {
    let folder = tempfile::tempdir().unwrap();
    let output = folder.path().join("out.csv");
    let inputs = inputs.iter().map(|input| input.to_str().unwrap());
    let arguments: Vec<&str> = ["import"]
        .into_iter()
        .chain(inputs)
        .chain(["-o", output.to_str().unwrap()])
        .chain(options.iter().copied())
        .collect();
    let (code, out, error) = run(&arguments);
    (code, out, error, fs::read_to_string(output).ok())
}

/// The recording that a session is made into.
fn imported(inputs: &[&Path], options: &[&str]) -> String {
    let (code, _, error, recording) = import(inputs, options);
    assert_eq!((code, error.as_str()), (0, ""), "{inputs:?} {options:?}");
    recording.unwrap()
}

fn refused(inputs: &[&Path], options: &[&str]) -> String {
    let (code, out, error, recording) = import(inputs, options);
    assert!(code != 0 && out.is_empty() && recording.is_none(), "{inputs:?} {options:?} was taken: {out}");
    assert_eq!(error.lines().count(), 1, "{error}");
    error
}

const HEADER: &str = "time,seconds_elapsed,z,y,x\n";
const RAW: &str =
    "time,seconds_elapsed,z,y,x\n1700000000000000000,0.0,-400,30,200\n1700000000010000100,0.0100001,-401,31,201\n";
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

#[test]
fn plain_csv_by_names_units_and_axes() {
    let folder = folder(&[
        ("m.csv", "ms,right,up,out\n0,1,2,-4\n10,1.5,2.5,-4\n"),
        ("g.csv", "ms;p;q;r\n5;180;90;0\n"),
        ("own.csv", "t_s,mx,my,mz,gx,gy,gz\n0,20,30,40,,,\n0.005,,,,1,2,3\n0.01,21,30,40,,,\n"),
    ]);
    let path = |name: &str| folder.path().join(name);
    let columns = ["--columns", "t=ms,mx=right,my=up,mz=out,gx=p,gy=q,gz=r"];
    let units = ["--units", "t=ms,m=G,g=deg/s", "--frame", "y,-x,z"];
    let found =
        imported(&[&path("m.csv"), &path("g.csv")], &[columns, [units[0], units[1]], [units[2], units[3]]].concat());
    let half = std::f64::consts::FRAC_PI_2;
    let expected = format!(
        "t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n0.000000000,200,-100,-400,,,,,,\n0.005000000,,,,,,,{half},{},0\n0.010000000,250,-150,-400,,,,,,\n",
        -2.0 * half
    );
    assert_eq!(found, expected);
    // a recording's own names need no option
    assert_eq!(imported(&[&path("own.csv")], &[]).lines().nth(2).unwrap(), "0.005000000,,,,,,,1,2,3");
    let error = refused(&[&path("m.csv")], &[]);
    assert!(
        error.contains("line 1: expected a header of Sensor Logger") && error.contains("--columns t=NAME"),
        "{error}"
    );
    assert!(error.ends_with("found 'ms,right,up,out'\n"), "{error}");
    let error = refused(&[&path("g.csv")], &columns);
    assert!(error.contains("no magnetometer event"), "{error}");
    let error = refused(&[&path("m.csv")], &["--columns", "t=ms,mx=left,my=up,mz=out"]);
    assert!(error.contains("expected a header with the column 'left'"), "{error}");
}

#[test]
fn a_wrong_unit_is_told_with_the_option_that_mends_it() {
    let cases = [
        ("0,20,30,40", "10000000,21,30,40", "column 1 (t)", "time looks like nanoseconds: --units t=ns"),
        ("0,20,30,40", "10000,21,30,40", "column 1 (t)", "time looks like microseconds: --units t=us"),
        ("0,20,30,40", "10,21,30,40", "column 1 (t)", "time looks like milliseconds: --units t=ms"),
        ("0,0.2,0.3,0.4", "0.01,0.2,0.3,0.4", "column 2 (mx)", "mostly 0.539; it looks like G: --units m=G"),
        ("0,20000,30000,40000", "0.01,20000,30000,40000", "column 2 (mx)", "it looks like nT: --units m=nT"),
        ("0,2e-5,3e-5,4e-5", "0.01,2e-5,3e-5,4e-5", "column 2 (mx)", "it looks like T: --units m=T"),
    ];
    for (first, second, place, hint) in cases {
        let folder = folder(&[("r.csv", &format!("t,mx,my,mz\n{first}\n{second}\n"))]);
        let path = folder.path().join("r.csv");
        let error = refused(&[&path], &["--columns", "t=t"]);
        assert!(error.contains(&format!("r.csv: line 2, {place}: expected ")) && error.contains(hint), "{error}");
        // what the message says to do works
        let option = hint.rsplit_once("--units ").unwrap().1;
        assert_eq!(imported(&[&path], &["--columns", "t=t", "--units", option]).lines().count(), 3);
    }
    let inertial = |cells: &str| {
        folder(&[("r.csv", &format!("t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n0,20,30,40,{cells}\n0.01,21,30,40,{cells}\n"))])
    };
    let (g, degrees) = (inertial("0,0.1,1,0,0,1"), inertial("0,0.1,9.8,0,0,100"));
    assert!(refused(&[&g.path().join("r.csv")], &["--frame", "x,y,z"]).contains("it looks like g: --units a=g"));
    assert!(
        refused(&[&degrees.path().join("r.csv")], &["--frame", "x,y,z"])
            .contains("it looks like deg/s: --units g=deg/s")
    );
}

#[test]
fn a_recordings_own_units_and_marks_are_looked_at_too() {
    let rows = |row: &dyn Fn(u32) -> String| (0..50).map(row).collect::<String>();
    let cases = [
        (rows(&|k| format!("{},20,{},-40\n", 10 * k, k % 5)), "column 1 (t_s)", "--units t=ms"),
        (rows(&|k| format!("{},20000,{},-40000\n", f64::from(k) / 100.0, k % 5)), "column 2 (mx)", "--units m=nT"),
    ];
    for (text, place, hint) in cases {
        let folder = folder(&[("r.csv", &format!("t_s,mx,my,mz\n{text}"))]);
        let path = folder.path().join("r.csv");
        let (code, out, error) = run(&["replay", path.to_str().unwrap()]);
        assert!(code == 1 && out.is_empty() && error.contains(place) && error.trim_end().ends_with(hint), "{error}");
        let option = hint.split_once(' ').unwrap().1;
        assert_eq!(run(&["replay", path.to_str().unwrap(), "--units", option]).0, 0);
    }
    let nanoseconds = folder(&[("r.csv", "t_s,mx,my,mz\n1700000000000000000,20,3,-40\n")]);
    let (code, _, error) = run(&["replay", nanoseconds.path().join("r.csv").to_str().unwrap()]);
    let place =
        "r.csv: line 2, column 1 (t_s): expected a time in seconds; name another unit by --units t=ms, us or ns";
    assert!(code == 1 && error.contains(place), "{error}");
    // semicolons and decimal commas under a recording's own names
    let german = rows(&|k| format!("{};20;{};-40,5\n", f64::from(k) / 100.0, k % 5)).replace('.', ",");
    let folder = self::folder(&[("g.csv", &format!("t_s;mx;my;mz\n{german}"))]);
    let (code, out, error) = run(&["replay", folder.path().join("g.csv").to_str().unwrap()]);
    assert!(code == 0 && out.contains("plain CSV session"), "{error}");
    // decimal commas between commas make rows longer than the header
    let (folder, columns) = (self::folder(&[("c.csv", "t,mx,my,mz\n0,01,20,5,3,-40\n")]), ["--columns", "t=t"]);
    let error = refused(&[&folder.path().join("c.csv")], &columns);
    let place = "c.csv: line 2, column 5: expected 4 cells as in the header; a decimal comma needs semicolons or tabs";
    assert!(error.contains(place) && error.ends_with("found 6 cells\n"), "{error}");
    // which of two columns of a name?
    let folder = self::folder(&[("d.csv", "t,mx,mx,my,mz\n0,20,20,3,-40\n")]);
    let error = refused(&[&folder.path().join("d.csv")], &columns);
    assert!(error.contains("d.csv: line 1: expected column 'mx' once"), "{error}");
}

#[test]
fn what_is_no_text_and_two_sessions_at_once_are_refused() {
    let folder = folder(&[("Magnetometer.csv", RAW)]);
    let again = self::folder(&[("Magnetometer.csv", RAW)]);
    let error = refused(&[folder.path(), again.path()], &[]);
    assert!(error.contains("are of the same sensor; import one session at a time"), "{error}");
    for (bytes, hint) in [
        (&b"MATLAB 5.0 MAT-file\0\0"[..], "writetimetable"),
        (b"\x89MCAP0\r\n\0\0", "cannot be read: MCAP file ended"),
        (b"\xff\xfet\0,\0", "save it as UTF-8"),
        (b"\x7fELF\0\0\0\0", "this is no text file"),
    ] {
        let path = folder.path().join("session.bin");
        fs::write(&path, bytes).unwrap();
        let error = refused(&[&path], &[]);
        assert!(error.contains("session.bin: ") && error.contains(hint), "{error}");
    }
    let empty = tempfile::tempdir().unwrap();
    assert!(refused(&[empty.path()], &[]).contains("no file there ends in .csv, .txt, .csv.gz"));
    let cut = folder.path().join("cut.zip");
    fs::write(&cut, b"PK\x03\x04 and no more").unwrap();
    assert!(refused(&[&cut], &[]).contains("cut.zip: cannot be read"));
}

#[test]
fn events_out_of_order_and_twice_are_said() {
    let text = format!("{HEADER}3,0,-40,3,2\n1,0,-40,1,2\n2,0,-40,2,2\n2,0,-40,9,2\n").replace("\n3,", "\n30000000,");
    let text = text.replace("\n1,", "\n10000000,").replace("\n2,", "\n20000000,");
    let folder = folder(&[("Magnetometer.csv", &text)]);
    let elsewhere = tempfile::tempdir().unwrap();
    let output = elsewhere.path().join("out.csv");
    let (code, table, _) = run(&["import", folder.path().to_str().unwrap(), "-o", output.to_str().unwrap()]);
    assert_eq!(code, 0);
    assert!(table.contains("magnetometer: 1 events were older than the one before"), "{table}");
    assert!(table.contains("magnetometer: 1 events repeated the time of another"), "{table}");
    assert!(table.contains("the magnetometer is the one that the system calibrates"), "{table}");
    let times = fs::read_to_string(output).unwrap();
    let times: Vec<&str> = times.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(times, ["0.010000000", "0.020000000", "0.030000000"]);
}

/// Three sensors at three rates that do not divide one another.
fn three_rates() -> Simulation {
    let scenario = Scenario {
        seed: 7,
        samples: 50 * 30,
        rate_hz: 50.0,
        motion: Motion::Tumble,
        world_ut: Schedule::constant(world_field_ut(50.0, 60.0)),
        parameters: Schedule::step(ParameterSet::Mid.parameters(), 15.0, ParameterSet::Mid.parameters().times(1.3)),
        noise: Noise::Ut(0.5),
        spikes: None,
        gyroscope: Some(InertialSensor { rate_hz: 173.0, ..InertialSensor::gyroscope() }),
        accelerometer: Some(InertialSensor { rate_hz: 71.0, ..InertialSensor::accelerometer() }),
    };
    scenario.run()
}

#[test]
fn three_sensors_at_three_rates_are_the_events_pushed_by_hand() {
    let session = three_rates();
    let csv = |rows: Vec<(i64, [f64; 3])>| {
        let mut text = HEADER.to_owned();
        for (time_ns, [x, y, z]) in rows {
            writeln!(text, "{time_ns},{},{z},{y},{x}", time_ns as f64 / 1e9).unwrap();
        }
        text
    };
    let raw = session.magnetic.iter().map(|event| (event.time_ns, event.field_ut.into())).collect();
    let rate = session.rotation_rates.iter().map(|event| (event.time_ns, event.rate_rad_s.into())).collect();
    let up = session.ups.iter().map(|event| (event.time_ns, event.up_m_s2.into())).collect();
    let folder = folder(&[
        ("MagnetometerUncalibrated.csv", &csv(raw)),
        ("GyroscopeUncalibrated.csv", &csv(rate)),
        ("TotalAcceleration.csv", &csv(up)),
    ]);
    let elsewhere = tempfile::tempdir().unwrap();
    let path = elsewhere.path().join("session.csv.gz");
    let (code, ..) = run(&["import", folder.path().to_str().unwrap(), "-o", path.to_str().unwrap()]);
    assert_eq!(code, 0);
    let recording = recording::read(&path).unwrap();
    let found = replay(&recording, &Config::default(), Ignore::default()).unwrap();

    let mut compensator = Compensator::new(Config::default()).unwrap();
    let (mut rates, mut ups) = (session.rotation_rates.iter().peekable(), session.ups.iter().peekable());
    let by_hand = session.magnetic.iter().map(|sample| {
        while let Some(event) = rates.next_if(|event| event.time_ns <= sample.time_ns) {
            let _ = compensator.push_rotation_rate(*event);
        }
        while let Some(event) = ups.next_if(|event| event.time_ns <= sample.time_ns) {
            let _ = compensator.push_up(*event);
        }
        compensator.push(*sample)
    });
    let by_hand: Vec<_> = by_hand.collect();
    assert_eq!(found.len(), by_hand.len());
    for (found, by_hand) in found.iter().zip(&by_hand) {
        assert_eq!(found.reading, *by_hand);
    }
    assert!(by_hand.iter().filter(|reading| reading.heading.is_some()).count() > 1000);
}

#[test]
fn the_systems_field_is_judged_beside_ours_and_the_calibration_is_read_again() {
    let session = three_rates();
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("r.csv");
    let mut text = "t_s,mx,my,mz,gx,gy,gz,sys_mx,sys_my,sys_mz\n".to_owned();
    let mut sizes = Vec::new();
    for (sample, truth) in session.magnetic.iter().zip(&session.truth) {
        // a system that is right but for a constant of 5 uT
        let system =
            truth.attitude.inverse() * world_field_ut(50.0, 60.0) + magcomp::nalgebra::Vector3::new(5.0, 0.0, 0.0);
        if sample.time_ns > 15_000_000_000 {
            sizes.push(system.norm());
        }
        let m = sample.field_ut;
        let rate = session
            .rotation_rates
            .iter()
            .find(|event| event.time_ns >= sample.time_ns)
            .unwrap_or(session.rotation_rates.last().unwrap());
        let (g, s) = (rate.rate_rad_s, system);
        writeln!(
            text,
            "{},{},{},{},{},{},{},{},{},{}",
            sample.time_ns as f64 / 1e9,
            m.x,
            m.y,
            m.z,
            g.x,
            g.y,
            g.z,
            s.x,
            s.y,
            s.z
        )
        .unwrap();
    }
    fs::write(&input, text).unwrap();
    let (json, pages) = (folder.path().join("c.json"), folder.path().join("pages"));
    let paths = [&input, &json, &pages].map(|path| path.to_str().unwrap());
    let (code, table, error) = run(&["replay", paths[0], "--calibration", paths[1], "--report", paths[2]]);
    assert_eq!((code, error.as_str()), (0, ""));
    let spread = table.lines().find(|line| line.contains("spread of total field")).unwrap();
    let cells: Vec<f64> = spread.split_whitespace().filter_map(|cell| cell.parse().ok()).collect();
    let mean = sizes.iter().sum::<f64>() / sizes.len() as f64;
    let variance = sizes.iter().map(|size| (size - mean).powi(2)).sum::<f64>() / sizes.len() as f64;
    let expected = variance.sqrt();
    assert!(
        table.contains("the system's") && cells.len() == 3 && (cells[1] - expected).abs() < 0.02,
        "{expected}: {table}"
    );

    let text = fs::read_to_string(&json).unwrap();
    let calibration: Calibration = serde_json::from_str(&text).unwrap();
    let value: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(value["covariance"].as_array().unwrap().len(), 9);
    // the names are those of the file that Kotlin's and Swift's tests read, and its numbers those that they expect
    let committed = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/vectors/calibration.json");
    let committed = fs::read_to_string(committed).unwrap();
    let names = |value: &serde_json::Value| value.as_object().unwrap().keys().cloned().collect::<Vec<_>>();
    assert_eq!(names(&value), names(&serde_json::from_str(&committed).unwrap()));
    let read: Calibration = serde_json::from_str(&committed).unwrap();
    let (m, b) = (read.soft_iron(), read.hard_iron_ut());
    assert_eq!([m.m11, m.m22, m.m33], [1.0074739066651197, 0.9949408198854466, 0.9975852116805589]);
    assert_eq!([m.m12, m.m13, m.m23], [0.0010278183785302803, 0.0033559853288960234, -0.0005891320979764632]);
    assert_eq!([b.x, b.y, b.z], [0.4434981867517305, 0.07810767384555047, -0.2777318011715177]);
    assert_eq!(read.field_strength_ut(), 44.62375335464398);
    let truth = session.truth.last().unwrap().hard_iron_ut;
    let sigma = value["covariance"][0][0].as_f64().unwrap().sqrt();
    assert!(
        (calibration.hard_iron_ut().x - truth.x).abs() < 4.0 * sigma && sigma < 1.0,
        "{calibration:?}, {truth}, {sigma}"
    );
    assert!(Compensator::new(Config { initial: Some(calibration), ..Config::default() }).is_ok());

    let html = fs::read_to_string(pages.join("index.html")).unwrap();
    assert!(html.contains("replay_sphere.svg") && html.contains("replay_sphere.html"), "{html}");
    let page = fs::read_to_string(pages.join("replay_sphere.html")).unwrap();
    assert!(
        !page.contains("http") && !page.contains("/*DATA*/") && page.contains("\"tracking\""),
        "the page needs a network or has no data"
    );
}

#[test]
fn a_calibration_that_was_not_found_is_not_written() {
    let folder = folder(&[("r.csv", "t_s,mx,my,mz\n0,20,30,40\n0.01,20,30,41\n")]);
    let (input, json) = (folder.path().join("r.csv"), folder.path().join("c.json"));
    let (code, _, error) = run(&["replay", input.to_str().unwrap(), "--calibration", json.to_str().unwrap()]);
    assert!(code == 1 && error.contains("no calibration was found") && !json.exists(), "{error}");
}

/// A file of `tests/sessions`, which `make.py` there made with other people's writers.
fn session(name: &str) -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/sessions").join(name)
}

#[test]
fn a_bag_of_ros_2() {
    let line = |k: usize| {
        let (mag, imu) = (format!("0.0{k}0000000,{},-5,-40", 20 + k), format!("0.0{k}4000000"));
        format!("{mag},,,,,,\n{imu},,,,0.5,-0.25,9.75,0.1,0.2,{}\n", 0.25 * k as f64)
    };
    let lines = |text: &str| -> Vec<Vec<String>> {
        let cell = |cell: &str| cell.parse::<f64>().map_or_else(|_| cell.to_owned(), |v| format!("{v:.9}"));
        text.lines().map(|line| line.split(',').map(cell).collect()).collect()
    };
    let expected = format!("t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n{}", (0..5).map(line).collect::<String>());
    assert_eq!(lines(&imported(&[&session("ros2.mcap")], &[])), lines(&expected));
    // as ROS 2 writes it: a folder with metadata.yaml
    let folder = folder(&[("metadata.yaml", "rosbag2_bagfile_information:\n")]);
    fs::copy(session("ros2.mcap"), folder.path().join("bag_0.mcap")).unwrap();
    assert_eq!(lines(&imported(&[folder.path()], &[])), lines(&expected));
    let turned = imported(&[&session("ros2.mcap")], &["--frame=-y,x,z"]);
    assert_eq!(lines(&turned)[1][1..4], ["5.000000000", "20.000000000", "-40.000000000"]);
    let (code, text, error) = run(&["replay", session("ros2.mcap").to_str().unwrap()]);
    assert_eq!(code, 0, "{error}");
    assert!(text.contains("ROS 2 session") && text.contains("--frame=-y,x,z"), "{text}");

    // no stamps: the recorder's time; two topics of one kind
    let two = session("ros2_two_topics.mcap");
    let error = refused(&[&two], &[]);
    assert!(error.contains("MagneticField is on /gps/mag and /imu/mag; name one by --topics"), "{error}");
    let (code, text, error, recording) = import(&[&two], &["--topics", "/gps/mag,/imu/data_raw"]);
    assert_eq!((code, error.as_str()), (0, ""));
    assert!(text.contains("10 messages had no stamp"), "{text}");
    assert_eq!(lines(&recording.unwrap()), lines(&expected));
    // not tesla; cut off; of SQLite
    let error = refused(&[&session("ros2.mcap")], &["--units", "m=mT"]);
    assert!(error.contains("line 2, column 1 (/imu/mag magnetic_field): expected a field of 5 to 5000 uT"), "{error}");
    let bytes = fs::read(session("ros2.mcap")).unwrap();
    // cut before its first message
    let cut = folder.path().join("cut.mcap");
    fs::write(&cut, &bytes[..200]).unwrap();
    assert!(refused(&[&cut], &[]).contains("cut.mcap: cannot be read: "));
    let database = folder.path().join("bag.db3");
    fs::write(&database, b"SQLite format 3\0").unwrap();
    assert!(refused(&[&database], &[]).contains("`ros2 bag convert` makes an mcap file of it"));
}

const TABLE: [&str; 2] = ["--columns", "t=time,mx=bx,my=by,mz=bz,gx=rate_x,gy=rate_y,gz=rate_z"];
const TABLE_READ: &str = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n\
                          0.000000000,20.5,-5,-40,,,,0.125,0.25,0.5\n\
                          0.010000000,21.5,-5.5,-41,,,,0.125,0.25,0.5\n\
                          0.020000000,,,,,,,0.125,0.25,0.5\n\
                          0.030000000,22.5,-6,-42,,,,0.125,0.25,0.5\n";

#[test]
fn a_table_in_parquet_or_arrow() {
    let whole_numbers = [TABLE.as_slice(), &["--units", "t=ns"]].concat();
    for name in ["table.parquet", "table_numbers.feather"] {
        assert_eq!(imported(&[&session(name)], &whole_numbers), TABLE_READ, "{name}");
        // the unit, the column and the form are named
        let error = refused(&[&session(name)], &TABLE);
        assert!(
            error.contains(&format!("{name} as CSV: line 2, column 1 (time)"))
                && error.contains("--units t=s, ms, us or ns"),
            "{error}"
        );
        let note = ["--columns", "t=time,mx=note,my=by,mz=bz", "--units", "t=ns"];
        let error = refused(&[&session(name)], &note);
        let place = format!("{name} as CSV: line 2, column 8 (note): expected a number, found 'a'");
        assert!(error.contains(&place), "{error}");
    }
    for name in ["table_timestamps.parquet", "table_nanoseconds.parquet", "table.feather", "table.arrow"] {
        assert_eq!(imported(&[&session(name)], &TABLE), TABLE_READ, "{name}");
        let (code, text, error) = run(&[&["replay", session(name).to_str().unwrap()], TABLE.as_slice()].concat());
        assert!(code == 0 && text.contains("answered"), "{name}: {error}");
    }
    let folder = folder(&[]);
    for name in ["table.parquet", "table.feather", "table.arrow"] {
        let cut = folder.path().join(name);
        fs::write(&cut, &fs::read(session(name)).unwrap()[..200]).unwrap();
        assert!(refused(&[&cut], &TABLE).contains(&format!("{name}: cannot be read: ")), "{name}");
    }
    let old = folder.path().join("old.feather");
    fs::write(&old, b"FEA1\0\0").unwrap();
    assert!(refused(&[&old], &TABLE).contains("pandas.read_feather(IN).to_feather(OUT)"));
}
