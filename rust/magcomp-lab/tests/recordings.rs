//! `evaluate --recordings`: every figure against an independent computation, on simulated recordings with planted faults.

use assert_cmd::Command;
use magcomp::nalgebra::{UnitQuaternion, Vector3};
use magcomp::{Config, EventKind, HeadingConfig, ReferenceAxis, Status};
use magcomp_lab::catalogue::{Place, Variant, find};
use magcomp_lab::course::{Course, DevicePart};
use magcomp_lab::parallel::cores;
use magcomp_lab::parameters::Parameters;
use magcomp_lab::simulate::Noise;
use magcomp_lab::trials::{Score, Trials, judge_folder};
use magcomp_recordings::recording::{Recording, read, write_recording};
use magcomp_replay::atomic::write_atomically;
use magcomp_replay::{Ignore, Step, replay};
use serde_json::Value;
use std::fs;
use std::num::NonZeroUsize;
use std::path::Path;

/// The reference of every recording is turned by so much, clockwise.
const TURNED_DEG: f64 = 4.0;
/// The declination that the index names.
const DECLINATION_DEG: f64 = 3.0;
/// In the recording `lie` the reference is turned by so much more from 60 s to 64 s.
const LIE_DEG: f64 = 60.0;

/// A phone that is tumbled for 90 s; its hard iron steps at 50 s in the recording `step`. In `lie` it is carried, its top edge level.
fn simulated(name: &str, seed: u64) -> Recording {
    let start = Parameters { hard_iron: Vector3::new(0.4, -0.2, 0.3), ..Parameters::none() };
    let stepped = Parameters { hard_iron: Vector3::new(-0.5, 0.4, -0.3), ..start };
    let phone = find(if name == "lie" { "phone-walk-steady" } else { "phone-steady" }).unwrap();
    let sensors = phone.sensors.at_rate(50.0);
    // nothing but what is planted
    let place = Place::Even;
    let variant =
        Variant { duration_s: 90.0, earth: (48.0, 60.0), place, sensors, ..phone }.with_noise(Some(Noise::Ut(0.5)));
    let mut scenario = variant.scenario(seed);
    scenario.device = start;
    if name == "step" {
        scenario.device_parts = vec![DevicePart::between(Course::step(50.0), &start, &stepped, 48.0)];
    }
    let mut recording = scenario.run().recording(name);
    for row in &mut recording.rows {
        let lie = if name == "lie" && (60.0..64.0).contains(&row.time_s) { LIE_DEG } else { 0.0 };
        let clockwise = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -(TURNED_DEG + lie).to_radians());
        row.attitude = row.attitude.map(|attitude| clockwise * attitude);
        row.hard_iron_ut = None;
        // a reference with a hole
        if (30.0..31.0).contains(&row.time_s) {
            row.attitude = None;
        }
    }
    recording
}

/// Four recordings, the system's half of one, waypoints, and an index; gzipped or not.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    for (seed, name) in (1..).zip(["calm", "lie", "step", "other"]) {
        let end = if seed % 2 == 0 { ".csv.gz" } else { "_uncal.csv" };
        let path = folder.path().join(format!("{name}{end}"));
        write_atomically(&path, |out| write_recording(out, &simulated(name, seed))).unwrap();
    }
    let half = read(&folder.path().join("calm_uncal.csv")).unwrap();
    write_atomically(&folder.path().join("calm_oscal.csv"), |out| write_recording(out, &half)).unwrap();
    fs::write(folder.path().join("way.csv"), "t_s,x_m,y_m\n0,0,0\n").unwrap();
    let index = format!(
        "recording,group,declination_deg\ncalm*,good,{DECLINATION_DEG}\nlie,bad,{DECLINATION_DEG}\nste?_uncal,bad,{DECLINATION_DEG}\n"
    );
    fs::write(folder.path().join("INDEX.csv"), index).unwrap();
    folder
}

fn wrapped(deg: f64) -> f64 {
    (deg + 540.0).rem_euclid(360.0) - 180.0
}

