//! Tables in the forms that people have: no header, no times, blanks, titles, units, dates; sensors by names of files and columns.

use crate::{folder, import, imported, refused};
use std::fs;

/// The recording's rows as numbers, empty cells as nan.
fn rows(text: &str) -> Vec<Vec<f64>> {
    let row = |line: &str| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
    text.lines().skip(1).map(row).collect()
}

#[test]
fn columns_by_number_blanks_and_a_rate_instead_of_times() {
    let folder = folder(&[
        ("blanks.txt", "0.1 0.2  0.3\t0 0 9.8 20 30 -40\n0.1 0.2 0.3 0 0 9.8 21 30 -40\n"),
        ("titles.txt", "my walk\nphone: blue, old\n1;0.1;20;30;-40\n2;0.2;21;30;-40\n"),
    ]);
    let columns = "gx=#1,gy=#2,gz=#3,ax=#4,ay=#5,az=#6,mx=#7,my=#8,mz=#9";
    let found = imported(&[&folder.path().join("blanks.txt")], &["--columns", columns, "--rate", "50"]);
    assert_eq!(
        rows(&found),
        [
            [0.0, 20.0, 30.0, -40.0, 0.0, 0.0, 9.8, 0.1, 0.2, 0.3],
            [0.02, 21.0, 30.0, -40.0, 0.0, 0.0, 9.8, 0.1, 0.2, 0.3]
        ]
    );
    let path = folder.path().join("titles.txt");
    let found = imported(&[&path], &["--columns", "t=#2,mx=#3,my=#4,mz=#5"]);
    assert_eq!(
        rows(&found).iter().map(|row| row[..4].to_vec()).collect::<Vec<_>>(),
        [[0.1, 20.0, 30.0, -40.0], [0.2, 21.0, 30.0, -40.0]]
    );
    let found = imported(&[&path], &["--columns", "t=#2,mx=#3,my=#4,mz=#5", "--skip", "3"]);
    assert_eq!(rows(&found).len(), 1);
    let error = refused(&[&folder.path().join("blanks.txt")], &[]);
    assert!(error.contains("--columns t=#1,mx=#2,my=#3,mz=#4 (and --rate HZ"), "{error}");
    let error = refused(&[&path], &["--columns", "t=#2,mx=#3,my=#4,mz=#6"]);
    assert!(error.contains("expected at least 6 columns"), "{error}");
}

#[test]
fn titles_units_dates_sums_and_empty_words() {
    let folder = folder(&[
        (
            "dates.csv",
            "Recorded by me\n\nt,mx,my,mz\n(s),(uT),(uT),(uT)\n2026-11-22T10:11:12.000+01:00,20,30,-40\n2026-11-22T10:11:12.010+01:00,21,30,-40\n",
        ),
        ("sums.csv", "secs,nsecs,mx,my,mz\n5,10000000,20,30,-40\n5,20000000,null,None,-\n5,30000001,22,30,-40\n"),
        ("factor.csv", "t,mx,my,mz\n0,200000,300000,-400000\n10000,210000,300000,-400000\n"),
    ]);
    let path = |name: &str| folder.path().join(name);
    let found = rows(&imported(&[&path("dates.csv")], &["--columns", "t=t"]));
    assert!(found.len() == 2 && found[1][0] == 0.01 && found[1][1] == 21.0, "{found:?}");
    let found = imported(&[&path("sums.csv")], &["--columns", "t=secs+1e-9*nsecs"]);
    let times: Vec<&str> = found.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(times, ["5.010000000", "5.030000001"]);
    let found = rows(&imported(&[&path("factor.csv")], &["--columns", "t=t", "--units", "t=1e-6,m=1e-4"]));
    assert_eq!([found[0][1], found[0][3], found[1][0]], [20.0, -40.0, 0.01]);
    assert!(refused(&[&path("sums.csv")], &["--columns", "t=secs+1e-12*nsecs"]).contains("t=secs+1e-9*nsecs"));
}

