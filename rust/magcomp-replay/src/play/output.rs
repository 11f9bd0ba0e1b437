//! The output of `replay`: one row for every input row, in order.

use super::player::Step;
use magcomp::Calibration;
use magcomp::nalgebra::Vector3;
use magcomp_recordings::recording::Row;
use std::io::{self, Write};

/// The columns of a recording (`magcomp replay --help`).
const COLUMNS: &str = "t_s,cx,cy,cz,fx,fy,fz,heading_deg,heading_sigma_deg,inclination_deg,sigma_t,window,coverage,status,\
                       bx,by,bz,w00,w01,w02,w10,w11,w12,w20,w21,w22,ns";

/// The names of the columns, as a line.
pub fn write_header(out: &mut dyn Write, true_heading: bool) -> io::Result<()> {
    writeln!(out, "{COLUMNS}{}", if true_heading { ",true_heading_deg" } else { "" })
}

/// The line of a row and the compensator's step for it.
pub fn write_row(out: &mut dyn Write, row: &Row, step: &Step, true_heading: bool) -> io::Result<()> {
    write!(out, "{}", row.time_s)?;
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
    write!(out, ",{push_ns}")?;
    if true_heading {
        cell(out, heading.and_then(|heading| heading.true_heading_deg), 4)?;
    }
    writeln!(out)
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
