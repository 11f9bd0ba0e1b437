//! Demo, simulate, compare, evaluate.

use crate::{magcomp, run, simulated, text};
use std::fs;

#[test]
fn demo_needs_nothing_but_an_empty_folder() {
    let folder = tempfile::tempdir().unwrap();
    let found = magcomp().current_dir(folder.path()).args(["demo", "--runs", "1"]).output().unwrap();
    let (out, error) = (String::from_utf8(found.stdout).unwrap(), String::from_utf8(found.stderr).unwrap());
    assert_eq!(found.status.code(), Some(0), "{error}");
    let is_progress = |line: &str| line.ends_with(" ...") || line.starts_with("step: ");
    assert!(error.lines().all(is_progress), "{error}");
    // what it comes to stands first, with its figures; the page is named last
    let plain = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let readme = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../README.md")).unwrap();
    let quoted = plain(&readme);
    let quoted =
        quoted.split("It prints ").nth(1).and_then(|rest| rest.split(" degrees").next()).expect("figures in README");
    let [raw, vqf, magcomp_deg] =
        quoted.split([',', ' ']).filter(|word| word.parse::<f64>().is_ok()).collect::<Vec<_>>()[..]
    else {
        panic!("README quotes {quoted}")
    };
    let told = [
        format!("the raw heading is {raw} degrees off, that of the filter VQF {vqf}, magcomp's {magcomp_deg} (rms"),
        "right to 2 degrees after".to_owned(),
    ];
    assert!(told.iter().all(|told| plain(&out[..800]).contains(told.as_str())), "{told:?} {out}");
    assert!(out.contains("broad_01") && out.ends_with("report: magcomp-report/index.html\n"), "{out}");
    assert!(out.lines().count() <= 20 && out.lines().all(|line| line.chars().count() <= 122), "{out}");
    let pages = folder.path().join("magcomp-report");
    let html = fs::read_to_string(pages.join("index.html")).unwrap();
    let pictures = fs::read_dir(&pages).unwrap().map(|file| file.unwrap().file_name().into_string().unwrap());
    let pictures: Vec<String> = pictures.filter(|name| name.ends_with(".svg")).collect();
    assert!(pictures.len() > 4 && pictures.iter().all(|name| html.contains(name)), "{pictures:?}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    let lead = html.split("class=\"lead\">").nth(1).and_then(|rest| rest.split("</p>").next()).unwrap();
    assert!(told.iter().all(|told| lead.contains(told.as_str())), "{lead}");
    assert!(html.find("heading_error.svg").unwrap() < html.find("<table").unwrap());
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let shown = fs::read_to_string(root.join("docs/pictures/heading_error.svg")).unwrap();
    let drawn = fs::read_to_string(pages.join("heading_error.svg")).unwrap();
    // points may differ in a last digit on another processor; names, figures and axes may not
    let words = |svg: &str| svg.lines().filter(|line| !line.contains('<')).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(words(&shown), words(&drawn), "copy magcomp-report/heading_error.svg to docs/pictures");
}

#[test]
fn simulate_is_reproducible_bit_for_bit() {
    let folder = tempfile::tempdir().unwrap();
    let written = |name: &str, seed: &str| {
        let path = folder.path().join(name);
        let arguments =
            ["simulate", text(&path), "--seed", seed, "--seconds", "10", "--change", "step", "--spikes", "0.02"];
        assert_eq!(run(&arguments).0, 0);
        fs::read(path).unwrap()
    };
    let (first, again, other) = (written("a.csv", "5"), written("b.csv", "5"), written("c.csv", "6"));
    assert!(first == again && first != other);
    assert!(first.starts_with(b"t_s,mx,my,mz,ax,ay,az,gx,gy,gz,qw,qx,qy,qz,true_bx,true_by,true_bz\n"));
}

