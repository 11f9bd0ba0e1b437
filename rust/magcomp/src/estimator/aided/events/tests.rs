//! What a trial decides, just below and just above each of its limits.

use super::*;
use nalgebra::Vector3;

const NOW_NS: i64 = 7_000_000_000;
const DT_S: f64 = 0.01;
const BELOW: f64 = 0.999;
const ABOVE: f64 = 1.001;

/// Turned for just long enough and over the ramp; nothing misfits, and neither is likelier.
fn open(tuning: &Tuning) -> Trial {
    Trial {
        rotation_rad: ABOVE * tuning.decide_rotation_rad,
        age_s: ABOVE * tuning.ramp_s,
        onset_ns: 5_000_000_000,
        ..Trial::default()
    }
}

fn decided(mut trial: Trial, tuning: &Tuning) -> Option<Verdict> {
    trial.decide(NOW_NS, DT_S, tuning)
}

#[test]
fn each_hypothesis_wins_from_its_limits_on() {
    let tuning = Tuning::default();
    let ratio = tuning.decide_log_ratio;
    let cases = [
        (0.0, 0.0, 0.0, Some(Verdict::Open)),
        (ABOVE * ratio, 0.0, 0.0, Some(Verdict::Device)),
        (BELOW * ratio, 0.0, 0.0, Some(Verdict::Open)),
        (-ABOVE * ratio, 0.0, 0.0, Some(Verdict::Place)),
        (-BELOW * ratio, 0.0, 0.0, Some(Verdict::Open)),
        // a device must fit nearly all samples, a place most of them
        (ABOVE * ratio, BELOW * tuning.suspect_share, 1.0, Some(Verdict::Device)),
        (ABOVE * ratio, ABOVE * tuning.suspect_share, 1.0, Some(Verdict::Open)),
        (-ABOVE * ratio, 1.0, BELOW * MOST, Some(Verdict::Place)),
        (-ABOVE * ratio, BELOW * MOST, ABOVE * MOST, Some(Verdict::Open)),
        // neither
        (ABOVE * ratio, ABOVE * MOST, ABOVE * MOST, None),
        (ABOVE * ratio, BELOW * MOST, ABOVE * MOST, Some(Verdict::Open)),
        (ABOVE * ratio, ABOVE * MOST, BELOW * MOST, Some(Verdict::Open)),
    ];
    for (log_ratio, device_misfit, place_misfit, expected) in cases {
        let trial = Trial { log_ratio, device_misfit, place_misfit, ..open(&tuning) };
        assert_eq!(decided(trial, &tuning), expected, "{log_ratio}, {device_misfit}, {place_misfit}");
    }
}

#[test]
fn nothing_wins_before_the_device_has_turned_and_the_change_has_held() {
    let tuning = Tuning::default();
    let hold_s = 2.0;
    let [turn_rad, over_s] = [tuning.decide_rotation_rad, tuning.ramp_s];
    // what must be turned, how long it must hold: with a former calibration half as much, and not for longer in a place that bursts
    for (recalled, hold_s, rotation_rad, age_s) in [
        (false, 0.0, turn_rad, over_s),
        (true, 0.0, 0.5 * turn_rad, over_s),
        (false, hold_s, turn_rad * (1.0 + hold_s / tuning.quick_s), over_s + hold_s),
        (true, hold_s, 0.5 * turn_rad, over_s),
    ] {
        for (turned, held, expected) in
            [(ABOVE, ABOVE, Verdict::Device), (BELOW, ABOVE, Verdict::Open), (ABOVE, BELOW, Verdict::Open)]
        {
            let mut trial = Trial {
                recalled,
                rotation_rad: turned * rotation_rad,
                age_s: held * age_s,
                log_ratio: ABOVE * tuning.decide_log_ratio,
                ..Trial::default()
            };
            trial.hold_s = hold_s;
            assert_eq!(decided(trial, &tuning), Some(expected), "recalled {recalled}, {hold_s} s, {turned}, {held}");
        }
    }
}

#[test]
fn after_a_pause_it_is_nothing_unless_the_device_is_likelier() {
    let tuning = Tuning::default();
    for (log_ratio, place_misfit, expected) in [
        (0.0, BELOW * MOST, Verdict::Unchanged),
        (0.0, ABOVE * MOST, Verdict::Open),
        (ABOVE * tuning.decide_log_ratio, 0.0, Verdict::Device),
        (-ABOVE * tuning.decide_log_ratio, 0.0, Verdict::Unchanged),
    ] {
        let trial = Trial { began: Began::Pause, log_ratio, place_misfit, ..open(&tuning) };
        assert_eq!(decided(trial, &tuning), Some(expected), "{log_ratio}, {place_misfit}");
    }
}

