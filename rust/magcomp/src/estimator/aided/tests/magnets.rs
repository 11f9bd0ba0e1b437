//! A magnet that is neared: what it taught is taken back, how long a change must hold, what is left in samples; and the delay.

use nalgebra::Vector3;

use super::super::bursts::Bursts;
use super::super::phase::Phase;
use super::super::propagate::ProcessNoise;
use super::super::quarantine::Quarantine;
use super::super::recent::Recent;
use super::super::state::{BIAS, FIELD, Filter, HARD_IRON};
use super::super::step::FrameStep;
use super::super::{Aided, Tuning};
use super::simulator::World;
use crate::reading::EventKind;

const DT_S: f64 = 0.01;
const NOISE: ProcessNoise = ProcessNoise { bridged_rad2: 1e-8, offset_ut: 0.3, local_ut: 1.0, local_time_s: 1.0 };

/// A turn by the gyroscope; what a quarantine does not look at is zero.
fn step(increment_rad: &Vector3<f64>) -> FrameStep {
    FrameStep { increment_rad: *increment_rad, noise: NOISE, ..FrameStep::of_nothing(DT_S) }
}

fn settled(seed: u64) -> (World, Aided) {
    let (mut world, mut aided) = (World::new(seed), Aided::new(Tuning::default(), None));
    run(&mut world, &mut aided, 2_000);
    (world, aided)
}

fn run(world: &mut World, aided: &mut Aided, samples: usize) {
    for _ in 0..samples {
        let sample = world.sample(DT_S);
        aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
    }
}

fn filter_of(aided: &Aided) -> &Filter {
    &aided.phase.running().expect("settled").filter
}

#[test]
fn a_copy_is_brought_to_now_as_a_filter_that_went_along() {
    let (mut world, aided) = settled(11);
    let mut along = filter_of(&aided).clone();
    let before_ut = along.part(FIELD);
    let (mut quarantine, tuning) = (Quarantine::default(), Tuning::default());
    quarantine.learned(&along, DT_S, &tuning);
    for k in 0..150 {
        let increment_rad = world.sample(DT_S).inertial.rotation.expect("a gyroscope").increment_rad;
        along.propagate(&increment_rad, DT_S, &NOISE);
        quarantine.turn(&step(&increment_rad));
        // two copies: the way goes on from the first to the second
        let is_due = k == 70;
        quarantine.learned(&Filter::default(), if is_due { 2.0 * tuning.quarantine_s } else { 0.0 }, &tuning);
    }
    let brought = quarantine.take_back(&NOISE).expect("a copy");
    let off_ut = (brought.part(FIELD) - along.part(FIELD)).norm();
    // the turn by bias and axes is taken to first order: 1.5 s of 0.03 rad/s and a share of 0.01 leave less than 1e-3 rad of 50 uT
    assert!(off_ut < 0.05, "{off_ut} uT");
    assert!((brought.part(FIELD) - before_ut).norm() > 5.0, "the device had turned");
    assert_eq!(brought.part(HARD_IRON), along.part(HARD_IRON));
    let off = (brought.covariance - along.covariance).norm() / along.covariance.norm();
    let grown = (along.covariance - filter_of(&aided).covariance).norm() / along.covariance.norm();
    assert!(off < 0.01 && grown > 0.1, "{off} of P, which grew by {grown}");
}

#[test]
fn the_older_copy_is_taken_and_once() {
    let (mut quarantine, tuning) = (Quarantine::default(), Tuning::default());
    let named = |name: f64| Filter { mean: nalgebra::SVector::repeat(name), ..Filter::default() };
    assert!(quarantine.take_back(&NOISE).is_none());
    for k in 0..250 {
        quarantine.learned(&named(f64::from(k) * DT_S), DT_S, &tuning);
    }
    // taken at 0, 1.0 and 2.0 s: the one before the last
    let taken = quarantine.take_back(&NOISE).expect("a copy").mean[HARD_IRON.start()];
    assert!((0.9..1.1).contains(&taken), "of {taken} s");
    assert!(quarantine.take_back(&NOISE).is_none());
}

