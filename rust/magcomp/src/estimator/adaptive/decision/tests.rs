//! What is told of a bank that is made by hand: a few hypotheses, of which everything is known.

use super::*;
use crate::estimator::adaptive::parameters::{Gaussian, TauMatrix, tau_of};
use crate::estimator::adaptive::state::State;
use crate::priors::SETTLED_S;
use nalgebra::{Matrix3, Vector3};

const UNIT_UT: f64 = 45.0;
const NOW_NS: i64 = 100_000_000_000;

fn s(seconds: f64) -> i64 {
    (seconds * 1e9).round() as i64
}

/// A hypothesis that is known, turned, and has b at these microtesla.
fn hypothesis(kind: Kind, id: u32, onset_ns: i64, b_ut: f64, log: f64) -> Filter {
    let mean = tau_of(&Matrix3::identity(), &(Vector3::x() * (b_ut / UNIT_UT)));
    let known = Gaussian { mean, covariance: TauMatrix::from_diagonal_element(1e-6) };
    let mut base = State::new(&known, 1e-6, 1e-6);
    base.log = log;
    let mut filter = Filter::new(kind, base, mean, 0, onset_ns);
    filter.id = id;
    filter.estimate_error();
    assert!(filter.is_known());
    filter
}

/// The device has turned by `rad` to each side of x.
fn turned(mut filter: Filter, rad: f64) -> Filter {
    for side in [-1.0, 1.0] {
        let u = filter.now.tau().fixed_rows::<3>(6) + Vector3::new(f64::cos(rad), side * f64::sin(rad), 0.0);
        let frame = crate::estimator::adaptive::frame::Frame { u, white: 1.0, count: 1.0, ..Default::default() };
        let now = filter.now.clone();
        filter.add(&frame, &Tuning::USED, UNIT_UT);
        filter.now = now;
    }
    filter
}

fn bank(all: impl IntoIterator<Item = Filter>) -> Bank {
    let mut bank = Bank::new(UNIT_UT);
    all.into_iter().for_each(|it| bank.all.push(it));
    bank
}

/// A decision that has seen the first calibration.
fn settled() -> Decision {
    let mut decision = Decision::default();
    decision.review(&bank([hypothesis(Kind::Cold, 1, 0, 0.0, 0.0)]), s(10.0), UNIT_UT, &Tuning::USED);
    assert_eq!((decision.id, decision.event, decision.suspected_ns), (1, None, None));
    decision
}

fn reviewed(mut decision: Decision, bank: &Bank) -> Decision {
    decision.review(bank, NOW_NS, UNIT_UT, &Tuning::USED);
    decision
}

#[test]
fn a_change_of_the_device_is_told_when_it_has_lasted_is_shown_and_sure() {
    let change_s = Tuning::USED.change_s;
    let shown_rad = Tuning::USED.shown_rad2.sqrt();
    // two directions by an angle to each side of their mean: 1 - cos^2 is its sine squared
    let (enough, too_little) = (1.01 * shown_rad.asin(), 0.99 * shown_rad.asin());
    let old = |log: f64| hypothesis(Kind::Cold, 1, 0, 0.0, log);
    // log odds, how long ago, turn, b: told, suspected
    for (log, ago_s, turn_rad, b_ut, is_told, is_suspected) in [
        (100f64.ln(), 1.01 * change_s, enough, 9.0, true, true),
        (98f64.ln(), 1.01 * change_s, enough, 9.0, false, true),
        (100f64.ln(), 0.99 * change_s, enough, 9.0, false, true),
        (100f64.ln(), 1.01 * change_s, too_little, 9.0, false, true),
        (-1.0, 1.01 * change_s, enough, 9.0, false, false),
    ] {
        let onset_ns = NOW_NS - s(ago_s);
        let new = turned(hypothesis(Kind::Device, 2, onset_ns, b_ut, log), turn_rad);
        let found = reviewed(settled(), &bank([old(0.0), new]));
        let told = Event { kind: EventKind::DeviceStep, since_ns: onset_ns, decided_ns: NOW_NS };
        let name = format!("{log}, {ago_s} s, {turn_rad} rad");
        assert_eq!(found.event, is_told.then_some(told), "{name}");
        assert_eq!(found.suspected_ns, is_suspected.then_some(onset_ns), "{name}");
        assert_eq!(found.id, if is_told { 2 } else { 1 }, "{name}");
        assert_eq!(found.order, if is_told { ModelOrder::All } else { ModelOrder::default() }, "{name}");
    }
}

