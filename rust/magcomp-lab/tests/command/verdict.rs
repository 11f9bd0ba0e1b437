//! The verdict that a replay begins with.

use crate::{run, text};
use std::fs;

/// The same recording, each row's cells of these columns changed.
fn changed(input: &str, columns: &[&str], change: impl Fn(f64) -> f64) -> String {
    let header: Vec<&str> = input.lines().next().unwrap().split(',').collect();
    let row = |line: &str| {
        let cells = line.split(',').zip(&header).map(|(cell, name)| {
            if columns.contains(name) { change(cell.parse().unwrap()).to_string() } else { cell.to_owned() }
        });
        cells.collect::<Vec<_>>().join(",")
    };
    let rows = input.lines().skip(1).map(row);
    std::iter::once(header.join(",")).chain(rows).collect::<Vec<_>>().join("\n") + "\n"
}

#[test]
fn a_replay_begins_with_its_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let good = folder.path().join("good.csv");
    assert_eq!(run(&["simulate", text(&good), "--seconds", "90", "--motion", "text", "--seed", "7"]).0, 0);
    let (code, table, error) = run(&["replay", text(&good)]);
    assert_eq!((code, error.as_str()), (0, ""));
    let lines: Vec<&str> = table.lines().map(str::trim).collect();
    assert!(lines[1].starts_with("Heading: known to +-") && lines[1].ends_with(" % of the time."), "{table}");
    assert_eq!(lines[2], "Place: even.", "{table}");
    // the published heading is the first row, and no time of a busy machine is there
    let rule = lines.iter().position(|line| line.starts_with("---")).unwrap();
    assert!(lines[rule + 1].starts_with("published heading") && !table.contains("push"), "{table}");

    let input = fs::read_to_string(&good).unwrap();
    let bad = folder.path().join("bad.csv");
    fs::write(&bad, changed(&input, &["mx"], |value| -value)).unwrap();
    let pages = folder.path().join("pages");
    let (code, table, error) = run(&["replay", text(&bad), "--report", text(&pages)]);
    let table = table.replace("\n  ", " ");
    assert!(
        code == 3
            && table.contains("Heading: bad, ")
            && table.contains("the field turns as if the magnetometer's axes were others"),
        "{table}"
    );
    assert!(table.contains("Next: replay it again with the option that is named"), "{table}");
    assert!(error.lines().last().unwrap().starts_with("magcomp: bad.csv is bad: the field turns"), "{error}");
    let page = fs::read_to_string(pages.join("index.html")).unwrap();
    assert!(page.contains("<section class=\"card bad\"") && page.contains("magnetometer's axes"), "no card");
    let (code, json, _) = run(&["replay", text(&bad), "--json"]);
    let told: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(code == 3 && told["verdict"]["grade"] == "bad" && told["rows"].as_u64() > Some(1000), "{json}");
    assert_eq!(run(&["replay", text(&bad), "--frame", "m=-x,y,z"]).0, 0);

    // no heading is no good one, whatever the reason, which is told
    let short = folder.path().join("short.csv");
    assert_eq!(run(&["simulate", text(&short), "--seconds", "1", "--motion", "text"]).0, 0);
    let (code, table, _) = run(&["replay", text(&short)]);
    assert!(code == 0 && table.contains("Heading: bad, no heading, because after 1 s it says: "), "{table}");
    let without_up = folder.path().join("without_up.csv");
    let cells = |line: &str| {
        line.split(',').enumerate().filter(|(k, _)| !(4..7).contains(k)).map(|(_, it)| it).collect::<Vec<_>>().join(",")
    };
    fs::write(&without_up, input.lines().map(|line| cells(line) + "\n").collect::<String>()).unwrap();
    let (code, json, _) = run(&["replay", text(&without_up), "--json"]);
    let told: serde_json::Value = serde_json::from_str(&json).unwrap();
    let why = told["verdict"]["heading"].as_str().unwrap();
    assert!(
        code == 0
            && told["verdict"]["grade"] == "bad"
            && why.contains("no acceleration with gravity")
            && told["known"]["share"] == 0.0,
        "{why}"
    );
}

/// A device that is hardly turned shows too little: never a good heading.
#[test]
fn a_device_that_was_hardly_turned_has_no_good_verdict() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("still.csv");
    let mut text_of = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n".to_owned();
    for k in 0..3000 {
        // a quarter turn in a minute, and the noise of the sensors
        let (t, noise) = (f64::from(k) * 0.02, 0.2 * f64::from(k * 7919 % 13 - 6) / 6.0);
        let angle = std::f64::consts::FRAC_PI_2 * t / 60.0;
        let (mx, my) = (20.0 * angle.sin() + 30.0 + noise, 20.0 * angle.cos() - 10.0 - noise);
        let rate = std::f64::consts::FRAC_PI_2 / 60.0 + 0.01 * noise;
        text_of += &format!("{t},{mx},{my},{},{noise},0.1,{},{},0,{rate}\n", -40.0 + noise, 9.81 - noise, 0.01 * noise);
    }
    fs::write(&path, text_of).unwrap();
    let (_, json, error) = run(&["replay", text(&path), "--json"]);
    let told: serde_json::Value = serde_json::from_str(&json).unwrap_or_else(|_| panic!("{error}"));
    assert_ne!(told["verdict"]["grade"], "good", "{}", told["verdict"]);
    let turned_deg = told["known"]["turned_deg"].as_f64().unwrap();
    assert!(turned_deg < 120.0, "{turned_deg}");
}

