//! What lies beside a recording: the other files of a folder, and small tables.

use super::source::unzipped;
use crate::error::{LabError, Place};
use serde::de::DeserializeOwned;
use std::fs::File;
use std::path::{Path, PathBuf};

/// The files of a folder, by name.
///
/// # Errors
/// [`LabError::Read`].
pub fn files_of(folder: &Path) -> Result<Vec<PathBuf>, LabError> {
    let entries = std::fs::read_dir(folder).and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect());
    let mut paths: Vec<PathBuf> = entries.map_err(LabError::read(folder))?;
    paths.retain(|path| path.is_file());
    paths.sort();
    Ok(paths)
}

/// Reads all lines of a table, CSV with a header, gzipped or not, each as a value of one type; `expected` names its form for errors.
///
/// # Errors
/// [`LabError::Recording`] for a file of another form, [`LabError::Read`] when it cannot be read.
pub fn read_table<T: DeserializeOwned>(path: &Path, expected: &str) -> Result<Vec<T>, LabError> {
    let file = File::open(path).and_then(unzipped).map_err(LabError::read(path))?;
    let wrong = |error: csv::Error| LabError::Recording {
        place: Place { path: path.to_owned(), line: error.position().map_or(1, csv::Position::line), column: None },
        expected: expected.to_owned(),
        found: error.to_string(),
    };
    csv::Reader::from_reader(file).deserialize().collect::<Result<_, _>>().map_err(wrong)
}
