//! Events of several sensors in the order of their times. Systems deliver each sensor's events late or in batches.
//!
//! An event waits for every other sensor until that has delivered an event at or after its time. The sensors need not be known:
//! one whose latest event, or else the beginning of the stream, is more than `STALE_S` older than the newest event of all is not waited for. Nothing waits for longer than `hold_s`,
//! counted in the time of the events: between its time and the newest of any sensor. At equal times the rotation rate is first,
//! then `up`, then the magnetometer; events of one sensor with equal times keep the order they came in.
//!
//! Kotlin and Swift have the same rules in their own language; `tests/vectors/event_order.json` holds all three to them.

use super::pairing::{MAX_LEAD_S, STALE_S};
use crate::range::{ConfigError, in_range};
use crate::room::Roomy;
use crate::sample::{MagneticSample, RotationRateSample, UpSample};
use alloc::collections::VecDeque;

/// Choice: events that can wait: 0.25 s of two inertial sensors at 400 Hz and a magnetometer at 100 Hz.
const ROOM: usize = 256;
/// Mathematics: `STALE_S` in nanoseconds; an event that is this much newer than all before it follows a pause of all sensors, ns.
const PAUSE_NS: i64 = (STALE_S * 1e9) as i64;
/// Mathematics: `MAX_LEAD_S` in nanoseconds; an event that is this much older is from another clock, ns.
const ANOTHER_CLOCK_NS: i64 = (MAX_LEAD_S * 1e9) as i64;

/// An event of one of the three sensors.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum SensorEvent {
    /// Of the gyroscope.
    RotationRate(RotationRateSample),
    /// Of the accelerometer or the gravity sensor.
    Up(UpSample),
    /// Of the magnetometer.
    Magnetic(MagneticSample),
}

impl SensorEvent {
    /// Its time, nanoseconds.
    #[must_use]
    pub fn time_ns(&self) -> i64 {
        self.place().0
    }

    /// Its time, and the place of its sensor among events of one time: events go out in the order of both.
    fn place(&self) -> (i64, usize) {
        match self {
            Self::RotationRate(sample) => (sample.time_ns, 0),
            Self::Up(sample) => (sample.time_ns, 1),
            Self::Magnetic(sample) => (sample.time_ns, 2),
        }
    }
}

/// Brings events that are delivered late or in batches into the order of their times, which [`crate::Compensator`] expects.
///
/// It drops none and checks none. It takes no memory after it was made. An event that comes more than `hold_s` too late goes out
/// at once, behind later ones; the compensator says what it makes of it. After a pause of all sensors, or when the clock is
/// another one, all that waits goes out first, so that no later event can be ahead of it.
///
/// ```
/// use magcomp::nalgebra::Vector3;
/// use magcomp::{EventQueue, MagneticSample, SensorEvent, UpSample};
///
/// let mut queue = EventQueue::new(EventQueue::DEFAULT_HOLD_S)?;
/// let mut times = Vec::new();
/// let mut out = |event: SensorEvent| times.push(event.time_ns());
/// let (field_ut, up_m_s2) = (Vector3::new(0.0, 22.0, -40.0), Vector3::new(0.0, 0.0, 9.8));
/// queue.push(SensorEvent::Magnetic(MagneticSample { time_ns: 8_000_000, field_ut }), &mut out);
/// queue.push(SensorEvent::Up(UpSample { time_ns: 5_000_000, up_m_s2 }), &mut out);
/// queue.push(SensorEvent::Up(UpSample { time_ns: 9_000_000, up_m_s2 }), &mut out);
/// queue.flush(&mut out); // the stream has ended
/// assert_eq!(times, [5_000_000, 8_000_000, 9_000_000]);
/// # Ok::<(), magcomp::ConfigError>(())
/// ```
#[derive(Clone, Debug)]
pub struct EventQueue {
    hold_ns: i64,
    /// In the order they go out.
    waiting: Roomy<VecDeque<SensorEvent>>,
    /// Time of the event the stream began with, ns.
    begin_ns: i64,
    /// Time of the latest event of each sensor, ns; none yet: `NEVER`.
    latest_ns: [i64; 3],
}

/// Mathematics: before every time.
const NEVER: i64 = i64::MIN;

impl EventQueue {
    /// Choice: longest that an event waits unless another time is chosen, s: longer than the sensors of a phone differ where no batches are asked for.
    pub const DEFAULT_HOLD_S: f64 = 0.05;

    /// An empty queue in which no event waits for longer than `hold_s`, 0 to 0.25 s; 0: every event goes out as it comes. For
    /// batches choose a little more than one batch takes.
    ///
    /// # Errors
    /// [`ConfigError`] when `hold_s` is out of range.
    pub fn new(hold_s: f64) -> Result<Self, ConfigError> {
        // by then its sensor counts as absent
        in_range("hold_s", hold_s, 0.0..=STALE_S, "s")?;
        let waiting = Roomy::<VecDeque<_>>::new(ROOM);
        Ok(Self { hold_ns: (hold_s * 1e9) as i64, waiting, begin_ns: 0, latest_ns: [NEVER; 3] })
    }

    /// Takes the event that was delivered next, and gives `out` those whose turn it is now, in order: none, one or several. When 256
    /// wait, the first goes out whatever it waits for.
    pub fn push(&mut self, event: SensorEvent, mut out: impl FnMut(SensorEvent)) {
        let (time_ns, sensor) = event.place();
        let since_ns = time_ns.saturating_sub(self.newest_ns());
        if self.newest_ns() == NEVER || !(-ANOTHER_CLOCK_NS..=PAUSE_NS).contains(&since_ns) {
            self.flush(&mut out);
            self.begin_ns = time_ns;
        }
        let place = self.waiting.partition_point(|other| other.place() <= event.place());
        self.waiting.insert(place, event);
        self.latest_ns[sensor] = time_ns;
        while self.waiting.front().is_some_and(|first| self.is_due(first.time_ns())) {
            self.waiting.pop_front().into_iter().for_each(&mut out);
        }
    }

    /// Gives `out` everything that waits: the stream has ended, or another begins.
    pub fn flush(&mut self, out: impl FnMut(SensorEvent)) {
        self.latest_ns = [NEVER; 3];
        self.waiting.drain(..).for_each(out);
    }

    /// Whether an event of this time waits no longer.
    fn is_due(&self, time_ns: i64) -> bool {
        let newest_ns = self.newest_ns();
        let lives = |latest_ns: i64| newest_ns.saturating_sub(latest_ns.max(self.begin_ns)) <= PAUSE_NS;
        self.waiting.len() >= ROOM
            || newest_ns.saturating_sub(time_ns) >= self.hold_ns
            || self.latest_ns.iter().all(|latest_ns| *latest_ns >= time_ns || !lives(*latest_ns))
    }

    fn newest_ns(&self) -> i64 {
        self.latest_ns.into_iter().fold(NEVER, i64::max)
    }
}
