//! How far `up` may lean where no gyroscope carries it: a moved accelerometer reads gravity and motion together.
//!
//! ```text
//! sigma_tilt^2 = sigma_0^2 + mean ((|up| - g) / g)^2      (1 s)
//! ```
//! Motion along gravity shows in the size; motion across it, which tilts, is taken to be as large. The system's gravity
//! sensor has the size g, always: nothing is added then.

#[cfg(test)]
mod tests;

use super::tuning::Tuning;

/// Physics: standard gravity, m/s^2.
pub(crate) const GRAVITY_M_S2: f64 = 9.80665;
/// Physics: free fall reads 1 g less than gravity, and a blow more; more says nothing, rad.
const LARGEST_RAD: f64 = 1.0;

/// The low-passed square of what motion adds to gravity.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Tilt {
    /// Of `up` about a horizontal axis, what it has at rest aside.
    pub variance_rad2: f64,
    last_ns: Option<i64>,
}

impl Tilt {
    /// One sample of `up`, of size `up_m_s2`.
    pub fn step(&mut self, time_ns: i64, up_m_s2: f64) {
        let off = (up_m_s2 / GRAVITY_M_S2 - 1.0).abs().min(LARGEST_RAD);
        let dt_s = self.last_ns.map_or(Tuning::USED.tilt_s, |last| time_ns.saturating_sub(last) as f64 * 1e-9);
        let gain = (dt_s / Tuning::USED.tilt_s).clamp(0.0, 1.0);
        self.variance_rad2 += gain * (off * off - self.variance_rad2);
        self.last_ns = Some(time_ns);
    }
}
