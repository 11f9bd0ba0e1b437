//! Against exact ellipsoids, a least-squares fit by a decomposition of all rows, and the constraint itself.

use super::*;
use nalgebra::{DMatrix, DVector};

/// z of the module `moments`.
fn row(u: &Vector3<f64>) -> SVector<f64, 10> {
    let (x, y, z) = (u.x, u.y, u.z);
    SVector::from([x * x, y * y, z * z, 2.0 * x * y, 2.0 * x * z, 2.0 * y * z, x, y, z, 1.0])
}

fn scatter(points: &[Vector3<f64>]) -> SMatrix<f64, 10, 10> {
    points.iter().map(|u| row(u) * row(u).transpose()).sum()
}

fn truth() -> Shape {
    Shape::of_unknowns(&SVector::from([1.3, 0.8, 1.1, 0.1, -0.2, 0.15, 0.3, -0.2, 0.25]))
}

/// p of a shape.
fn quadric(shape: &Shape) -> SVector<f64, 10> {
    let (y, beta) = (shape.unknowns(), shape.a.try_inverse().unwrap() * shape.offset);
    let last = shape.offset.dot(&beta) - 1.0;
    SVector::from([y[0], y[1], y[2], y[3], y[4], y[5], -2.0 * y[6], -2.0 * y[7], -2.0 * y[8], last])
}

/// Points of the ellipsoid, each off by up to so much.
fn points(off: f64) -> Vec<Vector3<f64>> {
    let beta = truth().a.try_inverse().unwrap() * truth().offset;
    let point = |k: u32| {
        let t = f64::from(k);
        let u = Vector3::new((1.3 * t).sin(), (0.7 * t).cos(), (2.1 * t + 0.4).sin());
        u / u.dot(&(truth().a * u)).sqrt() * (1.0 + off * (5.1 * t).sin()) + beta
    };
    (0..60).map(point).collect()
}

fn difference(one: &Shape, other: &Shape) -> f64 {
    (one.unknowns() - other.unknowns()).amax()
}

#[test]
fn both_starts_find_an_exact_ellipsoid() {
    let s = scatter(&points(0.0));
    assert!(difference(&linear(&s).unwrap(), &truth()) < 1e-9);
    assert!(difference(&ellipsoid_specific(&s).unwrap(), &truth()) < 1e-6);
}

#[test]
fn the_linear_start_is_the_least_squares_of_all_rows_with_a_trace_of_three() {
    let points = points(0.1);
    // A33 = 3 - A11 - A22
    let rows = DMatrix::from_fn(60, 9, |i, k| {
        let z = row(&points[i]);
        if k < 2 { z[k] - z[2] } else { z[k + 1] }
    });
    let right = DVector::from_fn(60, |i, _| -3.0 * row(&points[i])[2]);
    let q = rows.svd(true, true).solve(&right, 1e-14).unwrap();
    let p = SVector::from([q[0], q[1], 3.0 - q[0] - q[1], q[2], q[3], q[4], q[5], q[6], q[7], q[8]]);
    let found = quadric(&linear(&scatter(&points)).unwrap());
    // both up to a factor
    assert!((found / found.norm() - p / p.norm()).amax() < 1e-9, "{found} {p}");
}

/// 4 J - I^2 of the constraint.
fn constraint(p: &SVector<f64, 10>) -> f64 {
    let (i, j) =
        (p[0] + p[1] + p[2], p[0] * p[1] + p[1] * p[2] + p[2] * p[0] - p[3] * p[3] - p[4] * p[4] - p[5] * p[5]);
    4.0 * j - i * i
}

#[test]
fn the_specific_start_has_the_least_squares_of_all_that_meet_the_constraint() {
    let s = scatter(&points(0.3));
    let best = quadric(&ellipsoid_specific(&s).unwrap());
    let cost = |p: &SVector<f64, 10>| p.dot(&(s * p)) / constraint(p);
    assert!(constraint(&best) > 0.0);
    // at a minimum the slope is nothing in every direction, and the cost grows
    for k in 0..10 {
        let moved = |sign: f64| cost(&(best + SVector::ith(k, sign * 1e-4 * best.norm())));
        let (up, down, here) = (moved(1.0), moved(-1.0), cost(&best));
        assert!(up > here && down > here, "{k}");
        assert!((up - down).abs() < 1e-2 * (up + down - 2.0 * here), "{k}: {up} {down} {here}");
    }
}

#[test]
fn a_quadric_of_either_sign_is_the_same_ellipsoid() {
    for middle in 0..3 {
        let mut a = Vector3::repeat(1.0);
        a[middle] = 4.0;
        let offset = Vector3::new(0.3, -0.2, 0.1);
        let shape = Shape { a: Matrix3::from_diagonal(&a), offset };
        for factor in [1.0, -1.0, 2.5, -2.5] {
            let found = Shape::from_quadric(&(quadric(&shape) * factor)).unwrap();
            assert!(difference(&found, &shape) < 1e-12, "{middle} {factor}");
        }
    }
}

#[test]
fn an_ellipsoid_without_a_real_point_is_none() {
    let mut p = SVector::<f64, 10>::from([1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0]);
    assert!(Shape::from_quadric(&p).is_some());
    p[9] = 1.0;
    assert!(Shape::from_quadric(&p).is_none());
    p[9] = 0.0;
    assert!(Shape::from_quadric(&p).is_none());
}
