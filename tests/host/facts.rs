//! The facts every language of the library agrees on: gauge, signs, units, statuses, errors. Kotlin and Swift assert the
//! same file.

use magcomp::nalgebra::{Quaternion, Vector3};
use magcomp::{
    Axis, Calibration, Compensator, Config, ConstantField, Event, EventKind, EventRejection, FitError, FitOptions,
    HoldReason, KeptCalibration, MagneticSample, Missing, ReferenceAxis, RejectReason, RotationRateSample,
    ScreenRotation, Status, UpSample, WindowedConfig, attitude, heading, true_heading_deg,
};
use magcomp_tests::{symmetric, vectors};
use serde_json::Value;

fn facts() -> Value {
    vectors("facts.json")
}

fn list<'a>(facts: &'a Value, key: &str) -> &'a [Value] {
    let list = facts[key].as_array().expect(key);
    assert!(!list.is_empty(), "{key}");
    list
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().expect("numbers").iter().map(|number| number.as_f64().expect("a number")).collect()
}

fn vector(value: &Value) -> Vector3<f64> {
    Vector3::from_column_slice(&numbers(value))
}

fn text(value: &Value) -> &str {
    value.as_str().expect("a text")
}

#[test]
fn correcting() {
    for case in list(&facts(), "correct") {
        let soft_iron = symmetric(&numbers(&case["soft_iron"]));
        let calibration = Calibration::new(soft_iron, vector(&case["hard_iron_ut"]), 50.0).unwrap();
        let field_ut = calibration.correct(&vector(&case["raw_ut"]));
        assert!((field_ut - vector(&case["field_ut"])).amax() < 1e-12, "{}: {field_ut}", case["name"]);
    }
}

#[test]
fn no_calibration() {
    for case in list(&facts(), "no_calibration") {
        let strength_ut = case["field_strength_ut"].as_f64().unwrap();
        let error =
            Calibration::new(symmetric(&numbers(&case["soft_iron"])), Vector3::zeros(), strength_ut).unwrap_err();
        assert_eq!(error.to_string(), text(&case["text"]));
    }
}

#[test]
fn the_gauge_is_the_symmetric_positive_definite_matrix() {
    let facts = facts();
    let gauge = &facts["gauge"];
    let mut session = ConstantField::new(1);
    for raw_ut in list(gauge, "raw_ut") {
        session.add(&vector(raw_ut)).unwrap();
    }
    let found = session.finish(&FitOptions::default()).unwrap().calibration;
    let soft_iron = symmetric(&numbers(&gauge["soft_iron"]));
    assert!((found.soft_iron() - soft_iron).abs().max() < 1e-9, "{found:?}");
    assert!((found.hard_iron_ut() - vector(&gauge["hard_iron_ut"])).amax() < 1e-7, "{found:?}");
    assert!((found.field_strength_ut() - gauge["field_strength_ut"].as_f64().unwrap()).abs() < 1e-7, "{found:?}");
}

#[test]
fn headings() {
    for case in list(&facts(), "headings") {
        let (field_ut, up) = (vector(&case["field_ut"]), vector(&case["up"]));
        let found = heading(&field_ut, &up, ReferenceAxis::TopEdge, ScreenRotation::Deg0).unwrap();
        let true_deg = true_heading_deg(found.heading_deg, case["declination_deg"].as_f64().unwrap());
        let close = |ours: f64, key: &str| (ours - case[key].as_f64().unwrap()).abs() < 1e-9;
        assert!(close(found.heading_deg, "heading_deg"), "{}: {found:?}", case["name"]);
        assert!(close(found.inclination_deg.unwrap(), "inclination_deg"), "{}: {found:?}", case["name"]);
        assert!(close(true_deg, "true_heading_deg"), "{}: {true_deg}", case["name"]);
        let [w, x, y, z] = <[f64; 4]>::try_from(numbers(&case["attitude"])).unwrap();
        let to_world = attitude(&field_ut, &up).unwrap().to_world.into_inner();
        // a quaternion and its negative are the same attitude
        let product = to_world.dot(&Quaternion::new(w, x, y, z));
        assert!((product.abs() - 1.0).abs() < 1e-12 && to_world.w >= 0.0, "{}: {to_world}", case["name"]);
    }
}