/// A field that grows as a magnet's is neared: 0.5 uT at first, 30 uT after two seconds.
#[test]
fn a_magnet_that_is_neared_leads_the_filter_less_astray() {
    let error = |mechanism: &str| {
        let (mut bias_rad_s, mut b_ut) = (0.0, 0.0);
        for seed in 200..212 {
            let (mut world, mut aided) = settled(seed);
            aided.tuning.switch_off(mechanism);
            let earth_ut = world.field_ut;
            let magnet_ut = world.random.vector(1.0).normalize();
            for k in 0..250 {
                world.field_ut = earth_ut + magnet_ut * (0.5 * (f64::from(k) * DT_S * 2.05).exp()).min(30.0);
                run(&mut world, &mut aided, 1);
            }
            let filter = filter_of(&aided);
            bias_rad_s += (filter.part(BIAS) - world.gyro_bias).norm() / 12.0;
            b_ut += (filter.part(HARD_IRON) - world.hard_iron_ut).norm() / 12.0;
            assert!(matches!(aided.phase, Phase::Undecided(..) | Phase::Running(..)));
        }
        (bias_rad_s, b_ut)
    };
    let (with, without) = (error(""), error("quarantine"));
    assert!(with.0 < 0.8 * without.0 && with.1 < without.1, "{with:?}, without {without:?}");
}

#[test]
fn a_change_must_hold_the_longer_the_more_often_samples_misfit() {
    let tuning = Tuning::default();
    let mut bursts = Bursts::default();
    assert_eq!(bursts.hold_s(&tuning), 0.0);
    // one misfit a second for so long that what is forgotten is as much as what comes: T misfits in T seconds, over 2 T
    for _ in 0..400 {
        bursts.begin();
        (0..100).for_each(|_| bursts.pass(false, DT_S, &tuning));
    }
    let expected_s = tuning.hold_s * (1800.0 / tuning.device_rate_h).ln_1p();
    assert!((bursts.hold_s(&tuning) / expected_s - 1.0).abs() < 0.01, "{} s", bursts.hold_s(&tuning));
    // a change of the device is no misfit of the place
    let mut device = Bursts::default();
    device.begin();
    assert!(device.hold_s(&tuning) > 0.0);
    device.was_the_device();
    assert_eq!(device.hold_s(&tuning), 0.0);
}

#[test]
fn what_a_place_leaves_is_a_share_of_a_field_spread_within_the_gate() {
    let tuning = Tuning::default();
    let (mut bursts, mut device) = (Bursts::default(), Bursts::default());
    for k in 0..40_000 {
        for it in [&mut bursts, &mut device] {
            it.pass(k % 4 == 0, DT_S, &tuning);
        }
        if k % 50 == 0 {
            bursts.was_the_place();
            device.was_the_device();
        }
    }
    // a quarter of a ball of 8 uT: 64 / 5 an axis; at most the last half second is open
    let expected_ut2 = 0.25 * 64.0 / 5.0;
    assert!((bursts.left_ut2(&tuning) / expected_ut2 - 1.0).abs() < 0.03, "{} uT^2", bursts.left_ut2(&tuning));
    assert_eq!(device.left_ut2(&tuning), 0.0);
}

#[test]
fn the_mean_over_the_delay_is_the_integral_of_the_rate() {
    let mut recent = Recent::default();
    assert_eq!(recent.mean_rad_s(0.02), None);
    // rate = 3 t rad/s about x: the turn of a step is exact
    let turned = |to_s: f64| 1.5 * to_s * to_s;
    for k in 0..30 {
        let from_s = f64::from(k) * DT_S;
        let turn = Vector3::new(turned(from_s + DT_S) - turned(from_s), 0.0, 0.0);
        recent.add(&turn, DT_S, &Vector3::zeros(), false);
    }
    for delay_s in [0.01, 0.02, 0.05, 0.16] {
        let mean = recent.mean_rad_s(delay_s).expect("late").x;
        let expected = (turned(0.3) - turned(0.3 - delay_s)) / delay_s;
        assert!((mean - expected).abs() < 1e-12, "{delay_s} s: {mean}, {expected}");
    }
    // half a step is half of its turn; beyond what is known the mean is that of what is known
    let half = recent.mean_rad_s(0.015).expect("late").x * 0.015;
    assert!((half - (turned(0.3) - turned(0.29) + 0.5 * (turned(0.29) - turned(0.28)))).abs() < 1e-12);
    let [known, all] = [0.16, 1.0].map(|delay_s| recent.mean_rad_s(delay_s).expect("late").x);
    assert!((known - all).abs() < 1e-12);
    for early_s in [0.0, -0.01] {
        assert_eq!(recent.mean_rad_s(early_s), None);
    }
}

