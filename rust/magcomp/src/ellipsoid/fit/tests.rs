use super::*;
use nalgebra::Matrix3;

fn calibration() -> Calibration {
    let soft_iron = Matrix3::new(1.1, 0.1, -0.05, 0.1, 0.9, 0.08, -0.05, 0.08, 1.05);
    Calibration::from_symmetric(soft_iron, Vector3::new(30.0, -200.0, 80.0), 48.0).unwrap()
}

fn directions() -> Vec<Vector3<f64>> {
    (0..60)
        .map(|k| Vector3::new((1.3 * f64::from(k)).sin(), (0.7 * f64::from(k)).cos(), (2.1 * f64::from(k) + 0.4).sin()))
        .collect()
}

/// Samples of a calibration lie on its shape, wherever the moments' centre and whatever their scale.
#[test]
fn a_calibration_is_the_ellipsoid_of_its_samples() {
    let moments = Moments::new(Vector3::new(10.0, -190.0, 95.0), 37.0);
    let shape = moments.shape_of(&calibration());
    let beta = shape.centre().unwrap();
    for direction in directions() {
        let raw_ut = calibration().distort(&(direction.normalize() * 48.0));
        let off = (raw_ut - moments.centre_ut()) / 37.0 - beta;
        assert!((off.dot(&(shape.a * off)) - 1.0).abs() < 1e-12);
    }
}

#[test]
fn the_centre_of_exact_samples_is_found_from_afar() {
    let mut moments = Moments::new(Vector3::new(10.0, -190.0, 95.0), 37.0);
    directions().iter().for_each(|it| moments.add(&calibration().distort(&(it.normalize() * 48.0))));
    assert!((moments.provisional_centre_ut() - calibration().hard_iron_ut()).norm() < 1e-6);
    // one sample has no centre but that of the moments
    let mut moments = Moments::new(Vector3::new(10.0, -190.0, 95.0), 37.0);
    moments.add(&Vector3::new(1.0, 2.0, 3.0));
    assert_eq!(moments.provisional_centre_ut(), *moments.centre_ut());
}
