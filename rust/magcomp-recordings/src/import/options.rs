//! How files that are no logger's own are read.

use super::column_names::ColumnNames;
use super::units::{Frames, Shifts, Units};

/// How plain CSV, Parquet and Arrow are read; the loggers' own files need none of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImportOptions {
    /// Names of the columns.
    pub columns: Option<ColumnNames>,
    /// Units of the columns.
    pub units: Option<Units>,
    /// Which of the file's axes point right, up along the screen, and out of it.
    pub frame: Option<Frames>,
    /// What is added to the times of a sensor.
    pub shift: Option<Shifts>,
    /// So many rows a second, of a file without times.
    pub rate: Option<f64>,
    /// Lines at the beginning of each text file that are passed over.
    pub skip: u64,
    /// Which of several sessions that follow one another in one file, counted from 1.
    pub session: Option<usize>,
    /// Takes what is left of a sensor, even where most of its events are lost.
    pub force: bool,
    /// Topics of ROS to take, where several have the same sensor.
    pub topics: Vec<String>,
}
