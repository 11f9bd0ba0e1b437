//! A phone's sensors: what is fixed, and between what limits the errors of one phone are drawn.

use crate::inertial::{Fault, InertialSensor};
use crate::random::Random;
use crate::simulate::{Magnetometer, Noise};
use magcomp::nalgebra::{Matrix3, Vector3};

/// A phone's sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sensors {
    /// The magnetometer.
    pub magnetometer: Magnetometer,
    /// How far its axes may lean towards each other, degrees.
    pub leaning_deg: f64,
    /// Whether there is a gyroscope.
    pub has_gyroscope: bool,
    /// Whether there is an accelerometer.
    pub has_accelerometer: bool,
    /// Events of the gyroscope a second.
    pub gyro_hz: f64,
    /// Its bias in a random direction, between these, deg/s.
    pub gyro_bias_deg_s: (f64, f64),
    /// How fast the bias walks, deg/s a root second.
    pub gyro_walk_deg_s: f64,
    /// What each axis reads of what it should, 1: one that an app has flipped reads -1, a dead one 0.
    pub gyro_axes: [f64; 3],
    /// It says nothing at the end of each so many seconds, for a time between these, s.
    pub gyro_silent_s: Option<(f64, (f64, f64))>,
    /// What the app makes of its readings: axes, sign and unit.
    pub gyro_read_as: Matrix3<f64>,
    /// What befalls it, and from when on, s; the direction of a bias is drawn.
    pub gyro_fault: Option<(f64, Fault)>,
    /// Error of its scale on all axes, a share ...
    pub gyro_scale: f64,
    /// ... and on each axis at most, a share.
    pub gyro_axis_scale: f64,
    /// How far each axis leans towards the others at most, degrees.
    pub gyro_lean_deg: f64,
    /// Its white noise, rad/s.
    pub gyro_noise: f64,
    /// How late its events are stamped, s.
    pub gyro_late_s: f64,
    /// Events of the accelerometer a second.
    pub accel_hz: f64,
    /// Its white noise, m/s^2.
    pub accel_noise: f64,
    /// Its bias in a random direction, m/s^2.
    pub accel_bias: f64,
    /// What the app makes of its readings: axes, sign and unit.
    pub accel_read_as: Matrix3<f64>,
    /// What befalls it, and from when on, s.
    pub accel_fault: Option<(f64, Fault)>,
}

impl Sensors {
    /// A phone's without errors but noise: 0.5 uT of 50, 0.003 rad/s, 0.05 m/s^2, all at 100 Hz.
    pub fn plain() -> Self {
        Self {
            magnetometer: Magnetometer::plain(100.0, Noise::SnrDb(40.0)),
            leaning_deg: 0.0,
            has_gyroscope: true,
            has_accelerometer: true,
            gyro_hz: 100.0,
            gyro_bias_deg_s: (0.0, 0.0),
            gyro_walk_deg_s: 0.0,
            gyro_axes: [1.0; 3],
            gyro_silent_s: None,
            gyro_read_as: Matrix3::identity(),
            gyro_fault: None,
            gyro_scale: 0.0,
            gyro_axis_scale: 0.0,
            gyro_lean_deg: 0.0,
            gyro_noise: 0.003,
            gyro_late_s: 0.0,
            accel_hz: 100.0,
            accel_noise: 0.05,
            accel_bias: 0.0,
            accel_read_as: Matrix3::identity(),
            accel_fault: None,
        }
    }

    /// A phone's with the errors that phones have.
    pub fn carried() -> Self {
        Self {
            magnetometer: Magnetometer {
                late_s: 0.005,
                quantum_ut: 0.15,
                ..Magnetometer::plain(100.0, Noise::Ut(0.4))
            },
            gyro_bias_deg_s: (0.5, 3.0),
            gyro_walk_deg_s: 0.01,
            gyro_axis_scale: 0.01,
            gyro_lean_deg: 1.0,
            gyro_noise: 0.1_f64.to_radians(),
            accel_noise: 0.04,
            accel_bias: 0.08,
            ..Self::plain()
        }
    }

    /// The same without gyroscope.
    pub fn without_gyroscope(self) -> Self {
        Self { has_gyroscope: false, ..self }
    }

    /// Events of the magnetometer and the gyroscope a second. Those of a faster gyroscope are means over a shorter time, and noisier.
    pub fn at_rates(mut self, magnetometer_hz: f64, gyro_hz: f64) -> Self {
        self.magnetometer.rate_hz = magnetometer_hz;
        Self { gyro_hz, gyro_noise: self.gyro_noise * (gyro_hz / self.gyro_hz).sqrt(), ..self }
    }

    /// All at this rate.
    pub fn at_rate(mut self, rate_hz: f64) -> Self {
        self.magnetometer.rate_hz = rate_hz;
        Self { gyro_hz: rate_hz, accel_hz: rate_hz, ..self }
    }

    /// The sensors of one phone.
    pub(super) fn draw(&self, random: &mut Random) -> (Magnetometer, Option<InertialSensor>, Option<InertialSensor>) {
        let bias = random.direction() * random.uniform(self.gyro_bias_deg_s.0, self.gyro_bias_deg_s.1).to_radians();
        let (scale, lean) = (self.gyro_axis_scale, self.gyro_lean_deg.to_radians());
        let skew = Matrix3::from_fn(|i, j| random.uniform(-1.0, 1.0) * if i == j { scale } else { lean });
        let gyroscope = InertialSensor {
            rate_hz: self.gyro_hz,
            noise: self.gyro_noise,
            bias,
            bias_walk: self.gyro_walk_deg_s.to_radians(),
            scale: Vector3::from(self.gyro_axes) * (1.0 + self.gyro_scale),
            // a dead axis reads nothing of the others either
            skew: Matrix3::from_diagonal(&Vector3::from(self.gyro_axes)) * skew,
            delay_s: self.gyro_late_s,
            silent_s: self.gyro_silent_s,
            read_as: self.gyro_read_as,
            fault: None,
        };
        let accelerometer = InertialSensor {
            rate_hz: self.accel_hz,
            noise: self.accel_noise,
            bias: random.direction() * self.accel_bias,
            read_as: self.accel_read_as,
            fault: self.accel_fault,
            ..InertialSensor::accelerometer()
        };
        let [a, b, c] = [(); 3].map(|()| (random.uniform(-1.0, 1.0) * self.leaning_deg).to_radians());
        let axes = Matrix3::new(1.0, 0.0, 0.0, a.sin(), a.cos(), 0.0, b.sin(), c.sin(), 1.0);
        let magnetometer = Magnetometer { axes, ..self.magnetometer };
        // drawn last, so that it changes nothing of the others
        let fault = self.gyro_fault.map(|(from_s, fault)| (from_s, fault.along(&random.direction())));
        let gyroscope = InertialSensor { fault, ..gyroscope };
        (magnetometer, self.has_gyroscope.then_some(gyroscope), self.has_accelerometer.then_some(accelerometer))
    }
}