#[test]
fn one_file_a_sensor_is_told_by_its_name() {
    let rows = |z: f64| (0..50).map(|k| format!("{},0.5,0.25,{z}\n", f64::from(k) / 50.0)).collect::<String>();
    let text = |z: f64| format!("time,x,y,z\n{}", rows(z));
    let folder = folder(&[("my_mag.csv", &text(-40.0)), ("my_acc.csv", &text(9.8)), ("my_gyr.csv", &text(0.1))]);
    let paths = ["my_mag.csv", "my_acc.csv", "my_gyr.csv"].map(|name| folder.path().join(name));
    for options in [&[][..], &["--columns", "t=time,mx=x,my=y,mz=z"]] {
        let found = imported(&[&paths[0], &paths[1], &paths[2]], options);
        let first: Vec<&str> = found.lines().nth(1).unwrap().split(',').collect();
        assert_eq!([first[3], first[6], first[9], &found.lines().count().to_string()], ["-40", "9.8", "0.1", "51"]);
    }
    // names that say nothing, or the same, are refused and not taken for one sensor
    for (name, why) in
        [("other.csv", "other.csv: which sensor is it? rename it"), ("my_mag2.csv", "are of the same sensor")]
    {
        fs::write(folder.path().join(name), text(-40.0)).unwrap();
        let error = refused(&[&paths[0], &folder.path().join(name)], &["--columns", "t=time,mx=x,my=y,mz=z"]);
        assert!(error.contains(why), "{error}");
    }
    // said in the option
    let other = folder.path().join("other.csv");
    fs::write(&other, text(0.1)).unwrap();
    let columns = "t=time,mx=x,my=y,mz=z,other.csv:gx=x,gy=y,gz=z";
    let found = imported(&[&paths[0], &paths[1], &other], &["--columns", columns]);
    let first: Vec<&str> = found.lines().nth(1).unwrap().split(',').collect();
    assert_eq!([first[3], first[6], first[9]], ["-40", "9.8", "0.1"]);
    let error = refused(&[&paths[0], &other], &["--columns", "t=time,mx=x,my=y,mz=z,otter.csv:gx=x,gy=y,gz=z"]);
    assert!(error.contains("--columns otter.csv:...: no such file"), "{error}");
}

#[test]
fn loggers_are_known_by_their_headers() {
    let android = "ACCELEROMETER X (m/s²);ACCELEROMETER Y (m/s²);ACCELEROMETER Z (m/s²);LINEAR ACCELERATION X (m/s²);GYROSCOPE X (rad/s);\
                   GYROSCOPE Y (rad/s);GYROSCOPE Z (rad/s);MAGNETIC FIELD X (μT);MAGNETIC FIELD Y (μT);MAGNETIC FIELD Z (μT);\
                   Time since start in ms ;YYYY-MO-DD HH-MI-SS_SSS\n\
                   0,5;0;9,8;7;0,1;0,2;0,3;20;30;-40;0;2026-11-22 10:11:12:345\n0,5;0;9,8;7;0,1;0,2;0,3;21;30;-40;20;2026-11-22 10:11:12:365\n";
    let ios = "loggingTime(txt),accelerometerTimestamp_sinceReboot(s),accelerometerAccelerationX(G),accelerometerAccelerationY(G),\
               accelerometerAccelerationZ(G),gyroTimestamp_sinceReboot(s),gyroRotationX(rad/s),gyroRotationY(rad/s),gyroRotationZ(rad/s),\
               magnetometerTimestamp_sinceReboot(s),magnetometerX(µT),magnetometerY(µT),magnetometerZ(µT),motionUserAccelerationX(G)\n\
               2021-10-21 20:43:47.013 -0400,5.00,0.1,0,-1,5.01,0.1,0.2,0.3,5.02,20,30,-40,0\n\
               2021-10-21 20:43:47.023 -0400,5.03,0.1,0,-1,5.04,0.1,0.2,0.3,5.02,20,30,-40,0\n";
    let words = "Timestamp [ms],lsm6dso_accelerometer_x,lsm6dso_accelerometer_y,lsm6dso_accelerometer_z,ak0991x_magnetometer_x,\
                 ak0991x_magnetometer_y,ak0991x_magnetometer_z\n1000,0,0,9.8,20,30,-40\n1020,0,0,9.8,21,30,-40\n";
    let ipin = "% MAGN;AppTimestamp(s);SensorTimestamp(s);Mag_X(uT);;Mag_Y(uT);Mag_Z(uT);Accuracy(integer)\n\
                ACCE;0.004;100.004;0;0.5;9.8;3\nMAGN;0.005;100.005;20;30;-40;3\n\
                GNSS;0.010;99;45.5;5.7;200;90;5;3;10;8\nGYRO;0.012;100.012;0.1;0.2;0.3;3\nMAGN;0.015;100.015;21;30;-40;3\n";
    let folder = folder(&[("a.csv", android), ("i.csv", ios), ("w.csv", words), ("p.txt", ipin)]);
    let found = |name: &str| {
        let (code, told, error, text) = import(&[&folder.path().join(name)], &[]);
        assert_eq!(code, 0, "{error}");
        (told, rows(&text.unwrap()))
    };
    let (told, android) = found("a.csv");
    assert!(told.contains("AndroSensor session") && android[1][0] == 0.02, "{told}");
    assert_eq!(android[0][1..], [20.0, 30.0, -40.0, 0.5, 0.0, 9.8, 0.1, 0.2, 0.3]);
    // each sensor has its own time, and what a row repeats is no event
    let (told, ios) = found("i.csv");
    assert!(told.contains("SensorLog session") && ios.len() == 5, "{told}");
    assert_eq!(ios[0][4..7], [-0.980_665, 0.0, 9.80665]);
    assert_eq!(ios.iter().map(|row| row[0]).collect::<Vec<_>>(), [5.0, 5.01, 5.02, 5.03, 5.04]);
    let (_, words) = found("w.csv");
    assert_eq!((words[1][0], words[1][1], words[0][6]), (1.02, 21.0, 9.8));
    let (told, ipin) = found("p.txt");
    assert!(told.contains("GetSensorData session"), "{told}");
    assert_eq!(ipin.iter().map(|row| row[0]).collect::<Vec<_>>(), [100.004, 100.005, 100.01, 100.012, 100.015]);
    assert_eq!(ipin[2][10], 90.0);
}

