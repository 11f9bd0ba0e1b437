use super::{Ldl, add, solve};
use nalgebra::{SMatrix, SVector};

#[test]
fn agrees_with_a_general_factorisation() {
    let a = SMatrix::<f64, 9, 9>::from_fn(|i, j| ((i * 7 + j * 3) as f64 * 0.7).sin());
    let h = a * a.transpose() + SMatrix::identity() * 0.1;
    let g = SVector::<f64, 9>::from_fn(|i, _| i as f64 - 3.0);
    let expected = h.cholesky().expect("positive definite").solve(&g);
    assert!((solve(&h, &g).expect("positive definite") - expected).amax() < 1e-10);
}

#[test]
fn a_factorisation_solves_as_the_inverse_does() {
    let a = SMatrix::<f64, 9, 9>::from_fn(|i, j| ((i * 7 + j * 3) as f64 * 0.7).sin());
    let h = a * a.transpose() + SMatrix::identity() * 0.1;
    let g = SVector::<f64, 9>::from_fn(|i, _| i as f64 - 3.0);
    let (ldl, inverse) = (Ldl::new(&h).expect("positive definite"), h.try_inverse().expect("regular"));
    assert!((ldl.solve(&g) - inverse * g).amax() < 1e-8);
}

#[test]
fn refuses_what_is_not_positive_definite() {
    let mut h = SMatrix::<f64, 3, 3>::identity();
    h[(2, 2)] = -1.0;
    assert_eq!(solve(&h, &SVector::repeat(1.0)), None);
    h[(2, 2)] = f64::NAN;
    assert_eq!(solve(&h, &SVector::repeat(1.0)), None);
    h[(2, 2)] = f64::INFINITY;
    assert_eq!(solve(&h, &SVector::repeat(1.0)), None);
}

#[test]
fn the_border_of_positive_definite_is_where_the_determinant_changes_sign() {
    // [[1, c], [c, 1]] is positive definite where |c| < 1, exactly
    let with = |c: f64| Ldl::new(&SMatrix::<f64, 2, 2>::new(1.0, c, c, 1.0)).is_some();
    for c in [0.0, 0.5, 1.0 - 1e-12] {
        assert!(with(c) && with(-c), "{c}");
    }
    for c in [1.0, 1.0 + 1e-12, 3.0] {
        assert!(!with(c) && !with(-c), "{c}");
    }
}

#[test]
fn only_the_lower_triangle_is_read() {
    let h = SMatrix::<f64, 3, 3>::new(4.0, 1.0, 0.5, 1.0, 3.0, -1.0, 0.5, -1.0, 2.0);
    let mut lower = h;
    lower.fill_upper_triangle(f64::NAN, 1);
    let g = SVector::from([1.0, -2.0, 3.0]);
    assert_eq!(solve(&lower, &g), solve(&h, &g));
}

#[test]
fn a_multiple_of_a_row_is_added() {
    let mut sum = [1.0, 2.0, 3.0];
    add(&mut sum, -2.0, &[0.5, 1.0, 0.0]);
    assert_eq!(sum, [0.0, 0.0, 3.0]);
}
