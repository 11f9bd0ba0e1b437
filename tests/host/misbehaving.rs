//! Streams that misbehave: stamps far ahead, a gyroscope that stutters, sleep that the clock does not show.

use magcomp::nalgebra::{Rotation3, Unit, Vector3};
use magcomp::{
    Axis, Calibration, Compensator, Config, MagneticSample, Reading, RejectReason, RotationRateSample, SensorMode,
    Status, UpSample,
};
use magcomp_tests::{REF, Random, calibration};

const FIELD_UT: Vector3<f64> = Vector3::new(0.0, 21.0, -43.0);
const PERIOD_NS: i64 = 10_000_000;

/// A phone that is turned about in a hand at 100 Hz.
struct Phone {
    random: Random,
    attitude: Rotation3<f64>,
    truth: Calibration,
    time_ns: i64,
    tick: i64,
    full_scale_ut: f64,
}

impl Phone {
    fn new(seed: u64) -> Self {
        let mut random = Random::new(seed);
        let axis = Unit::new_normalize(random.normal3());
        let attitude = Rotation3::from_axis_angle(&axis, random.between(-3.1, 3.1));
        let truth = calibration(&REF.map(|v| v * 0.5 + 0.5 * f64::from(u8::from(v > 0.9))), FIELD_UT.norm());
        Self { random, attitude, truth, time_ns: 0, tick: 0, full_scale_ut: f64::MAX }
    }

    /// One sample; its gyroscope event is delivered where `gyroscope` says so.
    fn advance(&mut self, to: &mut Compensator, gyroscope: impl Fn(i64) -> bool) -> Reading {
        let t = self.tick as f64 * 0.01;
        let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin());
        self.attitude *= Rotation3::new(rate * 0.01);
        (self.tick, self.time_ns) = (self.tick + 1, self.time_ns + PERIOD_NS);
        let (time_ns, tick) = (self.time_ns, self.tick);
        let rate_rad_s = rate + Vector3::new(0.01, -0.02, 0.015) + self.random.normal3() * 0.003;
        if gyroscope(tick) {
            to.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s }).unwrap();
        }
        let up_m_s2 = self.attitude.inverse() * Vector3::new(0.0, 0.0, 9.81) + self.random.normal3() * 0.05;
        to.push_up(UpSample { time_ns, up_m_s2 }).unwrap();
        let field_ut = self.truth.distort(&(self.attitude.inverse() * FIELD_UT)) + self.random.normal3() * 0.5;
        let field_ut = field_ut.map(|v| v.clamp(-self.full_scale_ut, self.full_scale_ut));
        to.push(MagneticSample { time_ns, field_ut })
    }

    /// Error of the heading and its sigma, deg.
    fn error_deg(&self, reading: &Reading) -> Option<(f64, f64)> {
        let axis = Config::default().heading.axis;
        let heading = reading.heading?;
        let up = self.attitude.inverse() * Vector3::z();
        // as the compensator chooses the axis: the true heading comes from the true field
        let truth = magcomp::heading(&(self.attitude.inverse() * FIELD_UT), &up, axis, magcomp::ScreenRotation::Deg0)?;
        let off = heading.heading_deg - truth.heading_deg;
        Some((((off + 540.0).rem_euclid(360.0) - 180.0).abs(), heading.heading_sigma_deg?))
    }
}

fn compensator() -> Compensator {
    Compensator::new(Config::default()).unwrap()
}

#[test]
fn a_gyroscope_event_stamped_far_ahead_is_left_out() {
    for (seed, ahead_s) in [1.5, 3.0, 9.9].into_iter().enumerate() {
        let (mut phone, mut it) = (Phone::new(100 + seed as u64), compensator());
        (0..1500).for_each(|_| _ = phone.advance(&mut it, |_| true));
        let mut other = it.clone();
        let stray = RotationRateSample {
            time_ns: phone.time_ns + (ahead_s * 1e9) as i64,
            rate_rad_s: Vector3::new(5.0, -3.0, 4.0),
        };
        it.push_rotation_rate(stray).unwrap();
        let mut again = Phone::new(100 + seed as u64);
        (0..1500).for_each(|_| _ = again.advance(&mut compensator(), |_| true));
        for k in 0..1200 {
            let (found, expected) = (phone.advance(&mut it, |_| true), again.advance(&mut other, |_| true));
            // the next event tells that the stray one was wrong, so nothing differs
            assert_eq!(found, expected, "{ahead_s} s ahead, sample {k}");
        }
        assert_eq!(it.gaps(), 0);
    }
}

