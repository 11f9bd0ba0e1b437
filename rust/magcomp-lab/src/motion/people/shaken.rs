//! Turned to and fro and moved to and fro, the device's heading wandering meanwhile.

use super::{Mover, STEP_S, euler};
use crate::motion::Trajectory;
use crate::motion::noise::Turns;
use crate::random::Random;
use magcomp::nalgebra::Vector3;
use std::f64::consts::TAU;

/// The second axis is turned and moved by this share of the first, and by this share as often.
const SECOND: f64 = 0.7;
const SECOND_HZ: f64 = 0.83;
/// What is moved out of step is moved by these shares as often, one for each axis of the world.
const OUT_OF_STEP: [f64; 3] = [1.37, 0.71, 1.13];
/// The top edge is lifted by this, degrees, on average.
const LIFTED_DEG: f64 = 20.0;
/// Turns meanwhile.
const TURNED: Turns =
    Turns { held_s: (1.0, 5.0), angle_deg: (25.0, 120.0), over_s: (2.0, 5.0), first_s: (0.5, 2.0), is_eased: true };

/// How a device is shaken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shake {
    /// Turned to and fro by so much to either side, rad.
    pub turned_rad: f64,
    /// So often a second.
    pub hz: f64,
    /// Moved to and fro with accelerations of up to this, along the first horizontal axis, m/s^2.
    pub moved_m_s2: f64,
    /// In step with the turns, against the way that gravity's direction goes; out of step it is moved up and down as well.
    pub in_step: bool,
}

impl Shake {
    /// A trajectory of `duration_s`.
    pub fn trajectory(&self, duration_s: f64, random: &mut Random) -> Trajectory {
        Mover::new(duration_s, random).shaken(self)
    }
}

impl Mover<'_> {
    /// A sine of about this frequency, from any phase on.
    fn oscillation(&mut self, hz: f64) -> Vec<f64> {
        let (mut phase, wander) = (self.random.uniform(0.0, TAU), self.wander(3.0, 0.025));
        self.grid.each(|k| {
            phase += TAU * hz * (1.0 + wander[k]) * STEP_S;
            phase.sin()
        })
    }

    fn shaken(&mut self, shake: &Shake) -> Trajectory {
        let yaw = self.turns(TURNED);
        let [lean, tip] = [3.0, 3.0].map(|sd| self.wander(1.5, sd));
        let [one, two] = [1.0, SECOND_HZ].map(|share| self.oscillation(share * shake.hz));
        let turned_deg = shake.turned_rad.to_degrees();
        let attitudes = self.attitudes(|k| {
            let pitch = LIFTED_DEG + lean[k] + turned_deg * one[k];
            euler(yaw[k], pitch, tip[k] + SECOND * turned_deg * two[k])
        });
        let [ahead, aside, up] = if shake.in_step {
            // up goes to the top edge that is lifted, and the device is pushed away from there
            [one.iter().map(|v| -v).collect(), two, vec![0.0; self.grid.count]]
        } else {
            OUT_OF_STEP.map(|share| self.oscillation(share * shake.hz))
        };
        let acceleration: Vec<_> = (0..self.grid.count)
            .map(|k| {
                let (sin, cos) = yaw[k].sin_cos();
                let (ahead, aside) = (ahead[k], SECOND * aside[k]);
                Vector3::new(aside * cos - ahead * sin, aside * sin + ahead * cos, SECOND * up[k]) * shake.moved_m_s2
            })
            .collect();
        // as of a sine, and of one frequency: it is only to say how far it comes
        let positions = acceleration.iter().map(|moved| moved * -(TAU * shake.hz).powi(-2)).collect();
        self.trajectory(attitudes, acceleration).at_positions(positions)
    }
}
