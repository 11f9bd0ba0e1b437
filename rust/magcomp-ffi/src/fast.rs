//! The JNI fast path: primitives in, a caller-owned array out, no allocation on either side.
//!
//! `org.magcomp.FastPath` declares these functions; `handles` finds the object. Each answers a number: 0 or more is an
//! answer, below 0 an error of this list. The array's layout is `Slot`; `ReadingBuffer` in Kotlin reads it, and its test
//! compares every status with what uniffi says.

// the exported names are `#[unsafe(no_mangle)]`; there is no other unsafe code here
#![allow(unsafe_code)]

use crate::compensator::Compensator;
use crate::error::MagcompError;
use crate::java::{Env, JavaArray};
use crate::record::{MagneticSample, Reading, RotationRateSample, UpSample, Vector3};
use crate::status::{
    EventKind, EventRejection, FitProblem, HoldReason, Missing, ModelOrder, RejectReason, SensorMode, Status,
};
use jni::jni_mangle;
use jni::sys::{jclass, jdouble, jint, jlong};

/// The handle's object is closed or gone.
const CLOSED: jint = -1;
/// A panic was caught, now or before.
const PANICKED: jint = -2;
/// An array is too short.
const TOO_SHORT: jint = -3;
/// A batch holds a kind of event that does not exist.
const NO_SUCH_KIND: jint = -4;

/// An event was accepted; a rejected one answers 1 or more, by its reason.
const ACCEPTED: jint = 0;

/// What `out` holds, in doubles. What is not known is NaN.
mod slot {
    pub(super) const STATUS: usize = 0;
    pub(super) const REASON: usize = 1;
    /// Two numbers of the reason or of the status.
    pub(super) const DETAILS: usize = 2;
    pub(super) const FIT_PROBLEM: usize = 4;
    /// Three numbers of the fit problem.
    pub(super) const FIT_DETAILS: usize = 5;
    pub(super) const FIELD: usize = 8;
    pub(super) const FILTERED_FIELD: usize = 11;
    pub(super) const TOTAL_FIELD: usize = 14;
    pub(super) const HEADING: usize = 15;
    pub(super) const HEADING_SIGMA: usize = 16;
    pub(super) const TRUE_HEADING: usize = 17;
    pub(super) const INCLINATION: usize = 18;
    pub(super) const SIGMA_T: usize = 19;
    pub(super) const WINDOW: usize = 20;
    pub(super) const COVERAGE: usize = 21;
    pub(super) const REPORTED_JUMP: usize = 22;
    pub(super) const FIELD_SIGMA: usize = 23;
    pub(super) const MODE: usize = 24;
    /// The kind, and two times of two numbers each.
    pub(super) const EVENT: usize = 25;
    pub(super) const DIRECTION_SIGMA: usize = 30;
    pub(super) const WORST_SIGMA: usize = 31;
    pub(super) const ORDER: usize = 32;
    pub(super) const COUNT: usize = 33;
}

type Slots = [f64; slot::COUNT];

/// A time as two numbers a double holds exactly: the upper and the lower 32 bits.
fn halves(time_ns: i64) -> [f64; 2] {
    [(time_ns >> 32) as f64, (time_ns & 0xffff_ffff) as f64]
}

