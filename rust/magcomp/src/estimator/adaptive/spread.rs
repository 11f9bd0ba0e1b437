//! Whether a first answer can be trusted at all. While the samples lie in one plane, or in one place, b may be anywhere along
//! a line or on a sphere: a Gaussian about one of these places, however narrow, says nothing. So the first
//! calibration waits until the cloud of the latest samples is thick in every direction.

use super::samples::{SPANS, Samples};

/// Least thickness of the cloud, standard deviation in units (field strengths), and the variances of noise that do not count.
const LEAST: f64 = 0.015;
const NOISE: f64 = 1.3;

/// Whether the latest samples, of noise of this variance (units^2), fill space.
pub(super) fn fills_space(samples: &Samples, noise: f64) -> bool {
    let (_, covariance) = samples.span(SPANS - 1).cloud();
    covariance.symmetric_eigenvalues().min() > LEAST * LEAST + NOISE * noise
}
