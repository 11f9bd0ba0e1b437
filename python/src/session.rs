//! `magcomp.read_session` and `magcomp.earth_field`: the lab's importers and model of the Earth's field.

use crate::arrays::to_rows;
use crate::{PlaceError, SessionError};
use magcomp_lab::conventions::Weight;
use magcomp_lab::import::{ImportOptions, open};
use magcomp_lab::place::{self, GeoPoint};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use std::path::PathBuf;

/// Times, ns, and values of a sensor.
#[derive(Default)]
struct Sensor {
    time_ns: Vec<i64>,
    values: Vec<[f64; 3]>,
}

impl Sensor {
    fn add(&mut self, time_ns: i64, value: Option<magcomp::nalgebra::Vector3<f64>>) {
        if let Some(value) = value {
            self.time_ns.push(time_ns);
            self.values.push(value.into());
        }
    }

    fn arrays(self, python: Python<'_>) -> (Bound<'_, PyArray1<i64>>, Bound<'_, PyArray2<f64>>) {
        (PyArray1::from_vec(python, self.time_ns), to_rows(python, self.values))
    }
}

/// See `_magcomp.pyi`.
#[pyfunction]
#[pyo3(signature = (*paths))]
pub(crate) fn read_session<'py>(python: Python<'py>, paths: Vec<PathBuf>) -> PyResult<Bound<'py, PyDict>> {
    if paths.is_empty() {
        return Err(SessionError::new_err("read_session needs the path of a file or a folder"));
    }
    let read = python.detach(|| {
        let mut opened = open(&paths, &ImportOptions::default())?;
        let (mut magnetic, mut rates, mut ups) = (Sensor::default(), Sensor::default(), Sensor::default());
        for row in opened.source.rows()? {
            let row = row?;
            for event in row.inertial() {
                rates.add(event.time_ns, event.rate_rad_s);
                ups.add(event.time_ns, event.up_m_s2);
            }
            magnetic.add(row.time_ns, Some(row.field_ut));
        }
        let grave = opened.conventions.findings.into_iter().filter(|finding| finding.weight > Weight::Note);
        let warnings: Vec<String> = opened.warnings.into_iter().chain(grave.map(|finding| finding.text)).collect();
        Ok((magnetic, rates, ups, warnings))
    });
    let (magnetic, rates, ups, warnings) =
        read.map_err(|error: magcomp_lab::error::LabError| SessionError::new_err(error.to_string()))?;
    for warning in warnings {
        python.import("warnings")?.call_method1("warn", (warning,))?;
    }
    let session = PyDict::new(python);
    let (time_ns, field_ut) = magnetic.arrays(python);
    session.set_item("time_ns", time_ns)?;
    session.set_item("field_ut", field_ut)?;
    session.set_item("rotation_rate", (!rates.time_ns.is_empty()).then(|| rates.arrays(python)))?;
    session.set_item("up", (!ups.time_ns.is_empty()).then(|| ups.arrays(python)))?;
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
