//! What is computed on the way, with numbers by hand.

use super::*;

#[test]
fn headings_wait_in_the_order_of_their_times_and_the_oldest_makes_room() {
    let device = Device::new(0.0, 5.0);
    let at = |ms: i64| HeadingSample { time_ns: ms * 1_000_000, ..device.told(0.0, 5.0) };
    let mut north = North::default();
    let waiting = |north: &North| north.waiting.iter().map(|it| it.time_ns / 1_000_000).collect::<Vec<_>>();
    for ms in [300, 100, 200] {
        north.push(at(ms), Some(0)).unwrap();
    }
    assert_eq!(waiting(&north), [100, 200, 300]);
    for ms in 4..=32 {
        north.push(at(ms * 100), Some(0)).unwrap();
    }
    assert_eq!(north.push(at(50), Some(0)), Err(EventRejection::Late));
    north.push(at(250), Some(0)).unwrap();
    let expected: Vec<i64> = [200, 250].into_iter().chain((3..=32).map(|k| k * 100)).collect();
    assert_eq!(waiting(&north), expected);
}

#[test]
fn a_heading_may_be_ten_seconds_ahead_and_five_late() {
    let device = Device::new(0.0, 5.0);
    let push = |time_ns| North::default().push(HeadingSample { time_ns, ..device.told(0.0, 5.0) }, Some(0));
    assert_eq!([push(10_000_000_000), push(-5_000_000_000)], [Ok(()), Ok(())]);
    assert_eq!([push(10_000_000_001), push(-5_000_000_001)], [Err(EventRejection::Ahead), Err(EventRejection::Late)]);
}

/// A true heading without a declination: 15 degrees that no heading has told, learned from what this one and the magnetometer differ by.
#[test]
fn a_heading_is_judged_by_all_that_is_not_known_of_it_and_told_of_for_two_minutes() {
    let (mut north, mut device) = (North::default(), Device::new(12.0, 10.0));
    let answer = device.answer();
    let own_deg2 = Own::of(&answer, 0.0).unwrap().variance_rad2 * 180.0_f64.powi(2) / PI.powi(2);
    let time_ns = device.time_ns;
    let heading = HeadingSample { reference: NorthReference::True, ..device.told(2.0, 5.0) };
    north.push(heading, Some(time_ns)).unwrap();
    north.stepped(time_ns, answer, None);
    let told_deg2 = own_deg2 + 25.0;
    let declination_deg2 = 225.0 * told_deg2 / (225.0 + told_deg2);
    let explained = north.explain(time_ns).unwrap();
    assert!((explained.expected_deg - (told_deg2 + declination_deg2).sqrt()).abs() < 1e-9, "{explained:?}");
    // told 2, the magnetometer has -12: of the difference of 14 the declination takes its share
    let off_deg = 14.0 * (1.0 - 225.0 / (225.0 + told_deg2));
    assert!((explained.off_deg - off_deg).abs() < 1e-9, "{explained:?}");
    assert_eq!(north.aid(i64::MAX), Some(HeadingAid::Leads));
    north.carried.as_mut().unwrap().leads = false;
    let later = |s: f64| north.aid(time_ns + (s * 1e9) as i64);
    let north_sigma_deg = north.carried.as_ref().unwrap().variance_rad2().sqrt().to_degrees();
    assert!((explained.north_sigma_deg - north_sigma_deg).abs() < 1e-12);
    assert!(later(119.9) == Some(HeadingAid::Used) && later(120.1).is_none());
}

#[test]
fn a_declination_that_is_set_is_taken_off_true_headings() {
    let (mut north, mut device) = (North::default(), Device::new(12.0, 10.0));
    let answer = device.answer();
    let heading = HeadingSample { reference: NorthReference::True, ..device.told(0.0, 0.01) };
    let time_ns = device.time_ns;
    north.push(heading, Some(time_ns)).unwrap();
    let error_deg = device.error_deg(&north.stepped(time_ns, answer, Some(7.0)));
    // magnetic north is 7 degrees clockwise of true north
    assert!((error_deg - 7.0).abs() < 0.01, "{error_deg}");
}

