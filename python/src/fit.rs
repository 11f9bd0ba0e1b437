//! `magcomp.fit_ellipsoid`.

use crate::FitError;
use crate::arrays::{to_matrix, vectors};
use crate::calibration::Calibration;
use numpy::PyArray2;
use pyo3::prelude::*;

/// See `_magcomp.pyi`.
#[pyclass(frozen, module = "magcomp")]
pub(crate) struct EllipsoidFit(magcomp::EllipsoidFit);

#[pymethods]
impl EllipsoidFit {
    #[getter]
    fn calibration(&self) -> Calibration {
        Calibration(self.0.calibration)
    }

    #[getter]
    fn covariance<'py>(&self, python: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        to_matrix(python, &self.0.covariance)
    }

    #[getter]
    fn residual_rms_ut(&self) -> f64 {
        self.0.residual_rms_ut
    }

    #[getter]
    fn direction_sigma_deg(&self) -> f64 {
        self.0.direction_sigma_deg
    }

    #[getter]
    fn samples(&self) -> usize {
        self.0.samples
    }
}

/// See `_magcomp.pyi`.
#[pyfunction]
#[pyo3(signature = (points_ut, *, field_strength_ut = None))]
pub(crate) fn fit_ellipsoid(points_ut: &Bound<'_, PyAny>, field_strength_ut: Option<f64>) -> PyResult<EllipsoidFit> {
    let points = vectors(points_ut, "points_ut")?;
    let options = magcomp::FitOptions { field_strength_ut, ..Default::default() };
    let fit = points_ut.py().detach(|| magcomp::fit_ellipsoid(&points, &options));
    fit.map(EllipsoidFit).map_err(|error| FitError::new_err(error.to_string()))
}
