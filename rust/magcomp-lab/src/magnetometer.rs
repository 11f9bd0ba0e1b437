//! The simulated magnetometer: its rate, noise, stamps and limits, and what loggers and apps make of its readings.

use magcomp::MagneticSample;
use magcomp::nalgebra::{Matrix3, Vector3};

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

/// How a logger fills the time between two measured values; one sample in so many is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filled {
    /// With a straight line from one to the next.
    Interpolated(usize),
    /// With the latest.
    Held(usize),
}

impl Filled {
    /// Fills in place what is not measured. Behind the last measured value there is nothing but that.
    pub(crate) fn fill(self, samples: &mut [MagneticSample]) {
        let (Self::Interpolated(every) | Self::Held(every)) = self;
        let measured: Vec<Vector3<f64>> = samples.iter().step_by(every).map(|sample| sample.field_ut).collect();
        for (k, sample) in samples.iter_mut().enumerate() {
            let (at, share) = (k / every, (k % every) as f64 / every as f64);
            let next = measured.get(at + 1).filter(|_| matches!(self, Self::Interpolated(_)));
            sample.field_ut = next.map_or(measured[at], |next| measured[at].lerp(next, share));
        }
    }
}

/// The magnetometer and its oddities.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Magnetometer {
    /// Samples a second.
    pub rate_hz: f64,
    /// White noise.
    pub noise: Noise,
    /// Spikes, if any.
    pub spikes: Option<Spikes>,
    /// How much later than it is measured a sample is stamped, s ...
    pub late_s: f64,
    /// ... and up to how much more, at random, s.
    pub jitter_s: f64,
    /// Share of samples that are missing.
    pub missing: f64,
    /// Steps of the reading, uT; 0 for none.
    pub quantum_ut: f64,
    /// Where each axis saturates softly, uT.
    pub soft_limits_ut: Option<Vector3<f64>>,
    /// Where each axis is cut off, uT.
    pub full_scale_ut: Option<f64>,
    /// The axes that measure, in the device's; the identity for a sensor without such errors.
    pub axes: Matrix3<f64>,
    /// What the app makes of a reading: axes, sign and unit; the identity where it reads them rightly.
    pub read_as: Matrix3<f64>,
    /// Each second sample comes without b: calibrated and uncalibrated ones in one stream.
    pub is_mixed: bool,
    /// Fewer values are measured than samples are delivered.
    pub filled: Option<Filled>,
}

impl Magnetometer {
    /// One without oddities.
    pub fn plain(rate_hz: f64, noise: Noise) -> Self {
        Self {
            rate_hz,
            noise,
            spikes: None,
            late_s: 0.0,
            jitter_s: 0.0,
            missing: 0.0,
            quantum_ut: 0.0,
            soft_limits_ut: None,
            full_scale_ut: None,
            axes: Matrix3::identity(),
            read_as: Matrix3::identity(),
            is_mixed: false,
            filled: None,
        }
    }
}
