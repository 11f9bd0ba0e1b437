//! How people carry phones, with the accelerations that belong to it: walking, at the ear, in a pocket, in a car, on a table.
//!
//! Attitudes are Rz(yaw) Rx(pitch) Ry(roll), device (x right, y top edge, z out of the screen) to east-north-up: yaw counter-clockwise from
//! north, pitch lifts the top edge. Angles are degrees until they become an attitude.

pub mod shaken;

use super::Trajectory;
use super::noise::{Grid, Turns, WALKS_M_S, ease};
use crate::random::Random;
use magcomp::nalgebra::{UnitQuaternion, Vector3};
use std::f64::consts::{FRAC_PI_2, TAU};

/// Grid of these motions, s.
const STEP_S: f64 = 0.0025;
/// Before it is put where it goes, a phone is turned over in the hand for this long, s, and that ends over this long, s.
const HANDLED_S: f64 = 9.0;
const PUT_S: f64 = 3.0;
/// By how much, rad per axis.
const HANDLED_RAD: f64 = 0.9;
/// Somebody who turns on the spot holds it so far from the axis, m.
const ARM_M: f64 = 0.4;
/// Turns of somebody who walks.
const WALKED: Turns =
    Turns { held_s: (4.0, 12.0), angle_deg: (25.0, 120.0), over_s: (0.9, 2.0), first_s: (2.0, 6.0), is_eased: true };

/// Makes a motion on the grid of a duration.
pub(super) struct Mover<'a> {
    grid: Grid,
    random: &'a mut Random,
}

impl<'a> Mover<'a> {
    pub fn new(duration_s: f64, random: &'a mut Random) -> Self {
        Self { grid: Grid { count: (duration_s / STEP_S) as usize + 2, step_s: STEP_S }, random }
    }

    fn wander(&mut self, tau_s: f64, sd: f64) -> Vec<f64> {
        self.grid.wander(tau_s, sd, self.random)
    }

    fn wander3(&mut self, tau_s: f64, sd: f64) -> Vec<Vector3<f64>> {
        let [x, y, z] = [(); 3].map(|()| self.wander(tau_s, sd));
        (0..self.grid.count).map(|k| Vector3::new(x[k], y[k], z[k])).collect()
    }

    fn band3(&mut self, low_hz: f64, high_hz: f64, sd: f64) -> Vec<Vector3<f64>> {
        let [x, y, z] = [(); 3].map(|()| self.grid.band(low_hz, high_hz, sd, self.random));
        (0..self.grid.count).map(|k| Vector3::new(x[k], y[k], z[k])).collect()
    }

    fn turns(&mut self, rule: Turns) -> Vec<f64> {
        self.grid.turns(&rule, self.random)
    }

    /// Phase of the steps, rad: 1.7 to 2.1 a second.
    fn gait(&mut self) -> Vec<f64> {
        let hz = self.random.uniform(1.7, 2.1);
        let mut phase = 0.0;
        let wander = self.wander(3.0, 0.025);
        self.grid.each(|k| {
            phase += TAU * hz * (1.0 + wander[k]) * STEP_S;
            phase
        })
    }

    /// Position of somebody who walks where `yaw` points, m.
    fn walked(&mut self, yaw: &[f64]) -> Vec<Vector3<f64>> {
        self.walked_now_and_then(yaw, |_| 1.0)
    }

    /// The same of somebody who stands at times: the share of the speed at a point of the grid.
    fn walked_now_and_then(&mut self, yaw: &[f64], share: impl Fn(usize) -> f64) -> Vec<Vector3<f64>> {
        let wander = self.wander(4.0, 0.1);
        self.grid.way(yaw, |k| WALKS_M_S * (1.0 + wander[k]) * share(k))
    }