#[test]
fn a_sample_waits_for_the_gyroscope() {
    let mut recent = Recent::default();
    for k in 0..30 {
        recent.add(&Vector3::zeros(), DT_S, &Vector3::repeat(f64::from(k)), k == 24);
    }
    // no longer than half a sample more than it must, and no longer than samples are kept
    for (wait_s, sample) in [(-0.01, 29), (0.0, 29), (0.004, 29), (0.006, 28), (0.05, 24), (0.148, 14), (1.0, 14)] {
        let (waited, age_s) = recent.waited(wait_s);
        assert_eq!(waited.raw_ut, Vector3::repeat(f64::from(sample)), "{wait_s} s");
        assert!((age_s - DT_S * f64::from(29 - sample)).abs() < 1e-12, "{wait_s} s: {age_s}");
        assert_eq!(waited.is_blank, sample == 24);
    }
}

/// Magnets are passed every three seconds for a minute; b never changes.
#[test]
fn a_room_full_of_magnets_is_hardly_taken_for_a_change_of_the_device() {
    let (mut told, mut off_ut) = (0, 0.0_f64);
    for seed in 300..308 {
        let (mut world, mut aided) = settled(seed);
        let earth_ut = world.field_ut;
        for _ in 0..20 {
            let magnet_ut = world.random.vector(1.0).normalize() * (40.0 + 60.0 * world.random.uniform());
            let (nearest_s, lasts_s) = (0.8 + world.random.uniform(), 0.3 + 0.5 * world.random.uniform());
            for k in 0..300 {
                let along = (f64::from(k) * DT_S - nearest_s) / lasts_s;
                world.field_ut = earth_ut + magnet_ut / (1.0 + along * along).powf(1.5);
                let before = aided.changes.event;
                run(&mut world, &mut aided, 1);
                let is_new = aided.changes.event != before;
                told += i32::from(is_new && aided.changes.event.is_some_and(|it| it.kind != EventKind::PlaceChanged));
            }
        }
        off_ut = off_ut.max((filter_of(&aided).part(HARD_IRON) - world.hard_iron_ut).norm());
    }
    assert!(told <= 4 && off_ut < 5.0, "{told} device steps told in eight minutes, b off by {off_ut} uT");
}

/// A charger is plugged in while the phone lies; the gyroscope warms until it is taken up.
#[test]
fn a_step_at_rest_is_found_although_the_gyroscope_has_warmed_since() {
    for seed in 400..404 {
        let (mut world, mut aided) = settled(seed);
        world.tumbling_rad_s = 0.0;
        run(&mut world, &mut aided, 500);
        world.hard_iron_ut += Vector3::new(15.0, -12.0, 10.0);
        for _ in 0..60 {
            world.gyro_bias += Vector3::new(2e-4, -2e-4, 1e-4);
            run(&mut world, &mut aided, 100);
        }
        world.tumbling_rad_s = 1.0;
        run(&mut world, &mut aided, 400);
        let off_ut = (filter_of(&aided).part(HARD_IRON) - world.hard_iron_ut).norm();
        assert!(
            aided.changes.event.is_some_and(|it| it.kind == EventKind::DeviceStep),
            "seed {seed}: {:?}",
            aided.changes.event
        );
        assert!(off_ut < 3.0, "seed {seed}: {off_ut} uT off");
    }
}
