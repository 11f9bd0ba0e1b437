//! Reading a recording row by row, with an error that names file, line, column and what was expected there.

use super::rows::{Extent, Inertial, Recording, Row};
use crate::error::{LabError, Place};
use crate::time::{is_time, time_ns};
use csv::{ByteRecord, ReaderBuilder};
use flate2::read::MultiGzDecoder;
use magcomp::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read, Seek};
use std::path::{Path, PathBuf};

/// First bytes of a gzip file.
const GZIP: [u8; 2] = [0x1f, 0x8b];
/// Bytes of a line, at most: it lies in memory.
const LONGEST_LINE: usize = 1 << 20;
/// Events of other sensors that wait for the next magnetometer sample, at most: an hour of two sensors at 140 Hz.
const MOST_WAITING: usize = 1 << 20;

/// A recording on disk, gzipped or not. It was read once, so every row is known to be good; its rows are not in memory.
#[derive(Debug)]
pub struct Source {
    path: PathBuf,
    file: File,
    extent: Extent,
}

impl Source {
    /// The recording in `file`, under the name it came from. Every row is checked.
    ///
    /// # Errors
    /// [`LabError::Recording`] for a file of another form, [`LabError::Empty`] for one without rows, [`LabError::Read`] when
    /// it cannot be read.
    pub fn of(path: &Path, file: File) -> Result<Self, LabError> {
        let mut source = Self { path: path.to_owned(), file, extent: Extent::default() };
        for row in source.rows()? {
            source.extent.add(&row?);
        }
        if source.extent.rows == 0 {
            return Err(LabError::Empty { path: path.to_owned(), what: "a header but no rows" });
        }
        Ok(source)
    }

    /// Where it came from.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How many rows it has, and over what time.
    #[must_use]
    pub fn extent(&self) -> &Extent {
        &self.extent
    }

    /// Its rows from the first on. The rows of an earlier call must not be read any further.
    ///
    /// # Errors
    /// As of [`Source::of`].
    pub fn rows(&mut self) -> Result<Rows, LabError> {
        self.file.rewind().map_err(LabError::read(&self.path))?;
        let file = self.file.try_clone().map_err(LabError::read(&self.path))?;
        Rows::new(&self.path, unzipped(file).map_err(LabError::read(&self.path))?)
    }
}

/// Reads a whole recording into memory; `path` is its name in messages.
///
/// # Errors
/// As of [`Source::of`].
pub fn read_from(path: &Path, source: impl Read + 'static) -> Result<Recording, LabError> {
    let rows = Rows::new(path, unzipped(source).map_err(LabError::read(path))?)?;
    Ok(Recording { path: path.to_owned(), rows: rows.collect::<Result<_, _>>()? })
}

/// Opens `path` and reads a whole recording into memory.
///
/// # Errors
/// As of [`Source::of`].
pub fn read(path: &Path) -> Result<Recording, LabError> {
    read_from(path, File::open(path).map_err(LabError::read(path))?)
}

/// The content of `source`, gzipped or not.
///
/// # Errors
/// When it cannot be read.
pub fn unzipped(source: impl Read + 'static) -> io::Result<Box<dyn Read>> {
    let mut source = BufReader::new(source);
    let zipped = source.fill_buf()?.starts_with(&GZIP);
    Ok(if zipped { Box::new(MultiGzDecoder::new(source)) } else { Box::new(source) })
}

/// A text, of which no line may be longer than memory allows. The owner sets `read` to 0 after each line.
struct Lines {
    source: Box<dyn Read>,
    read: usize,
}

impl Read for Lines {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.read > LONGEST_LINE {
            let why =
                format!("a line has more than {LONGEST_LINE} bytes; is a quotation mark open, or is this no CSV?");
            return Err(io::Error::new(io::ErrorKind::InvalidData, why));
        }
        let read = self.source.read(buffer)?;
        self.read += read;
        Ok(read)
    }
}

/// The rows of a recording, in order; an error ends them.
pub struct Rows {
    path: PathBuf,
    reader: csv::Reader<Lines>,
    record: ByteRecord,
    columns: Columns,
    /// Time of the line before.
    before: Option<(f64, i64)>,
}

