//! Phone-like streams of 60 s: a device of usual soft and hard iron, its motion, and one change in the middle.
//!
//! M = I + e, e_ii within 3 to 10 %, e_ij within 2 to 7 %, b 20 to 40 uT on each axis, |h| = 50 uT, dip 60 deg: the
//! yardsticks of the aided estimator, one recipe for every figure that is quoted.

use crate::inertial::InertialSensor;
use crate::motion::Motion;
use crate::parameters::Parameters;
use crate::random::{Purpose, Random};
use crate::schedule::{Change, Schedule};
use crate::simulate::{Noise, Scenario, Spikes, world_field_ut};
use clap::ValueEnum;
use magcomp::nalgebra::{Matrix3, Vector3};

/// Field of the place, uT.
pub const FIELD_UT: f64 = 50.0;
/// Its dip, degrees.
const DIP_DEG: f64 = 60.0;
/// Length of a stream, s.
pub const DURATION_S: f64 = 60.0;
/// When it changes, s.
pub const CHANGE_S: f64 = 30.0;
/// Hard iron that a walker's magnet or cover adds, uT.
const OFFSET_STEP_UT: Vector3<f64> = Vector3::new(20.0, -15.0, 10.0);
/// A change of the place: its size, uT ...
const PLACE_UT: f64 = 20.0;
/// ... how long it lasts, s ...
pub const PLACE_S: f64 = 10.0;
/// ... and how long it takes to come and to go, s: the time to walk into it.
const PLACE_RAMP_S: f64 = 0.5;

/// A drift of b over the whole stream: this far along a random direction, uT a second.
const DRIFT_UT_S: f64 = 0.5;

/// What changes at [`CHANGE_S`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PhoneChange {
    /// Nothing
    #[default]
    Nothing,
    /// The device: M - I and b become 1.5 times what they were
    Parameters,
    /// The device: b steps by (20, -15, 10) uT
    Offset,
    /// The place: 20 uT in a random direction of the world for 10 s
    Place,
    /// The device: b drifts by 0.5 uT/s in a random direction, from the start to the end
    Drift,
}

/// A phone, its sensors and the change that it goes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Phone {
    /// Names the random numbers.
    pub seed: u64,
    /// Length, s.
    pub duration_s: f64,
    /// How it turns.
    pub motion: Motion,
    /// What changes.
    pub change: PhoneChange,
    /// Signal-to-noise ratio of the magnetometer, dB.
    pub snr_db: f64,
    /// Share of samples hit by a spike of 30 to 150 uT.
    pub spikes: f64,
    /// Samples a second of every sensor.
    pub rate_hz: f64,
    /// Gyroscope bias, deg/s, in a random direction.
    pub gyro_bias_deg_s: f64,
    /// Error of the gyroscope's scale, percent.
    pub gyro_scale_percent: f64,
    /// How late the gyroscope's events are stamped, ms.
    pub gyro_late_ms: f64,
    /// How far each axis of the gyroscope is off along each axis, degrees rms: random cross-axis and scale errors, drawn for each seed.
    pub gyro_skew_deg: f64,
}

impl Default for Phone {
    fn default() -> Self {
        Self {
            seed: 1,
            duration_s: DURATION_S,
            motion: Motion::Tumble,
            change: PhoneChange::Nothing,
            snr_db: 40.0,
            spikes: 0.0,
            rate_hz: 100.0,
            gyro_bias_deg_s: 0.0,
            gyro_scale_percent: 0.0,
            gyro_late_ms: 0.0,
            gyro_skew_deg: 0.0,
        }
    }
}

impl Phone {
    /// In a few words, for titles.
    #[must_use]
    pub fn describe(&self) -> String {
        let motion = match self.motion {
            Motion::Pedestrian | Motion::Stroll => "walking",
            Motion::Tumble => "tumbling",
            _ => "other motion",
        };
        let change = match self.change {
            PhoneChange::Nothing => "nothing changes",
            PhoneChange::Parameters => "all nine parameters step by 50 %",
            PhoneChange::Offset => "b steps by (20, -15, 10) uT",
            PhoneChange::Place => "the place's field changes by 20 uT for 10 s",
            PhoneChange::Drift => "b drifts by 0.5 uT/s",
        };
        let mut text = format!("{motion}, {change}, {} dB, {} Hz", self.snr_db, self.rate_hz);
        for (value, what) in [
            (self.gyro_bias_deg_s, "deg/s gyroscope bias"),
            (self.gyro_scale_percent, "% gyroscope scale"),
            (self.gyro_late_ms, "ms late"),
            (self.gyro_skew_deg, "deg rms gyroscope skew"),
            (self.spikes * 100.0, "% spikes"),
        ] {
            if value != 0.0 {
                text += &format!(", {value} {what}");
            }
        }
        text
    }

