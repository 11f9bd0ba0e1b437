//! What every method to compare with does.

use magcomp::nalgebra::Vector3;
use magcomp::{Calibration, MagneticSample};

/// Something that corrects a magnetometer, sample by sample, with nothing later than its own sample.
pub trait Baseline {
    /// The true direction of the field at the next sample: for one that learns from it.
    fn teach(&mut self, _direction: Vector3<f64>) {}

    /// One raw sample.
    fn push(&mut self, sample: &MagneticSample);

    /// What it would make of a raw vector now, uT; None while it knows nothing.
    fn correct(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>>;

    /// Its M, b and field strength, where it has such.
    fn calibration(&self) -> Option<Calibration> {
        None
    }
}