fn quantile(values: &[f64], share: f64) -> f64 {
    let mut sorted = values.to_vec();
    sorted.sort_by(f64::total_cmp);
    let place = share * (sorted.len() - 1) as f64;
    let (low, high) = (sorted[place as usize], sorted[(place as usize + 1).min(sorted.len() - 1)]);
    low + (high - low) * place.fract()
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|value| value * value).sum::<f64>() / values.len() as f64).sqrt()
}

/// The circular median, and what is left of the errors without it.
fn without_constant(errors: &[f64]) -> (f64, Vec<f64>) {
    let median = |part: fn(f64) -> f64| quantile(&errors.iter().map(|e| part(e.to_radians())).collect::<Vec<_>>(), 0.5);
    let constant = median(f64::sin).atan2(median(f64::cos)).to_degrees();
    (constant, errors.iter().map(|error| wrapped(error - constant)).collect())
}

/// Rotates by the matrix of a quaternion, written out.
fn turned(q: [f64; 4], v: [f64; 3]) -> [f64; 3] {
    let [w, x, y, z] = q;
    [
        v[0] * (1.0 - 2.0 * (y * y + z * z)) + v[1] * 2.0 * (x * y - w * z) + v[2] * 2.0 * (x * z + w * y),
        v[0] * 2.0 * (x * y + w * z) + v[1] * (1.0 - 2.0 * (x * x + z * z)) + v[2] * 2.0 * (y * z - w * x),
        v[0] * 2.0 * (x * z - w * y) + v[1] * 2.0 * (y * z + w * x) + v[2] * (1.0 - 2.0 * (x * x + y * y)),
    ]
}

/// The longest stretch of these times without a gap of more than 0.2 s.
fn longest_s(times_s: &[f64]) -> f64 {
    let stretches = times_s.chunk_by(|one, next| next - one <= 0.2);
    stretches.map(|stretch| stretch[stretch.len() - 1] - stretch[0]).fold(0.0, f64::max)
}

/// Every figure of a recording from all its rows at once.
fn expected(recording: &Recording, steps: &[Step], declination_deg: f64) -> Vec<(&'static str, f64)> {
    let start_s = recording.rows[0].time_s;
    let (mut level, mut errors, mut sigmas, mut lies) = (0, Vec::new(), Vec::new(), Vec::new());
    let (mut c, mut f) = (Vec::new(), Vec::new());
    for (row, step) in recording.rows.iter().zip(steps) {
        let Some(q) = row.attitude.filter(|_| row.time_s - start_s > 20.0) else { continue };
        let q = [q.w, q.i, q.j, q.k];
        for (errors, vector) in [(&mut c, step.reading.field_ut), (&mut f, step.reading.filtered_field_ut)] {
            if let Some(vector) = vector {
                let [east, north, _] = turned(q, vector.into());
                errors.push(wrapped(declination_deg - east.atan2(north).to_degrees()));
            }
        }
        let [east, north, _] = turned(q, [0.0, 1.0, 0.0]);
        if east.hypot(north) <= 0.5 {
            continue;
        }
        level += 1;
        if let Some(heading) = step.reading.heading {
            let error = wrapped(heading.heading_deg + declination_deg - east.atan2(north).to_degrees());
            let sigma = heading.heading_sigma_deg.unwrap();
            errors.push(error);
            sigmas.push(sigma);
            if step.reading.status == Status::Tracking && error.abs() > 3.0 * sigma {
                lies.push(row.time_s);
            }
        }
    }
    let z: Vec<f64> = errors.iter().zip(&sigmas).map(|(error, sigma)| error.abs() / sigma).collect();
    let within = |limit: f64| z.iter().filter(|z| **z < limit).count() as f64 / z.len() as f64;
    let first = steps.iter().position(|step| step.reading.heading.is_some()).unwrap();
    let mut events: Vec<_> = steps.iter().filter_map(|step| step.reading.event).collect();
    events.dedup();
    let device_steps = events.iter().filter(|event| event.kind != EventKind::PlaceChanged).count() as f64;
    let (constant, rest) = without_constant(&errors);
    vec![
        ("heading_rms_deg", rms(&rest)),
        ("heading_p95_deg", quantile(&rest.iter().map(|error| error.abs()).collect::<Vec<_>>(), 0.95)),
        ("heading_absolute_deg", rms(&errors)),
        ("constant_deg", constant),
        ("corrected_rms_deg", rms(&without_constant(&c).1)),
        ("corrected_absolute_deg", rms(&c)),
        ("carried_rms_deg", rms(&without_constant(&f).1)),
        ("carried_absolute_deg", rms(&f)),
        ("within_one_sigma", within(1.0)),
        ("within_two_sigma", within(2.0)),
        ("z_squared", z.iter().map(|z| z.powi(2).min(100.0)).sum::<f64>() / z.len() as f64),
        ("sigma_deg", quantile(&sigmas, 0.5)),
        ("longest_lie_s", longest_s(&lies)),
        ("device_steps_per_hour", device_steps / (recording.extent().duration_s() / 3600.0)),
        ("first_s", recording.rows[first].time_s - start_s),
        ("answered", errors.len() as f64 / f64::from(level)),
    ]
}

