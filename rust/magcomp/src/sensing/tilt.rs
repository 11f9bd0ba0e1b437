//! Where up is, and how far it may lean, where no gyroscope carries it: a moved accelerometer reads gravity and motion together.
//!
//! ```text
//! a: accelerometer / g,   v = mean (|a| - 1)^2,   w = mean (|u| - 1)^2                                          (1 s)
//! up walks as a hand turns it, the more the faster the field turns, r:   P <- P + (q^2 + 1.5 r^2 (1 s)) dt,   r^2 = mean |d raw|^2 / (72 uT dt)^2   (1.5 t_m)
//! motion is correlated over t_m, and twice as large across gravity as along it:   R = s^2 + 2 v max(t_m / dt, 1)
//! k = P / (P + R),   n += (dt / 1 s) (|e across u|^2 / (2 (P + R)) - n),   e = a - u,   u <- u + k e,   P <- (1 - k) P
//! variance of up about a horizontal axis = max(n P + 2 w, v)
//! ```
//! u is a Kalman filter of the accelerometer. Motion along gravity shows in the size: in that of u, what the filter has left of it. n says how
//! large the innovations are against what was expected: a device at rest turns less than a hand. Differences of raw samples (low-passed, t_m / 2) know nothing
//! of b: how fast the device turns shows in them, however it is shaken. The system's gravity sensor has the
//! size g, always: u then follows it within a sample or two. A change of the raw field is at least the turn that it is in the strongest field.

#[cfg(test)]
mod tests;

use crate::math::elementary::gain;
use crate::priors::HAND_RAD;
use crate::sample::seconds;
use crate::strength::EARTH_UT;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

/// Physics: standard gravity, m/s^2.
pub(crate) const GRAVITY_M_S2: f64 = 9.80665;
/// Physics: free fall reads 1 g less than gravity, and a blow more; more says nothing.
const LARGEST: f64 = 1.0;
/// Data sheet: s, noise of an accelerometer's sample, in g: 0.003 to 0.02.
const NOISE: f64 = 0.02;
/// Choice: memory of what motion adds to gravity, s: two steps of a pedestrian; and for how long a device turns about the same axis.
pub(super) const TILT_S: f64 = 1.0;
/// Choice: t_m, s: half a step of a pedestrian (walks with motion capture, docs/dev/DECISIONS.md).
const MOTION_S: f64 = 0.25;
/// Choice: how much more of it, in squares, lies along a horizontal axis than along gravity: the same walks.
const ACROSS: f64 = 2.0;
/// Choice: share of gravity by which an accelerometer may be off that shows where up is: 6 degrees if it is across.
const CALM: f64 = 0.1;
/// Choice: a sum of directions that is shorter than this share of them has none.
const LEAST_LENGTH: f64 = 0.1;

/// Where up is, a unit vector, while the device is hardly accelerated.
pub(crate) fn calm(up_m_s2: &Vector3<f64>) -> Option<Vector3<f64>> {
    let size = up_m_s2.norm() / GRAVITY_M_S2;
    ((size - 1.0).abs() < CALM).then(|| up_m_s2.normalize())
}

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Tilt {
    /// u and the rest, once there was a sample.
    filter: Option<Filter>,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct Filter {
    up: Vector3<f64>,
    variance: f64,
    /// v, w and n.
    motion: f64,
    motion_left: f64,
    surprise: f64,
    /// The raw field, low-passed, uT, and r^2.
    raw_ut: Vector3<f64>,
    turning: f64,
    last_ns: i64,
}

impl Tilt {
    /// Up, of about the size 1; `None` before the first sample, and where it has no direction.
    pub fn up(&self) -> Option<Vector3<f64>> {
        self.filter.map(|it| it.up).filter(|up| up.norm() > LEAST_LENGTH)
    }

    /// Variance of it about a horizontal axis, what it has at rest aside, rad^2.
    pub fn variance_rad2(&self) -> f64 {
        self.filter.map_or(0.0, |it| (it.surprise * it.variance + ACROSS * it.motion_left).max(it.motion))
    }

    /// One sample of the accelerometer, with the raw field at its time, uT.
    pub fn step(&mut self, time_ns: i64, up_m_s2: &Vector3<f64>, raw_ut: &Vector3<f64>) {
        let a = up_m_s2 / GRAVITY_M_S2;
        let off = |it: &Vector3<f64>| (it.norm() - 1.0).abs().min(LARGEST).powi(2);
        let age_s = |it: &Filter| seconds(it.last_ns, time_ns);
        // what was before a pause is gone
        let Some(it) = self.filter.as_mut().filter(|it| age_s(it) <= TILT_S) else {
            let (motion, variance) = (off(&a), NOISE.powi(2));
            let (raw_ut, last_ns, left) = (*raw_ut, time_ns, Filter::default());
            self.filter = Some(Filter { up: a, variance, motion, motion_left: motion, raw_ut, last_ns, ..left });
            return;
        };
        let dt_s = age_s(it).max(1e-6);
        it.last_ns = time_ns;
        let share = gain(dt_s, TILT_S);
        it.motion += share * (off(&a) - it.motion);
        let moved_ut = (raw_ut - it.raw_ut) * gain(dt_s, MOTION_S / 2.0);
        it.raw_ut += moved_ut;
        let turning = (moved_ut.norm() / (EARTH_UT.end * dt_s)).powi(2);
        it.turning += gain(dt_s, 1.5 * MOTION_S) * (turning - it.turning);
        // a turn about the field itself does not show: of turns about all axes a third
        it.variance += (HAND_RAD.powi(2) + 1.5 * it.turning * TILT_S) * dt_s;
        let noise = NOISE.powi(2) + ACROSS * it.motion * (MOTION_S / dt_s).max(1.0);
        let expected = it.variance + noise;
        let e = a - it.up;
        let along = it.up.try_normalize(LEAST_LENGTH).map_or(0.0, |up| e.dot(&up));
        it.surprise += share * ((e.norm_squared() - along * along) / (2.0 * expected) - it.surprise);
        it.up += e * (it.variance / expected);
        it.variance *= noise / expected;
        it.motion_left += share * (off(&it.up) - it.motion_left);
    }
}
