//! How files that are no logger's own are read.

use super::sheet::numbered;
use super::units::{Frames, Shifts, Units};
use crate::recording::name_of;
use std::path::Path;
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

/// Names of a file's columns, in the order of `QUANTITIES`; some files may have names of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnNames {
    pub(super) names: Vec<String>,
    /// Those that were given.
    given: Vec<usize>,
    /// Files with names of their own.
    files: Vec<(String, ColumnNames)>,
}

impl Default for ColumnNames {
    fn default() -> Self {
        let in_a_recording = |quantity: &str| match quantity {
            "t" => "t_s".to_owned(),
            "sx" | "sy" | "sz" => quantity.replace('s', "sys_m"),
            other => other.to_owned(),
        };
        Self { names: QUANTITIES.map(in_a_recording).to_vec(), given: Vec::new(), files: Vec::new() }
    }
}

impl FromStr for ColumnNames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut names = Self::default();
        // those behind `FILE:` are of that file, until another one is named
        let mut file: Option<usize> = None;
        for part in text.split(',') {
            let (what, name) = part.split_once('=').ok_or("expected such as t=time_ns,mx=mag_x,my=mag_y,mz=mag_z")?;
            let what = match what.rsplit_once(':') {
                Some((path, what)) => {
                    let path = path.trim().to_owned();
                    let place = names.files.iter().position(|(known, _)| *known == path);
                    file = place.or_else(|| {
                        names.files.push((path, Self::default()));
                        Some(names.files.len() - 1)
                    });
                    what
                }
                None => what,
            };
            let index = QUANTITIES.iter().position(|known| *known == what.trim());
            let index = index.ok_or_else(|| format!("'{what}' is none of {}", QUANTITIES.join(", ")))?;
            let of = match file {
                Some(file) => &mut names.files[file].1,
                None => &mut names,
            };
            of.names[index] = name.trim().to_owned();
            of.given.push(index);
        }
        Ok(names)
    }
}

impl ColumnNames {
    /// Whether all of the columns that were given are numbers.
    pub(super) fn are_numbers(&self) -> bool {
        !self.given.is_empty() && self.given.iter().all(|index| numbered(&self.names[*index]).is_some())
    }

    /// Those of a file that has names of its own: what they leave out is as for all files, but no sensor where they name some.
    pub(super) fn of_file(&self, path: &Path) -> Option<Self> {
        let own = &self.files.iter().find(|(file, _)| *file == name_of(path))?.1;
        let mut names = if own.given.iter().any(|index| *index > 0) {
            Self { names: vec![String::new(); QUANTITIES.len()], ..Self::default() }
        } else {
            self.clone()
        };
        names.names[0] = self.names[0].clone();
        own.given.iter().for_each(|index| names.names[*index] = own.names[*index].clone());
        Some(Self { given: own.given.clone(), files: Vec::new(), ..names })
    }

    /// A file that has names of its own and is none of these.
    pub(super) fn unknown_file<'a>(&self, mut paths: impl Iterator<Item = &'a Path>) -> Option<&str> {
        let names: Vec<String> = paths.by_ref().map(name_of).collect();
        self.files.iter().map(|(file, _)| file.as_str()).find(|file| !names.iter().any(|name| name == file))
    }
}
