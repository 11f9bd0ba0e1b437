use super::*;
use crate::calibration::Calibration;
use crate::quadric::direction_sigma_deg;
use nalgebra::{Matrix3, SMatrix};

/// With T = I, dM = -dT, and the sphere's mean of the ellipsoid's report must come out.
#[test]
fn the_sphere_agrees_with_the_closed_form() {
    let tau = super::super::parameters::tau_of(&Matrix3::identity(), &Vector3::new(0.3, -0.2, 0.1));
    let root = TauMatrix::from_fn(|i, j| ((i * 5 + j * 3) as f64).sin() * 0.01);
    let p = root * root.transpose();
    // order b, M of the report
    let swap = [6, 7, 8, 0, 1, 2, 3, 4, 5];
    let sign = |i: usize| if i < 6 { -1.0 } else { 1.0 };
    let other = SMatrix::<f64, 9, 9>::from_fn(|i, j| p[(swap[i], swap[j])] * sign(swap[i]) * sign(swap[j]));
    let closed = direction_sigma_deg(&Calibration::identity(1.0).expect("in range"), &other);
    let found = AngularWeight::sphere(&tau).expected(&p).sqrt().to_degrees();
    assert!((found / closed - 1.0).abs() < 1e-12, "{found} against {closed}");
}
