//! Writing a recording.

use super::rows::{Recording, Row};
use magcomp::nalgebra::Vector3;
use std::io::{self, Write};

/// Writes a recording, one line for every magnetometer sample. Columns of a sensor that no row has are left out; events of the other
/// sensors between two samples are not written.
pub fn write_recording(out: &mut dyn Write, recording: &Recording) -> io::Result<()> {
    let any = |has: fn(&Row) -> bool| recording.rows.iter().any(has);
    let groups: [(bool, &str); 4] = [
        (any(|row| row.up_m_s2.is_some()), ",ax,ay,az"),
        (any(|row| row.rate_rad_s.is_some()), ",gx,gy,gz"),
        (any(|row| row.attitude.is_some()), ",qw,qx,qy,qz"),
        (any(|row| row.hard_iron_ut.is_some()), ",true_bx,true_by,true_bz"),
    ];
    let [has_up, has_rate, has_attitude, has_hard_iron] = groups.map(|(has, _)| has);
    write!(out, "t_s,mx,my,mz")?;
    groups.iter().filter(|(has, _)| *has).try_for_each(|(_, columns)| write!(out, "{columns}"))?;
    writeln!(out)?;
    for row in &recording.rows {
        write!(out, "{}", row.time_s)?;
        vector(out, Some(row.field_ut), true)?;
        vector(out, row.up_m_s2, has_up)?;
        vector(out, row.rate_rad_s, has_rate)?;
        match row.attitude {
            Some(q) => write!(out, ",{:.9},{:.9},{:.9},{:.9}", q.w, q.i, q.j, q.k)?,
            None if has_attitude => write!(out, ",,,,")?,
            None => {}
        }
        vector(out, row.hard_iron_ut, has_hard_iron)?;
        writeln!(out)?;
    }
    Ok(())
}

/// Micro-units: below the noise of every sensor. Empty cells where there is a column but no value.
fn vector(out: &mut dyn Write, value: Option<Vector3<f64>>, has_column: bool) -> io::Result<()> {
    match value {
        Some(v) => write!(out, ",{:.6},{:.6},{:.6}", v.x, v.y, v.z),
        None if has_column => write!(out, ",,,"),
        None => Ok(()),
    }
}
