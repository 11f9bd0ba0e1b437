//! Laws of the mathematics, over any input that proptest finds.

use magcomp::nalgebra::{Matrix3, Unit, UnitQuaternion, Vector3, Vector4};
use magcomp::{
    Calibration, CalibrationError, Coverage, FitError, FitOptions, Moments, Normalisation, ReferenceAxis, Residual,
    ScreenRotation, fit_ellipsoid, heading, heading_sigma_deg, uniformity, window_length,
};
use magcomp_tests::{Random, difference};
use proptest::prelude::*;

/// Any double there is: NaN, infinite, denormal, huge.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        3 => -100.0..100.0,
        2 => any::<f64>(),
        2 => any::<u64>().prop_map(f64::from_bits),
        1 => prop::sample::select(vec![
            0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324, 1e154,
            -1e154, 1e-160, 1e300,
        ]),
    ]
}

fn any_vector() -> impl Strategy<Value = Vector3<f64>> {
    [any_number(), any_number(), any_number()].prop_map(Vector3::from)
}

fn vector(range: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-range..range, -range..range, -range..range].prop_map(Vector3::from)
}

/// Soft iron with eigenvalues of 0.5 to 1.6, turned any way; hard iron to 600 uT; 25 to 60 uT.
fn any_calibration() -> impl Strategy<Value = Calibration> {
    ([0.5..1.6, 0.5..1.6, 0.5..1.6], rotation(), vector(600.0), 25.0..60.0).prop_map(|(values, turn, b, field)| {
        let q = turn.to_rotation_matrix().into_inner();
        let m = q * Matrix3::from_diagonal(&Vector3::from(values)) * q.transpose();
        Calibration::new((m + m.transpose()) * 0.5, b, field).expect("a calibration")
    })
}

fn rotation() -> impl Strategy<Value = UnitQuaternion<f64>> {
    [-1.0..1.0, -1.0..1.0, -1.0..1.0, 0.05..1.0_f64]
        .prop_map(|v| UnitQuaternion::new_normalize(Vector4::from(v).into()))
}

/// With a known field, so that M keeps its scale; whatever coverage there is.
fn options(residual: Residual, field_ut: f64) -> FitOptions {
    FitOptions {
        residual,
        field_strength_ut: Some(field_ut),
        field_range_ut: (1.0, 1000.0),
        noise_floor_ut: 0.0,
        max_direction_sigma_deg: 90.0,
        ..FitOptions::default()
    }
}

