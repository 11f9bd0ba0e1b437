//! Laws of the stream: the compensator as a state machine, over any input that proptest finds.

use magcomp::nalgebra::{Rotation3, Vector3};
use magcomp::{
    Calibration, Compensator, Config, FitOptions, HeadingConfig, KeptCalibration, MagneticSample, Method, Reading,
    RejectReason, Residual, RotationRateSample, ScreenRotation, Status, UpSample, WindowedConfig, fit_ellipsoid,
};
use magcomp_tests::{REF, Random, calibration, difference, sample};
use proptest::prelude::*;

fn config(method: Method, n_min: usize, n_max: usize) -> Config {
    Config {
        method,
        windowed: WindowedConfig { n_min, n_max, ..WindowedConfig::default() },
        heading: HeadingConfig { declination_deg: Some(-4.5), ..HeadingConfig::default() },
        ..Config::default()
    }
}

fn compensator(config: &Config) -> Compensator {
    Compensator::new(config.clone()).expect("a valid config")
}

/// Every bit of a reading, the sign of zero included.
fn bits(reading: &Reading) -> String {
    serde_json::to_string(reading).expect("a reading is plain data")
}

/// One 10 ms of a stream: even motion, then rest, then a step, with bad samples in between.
fn advance(compensator: &mut Compensator, random: &mut Random, k: usize) -> Reading {
    let truth = calibration(&if k < 1500 { REF } else { REF.map(|v| v * 1.1) }, 45.0);
    let field_ut = match k {
        600..800 => truth.distort(&Vector3::new(10.0, 20.0, -38.0)) + random.normal3() * 0.2,
        _ => random.raw_one(&truth, 0.6),
    };
    let field_ut = if k % 97 == 50 { Vector3::new(f64::NAN, 0.0, 0.0) } else { field_ut };
    let MagneticSample { time_ns, .. } = sample(k, field_ut);
    let rate = RotationRateSample { time_ns, rate_rad_s: random.normal3() };
    let up = UpSample { time_ns, up_m_s2: random.direction() * 9.8 };
    assert!(compensator.push_rotation_rate(rate).is_ok() && compensator.push_up(up).is_ok());
    compensator.push(MagneticSample { time_ns, field_ut })
}

fn any_method() -> impl Strategy<Value = Method> {
    prop::sample::select(vec![Method::Auto, Method::Adaptive, Method::Windowed, Method::Constant])
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn a_stream_is_a_batch_fit_of_its_window(seed: u64, n_min in 50_usize..200, noise_ut in 0.05..1.0) {
        let config = config(Method::Windowed, n_min, 1000);
        let mut stream = compensator(&config);
        let truth = calibration(&REF, 48.0);
        let mut random = Random::new(seed);
        let mut raw = Vec::new();
        let mut compared = 0;
        for k in 0..1500 {
            raw.push(random.raw_one(&truth, noise_ut));
            let reading = stream.push(sample(k, raw[k]));
            if k % 50 == 49 && reading.status == Status::Tracking {
                let window = &raw[raw.len() - reading.window..];
                let batch = fit_ellipsoid(window, &FitOptions::default()).map_err(|e| TestCaseError::fail(e.to_string()))?;
                let found = stream.calibration().expect("tracking");
                let off = difference(&found, &batch.calibration);
                prop_assert!(off < 1e-8, "sample {}: {}", k, off);
                let corrected = reading.field_ut.expect("tracking");
                prop_assert!((corrected - batch.calibration.correct(&raw[k])).amax() < 1e-5);
                compared += 1;
            }
        }
        prop_assert!(compared > 15, "{}", compared);
    }
}

