//! The aided method through the public interface: what an app sees.

use magcomp::nalgebra::{Rotation3, Vector3};
use magcomp::{
    Calibration, Compensator, Config, EventKind, HeadingConfig, HoldReason, MagneticSample, Method, Missing, Reading,
    RotationRateSample, SensorMode, Status, UpSample,
};
use magcomp_tests::{REF, Random, calibration};

const DT_S: f64 = 0.01;
const FIELD_UT: Vector3<f64> = Vector3::new(0.0, 22.0, -38.0);

/// A phone in a hand: smooth motion, all three sensors.
struct Phone {
    attitude: Rotation3<f64>,
    k: usize,
    random: Random,
    truth: Calibration,
    moving: bool,
    gyroscope: bool,
    accelerometer: bool,
    /// The gyroscope repeats its latest reading.
    hangs: bool,
    /// One of its axes is the other way round.
    flips: bool,
    rate_rad_s: Vector3<f64>,
}

impl Phone {
    fn new(seed: u64) -> Self {
        Self {
            attitude: Rotation3::identity(),
            k: 0,
            random: Random::new(seed),
            truth: phone_like(1.0),
            moving: true,
            gyroscope: true,
            accelerometer: true,
            hangs: false,
            flips: false,
            rate_rad_s: Vector3::zeros(),
        }
    }

    /// The field in the device frame now, uT.
    fn field(&self) -> Vector3<f64> {
        self.attitude.inverse() * FIELD_UT
    }

    fn advance(&mut self, compensator: &mut Compensator) -> Reading {
        let t = self.k as f64 * DT_S;
        let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin());
        let rate = if self.moving { rate } else { Vector3::zeros() };
        self.attitude *= Rotation3::new(rate * DT_S);
        self.k += 1;
        let time_ns = self.k as i64 * 10_000_000;
        if self.gyroscope {
            let reads = rate + self.random.normal3() * 0.003 + Vector3::new(0.01, -0.02, 0.015);
            if !self.hangs {
                self.rate_rad_s = reads;
            }
            let rate_rad_s =
                if self.flips { self.rate_rad_s.component_mul(&Vector3::new(1.0, -1.0, 1.0)) } else { self.rate_rad_s };
            compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s }).expect("in order");
        }
        if self.accelerometer {
            let up_m_s2 = self.attitude.inverse() * Vector3::new(0.0, 0.0, 9.81) + self.random.normal3() * 0.05;
            compensator.push_up(UpSample { time_ns, up_m_s2 }).expect("in order");
        }
        let field_ut = self.truth.distort(&self.field()) + self.random.normal3() * 0.5;
        compensator.push(MagneticSample { time_ns, field_ut })
    }

    fn run(&mut self, compensator: &mut Compensator, samples: usize) -> Reading {
        (0..samples).map(|_| self.advance(compensator)).last().expect("some samples")
    }
}

/// Disturbance of a phone, `share` times as strong.
fn phone_like(share: f64) -> Calibration {
    let m = REF.map(|v| v * share);
    let soft = [1.0 + 0.05 * share, 1.0 - 0.05 * share, 1.0, 0.03 * share, -0.025 * share, 0.04 * share];
    calibration(&[m[0], m[1], m[2], soft[0], soft[1], soft[2], soft[3], soft[4], soft[5]], FIELD_UT.norm())
}

fn compensator(method: Method) -> Compensator {
    let heading = HeadingConfig { declination_deg: Some(2.5), ..HeadingConfig::default() };
    Compensator::new(Config { method, heading, ..Config::default() }).expect("a valid config")
}

fn angle_deg(a: &Vector3<f64>, b: &Vector3<f64>) -> f64 {
    a.angle(b).to_degrees()
}