fn write_reading(reading: &Reading) -> Slots {
    let mut out = [f64::NAN; slot::COUNT];
    write_status(&reading.status, &mut out);
    write_vector(reading.field_ut, slot::FIELD, &mut out);
    write_vector(reading.filtered_field_ut, slot::FILTERED_FIELD, &mut out);
    let unknown = f64::NAN;
    out[slot::TOTAL_FIELD] = reading.total_field_ut.unwrap_or(unknown);
    if let Some(heading) = &reading.heading {
        out[slot::HEADING] = heading.heading_deg;
        out[slot::HEADING_SIGMA] = heading.heading_sigma_deg.unwrap_or(unknown);
        out[slot::TRUE_HEADING] = heading.true_heading_deg.unwrap_or(unknown);
        out[slot::INCLINATION] = heading.inclination_deg;
    }
    out[slot::SIGMA_T] = reading.sigma_t.unwrap_or(unknown);
    out[slot::WINDOW] = f64::from(reading.window);
    out[slot::COVERAGE] = reading.coverage;
    out[slot::REPORTED_JUMP] = reading.reported_hard_iron_jump_ut.unwrap_or(unknown);
    out[slot::FIELD_SIGMA] = reading.field_sigma_ut.unwrap_or(unknown);
    out[slot::MODE] = f64::from(match reading.mode {
        SensorMode::GyroscopeAndGravity => 0,
        SensorMode::GyroscopeOnly => 1,
        SensorMode::GravityOnly => 2,
        SensorMode::MagnetometerOnly => 3,
    });
    out[slot::DIRECTION_SIGMA] = reading.direction_sigma_deg.unwrap_or(unknown);
    out[slot::WORST_SIGMA] = reading.worst_sigma_deg.unwrap_or(unknown);
    out[slot::ORDER] = reading.model_order.map_or(unknown, |order| {
        f64::from(match order {
            ModelOrder::Nothing => 0,
            ModelOrder::HardIron => 1,
            ModelOrder::Diagonal => 2,
            ModelOrder::All => 3,
            ModelOrder::Former => 4,
        })
    });
    if let Some(event) = &reading.event {
        out[slot::EVENT] = f64::from(match event.kind {
            EventKind::DeviceStep => 0,
            EventKind::DeviceStepBack => 1,
            EventKind::PlaceChanged => 2,
            EventKind::Erratic => 3,
        });
        out[slot::EVENT + 1..slot::EVENT + 3].copy_from_slice(&halves(event.since_ns));
        out[slot::EVENT + 3..slot::EVENT + 5].copy_from_slice(&halves(event.decided_ns));
    }
    out
}

fn write_vector(v: Option<Vector3>, at: usize, out: &mut Slots) {
    if let Some(v) = v {
        out[at..at + 3].copy_from_slice(&[v.x, v.y, v.z]);
    }
}

fn write_status(status: &Status, out: &mut Slots) {
    out[slot::STATUS] = f64::from(status_code(status));
    let details: [f64; 2] = match *status {
        Status::Collecting { missing } => {
            let (code, details) = match missing {
                Missing::Samples { have, need } => (0, [have.into(), need.into()]),
                Missing::Fit { problem } => {
                    write_fit_problem(&problem, out);
                    (1, [f64::NAN; 2])
                }
                Missing::Rotation => (2, [f64::NAN; 2]),
                Missing::Directions => (3, [f64::NAN; 2]),
            };
            out[slot::REASON] = f64::from(code);
            details
        }
        Status::Tracking => return,
        Status::Suspect { since_ns } => halves(since_ns),
        Status::Held { reason } => {
            let code = match reason {
                HoldReason::LowUniformity => 0,
                HoldReason::FitRefused { problem } => {
                    write_fit_problem(&problem, out);
                    1
                }
                HoldReason::Constant => 2,
                HoldReason::AtRest => 3,
                HoldReason::TooLittleRotation => 4,
                HoldReason::NoGyroscope => 5,
            };
            out[slot::REASON] = f64::from(code);
            return;
        }
        Status::Disturbed { since_ns } => halves(since_ns),
        Status::Rejected { reason } => {
            out[slot::REASON] = f64::from(reject_code(&reason));
            match reason {
                RejectReason::NotFinite => return,
                RejectReason::OutOfRange { value_ut, limit_ut } => [value_ut, limit_ut],
                RejectReason::Saturated { value_ut, rail_ut } => [value_ut, rail_ut],
                // its own time the caller knows
                RejectReason::TimeNotAfter { time_ns: _, latest_ns } => halves(latest_ns),
                RejectReason::TimeJump { gap_s, limit_s } => [gap_s, limit_s],
                RejectReason::Stuck { repeats } => [repeats.into(), f64::NAN],
            }
        }
    };
    out[slot::DETAILS..slot::DETAILS + 2].copy_from_slice(&details);
}

fn status_code(status: &Status) -> jint {
    match status {
        Status::Collecting { .. } => 0,
        Status::Tracking => 1,
        Status::Suspect { .. } => 2,
        Status::Held { .. } => 3,
        Status::Disturbed { .. } => 4,
        Status::Rejected { .. } => 5,
    }
}

fn reject_code(reason: &RejectReason) -> jint {
    match reason {
        RejectReason::NotFinite => 0,
        RejectReason::OutOfRange { .. } => 1,
        RejectReason::Saturated { .. } => 2,
        RejectReason::TimeNotAfter { .. } => 3,
        RejectReason::TimeJump { .. } => 4,
        RejectReason::Stuck { .. } => 5,
    }
}

