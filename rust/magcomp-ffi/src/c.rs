//! The C path for Swift: plain numbers in, one struct out, no allocation. `include/magcomp.h` declares it and says what
//! every answer means; Swift's `Compensator` reads the struct, and its test compares every status with what uniffi says.
//!
//! `handles` finds the object, so that no caller holds a pointer. `out` is a checked reference: null is an answer.

// the exported names are `#[unsafe(no_mangle)]`; there is no other unsafe code here
#![allow(unsafe_code)]

use crate::compensator::Compensator;
use crate::error::MagcompError;
use crate::record::{MagneticSample, Reading, RotationRateSample, UpSample, Vector3};
use crate::status::{
    EventKind, EventRejection, FitProblem, HoldReason, Missing, ModelOrder, RejectReason, SensorMode, Status,
};

const CLOSED: i32 = -1;
const PANICKED: i32 = -2;
const NO_ROOM: i32 = -3;
const ACCEPTED: i32 = 0;
/// No case, where a number counts cases.
const NONE: i32 = -1;

/// As in `include/magcomp.h`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct CStatus {
    kind: i32,
    reason: i32,
    problem: i32,
    whole: [i64; 2],
    real: [f64; 3],
}

/// As in `include/magcomp.h`.
#[repr(C)]
pub struct CEvent {
    kind: i32,
    since_ns: i64,
    decided_ns: i64,
}

/// As in `include/magcomp.h`.
#[repr(C)]
pub struct CReading {
    field_ut: [f64; 3],
    field_sigma_ut: f64,
    filtered_field_ut: [f64; 3],
    total_field_ut: f64,
    heading_deg: f64,
    heading_sigma_deg: f64,
    true_heading_deg: f64,
    inclination_deg: f64,
    sigma_t: f64,
    coverage: f64,
    direction_sigma_deg: f64,
    worst_sigma_deg: f64,
    reported_hard_iron_jump_ut: f64,
    window: i32,
    mode: i32,
    model_order: i32,
    event: CEvent,
    status: CStatus,
}

/// A raw magnetometer event.
#[allow(clippy::too_many_arguments)]
#[unsafe(no_mangle)]
pub extern "C" fn magcomp_push(
    handle: i64,
    time_ns: i64,
    x: f64,
    y: f64,
    z: f64,
    bx: f64,
    by: f64,
    bz: f64,
    out: Option<&mut CReading>,
) -> i32 {
    let Some(compensator) = crate::handles::find(handle) else { return CLOSED };
    let Some(out) = out else { return NO_ROOM };
    let known = !(bx.is_nan() || by.is_nan() || bz.is_nan());
    let reported_hard_iron_ut = known.then_some(Vector3 { x: bx, y: by, z: bz });
    match compensator.push(MagneticSample { time_ns, field_ut: Vector3 { x, y, z }, reported_hard_iron_ut }) {
        Ok(reading) => {
            *out = reading.into();
            ACCEPTED
        }
        Err(error) => code_of(&error),
    }
}

/// A gyroscope event.
#[unsafe(no_mangle)]
pub extern "C" fn magcomp_push_rotation_rate(handle: i64, time_ns: i64, x: f64, y: f64, z: f64) -> i32 {
    event(handle, |to| to.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s: Vector3 { x, y, z } }))
}

/// An accelerometer or gravity event.
#[unsafe(no_mangle)]
pub extern "C" fn magcomp_push_up(handle: i64, time_ns: i64, x: f64, y: f64, z: f64) -> i32 {
    event(handle, |to| to.push_up(UpSample { time_ns, up_m_s2: Vector3 { x, y, z } }))
}

fn event(handle: i64, push: impl FnOnce(&Compensator) -> Result<(), MagcompError>) -> i32 {
    let Some(compensator) = crate::handles::find(handle) else { return CLOSED };
    match push(&compensator) {
        Ok(()) => ACCEPTED,
        Err(MagcompError::EventRejected { reason }) => match reason {
            EventRejection::NotFinite => 1,
            EventRejection::OutOfRange => 2,
            EventRejection::Late => 3,
            EventRejection::Duplicate => 4,
            EventRejection::Ahead => 5,
        },
        Err(error) => code_of(&error),
    }
}

fn code_of(error: &MagcompError) -> i32 {
    match error {
        MagcompError::Panicked { .. } => PANICKED,
        // no other error comes from the three pushes
        _ => CLOSED,
    }
}

