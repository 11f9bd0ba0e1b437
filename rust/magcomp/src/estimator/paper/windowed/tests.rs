//! What happens to a window, sample by sample.

use super::*;
use crate::explanation::SampleUse;
use nalgebra::SMatrix;

const FIELD_UT: f64 = 50.0;

fn truth(hard_iron_ut: Vector3<f64>) -> Calibration {
    let soft_iron: Matrix3<f64> = Matrix3::new(1.1, 0.1, -0.05, 0.1, 0.9, 0.08, -0.05, 0.08, 1.05);
    Calibration::from_symmetric(soft_iron / soft_iron.determinant().cbrt(), hard_iron_ut, FIELD_UT).unwrap()
}

fn iron() -> Vector3<f64> {
    Vector3::new(30.0, -200.0, 80.0)
}

/// The k-th of directions that cover the sphere evenly, however many of them are taken in a row.
fn field_ut(k: i64) -> Vector3<f64> {
    let z = (0.754_877_67 * k as f64).rem_euclid(1.0) * 2.0 - 1.0;
    let (sin, cos) = (0.569_840_29 * std::f64::consts::TAU * k as f64).sin_cos();
    let flat = (1.0 - z * z).sqrt();
    Vector3::new(flat * cos, flat * sin, z) * FIELD_UT
}

/// Even within 1 uT either way.
fn noise_ut(k: i64) -> Vector3<f64> {
    Vector3::from_fn(|i, _| ((3 * k + i as i64 + 1) as f64 * 12.9898).sin() * 43_758.545_3 % 1.0)
}

fn config() -> WindowedConfig {
    WindowedConfig { n_min: 20, n_max: 60, noise_floor_ut: 0.0, ..WindowedConfig::default() }
}

fn push(windowed: &mut Windowed, k: i64, raw_ut: Vector3<f64>) -> (Status, Answer) {
    windowed.push(&MagneticSample { time_ns: k * 10_000_000, field_ut: raw_ut }, None)
}

/// One that has seen so many samples without noise.
fn after(samples: i64) -> Windowed {
    let mut windowed = Windowed::new(false, config(), None);
    (0..samples).for_each(|k| _ = push(&mut windowed, k, truth(iron()).distort(&field_ut(k))));
    windowed
}

#[test]
fn it_collects_n_min_samples_and_answers_with_the_next_window_of_16() {
    let mut windowed = Windowed::new(false, config(), None);
    assert_eq!(windowed.explain().sample, None);
    for k in 0..19 {
        let (status, answer) = push(&mut windowed, k, truth(iron()).distort(&field_ut(k)));
        assert_eq!(status, Status::Collecting(Missing::Samples { have: k as usize + 1, need: 20 }));
        assert_eq!((answer.field_ut, answer.field_covariance_ut2, answer.window), (None, None, k as usize + 1));
        assert_eq!(windowed.explain().phase, EstimatorPhase::Starting);
    }
    let (status, answer) = push(&mut windowed, 19, truth(iron()).distort(&field_ut(19)));
    assert_eq!((status, answer.sigma_t, answer.window), (Status::Tracking, None, 20));
    assert!((answer.field_ut.unwrap() - field_ut(19)).norm() < 1e-6);
    for k in 20..100 {
        let (status, answer) = push(&mut windowed, k, truth(iron()).distort(&field_ut(k)));
        // the fields are known: so is how even the latest twenty of them are
        let expected = super::super::uniformity::uniformity((k - 19..=k).map(field_ut), config().normalisation);
        assert!((answer.sigma_t.unwrap() - expected).abs() < 1e-6);
        assert_eq!(status, Status::Tracking);
        let length = window_length(expected, 20, 60).min(k as usize + 1);
        assert_eq!((answer.window, windowed.counted().samples), (length, length), "{k}");
        assert!((windowed.counted().through.unwrap().hard_iron_ut() - iron()).norm() < 1e-5);
    }
    let explained = windowed.explain();
    assert_eq!((explained.sample, explained.phase), (Some(SampleUse::Pooled), EstimatorPhase::Running));
    assert_eq!(explained.noise.white_ut, Some(windowed.fit().unwrap().residual_rms_ut));
}

/// Fields that point the same way: nothing is updated, and the window keeps its length.
#[test]
fn where_nothing_turns_the_window_stays() {
    let mut windowed = after(50);
    let raw_ut = truth(iron()).distort(&(Vector3::x() * FIELD_UT));
    (50..90).for_each(|k| _ = push(&mut windowed, k, raw_ut));
    let (window, fit) = (windowed.counted().samples, *windowed.fit().unwrap());
    assert!(window < 60);
    for k in 90..95 {
        let (status, answer) = push(&mut windowed, k, raw_ut);
        assert_eq!((status, answer.window), (Status::Held(HoldReason::LowUniformity), window));
        assert_eq!(*windowed.fit().unwrap(), fit);
    }
}

