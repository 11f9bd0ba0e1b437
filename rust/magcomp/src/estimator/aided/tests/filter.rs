//! Consistency: the covariance stays positive definite, its size is right, nothing is learned at rest.

use std::collections::VecDeque;

use nalgebra::{SMatrix, Vector3};

use super::super::state::{DELAY, HARD_IRON, STATES};
use super::super::{Aided, Tuning};
use super::simulator::World;
use crate::reading::{HoldReason, Status};
use crate::sensing::pairing::PairedInertial;

fn assert_positive_definite(aided: &Aided, at: usize) {
    let Some(filter) = aided.phase.running().map(|it| &it.filter) else { return };
    // scaled to unit diagonal, so that units do not matter
    let p = &filter.covariance;
    let p = SMatrix::<f64, STATES, STATES>::from_fn(|i, j| p[(i, j)] / (p[(i, i)] * p[(j, j)]).sqrt());
    assert!(p.cholesky().is_some(), "not positive definite at sample {at}");
}

#[test]
fn covariance_stays_positive_definite_over_a_million_samples_with_gaps_and_rate_changes() {
    positive_definite_over(1_000_000);
}

/// Three to five minutes in release: `cargo test --release -- --ignored a_hundred_million`.
#[test]
#[ignore = "minutes"]
fn covariance_stays_positive_definite_over_a_hundred_million_samples() {
    positive_definite_over(100_000_000);
}

fn positive_definite_over(samples: usize) {
    let mut world = World::new(3);
    let mut aided = Aided::new(Tuning::default(), None);
    let rates = [0.01, 0.02, 0.0025, 0.1, 0.04, 0.005];
    for k in 0..samples {
        let mut dt_s = rates[(k / 5_000) % rates.len()] * (0.9 + 0.2 * world.random.uniform());
        world.tumbling_rad_s = [1.0, 0.0, 3.0, 0.2][(k / 20_000) % 4];
        if k % 7_777 == 0 {
            dt_s = 3.0;
        }
        if k % 100_000 == 50_000 {
            world.hard_iron_ut += Vector3::new(15.0, -20.0, 10.0);
        }
        let sample = world.sample(dt_s);
        let inertial = if k % 7_777 == 0 { PairedInertial::default() } else { sample.inertial };
        let (_, output) = aided.told(sample.time_ns, sample.raw_ut, &inertial);
        assert!(output.field_ut.is_none_or(|c| c.iter().all(|v| v.is_finite())));
        if k % 500 == 0 {
            assert_positive_definite(&aided, k);
        }
    }
}

/// b walks as the filter takes it to. The mean is over seeds, axes and time; a single run is correlated over many seconds.
#[test]
fn offset_errors_match_their_covariance() {
    let (mut sum, mut count) = (0.0, 0.0);
    for seed in 10..30 {
        let mut world = World::new(seed);
        // a place as even as this one
        let mut tuning = Tuning::default();
        assert!(tuning.set("local_least_ut", 0.05));
        let mut aided = Aided::new(tuning, None);
        for k in 0..3_000 {
            let walk_ut = Tuning::default().offset_walk_ut * 0.01_f64.sqrt();
            world.hard_iron_ut += world.random.vector(walk_ut);
            let sample = world.sample(0.01);
            aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
            if k >= 500 && k % 100 == 0 {
                let (Some(c), Some(p)) = (aided.calibration(), aided.covariance()) else { continue };
                let error = c.hard_iron_ut() - world.hard_iron_ut;
                for i in 0..3 {
                    sum += error[i] * error[i] / p[(i, i)];
                    count += 1.0;
                }
            }
        }
    }
    let nees: f64 = sum / count;
    assert!(count > 1_000.0 && (0.3..1.6).contains(&nees), "NEES per axis {nees:.2} over {count}");
}

#[test]
fn at_rest_nothing_is_learned_and_a_magnet_is_only_suspected() {
    let mut world = World::new(5);
    let mut aided = Aided::new(Tuning::default(), None);
    for _ in 0..2_000 {
        let sample = world.sample(0.01);
        aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
    }
    world.tumbling_rad_s = 0.0;
    let mut state = Status::Tracking;
    for _ in 0..300 {
        let sample = world.sample(0.01);
        state = aided.told(sample.time_ns, sample.raw_ut, &sample.inertial).0;
    }
    assert_eq!(state, Status::Held(HoldReason::AtRest));
    let before = aided.phase.running().unwrap().filter.part(HARD_IRON);
    world.hard_iron_ut += Vector3::new(80.0, -60.0, 40.0);
    let mut heading_moved = 0.0_f64;
    for _ in 0..1_000 {
        let sample = world.sample(0.01);
        let (status, output) = aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
        heading_moved = heading_moved.max(output.filtered_field_ut.unwrap().angle(&sample.field_ut).to_degrees());
        state = status;
    }
    assert!(matches!(state, Status::Suspect { .. }), "{state:?}");
    assert_eq!(before, aided.phase.running().unwrap().filter.part(HARD_IRON));
    assert!(heading_moved < 3.0, "carried field wrong by {heading_moved} deg");
}

