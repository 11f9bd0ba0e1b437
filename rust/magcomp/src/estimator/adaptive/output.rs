//! What comes out: the corrected sample and its covariance, the calibration, and how sure it is.
//!     M = (unit / |h|) T^-1, b = centre + unit beta (+ how far the coordinates have moved), c = |h| T (u - beta)
//! |h| as given, or the geometric mean of the half axes, so that det M = 1.

use super::parameters::{Matrix9, centre, shape, six};
use super::{Adaptive, RECENT};
use crate::calibration::Calibration;
use crate::reading::{Event, ModelOrder, Status};
use nalgebra::{Matrix3, Vector3};

/// Standard deviation of a heading that is not known at all, radians: its tangent exceeds 2 (`heading_sigma_deg`).
const LARGEST_ANGLE_RAD: f64 = 1.11;

/// One answer of the adaptive estimator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct AdaptiveOutput {
    /// Corrected sample, uT, and its covariance, uT^2.
    pub corrected_ut: Option<(Vector3<f64>, Matrix3<f64>)>,
    /// The covariance that leads to the heading's error while hypotheses compete: large errors are known as angles.
    pub heading_covariance_ut2: Option<Matrix3<f64>>,
    pub direction_sigma_deg: Option<f64>,
    pub worst_sigma_deg: Option<f64>,
    pub order: ModelOrder,
    pub event: Option<Event>,
    pub status: Status,
}

impl Adaptive {
    pub(super) fn output(&self, raw_ut: &Vector3<f64>) -> AdaptiveOutput {
        let found = self.published.and_then(|published| {
            let u = self.unit(raw_ut);
            let (field, covariance, noise) = published.correct(&u, &self.noise)?;
            // by what a gated sample misses the sphere it may be off across it, too
            let gated = self.late[RECENT - 1].is_some_and(|late| late.gated);
            let missed = Matrix3::from_diagonal_element(if gated { (field.norm() - 1.0).powi(2) } else { 0.0 });
            let (covariance, noise) = (covariance + missed, noise + missed);
            let up = self.witness.up().filter(|_| self.trial.is_some());
            let heading_covariance = up.map(|up| {
                let angle = self.rivals.heading_rad2(&u, &up, &field).sqrt().min(LARGEST_ANGLE_RAD);
                let (sin, cos) = angle.sin_cos();
                let across = field.cross(&up) * (sin / cos);
                across * across.transpose() + noise
            });
            let strength = self.strength_of(&shape(&published.tau));
            let square = strength * strength;
            let finite = field.iter().chain(covariance.iter()).chain(heading_covariance.iter().flatten());
            let is_finite = finite.map(|value| value * square).all(f64::is_finite);
            is_finite.then(|| (field * strength, covariance * square, heading_covariance.map(|c| c * square)))
        });
        AdaptiveOutput {
            corrected_ut: found.map(|(field, covariance, _)| (field, covariance)),
            heading_covariance_ut2: found.and_then(|(_, _, heading_covariance)| heading_covariance),
            direction_sigma_deg: self.published.map(|_| self.direction_sigma_deg),
            worst_sigma_deg: self.published.map(|_| self.worst_sigma_deg),
            order: self.order,
            event: self.event,
            status: self.status(),
        }
    }

    /// M, b and the field strength in force; before the first sample those that were given.
    pub fn calibration(&self) -> Option<Calibration> {
        let Some(published) = self.published else { return self.given.filter(|_| !self.started) };
        let t = shape(&published.tau);
        let strength = self.strength_of(&t);
        let inverse = t.try_inverse()? * (self.unit_ut / strength);
        let soft_iron = (inverse + inverse.transpose()) * 0.5;
        let hard_iron_ut = self.centre_ut + self.motion.gone_ut + centre(&published.tau) * self.unit_ut;
        Calibration::from_symmetric(soft_iron, hard_iron_ut, strength).ok()
    }

    /// Covariance of [b_x b_y b_z (uT), m_xx m_yy m_zz m_xy m_xz m_yz]: of tau, through
    /// dM = -M dT T^-1 (+ M tr(T^-1 dT) / 3 where det M = 1), db = unit dbeta.
    pub fn covariance(&self) -> Option<Matrix9> {
        let published = self.published?;
        let t = shape(&published.tau);
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
        let covariance = jacobian * published.covariance * jacobian.transpose();
        Some((covariance + covariance.transpose()) * 0.5)
    }

    /// Samples since the latest change.
    pub fn window(&self) -> usize {
        self.samples.age
    }
}