const BOTH: [Residual; 2] = [Residual::Algebraic, Residual::Corrected];

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn correcting_undoes_distorting(c in any_calibration(), h in vector(70.0)) {
        prop_assert!((c.correct(&c.distort(&h)) - h).amax() < 1e-11);
        prop_assert!((c.distort(&c.correct(&h)) - h).amax() < 1e-11);
    }

    #[test]
    fn the_fit_of_distorted_points_is_the_distortion(c in any_calibration(), seed: u64, count in 30_usize..300) {
        let raw = Random::new(seed).raw(&c, 0.0, count);
        for residual in BOTH {
            let fit = fit_ellipsoid(&raw, &options(residual, c.field_strength_ut()));
            let fit = fit.map_err(|error| TestCaseError::fail(error.to_string()))?;
            prop_assert!(difference(&fit.calibration, &c) < 1e-8, "{}", difference(&fit.calibration, &c));
            prop_assert!(fit.residual_rms_ut < 1e-5);
            prop_assert!((fit.calibration.field_strength_ut() - c.field_strength_ut()).abs() < 1e-12);
        }
    }

    #[test]
    fn without_a_known_field_the_determinant_is_one(c in any_calibration(), seed: u64) {
        let raw = Random::new(seed).raw(&c, 0.3, 200);
        let free = FitOptions { field_strength_ut: None, ..options(Residual::Corrected, 1.0) };
        let fit = fit_ellipsoid(&raw, &free).map_err(|error| TestCaseError::fail(error.to_string()))?.calibration;
        prop_assert!((fit.soft_iron().determinant() - 1.0).abs() < 1e-12);
        let known = fit_ellipsoid(&raw, &options(Residual::Corrected, c.field_strength_ut()));
        let known = known.map_err(|error| TestCaseError::fail(error.to_string()))?.calibration;
        // the same ellipsoid: half axes M |h|
        let axes = fit.soft_iron() * fit.field_strength_ut() - known.soft_iron() * c.field_strength_ut();
        prop_assert!(axes.amax() < 1e-6 && (fit.hard_iron_ut() - known.hard_iron_ut()).amax() < 1e-6);
    }

    #[test]
    fn turning_the_samples_turns_the_fit(c in any_calibration(), turn in rotation(), seed: u64) {
        let raw = Random::new(seed).raw(&c, 0.5, 250);
        let turned: Vec<_> = raw.iter().map(|h| turn * h).collect();
        let q = turn.to_rotation_matrix().into_inner();
        for residual in BOTH {
            let options = options(residual, c.field_strength_ut());
            let (plain, turned) = (fit_ellipsoid(&raw, &options), fit_ellipsoid(&turned, &options));
            let plain = plain.map_err(|error| TestCaseError::fail(error.to_string()))?;
            let turned = turned.map_err(|error| TestCaseError::fail(error.to_string()))?;
            let m = q * plain.calibration.soft_iron() * q.transpose();
            prop_assert!((turned.calibration.soft_iron() - m).amax() < 1e-8);
            prop_assert!((turned.calibration.hard_iron_ut() - q * plain.calibration.hard_iron_ut()).amax() < 1e-6);
            prop_assert!((turned.residual_rms_ut / plain.residual_rms_ut - 1.0).abs() < 1e-6);
            prop_assert!((turned.axis_ratio / plain.axis_ratio - 1.0).abs() < 1e-8);
            prop_assert!((turned.direction_sigma_deg / plain.direction_sigma_deg - 1.0).abs() < 1e-6);
        }
    }

    #[test]
    fn the_order_of_the_samples_does_not_matter(c in any_calibration(), seed: u64, shift in 0_usize..200) {
        let raw = Random::new(seed).raw(&c, 0.5, 200);
        let (mut one, mut other) = (Moments::new(*c.hard_iron_ut(), 45.0), Moments::new(*c.hard_iron_ut(), 45.0));
        raw.iter().for_each(|h| one.add(h));
        raw.iter().cycle().skip(shift).take(200).for_each(|h| other.add(h));
        prop_assert_eq!(one, other);
    }

    #[test]
    fn samples_that_came_and_went_leave_no_bit(
        centre in vector(700.0),
        scale in 1.0..100.0,
        stay in prop::collection::vec(vector(2000.0), 1..40),
        go in prop::collection::vec(any_vector(), 1..200),
    ) {
        let mut moments = Moments::new(centre, scale);
        stay.iter().for_each(|h| moments.add(h));
        let before = moments.clone();
        go.iter().for_each(|h| moments.add(h));
        prop_assert_eq!(moments.count(), stay.len() + go.len());
        go.iter().rev().for_each(|h| moments.remove(h));
        prop_assert_eq!(moments, before);
    }

    #[test]
    fn the_gauge_is_idempotent(c in any_calibration(), turn in rotation()) {
        let (first, dropped) = Calibration::from_any(
            c.soft_iron() * turn.to_rotation_matrix().into_inner(), *c.hard_iron_ut(), c.field_strength_ut(),
        ).expect("invertible");
        prop_assert!((first.soft_iron() - c.soft_iron()).amax() < 1e-12);
        prop_assert!((dropped.matrix() - turn.to_rotation_matrix().matrix()).amax() < 1e-12);
        let (second, nothing) =
            Calibration::from_any(*first.soft_iron(), *first.hard_iron_ut(), first.field_strength_ut())
                .expect("invertible");
        prop_assert!((second.soft_iron() - first.soft_iron()).amax() < 1e-13);
        prop_assert!((nothing.matrix() - Matrix3::identity()).amax() < 1e-13);
        prop_assert_eq!(second.hard_iron_ut(), first.hard_iron_ut());
    }

    #[test]
    fn a_calibration_survives_json(c in any_calibration()) {
        let text = serde_json::to_string(&c).expect("finite");
        prop_assert_eq!(serde_json::from_str::<Calibration>(&text).expect("written here"), c);
    }

    #[test]
    fn sigma_t_does_not_depend_on_strength_or_order(seed: u64, strength in 0.01..1000.0) {
        let mut random = Random::new(seed);
        let directions: Vec<_> = (0..100).map(|_| random.direction()).collect();
        for normalisation in [Normalisation::HalfRange, Normalisation::EvenSphere] {
            let plain = uniformity(directions.iter().copied(), normalisation);
            let other = uniformity(directions.iter().rev().map(|h| h * strength), normalisation);
            prop_assert!((plain - other).abs() < 1e-12);
            let window = window_length(plain, 100, 2000);
            prop_assert!((100..=2000).contains(&window));
        }
    }

    #[test]
    fn a_heading_turns_with_the_device(
        attitude in rotation(), angle in 0.0..360.0, dip in -80.0..80.0_f64, tilted in 0.0..1.0_f64,
    ) {
        let (sin, cos) = dip.to_radians().sin_cos();
        let world = Vector3::new(0.0, cos, -sin) * (30.0 + tilted);
        // clockwise seen from above
        let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), -f64::to_radians(angle)) * attitude;
        for axis in [ReferenceAxis::TopEdge, ReferenceAxis::Camera, ReferenceAxis::Auto] {
            let at = |q: UnitQuaternion<f64>| {
                heading(&(q.inverse() * world), &(q.inverse() * Vector3::z()), axis, ScreenRotation::Deg0)
            };
            let (Some(one), Some(other)) = (at(attitude), at(turned)) else { continue };
            let off = (other.heading_deg - one.heading_deg - angle + 540.0).rem_euclid(360.0) - 180.0;
            prop_assert!(off.abs() < 1e-7, "{axis:?}: {off}");
            prop_assert!((one.inclination_deg.unwrap() - dip).abs() < 1e-9);
        }
    }
}