#[test]
fn a_change_too_small_to_tell_is_taken_and_suspects_nothing_once_known() {
    let onset_ns = NOW_NS - s(10.0);
    for (share, is_told) in [(0.99, false), (1.01, true)] {
        let new = turned(hypothesis(Kind::Device, 2, onset_ns, share * LEAST_TOLD_UT, 9.0), 1.0);
        let found = reviewed(settled(), &bank([hypothesis(Kind::Cold, 1, 0, 0.0, 0.0), new.clone()]));
        assert_eq!((found.id, found.event.is_some()), (2, is_told), "{share}");
        // before it has lasted
        let mut fresh = new;
        fresh.onset_ns = NOW_NS - s(0.5);
        let found = reviewed(settled(), &bank([fresh.clone()]));
        assert_eq!(found.suspected_ns.is_some(), is_told, "{share}");
        fresh.error = 1.0;
        assert!(reviewed(settled(), &bank([fresh])).suspected_ns.is_some(), "{share}: what is not known may matter");
    }
}

#[test]
fn the_way_back_is_told_as_such() {
    let onset_ns = NOW_NS - s(10.0);
    let back = turned(hypothesis(Kind::Former, 2, onset_ns, 9.0, 9.0), 1.0);
    let found = reviewed(settled(), &bank([back]));
    assert_eq!(found.event.map(|it| it.kind), Some(EventKind::DeviceStepBack));
    assert_eq!(found.order, ModelOrder::Former);
}

#[test]
fn hypotheses_that_began_while_a_change_took_place_are_one() {
    let ramp_s = Tuning::USED.ramp_s;
    let begun_ns = NOW_NS - s(20.0);
    let first = reviewed(settled(), &bank([turned(hypothesis(Kind::Device, 2, begun_ns, 9.0, 0.0), 1.0)]));
    assert_eq!(first.id, 2);
    for (kind, since_s, id) in [
        (Kind::Device, 0.99 * ramp_s, 3),
        (Kind::Device, -0.99 * ramp_s, 3),
        (Kind::Device, 1.01 * ramp_s, 2),
        (Kind::Device, -1.01 * ramp_s, 2),
        (Kind::Former, 0.5 * ramp_s, 2),
    ] {
        // it is not shown, so that it is not taken for another reason
        let other = turned(hypothesis(kind, 3, begun_ns + s(since_s), 9.0, 0.0), 0.01);
        let found = reviewed(first, &bank([other]));
        assert_eq!(found.id, id, "{kind:?}, {since_s} s");
        assert_eq!(found.event, first.event);
    }
}

#[test]
fn what_follows_a_change_within_two_seconds_is_the_same_change() {
    let change_s = Tuning::USED.change_s;
    let begun_ns = NOW_NS - s(20.0);
    let first = reviewed(settled(), &bank([turned(hypothesis(Kind::Device, 2, begun_ns, 9.0, 0.0), 1.0)]));
    for (since_s, is_told) in [(0.99 * change_s, false), (1.01 * change_s, true)] {
        let next_ns = begun_ns + s(since_s);
        // the other way, or it would go on with it
        let next = turned(hypothesis(Kind::Device, 3, next_ns, -40.0, 0.0), 1.0);
        let found = reviewed(first, &bank([next]));
        assert_eq!(found.id, 3);
        assert_eq!(found.event.unwrap().since_ns, if is_told { next_ns } else { begun_ns }, "{since_s} s");
    }
}

