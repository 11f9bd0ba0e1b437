use super::*;

#[test]
fn motion_shows_in_the_size_and_is_forgotten() {
    let mut tilt = Tilt::default();
    let step = |tilt: &mut Tilt, k: i64, motion: f64| tilt.step(k * 10_000_000, GRAVITY_M_S2 + motion);
    for k in 0..300 {
        // 1 m/s^2 rms along gravity
        step(&mut tilt, k, 2f64.sqrt() * (k as f64 * 0.2).sin());
    }
    let sigma_deg = |tilt: &Tilt| 0.5_f64.hypot(tilt.variance_rad2.sqrt().to_degrees());
    let shaken = sigma_deg(&tilt);
    assert!((shaken - 5.87).abs() < 0.6, "{shaken}: atan(1 / g) = 5.8 deg, 0.5 deg beside");
    for k in 300..1300 {
        step(&mut tilt, k, 0.0);
    }
    assert!(sigma_deg(&tilt) < 0.51);
}
