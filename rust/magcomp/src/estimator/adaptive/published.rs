//! What is in force, and what it makes of a sample:
//!     M = (unit / |h|) T^-1, b = unit beta, c = |h| T (u - beta)
//! |h| as given, or the geometric mean of the half axes, so that det M = 1.

#[cfg(test)]
mod tests;

use super::parameters::{Gaussian, centre, gradient, see, shape};
use crate::calibration::Calibration;
use crate::math::elementary::cbrt;
use crate::math::symmetric::{basis, six};
use crate::priors::OUTLYING;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

type Matrix9 = SMatrix<f64, 9, 9>;

/// A Gaussian over tau in coordinates of `unit_ut`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Published {
    pub known: Gaussian,
    /// Expected direction error all around, rad^2.
    pub error: f64,
    pub unit_ut: f64,
    pub strength_ut: Option<f64>,
}

impl Published {
    pub fn new(known: Gaussian, unit_ut: f64, strength_ut: Option<f64>) -> Self {
        Self { known, error: known.error(), unit_ut, strength_ut }
    }

    /// The worst direction error, rad^2: the largest variance of T and beta.
    pub fn worst(&self) -> f64 {
        self.known.covariance.fixed_view::<9, 9>(0, 0).symmetric_eigenvalues().max()
    }

    /// |h| in uT: as given, or the geometric mean of the half axes.
    fn strength_of(&self, t: &Matrix3<f64>) -> f64 {
        self.strength_ut.unwrap_or_else(|| self.unit_ut / cbrt(t.determinant()))
    }

    /// A sample corrected, uT, and its covariance, uT^2. Of `noise` a sample tells by what it misses the ellipsoid, of `elsewhere` it tells
    /// nothing; both are variances in units^2.
    pub fn correct(&self, u: &Vector3<f64>, noise: f64, elsewhere: f64) -> Option<(Vector3<f64>, Matrix3<f64>)> {
        let seen = see(&self.known.mean, u)?;
        let t = shape(&self.known.mean);
        let axes = [Vector3::x(), Vector3::y(), Vector3::z()];
        let mut g =
            SMatrix::from_rows(&axes.map(|axis| gradient(&self.known.mean, &axis, &seen.offset, 0.0).transpose()));
        if self.strength_ut.is_none() {
            let by_scale = g.fixed_view::<3, 6>(0, 0) - seen.direction * seen.radius * by_shape(&t)?.transpose();
            g.fixed_view_mut::<3, 6>(0, 0).copy_from(&by_scale);
        }
        // by what a sample that nothing explains misses the sphere it may be off across it, too
        let along = gradient(&self.known.mean, &seen.direction, &seen.offset, 0.0) / seen.slope;
        let miss = (seen.radius - 1.0) / seen.slope;
        let is_off = miss * miss > OUTLYING * OUTLYING * (noise + self.known.variance(&along));
        let missed = if is_off { (seen.radius - 1.0).powi(2) } else { 0.0 };
        let noise = t * t * noise + Matrix3::from_diagonal_element(missed.max(elsewhere));
        let covariance = g * self.known.covariance * g.transpose() + noise;
        let strength = self.strength_of(&t);
        let field = seen.direction * (seen.radius * strength);
        let covariance = covariance * (strength * strength);
        field.iter().chain(covariance.iter()).all(|value| value.is_finite()).then_some((field, covariance))
    }

    /// M, b and the field strength.
    pub fn calibration(&self) -> Option<Calibration> {
        let t = shape(&self.known.mean);
        let strength = self.strength_of(&t);
        let inverse = t.try_inverse()? * (self.unit_ut / strength);
        Calibration::from_symmetric(inverse.symmetric_part(), centre(&self.known.mean) * self.unit_ut, strength).ok()
    }

    /// Covariance of [b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz]: of tau, through
    /// dM = -M dT T^-1 (+ M tr(T^-1 dT) / 3 where det M = 1), db = unit dbeta.
    pub fn covariance(&self) -> Option<Matrix9> {
        let t = shape(&self.known.mean);
        let inverse = t.try_inverse()?;
        let m = inverse * (self.unit_ut / self.strength_of(&t));
        let by_shape = by_shape(&t)?;
        let mut jacobian = Matrix9::zeros();
        for (k, dt) in basis().into_iter().enumerate() {
            let mut dm = -(m * dt * inverse);
            if self.strength_ut.is_none() {
                dm += m * by_shape[k];
            }
            jacobian.fixed_view_mut::<6, 1>(3, k).copy_from(&six(&dm.symmetric_part()));
        }
        (0..3).for_each(|i| jacobian[(i, 6 + i)] = self.unit_ut);
        let covariance = jacobian * self.known.covariance.fixed_view::<9, 9>(0, 0) * jacobian.transpose();
        Some(covariance.symmetric_part())
    }
}

/// d ln det(T)^(1/3)/dT: where det M = 1, a T of another size is the same M.
fn by_shape(t: &Matrix3<f64>) -> Option<SVector<f64, 6>> {
    let inverse = t.try_inverse()?;
    Some(SVector::from(basis().map(|dt| inverse.dot(&dt))) / 3.0)
}
