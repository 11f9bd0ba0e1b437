use super::super::parameters::{TauMatrix, tau_of};
use super::*;
use nalgebra::Matrix3;

const UNIT_UT: f64 = 45.0;
const ONSET_NS: i64 = 5_000_000_000;

fn known() -> Gaussian {
    Gaussian {
        mean: tau_of(&Matrix3::identity(), &Vector3::new(0.1, 0.2, -0.3)),
        covariance: TauMatrix::from_diagonal_element(1e-4),
    }
}

/// A large change, seen first at the onset: before it the field was along x, and turned by half a unit a second.
fn changed(takes_time: bool) -> Filter {
    let known = known();
    let mut base = State::new(&known, 0.0, 0.0);
    base.widen(2.0, 0.05);
    let mut filter = Filter::new(Kind::Device, base, known.mean, 0, ONSET_NS);
    filter.takes_time = takes_time;
    let from = Vector3::new(1.1, 0.2, -0.3);
    filter.leap = Some(Leap { known, from, from_ns: ONSET_NS - 80_000_000, turning: 0.5, step: 2.0 });
    filter
}

fn frame(since_onset_ns: i64, u: Vector3<f64>) -> Frame {
    Frame { time_ns: ONSET_NS + since_onset_ns, u, white: 1e-4, count: 8.0, seconds: 0.08, ..Frame::default() }
}

/// By hand: b moves by what the field did; it is unsure by the turn of 0.08 s, two frames' noise, and M, which changes with b, by 0.3 % for each uT, at most
/// as with the largest step, 90 uT here.
#[test]
fn after_a_large_change_b_is_what_the_field_changed_by() {
    let mut filter = changed(false);
    let log = filter.base.log;
    let by = Vector3::new(2.0, -1.0, 0.5);
    filter.add(&frame(0, Vector3::new(1.1, 0.2, -0.3) + by), &Tuning::USED, UNIT_UT);
    let (mean, p) = (filter.base.tau(), &filter.base.p);
    assert!((mean.fixed_rows::<3>(6) - (Vector3::new(0.1, 0.2, -0.3) + by)).norm() < 1e-12);
    let iron: f64 = 0.003 * 90.0;
    let variance = 0.04 * 0.04 + iron * iron + 2e-4;
    assert!((p[(6, 6)] - 1e-4 - variance).abs() < 1e-12, "{}", p[(6, 6)]);
    assert!((p[(0, 0)] - 1e-4 - iron * iron).abs() < 1e-12, "{}", p[(0, 0)]);
    assert!((p[(3, 3)] - 1e-4 - 0.5 * iron * iron).abs() < 1e-12, "{}", p[(3, 3)]);
    // all three numbers of b are told
    assert!((filter.base.log - log - 1.5 * (variance / 4.0).ln()).abs() < 1e-12, "{}", filter.base.log);
    assert!(filter.leap.is_none());
}

/// A change by 5 uT changes M by 1.5 %.
#[test]
fn m_changes_with_b() {
    let mut filter = changed(false);
    filter.add(&frame(0, Vector3::new(1.1 + 5.0 / UNIT_UT, 0.2, -0.3)), &Tuning::USED, UNIT_UT);
    assert!((filter.base.p[(0, 0)] - 1e-4 - 0.015 * 0.015).abs() < 1e-12, "{}", filter.base.p[(0, 0)]);
}

#[test]
fn a_change_that_takes_time_is_told_by_the_frame_after_it() {
    let mut filter = changed(true);
    filter.add(&frame(200_000_000, Vector3::new(9.0, 9.0, 9.0)), &Tuning::USED, UNIT_UT);
    assert!(filter.leap.is_some() && filter.base.tau() == known().mean);
    filter.add(&frame(320_000_000, Vector3::new(3.1, 0.2, -0.3)), &Tuning::USED, UNIT_UT);
    assert!((filter.base.tau()[6] - 2.1).abs() < 1e-12, "{}", filter.base.tau()[6]);
    // the turn of 0.4 s
    assert!(
        (filter.base.p[(7, 7)] - 1e-4 - (0.2 * 0.2 + 0.27 * 0.27 + 2e-4)).abs() < 1e-12,
        "{}",
        filter.base.p[(7, 7)]
    );
}

#[test]
fn a_fast_turn_tells_nothing_of_a_change() {
    let mut filter = changed(false);
    filter.leap.as_mut().unwrap().turning = 30.0;
    let before = filter.base.clone();
    filter.add(&frame(0, Vector3::new(3.1, 0.2, -0.3)), &Tuning::USED, UNIT_UT);
    assert_eq!(filter.base, before);
}

/// Else those that wait would be thrown away as twins of those that do not: all of them are at the old b still.
#[test]
fn a_hypothesis_that_waits_is_no_twin_of_one_that_does_not() {
    let (waits, mut other) = (changed(true), changed(true));
    assert!(waits.makes_needless(&other, 1));
    other.leap = None;
    assert!(!waits.makes_needless(&other, 1) && !other.makes_needless(&waits, 1));
}

/// The field's end circles a b that moves along x; no point in the past fits it.
#[test]
fn a_hypothesis_whose_b_moves_goes_on_about_where_it_is() {
    let rates = Tuning::USED.rates(UNIT_UT);
    let rests = Filter::new(Kind::Device, State::new(&known(), 0.0, 0.0), known().mean, 0, ONSET_NS);
    let mut moves = rests.fork(Some(rates), 0, -7.0);
    assert!(moves.moves && !moves.fork(None, 0, -7.0).moves && moves.log_joint() == -7.0);
    assert_eq!(moves.now.rate, Rate::new(rates));
    assert_eq!(rests.now.rate, Rate::default());

    let mut frames = Frames::new();
    for k in 0..100 {
        let (sin, cos) = (0.4 * f64::from(k)).sin_cos();
        let along = 0.3 * (0.13 * f64::from(k)).sin();
        let circle = Vector3::new(sin * (1.0 - along * along).sqrt(), cos * (1.0 - along * along).sqrt(), along);
        let b = Vector3::new(0.1 + 0.002 * f64::from(k), 0.2, -0.3);
        let frame = frame(i64::from(k) * 80_000_000, b + circle);
        frames.push(frame);
        moves.add(&frame, &Tuning::USED, UNIT_UT);
        if moves.wants_run() {
            let now = moves.now.clone();
            assert_eq!(moves.run(&frames, &Tuning::USED, UNIT_UT), 1);
            assert_eq!((&moves.start(), &moves.now, moves.first, moves.off()), (&now, &now, frames.next, Tau::zeros()));
        }
    }
    let off = moves.now.tau().fixed_rows::<3>(6) - Vector3::new(0.298, 0.2, -0.3);
    assert!(off.norm() < 0.02, "{off}");
    // 0.002 in 0.08 s
    assert!((moves.now.rate.mean - Vector3::new(0.025, 0.0, 0.0)).norm() < 0.01, "{}", moves.now.rate.mean);
}
