//! Each mechanism can be switched off, and does nothing then.

use nalgebra::Vector3;

use super::super::earth::Earth;
use super::super::phase::Phase;
use super::super::quarantine::Quarantine;
use super::super::running::Running;
use super::super::state::{AXES, DELAY, Filter, HARD_IRON, LOCAL};
use super::super::{Aided, Tuning};
use super::simulator::World;
use crate::reading::{EventKind, Status};
use crate::tuning::Mechanism;

/// What is for places that change, magnets, steps, poor starts and other sensors does nothing where nothing happens.
const QUIET: [&str; 14] = [
    "recall",
    "new_place",
    "quarantine",
    "hold",
    "left",
    "followed",
    "probation",
    "follow",
    "local_gate",
    "ramp",
    "place_holds",
    "long_up",
    "plausible",
    "forget",
];

const MAGNET_UT: Vector3<f64> = Vector3::new(20.0, -15.0, 10.0);

/// The world and an estimator without one mechanism after 25 s; with all where the name is empty.
fn without(mechanism: &str) -> (World, Aided) {
    let mut tuning = Tuning::default();
    assert!(mechanism.is_empty() || tuning.switch_off(mechanism));
    let (mut world, mut aided) = (World::new(40), Aided::new(tuning, None));
    run(&mut world, &mut aided, 2_500);
    assert!(aided.phase.running().is_some(), "{mechanism}");
    (world, aided)
}

fn run(world: &mut World, aided: &mut Aided, samples: usize) {
    for _ in 0..samples {
        let sample = world.sample(0.01);
        aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
    }
}

#[test]
fn a_name_that_is_none_switches_nothing_off() {
    let mut tuning = Tuning::default();
    assert!(!tuning.switch_off("nonsense"));
    assert_eq!(tuning, Tuning::default());
}

/// Whatever is switched off, the state stays sound and b is found.
#[test]
fn every_mechanism_is_worth_something_and_none_is_all() {
    let (_, with_all) = without("");
    let mut same = Vec::new();
    for mechanism in Tuning::MECHANISMS {
        let (mut world, mut aided) = without(mechanism.name);
        if aided.phase.running().unwrap().filter == with_all.phase.running().unwrap().filter {
            same.push(mechanism.name);
        }
        run(&mut world, &mut aided, 500);
        let off_ut = (aided.calibration().unwrap().hard_iron_ut() - world.hard_iron_ut).norm();
        assert!(off_ut < 2.0, "{}: b off by {off_ut} uT", mechanism.name);
    }
    assert_eq!(same, QUIET);
}

#[test]
fn a_part_of_the_state_that_is_off_stays_where_it_is() {
    // as far as the least variances let it go: twenty of their standard deviations
    let nothing = 20.0 * 1e-6;
    let (_, aided) = without("gyroscope_axes");
    assert!(aided.phase.running().unwrap().filter.part(AXES).amax() < nothing);
    let (_, aided) = without("delay");
    assert!(aided.phase.running().unwrap().filter.part(DELAY).amax() < nothing);
    let (_, aided) = without("unevenness");
    assert!(aided.phase.running().unwrap().filter.part(LOCAL).amax() < 20.0 * 1e-4);
    assert_eq!((aided.adaptation.local_ut, aided.adaptation.floor_ut2(&aided.tuning)), (0.0, 0.0));
    let (_, aided) = without("");
    let filter = &aided.phase.running().unwrap().filter;
    // the world has no delay: that it was sought shows in what is known of it
    assert!(filter.part(AXES).amax() > nothing && filter.own(DELAY).x.sqrt() > nothing);
}

#[test]
fn a_hard_iron_that_does_not_walk_is_known_ever_better() {
    let spread_ut2 = |mechanism| {
        let (mut world, mut aided) = without(mechanism);
        world.tumbling_rad_s = 0.0;
        run(&mut world, &mut aided, 300);
        let before = aided.phase.running().unwrap().filter.variances(HARD_IRON).sum();
        run(&mut world, &mut aided, 1_000);
        aided.phase.running().unwrap().filter.variances(HARD_IRON).sum() - before
    };
    // at rest 0.08 uT/s^0.5 for 10 s, three axes; nothing at all
    assert!((spread_ut2("") / (3.0 * 0.08 * 0.08 * 10.0) - 1.0).abs() < 0.05);
    assert!(spread_ut2("hard_iron_walk") <= 0.0);
}

#[test]
fn without_recall_the_way_back_is_a_step_like_any_other() {
    for (mechanism, kind) in [("", EventKind::DeviceStepBack), ("recall", EventKind::DeviceStep)] {
        let (mut world, mut aided) = without(mechanism);
        world.hard_iron_ut += MAGNET_UT;
        run(&mut world, &mut aided, 1_500);
        assert_eq!(aided.changes.event.unwrap().kind, EventKind::DeviceStep);
        let first_ns = aided.changes.event.unwrap().since_ns;
        world.hard_iron_ut -= MAGNET_UT;
        run(&mut world, &mut aided, 800);
        let event = aided.changes.event.unwrap();
        assert!(event.kind == kind && event.since_ns > first_ns, "{mechanism}: {event:?}");
    }
}