impl Rows {
    fn new(path: &Path, source: Box<dyn Read>) -> Result<Self, LabError> {
        let mut reader = ReaderBuilder::new().has_headers(false).flexible(true).from_reader(Lines { source, read: 0 });
        let mut record = ByteRecord::new();
        if !reader.read_byte_record(&mut record).map_err(|error| unreadable(path, error))? {
            return Err(LabError::Empty { path: path.to_owned(), what: "nothing in it" });
        }
        let columns = Columns::from_header(path, &record)?;
        Ok(Self { path: path.to_owned(), reader, record, columns, before: None })
    }

    /// Where the cell of a name is in the first line after the header.
    pub(crate) fn first_place(&self, name: &str) -> Place {
        let index = self.columns.names.iter().position(|column| column == name);
        Place { path: self.path.clone(), line: 2, column: index.map(|index| (index + 1, name.to_owned())) }
    }

    /// The next magnetometer sample, with the events of the lines before it that have none.
    fn read(&mut self) -> Result<Option<Row>, LabError> {
        let (mut before, mut system_ut) = (Vec::new(), None);
        while self.reader.read_byte_record(&mut self.record).map_err(|error| unreadable(&self.path, error))? {
            self.reader.get_mut().read = 0;
            let line = self.columns.line(&self.path, &self.record, self.before)?;
            self.before = Some((line.time_s, line.time_ns));
            system_ut = line.system_ut.or(system_ut);
            let Some(field_ut) = line.field_ut else {
                if line.rate_rad_s.is_some() || line.up_m_s2.is_some() {
                    if before.len() == MOST_WAITING {
                        return Err(LabError::Recording {
                            place: Place {
                                path: self.path.clone(),
                                line: self.record.position().map_or(0, csv::Position::line),
                                column: None,
                            },
                            expected: "a magnetometer sample".to_owned(),
                            found: format!(
                                "{MOST_WAITING} rows of other sensors before it; cut the part without magnetometer off"
                            ),
                        });
                    }
                    let Line { time_ns, rate_rad_s, up_m_s2, .. } = line;
                    before.push(Inertial { time_ns, rate_rad_s, up_m_s2 });
                }
                continue;
            };
            return Ok(Some(Row {
                time_s: line.time_s,
                time_ns: line.time_ns,
                field_ut,
                before,
                up_m_s2: line.up_m_s2,
                rate_rad_s: line.rate_rad_s,
                system_ut,
                attitude: line.attitude,
                hard_iron_ut: line.hard_iron_ut,
            }));
        }
        Ok(None)
    }
}

impl Iterator for Rows {
    type Item = Result<Row, LabError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.read().transpose()
    }
}

fn unreadable(path: &Path, error: csv::Error) -> LabError {
    let message = error.to_string();
    let source = match error.into_kind() {
        csv::ErrorKind::Io(source) => source,
        _ => io::Error::new(io::ErrorKind::InvalidData, message),
    };
    LabError::Read { path: path.to_owned(), source }
}

/// One line: the values of the sensors that have an event at its time.
struct Line {
    time_s: f64,
    time_ns: i64,
    field_ut: Option<Vector3<f64>>,
    up_m_s2: Option<Vector3<f64>>,
    rate_rad_s: Option<Vector3<f64>>,
    system_ut: Option<Vector3<f64>>,
    attitude: Option<UnitQuaternion<f64>>,
    hard_iron_ut: Option<Vector3<f64>>,
}

/// Where each quantity is.
struct Columns {
    names: Vec<String>,
    time: usize,
    magnetic: [usize; 3],
    accelerometer: Option<[usize; 3]>,
    gyroscope: Option<[usize; 3]>,
    system: Option<[usize; 3]>,
    reference: Option<[usize; 4]>,
    hard_iron: Option<[usize; 3]>,
}

