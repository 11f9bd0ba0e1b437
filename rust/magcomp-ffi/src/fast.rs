//! The JNI fast path: primitives in, a caller-owned array out, no allocation in a push.
//!
//! `org.magcomp.core.FastPath` declares these functions; `handles` finds the object. Each answers a number: 0 or more is an
//! answer, below 0 an error of `flat`. The array's layout is that of `slots`; `ReadingBuffer` in Kotlin reads it, and its test
//! compares every status with what uniffi says.

// the exported names are `#[unsafe(no_mangle)]`; there is no other unsafe code here
#![allow(unsafe_code)]

// made, for people to read and not to edit
#[rustfmt::skip]
mod slots;

use crate::compensator::find;
use crate::error::MagcompError;
use crate::flat::{self, CLOSED};
use crate::java::{Env, JavaDoubles};
use crate::record::{Calibration, Coverage, Vector3};
use jni::jni_mangle;
use jni::sys::{jclass, jdouble, jint, jlong};
use magcomp::Pointing;
use magcomp::nalgebra::{Quaternion, UnitQuaternion};

/// Doubles in `out`.
#[jni_mangle("org.magcomp.core.FastPath")]
pub fn slots(_env: Env, _class: jclass) -> jint {
    slots::COUNT as jint
}

/// A raw magnetometer event, uT; `bx` to `bz` are the operating system's own hard iron, NaN for none. Answers the
/// status's code and fills `out`; an `out` that is too short throws.
#[allow(clippy::too_many_arguments)]
#[jni_mangle("org.magcomp.core.FastPath")]
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
    out: JavaDoubles,
) -> jint {
    let Some(compensator) = find(handle) else { return CLOSED };
    match flat::push(&compensator, time_ns, Vector3 { x, y, z }, Vector3 { x: bx, y: by, z: bz }) {
        Ok(reading) => {
            // the JVM checks the length, and throws IndexOutOfBoundsException
            out.write(env, &slots::of(&reading));
            reading.0.status.kind
        }
        Err(code) => code,
    }
}

/// Of the heading that a reading has in a frame, by the four numbers of its attitude and the five of `Pointing`: the angle from magnetic north, its
/// sigma, the angle from true north, and the attitude's sigma, degrees, NaN where they are not known.
#[jni_mangle("org.magcomp.core.FastPath")]
pub fn heading(env: Env, _class: jclass, numbers: JavaDoubles, axis: jint, rotation: jint, which: jint) -> jdouble {
    let mut it = [f64::NAN; 9];
    numbers.read(env, &mut it);
    let [w, x, y, z, lean, across_rad2, tilt_sigma_deg, common_rad2, declination_deg] = it;
    let known = |it: f64| (!it.is_nan()).then_some(it);
    let to_world = UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z));
    let pointing = Pointing {
        to_world,
        lean,
        across_rad2: known(across_rad2),
        tilt_sigma_deg,
        common_rad2,
        declination_deg: known(declination_deg),
    };
    let (Some(axis), Some(rotation)) = (AXES.get(axis as usize), ROTATIONS.get(rotation as usize)) else {
        return f64::NAN;
    };
    let heading = || pointing.heading(*axis, *rotation);
    let found = match which {
        0 => heading().map(|it| it.heading_deg),
        1 => heading().and_then(|it| it.heading_sigma_deg),
        2 => heading().and_then(|it| it.true_heading_deg),
        _ => pointing.attitude().sigma_deg,
    };
    found.unwrap_or(f64::NAN)
}

/// As Kotlin counts them.
const AXES: [magcomp::ReferenceAxis; 3] =
    [magcomp::ReferenceAxis::TopEdge, magcomp::ReferenceAxis::Camera, magcomp::ReferenceAxis::Auto];
const ROTATIONS: [magcomp::ScreenRotation; 4] = [
    magcomp::ScreenRotation::Deg0,
    magcomp::ScreenRotation::Deg90,
    magcomp::ScreenRotation::Deg180,
    magcomp::ScreenRotation::Deg270,
];

/// A gyroscope event, rad/s.
#[jni_mangle("org.magcomp.core.FastPath")]
pub fn push_rotation_rate(
    _env: Env,
    _class: jclass,
    handle: jlong,
    time_ns: jlong,
    x: jdouble,
    y: jdouble,
    z: jdouble,
) -> jint {
    find(handle).map_or(CLOSED, |to| flat::push_rotation_rate(&to, time_ns, Vector3 { x, y, z }))
}

