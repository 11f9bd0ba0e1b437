mod by_hand;

use super::*;
use crate::estimator::answer::Carry;
use crate::level::Level;
use nalgebra::Rotation3;

const STEP_NS: i64 = 20_000_000;
const TILT: [f64; 3] = [0.3, -0.2, 0.0];

/// A device that turns about the vertical under a field that points north by itself, off by `off_deg`, sigma `sigma_deg`.
struct Device {
    attitude: Rotation3<f64>,
    time_ns: i64,
    rate_rad_s: f64,
    off_deg: f64,
    sigma_deg: f64,
    bias_rad_s: f64,
}

impl Device {
    fn new(off_deg: f64, sigma_deg: f64) -> Self {
        let attitude = Rotation3::new(Vector3::from(TILT));
        Self { attitude, time_ns: 0, rate_rad_s: 0.4, off_deg, sigma_deg, bias_rad_s: 0.0 }
    }

    fn answer(&mut self) -> Answer {
        self.time_ns += STEP_NS;
        let up = self.attitude.inverse() * Vector3::z();
        let turn = Rotation3::new(up * self.rate_rad_s * STEP_NS as f64 * 1e-9);
        self.attitude *= turn;
        let (sin, cos) = self.off_deg.to_radians().sin_cos();
        // north that is found is clockwise of the true one by off_deg
        let field = self.attitude.inverse() * Vector3::new(20.0 * sin, 20.0 * cos, -40.0);
        let across = 20.0 * self.sigma_deg.to_radians();
        Answer {
            filtered_field_ut: Some(field),
            filtered_covariance_ut2: Some(Matrix3::identity() * across * across),
            up: Some(self.attitude.inverse() * Vector3::z()),
            carry: Some(carry(turn.inverse().into_inner(), self.bias_rad_s, STEP_NS as f64 * 1e-9, up)),
            ..Answer::default()
        }
    }

    fn top_deg(&self) -> f64 {
        let top = self.attitude * Vector3::y();
        top.x.atan2(top.y).to_degrees()
    }

    fn told(&self, off_deg: f64, sigma_deg: f64) -> HeadingSample {
        HeadingSample {
            time_ns: self.time_ns,
            heading_deg: (self.top_deg() + off_deg) % 360.0,
            sigma_deg,
            reference: NorthReference::Magnetic,
            axis: HeadedAxis::Device(Vector3::y()),
        }
    }

    /// How far north is clockwise of the true one, degrees.
    fn error_deg(&self, answer: &Answer) -> f64 {
        let north = self.attitude * answer.filtered_field_ut.unwrap();
        north.x.atan2(north.y).to_degrees()
    }
}

impl North {
    fn stepped(&mut self, time_ns: i64, mut answer: Answer, declination_deg: Option<f64>) -> Answer {
        self.step(time_ns, &mut answer, declination_deg);
        answer
    }
}

/// A turn of a gyroscope whose bias is known to so much.
fn carry(turn: Matrix3<f64>, bias_rad_s: f64, span_s: f64, up: Vector3<f64>) -> Carry {
    let (bias_rad2_s2, up) = (bias_rad_s * bias_rad_s, Some(up));
    Carry { turn, up, tilt_rad2: 0.0, bias_rad2_s2, is_bias_told: true, span_s, noise_rad2: 0.0 }
}

/// Plays `seconds`; `tell` makes a heading every second.
fn play(
    north: &mut North,
    device: &mut Device,
    seconds: u32,
    mut tell: impl FnMut(&Device) -> Option<HeadingSample>,
) -> f64 {
    let mut error_deg = 0.0;
    for k in 0..seconds * 50 {
        let answer = device.answer();
        if k % 50 == 0
            && let Some(heading) = tell(device)
        {
            north.push(heading, Some(device.time_ns)).unwrap();
        }
        error_deg = device.error_deg(&north.stepped(device.time_ns, answer, None));
    }
    error_deg
}

