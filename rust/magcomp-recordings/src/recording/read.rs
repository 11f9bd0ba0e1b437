//! Reading a recording row by row.

use super::columns::{Columns, Line};
use super::events::Merged;
use super::record::{Delimiter, Record};
use super::rows::Row;
use crate::error::{Place, RecordingError};
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// Bytes of a line, at most: it lies in memory.
const LONGEST_LINE: usize = 1 << 20;
/// Events of other sensors that wait for the next magnetometer sample, at most: an hour of two sensors at 140 Hz.
const MOST_WAITING: usize = 1 << 20;

/// A text line by line, of which no line may be longer than memory allows.
struct Lines {
    source: BufReader<Box<dyn Read>>,
    text: Vec<u8>,
    record: Record,
}

impl Lines {
    /// Whether there is another line that is not empty; it is then in `record`.
    fn next(&mut self) -> io::Result<bool> {
        loop {
            self.text.clear();
            let mut limited = (&mut self.source).take(LONGEST_LINE as u64 + 1);
            if limited.read_until(b'\n', &mut self.text)? == 0 {
                return Ok(false);
            }
            self.record.line += 1;
            if self.text.len() > LONGEST_LINE {
                let line = self.record.line;
                let why = format!("line {line} has more than {LONGEST_LINE} bytes; is this no CSV?");
                return Err(io::Error::new(io::ErrorKind::InvalidData, why));
            }
            let end = self.text.iter().rposition(|byte| !b"\r\n".contains(byte)).map_or(0, |last| last + 1);
            // a byte order mark is none of the first name
            let start = if self.record.line == 1 && self.text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
            if end > start {
                self.record.split(&self.text[start..end], Delimiter::Mark(b','));
                return Ok(true);
            }
        }
    }
}

/// A recording's text, line by line as values.
pub(crate) struct Text {
    path: PathBuf,
    lines: Lines,
    columns: Columns,
    before: Option<(f64, i64)>,
}

impl Text {
    /// That of a source, under the name it came from.
    pub fn new(path: &Path, source: Box<dyn Read>) -> Result<Self, RecordingError> {
        let mut lines = Lines { source: BufReader::new(source), text: Vec::new(), record: Record::default() };
        if !lines.next().map_err(RecordingError::read(path))? {
            return Err(RecordingError::Empty { path: path.to_owned(), what: "nothing in it" });
        }
        let columns = Columns::from_header(path, &lines.record)?;
        Ok(Self { path: path.to_owned(), lines, columns, before: None })
    }

    /// Where the cell of a name is in the first line after the header.
    pub fn first_place(&self, name: &str) -> Place {
        let index = self.columns.names.iter().position(|column| column == name);
        Place { path: self.path.clone(), line: 2, column: index.map(|index| (index + 1, name.to_owned())) }
    }

    /// The names of its columns.
    pub fn header(&self) -> &[String] {
        &self.columns.names
    }

    /// Whether this column is one of a recording's own.
    pub fn takes(&self, column: usize) -> bool {
        self.columns.takes(column)
    }

    pub fn line(&mut self) -> Result<Option<Line>, RecordingError> {
        if !self.lines.next().map_err(RecordingError::read(&self.path))? {
            return Ok(None);
        }
        let line = self.columns.line(&self.path, &self.lines.record, self.before)?;
        self.before = Some((line.row.time_s, line.row.time_ns));
        Ok(Some(line))
    }
}

pub(super) enum Origin {
    Text(Box<Text>),
    Events(Merged),
}

/// The rows of a recording, in order; an error ends them.
pub struct Rows(pub(super) Origin);

impl Rows {
    fn line(&mut self) -> Result<Option<Line>, RecordingError> {
        match &mut self.0 {
            Origin::Text(text) => text.line(),
            Origin::Events(merged) => Ok(merged.next()),
        }
    }

    /// Refuses more events without a magnetometer sample than memory should hold; those of a session are in memory already.
    fn refuse_waiting(&self, waiting: usize) -> Result<(), RecordingError> {
        match &self.0 {
            Origin::Text(text) if waiting == MOST_WAITING => Err(RecordingError::Form {
                place: Place { path: text.path.clone(), line: text.lines.record.line, column: None },
                expected: "a magnetometer sample".to_owned(),
                found: format!("{MOST_WAITING} rows of other sensors before it; cut the part without magnetometer off"),
            }),
            _ => Ok(()),
        }
    }

    /// The next magnetometer sample, with the events of the lines before it that have none.
    fn read(&mut self) -> Result<Option<Row>, RecordingError> {
        let (mut before, mut system_ut) = (Vec::new(), None);
        while let Some(Line { field_ut, row }) = self.line()? {
            system_ut = row.system_ut.or(system_ut);
            if let Some(field_ut) = field_ut {
                return Ok(Some(Row { field_ut, before, system_ut, ..row }));
            }
            if row.rate_rad_s.is_some() || row.up_m_s2.is_some() || row.course.is_some() {
                self.refuse_waiting(before.len())?;
                before.extend(row.inertial());
            }
        }
        Ok(None)
    }
}

impl Iterator for Rows {
    type Item = Result<Row, RecordingError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.read().transpose()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Recording, read_from};
    use magcomp::nalgebra::{UnitQuaternion, Vector3};

    fn recording(text: &str) -> Result<Recording, RecordingError> {
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