fn write_fit_problem(problem: &FitProblem, out: &mut Slots) {
    let none = f64::NAN;
    let (code, details) = match *problem {
        FitProblem::TooFewSamples { have } => (0, [have.into(), none, none]),
        FitProblem::Planar { thickness_ut } => (1, [thickness_ut, none, none]),
        FitProblem::PoorCoverage { direction_sigma_deg, limit_deg } => (2, [direction_sigma_deg, limit_deg, none]),
        FitProblem::Inconsistent { residual_ut, limit_ut } => (3, [residual_ut, limit_ut, none]),
        FitProblem::NotAnEllipsoid => (4, [none; 3]),
        FitProblem::FieldOutOfRange { field_ut, low_ut, high_ut } => (5, [field_ut, low_ut, high_ut]),
        FitProblem::NotFinite => (6, [none; 3]),
    };
    out[slot::FIT_PROBLEM] = f64::from(code);
    out[slot::FIT_DETAILS..slot::FIT_DETAILS + 3].copy_from_slice(&details);
}

fn code_of(error: &MagcompError) -> jint {
    match error {
        MagcompError::Panicked { .. } => PANICKED,
        // no other error comes from the three pushes
        _ => CLOSED,
    }
}

fn event_code(result: Result<(), MagcompError>) -> jint {
    match result {
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

fn magnetic(compensator: &Compensator, time_ns: i64, field_ut: Vector3, reported: Vector3) -> Result<Slots, jint> {
    let known = !(reported.x.is_nan() || reported.y.is_nan() || reported.z.is_nan());
    let sample = MagneticSample { time_ns, field_ut, reported_hard_iron_ut: known.then_some(reported) };
    match compensator.push(sample) {
        Ok(reading) => Ok(write_reading(&reading)),
        Err(error) => Err(code_of(&error)),
    }
}

/// Doubles in `out`.
#[jni_mangle("org.magcomp.FastPath")]
pub fn slots(_env: Env, _class: jclass) -> jint {
    slot::COUNT as jint
}

/// A raw magnetometer event, uT; `bx` to `bz` are the operating system's own hard iron, NaN for none. Answers the
/// status's code and fills `out`.
#[allow(clippy::too_many_arguments)]
#[jni_mangle("org.magcomp.FastPath")]
pub fn push(
    env: Env,
    _class: jclass,
    handle: jlong,
    time_ns: jlong,
    x: jdouble,
    y: jdouble,
    z: jdouble,
    bx: jdouble,
    by: jdouble,
    bz: jdouble,
    out: JavaArray<jdouble>,
) -> jint {
    let Some(compensator) = crate::handles::find(handle) else { return CLOSED };
    if out.len(env) < slot::COUNT {
        return TOO_SHORT;
    }
    let reported = Vector3 { x: bx, y: by, z: bz };
    match magnetic(&compensator, time_ns, Vector3 { x, y, z }, reported) {
        Ok(slots) => {
            out.write(env, 0, &slots);
            slots[slot::STATUS] as jint
        }
        Err(code) => code,
    }
}

/// A gyroscope event, rad/s.
#[jni_mangle("org.magcomp.FastPath")]
pub fn push_rotation_rate(
    _env: Env,
    _class: jclass,
    handle: jlong,
    time_ns: jlong,
    x: jdouble,
    y: jdouble,
    z: jdouble,
) -> jint {
    let Some(compensator) = crate::handles::find(handle) else { return CLOSED };
    event_code(compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s: Vector3 { x, y, z } }))
}

/// An accelerometer or gravity event, m/s^2, pointing up.
#[jni_mangle("org.magcomp.FastPath")]
pub fn push_up(_env: Env, _class: jclass, handle: jlong, time_ns: jlong, x: jdouble, y: jdouble, z: jdouble) -> jint {
    let Some(compensator) = crate::handles::find(handle) else { return CLOSED };
    event_code(compensator.push_up(UpSample { time_ns, up_m_s2: Vector3 { x, y, z } }))
}

/// Events of a batch, as `kinds` says.
mod kind {
    pub(super) const MAGNETIC: i8 = 0;
    pub(super) const ROTATION_RATE: i8 = 1;
    pub(super) const UP: i8 = 2;
}

const NOT_REPORTED: Vector3 = Vector3 { x: f64::NAN, y: f64::NAN, z: f64::NAN };

/// Events carried over at a time: on the stack, so that a batch of any length allocates nothing.
const CHUNK: usize = 64;

