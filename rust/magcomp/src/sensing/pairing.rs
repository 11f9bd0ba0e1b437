//! Pairing of sensor events by time: the rotation between two magnetometer samples is
//! exp(theta_k) = product of exp(integral of w(t) dt) over the pieces of (t_{k-1}, t_k), with w(t) linear between gyroscope
//! events (trapezoid rule; the next term, [w x w'] dt^3/12, is below 1e-4 rad at 25 Hz and hand motion). The product, not
//! the sum: across a pause of the magnetometer the axis turns too.
//!
//! What the rate did between its events is not known. If it wanders with density q, its slope changes by d_k from one
//! interval T to the next, mean d_k . d_{k-1} = -3 q / T, and the trapezoid is wrong by q T^3 / 12 per axis (variance).
//! A smooth motion bends the same way twice: its product is positive, and nothing is counted.
//!
//! What is taken beyond the newest gyroscope event is extrapolated by holding the last rate, remembered as `owed`,
//! and taken back from the next increment, so that events which arrive late lose nothing. All storage is of
//! fixed size; when it overflows, the oldest segment is folded into the running integral, which loses nothing either.

#[cfg(test)]
mod tests;

use crate::math::elementary::{gain, quaternion, rotation_vector};
use crate::sample::seconds;
pub(crate) use crate::status::EventRejection;
use arrayvec::ArrayVec;
use core::mem::take;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

/// Choice: events held of each sensor: 40 ms at 400 Hz, the interval of a 25 Hz magnetometer; an overflow folds the oldest rate.
const EVENTS: usize = 16;
/// Choice: a sensor whose newest event is older than this counts as absent, and a longer silence of all of them as a pause, s: two and a half periods of
/// 10 Hz, the slowest rate supported. Smaller: a hiccup of the system turns the gyroscope off. Larger: a stopped gyroscope is taken for stillness.
pub(crate) const STALE_S: f64 = 0.25;
/// Choice: memory of how the rate wanders between its events, s: a hand changes its motion about as fast.
const WANDER_S: f64 = 0.5;
/// Data sheet: largest rotation rate believed, rad/s: above the 35 rad/s full scale of phone gyroscopes.
const MAX_RATE_RAD_S: f64 = 60.0;
/// Data sheet: largest acceleration believed, m/s^2: above the 160 m/s^2 full scale of phone accelerometers.
const MAX_UP_M_S2: f64 = 200.0;
/// Limit: an event further ahead of the newest magnetometer sample is from another clock, s: a system holds no sensor back for so long while it
/// delivers another.
pub(crate) const MAX_LEAD_S: f64 = 10.0;

/// What the inertial sensors say about the time of one magnetometer sample.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct PairedInertial {
    /// Rotation since the previous magnetometer sample; `None` when the gyroscope is absent or was, in between.
    pub rotation: Option<Rotation>,
    /// What an accelerometer at rest reads (m/s^2, Android's sign), at the sample's time; `None` when absent.
    pub up_m_s2: Option<Vector3<f64>>,
}

/// Rotation between two magnetometer samples, device frame, the gyroscope's bias not removed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Rotation {
    /// Rotation vector: the integral of the rate over the interval, rad.
    pub increment_rad: Vector3<f64>,
    /// Rate at the sample's time, rad/s.
    pub rate_rad_s: Vector3<f64>,
    /// Variance per axis of what the rate may have done between its events, rad^2.
    pub variance_rad2: f64,
}

#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Event {
    time_ns: i64,
    value: Vector3<f64>,
}

