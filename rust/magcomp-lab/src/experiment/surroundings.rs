//! What a walk or a drive meets: steel doors, an uneven field, a car's body, its braking.

use crate::random::{Purpose, Random};
use crate::schedule::{Change, Schedule};
use crate::simulate::Simulation;
use magcomp::nalgebra::{Rotation3, Vector3};
use std::f64::consts::TAU;

/// Largest field of a door that is passed, and of a car's body, uT.
pub const NEAR_UT: f64 = 30.0;
/// A door every so often, s.
const DOORS_S: f64 = 10.0;
/// Speed of a walk, m/s.
const WALK_M_S: f64 = 1.2;
/// How long the surroundings take to come, s.
const COMES_S: f64 = 2.0;
/// Straight and in a bend of 90 degrees in turn, each for so long, s.
const STRETCH_S: f64 = 8.0;
/// Acceleration of a car that speeds up and brakes, m/s^2, and how long it lasts, s.
const BRAKING_M_S2: f64 = 2.0;
const BRAKES_S: f64 = 4.0;
/// The field is linear between times so far apart, s.
const SAMPLED_S: f64 = 0.05;

/// Something that the device is carried through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Surroundings {
    /// A steel door at arm's length: a dipole that comes, turns and goes within two seconds.
    Doors,
    /// A curl-free random field of waves of 4 to 14 m, root mean square in uT.
    Uneven(f64),
    /// The body of a car around the hand that holds the device: its field turns with the car.
    Car,
    /// A car that speeds up and brakes.
    Braking,
}

impl Surroundings {
    /// The field from `from_s` to `until_s`, uT, east-north-up, where that of the Earth is `earth_ut`.
    #[must_use]
    pub fn field(self, earth_ut: Vector3<f64>, seed: u64, from_s: f64, until_s: f64) -> Schedule<Vector3<f64>> {
        let mut random = Random::new(seed, Purpose::Bootstrap);
        let direction = random.direction();
        let waves: Vec<_> = (0..20)
            .map(|_| {
                (random.direction() * (TAU / random.uniform(4.0, 14.0)), random.uniform(0.0, TAU), random.normal())
            })
            .collect();
        // mean square of a sum of waves along their own wave vectors
        let power: f64 = waves.iter().map(|(k, _, size)| 0.5 * (size * k.norm()).powi(2)).sum();
        let near = |since_s: f64| match self {
            Self::Doors => door(direction, since_s.rem_euclid(DOORS_S) - DOORS_S / 2.0),
            Self::Uneven(rms_ut) => {
                let at = direction * (WALK_M_S * since_s);
                let sum: Vector3<f64> =
                    waves.iter().map(|(k, phase, size)| k * (size * (k.dot(&at) + phase).cos())).sum();
                sum * (rms_ut / power.sqrt())
            }
            Self::Car => {
                let (stretches, rest) = ((since_s / STRETCH_S) as i32, since_s % STRETCH_S / STRETCH_S);
                let quarters = f64::from(stretches / 2) + if stretches % 2 == 1 { rest } else { 0.0 };
                Rotation3::from_euler_angles(0.0, 0.0, quarters * TAU / 4.0) * direction * NEAR_UT
            }
            Self::Braking => Vector3::zeros(),
        };
        let count = ((until_s - from_s) / SAMPLED_S) as usize;
        let change = |k: usize| {
            let (at_s, since_s) = (from_s + k as f64 * SAMPLED_S, (k + 1) as f64 * SAMPLED_S);
            Change { at_s, over_s: SAMPLED_S, to: earth_ut + near(since_s) * (since_s / COMES_S).min(1.0) }
        };
        Schedule { start: earth_ut, changes: (0..count).map(change).collect() }
    }

    /// Adds to the accelerometer what it feels besides gravity from `from_s` on.
    pub fn push(self, simulation: &mut Simulation, seed: u64, from_s: f64) {
        if self != Self::Braking {
            return;
        }
        let mut random = Random::new(seed, Purpose::Bootstrap);
        let along = random.direction().cross(&Vector3::z()).normalize() * BRAKING_M_S2;
        let mut truth = simulation.magnetic.iter().zip(&simulation.truth).peekable();
        for event in &mut simulation.ups {
            while truth.next_if(|(sample, _)| sample.time_ns < event.time_ns).is_some() {}
            let since_s = event.time_ns as f64 / 1e9 - from_s;
            if let (true, Some((_, truth))) = (since_s > 0.0, truth.peek()) {
                let sign = if (since_s / BRAKES_S) as i32 % 2 == 0 { 1.0 } else { -1.0 };
                event.up_m_s2 += truth.attitude.inverse() * along * sign;
            }
        }
    }
}

/// The field of a door of that moment's direction, seconds before or after it is nearest.
fn door(moment: Vector3<f64>, since_s: f64) -> Vector3<f64> {
    let field = |along: f64| {
        let r = Vector3::new(along, 0.8, 0.3);
        (r * (3.0 * r.dot(&moment) / r.norm_squared()) - moment) / r.norm().powi(3)
    };
    let largest = (-40..=40).map(|k| field(f64::from(k) * 0.05).norm()).fold(0.0, f64::max);
    field(since_s) * (NEAR_UT / largest)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_come_after_the_start_and_are_as_large_as_they_say() {
        let earth = Vector3::new(0.0, 25.0, -43.0);
        for seed in 0..5 {
            let sizes = |what: Surroundings| {
                let schedule = what.field(earth, seed, 30.0, 90.0);
                assert_eq!(schedule.at(30.0), earth);
                (320..900).map(|k| (schedule.at(f64::from(k) * 0.1) - earth).norm()).collect::<Vec<_>>()
            };
            let largest = |sizes: &[f64]| sizes.iter().copied().fold(0.0, f64::max);
            let doors = sizes(Surroundings::Doors);
            assert!((largest(&doors) - NEAR_UT).abs() < 0.6, "{}", largest(&doors));
            assert!(doors.iter().filter(|size| **size < 2.0).count() > doors.len() / 2);
            let car = sizes(Surroundings::Car);
            assert!(car.iter().all(|size| (size - NEAR_UT).abs() < 0.1));
            let uneven = sizes(Surroundings::Uneven(5.0));
            let rms = (uneven.iter().map(|size| size * size).sum::<f64>() / uneven.len() as f64).sqrt();
            assert!((3.0..8.0).contains(&rms), "{rms}");
            assert_eq!(largest(&sizes(Surroundings::Braking)), 0.0);
        }
    }
}
