//! The paper's scenarios through the whole compensator: cold start, steps, poor motion, pulses, bad samples.

use magcomp::nalgebra::{Rotation3, Unit, Vector3};
use magcomp::{
    Calibration, Compensator, Config, FitError, HoldReason, MagneticSample, Missing, Normalisation, Reading,
    RejectReason, Status, WindowedConfig,
};
use magcomp_tests::{REF, Random, calibration, nine, sample, worst_direction_deg};

/// 40 uT, so that M and b half as large again still lie in the Earth's range.
const FIELD_UT: f64 = 40.0;
/// 30 dB.
const NOISE_UT: f64 = FIELD_UT * 0.031_622_776_601_683_79;
/// Sample at which something happens.
const STEP: usize = 2500;

fn before() -> Calibration {
    calibration(&REF, FIELD_UT)
}

/// All nine parameters half as large again.
fn after() -> Calibration {
    calibration(&REF.map(|v| v * 1.5), FIELD_UT)
}

fn compensator(normalisation: Normalisation) -> Compensator {
    let config = Config {
        method: magcomp::Method::Windowed,
        field_strength_ut: Some(FIELD_UT),
        windowed: WindowedConfig { normalisation, ..WindowedConfig::default() },
        ..Config::default()
    };
    Compensator::new(config).expect("a valid config")
}

fn push(compensator: &mut Compensator, k: usize, field_ut: Vector3<f64>) -> Reading {
    compensator.push(sample(k, field_ut))
}

/// A compensator that has seen `STEP` even samples.
fn calibrated(random: &mut Random, noise_ut: f64) -> Compensator {
    let mut compensator = compensator(Normalisation::HalfRange);
    for k in 0..STEP {
        push(&mut compensator, k, random.raw_one(&before(), noise_ut));
    }
    compensator
}

fn refusal(status: &Status) -> Option<FitError> {
    match status {
        Status::Collecting(Missing::Fit(error)) => Some(*error),
        Status::Held(HoldReason::FitRefused(error)) => Some(*error),
        _ => None,
    }
}

#[test]
fn cold_start() {
    for seed in 0..5 {
        let mut random = Random::new(100 + seed);
        let mut compensator = compensator(Normalisation::HalfRange);
        for k in 0..700 {
            let reading = push(&mut compensator, k, random.raw_one(&before(), NOISE_UT));
            if k < 99 {
                let expected = Status::Collecting(Missing::Samples { have: k + 1, need: 100 });
                assert_eq!(reading.status, expected);
                assert_eq!((reading.field_ut, reading.sigma_t, reading.heading), (None, None, None));
                assert!(compensator.calibration().is_none());
            } else {
                assert_eq!(reading.status, Status::Tracking, "sample {k}");
                let worst = worst_direction_deg(&compensator.calibration().expect("tracking"), &before());
                // 100 samples at 30 dB reach 0.7 deg rms; the worst direction of the worst sample is several times that
                assert!(worst < 5.0, "sample {k}: {worst} deg");
            }
        }
        let worst = worst_direction_deg(&compensator.calibration().expect("tracking"), &before());
        assert!(worst < 1.5, "{worst} deg");
    }
}

/// What a step of all nine parameters leads to: sigma_T and window before it, relative errors after it.
struct Step {
    sigma_t: f64,
    window: f64,
    /// Rms over the runs of the relative error of each parameter, for each sample after the step.
    errors: Vec<[f64; 9]>,
}

