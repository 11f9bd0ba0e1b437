//! A look inside: what `Compensator::explain` tells must be what the estimators did.

use magcomp::nalgebra::Vector3;
use magcomp::{
    Calibration, ChangeKind, Compensator, Config, Estimator, EstimatorPhase, EventKind, Explanation, MagneticSample,
    Method, SampleUse, Status,
};
use magcomp_tests::{METHODS, PERIOD_NS, Phone, REF, calibration};

/// Of the phone's magnetometer, uT, and its gyroscope's bias, rad/s.
const WHITE_UT: f64 = 0.4;
const BIAS_RAD_S: Vector3<f64> = Vector3::new(0.01, -0.02, 0.015);
/// Of `v^T S^-1 v`, as the documentation of `InnovationTest::ratio` states it.
const GATE: f64 = 16.0;

fn truth() -> Calibration {
    calibration(&REF.map(|v| v * 0.5 + 0.5 * f64::from(u8::from(v > 0.9))), 48.0)
}

/// The same with another hard iron.
fn with_magnet() -> Calibration {
    let b = truth().hard_iron_ut() + Vector3::new(16.0, -19.0, 11.0);
    Calibration::new(*truth().soft_iron(), b, 48.0).expect("a phone's")
}

fn compensator(method: Method) -> Compensator {
    Compensator::new(Config { method, ..Config::default() }).expect("a valid config")
}

/// A phone that has been turned for 30 s.
fn settled(seed: u64, method: Method) -> (Phone, Compensator) {
    let (mut phone, mut compensator) = (Phone::new(seed, truth()), compensator(method));
    phone.run(&mut compensator, 3000);
    (phone, compensator)
}

/// Samples that the filter takes as one at 100 Hz.
const FRAME: usize = 4;

#[test]
fn a_start_tries_the_magnetometer_alone_once_the_gyroscope_has_broken_off() {
    let (mut phone, mut compensator) = (Phone::new(1, truth()), compensator(Method::Auto));
    let before = compensator.explain();
    assert_eq!((before.phase, before.sample), (EstimatorPhase::Starting, None));
    phone.run(&mut compensator, 2);
    let mut broken = (phone.clone(), compensator.clone());
    for (gyroscope, samples) in [(true, 20), (false, 60)] {
        assert!(!broken.1.explain().tries_both);
        broken.0.gyroscope = gyroscope;
        broken.0.run(&mut broken.1, samples);
    }
    assert!(broken.1.explain().tries_both);
    let mut pooled = 0;
    while compensator.explain().phase == EstimatorPhase::Starting {
        let it = compensator.explain();
        assert!(!it.tries_both && it.innovation.is_none() && it.gated_share.is_none());
        pooled += usize::from(it.estimator == Estimator::Aided && it.sample == Some(SampleUse::Pooled));
        phone.run(&mut compensator, 1);
        assert!(phone.time_ns < 30_000_000_000, "no calibration in 30 s");
    }
    assert!(pooled > 10, "{pooled}");
    phone.run(&mut compensator, FRAME);
    let it = compensator.explain();
    assert_eq!((it.estimator, it.phase), (Estimator::Aided, EstimatorPhase::Running));
    assert!(it.innovation.is_some() && it.hypotheses == [None; 4]);
}

/// Innovations have the size that is expected of them, and few are gated.
#[test]
fn in_a_quiet_stream_innovations_are_of_the_expected_size() {
    let (mut phone, mut compensator) = settled(2, Method::Auto);
    let (mut squares, mut axes, mut gated) = (0.0, Vector3::zeros(), 0);
    let count = 6000;
    for _ in 0..count {
        phone.run(&mut compensator, 1);
        let it = compensator.explain();
        assert_eq!((it.phase, it.tries_both), (EstimatorPhase::Running, false));
        let test = it.innovation.expect("there is a rotation");
        assert_eq!(it.sample, Some(if test.ratio > 1.0 { SampleUse::Gated } else { SampleUse::Used }));
        gated += usize::from(test.ratio > 1.0);
        squares += test.ratio * GATE / f64::from(count);
        axes += test.innovation_ut.component_div(&test.expected_ut).map(|v| v * v) / f64::from(count);
    }
    // one in 900 of three degrees of freedom lies above the gate: seven, and hardly twenty
    assert!(gated <= 20, "{gated}");
    // three degrees of freedom; the mean of 1500 frames scatters by 2 %, the learned noise by some more. No place is taken to be as even as this one: that
    // leaves half of it
    assert!((0.4..0.8).contains(&(squares / 3.0)), "{squares}");
    assert!(axes.iter().all(|square| (0.3..0.9).contains(square)), "{axes:?}");
}

