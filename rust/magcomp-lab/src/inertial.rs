//! Gyroscope and accelerometer that belong to a motion: each event reports the truth of `delay_s` ago, times its scale and skew,
//! plus a bias that may walk and white noise, at a rate of its own. An accelerometer feels the acceleration of the motion too.

use crate::motion::Trajectory;
use crate::random::Random;
use magcomp::nalgebra::{Matrix3, Vector3};
use magcomp::{RotationRateSample, UpSample};
use magcomp_recordings::time::time_ns;

/// Standard gravity, m/s^2.
pub const GRAVITY_M_S2: f64 = 9.806_65;

/// The errors and the rate of a gyroscope (units: rad/s) or an accelerometer (units: m/s^2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct InertialSensor {
    /// Events per second.
    pub rate_hz: f64,
    /// Standard deviation of the white noise per axis, in the sensor's unit.
    pub noise: f64,
    /// Constant bias, in the sensor's unit.
    pub bias: Vector3<f64>,
    /// How fast the bias walks, in the sensor's unit a root second.
    pub bias_walk: f64,
    /// Reading over truth, per axis.
    pub scale: Vector3<f64>,
    /// Cross-axis and scale errors of one device, rows first: the share of each true component that an axis reads besides
    /// its own. Zero for a sensor without such errors.
    pub skew: Matrix3<f64>,
    /// How much later than its truth an event is stamped, s; may be negative.
    pub delay_s: f64,
    /// It says nothing at the end of each so many seconds, for a time between these, s, all of which come up alike.
    pub silent_s: Option<(f64, (f64, f64))>,
    /// What the app makes of a reading: axes, sign and unit; the identity where it reads them rightly.
    pub read_as: Matrix3<f64>,
    /// What befalls it, and from when on, s.
    pub fault: Option<(f64, Fault)>,
}

/// What befalls a sensor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// It reads exact zeros.
    Zeros,
    /// It repeats its last reading.
    Frozen,
    /// Its bias steps by this, in the sensor's unit.
    Biased(Vector3<f64>),
}

impl Fault {
    /// The same in this direction, of length 1.
    pub(crate) fn along(self, direction: &Vector3<f64>) -> Self {
        match self {
            Self::Biased(by) => Self::Biased(direction * by.norm()),
            other => other,
        }
    }

    /// What is read: `last` is the last reading before it.
    fn read(self, reading: Vector3<f64>, last: Vector3<f64>) -> Vector3<f64> {
        match self {
            Self::Zeros => Vector3::zeros(),
            Self::Frozen => last,
            Self::Biased(by) => reading + by,
        }
    }
}

impl InertialSensor {
    /// A phone's gyroscope: 100 Hz, 0.003 rad/s noise, no bias.
    pub fn gyroscope() -> Self {
        Self {
            rate_hz: 100.0,
            noise: 0.003,
            bias: Vector3::zeros(),
            bias_walk: 0.0,
            scale: Vector3::repeat(1.0),
            skew: Matrix3::zeros(),
            delay_s: 0.0,
            silent_s: None,
            read_as: Matrix3::identity(),
            fault: None,
        }
    }

    /// A phone's accelerometer: 100 Hz, 0.05 m/s^2 noise, no bias.
    pub fn accelerometer() -> Self {
        Self { noise: 0.05, ..Self::gyroscope() }
    }

    /// (time, reading) of every event up to `duration_s`, for a true value over time.
    fn events(
        &self,
        duration_s: f64,
        truth: impl Fn(f64) -> Vector3<f64>,
        random: &mut Random,
    ) -> impl Iterator<Item = (i64, Vector3<f64>)> {
        let count = (duration_s * self.rate_hz).ceil() as usize + 1;
        let (mut bias, walk) = (self.bias, self.bias_walk / self.rate_hz.sqrt());
        // a dead axis reads its bias, to the last bit
        let lives = self.scale.map(|scale| f64::from(u8::from(scale != 0.0)));
        let mut last = Vector3::zeros();
        (0..count).filter_map(move |k| {
            let time_s = k as f64 / self.rate_hz;
            let truth = truth(time_s - self.delay_s);
            let read = truth.component_mul(&self.scale) + self.skew * truth;
            if walk > 0.0 {
                bias += random.normal3() * walk;
            }
            let strayed = bias - self.bias + random.normal3() * self.noise;
            let reading = read + self.bias + strayed.component_mul(&lives);
            let reading = match self.fault.filter(|(from_s, _)| time_s >= *from_s) {
                Some((_, fault)) => fault.read(reading, last),
                None => {
                    last = reading;
                    reading
                }
            };
            (!self.is_silent(time_s)).then(|| (time_ns(time_s), self.read_as * reading))
        })
    }

    fn is_silent(&self, time_s: f64) -> bool {
        self.silent_s.is_some_and(|(every_s, (least_s, most_s))| {
            // multiples of the golden ratio fall evenly between 0 and 1
            let share = ((time_s / every_s).floor() * 0.618_033_988_749_895).fract();
            time_s % every_s > every_s - (least_s + (most_s - least_s) * share)
        })
    }

    /// As a gyroscope: body rates of a trajectory.
    pub fn rotation_rates(
        &self,
        trajectory: &Trajectory,
        duration_s: f64,
        random: &mut Random,
    ) -> Vec<RotationRateSample> {
        self.events(duration_s, |time_s| trajectory.rate_read(time_s), random)
            .map(|(time_ns, rate_rad_s)| RotationRateSample { time_ns, rate_rad_s })
            .collect()
    }

    /// As an accelerometer: up in the device frame of a trajectory, and its acceleration.
    pub fn ups(&self, trajectory: &Trajectory, duration_s: f64, random: &mut Random) -> Vec<UpSample> {
        let up = Vector3::z() * GRAVITY_M_S2;
        let felt = |time_s| trajectory.at(time_s).0.inverse() * (up + trajectory.acceleration(time_s));
        self.events(duration_s, felt, random).map(|(time_ns, up_m_s2)| UpSample { time_ns, up_m_s2 }).collect()
    }
}
