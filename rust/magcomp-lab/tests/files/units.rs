//! Lively numbers are no other unit.

use crate::{field, folder, imported, logged, run_in};
use std::fmt::Write as _;

/// Sizes of a run's acceleration, m/s^2: a fifth is below 16, half below 23.
fn of_a_run(k: usize) -> f64 {
    8.0 + (k % 100) as f64 * 0.3
}

#[test]
fn a_run_is_no_other_unit() {
    let rows = |unit: f64| {
        let mut text = "t_s,mx,my,mz,ax,ay,az\n".to_owned();
        for k in 0..400 {
            writeln!(text, "{},20,{},-40,0,0,{}", k as f64 / 100.0, k % 5, of_a_run(k) * unit).unwrap();
        }
        text
    };
    let folder = folder(&[
        ("run.csv", rows(1.0).as_bytes()),
        ("rest.csv", rows(0.5).as_bytes()),
        ("run_in_g.csv", rows(1.0 / 9.80665).as_bytes()),
        ("run_in_mg.csv", rows(1e3 / 9.80665).as_bytes()),
        ("linear.csv", rows(0.002).as_bytes()),
    ]);
    let replay = |name: &str, more: &[&str]| run_in(folder.path(), &[&["replay", name], more].concat());
    let (code, _, error) = replay("run.csv", &[]);
    assert_eq!(code, Some(0), "{error}");
    assert!(
        error.starts_with("magcomp: warning: run.csv: acceleration is mostly 23.") && error.lines().count() == 1,
        "{error}"
    );
    assert_eq!(replay("rest.csv", &[]).2, "");
    // held as phones are, but with Apple's sign
    let (code, _, error) = replay("rest.csv", &["--units", "a=-m/s2"]);
    assert!(code == Some(0) && error.contains("the screen faced down nearly all the time"), "{error}");
    // the units that occur are told apart, however lively it is
    let (code, _, error) = replay("run_in_g.csv", &[]);
    assert!(code == Some(1) && error.contains("looks like g: --units a=g, or a=-g for Apple's sign"), "{error}");
    assert_eq!(replay("run_in_g.csv", &["--units", "a=g"]).0, Some(0));
    for (name, hint) in [("run_in_mg.csv", "mostly 23"), ("linear.csv", "is it an acceleration without gravity?")] {
        let (code, _, error) = replay(name, &[]);
        assert!(code == Some(1) && error.contains(hint), "{error}");
    }
    // an iPhone's run in g with Apple's sign
    let apple = logged(400, |k| [0.0, 0.0, -of_a_run(k) / 6.0]);
    let session = self::folder(&[
        ("MagnetometerUncalibrated.csv", field(400).as_bytes()),
        ("AccelerometerUncalibrated.csv", apple.as_bytes()),
    ]);
    let (text, _) = imported(session.path(), ".", &[]);
    let up: f64 = text.lines().nth(1).unwrap().split(',').nth(6).unwrap().parse().unwrap();
    assert!((up - 8.0 / 6.0 * 9.80665).abs() < 1e-9, "{up}");
}
