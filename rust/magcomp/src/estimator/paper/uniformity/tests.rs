use super::*;

/// By hand: of lengths 60, 40 and 50 in a field of 50 two are off by a fifth.
#[test]
fn the_spread_is_the_rms_of_what_the_lengths_are_off_by() {
    let calibration = Calibration::about(Vector3::new(7.0, -3.0, 2.0), 50.0);
    let raw_ut = [60.0, 40.0, 50.0].map(|length| Vector3::new(7.0, -3.0, 2.0) + Vector3::x() * length);
    let found = evenness(raw_ut.iter(), &calibration, Normalisation::HalfRange);
    assert!((found.spread - (0.08_f64 / 3.0).sqrt()).abs() < 1e-12 && found.sigma_t < 1e-12, "{found:?}");
}

/// By hand: azimuths of 0 and 90 degrees have a standard deviation of 45, elevations of 90 and 30 one of 30.
#[test]
fn the_deviations_of_azimuth_and_elevation_are_added_in_squares() {
    let found = uniformity([Vector3::x(), Vector3::y()], Normalisation::HalfRange);
    assert!((found - 0.25).abs() < 1e-12, "{found}");
    let steep = Vector3::new(0.5, 0.0, 0.75_f64.sqrt()) * 7.0;
    let found = uniformity([Vector3::x(), steep], Normalisation::HalfRange);
    assert!((found - 30.0 / 90.0).abs() < 1e-12, "{found}");
    assert_eq!(uniformity([], Normalisation::HalfRange), 0.0);
}