    /// The scenario of this phone.
    #[must_use]
    pub fn scenario(&self) -> Scenario {
        let mut random = Random::new(self.seed, Purpose::Parameters);
        let start = parameters(&mut random);
        let direction = random.direction();
        let bias = random.direction() * self.gyro_bias_deg_s.to_radians();
        let skew = Matrix3::from_fn(|_, _| random.normal()) * self.gyro_skew_deg.to_radians();
        let device = |to| Schedule::step(start, CHANGE_S, to);
        let identity = Matrix3::identity();
        let world_ut = world_field_ut(FIELD_UT, DIP_DEG);
        let place = |at_s, to| Change { at_s, over_s: PLACE_RAMP_S, to };
        Scenario {
            seed: self.seed,
            samples: (self.duration_s * self.rate_hz).round() as usize,
            rate_hz: self.rate_hz,
            motion: self.motion,
            world_ut: match self.change {
                PhoneChange::Place => Schedule {
                    start: world_ut,
                    changes: vec![
                        place(CHANGE_S, world_ut + direction * PLACE_UT),
                        place(CHANGE_S + PLACE_S, world_ut),
                    ],
                },
                _ => Schedule::constant(world_ut),
            },
            parameters: match self.change {
                PhoneChange::Nothing | PhoneChange::Place => Schedule::constant(start),
                PhoneChange::Parameters => device(Parameters {
                    soft_iron: identity + (start.soft_iron - identity) * 1.5,
                    hard_iron: start.hard_iron * 1.5,
                }),
                PhoneChange::Offset => {
                    device(Parameters { hard_iron: start.hard_iron + OFFSET_STEP_UT / FIELD_UT, ..start })
                }
                PhoneChange::Drift => {
                    let drift = direction * (DRIFT_UT_S * self.duration_s / FIELD_UT);
                    let end = Parameters { hard_iron: start.hard_iron + drift, ..start };
                    Schedule::ramp(start, 0.0, self.duration_s, end)
                }
            },
            noise: Noise::SnrDb(self.snr_db),
            spikes: (self.spikes > 0.0).then_some(Spikes { share: self.spikes, size_ut: (30.0, 150.0) }),
            gyroscope: Some(InertialSensor {
                rate_hz: self.rate_hz,
                bias,
                scale: Vector3::repeat(1.0 + self.gyro_scale_percent / 100.0),
                skew,
                delay_s: self.gyro_late_ms / 1000.0,
                ..InertialSensor::gyroscope()
            }),
            accelerometer: Some(InertialSensor { rate_hz: self.rate_hz, ..InertialSensor::accelerometer() }),
        }
    }
}

/// A phone's soft and hard iron, |h| = 1.
fn parameters(random: &mut Random) -> Parameters {
    let mut signed = |low, high| random.uniform(low, high) * random.sign();
    let diagonal = [(); 3].map(|()| 1.0 + signed(0.03, 0.10));
    let cross = [(); 3].map(|()| signed(0.02, 0.07));
    let offset = [(); 3].map(|()| signed(20.0, 40.0) / FIELD_UT);
    let theta = [diagonal, cross, offset].concat();
    Parameters::from_theta(std::array::from_fn(|i| theta[i]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_change_changes_what_it_says() {
        let at = |change, time_s| {
            let scenario = Phone { change, seed: 4, ..Phone::default() }.scenario();
            (scenario.parameters.at(time_s), scenario.world_ut.at(time_s))
        };
        let (before, world) = at(PhoneChange::Nothing, 59.0);
        let offset_ut = before.hard_iron * FIELD_UT;
        assert!(offset_ut.iter().all(|b| (20.0..=40.0).contains(&b.abs())), "{offset_ut}");
        assert!((before.soft_iron - Matrix3::identity()).amax() <= 0.1);
        let (after, same) = at(PhoneChange::Parameters, 31.0);
        assert_eq!((after.hard_iron, same), (before.hard_iron * 1.5, world));
        let (after, _) = at(PhoneChange::Offset, 31.0);
        assert!(((after.hard_iron - before.hard_iron) * FIELD_UT - OFFSET_STEP_UT).norm() < 1e-9);
        let (after, other) = at(PhoneChange::Place, 35.0);
        assert_eq!(after, before);
        assert!(((other - world).norm() - PLACE_UT).abs() < 1e-9);
        assert_eq!(at(PhoneChange::Place, 41.0).1, world);
        let (after, _) = at(PhoneChange::Drift, 42.0);
        assert!(((after.hard_iron - before.hard_iron).norm() * FIELD_UT - 0.5 * 42.0).abs() < 1e-9);
    }
}
