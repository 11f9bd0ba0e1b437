//! Constant-field compensation (section III): one calibration from a set of orientations, P samples averaged at each.

#[cfg(test)]
mod tests;

use crate::calibration::{Calibration, LARGEST_RAW_UT};
use crate::coverage::Coverage;
use crate::ellipsoid::{EllipsoidFit, FitError, FitOptions, Moments, fit_ellipsoid};
use crate::reading::RejectReason;
use alloc::vec::Vec;
use nalgebra::Vector3;

/// Collects orientations, shows which directions are missing, and fits.
#[derive(Clone, Debug)]
pub struct ConstantField {
    samples_per_orientation: usize,
    sum_ut: Vector3<f64>,
    summed: usize,
    orientations_ut: Vec<Vector3<f64>>,
}

impl ConstantField {
    /// A session that averages `samples_per_orientation` (P, at least 1) samples in a row into one orientation. With
    /// P > 1 the device must be held still meanwhile; P = 1 for a device that is turned about.
    #[must_use]
    pub fn new(samples_per_orientation: usize) -> Self {
        Self {
            samples_per_orientation: samples_per_orientation.max(1),
            sum_ut: Vector3::zeros(),
            summed: 0,
            orientations_ut: Vec::new(),
        }
    }

    /// One raw sample, uT, each component within +-100 000.
    ///
    /// # Errors
    /// [`RejectReason::NotFinite`] or [`RejectReason::OutOfRange`]; nothing has changed then.
    pub fn add(&mut self, raw_ut: &Vector3<f64>) -> Result<(), RejectReason> {
        if !raw_ut.iter().all(|v| v.is_finite()) {
            return Err(RejectReason::NotFinite);
        }
        let value_ut = raw_ut[raw_ut.iamax()];
        if value_ut.abs() > LARGEST_RAW_UT {
            return Err(RejectReason::OutOfRange { value_ut, limit_ut: LARGEST_RAW_UT });
        }
        self.sum_ut += raw_ut;
        self.summed += 1;
        if self.summed == self.samples_per_orientation {
            self.orientations_ut.push(self.sum_ut / self.summed as f64);
            (self.sum_ut, self.summed) = (Vector3::zeros(), 0);
        }
        Ok(())
    }

    /// Orientations so far.
    #[must_use]
    pub fn orientations(&self) -> usize {
        self.orientations_ut.len()
    }

    /// Which directions were seen, about the best centre known so far.
    #[must_use]
    pub fn coverage(&self) -> Coverage {
        let through = Calibration::about(Moments::of(&self.orientations_ut).provisional_centre_ut(), 1.0);
        let mut coverage = Coverage::default();
        self.orientations_ut.iter().for_each(|raw_ut| coverage.see(Some(&through.correct(raw_ut))));
        coverage
    }

    /// M_0 and b_0 with their covariance.
    ///
    /// # Errors
    /// [`FitError`] says what the orientations lack; the session can go on.
    pub fn finish(&self, options: &FitOptions) -> Result<EllipsoidFit, FitError> {
        fit_ellipsoid(&self.orientations_ut, options)
    }
}
