// made by bindings/generate.sh from bindings/reading.toml
//! The answer to one magnetometer sample as it crosses the border: uniffi's record, and the struct of plain numbers.

use crate::convert::count;
use crate::record::{Attitude, Heading, Vector3};
use crate::status::{Event, EventKind, FlatStatus, ModelOrder, NONE, SensorMode, Status};
use magcomp::nalgebra;

/// The answer to one magnetometer sample. A value that is not known is none, never NaN.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct Reading {
    /// Time of the sample, nanoseconds.
    pub time_ns: i64,
    /// The corrected sample, microtesla, device frame. None until there is a calibration, and for a rejected sample.
    pub field_ut: Option<Vector3>,
    /// One standard deviation of `field_ut` per axis, microtesla. None when it is not known.
    pub field_sigma_ut: Option<f64>,
    /// The estimator's own, smoother estimate of the same vector, microtesla; the heading comes from it. None where it has none.
    pub filtered_field_ut: Option<Vector3>,
    /// Length of `field_ut`, microtesla. None where that is not known.
    pub total_field_ut: Option<f64>,
    /// Heading and inclination. None without a calibration, without a recent `up`, or where the axis is vertical.
    pub heading: Option<Heading>,
    /// How the device lies in the world, also where the heading's axis is vertical. None without a calibration, without a recent `up`, or where the field is vertical.
    pub attitude: Option<Attitude>,
    /// Uniformity sigma_T of the latest orientations, 0 to about 1, dimensionless. None until there are enough of them and a calibration.
    pub sigma_t: Option<f64>,
    /// Samples in the window of the estimator.
    pub window: i32,
    /// Share of the directions seen in that window, 0 to 1.
    pub coverage: f64,
    /// Predicted rms error of a corrected direction by the parameters in force, over all directions, degrees. None when it is not known.
    pub direction_sigma_deg: Option<f64>,
    /// The same for the one combination of parameters that is known worst, degrees. It is large where the directions seen do not determine the parameters, also where `sigma_t` does not show that. Adaptive method only. None when it is not known.
    pub worst_sigma_deg: Option<f64>,
    /// Which parameters the latest change set free. Adaptive method only. None when it is not known.
    pub model_order: Option<ModelOrder>,
    /// By how much the operating system's own hard-iron estimate jumped with this sample, microtesla. A jump means that the operating system has recalibrated; the raw field has not changed. None when it did not jump or is not reported.
    pub reported_hard_iron_jump_ut: Option<f64>,
    /// The sensors the estimator runs on.
    pub mode: SensorMode,
    /// The latest change that was decided, kept until the next. None before the first.
    pub event: Option<Event>,
    /// What the compensator is doing, and why.
    pub status: Status,
}

impl From<magcomp::Reading> for Reading {
    fn from(it: magcomp::Reading) -> Self {
        let magcomp::Reading { time_ns, field_ut, field_sigma_ut, filtered_field_ut, total_field_ut, heading, attitude, sigma_t, window, coverage, direction_sigma_deg, worst_sigma_deg, model_order, mode, event, status } = it;
        Self {
            time_ns,
            field_ut: field_ut.map(Into::into),
            field_sigma_ut,
            filtered_field_ut: filtered_field_ut.map(Into::into),
            total_field_ut,
            heading: heading.map(Into::into),
            attitude: attitude.map(Into::into),
            sigma_t,
            window: count(window),
            coverage,
            direction_sigma_deg,
            worst_sigma_deg,
            model_order: model_order.map(Into::into),
            reported_hard_iron_jump_ut: None,
            mode: mode.into(),
            event: event.map(Into::into),
            status: status.into(),
        }
    }
}

/// `MagcompEvent`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct FlatEvent {
    pub(crate) kind: i32,
    pub(crate) since_ns: i64,
    pub(crate) decided_ns: i64,
}

/// `MagcompReading`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct FlatReading {
    pub(crate) field_ut: [f64; 3],
    pub(crate) field_sigma_ut: f64,
    pub(crate) filtered_field_ut: [f64; 3],
    pub(crate) total_field_ut: f64,
    pub(crate) heading_deg: f64,
    pub(crate) heading_sigma_deg: f64,
    pub(crate) true_heading_deg: f64,
    pub(crate) inclination_deg: f64,
    pub(crate) attitude_w: f64,
    pub(crate) attitude_x: f64,
    pub(crate) attitude_y: f64,
    pub(crate) attitude_z: f64,
    pub(crate) attitude_sigma_deg: f64,
    pub(crate) sigma_t: f64,
    pub(crate) window: i32,
    pub(crate) coverage: f64,
    pub(crate) direction_sigma_deg: f64,
    pub(crate) worst_sigma_deg: f64,
    pub(crate) model_order: i32,
    pub(crate) reported_hard_iron_jump_ut: f64,
    pub(crate) mode: i32,
    pub(crate) event: FlatEvent,
    pub(crate) status: FlatStatus,
}

impl FlatReading {
    /// What the core's reading does not have comes beside it.
    pub(crate) fn of(it: &magcomp::Reading, reported_hard_iron_jump_ut: Option<f64>) -> Self {
        // the time is the caller's own
        let magcomp::Reading { time_ns: _, field_ut, field_sigma_ut, filtered_field_ut, total_field_ut, heading, attitude, sigma_t, window, coverage, direction_sigma_deg, worst_sigma_deg, model_order, mode, event, status } = *it;
        let vector = |v: Option<nalgebra::Vector3<f64>>| v.map_or([f64::NAN; 3], Into::into);
        let number = |v: Option<f64>| v.unwrap_or(f64::NAN);
        let heading = heading.map(Heading::from);
        let attitude = attitude.map(Attitude::from);
        Self {
            field_ut: vector(field_ut),
            field_sigma_ut: number(field_sigma_ut),
            filtered_field_ut: vector(filtered_field_ut),
            total_field_ut: number(total_field_ut),
            heading_deg: number(heading.map(|it| it.heading_deg)),
            heading_sigma_deg: number(heading.and_then(|it| it.heading_sigma_deg)),
            true_heading_deg: number(heading.and_then(|it| it.true_heading_deg)),
            inclination_deg: number(heading.and_then(|it| it.inclination_deg)),
            attitude_w: number(attitude.map(|it| it.w)),
            attitude_x: number(attitude.map(|it| it.x)),
            attitude_y: number(attitude.map(|it| it.y)),
            attitude_z: number(attitude.map(|it| it.z)),
            attitude_sigma_deg: number(attitude.and_then(|it| it.sigma_deg)),
            sigma_t: number(sigma_t),
            window: count(window),
            coverage,
            direction_sigma_deg: number(direction_sigma_deg),
            worst_sigma_deg: number(worst_sigma_deg),
            model_order: model_order.map_or(NONE, |it| ModelOrder::from(it).code()),
            reported_hard_iron_jump_ut: number(reported_hard_iron_jump_ut),
            mode: SensorMode::from(mode).code(),
            event: event.map_or(FlatEvent { kind: NONE, since_ns: 0, decided_ns: 0 }, |it| FlatEvent {
                kind: EventKind::from(it.kind).code(),
                since_ns: it.since_ns,
                decided_ns: it.decided_ns,
            }),
            status: Status::from(status).into(),
        }
    }
}