/// What push must refuse, given the state of the compensator after `k` samples.
fn bad_sample(kind: usize, value: f64, next_ns: i64) -> MagneticSample {
    let good = Vector3::new(20.0, -30.0, 25.0);
    let at = |field_ut| MagneticSample { time_ns: next_ns, field_ut };
    let earlier = |by: i64| MagneticSample { time_ns: next_ns - 10_000_000 - by, field_ut: good };
    match kind {
        0 => at(Vector3::new(f64::NAN, value, 3.0)),
        1 => at(Vector3::new(value, f64::INFINITY, 3.0)),
        2 => at(Vector3::new(1.0, value, f64::NEG_INFINITY)),
        3 => at(Vector3::new(2000.5 + value.abs(), 0.0, 0.0)),
        4 => at(Vector3::new(0.0, 0.0, -1e300)),
        5 => earlier(0),
        6 => earlier(1 + value.abs() as i64 * 1_000_000),
        7 => MagneticSample { time_ns: i64::MIN, field_ut: good },
        8 => MagneticSample { time_ns: i64::MAX, field_ut: good },
        _ => at(Vector3::new(0.0, 1200.0, 0.0)),
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 100, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn bad_input_changes_nothing(
        method in any_method(),
        seed: u64,
        count in 1_usize..400,
        bad in prop::collection::vec((0_usize..10, -1000.0..1000.0_f64), 1..12),
    ) {
        let mut config = config(method, 100, 300);
        config.rail_ut = Some(1200.0);
        let mut compensator = compensator(&config);
        let mut random = Random::new(seed);
        for k in 0..count {
            // the last one is good, so that its time is the latest
            let k = if k + 1 == count && k % 97 == 50 { k + 1 } else { k };
            advance(&mut compensator, &mut random, k);
        }
        let next_ns = sample(count + 1, Vector3::zeros()).time_ns + 10_000_000;
        // one good sample at a known time
        let latest = MagneticSample { time_ns: next_ns - 10_000_000, field_ut: Vector3::new(60.0, 5.0, -20.0) };
        prop_assert!(!matches!(compensator.push(latest).status, Status::Rejected(_)));
        let before = compensator.clone();
        for (kind, value) in bad {
            let refused = bad_sample(kind, value, next_ns);
            let reading = compensator.push(refused);
            prop_assert!(matches!(reading.status, Status::Rejected(_)), "{:?}: {}", refused, reading.status);
            prop_assert_eq!((reading.field_ut, reading.total_field_ut), (None, None));
            prop_assert_eq!(reading.time_ns, refused.time_ns);
            let Status::Rejected(reason) = reading.status else { unreachable!() };
            let is_carried = matches!(reason, RejectReason::Saturated { .. } | RejectReason::NotFinite);
            if is_carried && compensator != before {
                // a gyroscope carries on (tests/host/misbehaving.rs, witnesses.rs)
                prop_assert!(matches!(method, Method::Auto | Method::Aided));
                compensator = before.clone();
                continue;
            }
            prop_assert_eq!(reading.heading, None);
            prop_assert!(compensator == before, "{:?}", refused);
            let late = latest.time_ns - 10_000_000 * 500;
            for (time_ns, value) in [(next_ns, f64::NAN), (next_ns, f64::INFINITY), (late, 1.0)] {
                let three = Vector3::new(0.0, value, 9.8);
                let up = UpSample { time_ns, up_m_s2: three };
                prop_assert!(compensator.push_up(up).is_err());
                let rate = RotationRateSample { time_ns, rate_rad_s: three };
                prop_assert!(compensator.push_rotation_rate(rate).is_err());
                prop_assert!(compensator == before, "{:?}, {:?}", up, rate);
            }
        }
    }
}

#[test]
fn a_sensor_that_hangs_is_rejected_and_changes_nothing() {
    let mut compensator = compensator(&config(Method::Auto, 100, 300));
    let mut random = Random::new(600);
    for k in 0..200 {
        advance(&mut compensator, &mut random, k);
    }
    let stuck = Vector3::new(31.0, 12.0, -20.0);
    let mut kept = None;
    for k in 200..300 {
        let reading = compensator.push(sample(k, stuck));
        let expected = k >= 250;
        assert_eq!(matches!(reading.status, Status::Rejected(RejectReason::Stuck { repeats: 50 })), expected, "{k}");
        if expected {
            assert!(*kept.get_or_insert_with(|| compensator.clone()) == compensator, "{k}");
        }
    }
    assert!(!matches!(compensator.push(sample(300, stuck + Vector3::x() * 0.1)).status, Status::Rejected(_)));
}

#[test]
fn an_adopted_calibration_is_in_force_at_once_and_the_stream_goes_on() {
    for (method, gyroscope) in [(Method::Auto, true), (Method::Auto, false), (Method::Windowed, true)] {
        let mut compensator = compensator(&config(method, 100, 300));
        let mut random = Random::new(630);
        let truth = calibration(&REF, 45.0);
        let up_m_s2 = Vector3::new(0.0, 0.0, 9.8);
        let mut push = |compensator: &mut Compensator, k: usize| {
            let MagneticSample { time_ns, field_ut } = sample(k, random.raw_one(&truth, 0.2));
            if gyroscope {
                let rate = RotationRateSample { time_ns, rate_rad_s: Vector3::new(0.1, 0.2, 0.3) };
                assert_eq!(compensator.push_rotation_rate(rate), Ok(()));
            }
            assert_eq!(compensator.push_up(UpSample { time_ns, up_m_s2 }), Ok(()));
            (field_ut, compensator.push(MagneticSample { time_ns, field_ut }))
        };
        // long enough for a calibration of its own without a gyroscope, and none with this one, which does not fit
        for k in 0..150 {
            push(&mut compensator, k);
        }
        let b = truth.hard_iron_ut() + Vector3::new(2.0, 0.0, 0.0);
        let given = Calibration::new(*truth.soft_iron(), b, 45.0).expect("a calibration");
        compensator.adopt(&KeptCalibration::given(given, 2.0).expect("in range"), None);
        assert_eq!(compensator.calibration(), Some(given));
        let (raw_ut, reading) = push(&mut compensator, 150);
        assert!(
            !matches!(reading.status, Status::Collecting(_) | Status::Rejected(_)),
            "{method:?}: {}",
            reading.status
        );
        if gyroscope && method == Method::Auto {
            // the first total field moves b by less than its sigma
            let off_ut = (reading.field_ut.expect("calibrated") - given.correct(&raw_ut)).norm();
            assert!(off_ut < 2.0, "{off_ut} uT");
        }
        // the clock did not start anew
        let late = compensator.push(sample(149, Vector3::new(1.0, 2.0, 3.0)));
        assert!(matches!(late.status, Status::Rejected(_)), "{}", late.status);
    }
}

#[test]
fn headings_may_be_set_anew_in_the_stream() {
    let set = HeadingConfig {
        screen_rotation: ScreenRotation::Deg90,
        declination_deg: Some(7.0),
        ..HeadingConfig::default()
    };
    let one = config(Method::Windowed, 100, 2000);
    let other = Config { heading: set, ..one.clone() };
    let (mut changed, mut from_the_start) = (compensator(&one), compensator(&other));
    let (mut random, mut again) = (Random::new(640), Random::new(640));
    for k in 0..400 {
        if k == 300 {
            assert_eq!(changed.set_heading(set), Ok(()));
            assert_eq!(changed.config(), &other);
        }
        let (found, expected) = (advance(&mut changed, &mut random, k), advance(&mut from_the_start, &mut again, k));
        assert_eq!(bits(&found) == bits(&expected), k >= 300 || found.heading.is_none(), "sample {k}");
        assert!(k < 390 || k % 97 == 50 || found.heading.is_some(), "sample {k} shows nothing");
    }
    let error = changed.set_heading(HeadingConfig { declination_deg: Some(181.0), ..set });
    assert_eq!(error.expect_err("out of range").field, "heading.declination_deg");
    assert_eq!(changed.config(), &other);
}

/// Any double there is.
fn any_number() -> impl Strategy<Value = f64> {
    prop_oneof![
        6 => -60.0..60.0,
        1 => -3000.0..3000.0,
        1 => any::<u64>().prop_map(f64::from_bits),
        1 => prop::sample::select(vec![
            0.0, -0.0, f64::NAN, f64::INFINITY, f64::NEG_INFINITY, f64::MAX, f64::MIN, f64::MIN_POSITIVE, 5e-324, 1e154,
            -1e154, 1e-160, 2000.0,
        ]),
    ]
}

#[derive(Clone, Debug)]
enum Event {
    Magnetic,
    Up,
    Rate,
    /// That many good samples.
    Motion(usize),
    Reset,
    /// What was learned is adopted.
    Relaunch,
}

fn any_event() -> impl Strategy<Value = (Event, i64, [f64; 3])> {
    let event = prop_oneof![
        10 => Just(Event::Magnetic),
        3 => Just(Event::Up),
        1 => Just(Event::Rate),
        2 => (1_usize..60).prop_map(Event::Motion),
        1 => Just(Event::Relaunch),
    ];
    let event = prop_oneof![40 => event, 1 => Just(Event::Reset)];
    let step_ns = prop_oneof![8 => 1_i64..20_000_000, 1 => any::<i64>(), 1 => -5_i64..1];
    (event, step_ns, [any_number(), any_number(), any_number()])
}

/// A jump from nearly the first to nearly the last nanosecond: refused 50 times, then another clock.
#[test]
fn no_jump_is_too_long_for_an_integer() {
    for method in [Method::Auto, Method::Adaptive, Method::Aided, Method::Windowed] {
        let mut compensator = compensator(&config(method, 20, 40));
        let (mut random, truth) = (Random::new(1), calibration(&REF, 45.0));
        for start_ns in [i64::MIN, i64::MAX - 2_000_000_000] {
            for k in 1..150 {
                let (time_ns, field_ut) = (start_ns + k * 10_000_000, random.raw_one(&truth, 0.5));
                let reading = compensator.push(MagneticSample { time_ns, field_ut });
                let refused = start_ns > 0 && k < 50;
                assert_eq!(matches!(reading.status, Status::Rejected(_)), refused, "{method:?}: {:?}", reading.status);
            }
        }
    }
}

/// Nothing in a reading is NaN or infinite, and everything is in its range.
fn sound(reading: &Reading) -> Result<(), TestCaseError> {
    for field in [reading.field_ut, reading.filtered_field_ut].into_iter().flatten() {
        prop_assert!(field.iter().all(|v| v.is_finite()), "{reading:?}");
    }
    prop_assert!(reading.total_field_ut.is_none_or(|v| v.is_finite() && v >= 0.0), "{reading:?}");
    prop_assert_eq!(reading.total_field_ut.is_some(), reading.field_ut.is_some());
    prop_assert!(reading.sigma_t.is_none_or(|v| (0.0..3.0).contains(&v)), "{reading:?}");
    prop_assert!((0.0..=1.0).contains(&reading.coverage), "{reading:?}");
    if let Some(found) = reading.heading {
        prop_assert!((0.0..360.0).contains(&found.heading_deg), "{reading:?}");
        prop_assert!(found.true_heading_deg.is_none_or(|v| (0.0..360.0).contains(&v)), "{reading:?}");
        prop_assert!(found.heading_sigma_deg.is_none_or(|v| (0.0..=180.0).contains(&v)), "{reading:?}");
        prop_assert!(found.inclination_deg.is_some_and(|dip_deg| (-90.0..=90.0).contains(&dip_deg)), "{reading:?}");
    }
    prop_assert!(!reading.status.to_string().contains("NaN"), "{}", reading.status);
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn nothing_panics_and_nothing_is_nan(
        method in any_method(),
        n_min in 9_usize..40,
        more in 0_usize..60,
        wild: bool,
        algebraic: bool,
        events in prop::collection::vec(any_event(), 1..150),
    ) {
        let mut config = config(method, n_min, n_min + more);
        config.windowed.sigma_th = 0.0;
        config.windowed.residual = if algebraic { Residual::Algebraic } else { Residual::Corrected };
        if wild {
            config.range_ut = 100_000.0;
            config.windowed.noise_floor_ut = 0.0;
        }
        let mut compensator = compensator(&config);
        let mut random = Random::new(n_min as u64);
        let truth = calibration(&REF, 45.0);
        let (mut time_ns, mut up_ns) = (0_i64, 0_i64);
        for (event, step_ns, numbers) in events {
            let three = Vector3::from(numbers);
            time_ns = time_ns.saturating_add(step_ns);
            match event {
                Event::Magnetic => sound(&compensator.push(MagneticSample { time_ns, field_ut: three }))?,
                Event::Up => {
                    up_ns = up_ns.saturating_add(step_ns);
                    let _ = compensator.push_up(UpSample { time_ns: up_ns, up_m_s2: three });
                }
                Event::Rate => {
                    let _ = compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s: three });
                }
                Event::Motion(count) => {
                    for _ in 0..count {
                        time_ns = time_ns.saturating_add(1_000_000);
                        let field_ut = random.raw_one(&truth, 0.5);
                        let _ = compensator.push_up(UpSample { time_ns, up_m_s2: random.direction() });
                        sound(&compensator.push(MagneticSample { time_ns, field_ut }))?;
                    }
                }
                Event::Reset => {
                    compensator.reset();
                    (time_ns, up_ns) = (0, 0);
                }
                Event::Relaunch => {
                    if let Some(kept) = compensator.keep(step_ns) {
                        prop_assert_eq!(KeptCalibration::from_json(&kept.to_json()), Ok(kept));
                        compensator.adopt(&kept, Some(time_ns));
                        prop_assert_eq!(compensator.keep(step_ns), None);
                    }
                }
            }
            if let Some(found) = compensator.calibration() {
                prop_assert!(found.soft_iron_inverse().iter().chain(found.hard_iron_ut()).all(|v| v.is_finite()));
            }
            let _ = compensator.coverage().unseen_directions();
        }
    }
}