#[test]
fn positions_are_places_and_phyphox_fixes_are_courses() {
    let location = "\"Time (s)\",\"Latitude (°)\",\"Longitude (°)\",\"Height (m)\",\"Velocity (m/s)\",\"Direction (°)\",\"Horizontal Accuracy (m)\"\n\
                    0.5,45.19,5.73,200,3,271.5,4\n0.6,45.19,5.73,200,0.1,90,4\n";
    let mut field =
        "\"Time (s)\",\"Magnetic field x (µT)\",\"Magnetic field y (µT)\",\"Magnetic field z (µT)\"\n".to_owned();
    (0..60).for_each(|k| field += &format!("{},20,{},-40\n", f64::from(k) / 50.0, k % 7));
    let clock = "\"event\",\"experiment time\",\"system time\"\n\"START\",0,1767225600.25\n";
    let folder = folder(&[("Magnetometer.csv", &field), ("Location.csv", location), ("time.csv", clock)]);
    let found = imported(&[folder.path()], &[]);
    let courses: Vec<&str> = found.lines().filter(|line| line.contains(",271.5,")).collect();
    assert!(courses.len() == 1 && courses[0].starts_with("0.500000000,"), "{courses:?}");
    let (_, json, _) = crate::run(&["replay", folder.path().to_str().unwrap(), "--json"]);
    let told: serde_json::Value = serde_json::from_str(&json).unwrap();
    let dip_deg = told["earth"]["dip_deg"].as_f64().unwrap();
    assert!((60.0..62.5).contains(&dip_deg), "{dip_deg}");
}

#[test]
fn a_folder_names_the_file_that_comes_nearest() {
    let folder = folder(&[
        ("CMakeLists.txt", "cmake_minimum_required(VERSION 3.10)\nproject(x)\n"),
        ("battery.csv", "time,level\n0,98\n"),
        ("log.csv", "clock,mag_x,mag_y,mag_z\n0,1,2,3\n"),
    ]);
    let error = refused(&[folder.path()], &[]);
    assert!(
        error.contains("log.csv: line 1: expected")
            && error.ends_with("found 'clock,mag_x,mag_y,mag_z'; not in CMakeLists.txt, battery.csv either\n"),
        "{error}"
    );
}