#[test]
fn without_a_new_place_its_field_is_the_earths() {
    for (mechanism, is_carried) in [("", true), ("new_place", false)] {
        let (mut world, mut aided) = without(mechanism);
        world.field_ut += Vector3::new(14.0, -8.0, 12.0);
        run(&mut world, &mut aided, 3_600);
        assert_eq!(aided.phase.running().unwrap().earth.is_some(), is_carried, "{mechanism}");
    }
}

#[test]
fn noise_that_is_not_learned_is_that_of_the_start() {
    let (_, aided) = without("noise_learning");
    assert_eq!(aided.senses.white.sigma_ut(), Tuning::default().noise_start_ut);
}

/// A walk of two minutes with everything in it: an uneven place at the start and a cover put on meanwhile, a magnet passed every few seconds, another place
/// for a minute with a cover put on there, the way back, a car's acceleration. What comes out, each second.
fn eventful(tuning: Tuning) -> Vec<[f64; 3]> {
    let (mut world, mut aided) = (World::new(43), Aided::new(tuning, None));
    let (earth_ut, own_ut) = (world.field_ut, world.hard_iron_ut);
    let mut told = Vec::new();
    for k in 0..13_000 {
        let t = f64::from(k) * 0.01;
        let uneven_ut =
            Vector3::new((0.9 * t).sin(), (1.3 * t).cos(), (0.7 * t).sin()) * if t < 12.0 { 4.0 } else { 0.5 };
        let neared = (-(t.rem_euclid(4.0) - 2.0).powi(2) / 0.05).exp() * f64::from((30.0..50.0).contains(&t));
        let elsewhere = f64::from((55.0..100.0).contains(&t));
        world.field_ut = earth_ut + uneven_ut + MAGNET_UT * (3.0 * neared) + Vector3::new(14.0, -8.0, 12.0) * elsewhere;
        // one cover early, one in the other place, which comes off when it is left
        let covers = f64::from(t > 2.5) - f64::from(t > 18.0) + f64::from((70.0..100.0).contains(&t));
        world.hard_iron_ut = own_ut + MAGNET_UT * covers;
        world.tumbling_rad_s = if (104.0..110.0).contains(&t) { 0.0 } else { 1.0 };
        let mut sample = world.sample(0.01);
        if t > 110.0 {
            let speeds_up = Vector3::new(3.0, 0.0, 0.0) * (0.5 * t).sin();
            sample.inertial.up_m_s2 = sample.inertial.up_m_s2.map(|up| up + world.attitude.inverse() * speeds_up);
        }
        let (_, answer) = aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
        if k % 100 == 0 {
            let f = answer.filtered_field_ut.unwrap_or_default();
            let sigma = answer.filtered_covariance_ut2.map_or(0.0, |p| p.trace());
            let up = answer.up.unwrap_or_default();
            told.push([f.sum() + up.sum(), sigma, aided.changes.event.map_or(0.0, |event| event.decided_ns as f64)]);
            assert!(f.iter().all(|v| v.is_finite()) && sigma.is_finite(), "{t} s");
        }
    }
    told
}

/// A switch that changes nothing in all this wants a stream of its own.
#[test]
fn every_mechanism_is_at_work_in_an_eventful_walk() {
    let with_all = eventful(Tuning::default());
    let is_idle = |mechanism: &&Mechanism| {
        let mut tuning = Tuning::default();
        assert!(tuning.switch_off(mechanism.name));
        eventful(tuning) == with_all
    };
    let idle: Vec<_> = Tuning::MECHANISMS.iter().filter(is_idle).map(|it| it.name).collect();
    // seen elsewhere: below, in `steps`, in tests/host/aided.rs, in `starts`
    assert_eq!(idle, ["recall", "plausible"]);
}

/// Any of them off together, the answers stay finite.
#[test]
fn combinations_of_mechanisms_are_sound() {
    let mut random = super::simulator::Random(5);
    for _ in 0..12 {
        let mut tuning = Tuning::default();
        for mechanism in Tuning::MECHANISMS {
            if random.uniform() < 0.5 {
                tuning.switch_off(mechanism.name);
            }
        }
        assert_eq!(eventful(tuning).len(), 130);
    }
}

#[test]
fn a_place_is_disturbed_while_its_field_is_likelier_not_the_earths() {
    let mut aided = Aided::new(Tuning::default(), None);
    for (probability, is_disturbed) in [(0.51, true), (0.49, false)] {
        let mut earth = Earth::of(&Filter::default(), None, 7);
        earth.probability = probability;
        aided.phase = Phase::Running(Running { earth: Some(earth), ..Running::default() }, Quarantine::default());
        assert_eq!(aided.status() == Status::Disturbed { since_ns: 7 }, is_disturbed, "{probability}");
    }
}
