//! Any CSV: columns named by options. Each file holds the sensors whose columns it has, so several files make one session.

use super::document::Document;
use super::session::Session;
use super::sheet::Sheet;
use super::units::Units;
use crate::error::{LabError, Place};
use magcomp::nalgebra::{Quaternion, UnitQuaternion};
use std::str::FromStr;

const SECOND_NS: i64 = 1_000_000_000;
/// The quantities of columns, and their names in a recording.
const QUANTITIES: [(&str, &str); 17] = [
    ("t", "t_s"),
    ("mx", "mx"),
    ("my", "my"),
    ("mz", "mz"),
    ("ax", "ax"),
    ("ay", "ay"),
    ("az", "az"),
    ("gx", "gx"),
    ("gy", "gy"),
    ("gz", "gz"),
    ("sx", "sys_mx"),
    ("sy", "sys_my"),
    ("sz", "sys_mz"),
    ("qw", "qw"),
    ("qx", "qx"),
    ("qy", "qy"),
    ("qz", "qz"),
];

/// Names of a file's columns, in the order of `QUANTITIES`.
#[derive(Clone, Debug, PartialEq)]
pub struct ColumnNames(Vec<String>);

impl Default for ColumnNames {
    fn default() -> Self {
        Self(QUANTITIES.iter().map(|(_, name)| (*name).to_owned()).collect())
    }
}

impl FromStr for ColumnNames {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let mut names = Self::default();
        for part in text.split(',') {
            let (what, name) = part.split_once('=').ok_or("expected such as t=time_ns,mx=mag_x,my=mag_y,mz=mag_z")?;
            let index = QUANTITIES.iter().position(|(known, _)| *known == what.trim());
            let known = || QUANTITIES.map(|(known, _)| known).join(", ");
            let index = index.ok_or_else(|| format!("'{what}' is none of {}", known()))?;
            names.0[index] = name.trim().to_owned();
        }
        Ok(names)
    }
}

/// Whether a file has a time and some sensor under these names.
pub(super) fn is_header(header: &[String], names: &ColumnNames) -> bool {
    let has = |index: usize| header.contains(&names.0[index]);
    has(0) && [1, 4, 7, 10].into_iter().any(has)
}

pub(super) fn read(documents: &[Document], names: &ColumnNames, units: &Units) -> Result<Session, LabError> {
    let mut session = Session::default();
    for document in documents {
        let header = Sheet::new(document).header;
        let has_field = names.0[1..4].iter().any(|name| header.contains(name));
        match read_one(document, names, units) {
            Ok(part) => session.append(part),
            // the others can be done without
            Err(why) if has_field || documents.len() == 1 => return Err(why),
            Err(why) => session.leave_out("no magnetometer", why),
        }
    }
    Ok(session)
}

fn read_one(document: &Document, names: &ColumnNames, units: &Units) -> Result<Session, LabError> {
    let mut session = Session::default();
    let [field, rate] = [units.field, units.rate].map(|factor| factor.unwrap_or(1.0));
    let factors = [field, units.acceleration.unwrap_or(1.0), rate, field];
    let sheet = Sheet::new(document);
    let time = sheet.required(&names.0[0])?;
    let sensors =
        [group::<3>(&sheet, names, 1)?, group(&sheet, names, 4)?, group(&sheet, names, 7)?, group(&sheet, names, 10)?];
    let attitude = group::<4>(&sheet, names, 13)?;
    if sensors.iter().all(Option::is_none) {
        return Err(LabError::Recording {
            place: Place { path: sheet.path().to_owned(), line: 1, column: None },
            expected: format!(
                "a sensor's columns, such as {}; name them by --columns mx=NAME,...",
                names.0[1..4].join(",")
            ),
            found: sheet.shown(),
        });
    }
    for cells in sheet.rows() {
        let cells = cells?;
        let time_ns = cells.time_ns(time, units.time_ns.unwrap_or(SECOND_NS))?;
        let streams = [&mut session.raw, &mut session.up, &mut session.rate, &mut session.system];
        for ((stream, columns), factor) in streams.into_iter().zip(sensors).zip(factors) {
            let Some(columns) = columns else { continue };
            if let Some(value) = cells.vector(columns)? {
                stream.add(time_ns, value * factor, || [cells.place(time), cells.place(columns[0])])?;
            }
        }
        if let Some([w, x, y, z]) = attitude.filter(|[w, ..]| !cells.text(*w).is_empty()) {
            let q = Quaternion::new(cells.number(w)?, cells.number(x)?, cells.number(y)?, cells.number(z)?);
            if let Some(q) = UnitQuaternion::try_new(q, 1e-6).filter(|_| q.norm().is_finite()) {
                session.attitude.add(time_ns, q, || [cells.place(time), cells.place(w)])?;
            }
        }
    }
    Ok(session)
}

/// Where a sensor's columns are: all of them or none.
fn group<const N: usize>(sheet: &Sheet<'_>, names: &ColumnNames, first: usize) -> Result<Option<[usize; N]>, LabError> {
    let names = &names.0[first..first + N];
    if names.iter().all(|name| sheet.column(name).is_none()) {
        return Ok(None);
    }
    let mut columns = [0; N];
    for (column, name) in columns.iter_mut().zip(names) {
        *column = sheet.required(name)?;
    }
    Ok(Some(columns))
}