/// A table that looks like phyphox's by its first columns is not phyphox's, and loses nothing.
#[test]
fn a_form_is_claimed_by_its_whole_header() {
    let row = |names: &str, cells: &str| format!("{names}\n0,{cells}\n0.02,{cells}\n0.04,{cells}\n");
    let field = "Magnetometer X (uT),Magnetometer Y (uT),Magnetometer Z (uT)";
    let rest = "Accelerometer X (g),Accelerometer Y (g),Accelerometer Z (g),Gyroscope X (deg/s),Gyroscope Y (deg/s),Gyroscope Z (deg/s)";
    let table = row(&format!("Time (s),{field},{rest}"), "20,30,-40,0,0,1,90,0,0");
    // units below the names; one letter before the axis, of which `a` has no gravity in it
    let below =
        "time,mx,my,mz,gx,gy,gz\ns,mG,mG,mG,deg/s,deg/s,deg/s\n0,200,300,-400,90,0,0\n0.02,200,300,-400,90,0,0\n";
    let letters = row("time,gFx,gFy,gFz,ax,ay,az,wx,wy,wz,Bx,By,Bz", "0,0,1,0.1,0.2,0.3,1.5,0,0,20,30,-40");
    let folder = folder(&[("t.csv", &table), ("u.csv", below), ("l.csv", &letters)]);
    let quarter = std::f64::consts::FRAC_PI_2;
    let first = |name: &str| rows(&imported(&[&folder.path().join(name)], &[]))[0].clone();
    let found = first("t.csv");
    assert_eq!(found[1..7], [20.0, 30.0, -40.0, 0.0, 0.0, 9.80665]);
    assert!((found[7] - quarter).abs() < 1e-9, "{found:?}");
    let found = first("u.csv");
    assert!(found[1..4] == [20.0, 30.0, -40.0] && (found[7] - quarter).abs() < 1e-9, "{found:?}");
    assert_eq!(first("l.csv")[1..], [20.0, 30.0, -40.0, 0.0, 0.0, 9.80665, 1.5, 0.0, 0.0]);
}

#[test]
fn columns_of_a_sensor_that_are_not_taken_are_told() {
    let header = "t_s,mx,my,mz,turn_gyro_x,turn_gyro_y,turn_gyro_z";
    let text = (0..60)
        .fold(format!("{header}\n"), |text, k| text + &format!("{},20,{},-40,0,0,0.1\n", f64::from(k) * 0.02, k % 7));
    let folder = folder(&[("r.csv", &text), ("n.csv", &text.replace("t_s", "time"))]);
    let warning = "3 columns look like a sensor's (rotation rate) and were not taken, 'turn_gyro_x' first; name them by --columns";
    let (code, _, error) = crate::run(&["replay", folder.path().join("r.csv").to_str().unwrap()]);
    assert!(code == 0 && error.contains(warning), "{error}");
    let (code, _, error, _) = import(&[&folder.path().join("n.csv")], &["--columns", "t=time,mx=mx,my=my,mz=mz"]);
    assert!(code == 0 && error.contains(warning), "{error}");
    // all of it by its names
    let (code, _, error, text) = import(&[&folder.path().join("n.csv")], &[]);
    assert!(
        code == 0 && !error.contains("not taken") && text.unwrap().lines().nth(1).unwrap().ends_with(",0,0,0.1"),
        "{error}"
    );
}

