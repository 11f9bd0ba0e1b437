//! A reading and an answer as plain numbers, for the paths that carry no records: C as it stands, JNI written out as doubles.
//!
//! `include/magcomp.h` says what every number means. `status` has the cases' codes; what is not known is NaN, or -1 where a number is a code.

use crate::compensator::Compensator;
use crate::error::MagcompError;
use crate::reading::FlatReading;
use crate::record::{MagneticSample, RotationRateSample, UpSample, Vector3};

/// The handle's object is closed or gone.
pub(crate) const CLOSED: i32 = -1;
/// A panic was caught, now or before.
pub(crate) const PANICKED: i32 = -2;
/// An event was accepted; a rejected one answers 1 or more, by its reason.
pub(crate) const ACCEPTED: i32 = 0;
/// No case, where a number counts cases.
pub(crate) const NONE: i32 = -1;

/// `MagcompStatus`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct FlatStatus {
    pub(crate) kind: i32,
    pub(crate) reason: i32,
    pub(crate) problem: i32,
    pub(crate) whole: [i64; 2],
    pub(crate) real: [f64; 3],
}

/// `MagcompEvent`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct FlatEvent {
    pub(crate) kind: i32,
    pub(crate) since_ns: i64,
    pub(crate) decided_ns: i64,
}

/// A raw magnetometer event, uT; `reported_ut` is the operating system's own hard iron, NaN for none.
pub(crate) fn push(
    compensator: &Compensator,
    time_ns: i64,
    field_ut: Vector3,
    reported_ut: Vector3,
) -> Result<FlatReading, i32> {
    let known = !(reported_ut.x.is_nan() || reported_ut.y.is_nan() || reported_ut.z.is_nan());
    let sample = MagneticSample { time_ns, field_ut, reported_hard_iron_ut: known.then_some(reported_ut) };
    compensator.push_for(sample, FlatReading::of).map_err(|error| code_of(&error))
}

/// A gyroscope event, rad/s.
pub(crate) fn push_rotation_rate(compensator: &Compensator, time_ns: i64, rate_rad_s: Vector3) -> i32 {
    event_code(compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s }))
}

/// An accelerometer or gravity event, m/s^2, pointing up.
pub(crate) fn push_up(compensator: &Compensator, time_ns: i64, up_m_s2: Vector3) -> i32 {
    event_code(compensator.push_up(UpSample { time_ns, up_m_s2 }))
}

pub(crate) fn event_code(result: Result<(), MagcompError>) -> i32 {
    match result {
        Ok(()) => ACCEPTED,
        Err(MagcompError::EventRejected { reason }) => reason.code(),
        Err(error) => code_of(&error),
    }
}

pub(crate) fn code_of(error: &MagcompError) -> i32 {
    match error {
        MagcompError::Panicked { .. } => PANICKED,
        // no other error comes from those who ask
        _ => CLOSED,
    }
}

impl FlatStatus {
    pub(crate) const fn of(kind: i32, reason: i32) -> Self {
        Self { kind, reason, problem: NONE, whole: [0; 2], real: [f64::NAN; 3] }
    }

    pub(crate) const fn whole(self, first: i64, second: i64) -> Self {
        Self { whole: [first, second], ..self }
    }

    pub(crate) const fn real(self, first: f64, second: f64, third: f64) -> Self {
        Self { real: [first, second, third], ..self }
    }
}
