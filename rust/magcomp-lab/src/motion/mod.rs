//! How the device turns: attitudes (device to east-north-up) and the body rates that connect them.
//!
//! A smooth motion is laid out on a grid of 1 ms with the body rate constant in between, so that attitude and rate
//! belong to each other exactly at any time: q(t) = q_k exp(w_k (t - t_k) / 2). How people carry phones (`people`) is laid out on a
//! grid of 2.5 ms, with the accelerations and the way that belong to it.

pub mod noise;
mod people;
mod trajectory;

pub use people::shaken::Shake;
pub use trajectory::Trajectory;

use crate::random::Random;
use clap::ValueEnum;
use magcomp::nalgebra::{UnitQuaternion, Vector3};
use noise::{Grid, Turns, WALKS_M_S};
use people::Mover;
use std::f64::consts::TAU;
use trajectory::GRID_S;

/// Body rate of hand-held tumbling and of the planar motion, rad/s rms over all axes.
const TUMBLE_RAD_S: f64 = 1.0;
/// Correlation time of a wandering motion, s: a hand changes its motion about once a second.
const WANDER_S: f64 = 1.0;
/// Time in which a hand follows such a motion, s: without it the attitude would have a jump of its rate at every point of the grid.
const FOLLOWS_S: f64 = 0.2;
/// Swing of pitch and roll of a pedestrian, degrees; the gait's sway on top keeps both within 20.
const SWING_DEG: f64 = 17.0;
/// Wandering of pitch and roll of a stroll, degrees; its gait's sway; the limit of both.
const STROLL_DEG: f64 = 8.0;
const STROLL_SWAY_DEG: f64 = 4.0;
const STROLL_LIMIT_DEG: f64 = 20.0;
/// Steps of a pedestrian per second.
const STEPS_HZ: f64 = 1.9;

/// Kinds of motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Motion {
    /// Every sample at a random attitude of its own; no gyroscope follows that
    #[default]
    Uniform,
    /// A hand turning the device about: smooth random body rate, 1 rad/s rms
    Tumble,
    /// Walking: heading held, then turned by 45 to 180 deg; pitch and roll within 20 deg
    Walk,
    /// Walking about, with more turns: straight for 1.5 to 4.5 s; pitch and roll wander within 20 deg
    Stroll,
    /// Turning about one axis of the device only
    Planar,
    /// At rest
    Still,
    /// Walking, the phone in the hand before the chest
    Text,
    /// Walking, the phone at the ear, after 9 s in the hand
    Call,
    /// Walking, the phone upside down in a trouser pocket, after 9 s in the hand
    Pocket,
    /// In a mount in a car, after 9 s in the hand
    Drive,
    /// In the hand of a passenger of a car
    DriveHand,
    /// Turned about in both hands: augmented reality, a game
    Game,
    /// On a table, picked up now and then
    Table,
    /// On a table, the screen up, never touched
    Lying,
    /// Standing, turning on the spot with the phone nearly flat
    Look,
    /// Rest, walking and turning over in the hands, in turns of 15 to 70 s
    Mixed,
}

impl Trajectory {
    /// Turns about one axis of the world, at 1 rad/s rms: the vertical or a random one. The axis wobbles: two slow swings across it,
    /// each of at most `wobble_deg`.
    pub fn about_one_axis(duration_s: f64, vertical: bool, wobble_deg: f64, random: &mut Random) -> Self {
        let count = (duration_s / GRID_S).ceil() as usize + 1;
        let (start, other) = (random.attitude(), random.direction());
        let axis = if vertical { Vector3::z() } else { other };
        let across = axis.cross(&axis.cross(&Vector3::x()).normalize());
        let rates = wandering(count, TUMBLE_RAD_S, random);
        let (one, two) = (swing(count, random), swing(count, random));
        let share = wobble_deg / SWING_DEG;
        let mut angle = 0.0;
        let attitudes = (0..count).map(|k| {
            let tilt = (across * one[k] + axis.cross(&across) * two[k]) * share;
            let turned = UnitQuaternion::from_scaled_axis(axis * angle);
            angle += rates[k].x * GRID_S;
            UnitQuaternion::from_scaled_axis(tilt) * turned * start
        });
        let attitudes = attitudes.collect();
        Self::from_attitudes(attitudes, GRID_S).at_positions(Grid { count, step_s: GRID_S }.hand(random))
    }
}