/// As competitions write them: time and sensor at the beginning of each line, in either order.
#[test]
fn lines_that_begin_with_a_type_are_read() {
    let tab = "#\tstartTime:1574572522414\n1574572522000\tTYPE_WIFI\tabc\tdef\t-60\t2400\n\
               1574572522414\tTYPE_ACCELEROMETER\t0.5\t0\t9.8\t3\n\
               1574572522414\tTYPE_MAGNETIC_FIELD\t21\t31\t-41\t3\n1574572522414\tTYPE_MAGNETIC_FIELD_UNCALIBRATED\t120\t30\t-40\t100\t1\t2\t3\n\
               1574572522424\tTYPE_GYROSCOPE\t0.1\t0.2\t0.3\t3\n1574572522430\tTYPE_ROTATION_VECTOR\t0.1\t0.2\t0.3\n\
               1574572522434\tTYPE_MAGNETIC_FIELD_UNCALIBRATED\t121\t30\t-40\t100\t1\t2\t3\n";
    let comma =
        "MAG,10.00,20,30,-40\nACC,10.00,0.5,0,9.8\nGYR,10.01,0.1,0.2,0.3\nMAG,10.02,21,30,-40\nLIGHT,10.02,7,8,9\n";
    let folder = folder(&[("walk.txt", tab), ("log.csv", comma)]);
    let found = rows(&imported(&[&folder.path().join("walk.txt")], &[]));
    assert_eq!(found[0][..7], [0.0, 120.0, 30.0, -40.0, 0.5, 0.0, 9.8]);
    // the system's own field, not the uncalibrated one less its bias, where both are there
    assert_eq!(found[0][10..], [21.0, 31.0, -41.0]);
    assert_eq!((found[1][0], found[1][7], found[2][0], found[2][1]), (0.01, 0.1, 0.02, 121.0));
    let found = rows(&imported(&[&folder.path().join("log.csv")], &[]));
    assert_eq!(found.iter().map(|row| row[0]).collect::<Vec<_>>(), [10.0, 10.01, 10.02]);
    assert_eq!(found[0][1..7], [20.0, 30.0, -40.0, 0.5, 0.0, 9.8]);
    // a table with a column of notes is a table
    let noted = "t_s,note,mx,my,mz\n0,magnet,1,20,-40\n0.02,magnet,2,20,-40\n0.04,magnet,3,20,-40\n";
    fs::write(folder.path().join("noted.csv"), noted).unwrap();
    assert_eq!(rows(&imported(&[&folder.path().join("noted.csv")], &[]))[2][1..4], [3.0, 20.0, -40.0]);
}

#[test]
fn a_closing_block_is_left_out_and_damage_is_not() {
    let rows_of = |count: i32| (0..count).map(|k| format!("{k}0 20 {} -40\n", 30 + k % 3)).collect::<String>();
    let columns = ["--columns", "t=#1,mx=#2,my=#3,mz=#4", "--units", "t=ms"];
    let whole = rows_of(60);
    let folder = folder(&[("r.txt", &format!("{whole}<2>\n39.9 -0.07\n39.9 -0.08\n"))]);
    let path = folder.path().join("r.txt");
    let (code, told, error, text) = import(&[&path], &columns);
    assert!(code == 0 && error.is_empty() && text.unwrap().lines().count() == 61, "{error}");
    assert!(
        told.replace("\n  ", " ").contains("lines 61 to 63 behind the last row are none and were left out"),
        "{told}"
    );
    // a row follows, or more lines than any logger closes a file with
    for end in [format!("<2>\n{}", rows_of(61).lines().last().unwrap()), "x y z\n".repeat(55)] {
        fs::write(&path, format!("{whole}{end}\n")).unwrap();
        assert!(refused(&[&path], &columns).contains("line 61, column "), "{end}");
    }
}

#[test]
fn what_is_no_table_is_refused_with_the_way_out_and_shows_no_numbers() {
    let few = "# a log\nFix,GPS,10.005980,20.005980,5.0,1.2,3.8,354,1700000598000\n".to_owned()
        + &(1..11).map(|k| format!("UncalMag,17000000{k}0000,{k}0000000000,20,30,-40,0,0,0\n")).collect::<String>();
    let folder = folder(&[
        ("s.json", "[{\"sensor\":\"Magnetometer\",\"x\":\"1\"}]\n"),
        ("b.bag", "#ROSBAG V2.0\nE\u{1}"),
        ("few.txt", &few),
        ("where.txt", "Fix,GPS,10.005980,20.005980,5.0\n"),
    ]);
    let error = |name: &str| refused(&[&folder.path().join(name)], &[]);
    assert!(error("s.json").contains("JSON is not read; export the session as CSV"));
    assert!(error("b.bag").contains("rosbags-convert"));
    let told = error("few.txt");
    assert!(
        told.contains("magnetometer events in")
            && told.contains("too few")
            && !told.contains("10.00")
            && !told.contains("--units"),
        "{told}"
    );
    let told = error("where.txt");
    assert!(told.contains("'Fix,GPS,..,..,..'"), "{told}");
}
