//! How files that are no logger's own are read.

use super::sheet::numbered;
use super::units::{Frames, Shifts, Units};
use std::str::FromStr;

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

/// The quantities of columns.
const QUANTITIES: [&str; 17] =
    ["t", "mx", "my", "mz", "ax", "ay", "az", "gx", "gy", "gz", "sx", "sy", "sz", "qw", "qx", "qy", "qz"];

/// Names of a file's columns, in the order of `QUANTITIES`.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnNames {
    pub(super) names: Vec<String>,
    /// Those that were given.
    given: Vec<usize>,
}

impl Default for ColumnNames {
    fn default() -> Self {
        let in_a_recording = |quantity: &str| match quantity {
            "t" => "t_s".to_owned(),
            "sx" | "sy" | "sz" => quantity.replace('s', "sys_m"),
            other => other.to_owned(),
        };
        Self { names: QUANTITIES.map(in_a_recording).to_vec(), given: Vec::new() }
    }
}

impl FromStr for ColumnNames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut names = Self::default();
        for part in text.split(',') {
            let (what, name) = part.split_once('=').ok_or("expected such as t=time_ns,mx=mag_x,my=mag_y,mz=mag_z")?;
            let index = QUANTITIES.iter().position(|known| *known == what.trim());
            let index = index.ok_or_else(|| format!("'{what}' is none of {}", QUANTITIES.join(", ")))?;
            names.names[index] = name.trim().to_owned();
            names.given.push(index);
        }
        Ok(names)
    }
}

impl ColumnNames {
    /// Whether all of the columns that were given are numbers.
    pub(super) fn are_numbers(&self) -> bool {
        !self.given.is_empty() && self.given.iter().all(|index| numbered(&self.names[*index]).is_some())
    }
}
