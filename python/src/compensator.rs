//! `magcomp.Compensator` and `magcomp.Reading`.

use crate::arrays::{array, times, to_array, to_matrix, to_rows, vector, vectors};
use crate::calibration::Calibration;
use crate::{ConfigError, EventError, KeptError, MagcompError};
use magcomp::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use magcomp::{
    AttitudeSample, EventRejection, HeadedAxis, HeadingAid, HeadingSample, KeptCalibration, MagneticSample,
    NorthReference, RotationRateSample, UpSample, Yaw,
};
use numpy::{PyArray1, PyArray2};
use pyo3::prelude::*;
use pyo3::types::{PyBytes, PyDict, PyTuple};
use std::iter::Peekable;
use std::slice::Iter;

/// See `_magcomp.pyi`.
#[pyclass(module = "magcomp")]
pub(crate) struct Compensator(magcomp::Compensator);

/// See `_magcomp.pyi`.
#[pyclass(frozen, module = "magcomp")]
pub(crate) struct Reading(magcomp::Reading);

/// Samples of a sensor beside the magnetometer, as `(time_ns, values)`.
type Stream = Vec<(i64, Vector3<f64>)>;

pub(crate) fn stream(value: Option<(Bound<'_, PyAny>, Bound<'_, PyAny>)>, name: &str) -> PyResult<Stream> {
    let Some((time_ns, values)) = value else { return Ok(Vec::new()) };
    let (time_ns, values) = (times(&time_ns, &format!("{name}[0]"))?, vectors(&values, &format!("{name}[1]"))?);
    if time_ns.len() != values.len() {
        let (have, of) = (time_ns.len(), values.len());
        return Err(MagcompError::new_err(format!("{name} has {have} times and {of} samples")));
    }
    let mut stream: Stream = time_ns.into_iter().zip(values).collect();
    stream.sort_by_key(|(time_ns, _)| *time_ns);
    Ok(stream)
}

fn refused(error: EventRejection) -> PyErr {
    EventError::new_err(error.to_string())
}

/// The settings that are given by name, the others as usual.
pub(crate) fn config(settings: Option<&Bound<'_, PyDict>>) -> PyResult<magcomp::Config> {
    let Some(settings) = settings else { return Ok(magcomp::Config::default()) };
    let text: String = settings.py().import("json")?.call_method1("dumps", (settings,))?.extract()?;
    serde_json::from_str(&text).map_err(|error| ConfigError::new_err(error.to_string()))
}

fn reference(name: &str) -> PyResult<NorthReference> {
    match name {
        "true" => Ok(NorthReference::True),
        "magnetic" => Ok(NorthReference::Magnetic),
        _ => Err(MagcompError::new_err(format!("north is {name:?}; it must be \"true\" or \"magnetic\""))),
    }
}

#[pymethods]
impl Compensator {
    #[new]
    #[pyo3(signature = (**settings))]
    fn new(settings: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        let config = config(settings)?;
        let made = magcomp::Compensator::new(config).map_err(|error| ConfigError::new_err(error.to_string()))?;
        Ok(Self(made))
    }

