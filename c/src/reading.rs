//! `magcomp_reading`.

use crate::grows::Grows;
use crate::status::{Event, FitProblem, Mode, ModelOrder, Reason, Status, told};
use magcomp_core::nalgebra::Vector3;
use std::mem::offset_of;

/// The answer to one magnetic sample. Numbers that are not known are NaN.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Reading {
    /// sizeof(magcomp_reading).
    pub size: usize,
    /// Time of the sample, ns.
    pub time_ns: i64,
    /// The corrected sample M^-1 (h_m - b), uT, device axes.
    pub field_ut: [f64; 3],
    /// The estimator's own, smoother estimate of it, uT; the heading comes from it.
    pub filtered_field_ut: [f64; 3],
    /// One standard deviation of `field_ut` per axis, uT.
    pub field_sigma_ut: f64,
    /// |field_ut|, uT.
    pub total_field_ut: f64,
    /// Clockwise from magnetic north, 0 to 360 deg, of the axis that the setting `heading.axis` names.
    pub heading_deg: f64,
    /// One standard deviation of `heading_deg`, 0 to 180 deg.
    pub heading_sigma_deg: f64,
    /// Clockwise from true north, 0 to 360 deg; where the setting `heading.declination_deg` is.
    pub true_heading_deg: f64,
    /// Angle of the field below the horizon, -90 to 90 deg; where a field is known: a north from outside needs none.
    pub inclination_deg: f64,
    /// The unit quaternion w, x, y, z that takes device axes to east, north (magnetic) and up; w is at least 0.
    pub attitude: [f64; 4],
    /// Root of the sum of the variances of the attitude's error about three axes, 0 to 180 deg.
    pub attitude_sigma_deg: f64,
    /// sigma_T, no unit: how evenly the latest directions are spread.
    pub sigma_t: f64,
    /// Share of the directions that were seen of late, 0 to 1.
    pub coverage: f64,
    /// Expected direction error of the calibration over all directions, 0 to 180 deg.
    pub direction_sigma_deg: f64,
    /// The same for the one combination of parameters that is known worst, deg; without a gyroscope only.
    pub worst_sigma_deg: f64,
    /// Samples that the estimator looks at.
    pub window: u64,
    /// Of SUSPECT and DISTURBED: time of the first sample that did not fit, ns; else 0.
    pub status_since_ns: i64,
    /// Of the latest event: time of the first sample that did not fit any longer, ns; 0 where there is none.
    pub event_since_ns: i64,
    /// Of the latest event: when it was decided, ns; 0 where there is none.
    pub event_decided_ns: i64,
    /// What the compensator is doing.
    pub status: Status,
    /// Why.
    pub reason: Reason,
    /// Of FIT and FIT_REFUSED.
    pub fit_problem: FitProblem,
    /// The latest change that was decided; it stays until the next.
    pub event: Event,
    /// The sensors that the estimator runs on.
    pub mode: Mode,
    /// Which parameters the latest change set free; without a gyroscope only.
    pub model_order: ModelOrder,
}

// SAFETY: it is as the trait asks; nothing is read of the caller's but the size
unsafe impl Grows for Reading {
    const NAME: &str = "magcomp_reading";
    const FIRST: usize = offset_of!(Self, model_order) + size_of::<ModelOrder>();
}

impl From<&magcomp_core::Reading> for Reading {
    fn from(reading: &magcomp_core::Reading) -> Self {
        let magcomp_core::Reading {
            time_ns,
            field_ut,
            filtered_field_ut,
            field_sigma_ut,
            total_field_ut,
            heading,
            attitude,
            sigma_t,
            window,
            coverage,
            direction_sigma_deg,
            worst_sigma_deg,
            model_order,
            mode,
            event,
            status,
        } = *reading;
        let vector = |v: Option<Vector3<f64>>| v.map_or([f64::NAN; 3], Into::into);
        let number = |v: Option<f64>| v.unwrap_or(f64::NAN);
        let (status, reason, fit_problem, status_since_ns) = told(&status);
        Self {
            size: size_of::<Self>(),
            time_ns,
            field_ut: vector(field_ut),
            filtered_field_ut: vector(filtered_field_ut),
            field_sigma_ut: number(field_sigma_ut),
            total_field_ut: number(total_field_ut),
            heading_deg: number(heading.map(|it| it.heading_deg)),
            heading_sigma_deg: number(heading.and_then(|it| it.heading_sigma_deg)),
            true_heading_deg: number(heading.and_then(|it| it.true_heading_deg)),
            inclination_deg: number(heading.and_then(|it| it.inclination_deg)),
            attitude: attitude.map_or([f64::NAN; 4], |it| {
                let q = it.to_world;
                [q.w, q.i, q.j, q.k]
            }),
            attitude_sigma_deg: number(attitude.and_then(|it| it.sigma_deg)),
            sigma_t: number(sigma_t),
            coverage,
            direction_sigma_deg: number(direction_sigma_deg),
            worst_sigma_deg: number(worst_sigma_deg),
            window: window as u64,
            status_since_ns,
            event_since_ns: event.map_or(0, |it| it.since_ns),
            event_decided_ns: event.map_or(0, |it| it.decided_ns),
            status,
            reason,
            fit_problem,
            event: event.map_or(Event::None, |it| it.kind.into()),
            mode: mode.into(),
            model_order: model_order.map_or(ModelOrder::None, Into::into),
        }
    }
}