/// Many events in the order they happened: kinds, times and three values each. Every magnetic one fills the next
/// reading of `out`. Answers how many readings were written.
#[jni_mangle("org.magcomp.FastPath")]
pub fn push_batch(
    env: Env,
    _class: jclass,
    handle: jlong,
    kinds: JavaArray<i8>,
    times_ns: JavaArray<jlong>,
    values: JavaArray<jdouble>,
    out: JavaArray<jdouble>,
) -> jint {
    let Some(compensator) = crate::handles::find(handle) else { return CLOSED };
    let events = kinds.len(env);
    let room = out.len(env) / slot::COUNT;
    if times_ns.len(env) < events || values.len(env) < 3 * events {
        return TOO_SHORT;
    }
    let (mut kind, mut time_ns, mut value) = ([0_i8; CHUNK], [0_i64; CHUNK], [0.0_f64; 3 * CHUNK]);
    let mut readings = 0;
    for first in (0..events).step_by(CHUNK) {
        let n = CHUNK.min(events - first);
        kinds.read(env, first, &mut kind[..n]);
        times_ns.read(env, first, &mut time_ns[..n]);
        values.read(env, 3 * first, &mut value[..3 * n]);
        for k in 0..n {
            let xyz = Vector3 { x: value[3 * k], y: value[3 * k + 1], z: value[3 * k + 2] };
            let code = match kind[k] {
                kind::MAGNETIC if readings == room => TOO_SHORT,
                kind::MAGNETIC => match magnetic(&compensator, time_ns[k], xyz, NOT_REPORTED) {
                    Ok(slots) => {
                        out.write(env, readings * slot::COUNT, &slots);
                        readings += 1;
                        ACCEPTED
                    }
                    Err(code) => code,
                },
                kind::ROTATION_RATE => event_code(
                    compensator.push_rotation_rate(RotationRateSample { time_ns: time_ns[k], rate_rad_s: xyz }),
                ),
                kind::UP => event_code(compensator.push_up(UpSample { time_ns: time_ns[k], up_m_s2: xyz })),
                _ => NO_SUCH_KIND,
            };
            if code < 0 {
                return code;
            }
        }
    }
    readings as jint
}

/// For tests alone; see the feature in Cargo.toml.
#[cfg(feature = "test-hooks")]
mod hooks {
    use super::*;

    /// Panics inside the object.
    #[jni_mangle("org.magcomp.TestHooks")]
    pub fn panic_on_purpose(_env: Env, _class: jclass, handle: jlong) -> jint {
        let Some(compensator) = crate::handles::find(handle) else { return CLOSED };
        event_code(compensator.panic_on_purpose())
    }

    /// What a status looks like in `out`, for comparing Kotlin's reader with uniffi's.
    #[jni_mangle("org.magcomp.TestHooks")]
    pub fn example_status(env: Env, _class: jclass, index: jint, out: JavaArray<jdouble>) -> jint {
        let examples = crate::status::examples();
        if let Some(status) = examples.get(index as usize) {
            let mut slots = [f64::NAN; slot::COUNT];
            write_status(status, &mut slots);
            out.write(env, 0, &slots);
        }
        examples.len() as jint
    }

    /// Nanoseconds the core itself takes for these samples (three values each, uT), `step_ns` apart, with the paper's
    /// method or a constant calibration.
    #[jni_mangle("org.magcomp.TestHooks")]
    pub fn bare_push_ns(env: Env, _class: jclass, constant: bool, step_ns: jlong, values: JavaArray<jdouble>) -> jlong {
        let mut samples = vec![0.0; values.len(env)];
        values.read(env, 0, &mut samples);
        let method = if constant { magcomp::Method::Constant } else { magcomp::Method::Windowed };
        let Ok(mut core) = magcomp::Compensator::new(magcomp::Config { method, ..Default::default() }) else {
            return -1;
        };
        let begin = std::time::Instant::now();
        for (k, xyz) in samples.chunks_exact(3).enumerate() {
            let time_ns = (k as i64 + 1) * step_ns;
            let field_ut = magcomp::nalgebra::Vector3::new(xyz[0], xyz[1], xyz[2]);
            std::hint::black_box(core.push(magcomp::MagneticSample { time_ns, field_ut }));
        }
        i64::try_from(begin.elapsed().as_nanos()).unwrap_or(i64::MAX)
    }
}