    #[getter]
    fn config<'py>(&self, python: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        let text = serde_json::to_string(self.0.config()).expect("numbers under names");
        python.import("json")?.call_method1("loads", (text,))
    }

    fn reset(&mut self) {
        self.0.reset();
    }

    fn push_rotation_rate(&mut self, time_ns: i64, rate_rad_s: &Bound<'_, PyAny>) -> PyResult<()> {
        let sample = RotationRateSample { time_ns, rate_rad_s: vector(rate_rad_s, "rate_rad_s")? };
        self.0.push_rotation_rate(sample).map_err(refused)
    }

    fn push_up(&mut self, time_ns: i64, up_m_s2: &Bound<'_, PyAny>) -> PyResult<()> {
        let sample = UpSample { time_ns, up_m_s2: vector(up_m_s2, "up_m_s2")? };
        self.0.push_up(sample).map_err(refused)
    }

    #[pyo3(signature = (time_ns, heading_deg, sigma_deg, *, north = "true", axis = None))]
    fn push_heading(
        &mut self,
        time_ns: i64,
        heading_deg: f64,
        sigma_deg: f64,
        north: &str,
        axis: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<()> {
        let reference = reference(north)?;
        let axis = axis.map(|axis| vector(axis, "axis")).transpose()?;
        let axis = axis.map_or(HeadedAxis::Vehicle, HeadedAxis::Device);
        let sample = HeadingSample { time_ns, heading_deg, sigma_deg, reference, axis };
        self.0.push_heading(sample).map_err(refused)
    }

    #[pyo3(signature = (time_ns, to_world, *, north = None, sigma_deg = None))]
    fn push_attitude(
        &mut self,
        time_ns: i64,
        to_world: &Bound<'_, PyAny>,
        north: Option<&str>,
        sigma_deg: Option<f64>,
    ) -> PyResult<()> {
        let yaw = match (north, sigma_deg) {
            (None, None) => Yaw::Relative,
            (Some(north), Some(sigma_deg)) => Yaw::Absolute { sigma_deg, reference: reference(north)? },
            _ => return Err(MagcompError::new_err("give both north and sigma_deg, or neither")),
        };
        let parts: Vec<f64> = array(to_world, "to_world")?.call_method0("tolist")?.extract().unwrap_or_default();
        let &[w, x, y, z] = &parts[..] else {
            return Err(MagcompError::new_err("to_world must be four numbers: w, x, y, z"));
        };
        if !parts.iter().all(|it| it.is_finite()) {
            return Err(refused(EventRejection::NotFinite));
        }
        let to_world = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), f64::MIN_POSITIVE);
        let to_world = to_world.ok_or_else(|| refused(EventRejection::OutOfRange))?;
        self.0.push_attitude(AttitudeSample { time_ns, to_world, yaw }).map_err(refused)
    }

    #[getter]
    fn heading_aid(&self) -> Option<&'static str> {
        Some(match self.0.heading_aid()? {
            HeadingAid::Used => "used",
            HeadingAid::Leads => "leads",
            HeadingAid::Disagrees => "disagrees",
        })
    }

    #[getter]
    fn found_declination_deg(&self) -> Option<(f64, f64)> {
        self.0.found_declination_deg()
    }

    fn push(&mut self, time_ns: i64, field_ut: &Bound<'_, PyAny>) -> PyResult<Reading> {
        Ok(Reading(self.0.push(MagneticSample { time_ns, field_ut: vector(field_ut, "field_ut")? })))
    }

    #[pyo3(signature = (time_ns, field_ut, *, rotation_rate = None, up = None))]
    fn process<'py>(
        &mut self,
        time_ns: &Bound<'py, PyAny>,
        field_ut: &Bound<'py, PyAny>,
        rotation_rate: Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)>,
        up: Option<(Bound<'py, PyAny>, Bound<'py, PyAny>)>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let python = time_ns.py();
        let (time_ns, fields) = (times(time_ns, "time_ns")?, vectors(field_ut, "field_ut")?);
        if time_ns.len() != fields.len() {
            let (have, of) = (time_ns.len(), fields.len());
            return Err(MagcompError::new_err(format!("time_ns has {have} times for {of} samples of field_ut")));
        }
        let (rates, ups) = (stream(rotation_rate, "rotation_rate")?, stream(up, "up")?);
        let compensator = &mut self.0;
        let (readings, left_out) = replay(python, compensator, &time_ns, &fields, &rates, &ups)?;
        let of = |value: fn(&magcomp::Reading) -> Option<f64>| {
            PyArray1::from_iter(python, readings.iter().map(|it| value(it).unwrap_or(f64::NAN)))
        };
        let rows = |value: fn(&magcomp::Reading) -> Option<Vector3<f64>>| {
            let nothing = Vector3::repeat(f64::NAN);
            to_rows(python, readings.iter().map(|it| value(it).unwrap_or(nothing).into()).collect())
        };
        let out = PyDict::new(python);
        out.set_item("field_ut", rows(|it| it.field_ut))?;
        out.set_item("filtered_field_ut", rows(|it| it.filtered_field_ut))?;
        out.set_item("field_sigma_ut", of(|it| it.field_sigma_ut))?;
        out.set_item("heading_deg", of(|it| Some(it.heading?.heading_deg)))?;
        out.set_item("heading_sigma_deg", of(|it| it.heading?.heading_sigma_deg))?;
        out.set_item("true_heading_deg", of(|it| it.heading?.true_heading_deg))?;
        out.set_item("direction_sigma_deg", of(|it| it.direction_sigma_deg))?;
        let labels: Vec<&str> = readings.iter().map(|it| it.status.label()).collect();
        out.set_item("status", python.import("numpy")?.call_method1("array", (labels, "U10"))?)?;
        out.set_item("events", events(&readings))?;
        out.set_item("left_out", left_out)?;
        Ok(out)
    }

    #[getter]
    fn calibration(&self) -> Option<Calibration> {
        self.0.calibration().map(Calibration)
    }

    #[getter]
    fn covariance<'py>(&self, python: Python<'py>) -> Option<Bound<'py, PyArray2<f64>>> {
        self.0.covariance().map(|covariance| to_matrix(python, &covariance))
    }

    fn keep(&self, unix_time_s: i64) -> Option<String> {
        self.0.keep(unix_time_s).map(|kept| kept.to_json())
    }

    #[pyo3(signature = (kept, unix_time_s = None))]
    fn adopt(&mut self, kept: &str, unix_time_s: Option<i64>) -> PyResult<()> {
        let kept = KeptCalibration::from_json(kept).map_err(|error| KeptError::new_err(error.to_string()))?;
        self.0.adopt(&kept, unix_time_s);
        Ok(())
    }

    /// All that it knows, in bytes that the same version alone reads.
    fn __reduce__<'py>(slf: &Bound<'py, Self>) -> PyResult<Bound<'py, PyTuple>> {
        let python = slf.py();
        let state = postcard::to_stdvec(&slf.borrow().0).map_err(|error| MagcompError::new_err(error.to_string()))?;
        let make = python.import("magcomp._magcomp")?.getattr("_compensator")?;
        (make, (env!("CARGO_PKG_VERSION"), PyBytes::new(python, &state))).into_pyobject(python)
    }

    fn __copy__(&self) -> Self {
        Self(self.0.clone())
    }

    fn __deepcopy__(&self, _memo: &Bound<'_, PyAny>) -> Self {
        self.__copy__()
    }
}

