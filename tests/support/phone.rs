//! A phone whose truth is known, for tests that need all three sensors.

use magcomp::nalgebra::{Rotation3, UnitQuaternion, Vector3};
use magcomp::{Calibration, Compensator, MagneticSample, Reading, RotationRateSample, UpSample};

/// Between two samples, ns.
pub const PERIOD_NS: i64 = 10_000_000;

/// A phone in a hand at 100 Hz, with a gyroscope and an accelerometer.
#[derive(Clone)]
pub struct Phone {
    attitude: Rotation3<f64>,
    /// The place's field, east north up, uT.
    pub field_ut: Vector3<f64>,
    /// What the phone does to it.
    pub truth: Calibration,
    noise: u64,
    /// Of the latest sample, ns.
    pub time_ns: i64,
    /// Whether its events come.
    pub gyroscope: bool,
    /// Whether its events come.
    pub accelerometer: bool,
    /// It is turned about all axes; else it lies still.
    pub moving: bool,
}

impl Phone {
    /// One that moves, in a field that dips by 60 deg.
    pub fn new(seed: u64, truth: Calibration) -> Self {
        Self {
            attitude: Rotation3::identity(),
            field_ut: Vector3::new(0.0, 0.5, -0.75_f64.sqrt()) * truth.field_strength_ut(),
            truth,
            noise: seed,
            time_ns: 0,
            gyroscope: true,
            accelerometer: true,
            moving: true,
        }
    }

    /// Noise of variance 1, near enough to normal: a phone can be cloned, a `Random` can't.
    fn normal3(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| {
            let uniform = |_| {
                self.noise = self.noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.noise >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(uniform).sum::<f64>() - 6.0
        })
    }

    /// The next sample, after the events that belong to it.
    pub fn sample(&mut self, compensator: &mut Compensator) -> MagneticSample {
        let t = self.time_ns as f64 * 1e-9;
        let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin());
        let rate = if self.moving { rate } else { Vector3::zeros() };
        self.attitude *= Rotation3::new(rate * 0.01);
        self.time_ns += PERIOD_NS;
        let time_ns = self.time_ns;
        let rate_rad_s = rate + self.normal3() * 0.003 + Vector3::new(0.01, -0.02, 0.015);
        let up_m_s2 = self.attitude.inverse() * Vector3::new(0.0, 0.0, 9.81) + self.normal3() * 0.05;
        if self.gyroscope {
            let _ = compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s });
        }
        if self.accelerometer {
            let _ = compensator.push_up(UpSample { time_ns, up_m_s2 });
        }
        let carried = self.attitude.inverse() * self.field_ut;
        MagneticSample { time_ns, field_ut: self.truth.distort(&carried) + self.normal3() * 0.4 }
    }

    /// One sample more.
    pub fn advance(&mut self, compensator: &mut Compensator) -> Reading {
        let sample = self.sample(compensator);
        compensator.push(sample)
    }

    /// That many samples more.
    pub fn run(&mut self, compensator: &mut Compensator, samples: usize) {
        (0..samples).for_each(|_| _ = self.advance(compensator));
    }

    /// Device to east, magnetic north, up.
    pub fn attitude(&self) -> UnitQuaternion<f64> {
        UnitQuaternion::from_rotation_matrix(&self.attitude)
    }

    /// The heading of its top edge, degrees clockwise from magnetic north.
    pub fn heading_deg(&self) -> f64 {
        let top = self.attitude * Vector3::y();
        top.x.atan2(top.y).to_degrees().rem_euclid(360.0)
    }
}
