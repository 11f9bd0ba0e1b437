//! A calibration from one launch to the next: what is kept, what is refused, and what an adopted one is believed for.

use magcomp::nalgebra::{Matrix3, Vector3};
use magcomp::{
    Calibration, CalibrationSource, Compensator, Config, KEPT_VERSION, KeptCalibration, KeptError, Method, Reading,
    Status,
};
use magcomp_tests::{METHODS, Phone, REF, Random, calibration};
use serde_json::Value;

/// `Aided` is as `Auto` where there is a gyroscope.
const WITH_A_PRIOR: [Method; 2] = [Method::Auto, Method::Adaptive];
const THEN_S: i64 = 1_795_560_000;
const HOUR_S: i64 = 3600;
/// With a gyroscope and an accelerometer, without one of them, without both.
const SENSORS: [(bool, bool); 4] = [(true, true), (false, true), (true, false), (false, false)];

fn compensator(method: Method) -> Compensator {
    Compensator::new(Config { method, ..Config::default() }).expect("a valid config")
}

fn truth() -> Calibration {
    calibration(&REF, 45.0)
}

/// A phone that lies still.
fn at_rest(seed: u64, sensors: (bool, bool)) -> Phone {
    laid_down(Phone::new(seed, truth()), sensors)
}

fn laid_down(mut phone: Phone, sensors: (bool, bool)) -> Phone {
    phone.moving = false;
    (phone.gyroscope, phone.accelerometer) = sensors;
    phone
}

/// A compensator that has learned from a turned phone.
fn taught(method: Method) -> (Phone, Compensator) {
    let (mut phone, mut compensator) = (Phone::new(80, truth()), compensator(method));
    phone.run(&mut compensator, 3000);
    (phone, compensator)
}

fn learned() -> KeptCalibration {
    taught(Method::Auto).1.keep(THEN_S).expect("a turned phone")
}

/// One value of the text is another.
fn with(kept: &KeptCalibration, pointer: &str, value: Value) -> Result<KeptCalibration, KeptError> {
    let mut text: Value = serde_json::from_str(&kept.to_json()).expect("JSON");
    *text.pointer_mut(pointer).expect(pointer) = value;
    KeptCalibration::from_json(&text.to_string())
}

/// The same, with b_x off by so much.
fn off_by(kept: &KeptCalibration, off_ut: f64) -> KeptCalibration {
    let x_ut = kept.calibration().hard_iron_ut().x + off_ut;
    with(kept, "/hard_iron_ut/0", x_ut.into()).expect("a calibration")
}

/// Every way to a calibration that no live sample has confirmed.
fn adoptions(method: Method) -> Vec<(String, Compensator)> {
    let learned = learned();
    let mut all = vec![("nothing".to_owned(), compensator(method))];
    for off_ut in [0.0, 20.0] {
        let learned = off_by(&learned, off_ut);
        let calibration = *learned.calibration();
        let config = Config { method, initial: Some(calibration), ..Config::default() };
        all.push((format!("initial, {off_ut} uT off"), Compensator::new(config).expect("a valid config")));
        let given = KeptCalibration::given(calibration, 2.0).expect("in range");
        let system = KeptCalibration::system(calibration, 13.0).expect("in range");
        for (kept, now_s) in [(learned, Some(THEN_S + HOUR_S)), (learned, None), (given, None), (system, None)] {
            let mut compensator = compensator(method);
            compensator.adopt(&kept, now_s);
            all.push((format!("{:?} at {now_s:?}, {off_ut} uT off", kept.source()), compensator));
        }
    }
    all
}

/// A constant calibration that was adopted stays, by choice.
fn learns(method: Method, adopted: &str, (gyroscope, _): (bool, bool)) -> bool {
    match method {
        Method::Constant => adopted == "nothing",
        Method::Aided => gyroscope,
        _ => true,
    }
}

#[test]
fn nothing_is_kept_before_anything_was_learned() {
    for method in METHODS {
        for sensors in SENSORS {
            for (adopted, mut compensator) in adoptions(method) {
                let what = format!("{method:?}, {sensors:?}, {adopted}");
                let mut phone = at_rest(81, sensors);
                for k in 0..1000 {
                    assert_eq!(compensator.keep(THEN_S), None, "{what}, sample {k}");
                    phone.advance(&mut compensator);
                }
                phone.moving = true;
                phone.run(&mut compensator, 3000);
                let kept = compensator.keep(THEN_S);
                assert_eq!(kept.is_some(), learns(method, &adopted, sensors), "{what}");
                let Some(kept) = kept else { continue };
                assert_eq!((kept.source(), kept.unix_time_s()), (CalibrationSource::Learned, Some(THEN_S)));
                assert_eq!(Some(*kept.calibration()), compensator.calibration(), "{what}");
                // what is adopted later is not what was learned
                compensator.adopt(&kept, Some(THEN_S));
                assert_eq!(compensator.keep(THEN_S), None, "{what}");
            }
        }
    }
}