    /// Acceleration of somebody's steps: up, forward and sideways, m/s^2.
    fn steps(&mut self, yaw: &[f64], gait: &[f64], [up, forward, side]: [f64; 3]) -> Vec<Vector3<f64>> {
        let shaken = self.band3(0.3, 8.0, 0.4);
        (0..self.grid.count)
            .map(|k| {
                let (phase, (sin, cos)) = (gait[k], yaw[k].sin_cos());
                let up = up * (phase.sin() + 0.45 * (2.0 * phase + 1.0).sin() + 0.2 * (3.0 * phase).sin());
                let forward = forward * ((phase + 0.8).sin() + 0.3 * (2.0 * phase).sin());
                let side = side * (phase / 2.0).sin();
                Vector3::new(-sin * forward + cos * side, cos * forward + sin * side, up) + shaken[k]
            })
            .collect()
    }

    /// Rotation of a phone that is turned over in the hand before it is put where it goes.
    fn handled(&mut self) -> Vec<UnitQuaternion<f64>> {
        let grid = self.grid;
        let amount = |k: usize| 1.0 - ease((grid.time_s(k) - HANDLED_S) / PUT_S);
        let turned = self.wander3(0.6, HANDLED_RAD);
        turned.iter().enumerate().map(|(k, v)| UnitQuaternion::from_scaled_axis(v * amount(k))).collect()
    }

    /// Walking, the phone in the hand before the chest.
    pub fn text(&mut self) -> Trajectory {
        let (yaw, gait) = (self.turns(WALKED), self.gait());
        let (pitch, roll) = (35.0 + self.random.uniform(-10.0, 15.0), self.random.uniform(-6.0, 6.0));
        let [lean, tip, sway] = [(1.2, 5.0), (1.0, 4.0), (1.5, 4.0)].map(|(tau_s, sd)| self.wander(tau_s, sd));
        let attitudes = self.attitudes(|k| {
            let phase = gait[k];
            let wobble = sway[k] + 1.8 * (phase / 2.0 + 1.0).sin();
            let pitch = pitch + lean[k] + 1.5 * (phase + 0.3).sin();
            euler(yaw[k] + wobble.to_radians(), pitch, roll + tip[k] + 2.0 * (phase / 2.0).sin())
        });
        let acceleration = self.steps(&yaw, &gait, [2.0, 0.8, 0.6]);
        self.trajectory(attitudes, acceleration).at_positions(self.walked(&yaw))
    }

    /// Walking, the phone at the ear.
    pub fn call(&mut self) -> Trajectory {
        let (yaw, gait) = (self.turns(Turns { held_s: (5.0, 15.0), ..WALKED }), self.gait());
        let [head, lean, tip] = [(1.2, 14.0), (2.0, 5.0), (2.0, 6.0)].map(|(tau_s, sd)| self.wander(tau_s, sd));
        let handled = self.handled();
        let attitudes = self.attitudes(|k| {
            let pitch = 62.0 + lean[k] + 0.8 * gait[k].sin();
            let roll = 25.0 + tip[k] + (gait[k] / 2.0).sin();
            euler(yaw[k] + FRAC_PI_2 + head[k].to_radians(), pitch, roll) * handled[k]
        });
        let acceleration = self.steps(&yaw, &gait, [1.8, 0.6, 0.5]);
        self.trajectory(attitudes, acceleration).at_positions(self.walked(&yaw))
    }

    /// Walking, the phone upside down in a trouser pocket.
    pub fn pocket(&mut self) -> Trajectory {
        let (yaw, gait) = (self.turns(Turns { held_s: (4.0, 14.0), ..WALKED }), self.gait());
        let swing = self.random.uniform(18.0, 28.0);
        let [lean, tip, sway] = [2.0, 3.0, 3.0].map(|sd| self.wander(2.0, sd));
        let handled = self.handled();
        let attitudes = self.attitudes(|k| {
            let phase = gait[k];
            let pitch = -82.0 + swing * ((phase / 2.0).sin() + 0.25 * (phase + 0.7).sin()) + lean[k];
            let roll = 8.0 * (phase / 2.0 + 0.9).sin() + 3.0 * phase.sin() + tip[k];
            let turned = 6.0 * (phase / 2.0 + 2.0).sin() + sway[k];
            euler(yaw[k] + FRAC_PI_2 + turned.to_radians(), pitch, roll) * handled[k]
        });
        let acceleration = self.steps(&yaw, &gait, [3.5, 2.5, 1.0]);
        self.trajectory(attitudes, acceleration).at_positions(self.walked(&yaw))
    }