impl Motion {
    /// A trajectory of `duration_s`; `sample_period_s` is the magnetometer's, for [`Motion::Uniform`].
    pub fn trajectory(self, duration_s: f64, sample_period_s: f64, random: &mut Random) -> Trajectory {
        let count = (duration_s / GRID_S).ceil() as usize + 1;
        let grid = Grid { count, step_s: GRID_S };
        match self {
            Self::Uniform => {
                let count = (duration_s / sample_period_s).ceil() as usize + 1;
                let attitudes = (0..count).map(|_| random.attitude()).collect();
                let rates_rad_s = vec![Vector3::zeros(); count];
                Trajectory { step_s: sample_period_s, attitudes, rates_rad_s, ..Trajectory::default() }
            }
            Self::Tumble => {
                let start = random.attitude();
                let rates = wandering(count, TUMBLE_RAD_S / 3f64.sqrt(), random);
                Trajectory::from_rates(start, rates).at_positions(grid.hand(random))
            }
            Self::Walk => walk(grid, random),
            Self::Stroll => stroll(grid, random),
            Self::Planar => {
                let (start, axis) = (random.attitude(), random.direction());
                let rates = wandering(count, TUMBLE_RAD_S, random).iter().map(|rate| axis * rate.x).collect();
                Trajectory::from_rates(start, rates).at_positions(grid.hand(random))
            }
            Self::Still => Trajectory::from_rates(random.attitude(), vec![Vector3::zeros(); count]),
            Self::Text => Mover::new(duration_s, random).text(),
            Self::Call => Mover::new(duration_s, random).call(),
            Self::Pocket => Mover::new(duration_s, random).pocket(),
            Self::Drive => Mover::new(duration_s, random).drive(false),
            Self::DriveHand => Mover::new(duration_s, random).drive(true),
            Self::Game => Mover::new(duration_s, random).game(),
            Self::Table => Mover::new(duration_s, random).table(),
            Self::Lying => Mover::new(duration_s, random).lying(),
            Self::Look => Mover::new(duration_s, random).look(),
            Self::Mixed => Mover::new(duration_s, random).mixed(),
        }
    }
}

/// Ornstein-Uhlenbeck: dw = -w / tau dt + noise, of standard deviation `sigma` per axis, stationary from the start.
fn wandering(count: usize, sigma: f64, random: &mut Random) -> Vec<Vector3<f64>> {
    let keep = (-GRID_S / WANDER_S).exp();
    let fresh = (1.0 - keep * keep).sqrt() * sigma;
    let mut value = random.normal3() * sigma;
    (0..count)
        .map(|_| {
            let now = value;
            value = value * keep + random.normal3() * fresh;
            now
        })
        .collect()
}

/// The same values, each drawn towards over [`FOLLOWS_S`] (a low-pass of the first order), so that their rates are those of a hand.
fn followed(values: Vec<Vector3<f64>>) -> Vec<Vector3<f64>> {
    let gain = 1.0 - (-GRID_S / FOLLOWS_S).exp();
    let mut at = values.first().copied().unwrap_or_default();
    let follow = |value: Vector3<f64>| {
        at += (value - at) * gain;
        at
    };
    values.into_iter().map(follow).collect()
}

/// Turns of somebody who walks: by 45 to 180 deg.
const WALKED: Turns =
    Turns { held_s: (3.0, 8.0), angle_deg: (45.0, 180.0), over_s: (1.0, 2.0), first_s: (2.0, 5.0), is_eased: false };
