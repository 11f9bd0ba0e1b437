//! The columns of a recording, found by name, and the values of a line, with an error that names file, line, column and what was
//! expected there.

use super::record::Record;
use super::rows::{Course, Row};
use crate::error::{Place, RecordingError, shorten};
use crate::time::{is_time, time_ns};
use magcomp::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use std::path::Path;

/// One line: the values of the sensors that have an event at its time.
pub(crate) struct Line {
    pub field_ut: Option<Vector3<f64>>,
    /// All of it but the field and what came before.
    pub row: Row,
}

pub(super) struct Columns {
    pub names: Vec<String>,
    time: usize,
    magnetic: [usize; 3],
    accelerometer: Option<[usize; 3]>,
    gyroscope: Option<[usize; 3]>,
    system: Option<[usize; 3]>,
    reference: Option<[usize; 4]>,
    hard_iron: Option<[usize; 3]>,
    course: Option<[usize; 2]>,
}

impl Columns {
    pub fn from_header(path: &Path, header: &Record) -> Result<Self, RecordingError> {
        let names: Vec<String> = header.texts();
        let wrong = |expected: String| RecordingError::Form {
            place: Place { path: path.to_owned(), line: 1, column: None },
            expected,
            found: format!("'{}'", shorten(&names.join(","))),
        };
        let index = |name: &str| -> Result<Option<usize>, RecordingError> {
            let mut places = (0..names.len()).filter(|i| names[*i] == name);
            match (places.next(), places.next()) {
                (_, Some(_)) => Err(wrong(format!("column '{name}' once"))),
                (place, None) => Ok(place),
            }
        };
        let required = |name: &str| {
            index(name)?.ok_or_else(|| wrong(format!("a header with the columns t_s,mx,my,mz; '{name}' is missing")))
        };
        Ok(Self {
            time: required("t_s")?,
            magnetic: [required("mx")?, required("my")?, required("mz")?],
            accelerometer: group(["ax", "ay", "az"], index, wrong)?,
            gyroscope: group(["gx", "gy", "gz"], index, wrong)?,
            system: group(["sys_mx", "sys_my", "sys_mz"], index, wrong)?,
            reference: group(["qw", "qx", "qy", "qz"], index, wrong)?,
            hard_iron: group(["true_bx", "true_by", "true_bz"], index, wrong)?,
            course: group(["course_deg", "course_sigma_deg"], index, wrong)?,
            names,
        })
    }

    /// Whether this column is read.
    pub fn takes(&self, column: usize) -> bool {
        let threes = [Some(self.magnetic), self.accelerometer, self.gyroscope, self.system, self.hard_iron];
        column == self.time || threes.iter().flatten().flatten().any(|taken| *taken == column)
    }

    /// The values of a line; `before` is the time of the line before, s and ns.
    pub fn line(&self, path: &Path, record: &Record, before: Option<(f64, i64)>) -> Result<Line, RecordingError> {
        let line = record.line;
        let wrong = |column: Option<usize>, expected: String, found: String| RecordingError::Form {
            place: Place {
                path: path.to_owned(),
                line,
                column: column.map(|i| (i + 1, self.names.get(i).cloned().unwrap_or_default())),
            },
            expected,
            found,
        };
        if record.len() != self.names.len() {
            // the first cell that is missing or too many
            let column = record.len().min(self.names.len());
            return Err(wrong(Some(column), format!("{} cells", self.names.len()), record.len().to_string()));
        }
        let cell = |i: usize| record.get(i).unwrap_or_default();
        let number = |i: usize| -> Result<f64, RecordingError> {
            let value = std::str::from_utf8(cell(i)).ok().and_then(|text| text.trim().parse().ok());
            value.ok_or_else(|| {
                let text = String::from_utf8_lossy(cell(i));
                let is_empty = text.trim().is_empty();
                let found = if is_empty { "an empty cell".to_owned() } else { format!("'{}'", shorten(&text)) };
                wrong(Some(i), "a number".to_owned(), found)
            })
        };
        // a sensor that said nothing at this time leaves all its cells empty
        let silent = |cells: &[usize]| cells.iter().all(|i| cell(*i).trim_ascii().is_empty());
        let vector = |cells: [usize; 3]| {
            let [x, y, z] = cells;
            if silent(&cells) {
                return Ok::<_, RecordingError>(None);
            }
            Ok(Some(Vector3::new(number(x)?, number(y)?, number(z)?)))
        };
        let of = |cells: Option<[usize; 3]>| cells.map_or(Ok(None), vector);

        let time_s = number(self.time)?;
        if !is_time(time_s) {
            let hint = if time_s.is_finite() { "; name another unit by --units t=ms, us or ns" } else { "" };
            return Err(wrong(Some(self.time), format!("a time in seconds{hint}"), time_s.to_string()));
        }
        let time_ns = time_ns(time_s);
        if let Some((before_s, _)) = before.filter(|(_, before_ns)| time_ns <= *before_ns) {
            let expected = format!("a time after {before_s} s");
            return Err(wrong(Some(self.time), expected, format!("{time_s} s")));
        }
        let field_ut = vector(self.magnetic)?;
        let row = Row {
            time_s,
            time_ns,
            up_m_s2: of(self.accelerometer)?,
            rate_rad_s: of(self.gyroscope)?,
            system_ut: of(self.system)?,
            attitude: match self.reference {
                None => None,
                Some(cells) if silent(&cells) => None,
                Some([w, x, y, z]) => {
                    let q = Quaternion::new(number(w)?, number(x)?, number(y)?, number(z)?);
                    UnitQuaternion::try_new(q, 1e-6).filter(|_| q.norm().is_finite())
                }
            },
            hard_iron_ut: of(self.hard_iron)?,
            course: match self.course {
                Some(cells) if !silent(&cells) => {
                    Some(Course { heading_deg: number(cells[0])?, sigma_deg: number(cells[1])? })
                }
                _ => None,
            },
            ..Row::default()
        };
        Ok(Line { field_ut, row })
    }
}

/// The columns of one sensor: all of them or none.
fn group<const N: usize>(
    names: [&str; N],
    index: impl Fn(&str) -> Result<Option<usize>, RecordingError>,
    wrong: impl Fn(String) -> RecordingError,
) -> Result<Option<[usize; N]>, RecordingError> {
    let mut places = [0; N];
    let mut present = 0;
    for (place, name) in places.iter_mut().zip(names) {
        if let Some(found) = index(name)? {
            *place = found;
            present += 1;
        }
    }
    match present {
        0 => Ok(None),
        _ if present == N => Ok(Some(places)),
        _ => Err(wrong(format!("all of the columns {} or none", names.join(",")))),
    }
}