fn step_of_all_nine(normalisation: Normalisation, runs: u64) -> Step {
    let after_step = 3000;
    let truth = nine(&after());
    let mut squares = vec![[0.0; 9]; after_step];
    let (mut sigma_t, mut window, mut count) = (0.0, 0.0, 0.0);
    for run in 0..runs {
        let mut random = Random::new(200 + run);
        let mut compensator = compensator(normalisation);
        let mut suspected = false;
        for k in 0..STEP + after_step {
            let through = if k < STEP { before() } else { after() };
            let reading = push(&mut compensator, k, random.raw_one(&through, NOISE_UT));
            if (1000..STEP).contains(&k) {
                assert_eq!(reading.status, Status::Tracking);
                sigma_t += reading.sigma_t.expect("tracking");
                window += reading.window as f64;
                count += 1.0;
            }
            suspected |= (STEP..STEP + 100).contains(&k) && matches!(reading.status, Status::Suspect { .. });
            if k >= STEP {
                let found = nine(&compensator.calibration().expect("calibrated"));
                for (square, i) in squares[k - STEP].iter_mut().zip(0..) {
                    *square += ((found[i] - truth[i]) / truth[i]).powi(2);
                }
            }
            if k >= STEP + 1000 {
                assert_eq!(reading.status, Status::Tracking, "run {run}, sample {k}");
            }
        }
        assert!(suspected, "run {run}: a step of 50 % goes unnoticed");
    }
    let errors = squares.into_iter().map(|s| s.map(|v: f64| (v / runs as f64).sqrt())).collect();
    Step { sigma_t: sigma_t / count, window: window / count, errors }
}

impl Step {
    /// Samples after the step until the error of parameter i stays below `limit`.
    fn transient(&self, i: usize, limit: f64) -> usize {
        self.errors.iter().rposition(|e| e[i] >= limit).map_or(0, |k| k + 1)
    }

    /// Rms relative error over the last 1000 samples.
    fn steady(&self, i: usize) -> f64 {
        let last = &self.errors[self.errors.len() - 1000..];
        (last.iter().map(|e| e[i].powi(2)).sum::<f64>() / 1000.0).sqrt()
    }
}

#[test]
fn step_of_all_nine_half_range() {
    let step = step_of_all_nine(Normalisation::HalfRange, 20);
    assert!((step.sigma_t - 0.723).abs() < 0.005, "{}", step.sigma_t);
    assert!((step.window - 626.0).abs() < 10.0, "{}", step.window);
    for i in 0..9 {
        let (transient, steady) = (step.transient(i, 0.05), step.steady(i));
        assert!(transient <= 700, "parameter {i}: {transient} samples");
        assert!(steady < 0.05, "parameter {i}: {:.1} %", steady * 100.0);
    }
}

#[test]
fn step_of_all_nine_even_sphere() {
    let step = step_of_all_nine(Normalisation::EvenSphere, 20);
    assert!((step.sigma_t - 1.0).abs() < 0.01, "{}", step.sigma_t);
    // windows can't be shorter than N_min, so the mean lies above 100 + 1900 (1 - sigma_T)
    assert!((100.0..170.0).contains(&step.window), "{}", step.window);
    for i in 0..9 {
        let (transient, steady) = (step.transient(i, 0.15), step.steady(i));
        assert!(transient <= 250, "parameter {i}: {transient} samples");
        // 126 samples at 30 dB can do little better: the Cramer-Rao bound of M_xz is 7.4 % of it (crb.json, scaled)
        assert!(steady < 0.10, "parameter {i}: {:.1} %", steady * 100.0);
    }
}

/// A field that turns about one axis of the device: samples on a circle.
fn circle(k: usize, axis: &Unit<Vector3<f64>>, through: &Calibration, noise_ut: Vector3<f64>) -> Vector3<f64> {
    let start = (Vector3::new(0.3, 0.8, -0.5)).normalize() * FIELD_UT;
    through.distort(&(Rotation3::from_axis_angle(axis, k as f64 * 0.013) * start)) + noise_ut
}

#[test]
fn motion_about_one_axis_is_refused_from_the_start() {
    for (seed, axis) in [Vector3::z(), Vector3::x(), Vector3::new(0.4, -0.5, 0.77)].into_iter().enumerate() {
        let mut random = Random::new(300 + seed as u64);
        let mut compensator = compensator(Normalisation::HalfRange);
        let axis = Unit::new_normalize(axis);
        for k in 0..3000 {
            let noise_ut = random.normal3() * 0.3;
            let reading = push(&mut compensator, k, circle(k, &axis, &before(), noise_ut));
            assert!(matches!(reading.status, Status::Collecting(_)), "sample {k}: {}", reading.status);
            assert!(compensator.calibration().is_none());
            // a full turn, so that it is the motion and not its shortness
            if k > 600 {
                let refused = refusal(&reading.status);
                assert!(matches!(refused, Some(FitError::Planar { .. })), "{axis:?}, sample {k}: {refused:?}");
            }
        }
    }
}