#[test]
fn a_place_is_found_now_and_is_new_when_it_has_lasted() {
    let tuning = Tuning::default();
    let mut trial = Trial { log_ratio: -ABOVE * tuning.decide_log_ratio, ..open(&tuning) };
    assert_eq!(trial.decide(NOW_NS, DT_S, &tuning), Some(Verdict::Place));
    assert_eq!((trial.began, trial.onset_ns), (Began::Misfit, 5_000_000_000));
    assert_eq!(trial.stage, Stage::Place { held_s: 0.0, fitted_ns: NOW_NS });
    // it lasts whatever the device does, and is remembered to have fitted while nearly all samples did
    for (misfit, fitted_ns) in [(0.99, NOW_NS + 1), (1.01, NOW_NS)] {
        let place_misfit = misfit * 0.5 * tuning.suspect_share;
        let mut trial = Trial { place_misfit, device_misfit: 0.0, log_ratio: 1e3, ..trial.clone() };
        assert_eq!(trial.decide(NOW_NS + 1, DT_S, &tuning), Some(Verdict::Open));
        assert_eq!(trial.stage, Stage::Place { held_s: DT_S, fitted_ns }, "{misfit}");
    }
    for (held_s, misfit, expected) in [
        (tuning.place_time_s - 1.5 * DT_S, BELOW, Some(Verdict::Open)),
        (tuning.place_time_s - 0.5 * DT_S, BELOW, Some(Verdict::NewPlace)),
        (tuning.place_time_s - 1.5 * DT_S, ABOVE, None),
        (tuning.place_time_s - 0.5 * DT_S, ABOVE, None),
    ] {
        let stage = Stage::Place { held_s, fitted_ns: NOW_NS };
        let trial = Trial { stage, place_misfit: misfit * MOST, ..trial.clone() };
        assert_eq!(decided(trial, &tuning), expected, "{held_s} s, {misfit}");
    }
}

#[test]
fn a_step_back_or_a_step_is_told_if_it_is_large_enough() {
    let tuning = Tuning::default();
    for (began, least_ut) in [(Began::Misfit, LEAST_TOLD_UT), (Began::Pause, tuning.smallest_step_ut)] {
        for (recalled, kind) in [(false, EventKind::DeviceStep), (true, EventKind::DeviceStepBack)] {
            for (share, expected) in [(ABOVE, Some(kind)), (BELOW, None)] {
                let mut trial = Trial { recalled, began, ..Trial::default() };
                let before = Filter::default();
                let moved = before.part(HARD_IRON) + Vector3::new(2.0, -1.0, 2.0) / 3.0 * (share * least_ut);
                trial.device.set_part(HARD_IRON, &moved);
                assert_eq!(trial.device_event(&before, &tuning), expected, "{began:?}, {recalled}, {share}");
            }
        }
    }
}

#[test]
fn the_likelier_hypothesis_is_explained_first() {
    for (log_ratio, began, recalled, kinds) in [
        (3.0, Began::Misfit, false, [ChangeKind::Device, ChangeKind::Place]),
        (-3.0, Began::Misfit, true, [ChangeKind::Place, ChangeKind::DeviceBack]),
        (-3.0, Began::Pause, false, [ChangeKind::Unchanged, ChangeKind::Device]),
    ] {
        let onset_ns = 5;
        let trial = Trial {
            log_ratio,
            recalled,
            began,
            onset_ns,
            rotation_rad: 0.7,
            device_misfit: 0.1,
            place_misfit: 0.2,
            ..Trial::default()
        };
        let told = trial.explain();
        assert_eq!(told.map(|it| it.kind), kinds);
        assert_eq!(told.map(|it| it.log_odds), [0.0, -3.0]);
        assert_eq!(told.map(|it| it.onset_ns), [5; 2]);
        let shares = if log_ratio > 0.0 { [0.1, 0.2] } else { [0.2, 0.1] };
        assert_eq!(told.map(|it| it.gated_share), shares.map(Some));
        assert_eq!(trial.rotation_rad, 0.7);
    }
}
