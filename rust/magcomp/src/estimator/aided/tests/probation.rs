//! A change of the device is in force at once, told once it has held, and taken back where samples stop fitting it.

use nalgebra::Vector3;

use super::super::events::Began;
use super::super::phase::Phase;
use super::super::propagate::ProcessNoise;
use super::super::state::Filter;
use super::super::{Aided, Tuning};
use super::simulator::World;
use crate::calibration::Given;
use crate::reading::{Event, EventKind};

const MAGNET_UT: Vector3<f64> = Vector3::new(20.0, -15.0, 10.0);

fn settled(seed: u64) -> (World, Aided) {
    let (mut world, mut aided) = (World::new(seed), Aided::new(Tuning::default(), None));
    run(&mut world, &mut aided, 2_500);
    (world, aided)
}

/// The events that were told.
fn run(world: &mut World, aided: &mut Aided, samples: usize) -> Vec<Event> {
    let mut told = Vec::new();
    for _ in 0..samples {
        let (before, sample) = (aided.changes.event, world.sample(0.01));
        aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
        told.extend(aided.changes.event.filter(|_| aided.changes.event != before));
    }
    told
}

/// A magnet is put on; until that is on probation.
fn on_probation(seed: u64) -> (World, Aided) {
    let (mut world, mut aided) = settled(seed);
    world.hard_iron_ut += MAGNET_UT;
    for _ in 0..300 {
        assert_eq!(run(&mut world, &mut aided, 1), []);
        if aided.changes.probation.is_some() {
            return (world, aided);
        }
    }
    panic!("seed {seed}: never on probation");
}

/// The filter that a misfit would go back to.
fn copy(aided: &Aided) -> Option<Filter> {
    let noise = ProcessNoise { bridged_rad2: 0.0, offset_ut: 0.0, local_ut: 0.0, local_time_s: 1.0 };
    if let Phase::Running(_, quarantine) = &aided.phase { quarantine.clone().take_back(&noise) } else { None }
}

fn off_ut(world: &World, aided: &Aided) -> f64 {
    (aided.calibration().unwrap().hard_iron_ut() - world.hard_iron_ut).norm()
}

#[test]
fn what_holds_is_told_after_its_time_in_motion_and_in_force_before() {
    for seed in 70..74 {
        let (mut world, mut aided) = on_probation(seed);
        assert!(off_ut(&world, &aided) < 6.0, "{seed}: {}", off_ut(&world, &aided));
        // a second and a half, by frames of four samples
        assert_eq!(run(&mut world, &mut aided, 145), [], "{seed}");
        let told = run(&mut world, &mut aided, 15);
        assert_eq!(told.iter().map(|it| it.kind).collect::<Vec<_>>(), [EventKind::DeviceStep], "{seed}");
        assert!(aided.changes.probation.is_none() && aided.changes.former.is_some(), "{seed}");
    }
}

#[test]
fn what_stops_fitting_meanwhile_is_taken_back_and_never_told() {
    for seed in 70..74 {
        let (mut world, mut aided) = on_probation(seed);
        // long enough for a copy of the filter that is refuted to be kept
        assert_eq!(run(&mut world, &mut aided, 110), [], "{seed}");
        assert!(aided.changes.probation.is_some() && copy(&aided).is_some(), "{seed}");
        world.hard_iron_ut -= MAGNET_UT;
        while aided.changes.probation.is_some() {
            assert_eq!(run(&mut world, &mut aided, 1), [], "{seed}");
        }
        // the place's field alone was another, and is gone: nothing of the refuted filter may come back
        assert!(aided.phase.trial().is_some() && copy(&aided).is_none(), "{seed}");
        assert_eq!(run(&mut world, &mut aided, 600), [], "{seed}");
        assert!(aided.changes.former.is_none(), "{seed}");
        assert!(off_ut(&world, &aided) < 1.5, "{seed}: {}", off_ut(&world, &aided));
    }
}

#[test]
fn rest_proves_nothing() {
    let (mut world, mut aided) = on_probation(71);
    world.tumbling_rad_s = 0.0;
    assert_eq!(run(&mut world, &mut aided, 500), []);
    assert!(aided.changes.probation.is_some());
}

#[test]
fn a_chain_of_turns_that_breaks_ends_it() {
    let (mut world, mut aided) = on_probation(72);
    break_chain(&mut world, &mut aided);
    assert_eq!(aided.changes.event.map(|it| it.kind), Some(EventKind::DeviceStep));
    assert!(aided.changes.probation.is_none());
}