#[test]
fn collects_tracks_and_relearns_a_change() {
    let mut phone = Phone::new(1);
    let mut compensator = compensator(Method::Auto);
    let first = phone.advance(&mut compensator);
    assert!(matches!(first.status, Status::Collecting(_)) && first.field_ut.is_none() && first.heading.is_none());
    let reading = phone.run(&mut compensator, 1500);
    assert_eq!((reading.status, reading.mode), (Status::Tracking, SensorMode::GyroscopeAndGravity));
    assert_eq!(reading.event, None);
    let heading = reading.heading.expect("up is there");
    let sigma_deg = heading.heading_sigma_deg.expect("sigma is known");
    assert!(sigma_deg > 0.1 && sigma_deg < 6.0, "{sigma_deg}");
    assert!(
        (heading.true_heading_deg.expect("declination given") - heading.heading_deg - 2.5).rem_euclid(360.0) < 1e-9
    );
    let carried = reading.filtered_field_ut.expect("a gyroscope");
    assert!(angle_deg(&carried, &phone.field()) < 1.0);
    assert!((reading.field_sigma_ut.expect("known")) < 2.0);

    // a cover is put on: everything half as strong again
    phone.truth = phone_like(1.5);
    let step_ns = phone.k as i64 * 10_000_000;
    let mut suspect_after = None;
    let mut worst_carried = 0.0_f64;
    for k in 0..400 {
        let reading = phone.advance(&mut compensator);
        if matches!(reading.status, Status::Suspect { .. }) && suspect_after.is_none() {
            suspect_after = Some(k);
        }
        worst_carried = worst_carried.max(angle_deg(&reading.filtered_field_ut.expect("carried"), &phone.field()));
    }
    assert!(suspect_after.expect("it is noticed") <= 30, "{suspect_after:?}");
    assert!(worst_carried < 3.0, "{worst_carried}");
    let event = phone.advance(&mut compensator).event.expect("it is decided");
    assert_eq!(event.kind, EventKind::DeviceStep);
    let off_s = (event.since_ns - step_ns) as f64 * 1e-9;
    assert!(off_s.abs() <= 0.1 && event.decided_ns > event.since_ns, "{off_s} s");
    let found = compensator.calibration().expect("calibrated");
    let raw = phone.truth.distort(&phone.field());
    assert!(angle_deg(&found.correct(&raw), &phone.field()) < 2.0);
}

#[test]
fn a_gyroscope_that_goes_and_comes_back_is_reported_and_nothing_is_lost() {
    let mut phone = Phone::new(3);
    let mut compensator = compensator(Method::Auto);
    phone.run(&mut compensator, 1500);
    phone.gyroscope = false;
    let reading = phone.run(&mut compensator, 300);
    assert_eq!(reading.mode, SensorMode::GravityOnly);
    assert!(reading.field_ut.is_some() && reading.filtered_field_ut.is_none());
    assert!(angle_deg(&reading.field_ut.expect("calibrated"), &phone.field()) < 5.0);
    phone.accelerometer = false;
    let reading = phone.run(&mut compensator, 100);
    assert_eq!((reading.mode, reading.heading), (SensorMode::MagnetometerOnly, None));
    (phone.gyroscope, phone.accelerometer) = (true, true);
    let reading = phone.run(&mut compensator, 300);
    assert_eq!(reading.mode, SensorMode::GyroscopeAndGravity);
    assert!(angle_deg(&reading.filtered_field_ut.expect("carried"), &phone.field()) < 2.0);
}

/// It hangs for half a minute: the magnetometer alone answers meanwhile, and the gyroscope is asked again with every sample.
#[test]
fn a_gyroscope_that_hangs_is_out_of_use_until_it_reads_something_else() {
    let mut phone = Phone::new(8);
    let mut compensator = compensator(Method::Auto);
    phone.run(&mut compensator, 1500);
    phone.hangs = true;
    let reading = phone.run(&mut compensator, 1000);
    assert_eq!(reading.mode, SensorMode::GravityOnly);
    for k in 0..2000 {
        let reading = phone.advance(&mut compensator);
        assert_eq!(reading.mode, SensorMode::GravityOnly, "{k}");
        let error_deg = angle_deg(&reading.field_ut.expect("calibrated"), &phone.field());
        assert!(error_deg < 8.0, "{error_deg} deg at {k}");
    }
    phone.hangs = false;
    let reading = phone.run(&mut compensator, 500);
    assert_eq!(reading.mode, SensorMode::GyroscopeAndGravity);
    assert!(angle_deg(&reading.filtered_field_ut.expect("carried"), &phone.field()) < 2.0);
}

/// With a gyroscope `Aided` is `Auto`. Without one it keeps its calibration, says so, and is the less sure; it goes on once the gyroscope is back.
#[test]
fn aided_keeps_its_calibration_without_a_gyroscope() {
    let [(mut auto, mut other), (mut aided, mut phone)] =
        [Method::Auto, Method::Aided].map(|method| (compensator(method), Phone::new(9)));
    for k in 0..1500 {
        let (reading, expected) = (phone.advance(&mut aided), other.advance(&mut auto));
        assert!(k < 2 || reading == expected, "sample {k}: {reading:?}");
    }
    phone.gyroscope = false;
    // a short silence is bridged, and a second of one is no loss
    phone.run(&mut aided, 150);
    let of_b = |it: &Compensator| it.covariance().expect("learned").fixed_view::<3, 3>(0, 0).trace();
    let (before, before_ut2) = (aided.calibration().expect("learned"), of_b(&aided));
    for k in 0..1000 {
        let reading = phone.advance(&mut aided);
        assert_eq!(
            (reading.status, reading.mode),
            (Status::Held(HoldReason::NoGyroscope), SensorMode::GravityOnly),
            "{k}"
        );
        let error_deg = angle_deg(&reading.field_ut.expect("corrected"), &phone.field());
        assert!(error_deg < 8.0 && reading.heading.is_some(), "{error_deg} deg at {k}");
    }
    let after = aided.calibration().expect("kept");
    assert!((after.hard_iron_ut() - before.hard_iron_ut()).norm() < 1e-9 && of_b(&aided) > before_ut2 + 0.1);
    // a magnet: the status said that nothing follows it
    phone.truth = phone_like(1.5);
    assert_eq!(phone.run(&mut aided, 300).status, Status::Held(HoldReason::NoGyroscope));
    phone.gyroscope = true;
    let reading = phone.run(&mut aided, 1500);
    assert!(angle_deg(&reading.filtered_field_ut.expect("carried"), &phone.field()) < 2.0);
    assert_eq!((reading.status, reading.mode), (Status::Tracking, SensorMode::GyroscopeAndGravity));
}