#[test]
fn independent_headings_are_averaged_with_the_magnetometers() {
    let (mut north, mut device) = (North::default(), Device::new(12.0, 10.0));
    play(&mut north, &mut device, 1, |device| Some(device.told(0.0, 10.0)));
    let carried = north.carried.clone().unwrap();
    // one of each, equally good: half way, and by the root of two better
    let error_deg = -carried
        .level(&(device.attitude.inverse() * Vector3::z()))
        .told_bearing(&(device.attitude.inverse() * Vector3::y()))
        .unwrap()
        .to_degrees();
    assert!((error_deg - 6.0).abs() < 0.4, "{error_deg}");
    assert!((carried.variance_rad2().sqrt().to_degrees() - 10.0 / 2.0_f64.sqrt()).abs() < 0.2);
    // what is published leans to the better one, and is no surer than it
    let answer = north.stepped(device.time_ns + 1, device.answer(), None);
    let error_deg = device.error_deg(&answer);
    assert!((error_deg - 8.0).abs() < 0.4, "a third of the way back from 6 to 12: {error_deg}");
    let sigma_deg = Own::of(&answer, 0.0).unwrap().variance_rad2.sqrt().to_degrees();
    assert!(
        (7.9..8.7).contains(&sigma_deg),
        "two thirds of 7.1 and one of 10, and what the curvature adds: {sigma_deg}"
    );
    // ten within ten seconds tell no more than two of ten seconds
    play(&mut north, &mut device, 10, |device| Some(device.told(0.0, 10.0)));
    let sigma_deg = north.carried.as_ref().unwrap().variance_rad2().sqrt().to_degrees();
    assert!((5.5..6.0).contains(&sigma_deg), "10 / root 3: {sigma_deg}");
    assert_eq!(north.aid(device.time_ns), Some(HeadingAid::Leads));
}

#[test]
fn a_late_heading_is_that_of_its_own_time() {
    let on_time = {
        let (mut north, mut device) = (North::default(), Device::new(20.0, 15.0));
        play(&mut north, &mut device, 6, |device| (device.time_ns < 1_000_000_000).then(|| device.told(0.0, 5.0)))
    };
    let (mut north, mut device) = (North::default(), Device::new(20.0, 15.0));
    let mut kept = None;
    play(&mut north, &mut device, 5, |device| {
        kept.get_or_insert_with(|| device.told(0.0, 5.0));
        None
    });
    north.push(kept.unwrap(), Some(device.time_ns)).unwrap();
    let late = play(&mut north, &mut device, 1, |_| None);
    assert!(on_time < 5.0 && (late - on_time).abs() < 1e-6, "{on_time} {late}");
    // one that was overtaken by a later one comes too late, as does one of long ago
    assert_eq!(north.push(kept.unwrap(), Some(device.time_ns)), Err(EventRejection::Late));
    let ago = HeadingSample { time_ns: device.time_ns - 5_100_000_000, ..device.told(0.0, 5.0) };
    assert_eq!(North::default().push(ago, Some(device.time_ns)), Err(EventRejection::Late));
}