/// While a magnet slides nothing is told but that something goes on; where it has come to rest it is one change, and so is what follows within 5 s,
/// whichever way.
#[test]
fn a_slide_is_told_once_and_not_before_it_rests() {
    let onset_ns = NOW_NS - s(20.0);
    let at = |hard_iron: HardIron, id: u32, onset_ns: i64, b_ut: f64| {
        let mut it = turned(hypothesis(Kind::Device, id, onset_ns, b_ut, 9.0), 1.0);
        it.hard_iron = hard_iron;
        bank([it])
    };
    let review = |mut decision: Decision, bank: &Bank, ago_s: f64| {
        decision.review(bank, NOW_NS - s(ago_s), UNIT_UT, &Tuning::USED);
        decision
    };
    let sliding = review(settled(), &at(HardIron::Slides, 2, onset_ns, 60.0), 10.0);
    assert_eq!((sliding.id, sliding.event, sliding.suspected_ns), (1, None, Some(onset_ns)));
    let rested = review(sliding, &at(HardIron::Rests, 2, onset_ns, 60.0), 9.0);
    let told = Event { kind: EventKind::DeviceStep, since_ns: onset_ns, decided_ns: NOW_NS - s(9.0) };
    assert_eq!((rested.id, rested.event), (2, Some(told)));
    // a change the other way, five seconds after it was told, or after a magnet slid on
    for (slid_ago_s, is_told) in [(None, true), (Some(4.1), false), (Some(3.9), true)] {
        let slid =
            slid_ago_s.map_or(rested, |ago_s| review(rested, &at(HardIron::Slides, 3, NOW_NS - s(8.0), 70.0), ago_s));
        let next_ns = NOW_NS - s(3.5);
        let back = review(slid, &at(HardIron::Rests, 4, next_ns, 20.0), 0.0);
        assert_eq!(back.event.unwrap().since_ns, if is_told { next_ns } else { onset_ns }, "{slid_ago_s:?}");
    }
}

#[test]
fn hypotheses_of_later_onset_speak_for_a_change_and_those_in_force_do_not() {
    let onset_ns = NOW_NS - s(10.0);
    let new = || turned(hypothesis(Kind::Device, 2, onset_ns, 9.0, 0.0), 1.0);
    let earlier_ns = onset_ns - s(2.0 * Tuning::USED.ramp_s);
    for (id, other_ns, is_told) in [(3, onset_ns + s(1.0), true), (1, onset_ns + s(1.0), false), (3, earlier_ns, false)]
    {
        let other = hypothesis(Kind::Device, id, other_ns, 9.0, -1.0);
        let found = reviewed(settled(), &bank([new(), other]));
        assert_eq!(found.event.is_some(), is_told, "{id}, {other_ns}");
    }
}

