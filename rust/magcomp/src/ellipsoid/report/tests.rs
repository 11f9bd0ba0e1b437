//! Against finite differences, an even sphere and numbers by hand.

use super::*;
use crate::config::Residual;
use crate::ellipsoid::fit_ellipsoid;
use crate::math::symmetric::symmetric;
use nalgebra::{SVector, Vector6};

/// A repeatable number in [-1, 1].
fn draw(k: usize) -> f64 {
    ((k as f64 + 1.0) * 12.9898).sin() * 43_758.545_3 % 1.0
}

/// Twelve directions whose mean is that of the whole sphere for every polynomial of up to the fifth degree: the corners of an icosahedron.
fn corners() -> Vec<Vector3<f64>> {
    let golden = 0.5 * (1.0 + 5.0_f64.sqrt());
    let mut all = Vec::new();
    for (a, b) in [(1.0, golden), (1.0, -golden), (-1.0, golden), (-1.0, -golden)] {
        all.extend([Vector3::new(0.0, a, b), Vector3::new(a, b, 0.0), Vector3::new(b, 0.0, a)]);
    }
    all.into_iter().map(|it| it.normalize()).collect()
}

/// Six numbers' worth of a covariance, or nine.
fn covariance<const N: usize>(seed: usize) -> SMatrix<f64, N, N> {
    let root = SMatrix::<f64, N, N>::from_fn(|i, j| draw(seed + i * N + j));
    root * root.transpose()
}

#[test]
fn the_mean_square_angle_is_that_over_the_sphere() {
    let by_matrix: [Matrix3<f64>; 6] = std::array::from_fn(|k| Matrix3::from_fn(|i, j| draw(100 * k + 3 * i + j)));
    let by_centre = Matrix3::from_fn(|i, j| draw(700 + 3 * i + j));
    let (of_matrix, of_centre): (Matrix6<f64>, Matrix3<f64>) = (covariance(800), covariance(900));
    let mut expected = 0.0;
    for u in corners() {
        let across = Matrix3::identity() - u * u.transpose();
        let by = SMatrix::<f64, 3, 6>::from_columns(&by_matrix.map(|e| across * e * u));
        let by_centre = across * by_centre;
        expected += ((by * of_matrix * by.transpose()).trace()
            + (by_centre * of_centre * by_centre.transpose()).trace())
            / 12.0;
    }
    let found = mean_square_angle(&by_matrix, &of_matrix, &by_centre, &of_centre);
    assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
}

/// A calibration whose M and b are off by a little corrects a direction to another one.
#[test]
fn the_direction_sigma_is_that_of_corrected_samples() {
    let m = symmetric(&Vector6::new(1.1, 0.9, 1.05, 0.1, -0.05, 0.08));
    let (b, field_ut, step) = (Vector3::new(30.0, -200.0, 80.0), 48.0, 1e-6);
    let calibration = Calibration::from_symmetric(m, b, field_ut).unwrap();
    let of_ut = SVector::<f64, 9>::from([1.0, 1.0, 1.0, 0.01, 0.01, 0.01, 0.01, 0.01, 0.01]);
    let covariance = SMatrix::from_diagonal(&of_ut) * covariance::<9>(0) * SMatrix::from_diagonal(&of_ut);
    let mut mean = 0.0;
    for u in corners() {
        let raw_ut = m * u * field_ut + b;
        let by = SMatrix::<f64, 3, 9>::from_fn(|i, k| {
            let moved = |sign: f64| {
                let off = SVector::<f64, 9>::ith(k, sign * step);
                let m = m + symmetric(&off.fixed_rows::<6>(3).into_owned());
                (m.try_inverse().unwrap() * (raw_ut - b - off.fixed_rows::<3>(0))).normalize()
            };
            ((moved(1.0) - moved(-1.0)) / (2.0 * step))[i]
        });
        mean += (by * covariance * by.transpose()).trace() / 12.0;
    }
    let found = direction_sigma_deg(&calibration, &covariance);
    assert!((found / mean.sqrt().to_degrees() - 1.0).abs() < 1e-7, "{found} {}", mean.sqrt().to_degrees());
}

