//! No output overwrites an input or another output.

use crate::{field, logged, run_in};
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};

/// All files below a folder, with their content.
pub(crate) fn content(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() && !path.is_symlink() {
            found.extend(content(&path));
        } else {
            found.insert(path.clone(), fs::read(&path).unwrap_or_default());
        }
    }
    found
}

/// Ways to name a place in F, which is read.
const INSIDE: [&str; 12] = [
    "F/TotalAcceleration.csv",
    "F/new.csv",
    "F/deep/new.csv",
    "F",
    "link/new.csv",
    "link/TotalAcceleration.csv",
    "file_link.csv",
    "other/../F/new.csv",
    "into/../new.csv",
    "into/new.csv",
    "./F/./new.csv",
    "F/none/new.csv",
];

#[test]
fn no_output_goes_into_the_session_or_onto_another_output() {
    let place = tempfile::tempdir().unwrap();
    let path = |name: &str| place.path().join(name);
    fs::create_dir_all(path("F/deep")).unwrap();
    fs::create_dir(path("other")).unwrap();
    let (m, a) = (field(30), logged(30, |_| [0.0, 0.0, 9.8]));
    fs::write(path("F/MagnetometerUncalibrated.csv"), &m).unwrap();
    fs::write(path("F/TotalAcceleration.csv"), &a).unwrap();
    fs::write(path("r.csv"), "t_s,mx,my,mz\n0,1,2,3\n0.01,1,2,3\n").unwrap();
    symlink(path("F"), path("link")).unwrap();
    symlink("F/TotalAcceleration.csv", path("file_link.csv")).unwrap();
    symlink("F", path("other/up")).unwrap();
    symlink(path("F/deep"), path("into")).unwrap();
    let before = content(place.path());
    let refuse = |arguments: &[&str], why: &str| {
        let (code, out, error) = run_in(place.path(), arguments);
        assert!(code == Some(2) && out.is_empty() && error.lines().count() == 1, "{arguments:?}: {code:?} {error}");
        assert!(error.contains(why), "{arguments:?}: {error}");
        assert_eq!(content(place.path()), before, "{arguments:?}");
    };
    for output in INSIDE {
        for input in ["F", "link", "other/../F"] {
            refuse(&["import", input, "-o", output], "in the input");
            refuse(&["replay", input, "--output", output], "in the input");
            refuse(&["replay", input, "--explain", output], "in the input");
        }
        refuse(&["replay", "F", "--calibration", output], "--calibration");
    }
    for verb in ["replay", "compare"] {
        refuse(&[verb, "F", "--report", "F/pages"], "--report F/pages lies in the input F");
        refuse(&[verb, "F", "--report", "link"], "--report link lies in the input F");
    }
    refuse(&["import", "F", "-o", "out.csv", "--report", "F"], "--report F lies in the input F");
    // two outputs
    refuse(&["replay", "r.csv", "--output", "x.csv", "--calibration", "other/../x.csv"], "is --output too");
    refuse(&["replay", "r.csv", "--output", "x.csv", "--explain", "other/../x.csv"], "is --output too");
    for output in ["pages/index.html", "pages/replay_sphere.svg"] {
        refuse(&["replay", "r.csv", "--output", output, "--report", "pages"], "may be a page of --report");
        refuse(&["simulate", output, "--seconds", "1", "--report", "pages"], "may be a page of --report");
    }
    // a folder beside it, and one whose name only begins alike, are fine
    fs::create_dir(path("F2")).unwrap();
    for output in ["F2/out.csv", "out.csv", "/dev/null"] {
        assert_eq!(run_in(place.path(), &["import", "F", "-o", output]).0, Some(0), "{output}");
    }
    assert_eq!(run_in(place.path(), &["replay", "F", "--output", "/dev/null", "--report", "pages"]).0, Some(0));
}