/// Buffers rotation-rate and `up` events and pairs them with magnetometer samples by time.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct InertialPairing {
    rates: ArrayVec<Event, EVENTS>,
    ups: ArrayVec<Event, EVENTS>,
    /// The event (or interpolated point) up to which the rate has been integrated.
    anchor: Option<Event>,
    /// Rotation gathered since the last magnetometer sample, rad.
    gathered_rad: Vector3<f64>,
    /// Variance per axis of that integral, rad^2.
    gathered_rad2: f64,
    /// The last event integrated (not interpolated), and how fast the rate changed up to it, rad/s^2.
    last_rate: Option<Event>,
    slope: Option<Vector3<f64>>,
    /// How that has changed from the interval before, and q, rad^2/s^3.
    bend: Option<Vector3<f64>>,
    wander: f64,
    /// Bias g (rad/s) and scale error s of the gyroscope as the estimator knows them: w = (1 - s) reading - g. What rounding
    /// does to them is far below the gyroscope's noise.
    bias_rad_s: Vector3<f32>,
    scale: Vector3<f32>,
    /// Extrapolated beyond the anchor and already handed out, rad.
    owed_rad: Vector3<f64>,
    /// A hole longer than `STALE_S` lies inside the present interval.
    broken: bool,
    last_up: Option<Event>,
    last_paired_ns: Option<i64>,
}

impl InertialPairing {
    /// Takes one gyroscope event: rad/s, device frame. One that is rejected changes nothing.
    pub fn push_rotation_rate(&mut self, time_ns: i64, rate_rad_s: Vector3<f64>) -> Result<(), EventRejection> {
        let taken_ns = self.anchor.map(|anchor| anchor.time_ns);
        let event = Event { time_ns, value: rate_rad_s };
        if let Some(oldest) = enter(&mut self.rates, event, MAX_RATE_RAD_S, taken_ns, self.last_paired_ns)? {
            self.bridge(&oldest);
            self.advance(oldest);
        }
        Ok(())
    }

    /// Takes one accelerometer (or gravity) event: m/s^2, what a device at rest reads. One that is rejected changes nothing.
    pub fn push_up(&mut self, time_ns: i64, up_m_s2: Vector3<f64>) -> Result<(), EventRejection> {
        let taken_ns = self.last_up.map(|last| last.time_ns);
        let event = Event { time_ns, value: up_m_s2 };
        self.last_up = enter(&mut self.ups, event, MAX_UP_M_S2, taken_ns, self.last_paired_ns)?.or(self.last_up);
        Ok(())
    }

    /// Time passed that the clock does not show: no turn reaches across it.
    pub fn pause(&mut self) {
        let (bias_rad_s, scale, last_paired_ns) = (self.bias_rad_s, self.scale, self.last_paired_ns);
        *self = Self { bias_rad_s, scale, last_paired_ns, ..Self::default() };
    }

    /// From now on the gyroscope's bias (rad/s) and scale error are taken to be these. Over many events the errors of the
    /// gyroscope turn with the device: taken off at the end they would be in a wrong frame.
    pub fn assume(&mut self, bias_rad_s: Vector3<f64>, scale: Vector3<f64>) {
        (self.bias_rad_s, self.scale) = (bias_rad_s.cast(), scale.cast());
    }

    /// Whether a gyroscope has told how the device turns of late.
    pub fn turns(&self) -> bool {
        self.anchor.is_some() || !self.rates.is_empty()
    }

    /// Whether gyroscope or accelerometer speaks at this time.
    pub fn hears(&self, time_ns: i64) -> bool {
        let rate = self.rates.last().copied().or(self.anchor);
        let up = self.ups.last().copied().or(self.last_up);
        [rate, up].into_iter().flatten().any(|event| !is_silence(seconds(event.time_ns, time_ns)))
    }

    /// How the device turns in `span_s` when the gyroscope reads `rate_rad_s`, rad.
    fn turned(&self, rate_rad_s: &Vector3<f64>, span_s: f64) -> Vector3<f64> {
        (rate_rad_s - rate_rad_s.component_mul(&self.scale.cast()) - self.bias_rad_s.cast()) * span_s
    }

    /// A turn in `span_s` as the gyroscope reads it: the estimator takes the same g and s off again.
    fn as_read(&self, turned_rad: &Vector3<f64>, span_s: f64) -> Vector3<f64> {
        let scale: Vector3<f64> = self.scale.cast();
        (turned_rad + self.bias_rad_s.cast() * span_s).component_div(&scale.map(|s| 1.0 - s))
    }