    /// A car: long legs, turns of 30 to 100 degrees in 4 to 7 s; the phone in a mount or in a passenger's hand.
    pub fn drive(&mut self, in_hand: bool) -> Trajectory {
        let rule = Turns {
            held_s: (12.0, 40.0),
            angle_deg: (30.0, 100.0),
            over_s: (4.0, 7.0),
            first_s: (14.0, 22.0),
            is_eased: true,
        };
        let (turned, lane, pace) = (self.turns(rule), self.wander(6.0, 3.0), self.wander(8.0, 5.0));
        let yaw = self.grid.each(|k| turned[k] + lane[k].to_radians());
        let rate = slope(&yaw);
        let wished = |k: usize| {
            let free = (11.0 + pace[k]).clamp(3.0, 25.0);
            if rate[k].abs() > 0.08 { f64::min(free, 9.0) } else { free }
        };
        let (follow, mut speed) = (1.0 - (-STEP_S / 1.5).exp(), wished(0));
        let speed = self.grid.each(|k| {
            speed += follow * (wished(k) - speed);
            speed
        });
        let along = slope(&speed);
        let (engine, bumps) = (self.band3(5.0, 28.0, 0.8), self.band3(0.8, 2.5, 0.5));
        let acceleration = (0..self.grid.count)
            .map(|k| {
                let ((sin, cos), across) = (yaw[k].sin_cos(), speed[k] * rate[k]);
                Vector3::new(-sin * along[k] - cos * across, cos * along[k] - sin * across, 0.0) + engine[k] + bumps[k]
            })
            .collect();
        let [pitched, rolled] = [0.6, 0.6].map(|sd| self.wander(0.25, sd));
        let (handled, shaken) = (self.handled(), self.band3(8.0, 25.0, 0.03_f64.to_radians()));
        let loose = UnitQuaternion::from_scaled_axis;
        let attitudes = if in_hand {
            let [lean, tip, sway] = [(1.5, 8.0), (1.5, 8.0), (2.0, 15.0)].map(|(tau_s, sd)| self.wander(tau_s, sd));
            self.attitudes(|k| {
                let held = euler(yaw[k] + sway[k].to_radians(), 45.0 + lean[k] + pitched[k], tip[k] + rolled[k]);
                held * handled[k] * loose(shaken[k])
            })
        } else {
            let (pitch, roll) = (60.0 + self.random.uniform(-10.0, 10.0), self.random.uniform(-5.0, 5.0));
            self.attitudes(|k| {
                let pitch = pitch + pitched[k] + 0.4 * along[k];
                let roll = roll + rolled[k] + 0.6 * speed[k] * rate[k];
                euler(yaw[k], pitch, roll) * handled[k] * loose(shaken[k])
            })
        };
        let positions = self.grid.way(&yaw, |k| speed[k]);
        Trajectory { vehicle_yaw: yaw, ..self.trajectory(attitudes, acceleration).at_positions(positions) }
    }

    /// Turned about in both hands: augmented reality, a game.
    pub fn game(&mut self) -> Trajectory {
        let start = UnitQuaternion::from_scaled_axis(self.random.direction() * self.random.uniform(0.0, TAU / 2.0));
        let rates = self.wander3(0.35, 1.2 / 3f64.sqrt());
        let mut attitude = start;
        let attitudes = self.attitudes(|k| {
            let now = attitude;
            attitude *= UnitQuaternion::from_scaled_axis(rates[k] * STEP_S);
            attitude.renormalize_fast();
            now
        });
        let acceleration = self.band3(0.3, 4.0, 1.2);
        self.trajectory(attitudes, acceleration).at_positions(self.grid.hand(self.random))
    }