#[test]
fn tracking_never_before_live_samples_of_a_turned_device() {
    for method in METHODS {
        for sensors in SENSORS {
            for (adopted, mut compensator) in adoptions(method) {
                let what = format!("{method:?}, {sensors:?}, {adopted}");
                let mut phone = at_rest(82, sensors);
                for k in 0..2000 {
                    let status = phone.advance(&mut compensator).status;
                    assert!(status != Status::Tracking, "{what}, sample {k}");
                }
                phone.moving = true;
                let tracks = (0..3000).any(|_| phone.advance(&mut compensator).status == Status::Tracking);
                assert_eq!(tracks, learns(method, &adopted, sensors), "{what}");
            }
        }
    }
}

/// In force at once, bit for bit; from the first sample on as sure as ten minutes allow.
#[test]
fn what_was_kept_comes_back_in_force() {
    for method in METHODS {
        let (phone, compensator_before) = taught(method);
        let kept = compensator_before.keep(THEN_S).expect("learned");
        assert!(kept.inclination_deg().is_some_and(|dip_deg| (dip_deg - 60.0).abs() < 5.0), "{method:?}: {kept:?}");
        let text = kept.to_json();
        assert!(!text.contains('\n') && text.len() < 3000, "{text}");
        let read = KeptCalibration::from_json(&text).expect("its own text");
        assert_eq!(read, kept, "{method:?}");
        for sensors in SENSORS {
            let mut compensator = compensator(method);
            compensator.adopt(&read, Some(THEN_S + 600));
            assert_eq!(compensator.calibration(), compensator_before.calibration(), "{method:?}");
            let mut phone = laid_down(phone.clone(), sensors);
            for k in 0..100 {
                let reading = phone.advance(&mut compensator);
                let found = compensator.calibration().expect("in force");
                let off_ut = (found.hard_iron_ut() - kept.calibration().hard_iron_ut()).norm();
                assert!(off_ut < 2.0, "{method:?}, {sensors:?}, sample {k}: b moved by {off_ut} uT");
                assert!(reading.field_ut.is_some(), "{method:?}, {sensors:?}, sample {k}: {}", reading.status);
                let heading = reading.heading.filter(|_| k > 0 && WITH_A_PRIOR.contains(&method));
                let Some(heading) = heading else { continue };
                let sigma_deg = heading.heading_sigma_deg.expect("a prior");
                let off_deg = (heading.heading_deg - phone.heading_deg() + 540.0).rem_euclid(360.0) - 180.0;
                assert!(off_deg.abs() < 2.0 * sigma_deg, "{method:?}, sample {k}: {off_deg} deg, sigma {sigma_deg}");
            }
        }
    }
}

/// A user's: lying still, b right. And a clock that was set back tells no age.
#[test]
fn the_older_the_less_sure() {
    let kept = learned();
    for method in WITH_A_PRIOR {
        for gyroscope in [true, false] {
            let sigmas_deg = [Some(0), Some(HOUR_S), Some(6 * HOUR_S), Some(48 * HOUR_S), None].map(|age_s| {
                let mut compensator = compensator(method);
                compensator.adopt(&kept, age_s.map(|age_s| THEN_S + age_s));
                let mut phone = at_rest(83, (gyroscope, true));
                phone.run(&mut compensator, 10);
                let heading = phone.advance(&mut compensator).heading;
                heading.map_or(180.0, |heading| heading.heading_sigma_deg.expect("a prior"))
            });
            let what = format!("{method:?}, gyroscope {gyroscope}: {sigmas_deg:?}");
            // beyond a day the sample alone says what is left, and its noise where the mean lies
            let grows = sigmas_deg.is_sorted_by(|younger, older| *younger < 1.05 * older);
            assert!(grows && sigmas_deg[0] > 0.5, "{what}");
            assert!(sigmas_deg[1] < 12.0 && sigmas_deg[4] > 2.0 * sigmas_deg[0], "{what}");
        }
        let [set_back, unknown] = [Some(THEN_S - 1), None].map(|now_s| {
            let mut compensator = compensator(method);
            compensator.adopt(&kept, now_s);
            compensator
        });
        assert!(set_back == unknown, "{method:?}");
    }
}