/// A gyroscope that never is there for long is no reason for silence: the magnetometer alone answers.
#[test]
fn a_gyroscope_that_stutters_never_means_silence() {
    type Delivered = fn(i64) -> bool;
    let cases: [(&str, Delivered); 2] = [("gone 0.3 s in each second", |k| k % 100 >= 30), ("3 Hz", |k| k % 33 == 0)];
    for (name, delivered) in cases {
        let (mut told, mut looked, mut within) = (0, 0, 0);
        for seed in 0..6 {
            let (mut phone, mut it) = (Phone::new(200 + seed), compensator());
            for k in 0..4000 {
                let reading = phone.advance(&mut it, delivered);
                if k >= 2000 {
                    looked += 1;
                    if let Some((off, sigma)) = phone.error_deg(&reading) {
                        told += 1;
                        within += i32::from(off < 2.0 * sigma);
                    }
                }
            }
            assert!(it.gaps() > 0, "{name}: no gap was counted");
        }
        assert!(told * 10 >= looked * 9, "{name}: {told} of {looked} samples have a heading");
        assert!(within * 10 >= told * 9, "{name}: {within} of {told} headings within two sigmas");
    }
}

/// Sleep that the clock does not show: the phone was turned, and in half of the runs changed, meanwhile.
#[test]
fn after_a_hidden_gap_headings_err_as_their_sigma_says() {
    let (mut told, mut within, mut tracked, mut sigmas) = (0, 0, 0, Vec::new());
    for seed in 0..20 {
        let (mut phone, mut it) = (Phone::new(300 + seed), compensator());
        (0..2000).for_each(|_| _ = phone.advance(&mut it, |_| true));
        let turn = Unit::new_normalize(phone.random.normal3());
        phone.attitude *= Rotation3::from_axis_angle(&turn, 2.0);
        if seed % 2 == 0 {
            let b = phone.truth.hard_iron_ut() + phone.random.normal3().normalize() * 25.0;
            phone.truth = Calibration::new(*phone.truth.soft_iron(), b, FIELD_UT.norm()).unwrap();
        }
        it.push_gap(600.0).unwrap();
        for k in 0..500 {
            let reading = phone.advance(&mut it, |_| true);
            tracked += i32::from(k == 0 && reading.status == Status::Tracking);
            if let Some((off, sigma)) = phone.error_deg(&reading) {
                told += 1;
                within += i32::from(off < 2.0 * sigma);
                if k < 20 && seed % 2 == 1 {
                    sigmas.push(sigma);
                }
            }
        }
        assert_eq!(it.gaps(), 1);
        assert!(it.keep(0).is_some(), "what was learned is still there to be kept");
    }
    assert!(within * 10 >= told * 9, "{within} of {told} headings within two sigmas");
    assert_eq!(tracked, 0, "tracking before a live sample");
    sigmas.sort_by(f64::total_cmp);
    let median_deg = sigmas[sigmas.len() / 2];
    assert!((2.0..12.0).contains(&median_deg), "sigma of {median_deg} deg where nothing changed");
}

#[test]
fn a_gap_is_a_time_or_it_is_refused() {
    let (mut phone, mut it) = (Phone::new(1), compensator());
    (0..600).for_each(|_| _ = phone.advance(&mut it, |_| true));
    let before = it.clone();
    for hidden_s in [-1.0, f64::NAN, f64::INFINITY, 2e9] {
        assert_eq!(it.push_gap(hidden_s).unwrap_err().field, "hidden_s");
        assert!(it == before, "{hidden_s}: the state has changed");
    }
}