/// An accelerometer or gravity event, m/s^2, pointing up.
#[jni_mangle("org.magcomp.core.FastPath")]
pub fn push_up(_env: Env, _class: jclass, handle: jlong, time_ns: jlong, x: jdouble, y: jdouble, z: jdouble) -> jint {
    find(handle).map_or(CLOSED, |to| flat::push_up(&to, time_ns, Vector3 { x, y, z }))
}

/// The calibration in force: xx, yy, zz, xy, xz, yz of the soft iron, the hard iron and the field's strength, uT. Answers 1, or 0 where
/// there is none, which leaves `out` as it was.
#[jni_mangle("org.magcomp.core.FastPath")]
pub fn calibration(env: Env, _class: jclass, handle: jlong, out: JavaDoubles) -> jint {
    let Some(compensator) = find(handle) else { return CLOSED };
    answered(compensator.calibration(), |calibration| {
        let Some(Calibration { soft_iron: m, hard_iron_ut: b, field_strength_ut }) = calibration else { return 0 };
        out.write(env, &[m.xx, m.yy, m.zz, m.xy, m.xz, m.yz, b.x, b.y, b.z, field_strength_ut]);
        1
    })
}

/// The share of the directions that were seen, then three numbers for each that was not. Answers how many these are; an `out` that
/// is too short throws.
#[jni_mangle("org.magcomp.core.FastPath")]
pub fn coverage(env: Env, _class: jclass, handle: jlong, out: JavaDoubles) -> jint {
    let Some(compensator) = find(handle) else { return CLOSED };
    answered(compensator.coverage(), |Coverage { share, unseen_directions }| {
        // at once: after a write that throws nothing may be called but what clears it
        let numbers: Vec<f64> =
            std::iter::once(share).chain(unseen_directions.iter().flat_map(|v| [v.x, v.y, v.z])).collect();
        out.write(env, &numbers);
        unseen_directions.len() as jint
    })
}

/// What is written of an answer, or the error's code.
fn answered<T>(result: Result<T, MagcompError>, write: impl FnOnce(T) -> jint) -> jint {
    result.map_or_else(|error| flat::code_of(&error), write)
}

/// For tests alone; see the feature in Cargo.toml.
#[cfg(feature = "test-hooks")]
mod hooks {
    use super::*;

    /// Panics inside the object.
    #[jni_mangle("org.magcomp.TestHooks")]
    pub fn panic_on_purpose(_env: Env, _class: jclass, handle: jlong) -> jint {
        find(handle).map_or(CLOSED, |to| flat::event_code(to.panic_on_purpose()))
    }

    /// Nanoseconds the core itself takes for these samples (three values each, uT), `step_ns` apart, by the paper's
    /// method or with a constant calibration.
    #[jni_mangle("org.magcomp.TestHooks")]
    pub fn bare_push_ns(
        env: Env,
        _class: jclass,
        constant: bool,
        n_min: jint,
        step_ns: jlong,
        values: JavaDoubles,
    ) -> jlong {
        let mut samples = vec![0.0; values.len(env)];
        values.read(env, &mut samples);
        let method = if constant { magcomp::Method::Constant } else { magcomp::Method::Windowed };
        let windowed = magcomp::WindowedConfig { n_min: n_min as usize, ..Default::default() };
        let initial = constant.then(|| magcomp::Calibration::identity(50.0).unwrap());
        let config = magcomp::Config { method, windowed, initial, ..Default::default() };
        let Ok(mut core) = magcomp::Compensator::new(config) else { return -1 };
        let begin = std::time::Instant::now();
        for (k, xyz) in samples.chunks_exact(3).enumerate() {
            let time_ns = (k as i64 + 1) * step_ns;
            let field_ut = magcomp::nalgebra::Vector3::new(xyz[0], xyz[1], xyz[2]);
            std::hint::black_box(core.push(magcomp::MagneticSample { time_ns, field_ut }));
        }
        i64::try_from(begin.elapsed().as_nanos()).unwrap_or(i64::MAX)
    }
}