    /// Integrates from the anchor to `event` by the trapezoid rule, and makes it the anchor.
    fn advance(&mut self, event: Event) {
        if let Some(anchor) = self.anchor {
            let span_s = seconds(anchor.time_ns, event.time_ns);
            if is_silence(span_s) {
                // the hole may have been bridged by extrapolation for its first part: forget that debt
                self.broken = true;
                self.owed_rad = Vector3::zeros();
            } else {
                let mean_rad_s = (anchor.value + event.value) * 0.5;
                self.gathered_rad = then(&self.gathered_rad, &self.turned(&mean_rad_s, span_s));
            }
        }
        self.anchor = Some(event);
    }

    /// Gathers the variance of what the rate may have done between its last event and `event`.
    fn bridge(&mut self, event: &Event) {
        let Some(last) = self.last_rate.replace(*event) else { return };
        let span_s = seconds(last.time_ns, event.time_ns);
        if is_silence(span_s) {
            (self.slope, self.bend) = (None, None);
            return;
        }
        let slope = (event.value - last.value) / span_s;
        let Some(before) = self.slope.replace(slope) else { return };
        let bend = slope - before;
        let Some(bend_before) = self.bend.replace(bend) else { return };
        let seen = -bend.dot(&bend_before) * span_s / 3.0;
        self.wander += gain(span_s, WANDER_S) * (seen - self.wander);
        self.gathered_rad2 += self.wander.max(0.0) * span_s.powi(3) / 12.0;
    }

    /// The inertial state at the time of a magnetometer sample, and the rotation since the one before.
    ///
    /// A `time_ns` at or before the previous one gives nothing and changes nothing.
    pub fn pair(&mut self, time_ns: i64) -> PairedInertial {
        if self.last_paired_ns.is_some_and(|last| time_ns <= last) {
            return PairedInertial::default();
        }
        let started = self.last_paired_ns.is_some() && self.anchor.is_some();
        while self.rates.first().is_some_and(|event| event.time_ns <= time_ns) {
            let event = self.rates.remove(0);
            self.bridge(&event);
            self.advance(event);
        }
        let rotation = self.rotation_at(time_ns, started);
        let up_m_s2 = self.up_at(time_ns);
        self.last_paired_ns = Some(time_ns);
        PairedInertial { rotation, up_m_s2 }
    }

    fn rotation_at(&mut self, time_ns: i64, started: bool) -> Option<Rotation> {
        let anchor = self.anchor?;
        if anchor.time_ns > time_ns {
            return self.share_of_a_flood(anchor.time_ns, time_ns, started);
        }
        let mut owed_rad = Vector3::zeros();
        let rate_rad_s = match self.rates.first().copied() {
            // one beyond a hole, or stamped far ahead, says nothing of this time
            Some(next) if anchor.time_ns < time_ns && !is_silence(seconds(anchor.time_ns, next.time_ns)) => {
                let share = seconds(anchor.time_ns, time_ns) / seconds(anchor.time_ns, next.time_ns);
                let rate = anchor.value + (next.value - anchor.value) * share;
                self.advance(Event { time_ns, value: rate });
                rate
            }
            _ => {
                let beyond_s = seconds(anchor.time_ns, time_ns);
                owed_rad = self.turned(&anchor.value, beyond_s);
                self.broken |= is_silence(beyond_s);
                anchor.value
            }
        };
        let turned_rad = then(&then(&-take(&mut self.owed_rad), &take(&mut self.gathered_rad)), &owed_rad);
        let span_s = self.last_paired_ns.map_or(0.0, |last| seconds(last, time_ns));
        let increment_rad = self.as_read(&turned_rad, span_s);
        let (broken, variance_rad2) = (take(&mut self.broken), take(&mut self.gathered_rad2));
        if !broken {
            self.owed_rad = owed_rad;
        }
        (started && !broken).then_some(Rotation { increment_rad, rate_rad_s, variance_rad2 })
    }

