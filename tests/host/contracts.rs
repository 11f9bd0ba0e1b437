//! What the public interface promises whichever estimator answers: refused input changes nothing, headings alone follow
//! their settings, one known field strength serves every method, a clone is a snapshot, and every number has a range.

use magcomp::nalgebra::{Matrix3, Vector3};
use magcomp::{
    Calibration, CalibrationError, Compensator, Config, ConstantField, Disturbance, EventRejection, FactoryErrors,
    HeadingConfig, MagneticSample, Reading, ReferenceAxis, RejectReason, RotationRateSample, ScreenRotation, Status,
    UpSample,
};
use magcomp_tests::{METHODS, PERIOD_NS, Phone, REF, calibration, difference};

fn compensator(config: &Config) -> Compensator {
    Compensator::new(config.clone()).expect("a valid config")
}

// 1. refused input

/// Nothing of a compensator changes while `refuse` runs.
fn unchanged(compensator: &mut Compensator, what: &str, refuse: impl FnOnce(&mut Compensator)) {
    let before = compensator.clone();
    refuse(compensator);
    assert!(*compensator == before, "{what}: the state has changed");
}

#[test]
fn a_refused_sample_changes_nothing() {
    for method in METHODS {
        let config = Config { method, range_ut: 6000.0, ..Config::default() };
        let mut free = compensator(&config);
        let mut phone = Phone::new(10, calibration(&REF, 45.0));
        phone.run(&mut free, 400);
        let (now, good) = (phone.time_ns, Vector3::new(40.0, -10.0, 20.0));
        let at = |time_ns: i64, field_ut: Vector3<f64>| MagneticSample { time_ns, field_ut };
        let next = now + PERIOD_NS;
        let refused = |compensator: &mut Compensator, sample: MagneticSample, name: &str| {
            unchanged(compensator, &format!("{method:?}, {name}"), |compensator| {
                let Status::Rejected(reason) = compensator.push(sample).status else {
                    panic!("{method:?}, {name}: it was taken")
                };
                assert!(format!("{reason:?}").starts_with(name), "{method:?}, {name}: {reason:?}");
            });
        };
        refused(&mut free, at(next, Vector3::new(0.0, 0.0, -6001.0)), "OutOfRange");
        refused(&mut free, at(now, Vector3::new(0.0, f64::NAN, 0.0)), "NotFinite");
        // with a gyroscope the field is carried on meanwhile (tests/host/misbehaving.rs, witnesses.rs)
        let mut alone = compensator(&Config { rail_ut: Some(1000.0), ..config });
        let mut no_gyroscope = Phone::new(10, calibration(&REF, 45.0));
        no_gyroscope.gyroscope = false;
        no_gyroscope.run(&mut alone, 400);
        refused(&mut alone, at(next, Vector3::new(0.0, 0.0, -1000.0)), "Saturated");
        refused(&mut alone, at(next, Vector3::new(0.0, f64::NAN, 0.0)), "NotFinite");
        refused(&mut alone, at(next, Vector3::new(f64::INFINITY, 0.0, 0.0)), "NotFinite");
        refused(&mut free, at(now, good), "TimeNotAfter");
        refused(&mut free, at(i64::MIN, good), "TimeNotAfter");
        refused(&mut free, at(now + 700_000 * 1_000_000_000, good), "TimeJump");
        // what the config allows no estimator refuses
        let before = free.clone();
        let reading = free.push(at(next, Vector3::new(0.0, 0.0, -5500.0)));
        assert!(!matches!(reading.status, Status::Rejected(_)), "{method:?}: {}", reading.status);
        assert!(free != before, "{method:?}: states that differ compare as equal");
        for k in 1..50 {
            free.push(at(next + k * PERIOD_NS, good));
        }
        free.push(at(next + 50 * PERIOD_NS, good));
        refused(&mut free, at(next + 51 * PERIOD_NS, good), "Stuck");
    }
}