impl From<Reading> for CReading {
    fn from(reading: Reading) -> Self {
        let Reading {
            time_ns: _, // the caller's own
            field_ut,
            field_sigma_ut,
            filtered_field_ut,
            total_field_ut,
            heading,
            sigma_t,
            window,
            coverage,
            direction_sigma_deg,
            worst_sigma_deg,
            model_order,
            reported_hard_iron_jump_ut,
            mode,
            event,
            status,
        } = reading;
        let vector = |v: Option<Vector3>| v.map_or([f64::NAN; 3], |v| [v.x, v.y, v.z]);
        let number = |v: Option<f64>| v.unwrap_or(f64::NAN);
        Self {
            field_ut: vector(field_ut),
            field_sigma_ut: number(field_sigma_ut),
            filtered_field_ut: vector(filtered_field_ut),
            total_field_ut: number(total_field_ut),
            heading_deg: number(heading.map(|heading| heading.heading_deg)),
            heading_sigma_deg: number(heading.and_then(|heading| heading.heading_sigma_deg)),
            true_heading_deg: number(heading.and_then(|heading| heading.true_heading_deg)),
            inclination_deg: number(heading.map(|heading| heading.inclination_deg)),
            sigma_t: number(sigma_t),
            coverage,
            direction_sigma_deg: number(direction_sigma_deg),
            worst_sigma_deg: number(worst_sigma_deg),
            reported_hard_iron_jump_ut: number(reported_hard_iron_jump_ut),
            window,
            mode: match mode {
                SensorMode::GyroscopeAndGravity => 0,
                SensorMode::GyroscopeOnly => 1,
                SensorMode::GravityOnly => 2,
                SensorMode::MagnetometerOnly => 3,
            },
            model_order: model_order.map_or(NONE, |order| match order {
                ModelOrder::Nothing => 0,
                ModelOrder::HardIron => 1,
                ModelOrder::Diagonal => 2,
                ModelOrder::All => 3,
                ModelOrder::Former => 4,
            }),
            event: event.map_or(CEvent { kind: NONE, since_ns: 0, decided_ns: 0 }, |event| CEvent {
                kind: match event.kind {
                    EventKind::DeviceStep => 0,
                    EventKind::DeviceStepBack => 1,
                    EventKind::PlaceChanged => 2,
                    EventKind::Erratic => 3,
                },
                since_ns: event.since_ns,
                decided_ns: event.decided_ns,
            }),
            status: status.into(),
        }
    }
}

impl CStatus {
    const fn of(kind: i32, reason: i32) -> Self {
        Self { kind, reason, problem: NONE, whole: [0; 2], real: [f64::NAN; 3] }
    }

    const fn whole(self, first: i64, second: i64) -> Self {
        Self { whole: [first, second], ..self }
    }

    const fn real(self, first: f64, second: f64, third: f64) -> Self {
        Self { real: [first, second, third], ..self }
    }

    fn with(self, problem: FitProblem) -> Self {
        let none = f64::NAN;
        let case = |problem| Self { problem, ..self };
        match problem {
            FitProblem::TooFewSamples { have } => case(0).whole(have.into(), 0),
            FitProblem::Planar { thickness_ut } => case(1).real(thickness_ut, none, none),
            FitProblem::PoorCoverage { direction_sigma_deg, limit_deg } => {
                case(2).real(direction_sigma_deg, limit_deg, none)
            }
            FitProblem::Inconsistent { residual_ut, limit_ut } => case(3).real(residual_ut, limit_ut, none),
            FitProblem::NotAnEllipsoid => case(4),
            FitProblem::FieldOutOfRange { field_ut, low_ut, high_ut } => case(5).real(field_ut, low_ut, high_ut),
            FitProblem::NotFinite => case(6),
        }
    }
}

