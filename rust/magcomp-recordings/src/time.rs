//! Times as the sensors stamp them.

/// Times are less than this, ns, from zero (146 years), so that the difference of two fits 64 bits too.
pub const MOST_NS: i64 = 1 << 62;

/// Seconds as whole nanoseconds.
pub fn time_ns(time_s: f64) -> i64 {
    (time_s * 1e9).round() as i64
}

/// Whole nanoseconds as seconds.
pub fn seconds(time_ns: i64) -> f64 {
    time_ns as f64 / 1e9
}

/// Whether this is a time, s, less than [`MOST_NS`] from zero.
pub fn is_time(time_s: f64) -> bool {
    (time_s * 1e9).abs() < MOST_NS as f64
}