impl Columns {
    fn from_header(path: &Path, header: &ByteRecord) -> Result<Self, LabError> {
        let names: Vec<String> = header.iter().map(|name| String::from_utf8_lossy(name).trim().to_owned()).collect();
        let wrong = |expected: String| LabError::Recording {
            place: Place { path: path.to_owned(), line: 1, column: None },
            expected,
            found: format!("'{}'", shorten(&names.join(","))),
        };
        let index = |name: &str| -> Result<Option<usize>, LabError> {
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
            names,
        })
    }

    fn line(&self, path: &Path, record: &ByteRecord, before: Option<(f64, i64)>) -> Result<Line, LabError> {
        let line = record.position().map_or(0, csv::Position::line);
        let wrong = |column: Option<usize>, expected: String, found: String| LabError::Recording {
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
        let number = |i: usize| -> Result<f64, LabError> {
            let text = String::from_utf8_lossy(&record[i]);
            let found =
                if text.trim().is_empty() { "an empty cell".to_owned() } else { format!("'{}'", shorten(&text)) };
            text.trim().parse().map_err(|_| wrong(Some(i), "a number".to_owned(), found))
        };
        // a sensor that said nothing at this time leaves all its cells empty
        let silent = |cells: &[usize]| cells.iter().all(|i| record[*i].trim_ascii().is_empty());
        let vector = |cells: [usize; 3]| {
            let [x, y, z] = cells;
            if silent(&cells) {
                return Ok::<_, LabError>(None);
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
        Ok(Line {
            time_s,
            time_ns,
            field_ut: vector(self.magnetic)?,
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
        })
    }
}

/// The columns of one sensor: all of them or none.
fn group<const N: usize>(
    names: [&str; N],
    index: impl Fn(&str) -> Result<Option<usize>, LabError>,
    wrong: impl Fn(String) -> LabError,
) -> Result<Option<[usize; N]>, LabError> {
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

/// At most 60 characters, so that a message stays one line.
fn shorten(text: &str) -> String {
    let clean: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if clean.chars().count() <= 60 { clean } else { clean.chars().take(57).collect::<String>() + "..." }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn recording(text: &str) -> Result<Recording, LabError> {
        read_from(Path::new("r.csv"), io::Cursor::new(text.to_owned()))
    }

    fn message(text: &str) -> String {
        recording(text).unwrap_err().to_string()
    }

    #[test]
    fn columns_are_found_by_name_and_others_ignored() {
        let text = "note,mz,my,mx,qw,qx,qy,qz,t_s\r\nhello,3,2,1,nan,nan,nan,nan,0.5\r\nyou,nan,5,4,2,0,0,0,0.75\r\n";
        let recording = recording(text).unwrap();
        assert_eq!(recording.rows.len(), 2);
        assert_eq!(recording.rows[0].field_ut, Vector3::new(1.0, 2.0, 3.0));
        assert_eq!(recording.rows[0].attitude, None);
        assert_eq!(recording.rows[1].attitude, Some(UnitQuaternion::identity()));
        assert!(recording.rows[1].field_ut.z.is_nan());
        assert_eq!(recording.rows[1].time_ns, 750_000_000);
        assert_eq!(recording.extent().duration_s(), 0.25);
    }

    #[test]
    fn errors_say_where_and_what() {
        let cases = [
            ("", "r.csv: a recording has a header t_s,mx,my,mz and rows; this file has nothing in it"),
            (
                "t_s,mx,my\n",
                "r.csv: line 1: expected a header with the columns t_s,mx,my,mz; 'mz' is missing, found 't_s,mx,my'",
            ),
            ("t_s,mx,mx,my,mz\n", "r.csv: line 1: expected column 'mx' once, found 't_s,mx,mx,my,mz'"),
            (
                "t_s,mx,my,mz,gx\n",
                "r.csv: line 1: expected all of the columns gx,gy,gz or none, found 't_s,mx,my,mz,gx'",
            ),
            ("t_s,mx,my,mz\n0,1,2,3\n1,1,2\n", "r.csv: line 3, column 4 (mz): expected 4 cells, found 3"),
            ("t_s,mx,my,mz\n0,1,2,3,4\n", "r.csv: line 2, column 5: expected 4 cells, found 5"),
            ("t_s,mx,my,mz\n0,1,2,x3\n", "r.csv: line 2, column 4 (mz): expected a number, found 'x3'"),
            ("t_s,mx,my,mz\n0,1,,3\n", "r.csv: line 2, column 3 (my): expected a number, found an empty cell"),
            ("t_s,mx,my,mz\nnan,1,2,3\n", "r.csv: line 2, column 1 (t_s): expected a time in seconds, found NaN"),
            ("t_s,mx,my,mz\n1,1,2,3\n1,1,2,3\n", "r.csv: line 3, column 1 (t_s): expected a time after 1 s, found 1 s"),
        ];
        for (text, expected) in cases {
            assert_eq!(message(text), expected);
        }
    }
}
