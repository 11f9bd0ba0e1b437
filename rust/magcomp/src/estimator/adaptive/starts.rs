//! Where a fit may start besides where it stands. A short arc is fitted by ellipsoids on either side of it, so that the
//! cost has several minima: with T held, spheres of radius 1 (seen through T) through the samples, whose centres
//! lie along the principal axes e of the cloud, on both sides:
//!     beta = mean +- e sqrt(1 - v) / |T e|,   v = mean |T (u - mean)|^2
//! and the same with the scale of T that the prior allows.

use super::parameters::{Vector9, centre, shape, tau_of};
use nalgebra::{Matrix3, Vector3};

/// The starts for samples of a mean (units) and covariance (units^2), with the T of `tau`.
pub(super) fn starts(tau: &Vector9, mean: &Vector3<f64>, covariance: &Matrix3<f64>) -> [Vector9; 7] {
    let t = shape(tau);
    let spread = (t * covariance * t).trace().clamp(0.0, 0.95);
    let axes = covariance.symmetric_eigen().eigenvectors;
    let mut starts = [tau_of(&t, mean); 7];
    for k in 0..3 {
        let axis = axes.column(k).into_owned();
        let reach = axis * ((1.0 - spread).sqrt() / (t * axis).norm());
        starts[2 * k] = tau_of(&t, &(mean + reach));
        starts[2 * k + 1] = tau_of(&t, &(mean - reach));
    }
    starts[6] = mirrored(tau, mean, covariance);
    starts
}

/// The mirror image of tau on the other side of the plane of the samples: the other minimum of a flat arc.
pub(super) fn mirrored(tau: &Vector9, mean: &Vector3<f64>, covariance: &Matrix3<f64>) -> Vector9 {
    let flat = covariance.symmetric_eigen();
    let normal = flat.eigenvectors.column(flat.eigenvalues.imin()).into_owned();
    let beta = centre(tau);
    tau_of(&shape(tau), &(beta - normal * (2.0 * normal.dot(&(beta - mean)))))
}
