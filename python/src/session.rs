//! `magcomp.read_session` and `magcomp.earth_field`: recordings, and the model of the Earth's field.

use crate::arrays::to_rows;
use crate::{PlaceError, SessionError};
use magcomp::nalgebra::Vector3;
use magcomp_recordings::conventions::Weight;
use magcomp_recordings::import::{ImportOptions, Loaded, load};
use magcomp_recordings::place::{self, GeoPoint};
use magcomp_recordings::recording::Events;
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Times, ns, and values of a sensor.
type Arrays<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray2<f64>>);

fn arrays<'py>(python: Python<'py>, events: &[(i64, Vector3<f64>)]) -> Arrays<'py> {
    let time_ns = PyArray1::from_iter(python, events.iter().map(|(time_ns, _)| *time_ns));
    (time_ns, to_rows(python, events.iter().map(|(_, value)| (*value).into()).collect()))
}

/// What is amiss with a recording, in sentences.
pub(crate) fn doubts(loaded: &mut Loaded) -> Vec<String> {
    let grave = loaded.conventions.findings.drain(..).filter(|finding| finding.weight > Weight::Note);
    loaded.warnings.drain(..).chain(grave.map(|finding| finding.text)).collect()
}

/// See `_magcomp.pyi`.
#[pyfunction]
#[pyo3(signature = (*paths))]
pub(crate) fn read_session<'py>(python: Python<'py>, paths: Vec<PathBuf>) -> PyResult<Bound<'py, PyDict>> {
    if paths.is_empty() {
        return Err(SessionError::new_err("read_session needs the path of a file or a folder"));
    }
    let read = python.detach(|| load(&paths, &ImportOptions::default()));
    let mut loaded = read.map_err(|error| SessionError::new_err(error.to_string()))?;
    for doubt in doubts(&mut loaded) {
        python.import("warnings")?.call_method1("warn", (doubt,))?;
    }
    let Events { field, rate, up, .. } = loaded.events;
    let session = PyDict::new(python);
    let (time_ns, field_ut) = arrays(python, &field);
    session.set_item("time_ns", time_ns)?;
    session.set_item("field_ut", field_ut)?;
    session.set_item("rotation_rate", (!rate.is_empty()).then(|| arrays(python, &rate)))?;
    session.set_item("up", (!up.is_empty()).then(|| arrays(python, &up)))?;
    Ok(session)
}

/// See `_magcomp.pyi`.
#[pyfunction]
#[pyo3(signature = (latitude_deg, longitude_deg, date, *, height_m = 0.0))]
pub(crate) fn earth_field(
    latitude_deg: f64,
    longitude_deg: f64,
    date: &Bound<'_, PyAny>,
    height_m: f64,
) -> PyResult<(f64, f64, f64)> {
    if !(latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 180.0 && height_m.is_finite()) {
        return Err(PlaceError::new_err("latitude is -90 to 90 deg, longitude -180 to 180 deg, the height finite, m"));
    }
    // a `datetime.date` as its ISO text
    let day = date.str()?.to_string().parse().map_err(PlaceError::new_err)?;
    let field = place::earth_field(GeoPoint { latitude_deg, longitude_deg, height_m }, day)
        .map_err(|error| PlaceError::new_err(error.to_string()))?;
    Ok((field.total_field_ut, field.dip_deg, field.declination_deg))
}
