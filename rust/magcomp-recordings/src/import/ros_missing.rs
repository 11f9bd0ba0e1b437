//! In the place of `ros.rs`, in a build without the feature `formats`.

use super::session::Session;
use super::units::Units;
use crate::error::RecordingError;
use crate::recording::Content;
use std::path::PathBuf;

/// Refuses bags, of which there is one at least.
pub(super) fn read_bags(
    bags: Vec<(PathBuf, Content)>,
    _topics: &[String],
    _units: &Units,
) -> Result<Session, RecordingError> {
    Err(RecordingError::Feature { path: bags[0].0.clone(), form: "a bag of ROS 2 (mcap)" })
}