#[test]
fn a_saturated_sample_names_its_axis() {
    let mut it = Compensator::new(Config { rail_ut: Some(800.0), ..Config::default() }).unwrap();
    for (axis, name, field_ut) in [
        (Axis::X, "x", Vector3::new(-800.0, 1.0, 2.0)),
        (Axis::Y, "y", Vector3::new(1.0, 900.0, 2.0)),
        (Axis::Z, "z", Vector3::new(1.0, 2.0, -801.0)),
    ] {
        let Status::Rejected(reason) = it.push(MagneticSample { time_ns: 1, field_ut }).status else { panic!("taken") };
        assert!(matches!(reason, RejectReason::Saturated { axis: found, .. } if found == axis), "{reason:?}");
        assert!(reason.to_string().starts_with(&format!("field component {name} ")), "{reason}");
    }
}

/// Charging for three seconds: 900 uT along x, which reads no more than 300.
fn charged(phone: &mut Phone, it: &mut Compensator, gyroscope: bool) -> Vec<Reading> {
    let truth = phone.truth;
    let hard_iron_ut = truth.hard_iron_ut() + Vector3::new(900.0, 0.0, 0.0);
    phone.truth = Calibration::new(*truth.soft_iron(), hard_iron_ut, truth.field_strength_ut()).unwrap();
    phone.full_scale_ut = 300.0;
    let readings = (0..300).map(|_| phone.advance(it, |_| gyroscope)).collect();
    phone.truth = truth;
    readings
}

#[test]
fn at_full_scale_the_gyroscope_carries_heading_and_field_and_nothing_is_learned() {
    for rail_ut in [Some(300.0), None] {
        let (mut phone, mut it) = (Phone::new(3), Compensator::new(Config { rail_ut, ..Config::default() }).unwrap());
        (0..1500).for_each(|_| _ = phone.advance(&mut it, |_| true));
        let before = it.calibration().unwrap();
        let readings = charged(&mut phone, &mut it, true);
        let is_saturated = |it: &Reading| matches!(it.status, Status::Rejected(RejectReason::Saturated { .. }));
        // it takes some samples until a full scale that nobody told is found
        assert!(readings.iter().skip(50).all(is_saturated), "{rail_ut:?}");
        for reading in readings.iter().filter(|it| is_saturated(it)) {
            assert_eq!((reading.field_ut, reading.mode), (None, SensorMode::GyroscopeAndGravity));
            let (carried_ut, heading) = (reading.filtered_field_ut.unwrap(), reading.attitude.unwrap());
            assert!((carried_ut.norm() - FIELD_UT.norm()).abs() < 2.0, "{rail_ut:?}: {carried_ut}");
            assert!(heading.sigma_deg.unwrap() < 10.0);
        }
        let reading = readings.last().unwrap();
        let carried_ut = phone.attitude * reading.filtered_field_ut.unwrap();
        assert!(carried_ut.angle(&FIELD_UT).to_degrees() < 2.0, "{rail_ut:?}: {carried_ut}");
        let moved_ut = (it.calibration().unwrap().hard_iron_ut() - before.hard_iron_ut()).norm();
        assert!(moved_ut < 1.0, "{rail_ut:?}: {moved_ut}");
        assert_eq!(reading.event, None);
        // the charger is gone
        let readings: Vec<Reading> = (0..300).map(|_| phone.advance(&mut it, |_| true)).collect();
        assert!(readings.iter().all(|it| !is_saturated(it)) && readings.iter().all(|it| it.event.is_none()));
        let (error_deg, sigma_deg) = phone.error_deg(readings.last().unwrap()).unwrap();
        assert!(error_deg < 3.0 && sigma_deg < 6.0, "{rail_ut:?}: {error_deg} at {sigma_deg}");
    }
}

#[test]
fn at_full_scale_the_magnetometer_alone_says_nothing() {
    let mut it = Compensator::new(Config { rail_ut: Some(300.0), ..Config::default() }).unwrap();
    let mut phone = Phone::new(4);
    (0..3000).for_each(|_| _ = phone.advance(&mut it, |_| false));
    assert!(phone.advance(&mut it, |_| false).attitude.is_some());
    let readings = charged(&mut phone, &mut it, false);
    assert!(readings.iter().all(|it| it.attitude.is_none() && it.filtered_field_ut.is_none()));
}

