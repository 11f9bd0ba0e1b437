//! A text file as a table: delimiter and decimal mark found by looking, cells read with errors that name file, line and column.

use super::document::Document;
use super::session::Stream;
use crate::error::{LabError, Place, shorten};
use crate::time::MOST_NS;
use csv::{ByteRecord, ReaderBuilder};
use magcomp::nalgebra::Vector3;
use std::io;
use std::path::Path;

/// A header and where its rows are.
pub(super) struct Sheet<'a> {
    document: &'a Document,
    delimiter: u8,
    /// Names of the columns, without blanks around them.
    pub header: Vec<String>,
}

/// One row.
pub(super) struct Cells<'a> {
    sheet: &'a Sheet<'a>,
    record: ByteRecord,
}

impl<'a> Sheet<'a> {
    /// The table of a text file. A tab, else a semicolon, in its first line delimits the cells; a comma is then a decimal mark.
    pub fn new(document: &'a Document) -> Self {
        let line = document.first_line();
        let delimiter = ['\t', ';'].into_iter().find(|mark| line.contains(*mark)).map_or(b',', |mark| mark as u8);
        let mut sheet = Self { document, delimiter, header: Vec::new() };
        let header = sheet.records(false).next().and_then(Result::ok);
        let names =
            |record: &ByteRecord| record.iter().map(|name| String::from_utf8_lossy(name).trim().to_owned()).collect();
        sheet.header = header.as_ref().map(names).unwrap_or_default();
        sheet
    }

    /// Whether a comma is a decimal mark, because something else is between cells.
    pub fn has_decimal_commas(&self) -> bool {
        self.delimiter != b','
    }

    /// Where it lies.
    pub fn path(&self) -> &Path {
        &self.document.path
    }

