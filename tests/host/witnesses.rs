//! Three witnesses: gyroscope, gravity and field. A sensor that the two others contradict is not used, and headings from outside need no magnetometer.

use magcomp::nalgebra::{Matrix3, Rotation3, Vector3};
use magcomp::{
    Compensator, Config, HeadedAxis, HeadingSample, MagneticSample, NorthReference, Reading, RejectReason,
    RotationRateSample, SensorMode, Status, UpSample,
};
use magcomp_tests::Random;

const FIELD_UT: Vector3<f64> = Vector3::new(0.0, 21.0, -43.0);
const HARD_IRON_UT: Vector3<f64> = Vector3::new(30.0, -20.0, 45.0);

/// A phone in a hand at 50 Hz, about level, whose sensors read their vectors in these axes.
struct Phone {
    random: Random,
    attitude: Rotation3<f64>,
    tick: i64,
    field: Matrix3<f64>,
    rates: Matrix3<f64>,
    /// How it is accelerated, m/s^2 east, north and up, at a time, s.
    moved: fn(f64) -> Vector3<f64>,
}

impl Phone {
    fn new(seed: u64) -> Self {
        let sound = Matrix3::identity();
        Self {
            random: Random::new(seed),
            attitude: Rotation3::identity(),
            tick: 0,
            field: sound,
            rates: sound,
            moved: |_| Vector3::zeros(),
        }
    }

    fn time_ns(&self) -> i64 {
        self.tick * 20_000_000
    }

    fn advance(&mut self, to: &mut Compensator) -> Reading {
        let t = self.tick as f64 * 0.02;
        let rate = Vector3::new((0.9 * t).sin(), 0.7 * (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin()) * 0.8;
        self.attitude *= Rotation3::new(rate * 0.02);
        self.tick += 1;
        let time_ns = self.time_ns();
        let rate_rad_s = self.rates * rate + Vector3::new(0.01, -0.02, 0.015) + self.random.normal3() * 0.003;
        to.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s }).unwrap();
        let up_m_s2 =
            self.attitude.inverse() * (Vector3::new(0.0, 0.0, 9.81) + (self.moved)(t)) + self.random.normal3() * 0.1;
        to.push_up(UpSample { time_ns, up_m_s2 }).unwrap();
        let field_ut = self.field * (self.attitude.inverse() * FIELD_UT + HARD_IRON_UT) + self.random.normal3() * 0.5;
        to.push(MagneticSample { time_ns, field_ut })
    }

    fn heading_deg(&self) -> f64 {
        let top = self.attitude * Vector3::y();
        top.x.atan2(top.y).to_degrees()
    }

    fn error_deg(&self, heading_deg: f64) -> f64 {
        ((heading_deg - self.heading_deg() + 540.0).rem_euclid(360.0) - 180.0).abs()
    }
}

fn compensator() -> Compensator {
    Compensator::new(Config::default()).unwrap()
}

fn rows(rows: [f64; 9]) -> Matrix3<f64> {
    Matrix3::from_row_slice(&rows)
}

/// The axes are told while they are wrong and never `Tracking`; once both sensors have the same axes the samples are used again.
#[test]
fn a_magnetometer_in_other_axes_is_refused_with_their_names_until_it_is_mended() {
    for (seed, wrong, told) in [
        (1, rows([0.0, 1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0]), (2, 1, 3)),
        (2, rows([0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0]), (-2, 1, 3)),
        (3, rows([-1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0]), (-1, 2, 3)),
    ] {
        let (mut phone, mut it) = (Phone::new(seed), compensator());
        phone.field = wrong;
        let mut tracked = 0;
        for k in 0..3000 {
            let reading = phone.advance(&mut it);
            tracked += usize::from(reading.status == Status::Tracking);
            if k >= 1000 {
                let Status::Rejected(RejectReason::Axes { x, y, z }) = reading.status else { panic!("{reading:?}") };
                assert_eq!(((x, y, z), reading.heading.is_none()), (told, true), "{seed}");
            }
        }
        assert!(tracked < 50, "{seed}: {tracked} samples");
        phone.field = Matrix3::identity();
        let readings: Vec<Reading> = (0..3000).map(|_| phone.advance(&mut it)).collect();
        let last = readings.last().unwrap();
        assert_eq!(last.status, Status::Tracking, "{seed}");
        assert!(phone.error_deg(last.heading.unwrap().heading_deg) < 3.0, "{seed}: {last:?}");
    }
}

