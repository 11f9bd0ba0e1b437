//! The simulator: h_m = M h + b + w (eq. 8 with white noise), the truth kept beside every sample.
//!
//! A scenario and its seed name a stream bit for bit. M, b, the place's field and the motion change on their own
//! schedules, so that the truth shows whether the device or the place has changed.

use crate::inertial::InertialSensor;
use crate::motion::{Motion, Trajectory};
use crate::parameters::Parameters;
use crate::random::{Purpose, Random};
use crate::schedule::Schedule;
use crate::time::time_ns;
use magcomp::nalgebra::{Matrix3, UnitQuaternion, Vector3};
use magcomp::{MagneticSample, RotationRateSample, UpSample};

/// White noise of the magnetometer, per axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Noise {
    /// Standard deviation |h| 10^(-SNR/20).
    SnrDb(f64),
    /// Standard deviation, uT.
    Ut(f64),
}

impl Noise {
    /// Standard deviation per axis, uT, in a field of `field_ut`.
    #[must_use]
    pub fn sigma_ut(self, field_ut: f64) -> f64 {
        match self {
            Self::SnrDb(db) => field_ut * 10f64.powf(-db / 20.0),
            Self::Ut(sigma) => sigma,
        }
    }
}

/// Samples hit by something that is not the field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spikes {
    /// Share of the samples, 0 to 1.
    pub share: f64,
    /// Smallest and largest spike, uT; the direction is random.
    pub size_ut: (f64, f64),
}

/// Everything that makes a stream.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Names the random numbers.
    pub seed: u64,
    /// Magnetometer samples.
    pub samples: usize,
    /// Magnetometer samples per second.
    pub rate_hz: f64,
    /// How the device turns.
    pub motion: Motion,
    /// The place's field, uT, east-north-up. The strength at the start is the unit of `parameters`.
    pub world_ut: Schedule<Vector3<f64>>,
    /// M and b over time.
    pub parameters: Schedule<Parameters>,
    /// White noise of the magnetometer.
    pub noise: Noise,
    /// Spikes, if any.
    pub spikes: Option<Spikes>,
    /// The gyroscope, if there is one.
    pub gyroscope: Option<InertialSensor>,
    /// The accelerometer, if there is one.
    pub accelerometer: Option<InertialSensor>,
}

/// A field of this strength (uT) and dip (degrees, positive down) towards magnetic north, east-north-up.
#[must_use]
pub fn world_field_ut(strength_ut: f64, dip_deg: f64) -> Vector3<f64> {
    let (down, north) = dip_deg.to_radians().sin_cos();
    Vector3::new(0.0, north, -down) * strength_ut
}

/// The truth at the time of a magnetometer sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Truth {
    /// The place's field in the device frame, h, uT.
    pub field_ut: Vector3<f64>,
    /// M.
    pub soft_iron: Matrix3<f64>,
    /// b, uT.
    pub hard_iron_ut: Vector3<f64>,
    /// M h + b, uT: the raw sample without noise and spikes.
    pub clean_ut: Vector3<f64>,
    /// Device to east-north-up.
    pub attitude: UnitQuaternion<f64>,
    /// Whether a spike hit.
    pub spike: bool,
}

/// A stream and its truth.
#[derive(Clone, Debug, PartialEq)]
pub struct Simulation {
    /// Samples of the magnetometer.
    pub magnetic: Vec<MagneticSample>,
    /// The truth behind each of them.
    pub truth: Vec<Truth>,
    /// Events of the gyroscope; empty without one.
    pub rotation_rates: Vec<RotationRateSample>,
    /// Events of the accelerometer; empty without one.
    pub ups: Vec<UpSample>,
}

impl Scenario {
    /// The stream this scenario names.
    #[must_use]
    pub fn run(&self) -> Simulation {
        let mut random = Random::new(self.seed, Purpose::Motion);
        self.along(&self.motion.trajectory(self.duration_s(), 1.0 / self.rate_hz, &mut random))
    }

    /// Length, s.
    #[must_use]
    pub fn duration_s(&self) -> f64 {
        self.samples as f64 / self.rate_hz
    }

