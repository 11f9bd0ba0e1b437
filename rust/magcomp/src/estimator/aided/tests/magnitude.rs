//! Without a gyroscope: the gradients, and what the dip adds to the magnitude.

use nalgebra::{Rotation3, Vector3};

use super::super::magnitude::Magnitude;
use super::simulator::{Random, World};

const SIGMA_UT: f64 = 0.5;

/// A magnitude filter that has seen `samples` even orientations, with or without gravity.
fn begun(world: &mut World, samples: usize, with_dip: bool) -> Magnitude {
    let mut magnitude = Magnitude::new();
    for _ in 0..samples {
        world.attitude = Rotation3::new(world.random.vector(2.0));
        push(world, &mut magnitude, with_dip);
    }
    assert!(magnitude.started);
    magnitude
}

fn push(world: &mut World, magnitude: &mut Magnitude, with_dip: bool) {
    let sample = world.sample(0.01);
    let up_g = sample.inertial.up_m_s2.map(|up| up / 9.806_65).filter(|_| with_dip);
    magnitude.push(sample.time_ns, &sample.raw_ut, up_g.as_ref(), SIGMA_UT);
}

#[test]
fn gradients_are_those_of_finite_differences() {
    let mut random = Random(3);
    for seed in 0..20 {
        let mut world = World::new(seed);
        let magnitude = begun(&mut world, 200, true);
        let (raw, y) = (world.sample(0.01).raw_ut, random.vector(1.0).normalize());
        let at = |magnitude: &Magnitude| {
            let w = magnitude.soft_iron().try_inverse().unwrap();
            (w.transpose() * y, w * (raw - magnitude.offset_ut))
        };
        let (wy, h) = at(&magnitude);
        let gradient = magnitude.gradient(&wy, &h);
        for i in 0..9 {
            let step = if i < 3 { 1e-3 } else { 1e-5 };
            let moved = |by: f64| {
                let mut moved = magnitude.clone();
                if i < 3 {
                    moved.offset_ut[i] += by
                } else {
                    moved.iron[i - 3] += by
                }
                y.dot(&at(&moved).1)
            };
            let slope = (moved(step) - moved(-step)) / (2.0 * step);
            assert!((gradient[i] - slope).abs() < 1e-4 * (1.0 + slope.abs()), "seed {seed}, {i}: {slope}");
        }
    }
}

/// Turning upright on the spot, little tilt: the directions lie on a narrow cone about the vertical.
fn turning(world: &mut World, magnitude: &mut Magnitude, with_dip: bool, samples: usize) {
    for k in 0..samples {
        let t = k as f64 * 0.01;
        let tilt = Vector3::new(0.15 * (0.9 * t).sin(), 0.15 * (1.3 * t).cos(), 0.0);
        world.attitude = Rotation3::from_axis_angle(&Vector3::z_axis(), 0.8 * t) * Rotation3::new(tilt);
        push(world, magnitude, with_dip);
    }
}

#[test]
fn the_dip_makes_the_offset_surer_and_is_not_believed_too_much() {
    const SEEDS: u64 = 20;
    let [(with, nees), (without, nees_without)] = [true, false].map(|with_dip| {
        let (mut squares, mut normalised) = (0.0, 0.0);
        for seed in 100..100 + SEEDS {
            let mut world = World::new(seed);
            world.tumbling_rad_s = 0.0;
            let mut magnitude = begun(&mut world, 400, with_dip);
            // a random walk, seen from a narrow cone of directions
            for _ in 0..10 {
                world.hard_iron_ut += world.random.vector(0.3);
                turning(&mut world, &mut magnitude, with_dip, 300);
            }
            let error = magnitude.offset_ut - world.hard_iron_ut;
            let covariance = magnitude.covariance().fixed_view::<3, 3>(0, 0).into_owned();
            squares += error.norm_squared() / SEEDS as f64;
            normalised += error.dot(&(covariance.try_inverse().unwrap() * error)) / (3.0 * SEEDS as f64);
        }
        (squares.sqrt(), normalised)
    });
    println!("b rms {with:.2} uT with the dip, {without:.2} without; NEES {nees:.2}, {nees_without:.2}");
    assert!(with < 0.6 * without, "{with} uT with the dip, {without} without");
    assert!(nees.max(nees_without) < 3.0, "NEES {nees} with the dip, {nees_without} without");
}