#[test]
fn json_parses_and_the_report_shows_its_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let pages = folder.path().join("pages");
    let (code, json, _) = run(&[
        "paper",
        "bound",
        "--runs",
        "5",
        "--samples",
        "100,200",
        "--snr",
        "35",
        "--json",
        "--report",
        text(&pages),
    ]);
    assert_eq!(code, 0);
    let value: serde_json::Value = serde_json::from_str(&json).unwrap();
    assert_eq!(value["rows"].as_array().unwrap().len(), 2);
    let html = fs::read_to_string(pages.join("index.html")).unwrap();
    assert!(html.contains("fig2_bound.svg") && html.contains("magcomp paper bound --runs 5"));
    assert!(fs::read_to_string(pages.join("fig2_bound.svg")).unwrap().starts_with("<svg"));
}

#[test]
fn compare_says_who_is_better_as_markdown() {
    let methods = ["--method", "adaptive,none", "--scenario", "constant,pulse", "--runs", "1"];
    let (code, text, error) = run(&[&["compare", "--markdown"], methods.as_slice()].concat());
    assert_eq!((code, error.as_str()), (0, ""));
    assert!(text.contains("|  | adaptive | none |\n|---|---|---|\n| constant | **"), "{text}");
    assert!(text.contains("adaptive is the best or as good in all of them."), "{text}");
}

#[test]
fn compare_judges_methods_with_gyroscope_by_themselves() {
    let given = |arguments: &[&str]| {
        let (code, text, error) = run(&[&["compare", "--json"], arguments].concat());
        assert_eq!(code, 0, "{error}");
        serde_json::from_str::<serde_json::Value>(&text).unwrap()
    };
    let named = |value: &serde_json::Value, name: &str| {
        value.as_array().unwrap().iter().find(|method| method["name"] == name).unwrap().clone()
    };
    let methods = ["--method", "none,aided,aided-sample,vqf-raw,vqf-corrected,fusion"];
    let phone = given(&[&["--scenario", "phone-walk,step", "--runs", "1"], methods.as_slice()].concat());
    assert_eq!((phone[0]["methods"].as_array().unwrap().len(), phone[0]["aided"].as_array().unwrap().len()), (1, 5));
    // no gyroscope there
    assert_eq!(phone[1]["aided"].as_array().unwrap().len(), 0);
    let after_deg = |name: &str| named(&phone[0]["aided"], name)["after_deg"].as_f64().unwrap();
    // in a room: 3.5 and 3.4, against 9.0 and 16.5
    assert!(after_deg("aided") < 5.0 && after_deg("vqf-corrected") < 5.0, "{phone}");
    assert!(after_deg("fusion") > 6.0 && after_deg("vqf-raw") > 6.0, "{phone}");

    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/recordings/broad_34_attached_magnet_3cm.csv.gz");
    let recorded = given(&[&[path], methods.as_slice()].concat());
    let rms = |name: &str| named(&recorded[0]["aided"], name)["vectors"]["heading"]["rms_deg"].as_f64().unwrap();
    assert!(rms("aided") < rms("vqf-raw") && rms("vqf-raw") < rms("fusion"), "{recorded}");
    // the same figure as `replay` has for c
    let (_, text, _) = run(&["replay", "--json", path]);
    let replayed = serde_json::from_str::<serde_json::Value>(&text).unwrap();
    let replayed_deg = replayed["heading"]["rms_deg"].as_f64().unwrap();
    assert!((rms("aided-sample") - replayed_deg).abs() < 1e-6, "{} {replayed_deg}", rms("aided-sample"));
    // and as it has for the total field, in uT
    let field = named(&recorded[0]["aided"], "aided-sample")["vectors"]["total_field_ut"].clone();
    for part in ["mean", "spread"] {
        let (found, replayed) = (&field[part], &replayed["total_field_ut"]["compensated"][part]);
        assert!((found.as_f64().unwrap() - replayed.as_f64().unwrap()).abs() < 1e-6, "{part}: {found} {replayed}");
    }
    assert!(named(&recorded[0]["aided"], "vqf-raw")["vectors"]["total_field_ut"].is_null());
}