#[test]
fn motion_about_one_axis_keeps_the_old_calibration() {
    for (seed, axis) in [Vector3::z(), Vector3::x(), Vector3::new(0.4, -0.5, 0.77)].into_iter().enumerate() {
        let mut random = Random::new(310 + seed as u64);
        let mut compensator = calibrated(&mut random, 0.3);
        let axis = Unit::new_normalize(axis);
        let mut worst = 0.0_f64;
        let mut latest = None;
        for k in STEP..STEP + 6000 {
            let noise_ut = random.normal3() * 0.3;
            latest = Some(push(&mut compensator, k, circle(k, &axis, &before(), noise_ut)));
            if k % 50 == 0 {
                worst = worst.max(worst_direction_deg(&compensator.calibration().expect("kept"), &before()));
            }
        }
        let reading = latest.expect("samples");
        let refused = refusal(&reading.status);
        assert!(matches!(reading.status, Status::Held(_)), "{axis:?}: {}", reading.status);
        assert!(matches!(refused, Some(FitError::Planar { .. })), "{axis:?}: {refused:?}");
        assert!(reading.field_ut.is_some());
        // the window empties of the even samples before a fit is refused: the last good one is what is kept
        assert!(worst < 10.0, "{axis:?}: {worst} deg");
    }
}

#[test]
fn a_device_at_rest_learns_nothing() {
    let mut random = Random::new(320);
    let still = before().distort(&(Vector3::new(0.2, 0.6, -0.77).normalize() * FIELD_UT));
    let mut cold = compensator(Normalisation::HalfRange);
    for k in 0..3000 {
        let reading = push(&mut cold, k, still + random.normal3() * 0.3);
        assert!(matches!(reading.status, Status::Collecting(_)), "sample {k}: {}", reading.status);
        assert!(cold.calibration().is_none());
        assert!(k < 200 || refusal(&reading.status).is_some(), "sample {k}: no reason given");
    }
    let mut warm = calibrated(&mut random, 0.3);
    for k in STEP..STEP + 3000 {
        let kept = warm.calibration().expect("calibrated");
        let reading = push(&mut warm, k, still + random.normal3() * 0.3);
        if k > STEP + 100 {
            assert_eq!(reading.status, Status::Held(HoldReason::LowUniformity), "sample {k}");
            assert_eq!(warm.calibration(), Some(kept));
        }
    }
    assert!(worst_direction_deg(&warm.calibration().expect("kept"), &before()) < 1.0);
}

#[test]
fn a_pulse_passes() {
    for seed in 0..5 {
        let mut random = Random::new(330 + seed);
        let mut compensator = calibrated(&mut random, NOISE_UT);
        let pulse = Vector3::new(0.6, -0.4, 0.3) * FIELD_UT;
        let mut suspected = false;
        for k in STEP..STEP + 2000 {
            let on = (STEP..STEP + 50).contains(&k);
            let raw = random.raw_one(&before(), NOISE_UT) + if on { pulse } else { Vector3::zeros() };
            let reading = push(&mut compensator, k, raw);
            suspected |= matches!(reading.status, Status::Suspect { .. });
            if k > STEP + 50 + 900 {
                assert_eq!(reading.status, Status::Tracking, "sample {k}");
                let worst = worst_direction_deg(&compensator.calibration().expect("tracking"), &before());
                assert!(worst < 2.5, "sample {k}: {worst} deg");
            }
        }
        assert!(suspected, "seed {seed}: the pulse goes unnoticed");
    }
}