/// A calibration from elsewhere comes meanwhile: the filter as it was is nothing to go back to afterwards.
#[test]
fn a_calibration_that_is_given_ends_it() {
    let (mut world, mut aided) = on_probation(73);
    let given = Given { calibration: aided.calibration().unwrap(), covariance: aided.covariance().unwrap() };
    aided.begin_from(&given);
    assert_eq!(aided.changes.event.map(|it| it.kind), Some(EventKind::DeviceStep));
    assert!(aided.changes.probation.is_none());
    assert_eq!(run(&mut world, &mut aided, 1_000), []);
    assert!(off_ut(&world, &aided) < 2.0, "{}", off_ut(&world, &aided));
}

/// A filter that is no number begins anew, and nothing of before comes back.
#[test]
fn a_filter_that_is_not_finite_ends_it() {
    let (mut world, mut aided) = on_probation(70);
    // in the middle of a frame
    while !aided.frame.is_empty() {
        run(&mut world, &mut aided, 1);
    }
    run(&mut world, &mut aided, 1);
    aided.phase.running_mut().unwrap().filter.mean[0] = f64::NAN;
    run(&mut world, &mut aided, 1);
    assert!(aided.changes.probation.is_none() && aided.phase.running().is_none());
    assert!(aided.frame.is_empty() && aided.covariances.is_none(), "a start has no frame of before");
    run(&mut world, &mut aided, 1_500);
    assert!(off_ut(&world, &aided) < 2.0, "{}", off_ut(&world, &aided));
}

/// 60 uT over four seconds; and off again at once, the other way.
#[test]
fn a_slide_is_told_once_and_its_end_is_another_change() {
    for seed in 70..74 {
        let (mut world, mut aided) = settled(seed);
        let slid_ut = MAGNET_UT.normalize() * 60.0;
        let mut told = Vec::new();
        for _ in 0..400 {
            world.hard_iron_ut += slid_ut / 400.0;
            told.extend(run(&mut world, &mut aided, 1));
        }
        told.extend(run(&mut world, &mut aided, 1_000));
        assert_eq!(told.len(), 1, "{seed}: {told:?}");
        assert!(off_ut(&world, &aided) < 2.0, "{seed}: {}", off_ut(&world, &aided));
        world.hard_iron_ut -= slid_ut;
        assert_eq!(run(&mut world, &mut aided, 800).len(), 1, "{seed}");
    }
}

/// The sensors pause: the turn alone was unknown, so no change has to hold for longer afterwards.
#[test]
fn a_pause_is_no_burst() {
    for seed in 70..74 {
        let (mut world, mut aided) = settled(seed);
        assert_eq!(aided.changes.bursts.hold_s(&aided.tuning), 0.0, "{seed}");
        break_chain(&mut world, &mut aided);
        run(&mut world, &mut aided, 1);
        assert!(aided.phase.trial().is_some_and(|it| it.began == Began::Pause), "{seed}");
        run(&mut world, &mut aided, 500);
        assert!(aided.phase.trial().is_none(), "{seed}");
        assert_eq!(aided.changes.bursts.hold_s(&aided.tuning), 0.0, "{seed}");
    }
}

/// The first samples after a pause say nothing of the field: both hypotheses are tried by the first that does.
#[test]
fn blank_samples_after_a_pause_tell_no_direction() {
    let (mut world, mut aided) = settled(74);
    break_chain(&mut world, &mut aided);
    for _ in 0..5 {
        let sample = world.sample(0.01);
        aided.carry(sample.time_ns, &sample.inertial);
        assert!(aided.phase.trial().is_none() && aided.phase.lost_strength_ut().is_some());
    }
    run(&mut world, &mut aided, 1);
    assert!(aided.phase.trial().is_some_and(|it| it.began == Began::Pause) && aided.phase.lost_strength_ut().is_none());
}

fn break_chain(world: &mut World, aided: &mut Aided) {
    let mut sample = world.sample(0.01);
    sample.inertial.rotation = None;
    aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
}

/// Magnet after magnet before the first is decided, so that the hypotheses begin anew: what does not fit now is not yet the place's doing.
#[test]
fn a_misfit_that_begins_anew_is_open() {
    for seed in 70..74 {
        let (mut world, mut aided) = settled(seed);
        for k in 0..600 {
            if k % 20 == 0 && k < 100 {
                world.hard_iron_ut += MAGNET_UT;
            }
            run(&mut world, &mut aided, 1);
            let bursts = aided.changes.bursts;
            let mut of_device = bursts;
            of_device.was_the_device();
            let is_compared = aided.phase.trial().is_some_and(|it| !it.is_place());
            let [ours, others] = [bursts, of_device].map(|it| it.hold_s(&aided.tuning));
            assert!(!is_compared || others < ours, "{seed}: {others} {ours} s");
        }
        assert!(aided.phase.trial().is_none() && off_ut(&world, &aided) < 2.0, "{seed}");
    }
}