#[test]
fn compare_on_a_recording_has_a_picture() {
    let folder = tempfile::tempdir().unwrap();
    let (input, pages) = (simulated(folder.path(), "30"), folder.path().join("pages"));
    let (code, table, error) =
        run(&["compare", text(&input), "--method", "adaptive,network", "--report", text(&pages)]);
    assert_eq!((code, error.as_str()), (0, ""));
    assert!(table.contains("adaptive") && table.contains("network"), "{table}");
    assert!(table.contains("spread of |h| uT"), "{table}");
    let picture = fs::read_to_string(pages.join("compare_in.svg")).unwrap();
    assert!(picture.starts_with("<svg") && picture.contains("adaptive"), "{picture}");
}

/// docs/data/evaluation.csv has the lines of the catalogue, and the command prints them.
#[test]
fn the_situations_are_those_of_the_command() {
    let data = fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/data/evaluation.csv")).unwrap();
    let rows = |text: &str| -> Vec<csv::StringRecord> {
        csv::Reader::from_reader(text.as_bytes()).records().collect::<Result<_, _>>().unwrap()
    };
    let catalogue = magcomp_lab::catalogue::all();
    let expected: Vec<(&str, &str)> = catalogue.iter().map(|one| (one.about.as_str(), one.name.as_str())).collect();
    let all = rows(&data);
    let shown: Vec<(&str, &str)> = all.iter().map(|row| (&row[1], &row[2])).collect();
    let hint = "run `tests/figures.py evaluation --write`";
    assert_eq!(expected, shown, "{hint}");
    let (code, printed, error) = run(&["evaluate", "--variant", "phone-walk,pause.*", "--seeds", "1", "--csv"]);
    assert_eq!(code, 0, "{error}");
    assert_eq!(rows(&printed).len(), 11);
    assert!(rows(&printed).iter().all(|row| expected.contains(&(&row[1], &row[2]))), "{printed}");
    assert_eq!(printed.lines().next(), data.lines().next(), "{hint}");
}

/// The same figures from one thread and from three, each run's too; and a name that there is not is told.
#[test]
fn evaluate_gives_the_same_whatever_the_number_of_threads() {
    let with = |threads| {
        let part = ["evaluate", "--json", "--variant", "steps.b20,places.doors,alone.step", "--seeds", "3-5"];
        let (code, printed, error) = run(&[&part[..], &["--threads", threads]].concat());
        assert_eq!(code, 0, "{error}");
        printed
    };
    let one = with("1");
    assert_eq!(one, with("3"));
    let value: serde_json::Value = serde_json::from_str(&one).unwrap();
    assert_eq!(value["seeds"], serde_json::json!([3, 5]));
    let names: Vec<&str> = value["groups"]
        .as_array()
        .unwrap()
        .iter()
        .map(|group| group["variants"][0]["name"].as_str().unwrap())
        .collect();
    // in the order of the catalogue
    assert_eq!(names, ["alone.step", "steps.b20", "places.doors"]);
    assert_eq!(value["groups"][1]["variants"][0]["runs"].as_array().unwrap().len(), 3);
    let (code, _, error) = run(&["evaluate", "--variant", "steps.nothing"]);
    assert!(code == 2 && error.contains("--list"), "{code} {error}");
    for seeds in ["5-3", "x", "1-"] {
        assert_eq!(run(&["evaluate", "--seeds", seeds]).0, 2, "{seeds}");
    }
    let (_, list, _) = run(&["evaluate", "--list"]);
    assert!(list.contains("long.mixed30min") && list.contains("walking, b steps by 27 uT"), "{list}");
}

