//! `magcomp_reading` and the enums in it.

use crate::grows::Grows;
use magcomp_core::nalgebra::Vector3;
use magcomp_core::{EventKind, FitError, HoldReason, Missing, RejectReason, SensorMode};
use std::mem::offset_of;

/// What the compensator is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Status {
    /// There is no calibration yet; `reason` says what is missing.
    Collecting = 0,
    /// Calibrated, and following changes.
    Tracking = 1,
    /// Something changed, since `status_since_ns`; not yet decided whether the device or the place.
    Suspect = 2,
    /// Calibrated, but not learning; `reason` says why.
    Held = 3,
    /// The place is disturbed, since `status_since_ns`, not the device; the calibration is kept.
    Disturbed = 4,
    /// This sample was not used, and changed nothing; `reason` says why. 50 in a row whose times follow one another and not the latest used sample's are
    /// taken for another clock: the calibration stays, all else begins anew.
    Rejected = 5,
}

/// Why the status is what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Reason {
    /// The status says it all.
    None = 0,
    /// Collecting: too few samples.
    Samples = 1,
    /// Collecting: the device was hardly turned.
    Rotation = 2,
    /// Collecting: the device was not turned about enough axes.
    Directions = 3,
    /// Collecting: the samples allow no fit; see `fit_problem`.
    Fit = 4,
    /// Held: the device lies still.
    AtRest = 5,
    /// Held: the device was hardly turned of late.
    TooLittleRotation = 6,
    /// Held, by the method `Windowed` alone: the latest orientations are too much alike.
    LowUniformity = 7,
    /// Held: the latest fit was refused, or no place on Earth has such a field; see `fit_problem`.
    FitRefused = 8,
    /// Held: the gyroscope is gone or reads nonsense; the magnetometer alone takes over within a second.
    NoGyroscope = 9,
    /// Held, by the method `Constant` alone: it follows no changes.
    Constant = 10,
    /// Rejected: a component is NaN or infinite.
    NotFinite = 11,
    /// Rejected: a component is beyond the setting `range_ut`. Is the unit microtesla?
    OutOfRange = 12,
    /// Rejected: a component is at the sensor's full scale, the setting `rail_ut` or as found. A gyroscope carries the heading on.
    Saturated = 13,
    /// Rejected: time did not advance.
    TimeNotAfter = 14,
    /// Rejected: time jumped ahead further than any pause. Is the unit nanoseconds?
    TimeJump = 15,
    /// Rejected: the same value to the last bit for too long: the sensor hangs.
    Stuck = 16,
    /// Rejected: the field turns as if the magnetometer had other axes than the gyroscope; the status' text says which.
    Axes = 17,
}

/// Why samples allow no fit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum FitProblem {
    /// `reason` is about no fit.
    None = 0,
    /// Fewer than nine.
    TooFewSamples = 1,
    /// They lie in one plane.
    Planar = 2,
    /// The directions seen leave too large an error.
    PoorCoverage = 3,
    /// They lie on no one ellipsoid: something changed meanwhile.
    Inconsistent = 4,
    /// A surface that is no ellipsoid fits best.
    NotAnEllipsoid = 5,
    /// A field strength that no place on Earth has. Is the unit microtesla?
    FieldOutOfRange = 6,
    /// One is NaN or infinite.
    NotFinite = 7,
}

/// A change that was decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Event {
    /// None yet.
    None = 0,
    /// The device's own disturbance changed (a cover was put on), and was relearned.
    DeviceStep = 1,
    /// The device is as it was before (the cover was taken off); that calibration was restored.
    DeviceStepBack = 2,
    /// The field of the place changed; the calibration is held.
    PlaceChanged = 3,
}

/// The sensors that the estimator runs on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Mode {
    /// Magnetometer, gyroscope and accelerometer.
    GyroscopeAndGravity = 0,
    /// No accelerometer: no heading.
    GyroscopeOnly = 1,
    /// No usable gyroscope: changes are followed slower.
    GravityOnly = 2,
    /// The magnetometer alone: no heading.
    MagnetometerOnly = 3,
}

