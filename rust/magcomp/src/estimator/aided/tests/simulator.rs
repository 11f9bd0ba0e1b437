//! A small deterministic world: hand-held tumbling, a disturbed magnetometer, a gyroscope, an accelerometer.

use nalgebra::{Matrix3, Rotation3, Vector3};

use crate::sensing::pairing::{PairedInertial, Rotation};

/// splitmix64 and Box-Muller.
pub(super) struct Random(pub(super) u64);

impl Random {
    pub(super) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(super) fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    pub(super) fn vector(&mut self, sd: f64) -> Vector3<f64> {
        Vector3::new(self.normal() * sd, self.normal() * sd, self.normal() * sd)
    }
}

/// The world and the device in it; public fields may be changed between samples.
pub(super) struct World {
    pub(super) random: Random,
    pub(super) attitude: Rotation3<f64>,
    pub(super) rate: Vector3<f64>,
    /// Rms of the tumbling rate, rad/s; 0 is rest.
    pub(super) tumbling_rad_s: f64,
    /// East, north, up, uT.
    pub(super) field_ut: Vector3<f64>,
    pub(super) soft_iron: Matrix3<f64>,
    pub(super) hard_iron_ut: Vector3<f64>,
    pub(super) noise_ut: f64,
    pub(super) gyro_bias: Vector3<f64>,
    /// What the gyroscope makes of a rate: I for axes that are right.
    pub(super) gyro_axes: Matrix3<f64>,
    /// The device turns about this axis of its own alone, if there is one.
    pub(super) axis: Option<Vector3<f64>>,
    /// Angle of a wobble about all axes beside it, rad rms.
    pub(super) wobble_rad: f64,
    wobble: Vector3<f64>,
    pub(super) time_ns: i64,
}

/// One sample and the truth.
pub(super) struct Sample {
    pub(super) time_ns: i64,
    pub(super) raw_ut: Vector3<f64>,
    pub(super) inertial: PairedInertial,
    pub(super) field_ut: Vector3<f64>,
}

impl World {
    pub(super) fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let hard_iron_ut = random.vector(200.0);
        let e = random.vector(0.05);
        let x = random.vector(0.04);
        Self {
            attitude: Rotation3::new(random.vector(1.0)),
            random,
            rate: Vector3::zeros(),
            tumbling_rad_s: 1.0,
            field_ut: Vector3::new(0.0, 25.0, -43.3),
            soft_iron: Matrix3::new(1.0 + e.x, x.x, x.y, x.x, 1.0 + e.y, x.z, x.y, x.z, 1.0 + e.z),
            hard_iron_ut,
            noise_ut: 0.5,
            gyro_bias: Vector3::new(0.01, -0.02, 0.015),
            gyro_axes: Matrix3::identity(),
            axis: None,
            wobble_rad: 0.0,
            wobble: Vector3::zeros(),
            time_ns: 0,
        }
    }

    /// The next sample, `dt_s` later; the attitude turns by the exact mean rate of the interval.
    pub(super) fn sample(&mut self, dt_s: f64) -> Sample {
        let fade = (-dt_s).exp();
        let sd = self.tumbling_rad_s / 3.0_f64.sqrt();
        let next = if sd > 0.0 {
            self.rate * fade + self.random.vector(sd * (1.0 - fade * fade).sqrt())
        } else {
            Vector3::zeros()
        };
        let next = self.axis.map_or(next, |axis| axis * axis.dot(&next));
        let mut turn = (self.rate + next) * (0.5 * dt_s);
        self.rate = next;
        if self.wobble_rad > 0.0 {
            let fade = (-dt_s / 0.4).exp();
            let wobble =
                self.wobble * fade + self.random.vector(self.wobble_rad / 3.0_f64.sqrt() * (1.0 - fade * fade).sqrt());
            turn += wobble - self.wobble;
            self.wobble = wobble;
        }
        self.attitude *= Rotation3::new(turn);
        self.time_ns += (dt_s * 1e9).round() as i64;
        let field_ut = self.attitude.inverse() * self.field_ut;
        let raw_ut = self.soft_iron * field_ut + self.hard_iron_ut + self.random.vector(self.noise_ut);
        let noise = self.random.vector(0.003);
        let rotation = Rotation {
            increment_rad: self.gyro_axes * turn + (self.gyro_bias + noise) * dt_s,
            rate_rad_s: self.gyro_axes * turn / dt_s + self.gyro_bias + noise,
            variance_rad2: 0.0,
        };
        let up = self.attitude.inverse() * Vector3::new(0.0, 0.0, 9.80665) + self.random.vector(0.05);
        Sample {
            time_ns: self.time_ns,
            raw_ut,
            inertial: PairedInertial { rotation: Some(rotation), up_m_s2: Some(up) },
            field_ut,
        }
    }
}