/// The chain of rotations breaks while the sensor is at its full scale: the calibration is kept, and where the field points is found anew.
#[test]
fn a_gyroscope_that_stops_at_full_scale_loses_the_heading_and_not_the_calibration() {
    let mut it = Compensator::new(Config { rail_ut: Some(300.0), ..Config::default() }).unwrap();
    let mut phone = Phone::new(5);
    (0..1500).for_each(|_| _ = phone.advance(&mut it, |_| true));
    let before = it.calibration().unwrap();
    let last = *charged(&mut phone, &mut it, false).last().unwrap();
    assert!(last.heading.is_none() && last.filtered_field_ut.is_none(), "{last:?}");
    (0..500).for_each(|_| _ = phone.advance(&mut it, |_| true));
    let reading = phone.advance(&mut it, |_| true);
    let (error_deg, sigma_deg) = phone.error_deg(&reading).unwrap();
    assert!(error_deg < 4.0 + 2.0 * sigma_deg, "{error_deg} at {sigma_deg}");
    assert!((it.calibration().unwrap().hard_iron_ut() - before.hard_iron_ut()).norm() < 3.0);
}

#[test]
fn at_full_scale_time_passes() {
    let mut it = Compensator::new(Config { rail_ut: Some(300.0), ..Config::default() }).unwrap();
    let mut phone = Phone::new(6);
    (0..1500).for_each(|_| _ = phone.advance(&mut it, |_| true));
    let latest_ns = phone.time_ns + PERIOD_NS;
    let status = |it: &mut Compensator, x_ut| {
        it.push(MagneticSample { time_ns: latest_ns, field_ut: Vector3::new(x_ut, 5.0, 5.0) }).status
    };
    assert!(matches!(status(&mut it, 300.0), Status::Rejected(RejectReason::Saturated { .. })));
    let late = RejectReason::TimeNotAfter { time_ns: latest_ns, latest_ns };
    assert_eq!((status(&mut it, 300.0), status(&mut it, 30.0)), (Status::Rejected(late), Status::Rejected(late)));
}

/// The device changes, and while it is not decided whether it did, a charger comes for three seconds.
#[test]
fn a_change_that_is_in_doubt_is_found_after_full_scale() {
    for seed in 7..12 {
        let mut it = Compensator::new(Config { rail_ut: Some(300.0), ..Config::default() }).unwrap();
        let mut phone = Phone::new(seed);
        (0..1500).for_each(|_| _ = phone.advance(&mut it, |_| true));
        let truth = phone.truth;
        let hard_iron_ut = truth.hard_iron_ut() + Vector3::new(20.0, -25.0, 10.0);
        phone.truth = Calibration::new(*truth.soft_iron(), hard_iron_ut, truth.field_strength_ut()).unwrap();
        (0..20).for_each(|_| _ = phone.advance(&mut it, |_| true));
        assert!(matches!(phone.advance(&mut it, |_| true).status, Status::Suspect { .. }));
        charged(&mut phone, &mut it, true);
        (0..100).for_each(|_| _ = phone.advance(&mut it, |_| true));
        let carried_ut = phone.attitude * phone.advance(&mut it, |_| true).filtered_field_ut.unwrap();
        assert!(carried_ut.angle(&FIELD_UT).to_degrees() < 3.0, "{seed}: {carried_ut}");
        let off_ut = (it.calibration().unwrap().hard_iron_ut() - hard_iron_ut).norm();
        assert!(off_ut < 5.0, "{seed}: {off_ut}");
    }
}

/// What is documented for every method is there with a gyroscope, too.
#[test]
fn sigma_t_and_the_directions_sigma_are_formed_with_a_gyroscope() {
    let (mut phone, mut it) = (Phone::new(2), compensator());
    (0..1500).for_each(|_| _ = phone.advance(&mut it, |_| true));
    let reading = phone.advance(&mut it, |_| true);
    assert_eq!(reading.mode, SensorMode::GyroscopeAndGravity);
    let (sigma_t, direction_deg) = (reading.sigma_t.unwrap(), reading.direction_sigma_deg.unwrap());
    assert!((0.05..1.5).contains(&sigma_t), "{sigma_t}");
    assert!((0.01..3.0).contains(&direction_deg), "{direction_deg}");
    let expected = magcomp::direction_sigma_deg(&it.calibration().unwrap(), &it.covariance().unwrap());
    // formed anew once a second
    assert!((0.7..1.4).contains(&(direction_deg / expected)), "{direction_deg} for {expected}");
}