fn judged(folder: &Path) -> Trials {
    judge_folder(folder, None, Ignore::default(), cores()).unwrap()
}

fn score<'a>(trials: &'a Trials, recording: &str) -> &'a Score {
    trials.recordings.iter().find(|score| score.recording == recording).unwrap()
}

#[test]
fn every_figure_agrees_with_an_independent_computation() {
    let folder = folder();
    let trials = judged(folder.path());
    let names: Vec<&str> = trials.recordings.iter().map(|score| score.recording.as_str()).collect();
    assert_eq!(names, ["calm_uncal", "lie", "other", "step_uncal"]);
    for (name, file, declination_deg) in [
        ("calm_uncal", "calm_uncal.csv", DECLINATION_DEG),
        ("lie", "lie.csv.gz", DECLINATION_DEG),
        ("other", "other.csv.gz", 0.0),
        ("step_uncal", "step_uncal.csv", DECLINATION_DEG),
    ] {
        let recording = read(&folder.path().join(file)).unwrap();
        let heading = HeadingConfig { axis: ReferenceAxis::TopEdge, ..HeadingConfig::default() };
        let steps = replay(&recording, &Config { heading, ..Config::default() }, Ignore::default()).unwrap();
        let found = score(&trials, name);
        let expected = expected(&recording, &steps, declination_deg);
        // the bound is tested where it is formed
        assert_eq!(found.figures.len(), expected.len() + 2);
        let [bound, over] = ["bound_deg", "over_bound"].map(|name| found.figures[name].unwrap());
        let heading = found.figures["heading_rms_deg"].unwrap();
        assert!(bound > 0.0 && (over * bound / heading - 1.0).abs() < 1e-9, "{bound} {over}");
        for (figure, expected) in expected {
            let found = found.figures[figure].unwrap_or_else(|| panic!("{name} has no {figure}"));
            // azimuths are counted in bins of 0.001 deg, and the median is the upper one
            assert!(
                (found - expected).abs() < 0.005 + 0.001 * expected.abs(),
                "{name} {figure}: {found}, not {expected}"
            );
        }
    }
}

#[test]
fn what_was_planted_is_found() {
    let folder = folder();
    let trials = judged(folder.path());
    let figure = |recording: &str, figure: &str| score(&trials, recording).figures[figure].unwrap();
    // the reference is turned clockwise, so headings are too small; magnetic north is east, so true headings are larger
    let constant = figure("calm_uncal", "constant_deg");
    assert!((constant - (DECLINATION_DEG - TURNED_DEG)).abs() < 1.0, "{constant}");
    let other = figure("other", "constant_deg");
    assert!((other + TURNED_DEG).abs() < 1.0, "{other}");
    assert!(figure("calm_uncal", "heading_rms_deg") < 1.5 && figure("other", "heading_absolute_deg") > 3.0);

    let [lie, calm] = ["lie", "calm_uncal"].map(|recording| figure(recording, "longest_lie_s"));
    assert!((3.9..4.0).contains(&lie) && calm < 1.0, "{lie} {calm}");
    assert!(figure("lie", "heading_p95_deg") > 50.0, "4 of 70 s are off by 60 deg");

    let steps: Vec<usize> = trials.recordings.iter().map(|score| score.device_steps).collect();
    assert_eq!(steps, [0, 0, 0, 1]);
    assert!((figure("step_uncal", "device_steps_per_hour") - 40.0).abs() < 0.1, "one in 90 s");
}