#[test]
fn noise_levels_are_those_of_the_phone() {
    for seed in 10..13 {
        let (_, compensator) = settled(seed, Method::Auto);
        let noise = compensator.explain().noise;
        let white_ut = noise.white_ut.expect("learned");
        assert!((white_ut / WHITE_UT - 1.0).abs() < 0.2, "{white_ut}");
        let (bias, sigma) =
            (noise.gyroscope_bias_rad_s.expect("known"), noise.gyroscope_bias_sigma_rad_s.expect("known"));
        for i in 0..3 {
            assert!((bias[i] - BIAS_RAD_S[i]).abs() < 4.0 * sigma[i] && sigma[i] < 0.005, "{bias:?} {sigma:?}");
        }
        // its rates are those of the middle of the 10 ms before them: the magnetometer is early by half of that
        let (delay_s, sigma_s) = (noise.delay_s.expect("known"), noise.delay_sigma_s.expect("known"));
        assert!((delay_s + 0.005).abs() < 4.0 * sigma_s && sigma_s < 0.005, "{delay_s} {sigma_s}");
        let (_, alone) = settled(seed, Method::Adaptive);
        let noise = alone.explain().noise;
        let white_ut = noise.white_ut.expect("learned");
        assert!((white_ut / WHITE_UT - 1.0).abs() < 0.2, "{white_ut}");
        assert!(noise.local_ut.is_some() && noise.delay_s.is_none() && noise.gyroscope_bias_rad_s.is_none());
    }
}

/// The explanations of so many samples while `Undecided`, and the first one after.
fn undecided(phone: &mut Phone, compensator: &mut Compensator, most: usize) -> (Vec<Explanation>, Option<Explanation>) {
    let mut found = Vec::new();
    for _ in 0..most {
        phone.run(compensator, 1);
        let it = compensator.explain();
        match it.phase {
            EstimatorPhase::Undecided => found.push(it),
            // samples that do not fit come before the doubt
            _ if found.is_empty() => {
                assert!(it.sample == Some(SampleUse::Gated) || it.gated_share < Some(0.1), "{it:?}")
            }
            _ => return (found, Some(it)),
        }
    }
    (found, None)
}

#[test]
fn a_step_of_the_device_is_doubted_compared_and_decided() {
    for seed in 20..24 {
        let (mut phone, mut compensator) = settled(seed, Method::Auto);
        phone.truth = with_magnet();
        let step_ns = phone.time_ns + PERIOD_NS;
        let (doubts, after) = undecided(&mut phone, &mut compensator, 1000);
        let after = after.expect("decided within 10 s");
        let first = doubts.first().expect("a step of 27 uT is doubted");
        assert!(first.innovation.expect("a rotation").ratio > 1.0, "{first:?}");
        // the first frame of the doubt is told until the next one is full
        for it in &doubts[FRAME..] {
            assert_eq!(it.sample, Some(SampleUse::Compared));
            let [Some(best), Some(other), None, None] = it.hypotheses else { panic!("{it:?}") };
            assert!(best.onset_ns == other.onset_ns && (best.onset_ns - step_ns).abs() <= 50_000_000, "{best:?}");
            assert!(best.log_odds == 0.0 && other.log_odds <= 0.0);
        }
        let last = doubts.last().expect("some");
        let [Some(best), Some(other), ..] = last.hypotheses else { panic!("{last:?}") };
        assert_eq!((best.kind, other.kind), (ChangeKind::Device, ChangeKind::Place));
        // a frame counts for its four samples, each of which adds 8 for a misfit at most: the next one is beyond 30
        assert!(best.gated_share < Some(0.5) && (-30.0..0.0).contains(&other.log_odds), "{other:?}");
        assert!(last.compared_turn_deg > Some(28.0), "{last:?}");
        assert_eq!((after.phase, after.hypotheses), (EstimatorPhase::Running, [None; 4]));
        // in force, and told once it has held
        let told: Vec<_> = (0..200).map(|_| phone.advance(&mut compensator).event).collect();
        assert_eq!(told[..140], [None; 140]);
        let event = told[199].expect("told");
        assert_eq!((event.kind, event.since_ns), (EventKind::DeviceStep, best.onset_ns));
    }
}