#[test]
fn bad_headings_are_refused_and_change_nothing() {
    let (mut north, device) = (North::default(), Device::new(0.0, 5.0));
    let good = device.told(0.0, 5.0);
    north.push(good, Some(0)).unwrap();
    let before = north.clone();
    let bad = [
        (HeadingSample { heading_deg: f64::NAN, ..good }, EventRejection::NotFinite),
        (
            HeadingSample { axis: HeadedAxis::Device(Vector3::new(f64::INFINITY, 0.0, 0.0)), ..good },
            EventRejection::NotFinite,
        ),
        (HeadingSample { axis: HeadedAxis::Device(Vector3::zeros()), ..good }, EventRejection::OutOfRange),
        (HeadingSample { sigma_deg: 0.0, ..good }, EventRejection::OutOfRange),
        (HeadingSample { sigma_deg: 181.0, ..good }, EventRejection::OutOfRange),
        (HeadingSample { heading_deg: 361.0, ..good }, EventRejection::OutOfRange),
        (good, EventRejection::Duplicate),
        (HeadingSample { time_ns: 11_000_000_000, ..good }, EventRejection::Ahead),
        (HeadingSample { time_ns: -6_000_000_000, ..good }, EventRejection::Late),
    ];
    for (heading, why) in bad {
        assert_eq!(north.push(heading, Some(0)), Err(why));
        assert_eq!(north, before);
    }
    // times at both ends of what 64 bits hold
    for time_ns in [i64::MIN, i64::MAX] {
        for latest_ns in [i64::MIN, 0, i64::MAX] {
            let _ = North::default().push(HeadingSample { time_ns, ..good }, Some(latest_ns));
        }
    }
}

#[test]
fn half_a_minute_of_a_wrong_source_is_ignored_and_told() {
    let (mut north, mut device) = (North::default(), Device::new(5.0, 8.0));
    let before = play(&mut north, &mut device, 40, |device| Some(device.told(0.0, 8.0)));
    let wrong = play(&mut north, &mut device, 30, |device| Some(device.told(180.0, 8.0)));
    assert!((wrong - before).abs() < 0.5, "{before} {wrong}");
    let heard = north.aid(device.time_ns);
    assert!(matches!(heard, Some(HeadingAid::Disagrees)), "{heard:?}");
    // right again: told at once, and the wrong one is forgotten
    play(&mut north, &mut device, 31, |device| Some(device.told(0.0, 8.0)));
    assert_eq!((north.aid(device.time_ns), &north.rival), (Some(HeadingAid::Leads), &None));
}

#[test]
fn headings_that_say_the_same_for_longer_than_a_minute_are_believed() {
    // the magnetometer is off by 90 degrees and sure of it
    let (mut north, mut device) = (North::default(), Device::new(90.0, 5.0));
    let at = |seconds| {
        let (mut north, mut device) = (North::default(), Device::new(90.0, 5.0));
        play(&mut north, &mut device, seconds, |device| Some(device.told(0.0, 8.0)))
    };
    assert!((at(45) - 90.0).abs() < 1e-6);
    let error_deg = at(65);
    assert!(error_deg.abs() < 1.0, "{error_deg}");
    // what contradicts itself is believed never
    let mut turn_deg = 30.0;
    let error_deg = play(&mut north, &mut device, 200, |device| {
        turn_deg += 120.0;
        Some(device.told(turn_deg % 360.0, 8.0))
    });
    assert!((error_deg - 90.0).abs() < 1e-6, "{error_deg}");
}

#[test]
fn without_headings_nothing_changes_and_north_ends_with_the_chain() {
    let (mut north, mut device) = (North::default(), Device::new(30.0, 5.0));
    for _ in 0..100 {
        let (answer, same) = (device.answer(), device.filtered());
        let out = north.stepped(device.time_ns, answer, None);
        assert_eq!((out.filtered_field_ut, north.aid(device.time_ns)), (Some(same), None));
    }
    play(&mut north, &mut device, 2, |device| Some(device.told(30.0, 1.0)));
    assert!(north.carried.is_some());
    let broken = Answer { carry: None, ..device.answer() };
    north.stepped(device.time_ns, broken, None);
    assert!(north.carried.is_none() && north.rival.is_none());
}