    /// The stream with this trajectory instead of that of `motion`.
    #[must_use]
    pub fn along(&self, trajectory: &Trajectory) -> Simulation {
        let random = |purpose| Random::new(self.seed, purpose);
        let duration_s = self.duration_s();
        let unit_ut = self.world_ut.start.norm();
        let sigma_ut = self.noise.sigma_ut(unit_ut);
        let (mut noise, mut spikes) = (random(Purpose::MagnetometerNoise), random(Purpose::Spikes));

        let (mut magnetic, mut truth) = (Vec::with_capacity(self.samples), Vec::with_capacity(self.samples));
        for k in 0..self.samples {
            let time_s = k as f64 / self.rate_hz;
            let (attitude, _) = trajectory.at(time_s);
            let Parameters { soft_iron, hard_iron } = self.parameters.at(time_s);
            let field_ut = attitude.inverse() * self.world_ut.at(time_s);
            let hard_iron_ut = hard_iron * unit_ut;
            let clean_ut = soft_iron * field_ut + hard_iron_ut;
            let mut raw_ut = clean_ut + noise.normal3() * sigma_ut;
            let mut spike = false;
            if let Some(Spikes { share, size_ut: (low, high) }) = self.spikes {
                // always three draws, so that the share does not change where the others fall
                let (hit, size, direction) = (spikes.uniform(0.0, 1.0), spikes.uniform(low, high), spikes.direction());
                spike = hit < share;
                raw_ut += direction * if spike { size } else { 0.0 };
            }
            magnetic.push(MagneticSample { time_ns: time_ns(time_s), field_ut: raw_ut });
            truth.push(Truth { field_ut, soft_iron, hard_iron_ut, clean_ut, attitude, spike });
        }
        let rotation_rates = self.gyroscope.map_or_else(Vec::new, |sensor| {
            sensor.rotation_rates(trajectory, duration_s, &mut random(Purpose::GyroscopeNoise))
        });
        let ups = self.accelerometer.map_or_else(Vec::new, |sensor| {
            sensor.ups(trajectory, duration_s, &mut random(Purpose::AccelerometerNoise))
        });
        Simulation { magnetic, truth, rotation_rates, ups }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scenario() -> Scenario {
        Scenario {
            seed: 7,
            samples: 2000,
            rate_hz: 100.0,
            motion: Motion::Tumble,
            world_ut: Schedule::ramp(world_field_ut(50.0, 60.0), 10.0, 2.0, world_field_ut(45.0, 50.0)),
            parameters: Schedule::step(Parameters::none(), 5.0, Parameters::none().times(1.5)),
            noise: Noise::SnrDb(40.0),
            spikes: Some(Spikes { share: 0.02, size_ut: (30.0, 150.0) }),
            gyroscope: Some(InertialSensor { rate_hz: 200.0, ..InertialSensor::gyroscope() }),
            accelerometer: Some(InertialSensor::accelerometer()),
        }
    }

    #[test]
    fn the_same_seed_gives_the_same_bits() {
        assert_eq!(scenario().run(), scenario().run());
        assert_ne!(Scenario { seed: 8, ..scenario() }.run().magnetic, scenario().run().magnetic);
    }

    #[test]
    fn more_noise_does_not_change_the_motion() {
        let other = Scenario { noise: Noise::Ut(3.0), spikes: None, gyroscope: None, ..scenario() }.run();
        assert_eq!(other.truth[1500].attitude, scenario().run().truth[1500].attitude);
    }

    #[test]
    fn noise_and_spikes_are_as_asked() {
        let stream = scenario().run();
        let (mut squares, mut spikes) = (0.0, 0);
        for (sample, truth) in stream.magnetic.iter().zip(&stream.truth) {
            let off = (sample.field_ut - truth.clean_ut).norm();
            if truth.spike {
                spikes += 1;
                assert!((25.0..155.0).contains(&off));
            } else {
                squares += off * off / 3.0;
            }
        }
        assert!((20..=60).contains(&spikes), "{spikes} spikes");
        let sigma = (squares / f64::from(2000 - spikes)).sqrt();
        assert!((sigma / 0.5 - 1.0).abs() < 0.05, "noise {sigma} uT");
    }

    #[test]
    fn the_place_changes_without_the_device() {
        let truth = scenario().run().truth;
        assert!((truth[999].field_ut.norm() - 50.0).abs() < 1e-9);
        assert!((truth[1300].field_ut.norm() - 45.0).abs() < 1e-9);
        assert_eq!(truth[999].soft_iron, truth[1300].soft_iron);
    }

    #[test]
    fn a_delayed_gyroscope_reports_the_past() {
        let late = InertialSensor { delay_s: 0.05, noise: 0.0, ..InertialSensor::gyroscope() };
        let prompt = InertialSensor { delay_s: 0.0, ..late };
        let run = |sensor| Scenario { gyroscope: Some(sensor), ..scenario() }.run().rotation_rates;
        let (late, prompt) = (run(late), run(prompt));
        assert!((late[105].rate_rad_s - prompt[100].rate_rad_s).norm() < 1e-2);
        assert_eq!(late[105].time_ns, 1_050_000_000);
    }
}
