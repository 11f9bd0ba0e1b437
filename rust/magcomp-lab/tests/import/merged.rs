//! Sensors of several rates as one recording, and its replay.

use crate::{HEADER, folder, run};
use magcomp::nalgebra::Vector3;
use magcomp::{Calibration, Compensator, Config};
use magcomp_lab::catalogue::{Variant, find};
use magcomp_lab::simulate::{Simulation, world_field_ut};
use magcomp_recordings::recording;
use magcomp_replay::{Ignore, replay};
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

#[test]
fn events_out_of_order_and_twice_are_said() {
    let text = format!("{HEADER}3,0,-40,3,2\n1,0,-40,1,2\n2,0,-40,2,2\n2,0,-40,9,2\n").replace("\n3,", "\n30000000,");
    let text = text.replace("\n1,", "\n10000000,").replace("\n2,", "\n20000000,");
    let folder = folder(&[("Magnetometer.csv", &text)]);
    let elsewhere = tempfile::tempdir().unwrap();
    let output = elsewhere.path().join("out.csv");
    let (code, table, _) = run(&["import", folder.path().to_str().unwrap(), "-o", output.to_str().unwrap()]);
    assert_eq!(code, 0);
    assert!(table.contains("magnetometer 1 events were older than the one before"), "{table}");
    assert!(table.contains("magnetometer 1 events had the time of another with another value"), "{table}");
    assert!(table.contains("the magnetometer is the one that the system calibrates"), "{table}");
    let times = fs::read_to_string(output).unwrap();
    let times: Vec<&str> = times.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(times, ["0.010000000", "0.020000000", "0.030000000"]);
}

/// Three sensors at three rates that do not divide one another.
fn three_rates() -> Simulation {
    let mut phone = Variant { duration_s: 30.0, ..find("phone-steady").unwrap() };
    phone.sensors.magnetometer.rate_hz = 50.0;
    (phone.sensors.gyro_hz, phone.sensors.accel_hz) = (173.0, 71.0);
    phone.stream(7)
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

/// As a recording with the field of a system that is right but for a constant of 5 uT, and that field's sizes after 15 s, uT.
fn with_a_systems_field(session: &Simulation) -> (String, Vec<f64>) {
    let mut text = "t_s,mx,my,mz,gx,gy,gz,sys_mx,sys_my,sys_mz\n".to_owned();
    let mut sizes = Vec::new();
    for (sample, truth) in session.magnetic.iter().zip(&session.truth) {
        let system = truth.attitude.inverse() * world_field_ut(50.0, 60.0) + Vector3::new(5.0, 0.0, 0.0);
        if sample.time_ns > 15_000_000_000 {
            sizes.push(system.norm());
        }
        let later = session.rotation_rates.iter().find(|event| event.time_ns >= sample.time_ns);
        let rate = later.unwrap_or(session.rotation_rates.last().unwrap()).rate_rad_s;
        let cells = [sample.field_ut, rate, system].map(|v| format!("{},{},{}", v.x, v.y, v.z));
        writeln!(text, "{},{}", sample.time_ns as f64 / 1e9, cells.join(",")).unwrap();
    }
    (text, sizes)
}

#[test]
fn the_systems_field_is_judged_beside_ours_and_the_calibration_is_read_again() {
    let session = three_rates();
    let folder = tempfile::tempdir().unwrap();
    let input = folder.path().join("r.csv");
    let (text, sizes) = with_a_systems_field(&session);
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
