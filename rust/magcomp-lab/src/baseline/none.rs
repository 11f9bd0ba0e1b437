//! Nothing: the raw sample.

use super::method::Baseline;
use magcomp::MagneticSample;
use magcomp::nalgebra::Vector3;

/// The raw sample.
#[derive(Clone, Copy, Debug, Default)]
pub struct Nothing;

impl Baseline for Nothing {
    fn push(&mut self, _: &MagneticSample) {}

    fn correct(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>> {
        Some(*raw_ut)
    }
}