#[test]
fn no_more_than_two_minutes_speak_for_north() {
    let (mut north, mut device) = (North::default(), Device::new(0.0, 5.0));
    play(&mut north, &mut device, 100, |device| Some(device.told(0.0, 5.0)));
    assert_eq!(north.carried.unwrap().support_s, 120.0);
}

/// North is 90 degrees clockwise of where a sure magnetometer has it: x goes to -y and y to x. What was across x is across by the headings now.
#[test]
fn a_field_that_is_led_takes_its_covariance_along() {
    let covariance = Matrix3::new(1.0, 0.2, 0.3, 0.2, 2.0, 0.4, 0.3, 0.4, 3.0);
    let mut led = Answer {
        filtered_field_ut: Some(Vector3::new(0.0, 20.0, -40.0)),
        filtered_covariance_ut2: Some(covariance),
        up: Some(Vector3::z()),
        ..Answer::default()
    };
    let own = Own::of(&led, 0.0).unwrap();
    let east = Own { level: Level::of(&Vector3::x(), &Vector3::z()).unwrap(), variance_rad2: 1e-4 };
    let still = carry(Matrix3::identity(), 0.0, 0.01, Vector3::z());
    lead(&mut led, &own, &Carried::of(&east), &still);
    assert!((led.filtered_field_ut.unwrap() - Vector3::new(20.0, 0.0, -40.0)).norm() < 1e-12);
    let expected = Matrix3::new(2.0, 0.0, 0.4, 0.0, 1e-4 * 400.0, 0.0, 0.4, 0.0, 3.0);
    assert!((led.filtered_covariance_ut2.unwrap() - expected).amax() < 1e-12, "{:?}", led.filtered_covariance_ut2);
}

/// The device turned by 0.2 rad about z until 1 s and by 0.4 rad more until 2 s: a vector of 1.25 s has 0.3 rad to go, and turns the other way.
#[test]
fn a_vector_of_a_time_between_is_brought_by_the_rest_of_the_turn() {
    let mut history = History::default();
    for (time_ns, rad) in [(0, 0.0), (1_000_000_000, 0.2), (2_000_000_000, 0.4)] {
        history.turn(time_ns, &Rotation3::new(Vector3::z() * -rad).into_inner());
    }
    for (time_ns, rad) in [(2_000_000_000, 0.0), (1_250_000_000, 0.3), (1_000_000_000, 0.4), (500_000_000, 0.5)] {
        let brought = history.brought(&Vector3::x(), time_ns).unwrap();
        let expected = Vector3::new(f64::cos(rad), -f64::sin(rad), 0.0);
        assert!((brought - expected).norm() < 1e-9, "{time_ns}: {brought}");
    }
    assert_eq!(history.brought(&Vector3::x(), -1), None);
}

#[test]
fn an_offset_is_learned_elsewhere_alone_and_from_what_it_may_be() {
    let known = |at_rad| {
        let mut offset = Offset::unknown(3.0, Vector3::x());
        assert_eq!(offset.variance_rad2, 9.0);
        offset.begin_at(0.5, at_rad, 0.04);
        offset
    };
    assert_eq!((known(1.0).angle_rad, known(1.0).variance_rad2), (0.5, 0.04));
    let learned = |at_rad, difference_rad| {
        let mut offset = known(1.0);
        offset.learn(difference_rad, at_rad, 0.06);
        (offset.angle_rad, offset.variance_rad2)
    };
    // 11 degrees from where it was last learned, and 29; 31, and 115
    assert_eq!([learned(1.2, 0.6), learned(1.0 + 29.0_f64.to_radians(), 0.6)], [(0.5, 0.04); 2]);
    for at_rad in [1.0 + 31.0_f64.to_radians(), -1.0] {
        let (angle_rad, variance_rad2) = learned(at_rad, 0.6);
        assert!((angle_rad - (0.5 + 0.4 * 0.1)).abs() < 1e-12 && (variance_rad2 - 0.04 * 0.6).abs() < 1e-12);
    }
    // sqrt 0.9 is three standard deviations
    assert_eq!([learned(-1.0, 0.5 - 0.95), learned(-1.0, 0.5 + 0.95)], [(0.5, 0.04); 2]);
    assert_ne!(learned(-1.0, 0.5 - 0.94), (0.5, 0.04));
}