/// And of somebody who strolls.
const STROLLED: Turns = Turns { held_s: (1.5, 4.5), over_s: (1.5, 1.5), first_s: (1.5, 4.5), ..WALKED };

/// Phase of the steps at a point of the grid, rad.
fn gait(k: usize) -> f64 {
    TAU * STEPS_HZ * k as f64 * GRID_S
}

/// Of somebody who walks where the heading points.
fn on_the_way(grid: Grid, heading: &[f64], attitude: impl FnMut(usize) -> UnitQuaternion<f64>) -> Trajectory {
    let attitudes = (0..grid.count).map(attitude).collect();
    Trajectory::from_attitudes(attitudes, GRID_S).at_positions(grid.way(heading, |_| WALKS_M_S))
}

/// Heading held for 3 to 8 s, then turned in 1 to 2 s; slow swings of pitch and roll; a sway at the rate of the steps.
fn walk(grid: Grid, random: &mut Random) -> Trajectory {
    let heading = grid.turns(&WALKED, random);
    let (pitch, roll) = (swing(grid.count, random), swing(grid.count, random));
    let degrees = |deg: f64| deg.to_radians();
    on_the_way(grid, &heading, |k| {
        let step = gait(k);
        UnitQuaternion::from_euler_angles(
            roll[k] + degrees(3.0) * (step / 2.0).sin(),
            pitch[k] + degrees(2.0) * step.sin(),
            heading[k] + degrees(2.0) * (step / 2.0 + 1.0).sin(),
        )
    })
}

/// Heading held for 1.5 to 4.5 s, then turned in 1.5 s; pitch and roll wander and sway.
fn stroll(grid: Grid, random: &mut Random) -> Trajectory {
    let heading = grid.turns(&STROLLED, random);
    // the hand that follows it takes out as much of the wandering as is given more of it
    let wander = followed(wandering(grid.count, STROLL_DEG * (1.0 + FOLLOWS_S / WANDER_S).sqrt(), random));
    let tilt = |wander: f64, phase: f64| {
        (wander + STROLL_SWAY_DEG * phase.sin()).clamp(-STROLL_LIMIT_DEG, STROLL_LIMIT_DEG).to_radians()
    };
    on_the_way(grid, &heading, |k| {
        let (roll, pitch) = (tilt(wander[k].x, gait(k) / 2.0), tilt(wander[k].y, gait(k)));
        UnitQuaternion::from_euler_angles(roll, pitch, heading[k])
    })
}

