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
    filter.former = Some(known);
    filter.leap = Some(Leap { noise: None, from, from_ns: ONSET_NS - 80_000_000, turning: 0.5, step: 2.0 });
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

/// What a slide has moved b by counts as long as it slides, and no longer.
#[test]
fn a_slide_may_be_a_place_until_b_rests() {
    let mut filter = Filter::new(Kind::Device, State::new(&known(), 0.0, 0.0), known().mean, 0, ONSET_NS);
    filter.former = Some(known());
    filter.now.x[7] += 0.5;
    for (hard_iron, by) in [(HardIron::Rests, 0.0), (HardIron::Drifts, 0.0), (HardIron::Slides, 0.5)] {
        filter.hard_iron = hard_iron;
        assert!((filter.slid() - Vector3::new(0.0, by, 0.0)).norm() < 1e-12, "{hard_iron:?}");
    }
}

/// The field's end circles a b that moves along x; no point in the past fits it.
#[test]
fn a_hypothesis_whose_b_moves_goes_on_about_where_it_is() {
    let rates = HardIron::Drifts.rates(&Tuning::USED, UNIT_UT).unwrap();
    let rests = Filter::new(Kind::Device, State::new(&known(), 0.0, 0.0), known().mean, 0, ONSET_NS);
    let fork = |it: &Filter, hard_iron| it.fork(hard_iron, 0, -7.0, &Tuning::USED, UNIT_UT);
    let mut moves = fork(&rests, HardIron::Drifts);
    assert_eq!(
        (moves.hard_iron, fork(&moves, HardIron::Rests).hard_iron, moves.log_joint()),
        (HardIron::Drifts, HardIron::Rests, -7.0)
    );
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

/// Two are one if they say the same kind of change of the same parent, and their ages are within a factor of two.
#[test]
fn onsets_are_kept_on_a_grid_that_doubles_with_their_age() {
    let at = |begun: u64, id: u32| {
        let mut it = Filter::new(Kind::Device, State::new(&known(), 0.0, 0.0), known().mean, begun, ONSET_NS);
        it.id = id;
        it
    };
    let latest = 100;
    for (ages, is_needless) in
        [((10, 19), true), ((10, 20), false), ((19, 10), true), ((20, 10), false), ((7, 7), true)]
    {
        let (one, other) = (at(latest - ages.0, 1), at(latest - ages.1, 2));
        assert_eq!(one.makes_needless(&other, latest), is_needless, "{ages:?}");
    }
    let one = at(90, 1);
    let others: [fn(&mut Filter); 5] = [
        |it| it.kind = Kind::Place,
        |it| it.size = Size::Usual,
        |it| it.parent = 5,
        |it| it.hard_iron = HardIron::Drifts,
        |it| it.kind = Kind::Cold,
    ];
    for change in others {
        let mut other = at(90, 2);
        change(&mut other);
        assert!(!one.makes_needless(&other, latest));
    }
    // two cold starts are two
    let [mut one, mut other] = [at(90, 1), at(90, 2)];
    (one.kind, other.kind) = (Kind::Cold, Kind::Cold);
    assert!(!one.makes_needless(&other, latest));
    // those of one beginning are one in one place
    for (off, is_twin) in [(0.99 * NEAR, true), (1.01 * NEAR, false)] {
        let mut other = at(10, 1);
        other.now.x[8] += off;
        assert_eq!(at(90, 1).makes_needless(&other, latest), is_twin, "{off}");
    }
}

/// Four directions at 30 degrees about z: their mean is cos 30 long.
#[test]
fn how_far_directions_turned_is_what_their_mean_lacks() {
    let mut filter = Filter::new(Kind::Device, State::new(&known(), 0.0, 0.0), known().mean, 0, ONSET_NS);
    assert_eq!(filter.turned(), 1.0);
    let (sin, cos) = (30f64.to_radians().sin(), 30f64.to_radians().cos());
    for (k, (x, y)) in [(sin, 0.0), (-sin, 0.0), (0.0, sin), (0.0, -sin)].into_iter().enumerate() {
        let u = Vector3::new(0.1, 0.2, -0.3) + Vector3::new(x, y, cos);
        filter.add(&frame(80_000_000 * k as i64, u), &Tuning::USED, UNIT_UT);
        assert_eq!(filter.age, 8.0 * (k + 1) as f64);
    }
    assert!((filter.turned() - sin * sin).abs() < 1e-12, "{}", filter.turned());
    for (shown_rad2, is_shown) in [(0.249, true), (0.251, false)] {
        let tuning = Tuning { shown_rad2, ..Tuning::USED };
        assert_eq!(filter.is_shown(&tuning), is_shown);
        let place = Filter { kind: Kind::Place, ..filter.clone() };
        assert!(place.is_shown(&tuning));
    }
}

#[test]
fn a_point_is_as_likely_beforehand_as_its_distance_and_its_scale_say() {
    let mut filter = Filter::new(Kind::Cold, State::new(&known(), 0.0, 0.0), known().mean, 0, ONSET_NS);
    let mut tau = known().mean;
    (tau[0], tau[3], tau[7]) = (tau[0] + 0.03, tau[3] - 0.01, tau[7] + 0.02);
    let by_distance = -0.5 * (0.03 * 0.03 + 0.01 * 0.01 + 0.02 * 0.02) / 1e-4;
    assert!((filter.log_prior(&tau) - by_distance).abs() < 1e-9);
    filter.scale_sd = Some(0.2);
    let by_scale = -0.5 * (1.01f64.ln() / 0.2).powi(2);
    assert!((filter.log_prior(&tau) - by_distance - by_scale).abs() < 1e-9);
}

/// A mean that is off `lin` by more than two steps costs what it would have to move; and a field that the Earth has nowhere costs too.
#[test]
fn what_a_hypothesis_costs_where_it_is() {
    let mut filter = Filter::new(Kind::Device, State::new(&known(), 0.0, 0.0), known().mean, 0, ONSET_NS);
    let of = |filter: &mut Filter| {
        filter.penalize(&Tuning::USED, UNIT_UT);
        (filter.penalty, filter.now.log - filter.log_joint())
    };
    assert_eq!(of(&mut filter), (0.0, 0.0));
    for (off, cost) in [(1.99 * NEAR, 0.0), (2.01 * NEAR, 0.5 * (2.01 * NEAR).powi(2) / 1e-4)] {
        let mut moved = filter.clone();
        moved.now.x[6] += off;
        // the last number, the vertical part, is free
        moved.now.x[9] += 0.5;
        let (gain, log) = of(&mut moved);
        assert!((gain - cost).abs() < 1e-9 && (log - cost).abs() < 1e-9, "{off}: {gain}");
    }
    // 90 uT
    let t = 0.5;
    let mean = tau_of(&Matrix3::from_diagonal_element(t), &Vector3::zeros());
    let known = Gaussian { mean, ..known() };
    let mut strong = Filter::new(Kind::Device, State::new(&known, 0.0, 0.0), mean, 0, ONSET_NS);
    let beyond = 1.0 - crate::strength::EARTH_UT.end / (UNIT_UT / t);
    assert!((of(&mut strong).0 - 0.5 * (beyond / Tuning::USED.soft_iron).powi(2)).abs() < 1e-9);
}