#[test]
fn a_damaged_or_newer_text_is_refused_and_nothing_changes() {
    let text = learned().to_json();
    let newer = text.replacen(&format!(":{KEPT_VERSION},"), &format!(":{},", KEPT_VERSION + 1), 1);
    let old_snapshot = r#"{"magcomp_snapshot":1,"crc32":"47a2412f","library":"0.1.0","calibration":"","state":""}"#;
    let damaged = ["", "null", "{}", "[]", "nonsense", old_snapshot, &text[..text.len() - 1], &text[1..]];
    for method in METHODS {
        let (_, mut compensator) = taught(method);
        let before = compensator.clone();
        // as an app does
        let mut relaunch =
            |text: &str| KeptCalibration::from_json(text).map(|kept| compensator.adopt(&kept, Some(THEN_S)));
        for text in damaged {
            let error = relaunch(text).expect_err(text);
            assert!(matches!(error, KeptError::Damaged { .. }), "{text}: {error:?}");
            assert!(error.to_string().ends_with("; start without it"), "{error}");
        }
        let error = relaunch(&newer).expect_err("newer");
        assert_eq!(error, KeptError::Newer { found: KEPT_VERSION + 1 });
        assert!(error.to_string().ends_with("; update it or start without"), "{error}");
        assert!(compensator == before, "{method:?}");
    }
}

#[test]
fn a_system_calibration_replaces_nothing_that_was_learned() {
    for method in METHODS {
        let (mut phone, mut compensator) = taught(method);
        let found = compensator.calibration().expect("learned");
        let b = found.hard_iron_ut() + Vector3::new(40.0, 0.0, 0.0);
        let elsewhere = Calibration::new(*found.soft_iron(), b, 45.0).expect("a calibration");
        let system = KeptCalibration::system(elsewhere, 1.0).expect("in range");
        for round in 0..3 {
            let before = compensator.clone();
            compensator.adopt(&system, Some(THEN_S));
            assert!(compensator == before, "{method:?}, round {round}");
            phone.moving = round == 0;
            phone.run(&mut compensator, 500);
        }
    }
}

/// Nothing was learned: alone it is in force, beside one that was kept it is one more measurement of b, once.
#[test]
fn a_system_calibration_is_heard_while_nothing_was_learned() {
    let right = learned();
    let kept = off_by(&right, 20.0);
    let system = KeptCalibration::system(*right.calibration(), 2.0).expect("in range");
    let off_ut = |compensator: &Compensator| {
        let found = compensator.calibration().expect("in force");
        (found.hard_iron_ut() - right.calibration().hard_iron_ut()).norm()
    };
    for method in METHODS {
        let mut alone = compensator(method);
        alone.adopt(&system, None);
        assert_eq!(alone.calibration(), Some(*right.calibration()), "{method:?}");
        let mut both = compensator(method);
        both.adopt(&kept, Some(THEN_S + HOUR_S));
        at_rest(84, (true, true)).run(&mut both, 100);
        let before_ut = off_ut(&both);
        both.adopt(&system, None);
        let after_ut = off_ut(&both);
        assert!(after_ut < 4.0 && after_ut < before_ut, "{method:?}: {before_ut}, then {after_ut} uT");
        let before = both.clone();
        let other = KeptCalibration::system(*kept.calibration(), 1.0).expect("in range");
        both.adopt(&other, None);
        assert!(both == before, "{method:?}");
    }
}

/// Everything that a compensator says is finite.
fn is_sound(reading: &Reading, compensator: &Compensator) -> bool {
    let heading = reading.heading.map_or([0.0; 4], |found| {
        let or_zero = |value: Option<f64>| value.unwrap_or(0.0);
        [
            found.heading_deg,
            or_zero(found.inclination_deg),
            or_zero(found.heading_sigma_deg),
            or_zero(found.true_heading_deg),
        ]
    });
    let fields = [reading.field_ut, reading.filtered_field_ut].into_iter().flatten().flat_map(<[f64; 3]>::from);
    let numbers = [reading.field_sigma_ut, reading.total_field_ut, reading.sigma_t, reading.direction_sigma_deg];
    let rest = [reading.worst_sigma_deg, Some(reading.coverage)];
    let found = compensator.calibration();
    let calibration = found.iter().flat_map(|c| c.soft_iron().iter().chain(c.hard_iron_ut()).copied());
    heading
        .into_iter()
        .chain(fields)
        .chain(numbers.into_iter().chain(rest).flatten())
        .chain(calibration)
        .all(f64::is_finite)
        && compensator.covariance().is_none_or(|c| c.iter().all(|v| v.is_finite()))
        && !reading.status.to_string().contains("NaN")
}