    /// On a table, picked up now and then, and laid back another way round.
    pub fn table(&mut self) -> Trajectory {
        let end_s = self.grid.time_s(self.grid.count);
        let (mut at_s, mut busy_s, mut spans) = (-2.0, 16.0, Vec::new());
        while at_s < end_s {
            spans.push((at_s, at_s + busy_s + 0.8));
            at_s += busy_s + 0.8 + self.random.uniform(12.0, 30.0);
            busy_s = self.random.uniform(4.0, 9.0);
        }
        let grid = self.grid;
        let picked_up = grid.each(|k| {
            let up = |(from_s, to_s): &(f64, f64)| {
                let (since_s, left_s) = (grid.time_s(k) - from_s, grid.time_s(k) - (to_s - 0.8));
                ease(since_s / 0.8) * (1.0 - ease(left_s / 0.8))
            };
            spans.iter().map(up).fold(0.0, f64::max)
        });
        let start = self.random.uniform(-3.0, 3.0);
        let turns: Vec<f64> = spans.iter().map(|_| self.random.uniform(-2.0, 2.0)).collect();
        let moved = self.wander3(0.7, 0.8);
        let attitudes = self.attitudes(|k| {
            let turned = spans.iter().zip(&turns).map(|((from_s, to_s), turn)| {
                let from_s = from_s.max(0.0);
                turn * ease((grid.time_s(k) - from_s) / (to_s - from_s))
            });
            let lying = euler(start + turned.sum::<f64>(), 0.57, -0.34);
            lying * UnitQuaternion::from_scaled_axis(moved[k] * picked_up[k])
        });
        let shaken = self.band3(0.3, 4.0, 1.5);
        let acceleration = shaken.iter().zip(&picked_up).map(|(shaken, share)| shaken * *share).collect();
        let hand = grid.hand(self.random);
        let positions = hand.iter().zip(&picked_up).map(|(hand, share)| hand * *share).collect();
        Trajectory { picked_up_s: spans, ..self.trajectory(attitudes, acceleration).at_positions(positions) }
    }

    /// On a table, the screen up, never touched.
    pub fn lying(&mut self) -> Trajectory {
        let [yaw, pitch, roll] = [TAU / 2.0, 3.0, 3.0].map(|most| self.random.uniform(-most, most));
        let attitudes = self.attitudes(|_| euler(yaw, pitch, roll));
        self.trajectory(attitudes, vec![Vector3::zeros(); self.grid.count])
    }

    /// Standing, turning on the spot with the phone nearly flat.
    pub fn look(&mut self) -> Trajectory {
        let rule = Turns {
            held_s: (0.5, 3.0),
            angle_deg: (30.0, 180.0),
            over_s: (1.0, 4.0),
            first_s: (0.5, 2.0),
            is_eased: true,
        };
        let yaw = self.turns(rule);
        let [sway, lean, tip] = [3.0, 5.0, 4.0].map(|sd| self.wander(1.0, sd));
        let attitudes = self.attitudes(|k| euler(yaw[k] + sway[k].to_radians(), 20.0 + lean[k], tip[k]));
        let acceleration = self.band3(0.3, 4.0, 0.4);
        let before = |yaw: &f64| Vector3::new(-yaw.sin(), yaw.cos(), 0.0) * ARM_M;
        let positions = yaw.iter().map(before).collect();
        self.trajectory(attitudes, acceleration).at_positions(positions)
    }

