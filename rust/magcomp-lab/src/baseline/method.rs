//! The interface of every method to compare with.

use magcomp::nalgebra::Vector3;
use magcomp::{Calibration, MagneticSample, RotationRateSample, UpSample};

/// Something that corrects a magnetometer, sample by sample, with nothing later than its own sample.
pub trait Baseline {
    /// The true direction of the field at the next sample: for one that learns from it.
    fn teach(&mut self, _direction: Vector3<f64>) {}

    /// A rotation rate: for one that takes the gyroscope.
    fn push_rate(&mut self, _sample: &RotationRateSample) {}

    /// An accelerometer sample, Android's sign: for one that takes it.
    fn push_up(&mut self, _sample: &UpSample) {}

    /// One raw sample.
    fn push(&mut self, sample: &MagneticSample);

    /// The corrected vector of a raw one by the method's present state, uT. A method that gives an attitude answers with its
    /// north, of length 1, whatever the raw vector. None while the method has no answer.
    fn correct(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>>;

    /// The method's answer to the latest sample, whose raw vector this is.
    fn latest(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>> {
        self.correct(raw_ut)
    }

    /// One standard deviation of the latest heading, degrees, where the method tells one.
    fn sigma_deg(&self) -> Option<f64> {
        None
    }

    /// Its M, b and field strength, where it has such.
    fn calibration(&self) -> Option<Calibration> {
        None
    }
}

/// The raw sample.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nothing;

impl Baseline for Nothing {
    fn push(&mut self, _: &MagneticSample) {}

    fn correct(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>> {
        Some(*raw_ut)
    }
}