/// What dies out must not become subnormal, which processors are slow with: every number of the state after an hour on a table.
#[test]
fn an_hour_at_rest_leaves_no_subnormal_number() {
    for has_gyroscope in [true, false] {
        let mut compensator = compensator(&config(Method::Auto, 100, 1000));
        let mut random = Random::new(7);
        let truth = calibration(&REF, 45.0);
        let attitude = |t: f64| Rotation3::from_euler_angles(0.6 * (2.0 * t).sin(), 0.5 * (1.4 * t).cos(), 0.5 * t);
        let rate_hz = 25.0;
        let mut tracked = 0;
        for k in 0..(3_620.0 * rate_hz) as usize {
            let (time_ns, t) = ((k as f64 / rate_hz * 1e9) as i64, (k as f64 / rate_hz).min(20.0));
            let turn =
                if t < 20.0 { attitude(t).inverse() * attitude(t + 1.0 / rate_hz) } else { Rotation3::identity() };
            let to_device = attitude(t).inverse();
            let rate_rad_s = turn.scaled_axis() * rate_hz + random.normal3() * 1e-3;
            if has_gyroscope {
                compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s }).expect("a good sample");
            }
            let up_m_s2 = to_device * Vector3::new(0.0, 0.0, 9.81) + random.normal3() * 0.02;
            compensator.push_up(UpSample { time_ns, up_m_s2 }).expect("a good sample");
            let field_ut = truth.distort(&(to_device * Vector3::new(0.0, 20.0, -40.0))) + random.normal3() * 0.3;
            tracked += usize::from(compensator.push(MagneticSample { time_ns, field_ut }).status == Status::Tracking);
        }
        assert!(tracked > 100, "{has_gyroscope}: {tracked}");
        let state = format!("{compensator:?}");
        let words = state.split(|c: char| !(c.is_alphanumeric() || "+-.".contains(c)));
        let numbers: Vec<f64> = words.filter_map(|it| it.parse().ok()).collect();
        assert!(numbers.len() > 3_000, "{}", numbers.len());
        let small: Vec<_> = numbers.iter().filter(|it| it.is_subnormal()).collect();
        assert!(small.is_empty(), "gyroscope {has_gyroscope}: {} of {}: {:e}", small.len(), numbers.len(), small[0]);
    }
}
