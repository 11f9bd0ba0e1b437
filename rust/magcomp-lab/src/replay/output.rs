//! The output of `replay`: one row for every input row, in order.

use super::player::Step;
use crate::atomic::AtomicFile;
use crate::error::LabError;
use magcomp::Calibration;
use magcomp::nalgebra::Vector3;
use magcomp_recordings::recording::Row;
use std::io::{self, Write};
use std::path::Path;

/// The columns of a recording (`magcomp replay --help`).
const COLUMNS: &str = "t_s,cx,cy,cz,fx,fy,fz,heading_deg,heading_sigma_deg,inclination_deg,sigma_t,window,coverage,status,\
                       bx,by,bz,w00,w01,w02,w10,w11,w12,w20,w21,w22,ns";

/// The output of a replay in the making; it appears under its name when it is finished.
pub struct Output {
    file: AtomicFile,
    true_heading: bool,
}

impl Output {
    /// Begins to write `path`; with a `true_heading_deg` column at the end when a declination was given.
    ///
    /// # Errors
    /// [`LabError::Write`]; a file that was at `path` before is untouched then.
    pub fn create(path: &Path, true_heading: bool) -> Result<Self, LabError> {
        let mut file = AtomicFile::create(path)?;
        file.write(|out| write_header(out, true_heading))?;
        Ok(Self { file, true_heading })
    }

    /// The next row and the compensator's step for it.
    pub fn add(&mut self, row: &Row, step: &Step) -> Result<(), LabError> {
        self.file.write(|out| write_row(out, row, step, self.true_heading))
    }

    /// Moves it into place.
    pub fn finish(self) -> Result<(), LabError> {
        self.file.finish()
    }
}

/// The names of the columns, as a line.
pub fn write_header(out: &mut dyn Write, true_heading: bool) -> io::Result<()> {
    writeln!(out, "{COLUMNS}{}", if true_heading { ",true_heading_deg" } else { "" })
}

/// The line of a row and the compensator's step for it.
pub fn write_row(out: &mut dyn Write, row: &Row, step: &Step, true_heading: bool) -> io::Result<()> {
    write!(out, "{}", row.time_s)?;
    line(out, step)?;
    if true_heading {
        cell(out, step.reading.heading.and_then(|heading| heading.true_heading_deg), 4)?;
    }
    writeln!(out)
}

fn line(out: &mut dyn Write, step: &Step) -> io::Result<()> {
    let Step { reading, calibration, push_ns, .. } = step;
    vector(out, reading.field_ut, 6)?;
    vector(out, reading.filtered_field_ut, 6)?;
    let heading = reading.heading;
    cell(out, heading.map(|heading| heading.heading_deg), 4)?;
    cell(out, heading.and_then(|heading| heading.heading_sigma_deg), 4)?;
    cell(out, heading.and_then(|heading| heading.inclination_deg), 4)?;
    cell(out, reading.sigma_t, 6)?;
    write!(out, ",{},{:.4},{}", reading.window, reading.coverage, reading.status.label())?;
    // in force before there is a calibration: no correction
    let calibration = calibration.unwrap_or_else(|| Calibration::identity(1.0).expect("1 uT is a field strength"));
    vector(out, Some(*calibration.hard_iron_ut()), 6)?;
    for row in 0..3 {
        for column in 0..3 {
            cell(out, Some(calibration.soft_iron_inverse()[(row, column)]), 9)?;
        }
    }
    write!(out, ",{push_ns}")
}

pub(super) fn vector(out: &mut dyn Write, value: Option<Vector3<f64>>, digits: usize) -> io::Result<()> {
    (0..3).try_for_each(|i| cell(out, value.map(|v| v[i]), digits))
}

/// A number, or an empty cell where it is not known.
pub(super) fn cell(out: &mut dyn Write, value: Option<f64>, digits: usize) -> io::Result<()> {
    match value {
        Some(v) => write!(out, ",{v:.digits$}"),
        None => write!(out, ","),
    }
}
