use super::*;
use nalgebra::Matrix3;

#[test]
fn sigma_is_the_slope_of_the_heading() {
    // field (0, 20, -40), up z: 1 uT to the east turns the heading by 1/20 rad
    let covariance = Matrix3::from_diagonal(&Vector3::new(1.0, 4.0, 9.0));
    let (axis, rotation) = (ReferenceAxis::TopEdge, ScreenRotation::Deg0);
    let sigma = |field, tilt_deg| heading_sigma_deg(&field, &Vector3::z(), axis, rotation, &covariance, tilt_deg);
    let plain = sigma(Vector3::new(0.0, 20.0, -40.0), 0.0).expect("horizontal enough");
    // and a part of 20 uT whose length is known to 2 uT, by 3 (2/20)^2 / 2 more
    let across = (1.0 + 3.0 * 4.0 / 400.0_f64).sqrt();
    assert!((plain - (across / 20.0).to_degrees()).abs() < 1e-12);
    // a tilt of 1 deg brings 1 deg of the vertical part into the horizon
    let tilted = sigma(Vector3::new(0.0, 20.0, -40.0), 1.0).expect("horizontal enough");
    let tilt = 40.0 * 1.0_f64.to_radians();
    assert!((tilted - (across.hypot(tilt) / 20.0).to_degrees()).abs() < 1e-6);
    assert_eq!(sigma(Vector3::new(0.0, 0.3, -40.0), 0.0), Some(180.0));
    assert_eq!(sigma(Vector3::new(0.0, 0.0, -40.0), 0.0), None);
}

#[test]
fn a_horizontal_part_of_unknown_length_is_turned_by_more() {
    // (east, north) = (0, 20) uT, 1 uT across and up to 8 uT along, by their quantiles
    for along_ut in [0.5, 2.0, 4.0, 8.0] {
        let mut squares = 0.0;
        for k in 0..20_000 {
            let radius = (-2.0 * ((f64::from(k) + 0.5) / 20_000.0).ln()).sqrt();
            let angle = f64::from(k) * 2.399_963;
            let field = Vector3::new(radius * angle.cos(), 20.0 + along_ut * radius * angle.sin(), -40.0);
            squares += field.x.atan2(field.y).to_degrees().powi(2);
        }
        let covariance = Matrix3::from_diagonal(&Vector3::new(1.0, along_ut * along_ut, 0.0));
        let (field, axis) = (Vector3::new(0.0, 20.0, -40.0), ReferenceAxis::TopEdge);
        let sigma = heading_sigma_deg(&field, &Vector3::z(), axis, ScreenRotation::Deg0, &covariance, 0.0).unwrap();
        let seen = (squares / 20_000.0_f64).sqrt();
        // the expansion ends after its second term, and the tail in which north changes its sign is beyond it
        let most = if along_ut < 6.0 { 1.1 } else { 4.0 };
        assert!((0.95..most).contains(&(seen / sigma)), "{along_ut} uT: {sigma}, seen {seen}");
    }
}

#[test]
fn a_tilt_turns_a_steep_axis_as_sigma_says() {
    // the heading of each axis for 4000 directions of up about the true one, 0.5 deg per axis
    let tilt_deg: f64 = 0.5;
    let field = Vector3::new(3.0, 20.0, -40.0);
    for axis in [ReferenceAxis::TopEdge, ReferenceAxis::Camera, ReferenceAxis::Auto] {
        for (pitch_deg, roll_deg) in [(0.0, 0.0), (50.0, 20.0), (80.0, 5.0), (10.0, 50.0), (-35.0, 60.0)] {
            let (pitch, roll) = (f64::to_radians(pitch_deg), f64::to_radians(roll_deg));
            let up = Vector3::new(-roll.sin() * pitch.cos(), pitch.sin(), roll.cos() * pitch.cos());
            let right = up.cross(&Vector3::new(0.3, 0.7, -0.2)).normalize();
            let ahead = up.cross(&right);
            let given = |up: &Vector3<f64>| heading(&field, up, axis, ScreenRotation::Deg0).map(|h| h.heading_deg);
            let Some(there) = given(&up) else { continue };
            let mut squares = 0.0;
            for k in 0..4000 {
                // Gaussian by its quantiles: radius by one, angle by the golden ratio
                let radius = (-2.0 * ((f64::from(k) + 0.5) / 4000.0).ln()).sqrt() * tilt_deg.to_radians();
                let angle = f64::from(k) * 2.399_963;
                let tilted = up + (right * angle.cos() + ahead * angle.sin()) * radius;
                let off = (given(&tilted).unwrap() - there + 540.0).rem_euclid(360.0) - 180.0;
                squares += off * off;
            }
            let seen = (squares / 4000.0).sqrt();
            let covariance = Matrix3::zeros();
            let sigma = heading_sigma_deg(&field, &up, axis, ScreenRotation::Deg0, &covariance, tilt_deg).unwrap();
            // small by the arc tangent where it is large; the automatic axis has kinks
            assert!((0.85..1.15).contains(&(sigma / seen)), "{axis:?} {pitch_deg} {roll_deg}: {sigma}, seen {seen}");
        }
    }
    // also where the step of the slope tips the axis over the vertical
    for off in [0.001, 5e-6] {
        let up = Vector3::new(0.0, 1.0, off);
        let none = Matrix3::zeros();
        let upright = heading_sigma_deg(&field, &up, ReferenceAxis::TopEdge, ScreenRotation::Deg0, &none, tilt_deg);
        assert_eq!(upright, Some(180.0), "{off}");
    }
}

#[test]
fn a_tilt_turns_the_heading_as_finite_differences_say() {
    let field = Vector3::new(3.0, 20.0, -40.0);
    for axis in [ReferenceAxis::TopEdge, ReferenceAxis::Camera, ReferenceAxis::Auto] {
        for rotation in [ScreenRotation::Deg0, ScreenRotation::Deg90, ScreenRotation::Deg270] {
            for up in [Vector3::new(0.1, 0.4, 0.9), Vector3::new(-0.8, 0.2, 0.5), Vector3::new(0.3, -0.77, -0.4)] {
                let up = up.normalize();
                let across = up.cross(&Vector3::new(0.3, 0.7, -0.2)).normalize();
                let slope = |d: Vector3<f64>| {
                    let of = |step: f64| heading(&field, &(up + d * step), axis, rotation).unwrap().heading_deg;
                    (of(1e-5) - of(-1e-5)) / 2e-5_f64.to_degrees()
                };
                let expected = slope(across).hypot(slope(up.cross(&across)));
                let sigma = heading_sigma_deg(&field, &up, axis, rotation, &Matrix3::zeros(), 1.0).unwrap();
                assert!((sigma / expected - 1.0).abs() < 1e-6, "{axis:?} {rotation:?} {up:?}: {sigma}, {expected}");
            }
        }
    }
}
