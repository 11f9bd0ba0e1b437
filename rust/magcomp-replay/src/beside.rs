//! Small tables that lie beside recordings.

use magcomp_recordings::error::{Place, RecordingError};
use magcomp_recordings::recording::unzipped;
use serde::de::DeserializeOwned;
use std::fs::File;
use std::path::Path;

/// Reads all lines of a table, CSV with a header, gzipped or not, each as a value of one type; `expected` names its form for errors.
pub fn read_table<T: DeserializeOwned>(path: &Path, expected: &str) -> Result<Vec<T>, RecordingError> {
    let file = File::open(path).and_then(unzipped).map_err(RecordingError::read(path))?;
    let wrong = |error: csv::Error| RecordingError::Form {
        place: Place { path: path.to_owned(), line: error.position().map_or(1, csv::Position::line), column: None },
        expected: expected.to_owned(),
        found: error.to_string(),
    };
    csv::Reader::from_reader(file).deserialize().collect::<Result<_, _>>().map_err(wrong)
}
