//! The C path for Swift: plain numbers in, one struct out, no allocation. `include/magcomp.h` declares it and says what
//! every answer means; Swift's `Compensator` reads the struct, and its test compares every status with what uniffi says.
//!
//! `handles` finds the object, so that no caller holds a pointer. `out` is a checked reference: null is an answer.

// the exported names are `#[unsafe(no_mangle)]`; there is no other unsafe code here
#![allow(unsafe_code)]

use crate::compensator::find;
use crate::flat::{self, ACCEPTED, CLOSED};
use crate::reading::FlatReading;
use crate::record::{Coverage, Vector3};

const NO_ROOM: i32 = -3;

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
    out: Option<&mut FlatReading>,
) -> i32 {
    let Some(compensator) = find(handle) else { return CLOSED };
    let Some(out) = out else { return NO_ROOM };
    match flat::push(&compensator, time_ns, Vector3 { x, y, z }, Vector3 { x: bx, y: by, z: bz }) {
        Ok((reading, _)) => {
            *out = reading;
            ACCEPTED
        }
        Err(code) => code,
    }
}

/// A gyroscope event.
#[unsafe(no_mangle)]
pub extern "C" fn magcomp_push_rotation_rate(handle: i64, time_ns: i64, x: f64, y: f64, z: f64) -> i32 {
    find(handle).map_or(CLOSED, |to| flat::push_rotation_rate(&to, time_ns, Vector3 { x, y, z }))
}

/// An accelerometer or gravity event.
#[unsafe(no_mangle)]
pub extern "C" fn magcomp_push_up(handle: i64, time_ns: i64, x: f64, y: f64, z: f64) -> i32 {
    find(handle).map_or(CLOSED, |to| flat::push_up(&to, time_ns, Vector3 { x, y, z }))
}

/// Where the field has not pointed yet, three numbers each; how many directions these are.
#[unsafe(no_mangle)]
pub extern "C" fn magcomp_unseen_directions(handle: i64, out: Option<&mut [f64; 3 * magcomp::CELLS]>) -> i32 {
    let Some(compensator) = find(handle) else { return CLOSED };
    let Some(out) = out else { return NO_ROOM };
    match compensator.coverage() {
        Ok(Coverage { unseen_directions, .. }) => {
            for (place, v) in out.as_chunks_mut().0.iter_mut().zip(&unseen_directions) {
                *place = [v.x, v.y, v.z];
            }
            unseen_directions.len() as i32
        }
        Err(error) => flat::code_of(&error),
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
        find(handle).map_or(CLOSED, |to| flat::event_code(to.panic_on_purpose()))
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
