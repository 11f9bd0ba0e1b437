//! A magnetometer that repeats its reading to the last bit: at rest that is rest, while the phone turns it hangs.

use magcomp::nalgebra::Vector3;
use magcomp::{Compensator, Config, MagneticSample, Method, Reading, RejectReason, Status};
use magcomp_tests::{METHODS, PERIOD_NS, Phone, REF, calibration};

/// Which of gyroscope and gravity speak.
const WITNESSES: [(bool, bool); 3] = [(true, true), (true, false), (false, true)];

/// A phone whose magnetometer has no noise, and a last bit.
struct Coarse {
    phone: Phone,
    it: Compensator,
    last_bit_ut: f64,
    hangs_at_ut: Option<Vector3<f64>>,
}

impl Coarse {
    fn new(method: Method, (gyroscope, accelerometer): (bool, bool), last_bit_ut: f64) -> Self {
        let mut phone = Phone::new(8, calibration(&REF, 45.0));
        (phone.gyroscope, phone.accelerometer) = (gyroscope, accelerometer);
        // which learns nothing without a gyroscope
        let initial = (method == Method::Aided && !gyroscope).then_some(phone.truth);
        let it = Compensator::new(Config { method, initial, ..Config::default() }).expect("a valid config");
        Self { phone, it, last_bit_ut, hangs_at_ut: None }
    }

    /// After half a minute in a hand.
    fn learned(method: Method, witnesses: (bool, bool), last_bit_ut: f64) -> Self {
        let mut it = Self::new(method, witnesses, last_bit_ut);
        it.run(30.0, true);
        assert!(it.it.calibration().is_some(), "{method:?}, {witnesses:?}");
        it
    }

    fn advance(&mut self) -> Reading {
        let MagneticSample { time_ns, .. } = self.phone.sample(&mut self.it);
        let field_ut = self.phone.truth.distort(&(self.phone.attitude().inverse() * self.phone.field_ut));
        let read_ut = (field_ut / self.last_bit_ut).map(f64::round) * self.last_bit_ut;
        self.it.push(MagneticSample { time_ns, field_ut: self.hangs_at_ut.unwrap_or(read_ut) })
    }

    fn run(&mut self, seconds: f64, moving: bool) -> Vec<Reading> {
        self.phone.moving = moving;
        (0..(seconds * 1e9) as i64 / PERIOD_NS).map(|_| self.advance()).collect()
    }

    /// It repeats from here on what it reads now.
    fn hang(&mut self) {
        let field_ut = self.phone.truth.distort(&(self.phone.attitude().inverse() * self.phone.field_ut));
        self.hangs_at_ut = Some((field_ut / self.last_bit_ut).map(f64::round) * self.last_bit_ut);
    }

    fn error_deg(&self, reading: &Reading) -> Option<(f64, f64)> {
        let heading = reading.heading?;
        let off = heading.heading_deg - self.phone.heading_deg();
        Some((((off + 540.0).rem_euclid(360.0) - 180.0).abs(), heading.heading_sigma_deg?))
    }
}

fn is_stuck(reading: &Reading) -> bool {
    matches!(reading.status, Status::Rejected(RejectReason::Stuck { .. }))
}

#[test]
fn at_rest_a_reading_that_repeats_is_used_for_minutes() {
    for method in METHODS {
        for witnesses in WITNESSES {
            let last_bits_ut: &[f64] = if method == Method::Auto { &[1e-9, 1.0] } else { &[1.0] };
            for &last_bit_ut in last_bits_ut {
                let mut it = Coarse::learned(method, witnesses, last_bit_ut);
                let readings = it.run(120.0, false);
                let refused = readings.iter().filter(|it| matches!(it.status, Status::Rejected(_))).count();
                assert_eq!(refused, 0, "{method:?}, {witnesses:?}, {last_bit_ut} uT");
                assert!(readings.iter().all(|it| it.field_ut.is_some()));
                // and on from there
                let readings = it.run(10.0, true);
                let refused = readings.iter().filter(|it| matches!(it.status, Status::Rejected(_))).count();
                assert_eq!(refused, 0, "{method:?}, {witnesses:?}, {last_bit_ut} uT");
                assert!(readings.last().is_some_and(|it| it.field_ut.is_some()));
            }
        }
    }
}

/// Headings at rest and after it, by the estimators of a phone.
#[test]
fn headings_of_a_coarse_sensor_at_rest_err_as_their_sigma_says() {
    for witnesses in [(true, true), (false, true)] {
        let mut it = Coarse::learned(Method::Auto, witnesses, 1.0);
        for moving in [false, true] {
            for _ in 0..6 {
                let reading = it.run(20.0, moving).pop().expect("a reading");
                let (off, sigma) = it.error_deg(&reading).unwrap_or((0.0, 90.0));
                // the magnetometer alone takes its noise for a magnet that slides
                let most_deg = if witnesses.0 { 5.0 } else { 20.0 };
                assert!(off < 3.0 * sigma && sigma < most_deg, "{witnesses:?}, moving {moving}: {off} at {sigma}");
            }
        }
    }
}

/// From a hundred samples on, whoever the witness is; any other reading takes it back, and a hang in motion goes on at rest.
#[test]
fn a_hang_in_motion_is_refused_until_another_reading_comes() {
    for method in METHODS {
        for witnesses in WITNESSES {
            let mut it = Coarse::learned(method, witnesses, 0.1);
            it.hang();
            let readings = it.run(5.0, true);
            let first = readings.iter().position(is_stuck).expect("it hangs");
            assert!((48..=150).contains(&first), "{method:?}, {witnesses:?}: {first}");
            assert!(readings[first..].iter().all(is_stuck), "{method:?}, {witnesses:?}");
            assert!(it.run(60.0, false).iter().all(is_stuck), "{method:?}, {witnesses:?}");
            it.hangs_at_ut = None;
            assert!(!it.run(60.0, true).iter().any(is_stuck), "{method:?}, {witnesses:?}");
        }
    }
}

#[test]
fn a_hang_that_begins_at_rest_is_told_once_the_phone_is_moved() {
    for witnesses in WITNESSES {
        let mut it = Coarse::learned(Method::Auto, witnesses, 1.0);
        it.hang();
        assert!(!it.run(120.0, false).iter().any(is_stuck), "{witnesses:?}");
        let readings = it.run(5.0, true);
        let first = readings.iter().position(is_stuck).expect("it hangs");
        assert!(first <= 150 && readings[first..].iter().all(is_stuck), "{witnesses:?}: {first}");
    }
}

/// Nobody tells rest from a hang: no reading is better than one that may be wrong, and there is no heading without gravity anyway.
#[test]
fn without_gyroscope_and_gravity_a_reading_that_repeats_is_a_hang() {
    let mut it = Coarse::learned(Method::Auto, (false, false), 1.0);
    it.hang();
    let readings = it.run(2.0, false);
    assert!(readings.iter().position(is_stuck).is_some_and(|first| first <= 50), "{readings:?}");
    // gravity comes, and says that it rests
    it.phone.accelerometer = true;
    assert!(!it.run(60.0, false).iter().any(is_stuck));
    // and is gone again
    it.phone.accelerometer = false;
    let readings = it.run(2.0, false);
    assert!(!is_stuck(&readings[10]) && is_stuck(&readings[100]));
}
