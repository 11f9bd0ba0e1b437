//! Normalised estimation error squared of a calibration: e^T P^-1 e over the number of parameters, 1 on average where the
//! covariance is right, chi-squared with so many degrees of freedom.

use crate::simulate::Truth;
use magcomp::Compensator;
use magcomp::nalgebra::{SMatrix, SVector};

/// Eigenvalues of the correlations below this are a direction that is fixed by convention.
const FIXED: f64 = 1e-9;

/// NEES and its number of parameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Nees {
    /// e^T P^-1 e over the number of parameters.
    pub mean_square: f64,
    /// 9, or 8 where the field strength is not known: then det M = 1 in truth and estimate.
    pub parameters: usize,
    /// The same of b alone.
    pub hard_iron: f64,
}

impl Nees {
    /// None without a calibration or a covariance.
    pub fn of(compensator: &Compensator, truth: &Truth) -> Option<Self> {
        let (found, covariance) = (compensator.calibration()?, compensator.covariance()?);
        let known = compensator.config().field_strength_ut.is_some();
        let scale = if known { 1.0 } else { truth.soft_iron.determinant().cbrt() };
        let b = found.hard_iron_ut() - truth.hard_iron_ut;
        let m = found.soft_iron() - truth.soft_iron / scale;
        let error = SVector::<f64, 9>::from([b.x, b.y, b.z, m.m11, m.m22, m.m33, m.m12, m.m13, m.m23]);
        let sd: [f64; 9] = std::array::from_fn(|i| covariance[(i, i)].sqrt());
        if !sd.iter().all(|sd| *sd > 0.0) {
            return None;
        }
        // as correlations: uT and shares are of the same size then
        let eigen = SMatrix::<f64, 9, 9>::from_fn(|i, j| covariance[(i, j)] / (sd[i] * sd[j])).symmetric_eigen();
        let scaled = SVector::<f64, 9>::from_fn(|i, _| error[i] / sd[i]);
        let along = eigen.eigenvectors.tr_mul(&scaled);
        let free = (0..9).filter(|k| eigen.eigenvalues[*k] > FIXED);
        let (sum, parameters) =
            free.fold((0.0, 0), |(sum, count), k| (sum + along[k].powi(2) / eigen.eigenvalues[k], count + 1));
        let inverse = covariance.fixed_view::<3, 3>(0, 0).into_owned().try_inverse()?;
        Some(Self { mean_square: sum / parameters as f64, parameters, hard_iron: b.dot(&(inverse * b)) / 3.0 })
    }
}