#[test]
fn a_refused_event_changes_nothing() {
    for method in METHODS {
        let mut compensator = compensator(&Config { method, ..Config::default() });
        let mut phone = Phone::new(11, calibration(&REF, 45.0));
        phone.run(&mut compensator, 300);
        let now = phone.time_ns;
        // more than any buffer holds: the oldest have been folded
        let ahead: Vec<i64> = (1..=40).map(|k| now + k * 1_000_000).collect();
        for &time_ns in &ahead {
            let rate_rad_s = Vector3::new(0.1, 0.2, time_ns as f64 * 1e-12);
            assert_eq!(compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s }), Ok(()));
            assert_eq!(compensator.push_up(UpSample { time_ns, up_m_s2: Vector3::new(0.1, 0.2, 9.8) }), Ok(()));
        }
        let three = Vector3::new(0.3, 0.2, 0.1);
        let newest = ahead[39];
        for (time_ns, value, expected) in [
            (newest, three, EventRejection::Duplicate),
            (newest - 1_000_000, three, EventRejection::Duplicate),
            (newest - 7_000_000, three, EventRejection::Duplicate),
            (now - 1, three, EventRejection::Late),
            (ahead[0] + 1, three, EventRejection::Late),
            (newest + 1, Vector3::new(0.0, f64::NAN, 0.0), EventRejection::NotFinite),
            (newest + 1, Vector3::new(0.0, 1e4, 0.0), EventRejection::OutOfRange),
            (now + 11_000_000_000, three, EventRejection::Ahead),
        ] {
            let what = format!("{method:?}, {expected:?} at {time_ns}");
            unchanged(&mut compensator, &what, |compensator| {
                let rate = RotationRateSample { time_ns, rate_rad_s: value };
                assert_eq!(compensator.push_rotation_rate(rate), Err(expected), "{what}");
                assert_eq!(compensator.push_up(UpSample { time_ns, up_m_s2: value }), Err(expected), "{what}");
            });
        }
    }
}

/// 50 refused samples that follow one another begin another clock. How many there have been is no part of the comparison.
#[test]
fn the_count_towards_another_clock_is_not_compared() {
    let mut one = compensator(&Config::default());
    let mut phone = Phone::new(12, calibration(&REF, 45.0));
    phone.run(&mut one, 600);
    let found = one.calibration().expect("calibrated");
    let sample =
        |k: i64| MagneticSample { time_ns: -(1 << 50) + k * PERIOD_NS, field_ut: Vector3::new(40.0, 1.0, 9.0) };
    let mut other = one.clone();
    unchanged(&mut one, "another clock", |one| {
        (0..49).for_each(|k| assert!(matches!(one.push(sample(k)).status, Status::Rejected(_))));
    });
    assert!(matches!(other.push(sample(49)).status, Status::Rejected(_)), "it has seen none of them");
    assert!(!matches!(one.push(sample(49)).status, Status::Rejected(_)));
    let off = difference(&one.calibration().expect("the calibration stays"), &found);
    assert!(off < 0.01, "{off}");
}

// 2. headings

/// Every bit of a reading but the heading.
fn all_but_heading(reading: &Reading) -> String {
    serde_json::to_string(&Reading { heading: None, attitude: None, ..*reading }).expect("plain data")
}

/// Through a change of the device, a gyroscope that goes and comes back, and another clock.
#[test]
fn set_heading_changes_headings_alone() {
    for method in METHODS {
        let config = Config { method, ..Config::default() };
        let (mut one, mut other) = (compensator(&config), compensator(&config));
        let mut phones = [0; 2].map(|_| Phone::new(20, calibration(&REF, 45.0)));
        let mut differing = 0;
        for k in 0..2600 {
            if k == 300 {
                let heading = HeadingConfig {
                    axis: ReferenceAxis::Camera,
                    screen_rotation: ScreenRotation::Deg90,
                    declination_deg: Some(5.0),
                    tilt_sigma_deg: 2.0,
                };
                assert_eq!(other.set_heading(heading), Ok(()));
                assert_eq!(other.config().heading, heading);
            }
            for phone in &mut phones {
                phone.gyroscope = !(900..1500).contains(&k);
                if k == 1200 {
                    phone.truth = calibration(&REF.map(|v| v * 1.2), 45.0);
                }
                if k == 1700 {
                    phone.time_ns -= 1 << 45;
                }
            }
            let (expected, found) = (phones[0].advance(&mut one), phones[1].advance(&mut other));
            assert_eq!(all_but_heading(&found), all_but_heading(&expected), "{method:?}, sample {k}");
            assert_eq!(other.calibration(), one.calibration(), "{method:?}, sample {k}");
            assert_eq!(other.covariance(), one.covariance(), "{method:?}, sample {k}");
            differing += usize::from(found.heading != expected.heading);
        }
        assert!(differing > 1000, "{method:?}: {differing} headings differ");
    }
}