#[test]
fn units_by_their_limits() {
    let facts = facts();
    let pair = |key: &str| <[f64; 2]>::try_from(numbers(&facts["limits"][key])).unwrap();
    let mut compensator = Compensator::new(Config::default()).unwrap();
    let mut push =
        |time_ns: i64, x: f64| compensator.push(MagneticSample { time_ns, field_ut: Vector3::new(x, 0.0, 0.0) });
    let [within, beyond] = pair("magnetic_ut");
    assert_eq!(push(0, within).status.label(), "collecting");
    assert!(matches!(push(1, beyond).status, Status::Rejected(RejectReason::OutOfRange { .. })));
    let [within, beyond] = pair("gap_ns");
    assert!(matches!(push(beyond as i64, 1.0).status, Status::Rejected(RejectReason::TimeJump { .. })));
    assert_eq!(push(within as i64, 1.0).status.label(), "collecting");

    let mut compensator = Compensator::new(Config::default()).unwrap();
    let [within, beyond] = pair("rotation_rate_rad_s");
    let mut rate = |time_ns, x| {
        compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s: Vector3::new(x, 0.0, 0.0) })
    };
    assert_eq!(rate(1, within), Ok(()));
    assert_eq!(rate(2, beyond), Err(EventRejection::OutOfRange));
    let [within, beyond] = pair("up_m_s2");
    let mut up = |time_ns, x| compensator.push_up(UpSample { time_ns, up_m_s2: Vector3::new(x, 0.0, 0.0) });
    assert_eq!(up(1, within), Ok(()));
    assert_eq!(up(2, beyond), Err(EventRejection::OutOfRange));
}

#[test]
fn statuses() {
    let poor = FitError::PoorCoverage { direction_sigma_deg: 12.5, limit_deg: 10.0 };
    let problems = [
        FitError::TooFewSamples { have: 8 },
        FitError::Planar { thickness_ut: 0.5 },
        poor,
        FitError::Inconsistent { residual_ut: 7.5, limit_ut: 2.5 },
        FitError::NotAnEllipsoid,
        FitError::FieldOutOfRange { field_ut: 90.0, low_ut: 22.0, high_ut: 67.0 },
        FitError::NotFinite,
    ];
    let held = [
        HoldReason::LowUniformity,
        HoldReason::FitRefused(poor),
        HoldReason::Constant,
        HoldReason::AtRest,
        HoldReason::TooLittleRotation,
        HoldReason::NoGyroscope,
    ];
    let rejected = [
        RejectReason::NotFinite,
        RejectReason::OutOfRange { value_ut: -2500.0, limit_ut: 2000.0 },
        RejectReason::Saturated { axis: Axis::X, value_ut: 1300.0, rail_ut: 1299.5 },
        RejectReason::TimeNotAfter { time_ns: 7, latest_ns: 8 },
        RejectReason::TimeJump { gap_s: 1e6, limit_s: 604_800.0 },
        RejectReason::Stuck { repeats: 50 },
        RejectReason::Axes { x: 2, y: -1, z: 3 },
    ];
    let mut ours = vec![Status::Collecting(Missing::Samples { have: 60, need: 100 })];
    ours.extend(problems.map(|problem| Status::Collecting(Missing::Fit(problem))));
    ours.extend([Missing::Rotation, Missing::Directions].map(Status::Collecting));
    ours.extend([Status::Tracking, Status::Suspect { since_ns: 1 }]);
    ours.extend(held.map(Status::Held));
    ours.push(Status::Disturbed { since_ns: 1 });
    ours.extend(rejected.map(Status::Rejected));
    let ours: Vec<_> = ours.iter().map(|status| (status.label().to_owned(), status.to_string())).collect();
    let facts = facts();
    let facts: Vec<_> = list(&facts, "statuses")
        .iter()
        .map(|status| (text(&status["label"]).to_owned(), text(&status["text"]).to_owned()))
        .collect();
    assert_eq!(ours, facts);
}

#[test]
fn events() {
    for case in list(&facts(), "events") {
        let kind: EventKind = serde_json::from_value(case["kind"].clone()).unwrap();
        let [since_ns, decided_ns] = ["since_ns", "decided_ns"].map(|key| case[key].as_i64().unwrap());
        assert_eq!(Event { kind, since_ns, decided_ns }.to_string(), text(&case["text"]));
    }
}

#[test]
fn errors() {
    let facts = facts();
    let rejections = [
        EventRejection::NotFinite,
        EventRejection::OutOfRange,
        EventRejection::Late,
        EventRejection::Duplicate,
        EventRejection::Ahead,
    ];
    let expected: Vec<_> = list(&facts, "event_rejections").iter().map(|case| text(&case["text"])).collect();
    assert_eq!(rejections.map(|rejection| rejection.to_string()).to_vec(), expected);

    for case in list(&facts, "errors") {
        let windowed = WindowedConfig { n_min: 3, ..Default::default() };
        let said = match text(&case["name"]) {
            "Config" => Compensator::new(Config { windowed, ..Default::default() }).unwrap_err().to_string(),
            "KeptDamaged" => KeptCalibration::from_json("nonsense").unwrap_err().to_string(),
            "KeptNewer" => KeptCalibration::from_json(r#"{"magcomp_calibration": 99}"#).unwrap_err().to_string(),
            other => panic!("{other}"),
        };
        match case.get("begins") {
            Some(begins) => assert!(said.starts_with(text(begins)), "{said}"),
            None => assert_eq!(said, text(&case["text"])),
        }
    }
}