/// Nor has `Aided` a use for a gyroscope that hangs, or that gravity and field contradict.
#[test]
fn aided_keeps_its_calibration_beside_a_gyroscope_that_reads_nonsense() {
    for (hangs, flips) in [(true, false), (false, true)] {
        let (mut phone, truth) = (Phone::new(8), phone_like(1.0));
        (phone.hangs, phone.flips) = (hangs, flips);
        let mut aided =
            Compensator::new(Config { method: Method::Aided, initial: Some(truth), ..Config::default() }).unwrap();
        phone.run(&mut aided, 3000);
        for k in 0..1000 {
            let reading = phone.advance(&mut aided);
            assert_eq!(reading.status, Status::Held(HoldReason::NoGyroscope), "{hangs}, {flips}, {k}");
            let error_deg = angle_deg(&reading.field_ut.expect("corrected"), &phone.field());
            assert!(error_deg < 8.0, "{error_deg} deg at {k}");
        }
    }
}

#[test]
fn at_rest_nothing_is_learned_and_the_reading_says_so() {
    let mut phone = Phone::new(4);
    let mut compensator = compensator(Method::Auto);
    phone.run(&mut compensator, 1500);
    phone.moving = false;
    phone.run(&mut compensator, 200);
    let before = compensator.calibration().expect("calibrated");
    // a magnet beside a phone that lies still
    phone.truth = phone_like(1.5);
    let reading = phone.run(&mut compensator, 1000);
    let after = compensator.calibration().expect("kept");
    assert!((after.hard_iron_ut() - before.hard_iron_ut()).norm() < 0.1);
    let held = matches!(reading.status, Status::Held(HoldReason::AtRest) | Status::Suspect { .. });
    assert!(held, "{}", reading.status);
    assert!(angle_deg(&reading.filtered_field_ut.expect("carried"), &phone.field()) < 2.0);
}

#[test]
fn a_kept_calibration_answers_from_the_second_sample() {
    let truth = phone_like(1.0);
    let config = Config { initial: Some(truth), ..Config::default() };
    let mut compensator = Compensator::new(config).expect("a valid config");
    assert_eq!(compensator.calibration(), Some(truth));
    let mut phone = Phone::new(5);
    phone.advance(&mut compensator);
    for _ in 0..300 {
        let reading = phone.advance(&mut compensator);
        let corrected = reading.field_ut.expect("calibrated from the start");
        assert!(angle_deg(&corrected, &phone.field()) < 6.0, "{corrected}");
    }
}

#[test]
fn without_any_motion_it_goes_on_collecting() {
    let mut phone = Phone::new(6);
    phone.moving = false;
    let mut compensator = compensator(Method::Aided);
    let reading = phone.run(&mut compensator, 2000);
    assert_eq!(reading.status, Status::Collecting(Missing::Rotation));
    assert_eq!((reading.field_ut, compensator.calibration()), (None, None));
}

#[test]
fn after_a_pause_of_all_sensors_it_goes_on_at_once_less_sure() {
    let mut phone = Phone::new(7);
    let mut compensator = compensator(Method::Auto);
    let before = phone.run(&mut compensator, 1500).heading.and_then(|h| h.heading_sigma_deg).expect("tracking");
    phone.k += 500;
    let reading = phone.advance(&mut compensator);
    assert!(reading.field_ut.is_some());
    let after = reading.heading.and_then(|heading| heading.heading_sigma_deg).expect("the calibration is kept");
    assert!(after > before, "{after} against {before}");
    phone.run(&mut compensator, 200);
    let reading = phone.advance(&mut compensator);
    assert!(angle_deg(&reading.filtered_field_ut.expect("carried"), &phone.field()) < 2.0);
}
