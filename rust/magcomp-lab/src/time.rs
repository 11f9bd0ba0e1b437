//! Times as the sensors stamp them.

/// Seconds as whole nanoseconds.
#[must_use]
pub fn time_ns(time_s: f64) -> i64 {
    (time_s * 1e9).round() as i64
}