// 3. a known field strength

#[test]
fn a_known_field_strength_is_heard_by_every_method() {
    let field_ut = 48.0;
    // a sensor that reads a tenth too much: without the known strength that is the field's
    let mut parameters = [0.3, -0.2, 1.3, 1.15, 1.05, 1.10, 0.03, -0.02, 0.04];
    parameters[..3].iter_mut().for_each(|b| *b *= 1.1);
    let truth = calibration(&parameters, field_ut);
    for method in METHODS {
        let field_strength_ut = Some(field_ut);
        let mut compensator = compensator(&Config { method, field_strength_ut, ..Config::default() });
        let mut phone = Phone::new(30, truth);
        phone.run(&mut compensator, 6000);
        let (mut sums, count) = ([0.0; 2], 500);
        for _ in 0..count {
            let reading = phone.advance(&mut compensator);
            sums[0] += reading.total_field_ut.expect("calibrated") / f64::from(count);
            sums[1] += reading.filtered_field_ut.map_or(field_ut, |field| field.norm()) / f64::from(count);
        }
        let found = compensator.calibration().expect("calibrated");
        assert!((found.field_strength_ut() - field_ut).abs() < 1e-9, "{method:?}: {}", found.field_strength_ut());
        let near = |value: f64| (value / field_ut - 1.0).abs() < 0.02;
        assert!(sums.into_iter().all(near), "{method:?}: {sums:?}");
        let off = (found.soft_iron() - truth.soft_iron()).amax();
        assert!(off < 0.03, "{method:?}: M is off by {off}: {}", found.soft_iron());
        // M is free in scale no longer, and says how well it is known
        if let Some(covariance) = compensator.covariance() {
            let sd = covariance.diagonal().fixed_rows::<3>(3).amax().sqrt();
            assert!(off < 6.0 * sd, "{method:?}: M is off by {off}, sigma {sd}");
        }
    }
}

// 4. clones

/// At the start, while tracking, suspect after a step, in another place, without a gyroscope, and at rest; and one that was written and is read again.
#[test]
fn a_clone_goes_on_bit_for_bit_and_on_its_own() {
    let read_again = |it: &Compensator| {
        postcard::from_bytes(&postcard::to_stdvec(it).expect("it can be written")).expect("what was written")
    };
    for method in METHODS {
        let mut whole = compensator(&Config { method, ..Config::default() });
        let mut phone = Phone::new(40, calibration(&REF, 45.0));
        let mut cloned = (whole.clone(), phone.clone());
        for k in 0..3200 {
            if [1, 30, 120, 900, 1215, 1240, 1300, 1830, 2150, 2520, 2950].contains(&k) {
                assert!(cloned.0 == whole, "{method:?}, sample {k}");
                cloned = (if k % 20 == 0 { whole.clone() } else { read_again(&whole) }, phone.clone());
                // what another clone sees this one does not
                let mut another = cloned.clone();
                another.1.run(&mut another.0, 50);
                assert!(another.0 != whole && cloned.0 == whole, "{method:?}, sample {k}");
            }
            for phone in [&mut phone, &mut cloned.1] {
                phone.gyroscope = !(2100..2500).contains(&k);
                phone.moving = !(2800..3000).contains(&k);
                phone.truth = calibration(&REF.map(|v| v * if k < 1200 { 1.0 } else { 1.2 }), 45.0);
                phone.field_ut.y = if k < 1800 { 22.5 } else { 47.5 };
            }
            let (expected, found) = (phone.advance(&mut whole), cloned.1.advance(&mut cloned.0));
            let bits = |reading: &Reading| serde_json::to_string(reading).expect("plain data");
            assert_eq!(bits(&found), bits(&expected), "{method:?}, sample {k}");
        }
        assert!(cloned.0 == whole, "{method:?}");
    }
}

