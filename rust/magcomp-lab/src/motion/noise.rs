//! Random courses over time on an even grid: slow wandering, noise of a band of frequencies, easing, turns.

use crate::random::Random;
use magcomp::nalgebra::Vector3;
use std::f64::consts::{PI, TAU};

/// Waves that make up noise of a band: enough to look normal.
const WAVES: usize = 40;

/// Speed of a pedestrian, m/s.
pub(super) const WALKS_M_S: f64 = 1.3;
/// A hand that turns a device moves it: so far on each axis, root mean square, m, and for how long in one direction, s. Arms reach no further, and
/// do not go faster (0.6 m/s on an axis).
const HAND_M: f64 = 0.2;
const HAND_S: f64 = 0.35;

/// From 0 to 1 while `share` does, with speed and acceleration zero at both ends; 0 before and 1 after.
pub fn ease(share: f64) -> f64 {
    let u = share.clamp(0.0, 1.0);
    u * u * u * (10.0 - 15.0 * u + 6.0 * u * u)
}

/// The grid: points, and the time between two of them, s.
#[derive(Clone, Copy, Debug)]
pub struct Grid {
    /// Points.
    pub count: usize,
    /// From one to the next, s.
    pub step_s: f64,
}

impl Grid {
    /// Time of a point, s.
    pub fn time_s(self, k: usize) -> f64 {
        k as f64 * self.step_s
    }

    /// One value a point.
    pub fn each(self, value: impl FnMut(usize) -> f64) -> Vec<f64> {
        (0..self.count).map(value).collect()
    }

    /// Smooth stationary noise of standard deviation `sd`: white noise through two equal poles of the time constant `tau_s`.
    pub fn wander(self, tau_s: f64, sd: f64, random: &mut Random) -> Vec<f64> {
        let keep = (-self.step_s / tau_s).exp();
        let fresh = sd * ((1.0 - keep * keep).powi(3) / (1.0 + keep * keep)).sqrt();
        let burn_in = (6.0 * tau_s / self.step_s) as usize;
        let (mut latest, mut before) = (0.0, 0.0);
        let values = (0..self.count + burn_in).map(|_| {
            let value = fresh * random.normal() + 2.0 * keep * latest - keep * keep * before;
            (latest, before) = (value, latest);
            value
        });
        values.skip(burn_in).collect()
    }

    /// Noise between two frequencies of standard deviation `sd`.
    pub fn band(self, low_hz: f64, high_hz: f64, sd: f64, random: &mut Random) -> Vec<f64> {
        let mut values = vec![0.0; self.count];
        let size = sd * (2.0 / WAVES as f64).sqrt();
        for _ in 0..WAVES {
            let phase = TAU * random.uniform(low_hz, high_hz) * self.step_s;
            let (turn_sin, turn_cos) = phase.sin_cos();
            let (mut sin, mut cos) = random.uniform(0.0, TAU).sin_cos();
            for value in &mut values {
                *value += size * sin;
                (sin, cos) = (sin * turn_cos + cos * turn_sin, cos * turn_cos - sin * turn_sin);
            }
        }
        values
    }

    /// Where a hand is that turns a device, m: about one point.
    pub(super) fn hand(self, random: &mut Random) -> Vec<Vector3<f64>> {
        let [x, y, z] = [(); 3].map(|()| self.wander(HAND_S, HAND_M, random));
        (0..self.count).map(|k| Vector3::new(x[k], y[k], z[k])).collect()
    }

    /// Where somebody is who goes where the heading, rad, points, m.
    pub(super) fn way(self, heading: &[f64], speed_m_s: impl Fn(usize) -> f64) -> Vec<Vector3<f64>> {
        let mut position = Vector3::zeros();
        let step = |(k, heading): (usize, &f64)| {
            position += Vector3::new(-heading.sin(), heading.cos(), 0.0) * (speed_m_s(k) * self.step_s);
            position
        };
        heading.iter().enumerate().map(step).collect()
    }