/// A pickled compensator again.
#[pyfunction]
pub(crate) fn _compensator(version: &str, state: &[u8]) -> PyResult<Compensator> {
    if version != env!("CARGO_PKG_VERSION") {
        let here = env!("CARGO_PKG_VERSION");
        return Err(MagcompError::new_err(format!("it was pickled by magcomp {version}, and this is {here}")));
    }
    let compensator = postcard::from_bytes(state)
        .map_err(|error| MagcompError::new_err(format!("these are no bytes of a pickled compensator: {error}")))?;
    Ok(Compensator(compensator))
}

/// Choice: samples between two looks whether Ctrl-C was pressed.
pub(crate) const UNINTERRUPTED: usize = 4096;

/// All samples in the order of their times; how many of the other sensors' were left out. A signal's exception ends it between two samples.
fn replay(
    python: Python<'_>,
    compensator: &mut magcomp::Compensator,
    time_ns: &[i64],
    fields: &[Vector3<f64>],
    rates: &Stream,
    ups: &Stream,
) -> PyResult<(Vec<magcomp::Reading>, usize)> {
    let mut others = Others::new(rates, ups);
    let mut readings = Vec::with_capacity(time_ns.len());
    for (times, fields) in time_ns.chunks(UNINTERRUPTED).zip(fields.chunks(UNINTERRUPTED)) {
        python.detach(|| {
            let samples = times.iter().zip(fields);
            readings.extend(samples.map(|(time_ns, field_ut)| others.answer(compensator, *time_ns, *field_ut)));
        });
        python.check_signals()?;
    }
    Ok((readings, others.left_out))
}

