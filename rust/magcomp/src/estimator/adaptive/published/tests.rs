//! Against M, b and corrected samples written out, and finite differences of them.

use super::super::parameters::{Tau, TauMatrix};
use super::*;
use crate::math::symmetric::symmetric;
use nalgebra::SVector;

const UNIT_UT: f64 = 45.0;

fn tau() -> Tau {
    Tau::from_column_slice(&[1.1, 0.9, 1.05, 0.07, -0.04, 0.06, 0.3, -0.5, 0.8, 0.2])
}

fn published(strength_ut: Option<f64>) -> Published {
    let root = TauMatrix::from_fn(|i, j| ((i * 5 + j * 3) as f64).sin()) * 0.01;
    Published::new(Gaussian { mean: tau(), covariance: root * root.transpose() }, UNIT_UT, strength_ut)
}

/// b and M of tau.
fn parameters(tau: &Tau, strength_ut: Option<f64>) -> SVector<f64, 9> {
    let half_axes = symmetric(tau).try_inverse().unwrap();
    let m = half_axes * strength_ut.map_or_else(|| 1.0 / half_axes.determinant().cbrt(), |it| UNIT_UT / it);
    let b = tau.fixed_rows::<3>(6) * UNIT_UT;
    let mut all = SVector::<f64, 9>::zeros();
    all.fixed_rows_mut::<3>(0).copy_from(&b);
    all.fixed_rows_mut::<6>(3).copy_from(&six(&m));
    all
}

#[test]
fn the_calibration_is_that_of_the_parameters_and_its_covariance_that_of_their_derivatives() {
    for strength_ut in [None, Some(48.0)] {
        let published = published(strength_ut);
        let calibration = published.calibration().unwrap();
        let expected = parameters(&tau(), strength_ut);
        let mut found = SVector::<f64, 9>::zeros();
        found.fixed_rows_mut::<3>(0).copy_from(calibration.hard_iron_ut());
        found.fixed_rows_mut::<6>(3).copy_from(&six(calibration.soft_iron()));
        assert!((found - expected).amax() < 1e-12, "{found}");
        let own_ut = UNIT_UT / symmetric(&tau()).determinant().cbrt();
        assert!((calibration.field_strength_ut() - strength_ut.unwrap_or(own_ut)).abs() < 1e-9);
        let jacobian = SMatrix::<f64, 9, 9>::from_fn(|i, k| {
            let moved = |sign: f64| parameters(&(tau() + Tau::ith(k, sign * 1e-5)), strength_ut)[i];
            (moved(1.0) - moved(-1.0)) / 2e-5
        });
        let of_tau = published.known.covariance.fixed_view::<9, 9>(0, 0);
        let expected = jacobian * of_tau * jacobian.transpose();
        assert!((published.covariance().unwrap() - expected).amax() < 1e-8 * expected.amax());
    }
}

/// A corrected sample, uT, of tau.
fn corrected(tau: &Tau, strength_ut: Option<f64>, u: &Vector3<f64>) -> Vector3<f64> {
    let t = symmetric(tau);
    let size = strength_ut.unwrap_or_else(|| UNIT_UT / t.determinant().cbrt());
    t * (u - tau.fixed_rows::<3>(6)) * size
}

#[test]
fn a_corrected_sample_has_the_errors_of_the_parameters_and_of_what_it_misses_by() {
    let centre = Vector3::new(0.3, -0.5, 0.8);
    let on_it = centre + symmetric(&tau()).try_inverse().unwrap() * Vector3::new(0.6, 0.0, -0.8);
    for strength_ut in [None, Some(48.0)] {
        let published = published(strength_ut);
        let size = corrected(&tau(), strength_ut, &on_it).norm();
        let covariance = |u: &Vector3<f64>, noise: f64, across: f64| {
            let jacobian = SMatrix::<f64, 3, 10>::from_fn(|i, k| {
                let moved = |sign: f64| corrected(&(tau() + Tau::ith(k, sign * 1e-5)), strength_ut, u)[i];
                (moved(1.0) - moved(-1.0)) / 2e-5
            });
            let of_noise = symmetric(&tau()) * symmetric(&tau()) * noise + Matrix3::identity() * across;
            jacobian * published.known.covariance * jacobian.transpose() + of_noise * (size * size)
        };
        let (noise, elsewhere) = (1e-4, 3e-4);
        let (field_ut, found) = published.correct(&on_it, noise, elsewhere).unwrap();
        assert!((field_ut - Vector3::new(0.6, 0.0, -0.8) * size).norm() < 1e-9);
        assert!((published.calibration().unwrap().correct(&(on_it * UNIT_UT)) - field_ut).norm() < 1e-9);
        assert!((found - covariance(&on_it, noise, elsewhere)).amax() < 1e-6);
        // half as long again: nothing that is known explains it
        let off = centre + (on_it - centre) * 1.5;
        let (field_ut, found) = published.correct(&off, noise, elsewhere).unwrap();
        assert!((field_ut - Vector3::new(0.6, 0.0, -0.8) * (1.5 * size)).norm() < 1e-9);
        assert!((found - covariance(&off, noise, 0.25)).amax() < 1e-6);
        // with so much noise it is explained: four standard deviations are the limit
        let (_, found) = published.correct(&off, 0.1, elsewhere).unwrap();
        assert!((found - covariance(&off, 0.1, elsewhere)).amax() < 1e-6);
    }
}

#[test]
fn the_worst_error_is_the_largest_variance_along_any_direction() {
    let mut covariance = TauMatrix::identity() * 0.01;
    covariance.fixed_view_mut::<2, 2>(0, 0).copy_from(&nalgebra::Matrix2::new(0.05, 0.03, 0.03, 0.05));
    covariance[(9, 9)] = 1.0;
    let published = Published::new(Gaussian { mean: tau(), covariance }, UNIT_UT, None);
    assert!((published.worst() - 0.08).abs() < 1e-12 && published.error == published.known.error());
}