#[test]
fn the_constant_method_keeps_its_first_good_fit() {
    let mut windowed = Windowed::new(true, config(), None);
    for k in 0..40 {
        let (status, answer) = push(&mut windowed, k, truth(iron()).distort(&field_ut(k)));
        match k {
            0..19 => assert!(matches!(status, Status::Collecting(_))),
            19 => assert_eq!(status, Status::Tracking),
            _ => assert_eq!((status, answer.window), (Status::Held(HoldReason::Constant), 20)),
        }
    }
    assert_eq!(windowed.explain().sample, Some(SampleUse::Unused));
    // 2 uT of noise: sixty samples tell a direction to no degree, but there are no more than sixty
    let mut windowed = Windowed::new(true, config(), None);
    for k in 0..60 {
        let (status, _) = push(&mut windowed, k, truth(iron()).distort(&field_ut(k)) + noise_ut(k) * 3.6);
        assert_eq!(matches!(status, Status::Collecting(_)), k < 59, "{k}: {status:?}");
    }
    assert!(windowed.fit().unwrap().direction_sigma_deg > 1.0 && windowed.known().calibration.is_some());
}

/// J P J^T by finite differences, white noise through W, and 1.3 uT of a room's unevenness.
#[test]
fn the_covariance_of_an_answer_is_that_of_its_parts() {
    let mut windowed = Windowed::new(false, config(), None);
    (0..59).for_each(|k| _ = push(&mut windowed, k, truth(iron()).distort(&field_ut(k)) + noise_ut(k)));
    let raw_ut = truth(iron()).distort(&field_ut(59)) + noise_ut(59);
    let (_, answer) = push(&mut windowed, 59, raw_ut);
    let (fit, step) = (windowed.fit().unwrap(), 1e-6);
    let (m, b) = (fit.calibration.soft_iron(), fit.calibration.hard_iron_ut());
    let places = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
    let jacobian = SMatrix::<f64, 3, 9>::from_fn(|i, k| {
        let moved = |step: f64| {
            let (mut m, mut b) = (*m, *b);
            if k < 3 {
                b[k] += step;
            } else {
                let (row, column) = places[k - 3];
                m[(row, column)] += step;
                m[(column, row)] = m[(row, column)];
            }
            (m.try_inverse().unwrap() * (raw_ut - b))[i]
        };
        (moved(step) - moved(-step)) / (2.0 * step)
    });
    let w = m.try_inverse().unwrap();
    let expected = jacobian * fit.covariance * jacobian.transpose()
        + w * w.transpose() * fit.residual_rms_ut.powi(2)
        + Matrix3::identity() * (1.3 * 1.3);
    assert!((answer.field_covariance_ut2.unwrap() - expected).amax() < 1e-6);
    assert_eq!(answer.direction_sigma_deg, Some(fit.direction_sigma_deg));
}

/// A magnet is put on: it is suspected at once, the window is cut to N_min, and the new hard iron is found.
#[test]
fn a_change_within_the_window_cuts_it_to_its_latest_samples() {
    let mut windowed = after(60);
    let moved = truth(iron() + Vector3::new(60.0, -40.0, 30.0));
    let (mut suspected, mut shortest, mut refused) = (None, usize::MAX, false);
    for k in 60..160 {
        let (status, answer) = push(&mut windowed, k, moved.distort(&field_ut(k)));
        if let Status::Suspect { since_ns } = status {
            suspected.get_or_insert(since_ns);
            assert_eq!(Some(since_ns), suspected);
            assert_eq!(windowed.explain().phase, EstimatorPhase::Undecided);
        }
        refused |= matches!(windowed.state.refused, Some(FitError::Inconsistent { .. }));
        shortest = shortest.min(answer.window);
    }
    assert!(refused && suspected.is_some_and(|since_ns| (600_000_000..=620_000_000).contains(&since_ns)));
    assert_eq!(shortest, 20);
    assert!((windowed.known().calibration.unwrap().hard_iron_ut() - moved.hard_iron_ut()).norm() < 1e-3);
}

/// A fit that was refused is tried again ten samples later.
#[test]
fn a_refused_fit_is_tried_again_after_ten_samples() {
    let mut windowed = Windowed::new(false, config(), None);
    let flat = |k: i64| truth(iron()).distort(&Vector3::new((k as f64).cos(), (k as f64).sin(), 0.0).scale(FIELD_UT));
    let mut tries = Vec::new();
    for k in 0..60 {
        let (status, _) = push(&mut windowed, k, flat(k));
        assert_eq!(k >= 19, matches!(status, Status::Collecting(Missing::Fit(FitError::Planar { .. }))), "{k}");
        if k >= 19 && windowed.state.since_fit == 0 {
            tries.push(k);
        }
    }
    assert_eq!(tries, [19, 29, 39, 49, 59]);
}
