//! The adaptive method on simulated streams: what its documentation claims, on few seeds; the figures quoted there are of
//! many more (`magcomp step --method adaptive`, `magcomp compare`).

use magcomp::{Config, Method, ReferenceAxis};
use magcomp_lab::experiment::adaptive::{AdaptiveOptions, AdaptiveResult, run};
use magcomp_lab::recording::read;
use magcomp_lab::replay::{Ignore, Step, judge, replay};
use magcomp_lab::scenario::Case;

fn adaptive(case: Case, runs: usize, seed: u64) -> AdaptiveResult {
    let options = AdaptiveOptions { case, runs, seed, snr_db: None, repeats: 1 };
    run(&options).expect("the default config")
}

#[test]
fn a_step_of_everything_is_learned_in_a_second() {
    let result = adaptive(Case::Step, 8, 700);
    // all of M grows by half: beyond what is expected of phones
    assert!(result.score.settled[1].is_some_and(|samples| samples <= 100), "{:?}", result.score.settled);
    assert!(result.score.steady_deg < 0.2, "{}", result.score.steady_deg);
    assert_eq!(result.declared, 1.0, "one change, declared once");
    // right after the step a run may still weigh another place against the step
    for at in result.score.over_bound.expect("parameters").iter().skip(1) {
        assert!(at.iter().all(|ratio| *ratio < 2.0), "{at:?}");
    }
}

#[test]
fn noise_three_times_other_than_a_phones_does_not_matter() {
    // 0.167 and 1.5 uT of 40; the estimator takes 0.5 before it has learned
    for (snr_db, before_deg, settled) in [(47.6, 0.05, 20), (28.5, 0.42, 80)] {
        let options = AdaptiveOptions { case: Case::SmallStep, runs: 4, seed: 720, snr_db: Some(snr_db), repeats: 1 };
        let result = run(&options).expect("a valid config");
        assert!(result.score.before_deg < before_deg, "{snr_db} dB: {}", result.score.before_deg);
        assert!(result.score.settled[1].is_some_and(|samples| samples <= settled), "{:?}", result.score.settled);
    }
}

#[test]
fn a_hand_is_enough() {
    let result = adaptive(Case::PhoneHand, 6, 740);
    assert!(result.score.before_deg < 0.6, "{}", result.score.before_deg);
    assert!(result.score.told_deg[2] < 5.0, "{:?}", result.score.told_deg);
    assert!(result.score.told_deg[4] < 1.0, "{:?}", result.score.told_deg);
}

#[test]
fn walking_is_enough_for_b_where_m_is_known() {
    let result = adaptive(Case::PhoneWalkKnown, 6, 760);
    assert!(result.score.told_deg[2] < 1.0, "{:?}", result.score.told_deg);
    assert!(result.score.settled[1].is_some_and(|samples| samples <= 1000), "{:?}", result.score.settled);
}

#[test]
fn spikes_hardly_cost_anything() {
    let clean = adaptive(Case::PhoneHand, 4, 780).score;
    let spiky = adaptive(Case::PhoneSpikes, 4, 780).score;
    for (spiky, clean) in [(spiky.before_deg, clean.before_deg), (spiky.after_deg, clean.after_deg)] {
        assert!(spiky < 1.5 * clean.max(0.1), "{spiky} against {clean}");
    }
}

#[test]
fn a_pulse_is_over_when_it_is_over() {
    let result = adaptive(Case::Pulse, 24, 800);
    // 50 samples long; within 20 of its end everything is as before, in 19 runs of 20
    assert!(result.score.settled[1].is_some_and(|samples| samples <= 70), "{:?}", result.score.settled);
    assert_eq!(result.declared, 0.0, "no change lasted");
}

#[test]
fn a_cover_taken_off_again_is_recalled() {
    let result = adaptive(Case::Covers, 4, 820);
    // a few samples tell, of 1500
    assert!(result.score.steady_deg < 0.9, "{}", result.score.steady_deg);
}

#[test]
fn a_ramp_is_followed() {
    let result = adaptive(Case::Ramp, 4, 840);
    assert!(result.score.after_deg < 0.56, "{}", result.score.after_deg);
}

#[test]
fn a_drift_is_followed() {
    let result = adaptive(Case::PhoneDrift, 4, 840);
    assert!(result.score.after_deg < 3.5, "{}", result.score.after_deg);
    let [one, two] = result.honesty[3].within_sigma;
    assert!(one > 0.6 && two > 0.9, "{one} and {two}");
}

/// Over the runs and 50 samples, what is released is hardly ever worse than what was in force.
#[test]
fn never_much_worse_than_holding() {
    let repeated = [Case::Pulse, Case::Covers, Case::RandomSteps];
    for case in [Case::StepHand, Case::SmallStepHand, Case::PhoneHand, Case::PhoneWalk].into_iter().chain(repeated) {
        let result = adaptive(case, 6, 860);
        assert!(result.score.worst_over_held < 1.2, "{case:?}: {}", result.score.worst_over_held);
    }
    // short arcs whose noise looked like the other side of the ellipsoid
    let hand = adaptive(Case::StepHand, 24, 4000);
    assert!(hand.score.worst_over_held < 1.2, "{}", hand.score.worst_over_held);
    // a small change found by a span that began before it
    for (case, seed) in [(Case::SmallStepHand, 7014), (Case::PhoneWalk, 4004)] {
        let result = adaptive(case, 1, seed);
        assert!(result.score.worst_over_held < 1.2, "{case:?}, {seed}: {}", result.score.worst_over_held);
    }
}

