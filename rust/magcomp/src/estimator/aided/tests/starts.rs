//! Starts say no more than the motion shows: turned about one axis, with and without a wobble, from nothing and from a wrong
//! calibration; and ordinary motion is answered at once.

use nalgebra::Vector3;

use super::super::{Aided, Tuning};
use super::simulator::{Sample, World};
use crate::calibration::{Calibration, Given, independent};
use crate::estimator::answer::Answer;
use crate::reading::{Missing, Status};

/// Direction error of f and its standard deviation about the vertical, deg.
fn heading_error(output: &Answer, sample: &Sample) -> Option<(f64, f64)> {
    let (f, up) = (output.filtered_field_ut?, output.up?);
    let level = |v: &Vector3<f64>| v - up * up.dot(v);
    let across = up.cross(&level(&f)).normalize();
    let sigma = (across.dot(&(output.filtered_covariance_ut2.unwrap() * across))).sqrt() / level(&f).norm();
    Some((level(&f).angle(&level(&sample.field_ut)).to_degrees(), sigma.to_degrees()))
}

struct Run {
    first_s: Option<f64>,
    /// Samples with a heading, and of those off by more than two and three sigma.
    told: usize,
    beyond: [usize; 2],
    /// Largest error beyond three sigma, deg; and how many of these were said to be tracked.
    worst_deg: f64,
    tracked: usize,
    status: Status,
}

fn run(world: &mut World, aided: &mut Aided, seconds: f64) -> Run {
    let mut run = Run { first_s: None, told: 0, beyond: [0; 2], worst_deg: 0.0, tracked: 0, status: Status::Tracking };
    let begin_ns = world.time_ns;
    while ((world.time_ns - begin_ns) as f64) < seconds * 1e9 {
        let sample = world.sample(0.01);
        let (status, output) = aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
        run.status = status;
        let Some((error, sigma)) = heading_error(&output, &sample) else { continue };
        run.first_s.get_or_insert((world.time_ns - begin_ns) as f64 * 1e-9);
        run.told += 1;
        run.beyond[0] += usize::from(error > 2.0 * sigma);
        if error > 3.0 * sigma {
            run.beyond[1] += 1;
            run.worst_deg = run.worst_deg.max(error);
            run.tracked += usize::from(status == Status::Tracking);
        }
    }
    run
}

#[test]
fn one_axis_from_nothing_is_never_told_beyond_its_sigma() {
    for wobble_deg in [0.0, 0.1, 0.3, 0.6, 1.0] {
        // a run's errors go together: runs are counted
        let mut doubtful = 0;
        for seed in 0..12 {
            let mut world = World::new(100 + seed);
            world.axis = Some(world.random.vector(1.0).normalize());
            world.wobble_rad = f64::to_radians(wobble_deg);
            let mut aided = Aided::new(Tuning::default(), None);
            let run = run(&mut world, &mut aided, 40.0);
            doubtful += u32::from(run.beyond[0] * 10 > run.told);
            assert!(run.beyond[1] * 40 <= run.told, "{wobble_deg} deg, seed {seed}: {:?} of {}", run.beyond, run.told);
            assert!(run.worst_deg < 10.0, "{wobble_deg} deg, seed {seed}: off by {} deg", run.worst_deg);
            if wobble_deg == 0.0 {
                assert!(aided.phase.running().is_none(), "seed {seed}: {}", run.status);
                assert_eq!(run.status, Status::Collecting(Missing::Directions), "seed {seed}");
            }
        }
        assert!(doubtful <= 2, "{wobble_deg} deg: {doubtful} of 12 runs beyond two sigmas");
    }
}

/// Flat on a turntable the heading needs no more than the motion shows.
#[test]
fn a_turn_about_the_vertical_gives_a_heading_and_no_vertical_offset() {
    for seed in 0..12 {
        let mut world = World::new(200 + seed);
        world.attitude = nalgebra::Rotation3::new(Vector3::z() * seed as f64);
        world.axis = Some(Vector3::z());
        let mut aided = Aided::new(Tuning::default(), None);
        let run = run(&mut world, &mut aided, 40.0);
        assert!(run.first_s.is_some_and(|s| s < 8.0), "seed {seed}: {:?} s", run.first_s);
        assert!(run.worst_deg < 3.0, "seed {seed}: {} deg", run.worst_deg);
        let error = (aided.calibration().unwrap().hard_iron_ut() - world.hard_iron_ut).z;
        let sigma_ut = aided.covariance().unwrap()[(2, 2)].sqrt();
        assert!(error.abs() < 3.0 * sigma_ut && sigma_ut > 10.0, "seed {seed}: {error} uT, sigma {sigma_ut}");
    }
}