/// A magnetometer that is turned in the device by 18 degrees turns every heading by as much. Where the motion can't show it, the verdict is not
/// good, and says what would.
#[test]
fn a_turned_magnetometer_that_the_motion_hides_is_not_good() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("look.csv");
    assert_eq!(run(&["simulate", text(&path), "--seconds", "120", "--motion", "look", "--seed", "12"]).0, 0);
    let lead = |path: &std::path::Path, options: &[&str]| {
        let (_, json, error) = run(&[&["replay", text(path), "--json"], options].concat());
        let told: serde_json::Value = serde_json::from_str(&json).unwrap_or_else(|_| panic!("{error}"));
        (told["verdict"]["grade"].as_str().unwrap().to_owned(), told["verdict"]["next"].to_string())
    };
    // the reference's own north proves it
    assert_eq!(lead(&path, &[]).0, "good");
    let sensors = |line: &str| line.split(',').take(10).collect::<Vec<_>>().join(",") + "\n";
    let input = fs::read_to_string(&path).unwrap();
    fs::write(&path, input.lines().map(sensors).collect::<String>()).unwrap();
    for deg in ["18", "-18", "0"] {
        let (grade, next) = lead(&path, &["--frame", &format!("m=x,y,z,{deg}")]);
        assert!(grade == "doubtful" && next.contains("tilt the device by 45 degrees"), "{deg}: {grade} {next}");
    }
}

/// What the axis of the heading is, is known to the remark about it.
#[test]
fn no_remark_names_the_option_that_was_given() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("upright.csv");
    let mut upright = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz\n".to_owned();
    for k in 0..3000 {
        let t = f64::from(k) * 0.02;
        let (sin, cos) = (0.8 * t).sin_cos();
        let noise = 0.1 * f64::from(k * 7919 % 13 - 6) / 6.0;
        // turned about its y, which points up
        let (mx, my, mz) = (20.0 * cos + 30.0, -40.0 + noise, 20.0 * sin - 10.0);
        upright += &format!("{t},{mx},{my},{mz},{noise},9.81,{noise},{},0.8,{}\n", 0.01 * noise, -0.01 * noise);
    }
    fs::write(&path, upright).unwrap();
    let lead = |axis: &str| run(&["replay", text(&path), "--axis", axis]).1;
    let top = lead("top").replace("\n  ", " ");
    assert!(
        top.contains("the top edge points up or down in 100 % of the time") && top.contains("--axis camera"),
        "{top}"
    );
    for axis in ["camera", "auto"] {
        assert!(!lead(axis).contains("--axis"), "{axis}");
    }
}

/// A day that the model of the Earth's field does not hold costs the declination alone, and is told.
#[test]
fn a_date_outside_of_the_model_is_a_note() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.csv");
    assert_eq!(run(&["simulate", text(&path), "--seconds", "60", "--motion", "text"]).0, 0);
    let (_, table, error) = run(&["replay", text(&path), "--place", "45.19,5.73", "--date", "2019-11-24"]);
    assert!(
        error.contains("those of 2020-01-01") && table.replace("\n  ", " ").contains("Note: the world magnetic model"),
        "{error}{table}"
    );
    let (_, json, _) = run(&["replay", text(&path), "--place", "45.19,5.73", "--date", "2019-11-24", "--json"]);
    let told: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert!(
        told["earth"]["declination_deg"].is_null() && told["earth"]["total_field_ut"].as_f64() > Some(47.0),
        "{}",
        told["earth"]
    );
}

/// Headings from outside that are not used are counted, with the reason.
#[test]
fn courses_that_are_not_used_are_told() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("r.csv");
    let mut car = "t_s,mx,my,mz,ax,ay,az,gx,gy,gz,course_deg,course_sigma_deg\n".to_owned();
    for k in 0..3000 {
        let course = if k % 50 == 0 { "90,3" } else { "," };
        let noise = 0.1 * f64::from(k * 7919 % 13 - 6) / 6.0;
        car += &format!("{},{},30,-40,0,{noise},9.81,0,0,0.0{},{course}\n", f64::from(k) * 0.02, 20.0 + noise, k % 7);
    }
    fs::write(&path, car).unwrap();
    let table = |options: &[&str]| run(&[&["replay", text(&path)], options].concat()).1.replace("\n  ", " ");
    let without = table(&[]);
    assert!(
        without.contains("Note: the headings from outside (60 in the recording) were not used: --course"),
        "{without}"
    );
    let vehicle = table(&["--course", "vehicle"]);
    assert!(
        vehicle.contains("60 of 60 of the headings from outside were not used: a vehicle's needs a calibration"),
        "{vehicle}"
    );
}