/// b and M of y = (A, A beta), as the module says, by a root of A of its own.
fn parameters(y: &SVector<f64, 9>, scale: f64, ratio: Option<f64>) -> SVector<f64, 9> {
    let a = symmetric(y);
    let eigen = a.symmetric_eigen();
    let root = eigen.eigenvalues.map(|it| 1.0 / it.sqrt());
    let half_axes = eigen.eigenvectors * Matrix3::from_diagonal(&root) * eigen.eigenvectors.transpose();
    let m = half_axes * ratio.unwrap_or(1.0 / half_axes.determinant().cbrt());
    let b = a.try_inverse().unwrap() * y.fixed_rows::<3>(6) * scale;
    let mut all = SVector::<f64, 9>::zeros();
    all.fixed_rows_mut::<3>(0).copy_from(&b);
    all.fixed_rows_mut::<6>(3).copy_from(&six(&m));
    all
}

#[test]
fn the_jacobian_is_that_of_finite_differences() {
    let y = SVector::<f64, 9>::from([1.3, 0.8, 1.1, 0.1, -0.2, 0.15, 0.3, -0.2, 0.25]);
    let roots = Roots::of(&symmetric(&y)).unwrap();
    let beta = symmetric(&y).try_inverse().unwrap() * y.fixed_rows::<3>(6);
    let scale = 47.0;
    for ratio in [None, Some(1.7)] {
        let step = 1e-5;
        let found = roots.parameter_jacobian(&beta, scale, ratio.unwrap_or(1.0 / roots.radius), ratio.is_none());
        for k in 0..9 {
            let moved = |sign: f64| parameters(&(y + SVector::ith(k, sign * step)), scale, ratio);
            let expected = (moved(1.0) - moved(-1.0)) / (2.0 * step);
            assert!((found.column(k) - expected).amax() < 1e-7, "{k} {ratio:?}: {} {expected}", found.column(k));
        }
    }
}

#[test]
fn a_flat_or_endless_shape_has_no_roots() {
    assert!(Roots::of(&Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, 0.0))).is_none());
    assert!(Roots::of(&Matrix3::from_diagonal(&Vector3::new(1.0, 2.0, f64::INFINITY))).is_none());
    let roots = Roots::of(&Matrix3::from_diagonal(&Vector3::new(4.0, 1.0, 0.25))).unwrap();
    assert!((roots.axis_ratio - 4.0).abs() < 1e-12 && (roots.radius - 1.0).abs() < 1e-12);
}

/// Samples of an ellipsoid with noise of about 1 uT, all about or of one side.
fn samples(one_side: bool, noise_ut: f64) -> Vec<Vector3<f64>> {
    let m = symmetric(&Vector6::new(1.1, 0.9, 1.05, 0.1, -0.05, 0.08));
    let point = |k: usize| {
        let z = if one_side { 0.6 + 0.4 * draw(7 * k).abs() } else { draw(7 * k) };
        let (sin, cos) = (f64::from(k as u32) * 2.4).sin_cos();
        let flat = (1.0 - z * z).sqrt();
        let noise = Vector3::new(draw(7 * k + 1), draw(7 * k + 2), draw(7 * k + 3)) * noise_ut;
        m * Vector3::new(flat * cos, flat * sin, z) * 50.0 + Vector3::new(30.0, -200.0, 80.0) + noise
    };
    (0..300).map(point).collect()
}

/// Samples without noise were read to a last bit all the same.
#[test]
fn nothing_is_exactly_known() {
    let fit = fit_ellipsoid(&samples(false, 0.0), &FitOptions::default()).unwrap();
    let noisy = fit_ellipsoid(&samples(false, 1.0), &FitOptions::default()).unwrap();
    assert!(fit.residual_rms_ut < 1e-5 && noisy.residual_rms_ut > LAST_BIT_UT);
    let share = LAST_BIT_UT / noisy.residual_rms_ut;
    let ratio = fit.direction_sigma_deg / (noisy.direction_sigma_deg * share);
    assert!((ratio - 1.0).abs() < 0.1, "{ratio}");
    let expected_deg = direction_sigma_deg(&fit.calibration, &fit.covariance);
    assert!((fit.direction_sigma_deg / expected_deg - 1.0).abs() < 1e-12);
}