    /// More events came at once than the ring holds, and what was folded lies ahead of the sample too: how the turn is spread
    /// over that time is lost, and taken to be even.
    fn share_of_a_flood(&mut self, ahead_ns: i64, time_ns: i64, started: bool) -> Option<Rotation> {
        let Some(last_ns) = self.last_paired_ns.filter(|_| started && !self.broken) else {
            self.broken = true;
            return None;
        };
        let (span_s, share) = (seconds(last_ns, time_ns), seconds(last_ns, time_ns) / seconds(last_ns, ahead_ns));
        let all_rad = then(&-take(&mut self.owed_rad), &self.gathered_rad);
        let (turned_rad, variance_rad2) = (all_rad * share, self.gathered_rad2 * share);
        self.gathered_rad = all_rad - turned_rad;
        self.gathered_rad2 -= variance_rad2;
        let increment_rad = self.as_read(&turned_rad, span_s);
        Some(Rotation { increment_rad, rate_rad_s: increment_rad / span_s, variance_rad2 })
    }

    fn up_at(&mut self, time_ns: i64) -> Option<Vector3<f64>> {
        while self.ups.first().is_some_and(|event| event.time_ns <= time_ns) {
            self.last_up = Some(self.ups.remove(0));
        }
        let last = self.last_up?;
        let since_s = seconds(last.time_ns, time_ns);
        match self.ups.first().map(|next| (next.value, seconds(last.time_ns, next.time_ns))) {
            Some((next, span_s)) if !is_silence(span_s) => Some(last.value + (next - last.value) * (since_s / span_s)),
            _ => (!is_silence(since_s)).then_some(last.value),
        }
    }
}

/// An event enters in the order of times, unless it is none that is believed (`limit`), is from another clock than the latest
/// paired sample, or comes too late: after `taken_ns`, or after the oldest of a full storage. That oldest one makes room. Events that
/// are further ahead of it than a sensor may be silent were stamped wrong, and are left out.
fn enter(
    events: &mut ArrayVec<Event, EVENTS>,
    event: Event,
    limit: f64,
    taken_ns: Option<i64>,
    paired_ns: Option<i64>,
) -> Result<Option<Event>, EventRejection> {
    let Event { time_ns, value } = event;
    if !value.iter().all(|v| v.is_finite()) {
        return Err(EventRejection::NotFinite);
    }
    if value.amax() > limit {
        return Err(EventRejection::OutOfRange);
    }
    if paired_ns.is_some_and(|paired| seconds(paired, time_ns) > MAX_LEAD_S) {
        return Err(EventRejection::Ahead);
    }
    let place = events.partition_point(|other| other.time_ns < time_ns);
    if taken_ns.is_some_and(|taken| time_ns <= taken)
        || (events.is_full() && place == 0 && time_ns != events[0].time_ns)
    {
        return Err(EventRejection::Late);
    }
    if events.get(place).is_some_and(|other| other.time_ns == time_ns) {
        return Err(EventRejection::Duplicate);
    }
    if events.get(place).is_some_and(|later| is_silence(seconds(time_ns, later.time_ns))) {
        // those that came before it and lie so far behind it were stamped ahead
        events.truncate(place);
    }
    let oldest = events.is_full().then(|| events.remove(0));
    events.insert(place - usize::from(oldest.is_some()), event);
    Ok(oldest)
}

/// The rotation vector of `first` and then `next`, both in the frame of the device as it turns.
fn then(first: &Vector3<f64>, next: &Vector3<f64>) -> Vector3<f64> {
    // most often there is but one piece, kept to the bit
    if *first == Vector3::zeros() {
        return *next;
    }
    if *next == Vector3::zeros() {
        return *first;
    }
    rotation_vector(&(quaternion(first) * quaternion(next)))
}

/// Whether a sensor that says nothing for so long is not there, s.
fn is_silence(span_s: f64) -> bool {
    span_s > STALE_S
}