/// Five slow waves (0.05 to 0.6 Hz), scaled to reach [`SWING_DEG`].
fn swing(count: usize, random: &mut Random) -> Vec<f64> {
    let waves: [(f64, f64); 5] = std::array::from_fn(|_| (random.uniform(0.05, 0.6), random.uniform(0.0, TAU)));
    let sum = |t: f64| waves.iter().map(|(hz, phase)| (TAU * hz * t + phase).sin()).sum::<f64>();
    let swing: Vec<f64> = (0..count).map(|k| sum(k as f64 * GRID_S)).collect();
    let largest = swing.iter().fold(f64::MIN_POSITIVE, |max, v| max.max(v.abs()));
    swing.iter().map(|v| v / largest * SWING_DEG.to_radians()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Purpose;

    fn trajectory(motion: Motion) -> Trajectory {
        motion.trajectory(60.0, 0.01, &mut Random::new(3, Purpose::Motion))
    }

    #[test]
    fn rates_carry_one_attitude_to_the_next() {
        for motion in [Motion::Tumble, Motion::Walk, Motion::Stroll, Motion::Planar, Motion::Still] {
            let trajectory = trajectory(motion);
            for k in 0..5900 {
                let t = f64::from(k) * 0.01;
                let (before, _) = trajectory.at(t);
                let mut turned = before;
                for m in 0..10 {
                    turned *= UnitQuaternion::from_scaled_axis(trajectory.at(t + f64::from(m) * 1e-3).1 * 1e-3);
                }
                assert!(turned.angle_to(&trajectory.at(t + 0.01).0) < 1e-9, "{motion:?} at {t} s");
            }
        }
    }

    #[test]
    fn tumbling_has_its_rate_and_walking_its_limits() {
        let tumble = trajectory(Motion::Tumble);
        let squares: f64 = (0..6000).map(|k| tumble.at(f64::from(k) * 0.01).1.norm_squared()).sum();
        assert!(((squares / 6000.0).sqrt() - TUMBLE_RAD_S).abs() < 0.3);
        for walk in [Motion::Walk, Motion::Stroll].map(trajectory) {
            for k in 0..6000 {
                let (roll, pitch, _) = walk.at(f64::from(k) * 0.01).0.euler_angles();
                assert!(roll.to_degrees().abs() <= 20.01 && pitch.to_degrees().abs() <= 20.01);
            }
        }
    }

    /// A phone's gyroscope reads up to 35 rad/s; a stroll turns by 180 deg in 1.5 s at most, which is 3.1 rad/s at its middle.
    #[test]
    fn no_motion_is_faster_than_a_phones_gyroscope() {
        for (motion, most_rad_s) in [
            (Motion::Uniform, 35.0),
            (Motion::Tumble, 35.0),
            (Motion::Walk, 8.0),
            (Motion::Stroll, 8.0),
            (Motion::Planar, 35.0),
            (Motion::Still, 35.0),
        ] {
            for seed in 1..20 {
                let trajectory = motion.trajectory(60.0, 0.01, &mut Random::new(seed, Purpose::Motion));
                let fastest = trajectory.rates_rad_s.iter().map(Vector3::norm).fold(0.0, f64::max);
                assert!(fastest < most_rad_s, "{motion:?}, {seed}: {fastest} rad/s");
            }
        }
    }

    #[test]
    fn planar_motion_keeps_its_axis() {
        let planar = trajectory(Motion::Planar);
        let axis = planar.at(0.0).1.normalize();
        assert!((0..6000).all(|k| planar.at(f64::from(k) * 0.01).1.normalize().dot(&axis).abs() > 1.0 - 1e-9));
    }

    #[test]
    fn an_axis_wobbles_as_far_as_it_should() {
        for (vertical, wobble_deg) in [(true, 0.0), (false, 0.0), (true, 1.0), (false, 0.3)] {
            let random = &mut Random::new(5, Purpose::Motion);
            let trajectory = Trajectory::about_one_axis(60.0, vertical, wobble_deg, random);
            let start = trajectory.at(0.0).0;
            // the axis in the world: that of the largest turn since the start; swings begin anywhere
            let turns: Vec<_> = (0..6000).map(|k| trajectory.at(f64::from(k) * 0.01).0 * start.inverse()).collect();
            let largest = turns.iter().max_by(|a, b| a.angle().total_cmp(&b.angle())).unwrap();
            let axis = if vertical { Vector3::z() } else { largest.axis().unwrap().into_inner() };
            let tilt_deg = |turn: &UnitQuaternion<f64>| (turn * axis).angle(&axis).to_degrees();
            let worst = turns.iter().map(tilt_deg).fold(0.0, f64::max);
            assert!(largest.angle() > 2.5, "turned by {} rad", largest.angle());
            assert!(worst <= 3.0 * wobble_deg + 1e-5 && worst >= 0.5 * wobble_deg, "{wobble_deg} deg: {worst}");
        }
    }

    #[test]
    fn uniform_attitudes_are_even() {
        let uniform = trajectory(Motion::Uniform);
        let mean: Vector3<f64> = (0..6000).map(|k| uniform.at(f64::from(k) * 0.01).0 * Vector3::z()).sum();
        assert!(mean.norm() / 6000.0 < 0.04);
    }
}
