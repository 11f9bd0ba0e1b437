//! What comes out: the corrected sample and its covariance, the calibration, and how sure it is.
//!     M = (unit / |h|) T^-1, b = unit beta, c = |h| T (u - beta)
//! |h| as given, or the geometric mean of the half axes, so that det M = 1.

use super::Adaptive;
use super::parameters::{centre, see, shape, six, vector_gradient};
use crate::calibration::Calibration;
use crate::reading::{Event, ModelOrder, Status};
use nalgebra::{Matrix3, SMatrix, Vector3};

type Matrix9 = SMatrix<f64, 9, 9>;

/// One answer of the adaptive estimator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AdaptiveOutput {
    /// Corrected sample, uT, and its covariance, uT^2.
    pub corrected_ut: Option<(Vector3<f64>, Matrix3<f64>)>,
    pub direction_sigma_deg: Option<f64>,
    pub worst_sigma_deg: Option<f64>,
    pub order: ModelOrder,
    pub event: Option<Event>,
    pub status: Status,
}

impl Adaptive {
    pub(super) fn output(&self, u: &Vector3<f64>) -> AdaptiveOutput {
        let level = self.noise.level(&self.vertical_noise);
        let corrected = self.published.and_then(|published| {
            let seen = see(&published.known.mean, u)?;
            let t = shape(&published.known.mean);
            let g = vector_gradient(&published.known.mean, &seen.offset);
            // by what a sample that is left out misses the sphere it may be off across it, too
            let missed = if self.surprised { (seen.radius - 1.0).powi(2) } else { 0.0 };
            let noise = t * t * (level.white + level.uneven) + Matrix3::from_diagonal_element(missed);
            let covariance = g * published.known.covariance * g.transpose() + noise;
            let strength = self.strength_of(&t);
            let field = seen.direction * (seen.radius * strength);
            let covariance = covariance * (strength * strength);
            field.iter().chain(covariance.iter()).all(|value| value.is_finite()).then_some((field, covariance))
        });
        let degrees = |square: f64| square.max(0.0).sqrt().to_degrees().min(180.0);
        AdaptiveOutput {
            corrected_ut: corrected,
            direction_sigma_deg: self.published.map(|published| degrees(published.error)),
            worst_sigma_deg: self.published.map(|_| degrees(self.worst)),
            order: self.order,
            event: self.event,
            status: self.status(),
        }
    }

    /// |h| in uT: as given, or the geometric mean of the half axes.
    fn strength_of(&self, t: &Matrix3<f64>) -> f64 {
        self.strength_ut.unwrap_or_else(|| self.unit_ut / t.determinant().cbrt())
    }

    /// M, b and the field strength in force; before the first sample those that were given.
    pub fn calibration(&self) -> Option<Calibration> {
        let Some(published) = self.published else { return self.given.filter(|_| self.bank.is_empty()) };
        let t = shape(&published.known.mean);
        let strength = self.strength_of(&t);
        let inverse = t.try_inverse()? * (self.unit_ut / strength);
        let soft_iron = (inverse + inverse.transpose()) * 0.5;
        Calibration::from_symmetric(soft_iron, centre(&published.known.mean) * self.unit_ut, strength)
    }

    /// Covariance of [b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz]: of tau, through
    /// dM = -M dT T^-1 (+ M tr(T^-1 dT) / 3 where det M = 1), db = unit dbeta.
    pub fn covariance(&self) -> Option<Matrix9> {
        let published = self.published?;
        let t = shape(&published.known.mean);
        let inverse = t.try_inverse()?;
        let m = inverse * (self.unit_ut / self.strength_of(&t));
        let mut jacobian = Matrix9::zeros();
        for (k, (i, j)) in [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)].into_iter().enumerate() {
            let mut dt = Matrix3::zeros();
            dt[(i, j)] = 1.0;
            dt[(j, i)] = 1.0;
            let mut dm = -(m * dt * inverse);
            if self.strength_ut.is_none() {
                dm += m * ((inverse * dt).trace() / 3.0);
            }
            let dm = (dm + dm.transpose()) * 0.5;
            six(&dm).into_iter().enumerate().for_each(|(row, value)| jacobian[(3 + row, k)] = value);
        }
        (0..3).for_each(|i| jacobian[(i, 6 + i)] = self.unit_ut);
        let covariance = jacobian * published.known.covariance.fixed_view::<9, 9>(0, 0) * jacobian.transpose();
        Some((covariance + covariance.transpose()) * 0.5)
    }

    /// Samples since the latest change.
    pub fn window(&self) -> usize {
        self.bank.best().map_or(0, |best| best.age as usize)
    }
}
