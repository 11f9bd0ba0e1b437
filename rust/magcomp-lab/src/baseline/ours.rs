//! The compensator itself, with any config.

use super::method::Baseline;
use magcomp::nalgebra::Vector3;
use magcomp::{Calibration, Compensator, Config, ConfigError, MagneticSample, RotationRateSample, UpSample};

/// A compensator and its answer to the latest sample.
#[derive(Clone, Debug)]
pub struct Ours {
    compensator: Compensator,
    calibration: Option<Calibration>,
    /// The corrected sample that it published.
    field_ut: Option<Vector3<f64>>,
    /// Magnetic north in the device, by the published attitude.
    north: Option<Vector3<f64>>,
    sigma_deg: Option<f64>,
    gives_attitude: bool,
}

impl Ours {
    /// Judged by the calibration in force.
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        let compensator = Compensator::new(config)?;
        let calibration = compensator.calibration();
        Ok(Self { compensator, calibration, field_ut: None, north: None, sigma_deg: None, gives_attitude: false })
    }

    /// Judged by the attitude that it publishes.
    pub fn attitude(config: Config) -> Result<Self, ConfigError> {
        Ok(Self { gives_attitude: true, ..Self::new(config)? })
    }
}

impl Baseline for Ours {
    fn push_rate(&mut self, sample: &RotationRateSample) {
        let _ = self.compensator.push_rotation_rate(*sample);
    }

    fn push_up(&mut self, sample: &UpSample) {
        let _ = self.compensator.push_up(*sample);
    }

    fn push(&mut self, sample: &MagneticSample) {
        let reading = self.compensator.push(*sample);
        self.calibration = self.compensator.calibration();
        self.field_ut = reading.field_ut;
        self.sigma_deg = reading.heading.and_then(|heading| heading.heading_sigma_deg);
        self.north = reading.attitude.map(|attitude| attitude.to_world.inverse() * Vector3::y());
    }

    fn correct(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>> {
        if self.gives_attitude { self.north } else { self.calibration.map(|calibration| calibration.correct(raw_ut)) }
    }

    fn latest(&self, _: &Vector3<f64>) -> Option<Vector3<f64>> {
        if self.gives_attitude { self.north } else { self.field_ut }
    }

    fn sigma_deg(&self) -> Option<f64> {
        self.sigma_deg
    }

    fn calibration(&self) -> Option<Calibration> {
        self.calibration
    }
}
