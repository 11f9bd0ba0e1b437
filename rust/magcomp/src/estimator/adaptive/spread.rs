//! Whether a first answer can be trusted at all. While the samples lie in one plane, or in one place, b may be anywhere along
//! a line or on a sphere: a Gaussian about one of these places, however narrow, says nothing. So the first
//! calibration waits until the cloud of the latest samples is thick in every direction.

use super::samples::{SPANS, Samples};

/// Least thickness of the cloud, standard deviation in units (field strengths), and the variances of noise that do not count.
const LEAST: f64 = 0.015;
const NOISE: f64 = 1.3;

/// A free fit to a flat cloud takes noise for shape: the level learned from it may be so much too low.
const HIDDEN: f64 = 3.0;

/// Thickness of a segment's cloud from which its samples come from all around: on a flat arc a wide hypothesis has its
/// minimum far away, and it means nothing.
const AROUND: f64 = 0.1;

/// Whether the samples of the segment come from all around.
pub(super) fn is_around(samples: &Samples) -> bool {
    let (_, covariance) = samples.segment().cloud();
    covariance.symmetric_eigenvalues().min() > AROUND * AROUND
}

/// Whether the latest samples fill space; their noise as learned from the fit and as neighbours differ, variances (units^2).
/// Where orientations are not smooth the latter is more than noise.
pub(super) fn fills_space(samples: &Samples, fitted: f64, differing: f64) -> bool {
    let noise = fitted.max(differing.min(HIDDEN * fitted));
    let (_, covariance) = samples.span(SPANS - 1).cloud();
    covariance.symmetric_eigenvalues().min() > LEAST * LEAST + NOISE * noise
}