#[test]
fn groups_sum_their_recordings_up() {
    let folder = folder();
    let trials = judged(folder.path());
    let groups: Vec<(&str, usize)> =
        trials.groups.iter().map(|group| (group.group.as_str(), group.recordings)).collect();
    assert_eq!(groups, [("good", 1), ("bad", 2), ("others", 1)]);
    let [lie, step] = ["lie", "step_uncal"].map(|recording| score(&trials, recording));
    for (figure, summary) in &trials.groups[1].figures {
        let (summary, values) = (summary.unwrap(), [lie, step].map(|score| score.figures[figure].unwrap()));
        let small = figure.starts_with("within") || *figure == "answered";
        let (better, worse) =
            if (values[0] < values[1]) == small { (values[1], values[0]) } else { (values[0], values[1]) };
        for (found, expected) in [
            (summary.median, (better + worse) / 2.0),
            (summary.p90, better + 0.9 * (worse - better)),
            (summary.worst, worse),
        ] {
            assert!((found - expected).abs() < 1e-9, "{figure}: {found}, not {expected}");
        }
    }
    assert!(!trials.groups[1].figures.contains_key("constant_deg"));
}

#[test]
fn the_number_of_threads_changes_nothing() {
    let folder = folder();
    let by = |threads: usize| {
        judge_folder(folder.path(), None, Ignore::default(), NonZeroUsize::new(threads).unwrap()).unwrap()
    };
    let one = by(1);
    assert_eq!(by(2), one);
    assert_eq!(by(7), one);
}

/// Runs `evaluate --recordings`; exit code, standard output, standard error.
fn evaluate(folder: &Path, arguments: &[&str]) -> (i32, String, String) {
    let mut command = Command::cargo_bin("magcomp").unwrap();
    let output = command.args(["evaluate", "--recordings"]).arg(folder).args(arguments).output().unwrap();
    let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
    // progress, of which a slow machine has a line each ten seconds, is no complaint
    let is_progress = |line: &&str| line.starts_with("evaluate: ") || line.starts_with("magnets: ");
    let told: Vec<String> = text(&output.stderr).lines().filter(|line| !is_progress(line)).map(str::to_owned).collect();
    (output.status.code().unwrap(), text(&output.stdout), told.join("\n"))
}

#[test]
fn the_command_prints_a_row_a_recording_and_a_row_a_group() {
    let folder = folder();
    let (code, table, error) = evaluate(folder.path(), &[]);
    assert_eq!((code, error.as_str()), (0, ""));
    let trials = judged(folder.path());
    for name in
        trials.recordings.iter().map(|score| &score.recording).chain(trials.groups.iter().map(|group| &group.group))
    {
        assert_eq!(
            table.lines().filter(|line| line.trim_start().starts_with(&format!("{name} "))).count(),
            1,
            "{name}: {table}"
        );
    }
    let (code, json, _) = evaluate(folder.path(), &["--json"]);
    let value: Value = serde_json::from_str(&json).unwrap();
    assert_eq!((code, &value), (0, &serde_json::to_value(&trials).unwrap()));

    // another index; its line that fits nothing is told
    let index = folder.path().join("mine.csv");
    fs::write(&index, "recording,group\n*,all of them\nnobody*,nothing\n").unwrap();
    let (code, json, error) = evaluate(folder.path(), &["--json", "--index", index.to_str().unwrap()]);
    let value: Value = serde_json::from_str(&json).unwrap();
    assert_eq!(
        (code, &value["groups"][0]["group"], &value["groups"][0]["recordings"]),
        (0, &"all of them".into(), &4.into())
    );
    assert!(error.contains("warning") && error.contains("'nobody*' fits no recording"), "{error}");
}