#[test]
fn bad_samples_in_mid_stream_change_nothing_that_follows() {
    let mut random = Random::new(340);
    let mut clean = compensator(Normalisation::HalfRange);
    let mut dirty = compensator(Normalisation::HalfRange);
    let mut rejected = 0;
    for k in 0..3000 {
        let raw = random.raw_one(&before(), NOISE_UT);
        if k % 7 == 3 {
            let time_ns = sample(k, raw).time_ns;
            for (bad, reason) in [
                (Vector3::new(f64::NAN, 1.0, 2.0), RejectReason::NotFinite),
                (Vector3::new(1.0, f64::NEG_INFINITY, 2.0), RejectReason::NotFinite),
                (Vector3::new(1.0, 2.0, -2000.1), RejectReason::OutOfRange { value_ut: -2000.1, limit_ut: 2000.0 }),
            ] {
                let reading = dirty.push(MagneticSample { time_ns: time_ns - 1, field_ut: bad });
                assert_eq!(reading.status, Status::Rejected(reason));
                assert_eq!((reading.field_ut, reading.heading), (None, None));
                rejected += 1;
            }
            let late = sample(k - 1, raw);
            let backwards = RejectReason::TimeNotAfter { time_ns: late.time_ns, latest_ns: late.time_ns };
            assert_eq!(dirty.push(late).status, Status::Rejected(backwards));
        }
        assert_eq!(push(&mut clean, k, raw), push(&mut dirty, k, raw), "sample {k}");
    }
    assert!(rejected > 1000);
    assert!(clean == dirty);
}

/// Set back by an hour, or a single stamp an hour too late: the calibration stays.
#[test]
fn another_clock_is_taken_over() {
    const HOUR_NS: i64 = 3_600_000_000_000;
    for stray in [false, true] {
        let mut random = Random::new(360);
        let mut compensator = calibrated(&mut random, NOISE_UT);
        let known = compensator.calibration().expect("calibrated");
        let mut push = |k: usize, by_ns: i64| {
            let MagneticSample { time_ns, field_ut } = sample(STEP + k, random.raw_one(&before(), NOISE_UT));
            compensator.push(MagneticSample { time_ns: time_ns + by_ns, field_ut })
        };
        if stray {
            assert!(!matches!(push(0, HOUR_NS).status, Status::Rejected(_)));
        }
        let by_ns = if stray { 0 } else { -HOUR_NS };
        for k in 1..50 {
            assert!(matches!(push(k, by_ns).status, Status::Rejected(RejectReason::TimeNotAfter { .. })), "sample {k}");
        }
        for k in 50..100 {
            assert!(!matches!(push(k, by_ns).status, Status::Rejected(_)), "sample {k}");
        }
        let now = compensator.calibration().expect("kept");
        assert!((now.hard_iron_ut() - known.hard_iron_ut()).norm() < 0.5, "{now:?}");
    }
}

/// A magnet comes onto the phone and goes again.
#[test]
fn a_step_and_back() {
    let mut random = Random::new(350);
    let mut compensator = calibrated(&mut random, NOISE_UT);
    let mut parameters = REF;
    for (value, by) in parameters.iter_mut().zip([3.0, -2.0, 1.0]) {
        *value += by;
    }
    let with_magnet = calibration(&parameters, FIELD_UT);
    for (start, truth) in [(STEP, with_magnet), (STEP + 2000, before())] {
        let mut suspected = false;
        for k in start..start + 2000 {
            let reading = push(&mut compensator, k, random.raw_one(&truth, NOISE_UT));
            suspected |= matches!(reading.status, Status::Suspect { .. });
            if k >= start + 900 {
                assert_eq!(reading.status, Status::Tracking, "sample {k}");
                let worst = worst_direction_deg(&compensator.calibration().expect("tracking"), &truth);
                assert!(worst < 2.5, "sample {k}: {worst} deg");
            }
        }
        assert!(suspected);
    }
}

#[test]
fn the_constant_method_keeps_its_first_calibration() {
    let mut random = Random::new(360);
    let config = Config { method: magcomp::Method::Constant, ..compensator(Normalisation::HalfRange).config().clone() };
    let mut compensator = Compensator::new(config).expect("a valid config");
    let mut kept = None;
    for k in 0..STEP + 1000 {
        let through = if k < STEP { before() } else { after() };
        let reading = push(&mut compensator, k, random.raw_one(&through, NOISE_UT));
        match (kept, compensator.calibration()) {
            (None, now) => kept = now,
            (Some(kept), now) => {
                assert_eq!(now, Some(kept), "sample {k}");
                let held = matches!(reading.status, Status::Held(HoldReason::Constant) | Status::Suspect { .. });
                assert!(held, "sample {k}: {}", reading.status);
            }
        }
    }
    let worst = worst_direction_deg(&kept.expect("calibrated"), &before());
    assert!(worst < 4.0, "{worst} deg");
}
