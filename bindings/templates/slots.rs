// made by bindings/generate.sh from bindings/reading.toml
//! A reading as doubles: the numbers of `FlatReading`, a time or another whole number of 64 bits as two.

use crate::reading::FlatReading;
use crate::status::FlatStatus;
use magcomp::Pointing;

{% set n = reading.numbers %}
// what comes after the numbers that a reading of `Compass` copies changes seldom, and is kept as objects
const EVENT: usize = {{ n }};
/// Two times.
const EVENT_TIMES: usize = {{ n + 1 }};
const STATUS: usize = {{ n + 5 }};
const REASON: usize = {{ n + 6 }};
const FIT_PROBLEM: usize = {{ n + 7 }};
/// Three numbers.
const REAL: usize = {{ n + 8 }};
/// Two whole numbers.
const WHOLE: usize = {{ n + 11 }};
/// What the heading of any axis is formed of, beside the attitude: the numbers of `Pointing`.
const POINTING: usize = {{ n + 15 }};
/// Doubles in a reading.
pub(super) const COUNT: usize = {{ n + 20 }};

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
{% for leaf in reading.leaves %}
{% if leaf.kind == "vector" %}
    out[{{ leaf.at }}..{{ leaf.at + 3 }}].copy_from_slice(&reading.{{ leaf.flat }});
{% elif leaf.kind in ["real", "share"] %}
    out[{{ leaf.at }}] = reading.{{ leaf.flat }};
{% else %}
    out[{{ leaf.at }}] = reading.{{ leaf.flat }}.into();
{% endif %}
{% endfor %}
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