#[test]
fn what_cannot_be_judged_is_refused_with_its_place() {
    let folder = folder();
    let refused = |arguments: &[&str]| {
        let (code, output, error) = evaluate(folder.path(), arguments);
        assert_eq!(output, "");
        (code, error)
    };
    let index = folder.path().join("mine.csv");
    for (text, expected) in [
        ("recording,group\n[,x\n", "mine.csv: line 2: expected a recording's name or a pattern"),
        ("recording,group,declination_deg\n*,x,200\n", "expected a declination from -180 to 180 degrees, found 200"),
        ("recording,group,declination_deg\n*,x,east\n", "mine.csv: line 2: expected an index with the columns"),
        ("name,group\nx,y\n", "expected an index with the columns recording,group"),
    ] {
        fs::write(&index, text).unwrap();
        let (code, error) = refused(&["--index", index.to_str().unwrap()]);
        assert!(code == 1 && error.contains(expected) && error.lines().count() == 1, "{error}");
    }
    fs::remove_file(index).unwrap();
    assert_eq!(refused(&["--runs", "3"]).0, 2);

    fs::write(folder.path().join("broken.csv"), "t_s,mx,my,mz,qw,qx,qy,qz\n0,1,2,3,1,0,0,0\n1,1,x,3,1,0,0,0\n")
        .unwrap();
    let (code, error) = refused(&[]);
    assert!(code == 1 && error.contains("broken.csv: line 3, column 3 (my): expected a number, found 'x'"), "{error}");

    let empty = tempfile::tempdir().unwrap();
    fs::write(empty.path().join("r.csv"), "t_s,mx,my,mz\n0,1,2,3\n").unwrap();
    let (code, _, error) = evaluate(empty.path(), &[]);
    assert!(code == 2 && error.contains("no recording") && error.contains("qw,qx,qy,qz"), "{error}");
    let (code, _, error) = evaluate(&empty.path().join("missing"), &[]);
    assert!(code == 1 && error.contains("cannot be read"), "{error}");
}

/// Every magnet on a recording of a folder, and not on one that has a magnet of its own; each row says what it is.
#[test]
fn magnets_are_put_on_recordings_without_one() {
    let folder = tempfile::tempdir().unwrap();
    for (name, seed) in [("free", 1), ("taken", 2)] {
        let path = folder.path().join(format!("{name}.csv"));
        write_atomically(&path, |out| write_recording(out, &simulated("calm", seed))).unwrap();
    }
    let index = "recording,group,declination_deg,magnet_s\nfree,one,0,\ntaken,two,0,40-60\n";
    fs::write(folder.path().join("INDEX.csv"), index).unwrap();
    let (code, printed, error) = evaluate(folder.path(), &["--magnets", "--json"]);
    assert_eq!(code, 0, "{error}");
    assert!(error.contains("taken: left out, it has a magnet of its own"), "{error}");
    let value: Value = serde_json::from_str(&printed).unwrap();
    let runs = value["runs"].as_array().unwrap();
    assert_eq!(runs.len(), 10);
    assert!(runs.iter().all(|run| run["recording"] == "free" && run["label"] == "arithmetic, not a real magnet"));
    let of = |magnet: &str| runs.iter().find(|run| run["magnet"] == magnet).unwrap();
    assert_eq!((of("nothing")["due"].as_u64(), of("27 uT on and off")["due"].as_u64()), (Some(0), Some(2)));
    // a magnet on a tumbled phone in an even place is told, once, and found
    let strong = of("100 uT at once");
    assert_eq!((strong["missed"].as_u64(), strong["again"].as_u64()), (Some(0), Some(0)), "{strong}");
    assert!(strong["hard_iron_off_ut"].as_f64().is_some_and(|ut| ut < 2.0), "{strong}");
    let (_, table, _) = evaluate(folder.path(), &["--magnets", "--seeds", "2-3", "--without-gyroscope"]);
    let rows = table.lines().filter(|line| line.contains("arithmetic, not a real magnet)"));
    assert_eq!(rows.count(), 9, "{table}");
    fs::write(folder.path().join("INDEX.csv"), index.replace("free,one,0,", "free,one,0,30-50")).unwrap();
    let (code, out, error) = evaluate(folder.path(), &["--magnets"]);
    assert!(
        code == 2 && out.is_empty() && error.contains("a magnet can be put on no recording of this folder"),
        "{error}"
    );
    for wrong in [&["--seeds", "1-2"][..], &["--magnets", "--group", "steps"], &["--magnets", "--judge"]] {
        assert_eq!(evaluate(folder.path(), wrong).0, 2, "{wrong:?}");
    }
}
