//! The least-squares ellipsoid (eq. 9, 10) of a set of samples or of the window of a stream: start, descent (`cost`), report.

#[cfg(test)]
mod tests;

use super::cost::{Problem, Solution};
use super::moments::Moments;
use super::options::{FitOptions, SMALLEST_SAMPLE_COUNT};
use super::report::EllipsoidFit;
use super::start::{Shape, closed_form};
use crate::calibration::Calibration;
use crate::status::FitError;
use nalgebra::Vector3;

/// Batch fit of a slice of raw samples, uT (section III of the paper).
///
/// # Errors
/// [`FitError`] says what is wrong with the samples.
pub fn fit_ellipsoid(points_ut: &[Vector3<f64>], options: &FitOptions) -> Result<EllipsoidFit, FitError> {
    let fit = Moments::of(points_ut).fit(options)?;
    // a cap of the sphere lies off its own centre: once more about the centre that was found
    let mut moments = Moments::new(*fit.calibration.hard_iron_ut(), fit.calibration.field_strength_ut());
    points_ut.iter().for_each(|p| moments.add(p));
    moments.fit(options)
}

impl Moments {
    /// The least-squares ellipsoid of the samples in the set, from the closed-form start.
    ///
    /// # Errors
    /// [`FitError`] says what is wrong with the samples.
    pub fn fit(&self, options: &FitOptions) -> Result<EllipsoidFit, FitError> {
        self.fit_from(None, options)
    }

    /// The iteration alone, from a previous calibration: what a sample costs in a stream, without covariance and checks.
    ///
    /// # Errors
    /// [`FitError`] when there are too few samples or no ellipsoid.
    pub fn refine(&self, previous: &Calibration, options: &FitOptions) -> Result<Calibration, FitError> {
        let (_, solution) = self.minimum(Some(previous), options)?;
        self.calibration_of(&solution.place, options).map(|(calibration, _)| calibration)
    }

    /// The fit of a stream: the iteration starts from `previous` where that has the lower cost, else from the closed form.
    pub(crate) fn fit_from(
        &self,
        previous: Option<&Calibration>,
        options: &FitOptions,
    ) -> Result<EllipsoidFit, FitError> {
        let (problem, solution) = self.minimum(previous, options)?;
        self.report(&problem, &solution, options)
    }

    /// The cost of these samples, and its minimum.
    fn minimum(&self, previous: Option<&Calibration>, options: &FitOptions) -> Result<(Problem, Solution), FitError> {
        if !self.is_finite() {
            return Err(FitError::NotFinite);
        }
        if self.count() < SMALLEST_SAMPLE_COUNT {
            return Err(FitError::TooFewSamples { have: self.count() });
        }
        let (s, b) = self.scatter();
        let problem = Problem { s, b, residual: options.residual };
        let solution = problem.solve(previous.map(|calibration| self.shape_of(calibration)), options);
        Ok((problem, solution.ok_or_else(|| self.why_no_ellipsoid(0.0))?))
    }

    /// Where the centre seems to be, uT, however poor the coverage: for showing directions, not for correcting.
    pub(crate) fn provisional_centre_ut(&self) -> Vector3<f64> {
        let start = closed_form(&self.scatter().0).and_then(|shape| shape.centre());
        let centre = start.map(|beta| self.centre_ut() + beta * self.scale_ut());
        centre.filter(|c| c.iter().all(|v| v.is_finite())).unwrap_or(*self.centre_ut())
    }

    /// A calibration, seen in these coordinates: the warm start.
    fn shape_of(&self, calibration: &Calibration) -> Shape {
        let t = calibration.soft_iron_inverse() * (self.scale_ut() / calibration.field_strength_ut());
        let a = t * t;
        let beta = (calibration.hard_iron_ut() - self.centre_ut()) / self.scale_ut();
        Shape { a: a.symmetric_part(), offset: a * beta }
    }
}