/// The determinant of huge numbers overflows, and with it the inverse.
#[test]
fn a_soft_iron_without_a_finite_inverse_is_refused() {
    let m = Matrix3::from_diagonal(&Vector3::new(4.5e227, 4.5e233, 1.8e229));
    assert!(matches!(Calibration::new(m, Vector3::zeros(), 50.0), Err(CalibrationError::SoftIron { .. })));
    assert!(Calibration::from_any(m, Vector3::zeros(), 50.0).is_err());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 2000, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn no_number_makes_a_calibration_panic(
        m in [any_vector(), any_vector(), any_vector()], b in any_vector(), field in any_number(), h in any_vector(),
    ) {
        let m = Matrix3::from_columns(&m);
        for calibration in [
            Calibration::new((m + m.transpose()) * 0.5, b, field).ok(),
            Calibration::new(m, b, field).ok(),
            Calibration::from_any(m, b, field).ok().map(|(calibration, _)| calibration),
        ].into_iter().flatten() {
            let numbers = nine_and_inverse(&calibration);
            prop_assert!(numbers.iter().all(|v| v.is_finite()), "{calibration:?}");
            let _ = (calibration.correct(&h), calibration.distort(&h));
        }
    }

    #[test]
    fn no_number_makes_a_heading_panic_or_nan(field in any_vector(), up in any_vector(), tilt in any_number()) {
        for axis in [ReferenceAxis::TopEdge, ReferenceAxis::Camera, ReferenceAxis::Auto] {
            for rotation in [ScreenRotation::Deg0, ScreenRotation::Deg270] {
                if let Some(found) = heading(&field, &up, axis, rotation) {
                    prop_assert!((0.0..360.0).contains(&found.heading_deg));
                    prop_assert!(found.inclination_deg.is_some_and(|dip_deg| (-90.0..=90.0).contains(&dip_deg)));
                }
                if let Some(sigma) = heading_sigma_deg(&field, &up, axis, rotation, &Matrix3::identity(), tilt) {
                    prop_assert!(sigma.is_finite());
                }
            }
        }
        prop_assert!(Coverage::cell(&field) < magcomp::CELLS);
    }

    #[test]
    fn no_number_makes_a_fit_panic_or_nan(
        points in prop::collection::vec(prop_oneof![4 => vector(60.0), 1 => any_vector()], 0..40),
        known in prop::option::of(1e-3..1e3),
        algebraic: bool,
    ) {
        let options = FitOptions {
            residual: if algebraic { Residual::Algebraic } else { Residual::Corrected },
            field_strength_ut: known,
            ..options(Residual::Corrected, 1.0)
        };
        let finite = points.iter().all(|p| p.iter().all(|v| v.is_finite()));
        match fit_ellipsoid(&points, &options) {
            Ok(fit) => {
                prop_assert!(finite && points.len() >= 9);
                prop_assert!(nine_and_inverse(&fit.calibration).iter().all(|v| v.is_finite()));
                prop_assert!(fit.covariance.iter().all(|v| v.is_finite()));
                prop_assert!(fit.residual_rms_ut.is_finite() && fit.direction_sigma_deg.is_finite());
                prop_assert!(fit.axis_ratio >= 1.0);
            }
            Err(FitError::TooFewSamples { have }) => prop_assert!(have < 9 && have == points.len()),
            Err(FitError::NotFinite) => prop_assert!(!finite || points.iter().any(|p| p.amax() > 1e70)),
            Err(FitError::Planar { thickness_ut: number } | FitError::FieldOutOfRange { field_ut: number, .. }) => {
                prop_assert!(!number.is_nan());
            }
            Err(FitError::PoorCoverage { direction_sigma_deg, .. }) => {
                prop_assert!((0.0..=180.0).contains(&direction_sigma_deg));
            }
            Err(FitError::Inconsistent { residual_ut, limit_ut }) => prop_assert!(residual_ut > limit_ut),
            Err(FitError::NotAnEllipsoid) => {}
        }
        let _ = uniformity(points.iter().copied(), Normalisation::HalfRange);
    }
}

fn nine_and_inverse(c: &Calibration) -> Vec<f64> {
    let mut numbers: Vec<f64> =
        c.soft_iron().iter().chain(c.soft_iron_inverse()).chain(c.hard_iron_ut()).copied().collect();
    numbers.push(c.field_strength_ut());
    numbers
}

#[test]
fn samples_in_one_plane_are_called_planar() {
    let mut random = Random::new(500);
    for _ in 0..100 {
        let normal = Unit::new_normalize(random.direction());
        let at = random.direction() * 300.0;
        // a circle, and a filled disc
        for filled in [false, true] {
            let points: Vec<_> = (0..200)
                .map(|_| {
                    let u = random.direction().cross(&normal).normalize() * 40.0;
                    at + u * if filled { random.between(0.2, 1.0) } else { 1.0 }
                })
                .collect();
            let found = fit_ellipsoid(&points, &FitOptions::default());
            assert!(matches!(found, Err(FitError::Planar { thickness_ut }) if thickness_ut < 1e-3), "{found:?}");
        }
    }
}