#[test]
fn the_limits_of_a_fit_are_its_own_figures() {
    let points = samples(false, 1.0);
    let free = FitOptions { noise_floor_ut: 0.0, max_residual_share: 1.0, ..FitOptions::default() };
    let fit = fit_ellipsoid(&points, &free).unwrap();
    // of the covariance that is reported beside it
    let sigma_deg = direction_sigma_deg(&fit.calibration, &fit.covariance);
    assert!((fit.direction_sigma_deg / sigma_deg - 1.0).abs() < 1e-12);
    let (noise_ut, field_ut) = (fit.residual_rms_ut, fit.calibration.field_strength_ut());
    let with = |options| fit_ellipsoid(&points, &options).map(|_| ());

    let sigma_limit = |share: f64| FitOptions { max_direction_sigma_deg: share * sigma_deg, ..free };
    assert_eq!(with(sigma_limit(1.001)), Ok(()));
    let Err(FitError::PoorCoverage { direction_sigma_deg, limit_deg }) = with(sigma_limit(0.999)) else { panic!() };
    assert!((direction_sigma_deg / sigma_deg - 1.0).abs() < 1e-9 && limit_deg == 0.999 * sigma_deg);

    // noise that is assumed at the least
    let floor = |share: f64| FitOptions { noise_floor_ut: 3.0 * noise_ut, ..sigma_limit(share) };
    assert_eq!(with(floor(3.001)), Ok(()));
    assert!(matches!(with(floor(2.999)), Err(FitError::PoorCoverage { .. })));

    let residual_limit = |share: f64| FitOptions { max_residual_share: share * noise_ut / field_ut, ..free };
    assert_eq!(with(residual_limit(1.001)), Ok(()));
    let Err(FitError::Inconsistent { residual_ut, limit_ut }) = with(residual_limit(0.999)) else { panic!() };
    assert!((residual_ut / noise_ut - 1.0).abs() < 1e-9 && (limit_ut / (0.999 * noise_ut) - 1.0).abs() < 1e-9);

    let range = |low_ut, high_ut| with(FitOptions { field_range_ut: (low_ut, high_ut), ..free });
    assert_eq!(range(field_ut - 0.01, field_ut + 0.01), Ok(()));
    assert!(matches!(range(field_ut + 0.01, 60.0), Err(FitError::FieldOutOfRange { .. })));
    assert!(matches!(range(22.0, field_ut - 0.01), Err(FitError::FieldOutOfRange { .. })));
}

#[test]
fn with_a_known_strength_the_soft_iron_carries_the_scale() {
    let points = samples(false, 0.0);
    let of = |field_strength_ut| {
        let options = FitOptions { residual: Residual::Algebraic, field_strength_ut, ..FitOptions::default() };
        fit_ellipsoid(&points, &options).unwrap().calibration
    };
    let (own, known) = (of(None), of(Some(40.0)));
    let expected = own.soft_iron() * (own.field_strength_ut() / 40.0);
    assert!((known.soft_iron() - expected).amax() < 1e-9 && known.field_strength_ut() == 40.0);
}

/// Corners of a box: the standard deviations are its half sides.
#[test]
fn a_cloud_is_planar_where_it_is_thin_beside_its_width_or_the_noise() {
    let why = |thick_ut: f64, noise_ut: f64| {
        let mut moments = Moments::new(Vector3::new(5.0, 5.0, 5.0), 20.0);
        for k in 0..8 {
            let sign = |bit: usize| if k >> bit & 1 == 0 { -1.0 } else { 1.0 };
            moments.add(&Vector3::new(50.0 * sign(0) + 10.0, 30.0 * sign(1) - 20.0, thick_ut * sign(2) + 7.0));
        }
        let why = moments.why_no_ellipsoid(noise_ut);
        let FitError::Planar { thickness_ut } = why else { return why == FitError::NotAnEllipsoid };
        assert!((thickness_ut - thick_ut).abs() < 1e-6, "{thickness_ut}");
        assert!(matches!(moments.poorly_covered(20.0, noise_ut, &FitOptions::default()), FitError::Planar { .. }));
        false
    };
    // 1 % of 50 uT; three times 2 uT
    assert!(!why(0.49, 0.0) && why(0.51, 0.0) && !why(5.9, 2.0) && why(6.1, 2.0));
}

#[test]
fn poor_coverage_names_half_a_turn_at_the_most() {
    let points = samples(true, 0.0);
    let poor = Moments::of(&points).poorly_covered(f64::INFINITY, 0.0, &FitOptions::default());
    assert_eq!(poor, FitError::PoorCoverage { direction_sigma_deg: 180.0, limit_deg: 10.0 });
}