/// The mixture counts hypotheses of changes that have not happened, and unevenness that is not there: the error is smaller than
/// the covariance, on average by less than the square of 2.6.
#[test]
fn sigmas_are_honest_where_nothing_changes() {
    for (case, period) in [(Case::Constant, 3), (Case::PhoneSteady, 3), (Case::PhoneWalkSteady, 0)] {
        let result = adaptive(case, 6, 880);
        let [one, two] = result.honesty[period].within_sigma;
        assert!(one > 0.6 && two > 0.9, "{case:?}: {one} and {two}");
        let [nees, _] = result.honesty[period].nees.expect("a covariance");
        assert!((0.15..1.6).contains(&nees), "{case:?}: {nees}");
    }
}

/// Without gyroscope, from a cold start. Both devices lie on a table at first, or no magnet is attached yet.
#[test]
fn recordings_are_corrected_as_well_as_their_motion_allows() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings");
    let heading = |name: &str, part: std::ops::Range<f64>| {
        let recording = read(&path.join(name)).expect("a recording");
        let config = Config { method: Method::Adaptive, ..Config::default() };
        let steps =
            replay(&recording, &config, Ignore { gyroscope: true, ..Ignore::default() }).expect("a valid config");
        let judged = judge(&recording, &steps, part.clone(), ReferenceAxis::default());
        let [found, raw] = [judged.heading, judged.raw_heading].map(|error| error.expect("a reference").rms_deg);
        let begin_s = steps[0].reading.time_ns as f64 * 1e-9;
        let within = |step: &&Step| part.contains(&(step.reading.time_ns as f64 * 1e-9 - begin_s));
        let sigmas = steps.iter().filter(within).filter_map(|step| step.reading.heading?.heading_sigma_deg);
        let least = sigmas.fold(f64::INFINITY, f64::min);
        println!("{name}: {found:.2} deg, raw {raw:.2}; sigma at least {least:.2}");
        (found, raw, least)
    };
    // calibrated by its maker
    let (found, raw, _) = heading("broad_01_slow_rotation_A.csv.gz", 60.0..150.0);
    assert!(found < 1.25 * raw, "{found} against {raw}");
    // put on a table where the field is 3 uT weaker: whether that is the place or the device nothing tells
    let (found, _, sigma) = heading("broad_01_slow_rotation_A.csv.gz", 160.0..f64::INFINITY);
    assert!(found < 2.0 * sigma, "{found} and sigma {sigma}");
    // from 20 s after the magnet was attached
    let (found, ..) = heading("broad_34_attached_magnet_3cm.csv.gz", 75.1..97.8);
    assert!(found < 8.0, "{found}");
}

const STEADY: [Case; 5] =
    [Case::Constant, Case::PhoneSteady, Case::PhoneWalkSteady, Case::PhonePlanar, Case::PhoneStill];

#[test]
fn nothing_is_declared_where_nothing_changes() {
    for case in STEADY {
        let result = adaptive(case, 3, 900);
        // walking, a calibration is found out gradually: that may be called a change once a run
        let called = result.false_alarms as f64 + 3.0 * result.declared;
        assert!(called <= if case == Case::PhoneWalkSteady { 3.0 } else { 0.0 }, "{case:?}: {called} in 3 runs");
    }
}

/// Walking, where the first answer is off by tens of degrees, sigma says so.
#[test]
fn a_rough_first_answer_is_told_to_be_rough() {
    let options =
        AdaptiveOptions { case: Case::PhoneWalkSteady, runs: 1, seed: 50_189, snr_db: Some(30.0), repeats: 1 };
    let result = run(&options).expect("a valid config");
    assert!(result.score.before_deg < 10.0, "{}", result.score.before_deg);
    assert!(result.honesty[0].within_sigma[1] > 0.85, "{:?}", result.honesty[0]);
}

/// Three million samples of every motion at 40 and at 30 dB: fewer changes declared than one in a million.
#[test]
#[ignore = "30 million samples: twenty minutes"]
fn fewer_than_one_false_alarm_in_a_million_samples() {
    for case in STEADY {
        for snr_db in [40.0, 30.0] {
            let options = AdaptiveOptions { case, runs: 500, seed: 50_000, snr_db: Some(snr_db), repeats: 1 };
            let result = run(&options).expect("a valid config");
            let alarms = (result.false_alarms, result.declared, result.suspected_before);
            println!("{case:?}, {snr_db} dB: {alarms:?} in {} samples", result.samples);
            let declared = result.false_alarms as f64 + result.declared * 500.0;
            assert!(result.samples >= 3_000_000, "{}", result.samples);
            assert!(declared < 1e-6 * result.samples as f64, "{case:?}, {snr_db} dB: {alarms:?}");
        }
    }
}
