//! Zeroing in a Helmholtz coil, as a procedure before the stream: with the Earth's field cancelled the sensor reads b; with
//! known fields along each axis, both ways, it reads the columns of M. Then kept. P readings are averaged each time.

use super::method::Baseline;
use crate::parameters::Parameters;
use crate::random::{Purpose, Random};
use magcomp::nalgebra::{Matrix3, Vector3};
use magcomp::{Calibration, MagneticSample};

/// Readings averaged in each of the seven fields.
const READINGS: usize = 100;
/// Standard deviation of the field that the coil fails to cancel, as a share of the field: errors of the coil's constants
/// and alignment.
const COIL: f64 = 0.002;

/// A calibration from a coil.
#[derive(Clone, Copy, Debug)]
pub struct Helmholtz(Option<Calibration>);

impl Helmholtz {
    /// A sensor of these parameters in a coil, |h| and noise in uT.
    pub fn new(parameters: &Parameters, field_ut: f64, noise_ut: f64, seed: u64) -> Self {
        let mut random = Random::new(seed, Purpose::ConstantField);
        let mut read = |applied_ut: Vector3<f64>| {
            let field = applied_ut + random.normal3() * (COIL * field_ut);
            let clean = parameters.soft_iron * field + parameters.hard_iron * field_ut;
            clean + random.normal3() * (noise_ut / (READINGS as f64).sqrt())
        };
        let b = read(Vector3::zeros());
        let columns = [0, 1, 2].map(|i| {
            let applied = Vector3::ith(i, field_ut);
            (read(applied) - read(-applied)) / (2.0 * field_ut)
        });
        let m = Matrix3::from_columns(&columns);
        Self(Calibration::new((m + m.transpose()) * 0.5, b, field_ut).ok())
    }
}

impl Baseline for Helmholtz {
    fn push(&mut self, _: &MagneticSample) {}

    fn correct(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>> {
        self.0.map(|calibration| calibration.correct(raw_ut))
    }

    fn calibration(&self) -> Option<Calibration> {
        self.0
    }
}