    /// Rest, walking, turning over in the hands, in turns of 15 to 70 s. At rest time stands still for the motion.
    pub fn mixed(&mut self) -> Trajectory {
        let grid = self.grid;
        let end_s = grid.time_s(grid.count);
        let mut active = vec![1.0; grid.count];
        let mut turned = grid.each(|k| 1.0 - ease((grid.time_s(k) - 22.0) / 3.0));
        let mut at_s = 25.0;
        while at_s < end_s {
            let (for_s, kind) = (self.random.uniform(15.0, 70.0), self.random.index(4));
            // only this stretch is not zero
            let from = (at_s / STEP_S) as usize;
            let to = (((at_s + for_s + 1.0) / STEP_S) as usize + 1).min(grid.count);
            for k in from..to {
                let since_s = grid.time_s(k) - at_s;
                let share = ease(since_s) * (1.0 - ease(since_s - for_s));
                match kind {
                    0 => active[k] -= share,
                    1 => turned[k] = f64::max(turned[k], share),
                    _ => {}
                }
            }
            at_s += for_s + 1.0;
        }
        let mut moved = 0.0;
        let own_time: Vec<f64> = active
            .iter()
            .map(|active| {
                moved += active.clamp(0.0, 1.0);
                moved
            })
            .collect();
        let rule = Turns { held_s: (3.0, 12.0), angle_deg: (25.0, 150.0), over_s: (0.9, 2.5), ..WALKED };
        let (yaw, gait) = (self.turns(rule), self.gait());
        let [lean, tip] = [(1.2, 7.0), (1.0, 5.0)].map(|(tau_s, sd)| self.wander(tau_s, sd));
        let over = self.wander3(0.7, 0.9);
        let at = |values: &[f64], k: usize| between(values, own_time[k]);
        let yaw_now = grid.each(|k| at(&yaw, k));
        let pitch = grid.each(|k| 35.0 + lean[k] + 1.5 * gait[k].sin());
        let roll = grid.each(|k| tip[k] + 2.0 * (gait[k] / 2.0).sin());
        let [x, y, z] = [0, 1, 2].map(|i| over.iter().map(|v| v[i]).collect::<Vec<f64>>());
        let attitudes = self.attitudes(|k| {
            let over = Vector3::new(at(&x, k), at(&y, k), at(&z, k)) * turned[k];
            euler(yaw_now[k], at(&pitch, k), at(&roll, k)) * UnitQuaternion::from_scaled_axis(over)
        });
        let steps = self.steps(&yaw, &gait, [2.0, 0.8, 0.6]);
        let acceleration = steps.iter().zip(&active).map(|(steps, active)| steps * active.clamp(0.0, 1.0)).collect();
        let positions = self.walked_now_and_then(&yaw_now, |k| active[k].clamp(0.0, 1.0));
        self.trajectory(attitudes, acceleration).at_positions(positions)
    }

    fn attitudes(&self, attitude: impl FnMut(usize) -> UnitQuaternion<f64>) -> Vec<UnitQuaternion<f64>> {
        (0..self.grid.count).map(attitude).collect()
    }

    fn trajectory(&self, attitudes: Vec<UnitQuaternion<f64>>, acceleration: Vec<Vector3<f64>>) -> Trajectory {
        Trajectory { acceleration_m_s2: acceleration, ..Trajectory::from_attitudes(attitudes, STEP_S) }
    }
}

/// Rz(yaw) Rx(pitch) Ry(roll); yaw in rad, the others in degrees.
fn euler(yaw_rad: f64, pitch_deg: f64, roll_deg: f64) -> UnitQuaternion<f64> {
    let about = |axis, angle: f64| UnitQuaternion::from_axis_angle(&axis, angle);
    about(Vector3::z_axis(), yaw_rad)
        * about(Vector3::x_axis(), pitch_deg.to_radians())
        * about(Vector3::y_axis(), roll_deg.to_radians())
}

/// Central differences, per second.
fn slope(values: &[f64]) -> Vec<f64> {
    let last = values.len() - 1;
    let at = |k: usize| {
        let (low, high) = (k.saturating_sub(1), (k + 1).min(last));
        (values[high] - values[low]) / ((high - low) as f64 * STEP_S)
    };
    (0..values.len()).map(at).collect()
}

/// Linear between points; `at` counts points.
fn between(values: &[f64], at: f64) -> f64 {
    let k = (at as usize).min(values.len() - 2);
    values[k] + (values[k + 1] - values[k]) * (at - k as f64).clamp(0.0, 1.0)
}
