//! Headings and orientations from outside, through the compensator.

use magcomp::nalgebra::{UnitQuaternion, Vector3};
use magcomp::{
    AttitudeSample, Compensator, Config, EventRejection, HeadedAxis, HeadingAid, HeadingSample, NorthReference,
    SensorMode, Yaw,
};
use magcomp_tests::Phone;
use magcomp_tests::{REF, calibration};

fn phone(seed: u64) -> Phone {
    Phone::new(seed, calibration(&REF.map(|v| v * 0.5 + 0.5 * f64::from(u8::from(v > 0.9))), 48.0))
}

fn compensator() -> Compensator {
    Compensator::new(Config::default()).unwrap()
}

fn seen(phone: &Phone, yaw: Yaw, turned_deg: f64) -> AttitudeSample {
    let turned = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), turned_deg.to_radians());
    AttitudeSample { time_ns: phone.time_ns, to_world: turned * phone.attitude(), yaw }
}

fn off_deg(heading_deg: f64, phone: &Phone) -> f64 {
    (heading_deg - phone.heading_deg() + 180.0).rem_euclid(360.0) - 180.0
}

#[test]
fn turns_of_a_camera_stand_in_for_a_gyroscope() {
    let (mut phone, mut with, mut without) = (phone(1), compensator(), compensator());
    phone.gyroscope = false;
    let mut other = phone.clone();
    for k in 0..4000 {
        let reading = phone.advance(&mut with);
        let alone = other.advance(&mut without);
        // 33 Hz, in a world whose y axis points anywhere
        if k % 3 == 0 {
            with.push_attitude(seen(&phone, Yaw::Relative, 77.0)).unwrap();
        }
        if k == 3999 {
            assert_eq!((reading.mode, alone.mode), (SensorMode::GyroscopeAndGravity, SensorMode::GravityOnly));
            let error_deg = off_deg(reading.heading.unwrap().heading_deg, &phone);
            assert!(error_deg.abs() < 2.0, "{error_deg}");
        }
    }
    assert_eq!(with.heading_aid(), None);
}

/// The camera's world is another one after a sleep: what it seems to have turned by belongs to no time.
#[test]
fn no_turn_of_a_camera_reaches_across_a_gap() {
    let (mut phone, mut compensator) = (phone(5), compensator());
    phone.gyroscope = false;
    let run = |compensator: &mut Compensator, phone: &mut Phone, turned_deg: f64| {
        let mut reading = None;
        for _ in 0..3000 {
            compensator.push_attitude(seen(phone, Yaw::Relative, turned_deg)).unwrap();
            reading = Some(phone.advance(compensator));
        }
        reading.unwrap().heading.unwrap().heading_deg
    };
    run(&mut compensator, &mut phone, 0.0);
    compensator.push_gap(60.0).unwrap();
    let (mut same, mut other) = (compensator.clone(), phone.clone());
    let same_deg = run(&mut same, &mut other, 0.0);
    let another_deg = run(&mut compensator, &mut phone, 100.0);
    assert!((same_deg - another_deg).abs() < 1e-6, "{same_deg} {another_deg}");
    assert!(off_deg(same_deg, &phone).abs() < 3.0);
}

#[test]
fn beside_a_gyroscope_a_relative_orientation_changes_nothing() {
    let (mut phone, mut with, mut without) = (phone(2), compensator(), compensator());
    let mut other = phone.clone();
    for k in 0..500 {
        if k % 3 == 0 && k > 0 {
            with.push_attitude(seen(&phone, Yaw::Relative, 10.0)).unwrap();
        }
        assert_eq!(phone.advance(&mut with), other.advance(&mut without));
    }
}

#[test]
fn an_orientation_that_knows_north_is_a_heading() {
    let (mut phone, mut compensator) = (phone(3), compensator());
    let yaw = Yaw::Absolute { sigma_deg: 1.0, reference: NorthReference::True };
    for k in 0..3000 {
        phone.advance(&mut compensator);
        if k % 100 == 0 {
            // true north lies 12 degrees clockwise of magnetic north: true headings are smaller by that
            compensator.push_attitude(seen(&phone, yaw, 12.0)).unwrap();
        }
    }
    let (declination_deg, sigma_deg) = compensator.found_declination_deg().unwrap();
    assert!((declination_deg + 12.0).abs() < 3.0 * sigma_deg.max(0.5), "{declination_deg} +- {sigma_deg}");
    let heading = phone.advance(&mut compensator).heading.unwrap();
    let error_deg = off_deg(heading.true_heading_deg.unwrap() + 12.0, &phone);
    assert!(error_deg.abs() < 3.0, "{error_deg}");
    assert!(compensator.heading_aid().is_some());
    // a declination that is set is not found
    let mut frame = compensator.config().heading;
    frame.declination_deg = Some(-12.0);
    compensator.set_heading(frame).unwrap();
    assert_eq!(compensator.found_declination_deg(), None);
}