/// Samples of the other sensors that wait for the magnetic samples after them.
pub(crate) struct Others<'a> {
    rates: Peekable<Iter<'a, (i64, Vector3<f64>)>>,
    ups: Peekable<Iter<'a, (i64, Vector3<f64>)>>,
    /// How many were refused.
    pub left_out: usize,
}

impl<'a> Others<'a> {
    pub(crate) fn new(rates: &'a [(i64, Vector3<f64>)], ups: &'a [(i64, Vector3<f64>)]) -> Self {
        Self { rates: rates.iter().peekable(), ups: ups.iter().peekable(), left_out: 0 }
    }

    /// Pushes a magnetic sample after the others up to its time.
    pub(crate) fn answer(
        &mut self,
        compensator: &mut magcomp::Compensator,
        time_ns: i64,
        field_ut: Vector3<f64>,
    ) -> magcomp::Reading {
        loop {
            let rate = self.rates.peek().map(|(at, _)| *at).filter(|at| *at <= time_ns);
            let up = self.ups.peek().map(|(at, _)| *at).filter(|at| *at <= time_ns);
            let pushed = match (rate, up) {
                (None, None) => break,
                (Some(at), up) if up.is_none_or(|up| at <= up) => {
                    let (time_ns, rate_rad_s) = *self.rates.next().expect("it was looked at");
                    compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s })
                }
                _ => {
                    let (time_ns, up_m_s2) = *self.ups.next().expect("it was looked at");
                    compensator.push_up(UpSample { time_ns, up_m_s2 })
                }
            };
            self.left_out += usize::from(pushed.is_err());
        }
        compensator.push(MagneticSample { time_ns, field_ut })
    }
}

/// Each event once: kind, since when, and when it was decided, ns.
pub(crate) fn events(readings: &[magcomp::Reading]) -> Vec<(String, i64, i64)> {
    let mut found: Vec<magcomp::Event> = readings.iter().filter_map(|it| it.event).collect();
    found.dedup();
    found.into_iter().map(|it| (format!("{:?}", it.kind), it.since_ns, it.decided_ns)).collect()
}

#[pymethods]
impl Reading {
    #[getter]
    fn time_ns(&self) -> i64 {
        self.0.time_ns
    }

    #[getter]
    fn field_ut<'py>(&self, python: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.0.field_ut.map(|field| to_array(python, &field))
    }

    #[getter]
    fn filtered_field_ut<'py>(&self, python: Python<'py>) -> Option<Bound<'py, PyArray1<f64>>> {
        self.0.filtered_field_ut.map(|field| to_array(python, &field))
    }

    #[getter]
    fn field_sigma_ut(&self) -> Option<f64> {
        self.0.field_sigma_ut
    }

    #[getter]
    fn heading_deg(&self) -> Option<f64> {
        self.0.heading.map(|heading| heading.heading_deg)
    }

    #[getter]
    fn heading_sigma_deg(&self) -> Option<f64> {
        self.0.heading?.heading_sigma_deg
    }

    #[getter]
    fn true_heading_deg(&self) -> Option<f64> {
        self.0.heading?.true_heading_deg
    }

    #[getter]
    fn direction_sigma_deg(&self) -> Option<f64> {
        self.0.direction_sigma_deg
    }

    #[getter]
    fn status(&self) -> &'static str {
        self.0.status.label()
    }

    #[getter]
    fn status_text(&self) -> String {
        self.0.status.to_string()
    }

    #[getter]
    fn event(&self) -> Option<(String, i64, i64)> {
        events(&[self.0]).pop()
    }

    fn __repr__(&self) -> String {
        let heading = self.0.heading.map_or("none".to_owned(), |heading| format!("{:.1} deg", heading.heading_deg));
        format!("Reading(heading {heading}, {})", self.0.status)
    }
}
