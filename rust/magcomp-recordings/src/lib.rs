//! Recordings of a phone's sensors.
//!
//! [`import::open`] takes a file or a folder: a [`recording`] is read row by row, and the session of a phone's logger is made into one. Its
//! [`conventions`] are checked. [`place`] knows the Earth's field where it was recorded.

pub mod conventions;
pub mod error;
pub mod import;
pub mod place;
pub mod recording;
pub mod time;
