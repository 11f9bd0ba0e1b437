//! The attitude against quaternions known in the world frame, and its sigma against errors that are drawn.

use magcomp::nalgebra::{Cholesky, Matrix3, Quaternion, UnitQuaternion, Vector3};
use magcomp::{
    Calibration, Compensator, Config, MagneticSample, Method, Reading, RotationRateSample, SensorMode, UpSample,
    attitude, attitude_sigma_deg,
};
use magcomp_tests::{Random, vectors};
use serde::Deserialize;

#[derive(Deserialize)]
struct Attitudes {
    attitudes: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    field_ut: Vector3<f64>,
    up: Vector3<f64>,
    inclination_deg: f64,
    /// w, x, y, z.
    attitude: [f64; 4],
}

#[test]
fn attitudes_of_the_reference() {
    let cases = vectors::<Attitudes>("headings.json").attitudes;
    assert_eq!(cases.len(), 150);
    for case in cases {
        let [w, x, y, z] = case.attitude;
        let expected = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
        for (field_scale, up_scale) in [(1.0, 1.0), (0.5, 9.81), (3.0, 1e-3)] {
            let found = attitude(&(case.field_ut * field_scale), &(case.up * up_scale)).expect("not vertical");
            let off = found.to_world.angle_to(&expected);
            // rounding, larger where the field is near the vertical
            assert!(off < 1e-13 / case.inclination_deg.to_radians().cos(), "{off}");
            assert!(found.to_world.w >= 0.0 && (found.to_world.norm() - 1.0).abs() < 1e-15);
        }
    }
}

#[test]
fn nothing_is_said_where_there_is_no_north() {
    let (north, up) = (Vector3::new(0.0, 20.0, -40.0), Vector3::z());
    for (field, up) in [
        (up * 50.0, up),
        (up * -50.0, up),
        (Vector3::zeros(), up),
        (north, Vector3::zeros()),
        (Vector3::new(f64::NAN, 20.0, 0.0), up),
        (north, Vector3::new(0.0, f64::INFINITY, 1.0)),
    ] {
        assert_eq!(attitude(&field, &up), None, "{field} {up}");
        assert_eq!(attitude_sigma_deg(&field, &up, &Matrix3::identity(), 1.0), None, "{field} {up}");
    }
    let nothing_left = attitude_sigma_deg(&Vector3::new(0.0, 0.3, -40.0), &up, &Matrix3::identity(), 0.5);
    assert_eq!(nothing_left, Some(180.0));
}

/// Root of the mean square of the rotation error, for fields and ups with the errors that sigma is told.
#[test]
fn sigma_is_the_root_of_the_mean_square_of_the_rotation_error() {
    let mut random = Random::new(80);
    for case in 0..40 {
        let to_world = random.attitude();
        let (sin, cos) = random.between(-80.0, 80.0_f64).to_radians().sin_cos();
        let field = to_world.inverse() * Vector3::new(0.0, 50.0 * cos, -50.0 * sin);
        let up = to_world.inverse() * Vector3::z();
        let root = Matrix3::from_fn(|_, _| random.normal()) * 0.2;
        let covariance = root * root.transpose();
        let tilt_deg = random.between(0.0, 0.6);
        let (right, ahead) = (to_world.inverse() * Vector3::x(), to_world.inverse() * Vector3::y());
        let lower = Cholesky::new(covariance).expect("of full rank").l();
        let squares = (0..20_000).map(|_| {
            let leaning = (right * random.normal() + ahead * random.normal()) * tilt_deg.to_radians();
            let found = attitude(&(field + lower * random.normal3()), &(up + leaning)).expect("not vertical");
            found.to_world.angle_to(&to_world).to_degrees().powi(2)
        });
        let seen = (squares.sum::<f64>() / 20_000.0).sqrt();
        let sigma = attitude_sigma_deg(&field, &up, &covariance, tilt_deg).expect("not vertical");
        // 20 000 draws know it to 0.7 %; beyond first order it differs where the field is steep
        assert!((0.96..1.04).contains(&(sigma / seen)), "{case}: {sigma}, seen {seen}");
    }
}

/// A phone in a hand held upright, top edge to the sky: its attitude at each sample, and what the compensator says of it.
fn upright(method: Method, seed: u64, mut each: impl FnMut(&Reading, &UnitQuaternion<f64>)) {
    let mut random = Random::new(seed);
    let mut compensator = Compensator::new(Config { method, ..Config::default() }).unwrap();
    let truth = Calibration::new(Matrix3::identity(), Vector3::new(20.0, -35.0, 60.0), 48.0).unwrap();
    let at = |t: f64| {
        // turned about for twelve seconds, then upright, turning about the vertical
        let sway = (1.0 - (t - 12.0).clamp(0.0, 1.0)) * 1.2;
        UnitQuaternion::from_euler_angles(0.0, 0.0, 0.4 * t)
            * UnitQuaternion::from_euler_angles(std::f64::consts::FRAC_PI_2, 0.0, 0.0)
            * UnitQuaternion::from_euler_angles(sway * (1.9 * t).sin(), sway * (1.3 * t).cos(), sway * (0.7 * t).sin())
    };
    for k in 1..=2000_i64 {
        let (time_ns, t) = (k * 10_000_000, k as f64 * 0.01);
        let to_device = at(t).inverse();
        let rate_rad_s = (at(t - 0.005).inverse() * at(t + 0.005)).scaled_axis() / 0.01 + random.normal3() * 0.003;
        compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s }).unwrap();
        let up_m_s2 = to_device * Vector3::new(0.0, 0.0, 9.81) + random.normal3() * 0.05;
        compensator.push_up(UpSample { time_ns, up_m_s2 }).unwrap();
        let field = to_device * Vector3::new(0.0, 22.0, -42.6);
        let reading =
            compensator.push(MagneticSample { time_ns, field_ut: truth.distort(&field) + random.normal3() * 0.4 });
        if t > 14.0 {
            each(&reading, &at(t));
        }
    }
}

#[test]
fn an_upright_phone_has_an_attitude_where_its_top_edge_has_no_heading() {
    for (method, mode) in [(Method::Auto, SensorMode::GyroscopeAndGravity), (Method::Adaptive, SensorMode::GravityOnly)]
    {
        let (mut within, mut all, mut lost) = (0, 0, 0);
        for seed in 0..8 {
            upright(method, seed, |reading, truth| {
                assert_eq!(reading.mode, mode);
                let found = reading.attitude.expect("a field and an up");
                let sigma_deg = found.sigma_deg.expect("known");
                assert!(sigma_deg < 10.0, "{sigma_deg}");
                let off_deg = found.to_world.angle_to(truth).to_degrees();
                within += usize::from(off_deg < 2.0 * sigma_deg);
                all += 1;
                let heading = reading.heading.and_then(|heading| heading.heading_sigma_deg);
                lost += usize::from(heading.is_none_or(|sigma| sigma > 45.0));
            });
        }
        println!("{method:?}: {within} of {all} within two sigmas, {lost} without a heading of the top edge");
        // the accelerometer's noise alone takes `up` off the top edge by a degree
        assert!(lost * 4 > all * 3, "{method:?}: {lost} of {all}");
        assert!(within * 100 > all * 88, "{method:?}: {within} of {all} within two sigmas");
    }
}
