//! From the minimum of eq. (10) to a calibration with its covariance, and the checks a fit must pass.
//!
//! For white noise of standard deviation nu (distances), y has the information n J^T (S - nu^2 B) J / (nu^2 slope); the
//! parameters x = [b, M] follow with dx/dy: M = T^-1 in units of the field, A = T^2, b = centre + beta, where
//!     d beta = A^-1 (da - dA beta),  T dT + dT T = dA,  dM = -T^-1 dT T^-1.

#[cfg(test)]
mod tests;

use super::cost::{Candidate, Problem, Solution};
use super::moments::Moments;
use super::options::{FitOptions, SMALLEST_SAMPLE_COUNT};
use crate::calibration::Calibration;
use crate::math::descend::{Descent, Termination};
use crate::math::elementary::cbrt;
use crate::math::symmetric::{basis, six};
use crate::priors::BEYOND_CHANCE;
use crate::status::FitError;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Matrix6, SMatrix, Vector3};

type Matrix9 = SMatrix<f64, 9, 9>;

/// Data sheet: the finest last bit of a phone's magnetometer, 0.15 uT, as noise: / 12^0.5. Samples that leave less were not read to more.
const LAST_BIT_UT: f64 = 0.043;
/// Choice: samples thinner than this share of their width lie in a plane, 0.5 uT in 50: tests/host/laws.rs.
const PLANAR_RATIO: f64 = 0.01;

/// An ellipsoid and how far to trust it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct EllipsoidFit {
    /// M, b and the field strength.
    pub calibration: Calibration,
    /// Covariance of [b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz (dimensionless)], for white noise of
    /// `residual_rms_ut`, and of 0.043 uT at the least: a sensor's last bit.
    pub covariance: Matrix9,
    /// Iterations made.
    pub iterations: usize,
    /// Why they ended.
    pub termination: Termination,
    /// Rms distance of the samples from the ellipsoid, uT, nine degrees of freedom taken off: the noise per axis.
    pub residual_rms_ut: f64,
    /// Longest over shortest half axis.
    pub axis_ratio: f64,
    /// Predicted rms error of a corrected direction, over all directions, degrees: for the same noise, so never 0.
    pub direction_sigma_deg: f64,
    /// Samples in the fit.
    pub samples: usize,
}

impl Moments {
    /// M, b and field strength at a minimum found on these moments.
    pub(super) fn calibration_of(
        &self,
        at: &Candidate,
        options: &FitOptions,
    ) -> Result<(Calibration, Roots), FitError> {
        let roots = Roots::of(&at.shape.a).ok_or(FitError::NotAnEllipsoid)?;
        let field = options.field_strength_ut.unwrap_or(self.scale_ut() * roots.radius);
        let soft_iron = roots.t_inverse * (self.scale_ut() / field);
        let centre = self.centre_ut() + at.beta * self.scale_ut();
        let calibration =
            Calibration::from_symmetric(soft_iron, centre, field).map_err(|_| FitError::NotAnEllipsoid)?;
        Ok((calibration, roots))
    }

    /// Calibration, covariance and checks for a minimum found on these moments.
    pub(super) fn report(
        &self,
        problem: &Problem,
        solution: &Solution,
        options: &FitOptions,
    ) -> Result<EllipsoidFit, FitError> {
        let Descent { place: at, iterations, termination } = solution;
        let (count, scale) = (self.count(), self.scale_ut());
        let freedom = count as f64 / count.saturating_sub(SMALLEST_SAMPLE_COUNT).max(1) as f64;
        let noise_ut = (at.distance_squared() * freedom).sqrt() * scale;
        let (calibration, roots) = self.calibration_of(at, options).map_err(|_| self.why_no_ellipsoid(noise_ut))?;
        let field = calibration.field_strength_ut();
        // covariance for noise of one uT: geometry alone
        // nalgebra's factorisation reads the lower triangle alone
        let information = problem.information(at) * (count as f64 * scale * scale);
        let cholesky = information.cholesky().ok_or_else(|| self.poorly_covered(f64::INFINITY, noise_ut, options))?;
        let gradient = roots.parameter_jacobian(&at.beta, scale, scale / field, options.field_strength_ut.is_none());
        let geometry = (gradient * cholesky.inverse() * gradient.transpose()).symmetric_part();
        let deg_per_ut = direction_sigma_deg(&calibration, &geometry);
        let expected_deg = deg_per_ut * noise_ut.max(options.noise_floor_ut);
        if expected_deg.is_nan() || expected_deg > options.max_direction_sigma_deg {
            return Err(self.poorly_covered(expected_deg, noise_ut, options));
        }
        let half_axis_ut = scale * roots.radius;
        let limit_ut = options.max_residual_share * half_axis_ut;
        if noise_ut > limit_ut {
            return Err(FitError::Inconsistent { residual_ut: noise_ut, limit_ut });
        }
        let (low_ut, high_ut) = options.field_range_ut;
        if !(low_ut..=high_ut).contains(&half_axis_ut) {
            return Err(FitError::FieldOutOfRange { field_ut: half_axis_ut, low_ut, high_ut });
        }
        let read_ut = noise_ut.max(LAST_BIT_UT);
        Ok(EllipsoidFit {
            calibration,
            covariance: geometry * (read_ut * read_ut),
            iterations: *iterations,
            termination: *termination,
            residual_rms_ut: noise_ut,
            axis_ratio: roots.axis_ratio,
            direction_sigma_deg: deg_per_ut * read_ut,
            samples: count,
        })
    }