#[test]
fn tumbling_is_answered_soon_and_with_a_true_sigma() {
    let (mut beyond, mut told, mut slowest_s) = ([0; 2], 0, 0.0_f64);
    for seed in 0..24 {
        let mut world = World::new(300 + seed);
        // 1 deg/s and more of bias
        world.gyro_bias = world.random.vector(0.02);
        let mut aided = Aided::new(Tuning::default(), None);
        let run = run(&mut world, &mut aided, 5.0);
        beyond[0] += run.beyond[0];
        beyond[1] += run.beyond[1];
        told += run.told;
        slowest_s = slowest_s.max(run.first_s.unwrap_or(99.0));
    }
    assert!(slowest_s < 4.0, "{slowest_s} s");
    assert!(beyond[0] * 20 <= told && beyond[1] * 100 <= told, "{beyond:?} of {told}");
}

/// A stored calibration that no longer holds, on a device that turns about one axis.
#[test]
fn one_axis_with_a_wrong_calibration_is_not_tracked_beyond_its_sigma() {
    for (off_ut, seeds) in [(15.0, 400..406), (40.0, 406..412), (120.0, 412..418)] {
        let (mut beyond, mut told) = ([0; 2], 0);
        for seed in seeds {
            let mut world = World::new(seed);
            world.axis = Some(world.random.vector(1.0).normalize());
            let mut aided = Aided::new(Tuning::default(), None);
            let off = world.random.vector(1.0).normalize() * off_ut;
            let calibration = Calibration::new(world.soft_iron, world.hard_iron_ut + off, 50.0).unwrap();
            aided.begin_from(&Given { calibration, covariance: independent(100.0, 0.08 * 0.08) });
            let run = run(&mut world, &mut aided, 40.0);
            assert_eq!(run.tracked, 0, "{off_ut} uT, seed {seed}: {:?} of {}", run.beyond, run.told);
            beyond[0] += run.beyond[0];
            beyond[1] += run.beyond[1];
            told += run.told;
        }
        // what is off by twelve standard deviations is dropped as soon as the motion shows it; of four, along the axis, no
        // motion shows anything
        assert!(beyond[0] * 2 <= told && beyond[1] * 20 <= told, "{off_ut} uT: {beyond:?} of {told}");
    }
}

/// Walking through an uneven room, the start has an answer, and soon comes to an end.
#[test]
fn an_uneven_place_is_allowed_for() {
    for seed in 90..98 {
        let mut world = World::new(seed);
        let mut aided = Aided::new(Tuning::default(), None);
        let earth_ut = world.field_ut;
        let mut local_ut = Vector3::zeros();
        let (mut answered, mut ended_s) = (0, None);
        for k in 0..3_000 {
            local_ut = local_ut * 0.99 + world.random.vector(3.0 * (1.0_f64 - 0.99 * 0.99).sqrt());
            world.field_ut = earth_ut + local_ut;
            let sample = world.sample(0.01);
            let (status, output) = aided.told(sample.time_ns, sample.raw_ut, &sample.inertial);
            answered += i32::from(k >= 500 && output.filtered_field_ut.is_some());
            if !matches!(status, Status::Collecting(_)) {
                ended_s = ended_s.or(Some(f64::from(k) * 0.01));
            }
        }
        assert!(answered > 1_700, "{seed}: answered {answered} samples of 2500");
        assert!(ended_s.is_some_and(|ended_s| ended_s < 20.0), "{seed}: {ended_s:?}");
        let error_ut = (aided.calibration().unwrap().hard_iron_ut() - world.hard_iron_ut).norm();
        assert!(error_ut < 4.0, "{seed}: {error_ut} uT");
    }
}

/// A phone is put into a cover while its start is under way: the samples from before go, and the start ends soon after.
#[test]
fn a_device_that_changes_during_its_start_is_known_soon_after() {
    for seed in 300..306 {
        // slow turns show b late: the start is still under way when the cover is put on
        let mut world = World::new(seed);
        world.tumbling_rad_s = 0.15;
        let mut aided = Aided::new(Tuning::default(), None);
        let before = run(&mut world, &mut aided, 3.0);
        assert!(matches!(before.status, Status::Collecting(_)), "seed {seed}: {:?}", before.status);
        world.hard_iron_ut += Vector3::new(-18.0, 22.0, 9.0);
        let after = run(&mut world, &mut aided, 12.0);
        let off_ut = (aided.calibration().unwrap().hard_iron_ut() - world.hard_iron_ut).norm();
        assert!(after.beyond[1] == 0 && off_ut < 8.0, "seed {seed}: {} beyond, {off_ut} uT off", after.beyond[1]);
    }
}