#[test]
fn a_gyroscope_that_drifts_makes_north_less_sure_until_the_magnetometer_knows_more() {
    let (mut north, mut device) = (North::default(), Device::new(-9.0, 10.0));
    device.bias_rad_s = 0.5_f64.to_radians();
    play(&mut north, &mut device, 1, |device| Some(device.told(0.0, 2.0)));
    let sigma_deg = |north: &North| north.carried.as_ref().unwrap().variance_rad2().sqrt().to_degrees();
    let first = sigma_deg(&north);
    play(&mut north, &mut device, 10, |_| None);
    // what its bias adds is no part of what the headings are off by
    let expected_deg = (first * first - 0.5 * 0.5 + 5.5 * 5.5).sqrt();
    assert!((sigma_deg(&north) - expected_deg).abs() < 0.1, "0.5 deg/s for 11 s: {} {expected_deg}", sigma_deg(&north));
    let error_deg = play(&mut north, &mut device, 10, |_| None);
    assert!((error_deg + 9.0).abs() < 1e-6, "{error_deg}");
    assert_ne!(north.aid(device.time_ns), Some(HeadingAid::Leads));
}

#[test]
fn a_mounting_and_a_declination_are_learned_once_for_each_direction() {
    let mut offset = Offset::unknown(10.0, Vector3::x());
    let sigma_rad = 0.2_f64;
    for k in 0..12 {
        offset.learn(1.0, 0.1 * f64::from(k % 3), sigma_rad * sigma_rad);
    }
    assert!((offset.variance_rad2.sqrt() - sigma_rad).abs() < 0.001, "one direction counts once");
    (0..12).for_each(|k| offset.learn(1.0, f64::from(k), sigma_rad * sigma_rad));
    let expected = sigma_rad / 12.0_f64.sqrt();
    assert!((offset.variance_rad2.sqrt() / expected - 1.0).abs() < 0.1, "{}", offset.variance_rad2.sqrt());
    assert!((offset.angle_rad - 1.0).abs() < 0.01);

    let (mut north, mut device) = (North::default(), Device::new(0.0, 4.0));
    let told = |device: &Device| Some(HeadingSample { reference: NorthReference::True, ..device.told(7.0, 3.0) });
    play(&mut north, &mut device, 60, told);
    let (declination_deg, sigma_deg) = north.declination_deg().unwrap();
    assert!((declination_deg - 7.0).abs() < 0.5 && (0.5..2.0).contains(&sigma_deg), "{declination_deg} +- {sigma_deg}");
    assert!(north.mounting.is_none());
}

#[test]
fn an_offset_stays_in_the_variance_until_a_heading_without_one_comes() {
    let own = Own { level: Level::of(&Vector3::y(), &Vector3::z()).unwrap(), variance_rad2: 0.04 };
    let told = |own_rad2, common_rad2| Told {
        axis: Vector3::y(),
        bearing_rad: 0.0,
        own_bearing_rad: 0.0,
        own_rad2,
        common_rad2,
        new_s: 10.0,
        is_vehicle: false,
    };
    let mut north = Carried::of(&own);
    (0..100).for_each(|_| north.correct(0.0, &told(0.01, 0.03), &Vector3::z()));
    assert!((0.03..0.0305).contains(&north.variance_rad2()), "{}", north.variance_rad2());
    let before = north.variance_rad2();
    north.correct(0.0, &told(0.01, 0.0), &Vector3::z());
    let expected = before * 0.01 / (before + 0.01);
    assert!((north.variance_rad2() / expected - 1.0).abs() < 1e-9, "{} {expected}", north.variance_rad2());
}

#[test]
fn a_device_that_is_moved_in_its_holder_is_noticed() {
    let (mut north, mut device) = (North::default(), Device::new(0.0, 6.0));
    let vehicle = |mounted_deg: f64| {
        move |device: &Device| Some(HeadingSample { axis: HeadedAxis::Vehicle, ..device.told(mounted_deg, 3.0) })
    };
    play(&mut north, &mut device, 60, vehicle(40.0));
    let angle_deg = |north: &North| north.mounting.unwrap().angle_rad.to_degrees();
    let first = angle_deg(&north);
    // turned by 100 degrees in the holder: the gyroscope sees it
    device.rate_rad_s = -100.0_f64.to_radians();
    play(&mut north, &mut device, 1, |_| None);
    device.rate_rad_s = 0.4;
    let error_deg = play(&mut north, &mut device, 30, vehicle(-60.0));
    let moved = (angle_deg(&north) - first).rem_euclid(360.0);
    assert!((moved - 260.0).abs() < 10.0, "{first} {moved}");
    assert!(error_deg.abs() < 3.0, "{error_deg}");
}

