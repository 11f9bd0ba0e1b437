//! Against the sum that is squared, written out, and finite differences.

use super::*;
use crate::ellipsoid::Moments;
use crate::math::symmetric::symmetric;

fn points() -> Vec<Vector3<f64>> {
    let point = |k: u32| {
        let t = f64::from(k);
        let u = Vector3::new((1.3 * t).sin(), (0.7 * t).cos(), (2.1 * t + 0.4).sin());
        u.normalize() * (1.0 + 0.2 * (5.1 * t).sin()) + Vector3::new(0.2, -0.1, 0.3)
    };
    (0..60).map(point).collect()
}

/// The problem of these points, in coordinates of their own.
fn problem(residual: Residual) -> Problem {
    let mut moments = Moments::new(Vector3::zeros(), 1.0);
    points().iter().for_each(|point| moments.add(point));
    let (s, b) = moments.scatter();
    Problem { s, b, residual }
}

fn unknowns() -> Vector9 {
    Vector9::from([1.3, 0.8, 1.1, 0.1, -0.2, 0.15, 0.3, -0.2, 0.25])
}

#[test]
fn the_cost_is_the_mean_square_of_what_each_sample_misses_the_ellipsoid_by() {
    let (a, y) = (symmetric(&unknowns()), unknowns());
    let beta = a.try_inverse().unwrap() * y.fixed_rows::<3>(6);
    let (mut squares, mut slopes) = (0.0, 0.0);
    for u in points() {
        let miss = (u - beta).dot(&(a * (u - beta))) - 1.0;
        squares += miss * miss / 60.0;
        // |grad|^2, and half the Laplacian of miss^2 beyond it: what noise adds to the square
        slopes += ((a * (u - beta) * 2.0).norm_squared() + 2.0 * miss * a.trace()) / 60.0;
    }
    let value = |residual| {
        let problem = problem(residual);
        problem.value(&problem.at(Shape::of_unknowns(&y)).unwrap())
    };
    assert!((value(Residual::Algebraic) / squares - 1.0).abs() < 1e-9);
    assert!((value(Residual::Corrected) / (squares / slopes) - 1.0).abs() < 1e-9);
}

#[test]
fn gradient_and_curvature_are_those_of_finite_differences() {
    let step = 1e-5;
    for residual in [Residual::Algebraic, Residual::Corrected] {
        let problem = problem(residual);
        let at = |y: &Vector9| problem.at(Shape::of_unknowns(y)).unwrap();
        let here = at(&unknowns());
        let Derivatives { gradient, hessian } = problem.derivatives(&here);
        // the corrected cost's derivatives are its own, times the slope
        let unit = if residual == Residual::Corrected { here.slope } else { 1.0 };
        for k in 0..9 {
            let moved = |sign: f64| at(&(unknowns() + Vector9::ith(k, sign * step)));
            let expected = unit * (moved(1.0).value - moved(-1.0).value) / (4.0 * step);
            assert!((gradient[k] - expected).abs() < 1e-7, "{residual:?} {k}: {} {expected}", gradient[k]);
            if residual == Residual::Algebraic {
                let gradient = |sign: f64| problem.derivatives(&moved(sign)).gradient;
                let expected = (gradient(1.0) - gradient(-1.0)) / (2.0 * step);
                (k..9).for_each(|i| {
                    assert!(
                        (hessian[(i, k)] - expected[i]).abs() < 1e-6,
                        "{i} {k}: {} {}",
                        hessian[(i, k)],
                        expected[i]
                    );
                });
            }
        }
    }
}

/// J^T Q J by J = dp/dy, and p by its definition.
#[test]
fn the_information_is_that_of_the_jacobian_written_out() {
    let problem = problem(Residual::Corrected);
    let p = |y: &Vector9| {
        let offset = y.fixed_rows::<3>(6).into_owned();
        let last = offset.dot(&(symmetric(y).try_inverse().unwrap() * offset)) - 1.0;
        Vector10::from([y[0], y[1], y[2], y[3], y[4], y[5], -2.0 * y[6], -2.0 * y[7], -2.0 * y[8], last])
    };
    let step = 1e-5;
    let jacobian = SMatrix::<f64, 10, 9>::from_fn(|i, k| {
        let moved = |sign: f64| p(&(unknowns() + Vector9::ith(k, sign * step)));
        ((moved(1.0) - moved(-1.0)) / (2.0 * step))[i]
    });
    let candidate = problem.at(Shape::of_unknowns(&unknowns())).unwrap();
    let q = problem.s - problem.b * (candidate.cost / candidate.slope);
    let expected = jacobian.transpose() * q * jacobian / candidate.slope;
    let found = problem.information(&candidate);
    for j in 0..9 {
        (j..9).for_each(|i| assert!((found[(i, j)] - expected[(i, j)]).abs() < 1e-7, "{i} {j}"));
    }
}