#[test]
fn what_is_refused_changes_nothing() {
    let (mut phone, mut compensator) = (phone(4), compensator());
    phone.run(&mut compensator, 1000);
    let before = compensator.clone();
    let heading = HeadingSample {
        time_ns: phone.time_ns,
        heading_deg: 10.0,
        sigma_deg: 5.0,
        reference: NorthReference::Magnetic,
        axis: HeadedAxis::Device(Vector3::y()),
    };
    let refused = [
        compensator.push_heading(HeadingSample { sigma_deg: f64::NAN, ..heading }),
        compensator.push_heading(HeadingSample { sigma_deg: -1.0, ..heading }),
        compensator.push_heading(HeadingSample { time_ns: phone.time_ns + 11_000_000_000, ..heading }),
        compensator.push_heading(HeadingSample { time_ns: phone.time_ns - 6_000_000_000, ..heading }),
        compensator.push_attitude(seen(&phone, Yaw::Absolute { sigma_deg: 0.0, reference: NorthReference::True }, 0.0)),
        compensator.push_attitude(AttitudeSample {
            time_ns: phone.time_ns + 11_000_000_000,
            ..seen(&phone, Yaw::Relative, 0.0)
        }),
        compensator.push_attitude(AttitudeSample {
            to_world: UnitQuaternion::new_unchecked(magcomp::nalgebra::Quaternion::new(f64::NAN, 0.0, 0.0, 0.0)),
            ..seen(&phone, Yaw::Relative, 0.0)
        }),
    ];
    use EventRejection::{Ahead, Late, NotFinite, OutOfRange};
    assert_eq!(refused, [NotFinite, OutOfRange, Ahead, Late, OutOfRange, Ahead, NotFinite].map(Err));
    assert_eq!(compensator, before);
    compensator.push_heading(heading).unwrap();
    assert_ne!(compensator, before);
    phone.run(&mut compensator, 1);
    assert!(matches!(compensator.heading_aid(), Some(HeadingAid::Used | HeadingAid::Leads | HeadingAid::Disagrees)));
}

/// What is told of a heading is what was done with it: off by so much, against so much, and ignored beyond three times that.
#[test]
fn a_heading_from_outside_is_explained() {
    let (mut phone, mut compensator) = (phone(6), compensator());
    phone.run(&mut compensator, 3000);
    assert_eq!(compensator.explain().outside, None);
    let mut tell = |off_deg: f64, sigma_deg: f64| {
        let top_deg = phone.heading_deg();
        let heading = HeadingSample {
            time_ns: phone.time_ns,
            heading_deg: (top_deg + off_deg).rem_euclid(360.0),
            sigma_deg,
            reference: NorthReference::Magnetic,
            axis: HeadedAxis::Device(Vector3::y()),
        };
        compensator.push_heading(heading).unwrap();
        let own = phone.advance(&mut compensator).heading.unwrap();
        (own.heading_sigma_deg.unwrap(), compensator.explain().outside.unwrap(), compensator.heading_aid())
    };
    let (own_deg, told, aid) = tell(4.0, 6.0);
    assert_eq!((told.aid, aid), (HeadingAid::Leads, Some(HeadingAid::Leads)));
    assert!((told.off_deg - 4.0).abs() < 4.0 * own_deg, "{told:?}");
    assert!((told.expected_deg - 6.0_f64.hypot(own_deg)).abs() < 0.2, "{told:?} {own_deg}");
    let (own_deg, told, aid) = tell(-40.0, 6.0);
    assert_eq!((told.aid, aid), (HeadingAid::Disagrees, Some(HeadingAid::Disagrees)));
    assert!((told.off_deg + 40.0).abs() < 4.0 * own_deg && 40.0 > 3.0 * told.expected_deg, "{told:?}");
    assert!((told.north_sigma_deg.hypot(6.0) - told.expected_deg).abs() < 0.05, "{told:?}");
}
