use super::*;
use crate::ellipsoid::{FitError, FitOptions};

#[test]
fn scatter_is_the_sum_of_outer_products() {
    let points: Vec<Vector3<f64>> = (0..40)
        .map(|k| {
            let k = f64::from(k);
            Vector3::new(600.0 + 50.0 * (k * 1.3).sin(), -400.0 + 45.0 * (k * 0.7).cos(), 40.0 * (k * 2.1).sin())
        })
        .collect();
    let moments = Moments::of(&points);
    let (s, n) = moments.scatter();
    let mut s_direct = SMatrix::<f64, 10, 10>::zeros();
    let mut n_direct = SMatrix::<f64, 10, 10>::zeros();
    for p in &points {
        let u = (p - moments.centre_ut()) / moments.scale_ut();
        let (x, y, z) = (u.x, u.y, u.z);
        let d = SMatrix::<f64, 10, 1>::from_column_slice(&[
            x * x,
            y * y,
            z * z,
            2.0 * x * y,
            2.0 * x * z,
            2.0 * y * z,
            x,
            y,
            z,
            1.0,
        ]);
        s_direct += d * d.transpose();
        let mut g = SMatrix::<f64, 10, 3>::zeros();
        for (i, row) in [
            [2.0 * x, 0.0, 0.0],
            [0.0, 2.0 * y, 0.0],
            [0.0, 0.0, 2.0 * z],
            [2.0 * y, 2.0 * x, 0.0],
            [2.0 * z, 0.0, 2.0 * x],
            [0.0, 2.0 * z, 2.0 * y],
            [1.0, 0.0, 0.0],
            [0.0, 1.0, 0.0],
            [0.0, 0.0, 1.0],
        ]
        .iter()
        .enumerate()
        {
            g.set_row(i, &nalgebra::RowVector3::from_row_slice(row));
        }
        let mut c = SMatrix::<f64, 10, 1>::zeros();
        c.fixed_rows_mut::<3>(0).fill(1.0);
        n_direct += g * g.transpose() + d * c.transpose() + c * d.transpose();
    }
    let count = points.len() as f64;
    assert!((s - s_direct / count).abs().max() < 1e-13);
    assert!((n - n_direct / count).abs().max() < 1e-13);
}

#[test]
fn a_sample_that_is_not_finite_blocks_the_fit_until_it_leaves() {
    let mut moments = Moments::new(Vector3::zeros(), 50.0);
    for k in 0..200 {
        let (a, b) = (f64::from(k) * 1.1, f64::from(k) * 0.37);
        moments.add(&(Vector3::new(a.cos() * b.cos(), a.sin() * b.cos(), b.sin()) * 50.0));
    }
    let bad = Vector3::new(f64::NAN, 1.0, f64::INFINITY);
    moments.add(&bad);
    assert_eq!(moments.fit(&FitOptions::default()), Err(FitError::NotFinite));
    moments.remove(&bad);
    assert!(moments.fit(&FitOptions::default()).is_ok());
}

#[test]
fn adding_and_removing_is_exact() {
    let mut moments = Moments::new(Vector3::new(600.0, -550.0, 420.0), 50.0);
    moments.add(&Vector3::new(612.3, -561.7, 399.1));
    let before = moments.clone();
    for k in 0..1000 {
        let k = f64::from(k);
        moments.add(&Vector3::new(600.0 + k, -2000.0 + 3.7 * k, 1.0 / (k + 0.3)));
    }
    for k in 0..1000 {
        let k = f64::from(k);
        moments.remove(&Vector3::new(600.0 + k, -2000.0 + 3.7 * k, 1.0 / (k + 0.3)));
    }
    assert_eq!(moments, before);
}

/// By hand: four points, 3, 3, 4 and 4 from their mean.
#[test]
fn a_slice_is_centred_on_its_mean_and_scaled_by_its_spread() {
    let mean = Vector3::new(100.0, -20.0, 5.0);
    let points = [Vector3::x() * 3.0, Vector3::x() * -3.0, Vector3::y() * 4.0, Vector3::y() * -4.0].map(|it| it + mean);
    let moments = Moments::of(&points);
    assert!((moments.centre_ut() - mean).norm() < 1e-12 && (moments.scale_ut() - 12.5_f64.sqrt()).abs() < 1e-12);
    let expected = Matrix3::from_diagonal(&Vector3::new(4.5, 8.0, 0.0));
    assert!((moments.cloud_covariance_ut2() - expected).amax() < 1e-9);
    // about another centre it is the same
    let mut moments = Moments::new(mean + Vector3::new(7.0, -3.0, 2.0), 11.0);
    points.iter().for_each(|point| moments.add(point));
    assert!((moments.cloud_covariance_ut2() - expected).amax() < 1e-9);
    assert_eq!(Moments::of(&points[..1]).scale_ut(), 1.0);
}
