//! One step of each learner by hand, and its limits from both sides.

use super::*;
use crate::estimator::aided::propagate::ProcessNoise;

const DT_S: f64 = 0.02;
const NOTHING: Vector3<f64> = Vector3::new(0.0, 0.0, 0.0);

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 1e-12 * expected.abs().max(1.0)
}

/// Noise of which only the local field matters.
fn noise(local_ut: f64) -> ProcessNoise {
    ProcessNoise { bridged_rad2: 0.0, offset_ut: 0.0, local_ut, local_time_s: 1.0 }
}

/// c and f differ by a constant: every low-pass ends there.
#[test]
fn a_steady_unevenness_is_seen_in_full() {
    let tuning = Tuning::default();
    let mut adaptation = Adaptation::new(&tuning);
    let off_ut = Vector3::new(2.0, -1.0, 2.0);
    for _ in 0..4_000 {
        adaptation.add_difference(&off_ut, DT_S, &tuning);
    }
    // 3 uT^2 an axis; of what has lasted 1 + 2.5 s / 1.5 s as much is expected
    let lasts = 1.0 + tuning.lasting_s / tuning.place_correlation_s;
    let uneven_ut2 = 3.0 * lasts;
    assert!((adaptation.uneven_ut2(&tuning) / uneven_ut2 - 1.0).abs() < 1e-9);
    let unexplained = uneven_ut2 - tuning.local_most_ut.powi(2);
    assert!((adaptation.floor_ut2(&tuning) - uneven_ut2 - unexplained).abs() < 1e-6);
    // white noise alone would leave some of it in the quick one
    let quick = DT_S / tuning.quick_s;
    let white = 0.25 * quick / (2.0 - quick);
    assert!((adaptation.slow_power_ut2 - (3.0 - white)).abs() < 1e-3, "{}", adaptation.slow_power_ut2);
    assert_eq!(adaptation.largest_local_ut2(&tuning), tuning.local_most_ut.powi(2));
    for (noise_ut2, expected) in [(1.0, 2.0), (4.0, 0.0)] {
        assert!((adaptation.local_ut2(noise_ut2, &tuning) - expected).abs() < 1e-3);
    }
    assert!((adaptation.unaveraged_ut2(&tuning) - 2.0 * (uneven_ut2 - tuning.even_ut.powi(2))).abs() < 1e-6);
    // the densities' ratio, where the filter expects 0.5 uT, and 20
    let density = |local_ut2: f64| 2.0 * tuning.place_correlation_s * local_ut2 + 0.25 * DT_S;
    let expected = density(uneven_ut2) / density(0.25);
    assert!((adaptation.factor(&noise(0.5), DT_S, &tuning) / expected - 1.0).abs() < 1e-6);
    assert_eq!(adaptation.factor(&noise(20.0), DT_S, &tuning), 1.0);
    // what was followed fades by e in five seconds, while nothing is uneven
    let before = adaptation.followed_power_ut2;
    let mut faded = adaptation.clone();
    (faded.slow_power_ut2, faded.lasting_ut, faded.slow_ut) = (0.0, NOTHING, NOTHING);
    faded.add_difference(&NOTHING, DT_S, &tuning);
    assert!(close(faded.followed_power_ut2, before * (-DT_S / tuning.settled_s).exp()));
}

/// Of the first of all: the mean is plain, and one value counts as nine times what was believed at most.
#[test]
fn unevenness_is_a_plain_mean_at_first_and_then_of_five_seconds() {
    let tuning = Tuning::default();
    let off_ut = Vector3::new(30.0, 0.0, 0.0);
    let mut adaptation = Adaptation::new(&tuning);
    adaptation.add_difference(&off_ut, DT_S, &tuning);
    let before = tuning.even_ut.powi(2);
    let share = DT_S / (tuning.quick_s + DT_S);
    assert!(close(adaptation.power_ut2, before + share * (9.0 * before - before)), "{}", adaptation.power_ut2);
    assert!(close(adaptation.lasting_ut.x, 30.0 * DT_S / tuning.lasting_s));
    assert!(close(adaptation.slow_age_s, tuning.quick_s + DT_S));
    adaptation.slow_age_s = 100.0;
    let before = adaptation.power_ut2;
    adaptation.add_difference(&NOTHING, DT_S, &tuning);
    assert!(close(adaptation.power_ut2, before * (1.0 - DT_S / tuning.settled_s)));
}