/// The gyroscope goes and comes back, the device changes; what is learned can be kept.
fn does_no_harm(compensator: &mut Compensator, what: &str) {
    let mut phone = Phone::new(85, truth());
    for k in 0..1500 {
        phone.gyroscope = !(500..1000).contains(&k);
        phone.moving = k >= 50;
        phone.truth = calibration(&REF.map(|v| v * if k < 1200 { 1.0 } else { 1.3 }), 45.0);
        let reading = phone.advance(compensator);
        assert!(is_sound(&reading, compensator), "{what}, sample {k}: {reading:?}");
        if k % 100 == 50
            && let Some(kept) = compensator.keep(THEN_S)
        {
            assert_eq!(KeptCalibration::from_json(&kept.to_json()), Ok(kept), "{what}, sample {k}");
        }
    }
}

/// The extremes of what is allowed do no harm.
#[test]
fn whatever_calibration_may_be_adopted_does_no_harm() {
    for method in METHODS {
        for (m, b, field) in [(1e3, 1e5, 1.0), (1e-3, -1e5, 1e3), (1.0, 0.0, 1e3), (1.0, 1e5, 50.0), (1e-3, 0.0, 1.0)] {
            let given = Calibration::new(Matrix3::identity() * m, Vector3::repeat(b), field).expect("allowed");
            let what = format!("{method:?}, {m}, {b}, {field}");
            let config = Config { method, initial: Some(given), ..Config::default() };
            does_no_harm(&mut Compensator::new(config).expect("a valid config"), &what);
            for sigma_ut in [0.01, 2.0, 1000.0] {
                let both = [KeptCalibration::given(given, sigma_ut), KeptCalibration::system(given, sigma_ut)];
                for kept in both.map(|kept| kept.expect("in range")) {
                    let mut compensator = compensator(method);
                    compensator.adopt(&kept, None);
                    does_no_harm(&mut compensator, &format!("{what}, {:?}, {sigma_ut} uT", kept.source()));
                }
            }
        }
    }
}

/// A text with any numbers is refused or adopted, and never leads to a panic or a number that is none.
#[test]
fn whatever_text_is_read_does_no_harm() {
    let kept = learned();
    let numbers = [0.0, -0.0, 5e-324, 1e-9, 1.0, -1.0, 90.0, -90.0, 1e3, 1e5, 1e12, 1e17, 9e17, 1e300, -1e300];
    let times = [i64::MIN, -1, 0, THEN_S, i64::MAX];
    let mut texts = Vec::new();
    for pointer in ["/inclination_deg", "/field_strength_ut", "/hard_iron_ut/1", "/soft_iron/0", "/soft_iron/4"] {
        texts.extend(numbers.map(|value| (format!("{pointer} {value}"), with(&kept, pointer, value.into()))));
    }
    for number in numbers {
        for (name, nine) in [("the first of the diagonal", 1..2), ("b", 0..3), ("M", 3..9), ("all", 0..9)] {
            let diagonal = |i: usize| if nine.contains(&i) { number } else { kept.covariance()[(i, i)] };
            let rows: Vec<Vec<f64>> =
                (0..9).map(|i| (0..9).map(|j| if i == j { diagonal(i) } else { 0.0 }).collect()).collect();
            texts.push((format!("covariance of {name} {number}"), with(&kept, "/covariance", rows.into())));
        }
        // all nine are one
        let rows = vec![vec![number; 9]; 9];
        texts.push((format!("covariance {number} all over"), with(&kept, "/covariance", rows.into())));
    }
    texts.extend(times.map(|time_s| (format!("kept at {time_s}"), with(&kept, "/unix_time_s", time_s.into()))));
    let mut random = Random::new(86);
    let (mut refused, mut taken) = (0, 0);
    for (what, read) in texts {
        let Ok(kept) = read else {
            refused += 1;
            continue;
        };
        taken += 1;
        for method in [Method::Auto, Method::Adaptive, Method::Windowed] {
            let mut compensator = compensator(method);
            let now_s = times.get(random.between(0.0, times.len() as f64 + 1.0) as usize).copied();
            compensator.adopt(&kept, now_s);
            does_no_harm(&mut compensator, &format!("{method:?}, {what}, now {now_s:?}"));
        }
    }
    println!("{refused} refused, {taken} adopted");
    assert!(refused > 30 && taken > 60, "{refused} refused, {taken} adopted");
}