// 5. ranges

#[test]
fn a_calibration_no_phone_has_is_refused() {
    let build = |m: f64, b: f64, field: f64| {
        let (m, b) = (Matrix3::identity() * m, Vector3::new(0.0, b, 0.0));
        let both = [Calibration::new(m, b, field).map(|_| ()), Calibration::from_any(m, b, field).map(|_| ())];
        assert_eq!(both[0], both[1]);
        both[0]
    };
    for (m, b, field) in [(1.0, 1e5, 50.0), (1.0, -1e5, 50.0), (1e3, 0.0, 50.0), (1e-3, 0.0, 1e3), (1.0, 0.0, 1.0)] {
        assert_eq!(build(m, b, field), Ok(()), "{m}, {b}, {field}");
    }
    for (m, b, field, expected) in [
        (1.0, 1e6, 50.0, "hard iron component 1000000 uT is outside +-100000 uT; is the unit microtesla?"),
        (1.0, -100_001.0, 50.0, "hard iron component -100001 uT is outside +-100000 uT; is the unit microtesla?"),
        (1.0, 0.0, 0.9, "field strength is 0.9 uT, expected 1 to 1000 uT"),
        (1.0, 0.0, 1001.0, "field strength is 1001 uT, expected 1 to 1000 uT"),
        (1.0, 0.0, -50.0, "field strength is -50 uT, expected 1 to 1000 uT"),
        (1100.0, 0.0, 50.0, "an element of the soft iron matrix or of its inverse is 1100, outside +-1000"),
        (1e-4, 0.0, 50.0, "an element of the soft iron matrix or of its inverse is 10000, outside +-1000"),
    ] {
        let error = build(m, b, field).expect_err(expected);
        assert!(error.to_string().starts_with(expected), "{error}");
    }
    assert!(matches!(build(1.0, 1e300, 50.0), Err(CalibrationError::HardIron { .. })));
    assert!(matches!(build(f64::NAN, 0.0, 50.0), Err(CalibrationError::NotFinite)));
    assert!(Calibration::identity(f64::NAN).is_err() && Calibration::identity(1e-9).is_err());
    assert!(
        serde_json::from_str::<Calibration>(
            r#"{"soft_iron":[1,0,0,0,1,0,0,0,1],"hard_iron_ut":[1e300,0,0],"field_strength_ut":50}"#
        )
        .is_err()
    );
}

#[test]
fn every_number_of_the_config_has_a_range() {
    let serde_json::Value::Object(all) = serde_json::to_value(Config::default()).expect("plain data") else { panic!() };
    let mut tried = 0;
    let mut refused = |group: &str, name: &str, usual: &serde_json::Value| {
        let bad: &[&str] = match usual {
            serde_json::Value::Number(number) if !number.is_f64() => &["0", "1000000000000"],
            // what may be none is a number, but for a calibration
            serde_json::Value::Number(_) | serde_json::Value::Null if name != "initial" => {
                &["1e300", "1.7976931348623157e308", "inf", "-1000.0", "nan"]
            }
            _ => return,
        };
        let (head, field) = if group.is_empty() {
            (String::new(), name.to_owned())
        } else {
            (format!("[{group}]"), format!("{group}.{name}"))
        };
        for value in bad {
            let config = toml::from_str::<Config>(&format!("{head}\n{name} = {value}")).expect(&field);
            let error = Compensator::new(config).expect_err(&field);
            assert_eq!(error.field, field, "{value}");
            assert!(error.expected.contains(|c: char| c.is_ascii_digit() || c == '.'), "{error}");
        }
        tried += 1;
    };
    for (name, usual) in &all {
        match usual.as_object() {
            Some(group) => group.iter().for_each(|(field, usual)| refused(name, field, usual)),
            None => refused("", name, usual),
        }
    }
    assert!(tried >= 10, "{tried}");
}

