use super::{Ldl, solve};
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
fn every_use_of_a_factorisation_agrees_with_the_inverse() {
    let a = SMatrix::<f64, 9, 9>::from_fn(|i, j| ((i * 7 + j * 3) as f64 * 0.7).sin());
    let h = a * a.transpose() + SMatrix::identity() * 0.1;
    let b = a + a.transpose();
    let g = SVector::<f64, 9>::from_fn(|i, _| i as f64 - 3.0);
    let (ldl, inverse) = (Ldl::new(&h).expect("positive definite"), h.try_inverse().expect("regular"));
    assert!((ldl.inverse() - inverse).amax() < 1e-10);
    assert!((ldl.log_det - h.determinant().ln()).abs() < 1e-10);
    assert!((ldl.solve_matrix(&b) - inverse * b).amax() < 1e-8 && (ldl.solve(&g) - inverse * g).amax() < 1e-8);
}

#[test]
fn refuses_what_is_not_positive_definite() {
    let mut h = SMatrix::<f64, 3, 3>::identity();
    h[(2, 2)] = -1.0;
    assert_eq!(solve(&h, &SVector::repeat(1.0)), None);
    h[(2, 2)] = f64::NAN;
    assert_eq!(solve(&h, &SVector::repeat(1.0)), None);
}