impl From<Status> for CStatus {
    fn from(status: Status) -> Self {
        let none = f64::NAN;
        match status {
            Status::Collecting { missing } => match missing {
                Missing::Samples { have, need } => Self::of(0, 0).whole(have.into(), need.into()),
                Missing::Fit { problem } => Self::of(0, 1).with(problem),
                Missing::Rotation => Self::of(0, 2),
                Missing::Directions => Self::of(0, 3),
            },
            Status::Tracking => Self::of(1, NONE),
            Status::Suspect { since_ns } => Self::of(2, NONE).whole(since_ns, 0),
            Status::Held { reason } => match reason {
                HoldReason::LowUniformity => Self::of(3, 0),
                HoldReason::FitRefused { problem } => Self::of(3, 1).with(problem),
                HoldReason::Constant => Self::of(3, 2),
                HoldReason::AtRest => Self::of(3, 3),
                HoldReason::TooLittleRotation => Self::of(3, 4),
                HoldReason::NoGyroscope => Self::of(3, 5),
            },
            Status::Disturbed { since_ns } => Self::of(4, NONE).whole(since_ns, 0),
            Status::Rejected { reason } => match reason {
                RejectReason::NotFinite => Self::of(5, 0),
                RejectReason::OutOfRange { value_ut, limit_ut } => Self::of(5, 1).real(value_ut, limit_ut, none),
                RejectReason::Saturated { value_ut, rail_ut } => Self::of(5, 2).real(value_ut, rail_ut, none),
                RejectReason::TimeNotAfter { time_ns, latest_ns } => Self::of(5, 3).whole(time_ns, latest_ns),
                RejectReason::TimeJump { gap_s, limit_s } => Self::of(5, 4).real(gap_s, limit_s, none),
                RejectReason::Stuck { repeats } => Self::of(5, 5).whole(repeats.into(), 0),
            },
        }
    }
}

/// For tests alone; see the feature in Cargo.toml. `include/magcomp_test_hooks.h` declares them.
#[cfg(feature = "test-hooks")]
mod hooks {
    use super::*;
    use std::hint::black_box;
    use std::sync::{Mutex, PoisonError};
    use std::time::Instant;

    /// Panics inside the object.
    #[unsafe(no_mangle)]
    pub extern "C" fn magcomp_test_panic(handle: i64) -> i32 {
        event(handle, Compensator::panic_on_purpose)
    }

    /// What one of Rust's example statuses looks like; how many there are.
    #[unsafe(no_mangle)]
    pub extern "C" fn magcomp_test_status(index: i32, out: Option<&mut CStatus>) -> i32 {
        let examples = crate::status::examples();
        if let (Some(status), Some(out)) = (usize::try_from(index).ok().and_then(|k| examples.get(k)), out) {
            *out = (*status).into();
        }
        examples.len() as i32
    }

    #[derive(Clone, Copy)]
    enum Event {
        Magnetic(magcomp::MagneticSample),
        RotationRate(magcomp::RotationRateSample),
        Up(magcomp::UpSample),
    }

    static EVENTS: Mutex<Vec<Event>> = Mutex::new(Vec::new());

    /// Keeps an event for `magcomp_test_bare_ns`: 0 magnetic, 1 rotation rate, 2 up; any other forgets all.
    #[unsafe(no_mangle)]
    pub extern "C" fn magcomp_test_bare_add(kind: i32, time_ns: i64, x: f64, y: f64, z: f64) {
        let mut events = EVENTS.lock().unwrap_or_else(PoisonError::into_inner);
        let value = magcomp::nalgebra::Vector3::new(x, y, z);
        match kind {
            0 => events.push(Event::Magnetic(magcomp::MagneticSample { time_ns, field_ut: value })),
            1 => events.push(Event::RotationRate(magcomp::RotationRateSample { time_ns, rate_rad_s: value })),
            2 => events.push(Event::Up(magcomp::UpSample { time_ns, up_m_s2: value })),
            _ => events.clear(),
        }
    }

    /// Nanoseconds the core itself takes for these events: with the default method (0), the paper's (1) or a constant
    /// calibration (2).
    #[unsafe(no_mangle)]
    pub extern "C" fn magcomp_test_bare_ns(method: i32) -> i64 {
        use magcomp::Method::{Auto, Constant, Windowed};
        let method = [Auto, Windowed, Constant][method.clamp(0, 2) as usize];
        let Ok(mut core) = magcomp::Compensator::new(magcomp::Config { method, ..Default::default() }) else {
            return -1;
        };
        let events = EVENTS.lock().unwrap_or_else(PoisonError::into_inner).clone();
        let begin = Instant::now();
        for event in events {
            match event {
                Event::Magnetic(sample) => {
                    black_box(core.push(sample));
                }
                Event::RotationRate(sample) => {
                    let _ = black_box(core.push_rotation_rate(sample));
                }
                Event::Up(sample) => {
                    let _ = black_box(core.push_up(sample));
                }
            }
        }
        i64::try_from(begin.elapsed().as_nanos()).unwrap_or(i64::MAX)
    }
}