#[test]
fn its_text_says_what_to_type() {
    let told = Status::Rejected(RejectReason::Axes { x: 2, y: -1, z: 3 }).to_string();
    assert!(told.contains("y,-x,z"), "{told}");
}

/// Gravity and field both say so: the magnetometer alone answers, and no sample is refused.
#[test]
fn a_gyroscope_with_a_flipped_axis_is_put_out_of_use_and_no_other_sensor_is_blamed() {
    let (mut phone, mut it) = (Phone::new(5), compensator());
    phone.rates = rows([1.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0, 1.0]);
    let readings: Vec<Reading> = (0..4000).map(|_| phone.advance(&mut it)).collect();
    assert!(readings.iter().all(|it| !matches!(it.status, Status::Rejected(_))));
    assert!(phone.error_deg(readings[3999].heading.unwrap().heading_deg) < 8.0, "{:?}", readings[3999]);
}

/// A magnetometer that reads NaN alone, and a course each second: a heading from the first one on, as sure as the course, and no dip.
#[test]
fn a_course_each_second_and_no_magnetometer_give_headings() {
    for seed in 10..14 {
        let (mut phone, mut it) = (Phone::new(seed), compensator());
        phone.field = Matrix3::repeat(f64::NAN);
        let (mut errors_deg2, mut normal) = (0.0, 0.0);
        for k in 0..6000 {
            if k % 50 == 10 {
                let heading_deg = (phone.heading_deg() + phone.random.normal3().x * 3.0) % 360.0;
                let (reference, axis) = (NorthReference::Magnetic, HeadedAxis::Device(Vector3::y()));
                let time_ns = phone.time_ns();
                it.push_heading(HeadingSample { time_ns, heading_deg, sigma_deg: 4.0, reference, axis }).unwrap();
            }
            let reading = phone.advance(&mut it);
            assert_eq!(reading.status, Status::Rejected(RejectReason::NotFinite));
            let Some(heading) = reading.heading else {
                // the edge may be steep for a moment, where no course tells anything
                assert!(k <= 60, "{seed}, {k}: {reading:?}");
                continue;
            };
            let (error_deg, sigma_deg) = (phone.error_deg(heading.heading_deg), heading.heading_sigma_deg.unwrap());
            assert!(heading.inclination_deg.is_none() && error_deg < 4.0 * sigma_deg, "{seed}, {k}: {reading:?}");
            errors_deg2 += error_deg * error_deg / 6000.0;
            normal += (error_deg / sigma_deg).powi(2) / 6000.0;
        }
        assert!(errors_deg2.sqrt() < 4.5 && (0.05..1.5).contains(&normal), "{seed}: {} {normal}", errors_deg2.sqrt());
    }
}

/// Nobody of the three is blamed where all are sound, however the device is moved: to and fro, tapped each second, on an engine, shaken.
#[test]
fn sound_sensors_that_are_moved_are_all_believed() {
    let to_and_fro: fn(f64) -> Vector3<f64> = |t| Vector3::new((4.1 * t).sin(), (2.9 * t).cos(), (5.3 * t).sin()) * 3.0;
    let tapped: fn(f64) -> Vector3<f64> = |t| Vector3::new(12.0, -8.0, 30.0) * f64::from(t.fract() < 0.03);
    let vibrated: fn(f64) -> Vector3<f64> =
        |t| Vector3::new((150.0 * t).sin(), (170.0 * t).cos(), (190.0 * t).sin()) * 8.0;
    let shaken: fn(f64) -> Vector3<f64> = |t| Vector3::new((19.0 * t).sin(), (21.0 * t).cos(), (23.0 * t).sin()) * 10.0;
    for (name, moved) in [("to and fro", to_and_fro), ("tapped", tapped), ("vibrated", vibrated), ("shaken", shaken)] {
        for seed in 20..24 {
            let (mut phone, mut it) = (Phone { moved, ..Phone::new(seed) }, compensator());
            let readings: Vec<Reading> = (0..6000).map(|_| phone.advance(&mut it)).collect();
            let blamed = readings
                .iter()
                .skip(500)
                .filter(|it| matches!(it.status, Status::Rejected(_)) || it.mode != SensorMode::GyroscopeAndGravity)
                .count();
            let answered = readings.iter().skip(500).filter(|it| it.heading.is_some()).count();
            println!("{name} {seed}: blamed {blamed}, answered {answered} of 5500");
            assert_eq!((blamed, answered), (0, 5500), "{name}, {seed}");
        }
    }
}