/// A phone that lies there warms up: b walks on, and the sigmas of later headings know it.
/// What d has in common with other states fades by e a second. Below 1e-307 each number costs a processor a hundred times as much.
#[test]
fn twenty_minutes_at_rest_leave_no_number_that_is_too_small() {
    let (mut world, mut aided) = (World::new(5), Aided::new(Tuning::default(), None));
    for k in 0..120_000 {
        world.tumbling_rad_s = if k < 2_000 { world.tumbling_rad_s } else { 0.0 };
        let sample = world.sample(0.01);
        aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
    }
    let filter = &aided.phase.running().unwrap().filter;
    let small = |it: &&f64| **it != 0.0 && it.abs() < f64::MIN_POSITIVE;
    assert_eq!(filter.mean.iter().chain(filter.covariance.iter()).filter(small).count(), 0);
}

#[test]
fn at_rest_the_hard_iron_walks_on() {
    let mut world = World::new(6);
    let mut aided = Aided::new(Tuning::default(), None);
    let spread_ut2 = |world: &mut World, aided: &mut Aided, samples: usize| {
        for _ in 0..samples {
            let sample = world.sample(0.01);
            aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
        }
        aided.phase.running().unwrap().filter.variances(HARD_IRON).sum()
    };
    spread_ut2(&mut world, &mut aided, 2_000);
    world.tumbling_rad_s = 0.0;
    let lain_down_ut2 = spread_ut2(&mut world, &mut aided, 300);
    let grown_ut2 = spread_ut2(&mut world, &mut aided, 30_000) - lain_down_ut2;
    // 0.08 uT/sqrt s for 300 s, three axes
    assert!((5.0..6.5).contains(&grown_ut2), "{grown_ut2} uT^2");
}

/// Of the axes together: what they do not share is known less well, and trusted a little too much.
#[test]
fn the_scale_of_the_gyroscope_is_found() {
    let mut sum = 0.0;
    for seed in 60..70 {
        let mut world = World::new(seed);
        let mut aided = Aided::new(Tuning::default(), None);
        for _ in 0..3_000 {
            let mut sample = world.sample(0.01);
            if let Some(rotation) = &mut sample.inertial.rotation {
                rotation.increment_rad *= 1.01;
                rotation.rate_rad_s *= 1.01;
            }
            aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
        }
        let filter = &aided.phase.running().unwrap().filter;
        sum += filter.parts().axes.trace() / 3.0;
    }
    let mean: f64 = sum / 10.0;
    assert!((mean - 0.01 / 1.01).abs() < 0.003, "mean scale error found: {mean}");
}

#[test]
fn a_late_gyroscope_is_found_and_f_is_of_its_time() {
    for late in [1, 5, 10] {
        let mut world = World::new(23);
        let mut aided = Aided::new(Tuning::default(), None);
        let mut before = VecDeque::new();
        let mut squares_deg2 = 0.0;
        for k in 0..4_000 {
            // each rotation is stamped so many samples of 10 ms after its truth
            let sample = world.sample(0.01);
            before.push_back((sample.inertial, sample.field_ut));
            let (inertial, field_ut) =
                if before.len() > late { before.pop_front().expect("so many") } else { Default::default() };
            let (_, output) = aided.told(sample.time_ns, sample.raw_ut, &inertial);
            if k >= 3_000 {
                squares_deg2 += output.filtered_field_ut.unwrap().angle(&field_ut).to_degrees().powi(2);
            }
        }
        let (delay_s, late_s) = (aided.phase.running().unwrap().filter.part(DELAY).x, 0.01 * late as f64);
        assert!((delay_s + late_s).abs() < 0.004, "{late_s} s late: {delay_s} s");
        let rms_deg = (squares_deg2 / 1_000.0).sqrt();
        assert!((0.02..0.45).contains(&rms_deg), "{late_s} s late: {rms_deg} deg");
    }
}