    /// Planar or single-axis motion, if that is the reason; else the surface simply is no ellipsoid.
    pub(super) fn why_no_ellipsoid(&self, noise_ut: f64) -> FitError {
        let spread = self.cloud_covariance_ut2().symmetric_eigenvalues().map(|v| v.max(0.0).sqrt());
        let (thin, wide) = (spread.min(), spread.max());
        if thin <= PLANAR_RATIO * wide || thin <= BEYOND_CHANCE * noise_ut {
            FitError::Planar { thickness_ut: thin }
        } else {
            FitError::NotAnEllipsoid
        }
    }

    fn poorly_covered(&self, direction_sigma_deg: f64, noise_ut: f64, options: &FitOptions) -> FitError {
        match self.why_no_ellipsoid(noise_ut) {
            planar @ FitError::Planar { .. } => planar,
            _ => FitError::PoorCoverage {
                // a direction is never off by more than half a turn
                direction_sigma_deg: direction_sigma_deg.min(180.0),
                limit_deg: options.max_direction_sigma_deg,
            },
        }
    }
}

/// T = A^(1/2) and what comes with it.
pub(super) struct Roots {
    vectors: Matrix3<f64>,
    /// Square roots of A's eigenvalues.
    roots: Vector3<f64>,
    t: Matrix3<f64>,
    t_inverse: Matrix3<f64>,
    axis_ratio: f64,
    /// Geometric mean of the half axes.
    radius: f64,
}

impl Roots {
    fn of(a: &Matrix3<f64>) -> Option<Self> {
        let eigen = a.symmetric_eigen();
        let roots = eigen.eigenvalues.map(|v| v.max(0.0).sqrt());
        let (low, high) = (roots.min(), roots.max());
        if !(low > 0.0 && high.is_finite()) {
            return None;
        }
        let vectors = eigen.eigenvectors;
        let turned = |values| (vectors * Matrix3::from_diagonal(&values) * vectors.transpose()).symmetric_part();
        Some(Self {
            vectors,
            roots,
            t: turned(roots),
            t_inverse: turned(roots.map(|v| 1.0 / v)),
            axis_ratio: high / low,
            radius: cbrt(roots.product()).recip(),
        })
    }

    /// d[b, M]/dy, with b = scale * beta and M = ratio * T^-1, for unit determinant of M where that is the gauge.
    fn parameter_jacobian(&self, beta: &Vector3<f64>, scale: f64, ratio: f64, unit_determinant: bool) -> Matrix9 {
        let a_inverse = self.t_inverse * self.t_inverse;
        let mut jacobian = Matrix9::zeros();
        for (column, da) in basis().into_iter().enumerate() {
            let db = -(a_inverse * (da * beta)) * scale;
            let turned = self.vectors.transpose() * da * self.vectors;
            let dt = Matrix3::from_fn(|i, j| turned[(i, j)] / (self.roots[i] + self.roots[j]));
            let dt = self.vectors * dt * self.vectors.transpose();
            let mut dm = self.t_inverse * dt * self.t_inverse * -ratio;
            if unit_determinant {
                dm -= self.t_inverse * (ratio * (self.t * dm).trace() / (3.0 * ratio));
            }
            jacobian.fixed_view_mut::<3, 1>(0, column).copy_from(&db);
            jacobian.fixed_view_mut::<6, 1>(3, column).copy_from(&six(&dm));
        }
        jacobian.fixed_view_mut::<3, 3>(0, 6).copy_from(&(a_inverse * scale));
        jacobian
    }
}

/// Predicted rms angle between the corrected and the true direction, averaged over the sphere, degrees.
#[must_use]
pub fn direction_sigma_deg(calibration: &Calibration, covariance: &Matrix9) -> f64 {
    let w = calibration.soft_iron_inverse();
    let (of_b, of_m) = (covariance.fixed_view::<3, 3>(0, 0), covariance.fixed_view::<6, 6>(3, 3));
    let variance = mean_square_angle(
        &basis().map(|dm| -(w * dm)),
        &of_m.into(),
        &(w / calibration.field_strength_ut()),
        &of_b.into(),
    );
    variance.sqrt().to_degrees()
}

/// Mean square, over the sphere, of the angle by which the errors of a symmetric matrix and of the centre turn a direction,
/// rad^2.
///
/// An error (dM, db) turns u by the part of E u - e across u, with E linear in dM (`by_matrix`: E for each elementary dM) and
/// e = `by_centre` db. Averaged over even u: |E|^2 / 3 - (tr(E)^2 + 2 tr(Es^2)) / 15 + 2 |e|^2 / 3, with Es the symmetric part
/// of E.
pub(crate) fn mean_square_angle(
    by_matrix: &[Matrix3<f64>; 6],
    of_matrix: &Matrix6<f64>,
    by_centre: &Matrix3<f64>,
    of_centre: &Matrix3<f64>,
) -> f64 {
    let symmetric = by_matrix.map(|e| e.symmetric_part());
    let mut variance = (by_centre.tr_mul(by_centre) * (2.0 / 3.0)).dot(of_centre);
    for (k, e) in by_matrix.iter().enumerate() {
        for (l, other) in by_matrix.iter().enumerate() {
            let weight =
                e.dot(other) / 3.0 - (e.trace() * other.trace() + 2.0 * symmetric[k].dot(&symmetric[l])) / 15.0;
            variance += weight * of_matrix[(k, l)];
        }
    }
    variance.max(0.0)
}