/// What a stored config says: every setting may be left out, and none is unknown.
#[test]
fn a_config_has_a_default_for_each_setting() {
    let usual = Config::default();
    let read = |text: &str| serde_json::from_str::<Config>(text);
    assert_eq!(read("{}").expect("all may be left out"), usual);
    let mut other = usual;
    (other.range_ut, other.windowed.n_min, other.heading.declination_deg) = (5000.0, 50, Some(2.5));
    let text = r#"{"range_ut": 5000, "windowed": {"n_min": 50}, "heading": {"declination_deg": 2.5}}"#;
    assert_eq!(read(text).expect("some may be left out"), other);
    for unknown in [r#"{"range": 5000}"#, r#"{"windowed": {"n": 50}}"#, r#"{"heading": {"field_sigma_ut": 1}}"#] {
        assert!(read(unknown).is_err(), "{unknown}");
    }
}

#[test]
fn a_session_of_orientations_refuses_what_no_sensor_reads() {
    let mut session = ConstantField::new(2);
    assert_eq!(session.add(&Vector3::new(1.0, 2.0, 3.0)), Ok(()));
    let refused = session.add(&Vector3::new(0.0, -1e300, 0.0));
    assert_eq!(refused, Err(RejectReason::OutOfRange { value_ut: -1e300, limit_ut: 100_000.0 }));
    assert_eq!(session.orientations(), 0);
}

#[test]
fn factory_errors_compose_to_numbers_or_are_refused() {
    let good = FactoryErrors { scale: Vector3::repeat(1.0), axes: Matrix3::identity(), offset_ut: Vector3::zeros() };
    let disturbance = Disturbance { soft_iron: Matrix3::identity(), hard_iron_ut: Vector3::new(1.0, 2.0, 3.0) };
    assert_eq!(good.compose(&disturbance), Ok((Matrix3::identity(), Vector3::new(1.0, 2.0, 3.0))));
    let nan = Vector3::new(f64::NAN, 0.0, 0.0);
    for (factory, disturbance) in [
        (FactoryErrors { scale: nan, ..good }, disturbance),
        (FactoryErrors { offset_ut: nan, ..good }, disturbance),
        (
            FactoryErrors { scale: Vector3::repeat(1e200), ..good },
            Disturbance { soft_iron: Matrix3::repeat(1e200), ..disturbance },
        ),
        (good, Disturbance { soft_iron: Matrix3::repeat(f64::INFINITY), ..disturbance }),
        (good, Disturbance { hard_iron_ut: nan, ..disturbance }),
    ] {
        assert_eq!(factory.compose(&disturbance), Err(CalibrationError::NotFinite), "{factory:?}, {disturbance:?}");
    }
    let flat = FactoryErrors { axes: Matrix3::repeat(1.0), ..good };
    assert!(matches!(flat.compose(&disturbance), Err(CalibrationError::Singular { .. })));
}

#[test]
fn a_rejected_sample_still_tells_sensors_and_window() {
    for method in METHODS {
        let mut compensator = compensator(&Config { method, ..Config::default() });
        let mut phone = Phone::new(13, calibration(&REF, 45.0));
        phone.run(&mut compensator, 2000);
        let good = phone.advance(&mut compensator);
        let bad = compensator.push(MagneticSample { time_ns: phone.time_ns + 1, field_ut: Vector3::repeat(f64::NAN) });
        assert!(matches!(bad.status, Status::Rejected(_)) && good.window > 0, "{method:?}: {}", bad.status);
        assert_eq!((bad.mode, bad.window), (good.mode, good.window), "{method:?}");
    }
}