/// A mechanism on a simulated group and a folder of recordings: a row with figures of both, a summary, the command without the folder's place.
#[test]
fn sensitivity_tries_what_it_is_asked_for_on_streams_and_recordings() {
    let folder = tempfile::tempdir().unwrap();
    let trials = folder.path().join("walks");
    fs::create_dir(&trials).unwrap();
    for seed in ["4", "5", "6"] {
        let path = trials.join(format!("walk{seed}.csv"));
        assert_eq!(run(&["simulate", text(&path), "--seed", seed, "--seconds", "60"]).0, 0);
    }
    let only = ["--only", "noise_learning,gyroscope_axes,delay", "--switches"];
    let arguments = ["--group", "pause", "--seeds", "1-2", "--recordings", text(&trials)];
    let csv = folder.path().join("all.csv");
    let (code, page, error) = run(&[&["sensitivity", "--csv", text(&csv)][..], &only, &arguments].concat());
    assert_eq!(code, 0, "{error}");
    assert!(error.ends_with(" minutes\n"), "{error}");
    assert!(!page.contains(text(folder.path())), "{page}");
    assert!(page.contains("0 choices, 3 mechanisms that can be switched off and 1 pairs"), "{page}");
    let words = page.split_whitespace().collect::<Vec<_>>().join(" ");
    let command = "--seeds 1-2 --recordings walks --group pause --only noise_learning --only gyroscope_axes --only delay --switches`";
    assert!(words.contains(command) && words.contains("with gyroscope: pause.2s-b."), "{words}");
    assert!(words.contains("groups (2 streams)") && words.contains("recordings (3 streams)"), "{words}");
    let table = fs::read_to_string(&csv).unwrap();
    let figures = |begin: &str| -> Vec<Vec<String>> {
        let own = table.lines().filter(|line| line.starts_with(begin));
        own.map(|line| line.split(',').map(str::to_owned).collect()).collect()
    };
    let noise = figures("aided,noise_learning,mechanism,on,,with gyroscope,off,");
    let names: Vec<&str> = noise.iter().map(|cells| cells[7].as_str()).collect();
    let streams = ["error", "z2", "a group", "recorded error", "recorded z2", "false steps", "worst"];
    assert!(names.starts_with(&streams) && names.contains(&"magnets' error"), "{table}");
    // a figure and its noise: three recordings have a spread
    assert!(noise.iter().all(|cells| cells[8..10].iter().all(|cell| cell.parse::<f64>().is_ok())), "{table}");
    assert!(figures("aided,gyroscope_axes + delay,pair,").len() >= 6, "{table}");
    let shown = page.lines().filter(|line| line.starts_with("| aided | ")).count();
    let moved = |name: &str| figures(&format!("aided,{name},")).iter().any(|cells| cells[10] == "1");
    let moved =
        ["noise_learning", "gyroscope_axes", "delay", "gyroscope_axes + delay"].into_iter().filter(|it| moved(it));
    assert_eq!(shown, moved.count(), "{page}");
}

#[test]
fn sensitivity_refuses_what_there_is_not() {
    let refused = |arguments: &[&str]| {
        let (code, out, error) = run(&[&["sensitivity"], arguments].concat());
        assert_eq!((code, out.as_str()), (2, ""), "{error}");
        error
    };
    // the package is not the repository
    assert!(refused(&[]).contains("tests/recordings is not here: run it in the repository"));
    assert!(refused(&["--recordings", "tests", "--only", "nobody"]).contains("no choice or mechanism has 'nobody'"));
    assert!(refused(&["--recordings", "tests", "--seeds", "3"]).contains("one seed tells no noise"));
    assert!(refused(&["--recordings", "src", "--switches"]).contains("no recording"));
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("one.csv");
    assert_eq!(run(&["simulate", text(&path), "--seconds", "30"]).0, 0);
    assert!(
        refused(&["--recordings", text(folder.path()), "--only", "delay"]).contains("one recording tells no spread")
    );
    assert!(refused(&["--recordings", "tests", "--group", "nothing"]).contains("--group"));
}