/// The place's field is stronger, or tilted, by more than half of what another place usually has, and that is known to a quarter.
#[test]
fn another_place_is_told_once_it_is_off_known_sure_and_has_lasted() {
    let tuning = Tuning::USED;
    let (off, known) = (0.5 * tuning.place, (0.25 * tuning.place).powi(2));
    let at = |level: f64, tilted: f64, variances: [f64; 2], ago_s: f64, log: f64| {
        let mut it = hypothesis(Kind::Device, 1, 0, 0.0, log);
        (it.now.x[10], it.now.x[12]) = (level, tilted);
        (it.now.p[(10, 10)], it.now.p[(12, 12)]) = (variances[0], variances[1]);
        it.now.place_ns = Some(NOW_NS - s(ago_s));
        it
    };
    let usual = || hypothesis(Kind::Device, 1, 0, 0.0, 0.0);
    for (level, tilted, variances, ago_s, log, is_elsewhere, is_told) in [
        (1.01 * off, 0.0, [0.99 * known; 2], 3.0, 9.0, true, true),
        (-1.01 * off, 0.0, [0.99 * known; 2], 3.0, 9.0, true, true),
        (0.0, -1.01 * off, [0.99 * known; 2], 3.0, 9.0, true, true),
        (0.99 * off, 0.99 * off, [0.99 * known; 2], 3.0, 9.0, false, false),
        (1.01 * off, 0.0, [1.01 * known, 0.0], 3.0, 9.0, false, false),
        (1.01 * off, 0.0, [0.0, 1.01 * known], 3.0, 9.0, false, false),
        (1.01 * off, 0.0, [0.0; 2], 0.99 * tuning.change_s, 9.0, true, false),
        (1.01 * off, 0.0, [0.0; 2], 1.01 * tuning.change_s, 9.0, true, true),
        (1.01 * off, 0.0, [0.0; 2], 3.0, 98f64.ln(), true, false),
        (1.01 * off, 0.0, [0.0; 2], 3.0, 100f64.ln(), true, true),
        // after so long it is what is usual
        (1.01 * off, 0.0, [0.0; 2], 0.999 * tuning.new_place_s, 9.0, true, true),
        (1.01 * off, 0.0, [0.0; 2], 1.001 * tuning.new_place_s, 9.0, false, false),
    ] {
        let since_ns = NOW_NS - s(ago_s);
        let all = bank([at(level, tilted, variances, ago_s, log), usual()]);
        let found = reviewed(settled(), &all);
        let name = format!("{level}, {tilted}, {variances:?}, {ago_s} s, {log}");
        assert_eq!(found.elsewhere, is_elsewhere.then_some(since_ns), "{name}");
        let told = Event { kind: EventKind::PlaceChanged, since_ns, decided_ns: NOW_NS };
        assert_eq!(found.event, is_told.then_some(told), "{name}");
        // once
        let mut again = found;
        again.event = None;
        assert_eq!(reviewed(again, &all).event, None, "{name}");
    }
}

/// Stronger than any field of the Earth by more than a tenth of it.
#[test]
fn a_field_that_no_place_has_is_elsewhere_since_the_onset() {
    let told = 0.5 * Tuning::USED.place;
    let strongest_ut = crate::strength::EARTH_UT.end;
    for (share, is_elsewhere) in [(1.001 * told, true), (0.999 * told, false)] {
        let strength_ut = strongest_ut / (1.0 - share);
        let mut it = hypothesis(Kind::Cold, 1, 77, 0.0, 0.0);
        (0..3).for_each(|k| it.now.x[k] = UNIT_UT / strength_ut);
        assert_eq!(reviewed(settled(), &bank([it])).elsewhere, is_elsewhere.then_some(77), "{share}");
    }
}

#[test]
fn a_frame_that_is_no_noise_is_suspected_now() {
    let mut it = hypothesis(Kind::Device, 1, 0, 0.0, 0.0);
    it.now.odd = 1;
    assert_eq!(reviewed(settled(), &bank([it])).suspected_ns, Some(NOW_NS));
}

/// b at 0, then at 9 uT, then at another: when it began after the decision on the one before, where b is, and whether it is a change of its own.
#[test]
fn a_slide_is_told_once_and_a_change_the_other_way_is_another() {
    let step = |id, onset_ns, b_ut| turned(hypothesis(Kind::Device, id, onset_ns, b_ut, 9.0), 1.0);
    let begun_ns = NOW_NS - s(10.0);
    let first = reviewed(settled(), &bank([step(2, begun_ns, 9.0)]));
    for (after_s, b_ut, is_another) in [
        (0.99 * SETTLED_S, 18.0, false),
        (1.01 * SETTLED_S, 18.0, true),
        (0.99 * SETTLED_S, -9.0, true),
        // so soon after its beginning it is the same, whichever way
        (0.99 * Tuning::USED.change_s - 10.0, -9.0, false),
    ] {
        let onset_ns = NOW_NS + s(after_s);
        let mut then = first;
        then.review(&bank([step(3, onset_ns, b_ut)]), onset_ns + s(3.0), UNIT_UT, &Tuning::USED);
        let told = Event { kind: EventKind::DeviceStep, since_ns: onset_ns, decided_ns: onset_ns + s(3.0) };
        assert_eq!(then.event, if is_another { Some(told) } else { first.event }, "{after_s} s, {b_ut} uT");
        assert_eq!(then.id, 3);
    }
}