/// Which parameters the latest change set free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum ModelOrder {
    /// The estimator does not tell.
    None = 0,
    /// No parameter.
    Nothing = 1,
    /// b alone.
    HardIron = 2,
    /// All nine.
    All = 3,
    /// Back to a calibration from before.
    Former = 4,
}

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
            event: event.map_or(Event::None, |it| match it.kind {
                EventKind::DeviceStep => Event::DeviceStep,
                EventKind::DeviceStepBack => Event::DeviceStepBack,
                EventKind::PlaceChanged => Event::PlaceChanged,
            }),
            mode: match mode {
                SensorMode::GyroscopeAndGravity => Mode::GyroscopeAndGravity,
                SensorMode::GyroscopeOnly => Mode::GyroscopeOnly,
                SensorMode::GravityOnly => Mode::GravityOnly,
                SensorMode::MagnetometerOnly => Mode::MagnetometerOnly,
            },
            model_order: model_order.map_or(ModelOrder::None, |it| match it {
                magcomp_core::ModelOrder::Nothing => ModelOrder::Nothing,
                magcomp_core::ModelOrder::HardIron => ModelOrder::HardIron,
                magcomp_core::ModelOrder::All => ModelOrder::All,
                magcomp_core::ModelOrder::Former => ModelOrder::Former,
            }),
        }
    }
}

/// Status, reason, problem of a fit, and since when, ns.
fn told(status: &magcomp_core::Status) -> (Status, Reason, FitProblem, i64) {
    let because = |status, reason| (status, reason, FitProblem::None, 0);
    let since = |status, since_ns| (status, Reason::None, FitProblem::None, since_ns);
    match status {
        magcomp_core::Status::Collecting(missing) => match missing {
            Missing::Samples { .. } => because(Status::Collecting, Reason::Samples),
            Missing::Rotation => because(Status::Collecting, Reason::Rotation),
            Missing::Directions => because(Status::Collecting, Reason::Directions),
            Missing::Fit(error) => (Status::Collecting, Reason::Fit, (*error).into(), 0),
        },
        magcomp_core::Status::Tracking => because(Status::Tracking, Reason::None),
        magcomp_core::Status::Suspect { since_ns } => since(Status::Suspect, *since_ns),
        magcomp_core::Status::Held(reason) => match reason {
            HoldReason::AtRest => because(Status::Held, Reason::AtRest),
            HoldReason::TooLittleRotation => because(Status::Held, Reason::TooLittleRotation),
            HoldReason::LowUniformity => because(Status::Held, Reason::LowUniformity),
            HoldReason::FitRefused(error) => (Status::Held, Reason::FitRefused, (*error).into(), 0),
            HoldReason::NoGyroscope => because(Status::Held, Reason::NoGyroscope),
            HoldReason::Constant => because(Status::Held, Reason::Constant),
        },
        magcomp_core::Status::Disturbed { since_ns } => since(Status::Disturbed, *since_ns),
        magcomp_core::Status::Rejected(reason) => {
            let reason = match reason {
                RejectReason::NotFinite => Reason::NotFinite,
                RejectReason::OutOfRange { .. } => Reason::OutOfRange,
                RejectReason::Saturated { .. } => Reason::Saturated,
                RejectReason::TimeNotAfter { .. } => Reason::TimeNotAfter,
                RejectReason::TimeJump { .. } => Reason::TimeJump,
                RejectReason::Stuck { .. } => Reason::Stuck,
                RejectReason::Axes { .. } => Reason::Axes,
            };
            because(Status::Rejected, reason)
        }
    }
}

impl From<FitError> for FitProblem {
    fn from(error: FitError) -> Self {
        match error {
            FitError::TooFewSamples { .. } => FitProblem::TooFewSamples,
            FitError::Planar { .. } => FitProblem::Planar,
            FitError::PoorCoverage { .. } => FitProblem::PoorCoverage,
            FitError::Inconsistent { .. } => FitProblem::Inconsistent,
            FitError::NotAnEllipsoid => FitProblem::NotAnEllipsoid,
            FitError::FieldOutOfRange { .. } => FitProblem::FieldOutOfRange,
            FitError::NotFinite => FitProblem::NotFinite,
        }
    }
}
