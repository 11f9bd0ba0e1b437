//! One run of the step experiment, sample by sample.

use crate::parameters::Parameters;
use crate::simulate::Truth;
use magcomp::nalgebra::Vector3;
use magcomp::{Calibration, MagneticSample, Reading};
use magcomp_replay::off_deg;

/// Field of the simulation, uT: so that 1.5 M is still a plausible sensor.
pub const FIELD_UT: f64 = 40.0;
/// Samples before the step.
pub const BEFORE: usize = 2500;
/// Parameters below this have no relative error, field strengths.
const NEGLIGIBLE: f64 = 1e-3;
/// sin(theta) from which azimuth errors count.
const OFF_THE_POLES: f64 = 0.5;

/// One run, sample by sample.
#[derive(Clone, Debug, Default)]
pub struct Trace {
    /// True parameters at each sample; of the first run only.
    pub truth: Vec<[f64; 9]>,
    /// (azimuth, elevation) error of the method, degrees; azimuth NaN near the poles.
    pub method_deg: Vec<(f64, f64)>,
    /// The same of noise-free samples: the error of the calibration alone.
    pub clean_deg: Vec<(f64, f64)>,
    /// As `method_deg`, with the constant-field parameters kept.
    pub kept_deg: Vec<(f64, f64)>,
    /// Relative errors of the parameters at each sample.
    pub(super) relative: Vec<[f32; 9]>,
    pub(super) sigma_t: Vec<f64>,
    pub(super) window: Vec<f64>,
}

impl Trace {
    pub fn add(
        &mut self,
        sample: &MagneticSample,
        truth: &Truth,
        reading: &Reading,
        calibration: &Calibration,
        constant: &Calibration,
    ) {
        let estimated = Parameters::of(calibration).theta();
        let hard_iron = truth.hard_iron_ut / FIELD_UT;
        let true_theta = Parameters { soft_iron: truth.soft_iron, hard_iron }.theta();
        self.relative.push(std::array::from_fn(|i| ((estimated[i] - true_theta[i]) / size(true_theta[i])) as f32));
        self.truth.push(true_theta);
        self.method_deg.push(angle_errors_deg(&calibration.correct(&sample.field_ut), &truth.field_ut));
        self.clean_deg.push(angle_errors_deg(&calibration.correct(&truth.clean_ut), &truth.field_ut));
        self.kept_deg.push(angle_errors_deg(&constant.correct(&sample.field_ut), &truth.field_ut));
        self.sigma_t.push(reading.sigma_t.unwrap_or(f64::NAN));
        self.window.push(reading.window as f64);
    }

    /// Relative error of a parameter at a sample after the step.
    pub(super) fn relative(&self, after: usize, parameter: usize) -> f64 {
        f64::from(self.relative[BEFORE + after][parameter])
    }
}

/// The size that an error of a parameter is relative to.
pub(super) fn size(true_value: f64) -> f64 {
    if true_value.abs() < NEGLIGIBLE { 1.0 } else { true_value.abs() }
}

/// (azimuth, elevation) of `found` less that of `truth`, degrees.
fn angle_errors_deg(found: &Vector3<f64>, truth: &Vector3<f64>) -> (f64, f64) {
    let azimuth = |h: &Vector3<f64>| h.y.atan2(h.x).to_degrees();
    let elevation = |h: &Vector3<f64>| h.x.hypot(h.y).atan2(h.z).to_degrees();
    let off = off_deg(azimuth(found), azimuth(truth));
    let counts = truth.x.hypot(truth.y) >= OFF_THE_POLES * truth.norm();
    (if counts { off } else { f64::NAN }, elevation(found) - elevation(truth))
}
