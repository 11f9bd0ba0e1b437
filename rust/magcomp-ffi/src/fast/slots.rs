// made by bindings/generate.sh from bindings/reading.toml
//! A reading as doubles: the numbers of `FlatReading`, a time or another whole number of 64 bits as two.

use crate::reading::FlatReading;
use crate::status::FlatStatus;
use magcomp::Pointing;

// what comes after the numbers that a reading of `Compass` copies changes seldom, and is kept as objects
const EVENT: usize = 25;
/// Two times.
const EVENT_TIMES: usize = 26;
const STATUS: usize = 30;
const REASON: usize = 31;
const FIT_PROBLEM: usize = 32;
/// Three numbers.
const REAL: usize = 33;
/// Two whole numbers.
const WHOLE: usize = 36;
/// What the heading of any axis is formed of, beside the attitude: the numbers of `Pointing`.
const POINTING: usize = 40;
/// Doubles in a reading.
pub(super) const COUNT: usize = 45;

pub(super) type Slots = [f64; COUNT];

/// A whole number as two numbers a double holds exactly: the upper and the lower 32 bits.
fn write_whole(numbers: [i64; 2], at: usize, out: &mut Slots) {
    for (number, halves) in numbers.iter().zip(out[at..at + 4].chunks_exact_mut(2)) {
        halves[0] = (number >> 32) as f64;
        halves[1] = (number & 0xffff_ffff) as f64;
    }
}

pub(super) fn of((reading, pointing): &(FlatReading, Option<Pointing>)) -> Slots {
    let mut out = [0.0; COUNT];
    out[0..3].copy_from_slice(&reading.field_ut);
    out[3] = reading.field_sigma_ut;
    out[4..7].copy_from_slice(&reading.filtered_field_ut);
    out[7] = reading.total_field_ut;
    out[8] = reading.heading_deg;
    out[9] = reading.heading_sigma_deg;
    out[10] = reading.true_heading_deg;
    out[11] = reading.inclination_deg;
    out[12] = reading.attitude_w;
    out[13] = reading.attitude_x;
    out[14] = reading.attitude_y;
    out[15] = reading.attitude_z;
    out[16] = reading.attitude_sigma_deg;
    out[17] = reading.sigma_t;
    out[18] = reading.window.into();
    out[19] = reading.coverage;
    out[20] = reading.direction_sigma_deg;
    out[21] = reading.worst_sigma_deg;
    out[22] = reading.model_order.into();
    out[23] = reading.reported_hard_iron_jump_ut;
    out[24] = reading.mode.into();
    out[EVENT] = reading.event.kind.into();
    write_whole([reading.event.since_ns, reading.event.decided_ns], EVENT_TIMES, &mut out);
    let FlatStatus { kind, reason, problem, whole, real } = reading.status;
    out[STATUS] = kind.into();
    out[REASON] = reason.into();
    out[FIT_PROBLEM] = problem.into();
    out[REAL..REAL + 3].copy_from_slice(&real);
    write_whole(whole, WHOLE, &mut out);
    out[POINTING..].copy_from_slice(&pointing.map_or([f64::NAN; 5], |it| {
        [it.lean, it.across_rad2.unwrap_or(f64::NAN), it.tilt_sigma_deg, it.common_rad2, it.declination_deg.unwrap_or(f64::NAN)]
    }));
    out
}
