//! In the place of `columnar.rs`, in a build without the feature `formats`.

use crate::error::RecordingError;
use std::path::Path;

/// Refuses a Parquet or Arrow file.
pub(super) fn as_csv(path: &Path, _bytes: Vec<u8>) -> Result<Vec<u8>, RecordingError> {
    Err(RecordingError::Feature { path: path.to_owned(), form: "Parquet and Arrow" })
}
