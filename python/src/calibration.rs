//! `magcomp.Calibration`.

use crate::CalibrationError;
use crate::arrays::{matrix, to_array, to_matrix, to_rows, vector, vectors};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;

/// See `_magcomp.pyi`.
#[pyclass(frozen, eq, module = "magcomp", from_py_object)]
#[derive(Clone, PartialEq)]
pub(crate) struct Calibration(pub magcomp::Calibration);

#[pymethods]
impl Calibration {
    #[new]
    fn new(soft_iron: &Bound<'_, PyAny>, hard_iron_ut: &Bound<'_, PyAny>, field_strength_ut: f64) -> PyResult<Self> {
        let (m, b) = (matrix::<3>(soft_iron, "soft_iron")?, vector(hard_iron_ut, "hard_iron_ut")?);
        magcomp::Calibration::new(m, b, field_strength_ut)
            .map(Self)
            .map_err(|error| CalibrationError::new_err(error.to_string()))
    }

    #[getter]
    fn soft_iron<'py>(&self, python: Python<'py>) -> Bound<'py, PyArray2<f64>> {
        to_matrix(python, self.0.soft_iron())
    }

    #[getter]
    fn hard_iron_ut<'py>(&self, python: Python<'py>) -> Bound<'py, PyArray1<f64>> {
        to_array(python, self.0.hard_iron_ut())
    }

    #[getter]
    fn field_strength_ut(&self) -> f64 {
        self.0.field_strength_ut()
    }

    fn correct<'py>(&self, raw_ut: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = vectors(raw_ut, "raw_ut")?.iter().map(|raw| self.0.correct(raw).into()).collect();
        Ok(to_rows(raw_ut.py(), rows))
    }

    fn distort<'py>(&self, field_ut: &Bound<'py, PyAny>) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let rows = vectors(field_ut, "field_ut")?.iter().map(|field| self.0.distort(field).into()).collect();
        Ok(to_rows(field_ut.py(), rows))
    }

    fn __repr__(&self) -> String {
        let b = self.0.hard_iron_ut();
        format!("Calibration(b = [{:.2}, {:.2}, {:.2}] uT, |h| = {:.2} uT)", b.x, b.y, b.z, self.0.field_strength_ut())
    }
}