#[test]
fn another_place_wins_where_the_place_changed() {
    let (mut phone, mut compensator) = settled(30, Method::Auto);
    phone.field_ut += Vector3::new(15.0, -5.0, 12.0);
    let (doubts, after) = undecided(&mut phone, &mut compensator, 500);
    assert_eq!(after, None, "the place is held for longer");
    let [Some(best), Some(other), ..] = doubts.last().expect("doubted").hypotheses else { panic!("{doubts:?}") };
    assert_eq!((best.kind, other.kind), (ChangeKind::Place, ChangeKind::Device));
    assert!(other.log_odds < -30.0, "{other:?}");
    assert!(
        matches!(phone.advance(&mut compensator).status, Status::Disturbed { since_ns } if since_ns == best.onset_ns)
    );
}

#[test]
fn at_rest_and_without_a_rotation_nothing_is_judged() {
    let (mut phone, mut compensator) = settled(40, Method::Auto);
    phone.moving = false;
    phone.run(&mut compensator, 300);
    for _ in 0..500 {
        phone.run(&mut compensator, 1);
        let it = compensator.explain();
        assert_eq!((it.phase, it.sample), (EstimatorPhase::Running, Some(SampleUse::AtRest)));
    }
    phone.gyroscope = false;
    phone.run(&mut compensator, 50);
    let it = compensator.explain();
    assert_eq!((it.estimator, it.sample, it.innovation), (Estimator::Aided, Some(SampleUse::NoRotation), None));
    phone.run(&mut compensator, 200);
    assert_eq!(compensator.explain().estimator, Estimator::Adaptive);
}

#[test]
fn the_adaptive_hypotheses_are_told_the_likeliest_first() {
    let (mut phone, mut compensator) = settled(50, Method::Adaptive);
    phone.truth = with_magnet();
    let step_ns = phone.time_ns + PERIOD_NS;
    let (mut gated, mut rivals, mut doubted) = (0, 0, false);
    for _ in 0..1000 {
        phone.run(&mut compensator, 1);
        let it = compensator.explain();
        let odds: Vec<f64> = it.hypotheses.iter().flatten().map(|it| it.log_odds).collect();
        assert!(odds[0] == 0.0 && odds.is_sorted_by(|a, b| a >= b), "{odds:?}");
        gated += usize::from(it.sample == Some(SampleUse::Gated));
        rivals += usize::from(odds.len() > 1);
        doubted |= it.phase == EstimatorPhase::Undecided;
    }
    assert!(gated > 0 && rivals > 10 && doubted, "{gated} {rivals} {doubted}");
    let it = compensator.explain();
    let best = it.hypotheses[0].expect("there is one");
    assert!(matches!(best.kind, ChangeKind::HardIron | ChangeKind::Device), "{best:?}");
    assert!((best.onset_ns - step_ns).abs() < 500_000_000, "{best:?}");
    assert_eq!(it.phase, EstimatorPhase::Running);
}

/// Through a start, rejected samples, a step, rest and a loss of the gyroscope, in every method.
#[test]
fn an_explanation_changes_no_reading() {
    for method in METHODS {
        let mut phone = Phone::new(60, truth());
        let (mut asked, mut other) = (compensator(method), compensator(method));
        for k in 0..3000 {
            if k == 1200 {
                phone.truth = with_magnet();
            }
            phone.moving = !(1800..2200).contains(&k);
            phone.gyroscope = !(2400..2700).contains(&k);
            let mut twin = phone.clone();
            assert_eq!(phone.advance(&mut asked), twin.advance(&mut other), "{method:?}, sample {k}");
            let it = asked.explain();
            if k % 100 == 7 {
                // a rejected sample is none that could be explained
                let bad = MagneticSample { time_ns: phone.time_ns, field_ut: Vector3::repeat(f64::NAN) };
                assert_eq!(asked.push(bad), other.push(bad));
                assert_eq!(asked.explain(), it);
            }
        }
        assert!(asked == other);
    }
}

#[test]
fn the_paper_pools_its_samples() {
    for method in [Method::Windowed, Method::Constant] {
        let mut compensator = compensator(method);
        let mut phone = Phone::new(70, truth());
        phone.run(&mut compensator, 1);
        let it = compensator.explain();
        assert_eq!((it.estimator, it.phase), (Estimator::Windowed, EstimatorPhase::Starting));
        assert_eq!((it.sample, it.noise.white_ut), (Some(SampleUse::Pooled), None));
        phone.run(&mut compensator, 3000);
        let it = compensator.explain();
        assert_eq!(it.phase, EstimatorPhase::Running);
        let usage = if method == Method::Constant { SampleUse::Unused } else { SampleUse::Pooled };
        assert_eq!((it.sample, it.hypotheses), (Some(usage), [None; 4]));
        assert!((it.noise.white_ut.expect("a fit") / WHITE_UT - 1.0).abs() < 0.2, "{:?}", it.noise);
    }
}
