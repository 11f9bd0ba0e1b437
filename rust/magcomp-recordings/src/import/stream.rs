//! The events of one sensor of a session.

use crate::error::{Place, RecordingError};
use std::ops::Range;

/// Events of one sensor, at most: they wait in memory until all sensors are merged. At 100 Hz they are 23 hours.
const MOST_EVENTS: usize = 1 << 23;

/// One sensor's events.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Stream<T> {
    /// Time, ns, and value; in the order of time once the session is sorted.
    pub events: Vec<(i64, T)>,
    /// The cells of time and value of its first event.
    pub first: Option<[Place; 2]>,
    /// What is told of the end of its file, where that was left out.
    pub cut: Option<String>,
}

// not derived, which would ask for a default of the values
impl<T> Default for Stream<T> {
    fn default() -> Self {
        Self { events: Vec::new(), first: None, cut: None }
    }
}

impl<T> Stream<T> {
    /// One more event. The error is that there are too many.
    pub fn add(&mut self, time_ns: i64, value: T, places: impl FnOnce() -> [Place; 2]) -> Result<(), RecordingError> {
        if self.events.len() == MOST_EVENTS {
            let ([place, _], expected) = (places(), format!("at most {MOST_EVENTS} events of a sensor"));
            return Err(RecordingError::Form { place, expected, found: "more; import a shorter session".to_owned() });
        }
        self.first.get_or_insert_with(places);
        self.events.push((time_ns, value));
        Ok(())
    }

    pub fn keep(&mut self, part: &Range<usize>) {
        self.events.truncate(part.end);
        self.events.drain(..part.start.min(self.events.len()));
    }
}