    /// The column of that name.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.header.iter().position(|column| column == name)
    }

    /// The column of that name, which must be there, once.
    pub fn required(&self, name: &str) -> Result<usize, LabError> {
        let wrong = |expected: String| LabError::Recording {
            place: Place { path: self.path().to_owned(), line: 1, column: None },
            expected,
            found: self.shown(),
        };
        let mut columns = (0..self.header.len()).filter(|column| self.header[*column] == name);
        match (columns.next(), columns.next()) {
            (Some(column), None) => Ok(column),
            (Some(_), Some(_)) => Err(wrong(format!("column '{name}' once"))),
            (None, _) => Err(wrong(format!("a header with the column '{name}'"))),
        }
    }

    /// Its header, for an error.
    pub fn shown(&self) -> String {
        if self.header.is_empty() {
            "an empty file".to_owned()
        } else {
            format!("'{}'", shorten(&self.header.join(",")))
        }
    }

    fn records(&self, skip_header: bool) -> impl Iterator<Item = Result<ByteRecord, csv::Error>> + use<'a> {
        ReaderBuilder::new()
            .has_headers(skip_header)
            .flexible(true)
            .comment(Some(b'#'))
            .delimiter(self.delimiter)
            .from_reader(self.document.text.as_slice())
            .into_byte_records()
    }

    /// Its rows, after the header. A row with more cells than the header is refused: its cells would be taken for others.
    pub fn rows(&'a self) -> impl Iterator<Item = Result<Cells<'a>, LabError>> {
        self.cells(true).map(|cells| {
            let cells = cells?;
            let extra = (self.header.len()..cells.record.len()).find(|column| !cells.text(*column).is_empty());
            let Some(column) = extra else { return Ok(cells) };
            let expected = format!(
                "{} cells as in the header; a decimal comma needs semicolons or tabs between cells",
                self.header.len()
            );
            let found = format!("{} cells", cells.record.len());
            Err(LabError::Recording { place: cells.place(column), expected, found })
        })
    }

    /// All its rows, for a file that has no header.
    pub fn lines(&'a self) -> impl Iterator<Item = Result<Cells<'a>, LabError>> {
        self.cells(false)
    }

    /// The events of a sensor whose axes these columns are; none where all three cells are empty. `time_ns` reads the time from the
    /// column `time`.
    pub fn stream(
        &'a self,
        time: usize,
        axes: [usize; 3],
        time_ns: impl Fn(&Cells<'a>) -> Result<i64, LabError>,
    ) -> Result<Stream<Vector3<f64>>, LabError> {
        let mut stream = Stream::default();
        for cells in self.rows() {
            let cells = cells?;
            let time_ns = time_ns(&cells)?;
            if let Some(value) = cells.vector(axes)? {
                stream.add(time_ns, value, || [cells.place(time), cells.place(axes[0])])?;
            }
        }
        Ok(stream)
    }

    fn cells(&'a self, skip_header: bool) -> impl Iterator<Item = Result<Cells<'a>, LabError>> {
        self.records(skip_header).map(|record| {
            let unreadable = |error: csv::Error| io::Error::new(io::ErrorKind::InvalidData, error.to_string());
            let record = record.map_err(unreadable).map_err(LabError::read(self.path()))?;
            Ok(Cells { sheet: self, record })
        })
    }
}

impl Cells<'_> {
    /// The text of a cell, without blanks around it; empty where the row ends before.
    pub fn text(&self, column: usize) -> String {
        self.record.get(column).map_or_else(String::new, |cell| String::from_utf8_lossy(cell).trim().to_owned())
    }

    /// Where a cell is.
    pub fn place(&self, column: usize) -> Place {
        let name = self.sheet.header.get(column).map(|name| shorten(name)).unwrap_or_default();
        let line = self.record.position().map_or(0, csv::Position::line);
        Place { path: self.sheet.path().to_owned(), line, column: Some((column + 1, name)) }
    }

    /// An error about a cell.
    pub fn wrong(&self, column: usize, expected: &str) -> LabError {
        let text = self.text(column);
        let found = if text.is_empty() { "an empty cell".to_owned() } else { format!("'{}'", shorten(&text)) };
        LabError::Recording { place: self.place(column), expected: expected.to_owned(), found }
    }

    /// A cell with a decimal point, whatever mark the file uses.
    fn point(&self, column: usize) -> String {
        let text = self.text(column);
        if self.sheet.has_decimal_commas() { text.replace(',', ".") } else { text }
    }

    /// A number.
    pub fn number(&self, column: usize) -> Result<f64, LabError> {
        self.point(column).parse().map_err(|_| self.wrong(column, "a number"))
    }

    /// Three numbers; none where all three cells are empty.
    pub fn vector(&self, columns: [usize; 3]) -> Result<Option<Vector3<f64>>, LabError> {
        if columns.iter().all(|column| self.text(*column).is_empty()) {
            return Ok(None);
        }
        let [x, y, z] = columns;
        Ok(Some(Vector3::new(self.number(x)?, self.number(y)?, self.number(z)?)))
    }

    /// A time in units of so many nanoseconds, exact to the nanosecond where it is written without an exponent.
    pub fn time_ns(&self, column: usize, unit_ns: i64) -> Result<i64, LabError> {
        let text = self.point(column);
        time_ns(&text, unit_ns).ok_or_else(|| {
            self.wrong(column, "a time within 146 years of zero; its unit is named by --units t=s, ms, us or ns")
        })
    }
}

fn time_ns(text: &str, unit_ns: i64) -> Option<i64> {
    let (negative, digits) = text.strip_prefix('-').map_or((false, text), |digits| (true, digits));
    let (whole, fraction) = digits.split_once('.').unwrap_or((digits, ""));
    let plain = |digits: &str| digits.bytes().all(|byte| byte.is_ascii_digit());
    if !whole.is_empty() && plain(whole) && plain(fraction) && fraction.len() <= 18 {
        let unit = i128::from(unit_ns);
        let parts: i128 = if fraction.is_empty() { 0 } else { fraction.parse().ok()? };
        let scale = 10_i128.pow(fraction.len() as u32);
        let whole = whole.parse::<i128>().ok()?.checked_mul(unit)?;
        let size = whole.checked_add((parts * unit + scale / 2) / scale).filter(|size| *size < i128::from(MOST_NS))?;
        return i64::try_from(if negative { -size } else { size }).ok();
    }
    let value = text.parse::<f64>().ok()? * unit_ns as f64;
    (value.abs() < MOST_NS as f64).then(|| value.round() as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn times_are_exact_to_the_nanosecond() {
        let second = 1_000_000_000;
        for (text, unit, expected) in [
            ("1699734109755900401", 1, Some(1_699_734_109_755_900_401)),
            ("1699734109.755900401", second, Some(1_699_734_109_755_900_401)),
            ("-0.5", second, Some(-500_000_000)),
            ("1.2345E-3", second, Some(1_234_500)),
            ("12.0000000006", second, Some(12_000_000_001)),
            ("1e30", second, None),
            ("nan", second, None),
            ("", second, None),
            ("99999999999999999999", 1, None),
            ("9223372036854775807", 1, None),
            ("4611686018427387903", 1, Some((1 << 62) - 1)),
            ("-4.7e9", second, None),
            ("170141183460469231731687303715884.1057279", 1_000_000, None),
        ] {
            assert_eq!(time_ns(text, unit), expected, "{text}");
        }
    }
}
