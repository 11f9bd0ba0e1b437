//! The facts every language of the library agrees on: gauge, signs, units, statuses, errors. Kotlin and Swift assert the
//! same files.

use magcomp::nalgebra::{Quaternion, Vector3};
use magcomp::{
    Calibration, Compensator, Config, ConstantField, Event, EventKind, EventRejection, FitError, FitOptions,
    HeadingAid, HoldReason, KeptCalibration, MagneticSample, Missing, ReferenceAxis, RejectReason, RotationRateSample,
    ScreenRotation, Status, UpSample, WindowedConfig, attitude, heading, true_heading_deg,
};
use magcomp_tests::{symmetric, vectors};
use serde::de::DeserializeOwned;
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

/// What Rust calls the cases of an enum.
fn cases<T: DeserializeOwned>() -> &'static [&'static str] {
    match ron::from_str::<T>("none_of_them").map_err(|error| error.code) {
        Err(ron::Error::NoSuchEnumVariant { expected, .. }) => expected,
        _ => panic!("no enum"),
    }
}

#[test]
fn statuses() {
    let all: Value = vectors("statuses.json");
    for case in list(&all, "statuses") {
        let status: Status = ron::from_str(text(&case["status"])).unwrap();
        assert_eq!([status.label(), &status.to_string()], [text(&case["label"]), text(&case["en"])]);
    }
    let has = |within: &str, name: &str| {
        let mut rests = list(&all, "statuses")
            .iter()
            .filter_map(|case| text(&case["status"]).strip_prefix(within)?.strip_prefix(name));
        rests.any(|rest| !rest.starts_with(char::is_alphanumeric))
    };
    for (within, cases) in [
        ("", cases::<Status>()),
        ("Collecting(", cases::<Missing>()),
        ("Collecting(Fit(", cases::<FitError>()),
        ("Held(", cases::<HoldReason>()),
        ("Rejected(", cases::<RejectReason>()),
    ] {
        for name in cases {
            assert!(has(within, name), "statuses.json has no {within}{name}");
        }
    }
}

#[test]
fn events_and_heading_aids() {
    let all: Value = vectors("statuses.json");
    let names =
        |key: &str, name: &str| list(&all, key).iter().map(|case| text(&case[name]).to_owned()).collect::<Vec<_>>();
    assert_eq!(names("events", "kind"), cases::<EventKind>());
    assert_eq!(names("heading_aids", "name"), cases::<HeadingAid>());
    for case in list(&all, "events") {
        let kind: EventKind = ron::from_str(text(&case["kind"])).unwrap();
        let [since_ns, decided_ns] = ["since_ns", "decided_ns"].map(|key| case[key].as_i64().unwrap());
        assert_eq!(Event { kind, since_ns, decided_ns }.to_string(), text(&case["en"]));
    }
    for case in list(&all, "heading_aids") {
        assert_eq!(ron::from_str::<HeadingAid>(text(&case["name"])).unwrap().to_string(), text(&case["en"]));
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
