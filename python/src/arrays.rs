//! Between numpy arrays and the core's vectors.

use crate::MagcompError;
use magcomp::nalgebra::{SMatrix, Vector3};
use numpy::{PyArray1, PyArray2, PyArrayMethods, PyReadonlyArray1, PyReadonlyArray2};
use pyo3::prelude::*;

/// `asarray` would give what is under the mask.
fn unmasked(numpy: &Bound<'_, PyModule>, value: &Bound<'_, PyAny>, name: &str) -> PyResult<()> {
    if value.hasattr("mask")? && numpy.getattr("ma")?.call_method1("is_masked", (value,))?.extract()? {
        return Err(MagcompError::new_err(format!("{name} has masked values; leave their rows out")));
    }
    Ok(())
}

/// Whatever numpy makes an array of, as float64.
pub(crate) fn array<'py>(value: &Bound<'py, PyAny>, name: &str) -> PyResult<Bound<'py, PyAny>> {
    let numpy = value.py().import("numpy")?;
    unmasked(&numpy, value, name)?;
    let made = numpy.call_method1("asarray", (value, numpy.getattr("float64")?));
    made.map_err(|error| MagcompError::new_err(format!("{name} is no array of numbers: {error}")))
}

fn shape(value: &Bound<'_, PyAny>) -> PyResult<Vec<usize>> {
    value.getattr("shape")?.extract()
}

/// Three numbers.
pub(crate) fn vector(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vector3<f64>> {
    let made = array(value, name)?;
    let found = shape(&made)?;
    if found != [3] {
        return Err(MagcompError::new_err(format!("{name} has shape {found:?}; it must be (3,)")));
    }
    let view: PyReadonlyArray1<'_, f64> = made.extract()?;
    let view = view.as_array();
    Ok(Vector3::new(view[0], view[1], view[2]))
}

/// Rows of three numbers.
pub(crate) fn vectors(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<Vector3<f64>>> {
    let made = array(value, name)?;
    let found = shape(&made)?;
    if found.len() != 2 || found[1] != 3 {
        return Err(MagcompError::new_err(format!("{name} has shape {found:?}; it must be (n, 3)")));
    }
    let view: PyReadonlyArray2<'_, f64> = made.extract()?;
    Ok(view.as_array().rows().into_iter().map(|row| Vector3::new(row[0], row[1], row[2])).collect())
}

/// A square matrix.
pub(crate) fn matrix<const N: usize>(value: &Bound<'_, PyAny>, name: &str) -> PyResult<SMatrix<f64, N, N>> {
    let made = array(value, name)?;
    let found = shape(&made)?;
    if found != [N, N] {
        return Err(MagcompError::new_err(format!("{name} has shape {found:?}; it must be ({N}, {N})")));
    }
    let view: PyReadonlyArray2<'_, f64> = made.extract()?;
    let view = view.as_array();
    Ok(SMatrix::from_fn(|i, j| view[[i, j]]))
}

/// Times in nanoseconds: whole numbers; seconds are not guessed.
pub(crate) fn times(value: &Bound<'_, PyAny>, name: &str) -> PyResult<Vec<i64>> {
    let numpy = value.py().import("numpy")?;
    unmasked(&numpy, value, name)?;
    let made = numpy.call_method1("asarray", (value,))?;
    let kind: String = made.getattr("dtype")?.getattr("kind")?.extract()?;
    let found = shape(&made)?;
    if !matches!(kind.as_str(), "i" | "u") || found.len() != 1 {
        return Err(MagcompError::new_err(format!(
            "{name} has shape {found:?} and kind {kind:?}; it must be (n,) whole nanoseconds: (seconds * 1e9).astype('int64')"
        )));
    }
    let made = made.call_method1("astype", (numpy.getattr("int64")?,))?;
    let view: PyReadonlyArray1<'_, i64> = made.extract()?;
    let times = view.as_array().to_vec();
    if kind == "u" && times.iter().any(|time_ns| *time_ns < 0) {
        return Err(MagcompError::new_err(format!("{name} has times beyond 2^63 ns")));
    }
    Ok(times)
}

pub(crate) fn to_array<'py>(python: Python<'py>, v: &Vector3<f64>) -> Bound<'py, PyArray1<f64>> {
    PyArray1::from_slice(python, v.as_slice())
}

pub(crate) fn to_matrix<'py, const N: usize>(python: Python<'py>, m: &SMatrix<f64, N, N>) -> Bound<'py, PyArray2<f64>> {
    to_rows(python, (0..N).map(|i| std::array::from_fn::<f64, N, _>(|j| m[(i, j)])).collect())
}

/// Rows as a two-dimensional array.
pub(crate) fn to_rows<const N: usize>(python: Python<'_>, rows: Vec<[f64; N]>) -> Bound<'_, PyArray2<f64>> {
    let count = rows.len();
    let flat = PyArray1::from_vec(python, rows.into_flattened());
    flat.reshape([count, N]).expect("as many numbers as rows have")
}
