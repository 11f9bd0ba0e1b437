//! One step by hand, and its limits from both sides.

use super::*;
use crate::estimator::aided::state::{CALIBRATION, Filter, HARD_IRON};
use nalgebra::Rotation3;

const DT_S: f64 = 0.02;

fn close(found: f64, expected: f64) -> bool {
    (found - expected).abs() < 1e-12 * expected.abs().max(1.0)
}

/// b, and M - I.
fn parts() -> (Parts, Matrix3<f64>) {
    let mut filter = Filter::default();
    let mut all = filter.part(CALIBRATION);
    all.copy_from_slice(&[100.0, -40.0, 20.0, 0.1, -0.05, 0.02, 0.03, -0.02, 0.01]);
    filter.set_part(CALIBRATION, &all);
    assert_eq!(filter.part(HARD_IRON), Vector3::new(100.0, -40.0, 20.0));
    (filter.parts(), Matrix3::new(1.1, 0.03, -0.02, 0.03, 0.95, 0.01, -0.02, 0.01, 1.02))
}

/// Two samples of one field, the turn between in two steps with a sample that says nothing: what they differ by beyond that is noise, of two samples and
/// three axes, and is believed up to nine times what is believed.
#[test]
fn noise_is_what_samples_differ_by_beyond_the_turn() {
    let tuning = Tuning::default();
    let (x, m) = parts();
    let field_ut = Vector3::new(20.0, 5.0, -45.0);
    let [first, second] =
        [Vector3::new(0.3, -0.2, 0.1), Vector3::new(-0.1, 0.4, 0.2)].map(|it| *Rotation3::new(it).matrix());
    let at = |turn: Matrix3<f64>| m * turn * field_ut + x.hard_iron;
    let share = DT_S / tuning.memory_s;
    let start_ut2 = tuning.noise_start_ut.powi(2);
    for (off_ut, seen) in
        [(0.0, 0.0), (1.2, 1.44 / 6.0), (3.67, 3.67 * 3.67 / 6.0), (3.68, 9.0 * start_ut2), (50.0, 9.0 * start_ut2)]
    {
        let mut white = White::new(&tuning);
        white.step(Some(&at(Matrix3::identity())), &x, &Matrix3::identity(), DT_S, tuning.memory_s, &tuning);
        assert_eq!(white.variance_ut2, start_ut2);
        white.step(None, &x, &first, DT_S, tuning.memory_s, &tuning);
        let raw_ut = at(second * first) + Vector3::new(0.6, 0.0, -0.8) * off_ut;
        white.step(Some(&raw_ut), &x, &second, DT_S, tuning.memory_s, &tuning);
        let expected = start_ut2 + share * (seen - start_ut2);
        assert!(close(white.variance_ut2, expected), "{off_ut}: {} for {expected}", white.variance_ut2);
        assert_eq!(white.previous, Some((raw_ut, None)));
    }
}

#[test]
fn noise_is_learned_at_most_at_once_and_never_less_than_the_least() {
    let tuning = Tuning::default();
    let (x, _) = parts();
    let mut white = White::new(&tuning);
    for _ in 0..2 {
        white.step(Some(&Vector3::x()), &x, &Matrix3::identity(), 5.0 * tuning.memory_s, tuning.memory_s, &tuning);
    }
    assert!(close(white.variance_ut2, 0.04), "{}", white.variance_ut2);
}

#[test]
fn samples_and_means_of_frames_are_learned_apart() {
    let tuning = Tuning::default();
    let x = Filter::default().parts();
    let (mut of_samples, mut of_means) = (White::new(&tuning), White::new(&tuning));
    let one = Matrix3::identity();
    for k in 0..2 {
        of_samples.step(Some(&Vector3::repeat(f64::from(k))), &x, &one, DT_S, tuning.memory_s, &tuning);
        of_means.step(Some(&Vector3::zeros()), &x, &one, DT_S, tuning.settled_s, &tuning);
    }
    let start = tuning.noise_start_ut.powi(2);
    // |(1, 1, 1)|^2 / 6; the means are all zero
    let sample = start + DT_S / tuning.memory_s * (0.5 - start);
    let mean = start * (1.0 - DT_S / tuning.settled_s);
    assert!(close(of_samples.variance_ut2(), sample) && close(of_means.variance_ut2(), mean));
}
