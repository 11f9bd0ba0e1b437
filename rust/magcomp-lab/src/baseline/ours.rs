//! The compensator itself, with any config.

use super::method::Baseline;
use magcomp::nalgebra::Vector3;
use magcomp::{Calibration, Compensator, Config, ConfigError, MagneticSample};

/// A compensator and the calibration it has in force.
#[derive(Clone, Debug)]
pub struct Ours {
    compensator: Compensator,
    calibration: Option<Calibration>,
}

impl Ours {
    /// With a config.
    ///
    /// # Errors
    /// [`ConfigError`].
    pub fn new(config: Config) -> Result<Self, ConfigError> {
        let compensator = Compensator::new(config)?;
        Ok(Self { calibration: compensator.calibration(), compensator })
    }
}

impl Baseline for Ours {
    fn push(&mut self, sample: &MagneticSample) {
        let _ = self.compensator.push(*sample);
        self.calibration = self.compensator.calibration();
    }

    fn correct(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>> {
        self.calibration.map(|calibration| calibration.correct(raw_ut))
    }

    fn calibration(&self) -> Option<Calibration> {
        self.calibration
    }
}