impl Device {
    fn filtered(&self) -> Vector3<f64> {
        let (sin, cos) = self.off_deg.to_radians().sin_cos();
        self.attitude.inverse() * Vector3::new(20.0 * sin, 20.0 * cos, -40.0)
    }
}

#[test]
fn a_pause_forgets_north_and_keeps_what_was_learned_of_mounting_and_declination() {
    let (mut north, mut device) = (North::default(), Device::new(12.0, 10.0));
    let offset = |sd_rad| Some(Offset::unknown(sd_rad, Vector3::y()));
    (north.mounting, north.declination) = (offset(0.3), offset(0.1));
    play(&mut north, &mut device, 5, |device| Some(device.told(0.0, 1.0)));
    assert!(north.carried.is_some() && north.heard.is_some());
    north.pause();
    assert_eq!(north, North { mounting: offset(0.3), declination: offset(0.1), ..North::default() });
}

/// 60 s speak for the magnetometer; the first heading counts for 10 s and each after it for 1 s.
#[test]
fn another_north_is_believed_after_more_seconds_than_speak_for_this_one() {
    let at = |headings| {
        let (mut north, mut device) = (North::default(), Device::new(90.0, 5.0));
        play(&mut north, &mut device, headings, |device| Some(device.told(0.0, 8.0)))
    };
    assert!((at(51) - 90.0).abs() < 1e-6 && at(52).abs() < 1.0, "{} {}", at(51), at(52));
}

/// Ten seconds of a vehicle's headings say that the device lies elsewhere in its holder: where each counts for 1 s, the eleventh second; where each counts
/// for 4 s, the twelfth or the thirteenth.
#[test]
fn a_mounting_is_another_after_more_than_ten_seconds() {
    let vehicle = |mounted_deg: f64, period_s: i64| {
        move |device: &Device| {
            let heading = HeadingSample { axis: HeadedAxis::Vehicle, ..device.told(mounted_deg, 3.0) };
            (device.time_ns / 1_000_000_000 % period_s == 0).then_some(heading)
        }
    };
    let (mut north, mut device) = (North::default(), Device::new(0.0, 6.0));
    play(&mut north, &mut device, 60, vehicle(40.0, 1));
    device.rate_rad_s = -100.0_f64.to_radians();
    play(&mut north, &mut device, 1, |_| None);
    device.rate_rad_s = 0.4;
    for period_s in [1, 4] {
        let (mut north, mut device) = (north.clone(), Device { ..device });
        let learned = north.mounting.unwrap().angle_rad;
        let is_another = |north: &North| wrap(north.mounting.unwrap().angle_rad - learned).abs() > 1.0;
        let mut speaks_s = 0.0;
        for _ in 0..20 {
            let before = north.rival.clone();
            play(&mut north, &mut device, 1, vehicle(-60.0, period_s));
            if let Some(rival) = &north.rival {
                speaks_s = rival.support_s;
            }
            assert_eq!(is_another(&north), before.is_some() && north.rival.is_none(), "{speaks_s} s");
            if is_another(&north) {
                break;
            }
        }
        assert!(is_another(&north));
        let expected_s = if period_s == 1 { 10.0 } else { 9.0 };
        assert_eq!(speaks_s, expected_s, "none but the next is beyond ten");
        let known_rad2 = north.carried.as_ref().unwrap().variance_rad2() + 3.0_f64.to_radians().powi(2);
        assert!((north.mounting.unwrap().variance_rad2 / known_rad2 - 1.0).abs() < 1e-9);
    }
}