    /// A heading, rad: held, turned, and so on, as the rule says.
    pub fn turns(self, rule: &Turns, random: &mut Random) -> Vec<f64> {
        let start = random.uniform(-PI, PI);
        let mut turns = Vec::new();
        let mut at_s = random.uniform(rule.first_s.0, rule.first_s.1);
        while at_s < self.time_s(self.count) {
            let angle = random.uniform(rule.angle_deg.0, rule.angle_deg.1).to_radians() * random.sign();
            let over_s = random.uniform(rule.over_s.0, rule.over_s.1);
            turns.push((at_s, over_s, angle));
            at_s += over_s + random.uniform(rule.held_s.0, rule.held_s.1);
        }
        // turns do not overlap: those behind are whole
        let (mut behind, mut next) = (0.0, 0);
        self.each(|k| {
            let time_s = self.time_s(k);
            while turns.get(next).is_some_and(|(at_s, over_s, _)| time_s >= at_s + over_s) {
                behind += turns[next].2;
                next += 1;
            }
            let now = turns.get(next).map_or(0.0, |(at_s, over_s, angle)| {
                let share = ((time_s - at_s) / over_s).clamp(0.0, 1.0);
                angle * if rule.is_eased { ease(share) } else { share * share * (3.0 - 2.0 * share) }
            });
            start + (behind + now)
        })
    }
}

/// How a heading is held and turned: each is drawn between two limits.
#[derive(Clone, Copy, Debug)]
pub struct Turns {
    /// Held for, s.
    pub held_s: (f64, f64),
    /// Turned by, degrees, to either side.
    pub angle_deg: (f64, f64),
    /// A turn takes, s.
    pub over_s: (f64, f64),
    /// Held for at first, s.
    pub first_s: (f64, f64),
    /// A turn begins and ends without a jump of the acceleration.
    pub is_eased: bool,
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Purpose;

    const GRID: Grid = Grid { count: 200_000, step_s: 0.0025 };

    fn sd(values: &[f64]) -> f64 {
        let mean = values.iter().sum::<f64>() / values.len() as f64;
        (values.iter().map(|v| (v - mean).powi(2)).sum::<f64>() / values.len() as f64).sqrt()
    }

    #[test]
    fn wandering_and_bands_have_their_size_and_speed() {
        let random = &mut Random::new(5, Purpose::Motion);
        let wander = GRID.wander(0.5, 3.0, random);
        // 500 s of 0.5 s: the standard deviation of a standard deviation is some 3 %
        assert!((sd(&wander) / 3.0 - 1.0).abs() < 0.1, "{}", sd(&wander));
        // two equal poles: the rate's standard deviation is that of the value over tau
        let rates: Vec<f64> = wander.windows(2).map(|pair| (pair[1] - pair[0]) / GRID.step_s).collect();
        assert!((sd(&rates) / 6.0 - 1.0).abs() < 0.1, "{}", sd(&rates));
        let band = GRID.band(5.0, 15.0, 2.0, random);
        assert!((sd(&band) / 2.0 - 1.0).abs() < 0.02, "{}", sd(&band));
        let crossings = band.windows(2).filter(|pair| pair[0] < 0.0 && pair[1] >= 0.0).count() as f64;
        let hz = crossings / GRID.time_s(GRID.count);
        assert!((5.0..15.0).contains(&hz), "{hz}");
    }

    #[test]
    fn a_heading_is_held_between_turns_of_the_size_that_the_rule_says() {
        let rule = Turns {
            held_s: (4.0, 12.0),
            angle_deg: (25.0, 120.0),
            over_s: (0.9, 2.0),
            first_s: (2.0, 6.0),
            is_eased: true,
        };
        let heading = GRID.turns(&rule, &mut Random::new(6, Purpose::Motion));
        let held: Vec<f64> = heading.windows(2).filter(|pair| pair[0] == pair[1]).map(|pair| pair[0]).collect();
        let mut levels = held.clone();
        levels.dedup();
        assert!(levels.len() > 40 && held.len() > GRID.count / 2, "{} levels", levels.len());
        for pair in levels.windows(2) {
            let turned_deg = (pair[1] - pair[0]).abs().to_degrees();
            assert!((25.0..=120.0).contains(&turned_deg), "{turned_deg}");
        }
    }
}
