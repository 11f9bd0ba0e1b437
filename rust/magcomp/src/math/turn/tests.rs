//! Against the series of the matrix exponential, and finite differences.

use super::Turn;
use nalgebra::{Matrix3, Vector3};

/// sum [v]x^k / (k + more)!
fn series(v: &Vector3<f64>, more: i32) -> Matrix3<f64> {
    let (mut sum, mut power, mut factorial) = (Matrix3::zeros(), Matrix3::identity(), 1.0);
    for k in 1..60 {
        sum += power / factorial;
        power *= v.cross_matrix();
        factorial *= f64::from(k + more);
    }
    sum
}

/// Angles on both sides of the border between series and closed form, small and large.
fn vectors() -> impl Iterator<Item = Vector3<f64>> {
    let axis = Vector3::new(0.48, -0.6, 0.64);
    [0.0, 1e-9, 1e-4, 3e-3, 0.1, 0.2499, 0.2501, 0.4, 3.1, 5.0].into_iter().map(move |angle| axis * angle)
}

#[test]
fn a_turn_is_the_matrix_exponential() {
    for v in vectors() {
        let off = Turn::by(&v).rotation - series(&v, 0);
        assert!(off.norm() < 1e-12, "{v:?}: {off}");
    }
}

/// Beside the diagonal no 1 hides what the last terms of the series add.
#[test]
fn small_turns_are_exact_to_rounding() {
    for v in vectors().filter(|v| v.norm() < 0.25) {
        let turn = Turn::by(&v);
        for (found, expected) in [(turn.rotation, series(&v, 0)), (turn.left_jacobian, series(&v, 1))] {
            for (i, j) in [(0, 1), (0, 2), (1, 0), (1, 2), (2, 0), (2, 1)] {
                let (found, expected) = (found[(i, j)], expected[(i, j)]);
                assert!((found - expected).abs() <= 1e-15 * expected.abs(), "{v:?}: {found:e} is not {expected:e}");
            }
        }
    }
}

#[test]
fn the_left_jacobian_is_its_series() {
    for v in vectors() {
        // sum [v]x^k / (k + 1)!; the closed form loses digits just above the border
        let off = Turn::by(&v).left_jacobian - series(&v, 1);
        assert!(off.norm() < 1e-11, "{v:?}: {off}");
    }
}

#[test]
fn the_left_jacobian_is_the_derivative() {
    for v in vectors() {
        let turn = Turn::by(&v);
        for k in 0..3 {
            let step = Vector3::ith(k, 1e-5);
            let off = Turn::by(&(v + step)).rotation * Turn::by(&(v - step)).rotation.transpose();
            // exp([small]x): its skew part
            let found = Vector3::new(off.m32 - off.m23, off.m13 - off.m31, off.m21 - off.m12) / 4e-5;
            let wrong = (found - turn.left_jacobian.column(k)).norm();
            assert!(wrong < 1e-8, "{v:?}, axis {k}: {wrong:e}");
        }
    }
}
