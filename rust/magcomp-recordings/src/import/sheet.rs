//! A text file as a table: delimiter and decimal mark found by looking, cells read with errors that name file, line and column.

use super::dates;
use super::document::Document;
use super::stream::Stream;
use super::units::{Kind, parted, time_unit, written_factor, written_time_ns};
use crate::error::{Place, RecordingError, shorten};
use crate::recording::{Delimiter, Record};
use crate::time::MOST_NS;
use magcomp::nalgebra::Vector3;
use std::borrow::Cow;
use std::path::Path;

/// Lines behind the last row that may be none, at most: what a logger closes a file with.
const MOST_CLOSING: usize = 50;
/// What loggers write where they have no value.
const NOTHING: [&str; 6] = ["null", "none", "nil", "na", "n/a", "-"];

/// A header and where its rows are.
pub(super) struct Sheet<'a> {
    document: &'a Document,
    delimiter: Delimiter,
    /// Names of the columns, without blanks around them; `#1`, `#2` and so on where the file has no header.
    pub header: Vec<String>,
    /// There is a line of names.
    has_header: bool,
}

pub(super) struct Cells<'a> {
    sheet: &'a Sheet<'a>,
    record: Record,
}

impl<'a> Sheet<'a> {
    /// The table of a text file. A tab, else a semicolon, in its first line delimits the cells; a comma is then a decimal mark.
    /// Where there is no comma either, blanks do. A file that begins with numbers has no header.
    pub fn new(document: &'a Document) -> Self {
        let Some((_, line)) = document.lines().next() else {
            return Self { document, delimiter: Delimiter::Mark(b','), header: Vec::new(), has_header: false };
        };
        let delimiter = delimiter(line);
        let header = names(line, delimiter);
        let mut sheet = Self { document, delimiter, header, has_header: true };
        let decimal_commas = sheet.has_decimal_commas();
        let number = |cell: &String| {
            is_number(cell, decimal_commas) || dates::parse_ns(cell).is_some() || is_nothing(cell.as_bytes())
        };
        if sheet.header.len() > 1 && sheet.header.iter().all(number) {
            sheet.has_header = false;
            sheet.header = (1..=sheet.header.len()).map(|column| format!("#{column}")).collect();
        }
        sheet
    }

    /// Lines of several kinds, whose cells have no names.
    pub fn of_lines(document: &'a Document, delimiter: Delimiter) -> Self {
        Self { document, delimiter, header: Vec::new(), has_header: false }
    }

    /// Whether a comma is a decimal mark, because something else is between cells.
    pub fn has_decimal_commas(&self) -> bool {
        self.delimiter != Delimiter::Mark(b',')
    }

    pub fn path(&self) -> &Path {
        &self.document.path
    }

    /// The column of that name, or of that number: `#4` is the fourth.
    pub fn column(&self, name: &str) -> Option<usize> {
        let named = self.header.iter().position(|column| column == name);
        named.or_else(|| numbered(name).filter(|column| *column < self.header.len()))
    }

    pub fn has_header(&self) -> bool {
        self.has_header
    }

    /// The unit of a column in small letters: in its name, else in a row of units below the names.
    pub fn unit(&self, column: usize) -> Option<String> {
        let in_row = || {
            let cells = self.first_row().filter(|cells| self.has_header && self.is_of_units(cells))?;
            Some(cells.text(column).trim_matches(BRACKETS).to_lowercase())
        };
        parted(self.header.get(column)?).1.or_else(in_row)
    }

    /// Nanoseconds in the unit of a column of times, where its name or a row of units tells it.
    pub fn time_unit(&self, column: usize) -> Option<i64> {
        let named = self.header.get(column).and_then(|name| time_unit(name));
        named.or_else(|| written_time_ns(&self.unit(column)?))
    }

    /// Whether the first time of a column is a date.
    pub fn has_dates(&self, column: usize) -> bool {
        self.first_row().is_some_and(|cells| dates::parse_ns(&cells.text(column)).is_some())
    }

    /// The column of that name, which must be there, once.
    pub fn required(&self, name: &str) -> Result<usize, RecordingError> {
        let wrong = |expected: String| RecordingError::Form {
            place: Place { path: self.path().to_owned(), line: self.document.first_line_number(), column: None },
            expected,
            found: self.shown(),
        };
        let mut columns = (0..self.header.len()).filter(|column| self.header[*column] == name);
        match (columns.next(), columns.next()) {
            (Some(column), None) => Ok(column),
            (Some(_), Some(_)) => Err(wrong(format!("column '{name}' once"))),
            (None, _) => self.column(name).ok_or_else(|| {
                wrong(match numbered(name) {
                    Some(column) => format!("at least {} columns", column + 1),
                    None => format!("a header with the column '{name}'"),
                })
            }),
        }
    }

    /// Its header, for an error; numbers are not names, but values that may be private, such as where somebody was.
    pub fn shown(&self) -> String {
        if self.header.is_empty() {
            return "an empty file".to_owned();
        }
        if !self.has_header {
            return format!("{} columns of numbers without a header", self.header.len());
        }
        let mark = match self.delimiter {
            Delimiter::Mark(b'\t') => "<tab>",
            Delimiter::Mark(b';') => ";",
            Delimiter::Mark(_) => ",",
            Delimiter::Blanks => " ",
        };
        let name =
            |cell: &String| if is_number(cell, self.has_decimal_commas()) { "..".to_owned() } else { cell.clone() };
        format!("'{}'", shorten(&self.header.iter().map(name).collect::<Vec<_>>().join(mark)))
    }

    /// Whether a row that follows the header has the units of its columns: no number, and no cell that is empty for want of a value.
    fn is_of_units(&self, cells: &Cells<'_>) -> bool {
        let texts = cells.record.texts();
        let text = |cell: &String| {
            !is_number(cell, self.has_decimal_commas())
                && dates::parse_ns(cell).is_none()
                && !is_nothing(cell.as_bytes())
        };
        texts.iter().all(text) && texts.iter().any(|cell| is_unit(cell))
    }

    /// Reads its rows, after the header and a row of units. A row with more cells than the header is refused: its cells would be taken
    /// for others. A last row that cannot be read, as one of an app that was ended while it wrote, costs itself alone, and so do lines behind
    /// the last row that are none: the sentence about them is returned.
    pub fn rows(
        &'a self,
        mut read: impl FnMut(&Cells<'a>) -> Result<(), RecordingError>,
    ) -> Result<Option<String>, RecordingError> {
        let mut first = true;
        let read = move |cells: &Cells<'a>| {
            if std::mem::take(&mut first) && self.has_header && self.is_of_units(cells) {
                return Ok(());
            }
            let extra = (self.header.len()..cells.record.len()).find(|column| !cells.text(*column).is_empty());
            let Some(column) = extra else { return read(cells) };
            let expected = format!(
                "{} cells as in the header; a decimal comma needs semicolons or tabs between cells",
                self.header.len()
            );
            let found = format!("{} cells", cells.record.len());
            Err(RecordingError::Form { place: cells.place(column), expected, found })
        };
        self.each(usize::from(self.has_header), read)
    }

    /// As [`Self::rows`], of all lines: for a file that has no header and rows of several kinds.
    pub fn lines(
        &'a self,
        read: impl FnMut(&Cells<'a>) -> Result<(), RecordingError>,
    ) -> Result<Option<String>, RecordingError> {
        self.each(0, read)
    }

    /// The cells of the first row after the header.
    pub fn first_row(&'a self) -> Option<Cells<'a>> {
        let (line, text) = self.document.lines().nth(usize::from(self.has_header))?;
        let mut record = Record::default();
        record.line = line;
        record.split(text, self.delimiter);
        Some(Cells { sheet: self, record })
    }

    /// Whether all cells are there and are numbers: such a row was not cut off.
    fn is_whole(&self, cells: &Cells<'_>) -> bool {
        let texts = cells.record.texts();
        texts.len() >= self.header.len() && texts.iter().all(|cell| is_number(cell, self.has_decimal_commas()))
    }

    /// Which cells of a row are numbers or dates.
    fn shape(&self, record: &Record) -> Vec<bool> {
        let is_value = |cell: String| is_number(&cell, self.has_decimal_commas()) || dates::parse_ns(&cell).is_some();
        record.texts().into_iter().map(is_value).collect()
    }

    fn each(
        &'a self,
        skipped: usize,
        mut read: impl FnMut(&Cells<'a>) -> Result<(), RecordingError>,
    ) -> Result<Option<String>, RecordingError> {
        let mut lines = self.document.lines().skip(skipped);
        let mut cells = Cells { sheet: self, record: Record::default() };
        let (mut before, mut usual) = (0, Vec::new());
        while let Some((line, text)) = lines.next() {
            cells.record.line = line;
            cells.record.split(text, self.delimiter);
            let Err(why) = read(&cells) else {
                // a row of units has none
                if !usual.contains(&true) {
                    usual = self.shape(&cells.record);
                }
                before += 1;
                continue;
            };
            let rest: Vec<(u64, &[u8])> = lines.take(MOST_CLOSING).collect();
            let Some((last, _)) = rest.last() else {
                let is_cut = before > 0 && !self.is_whole(&cells);
                let told = format!("the last row was left out, as one of an app that was ended while it wrote: {why}");
                return if is_cut { Ok(Some(told)) } else { Err(why) };
            };
            // no line from here on has the numbers of a row
            let mut record = Record::default();
            let mut is_row = |text: &[u8]| {
                record.split(text, self.delimiter);
                let shape = self.shape(&record);
                shape.len() >= usual.len() && usual.iter().zip(&shape).all(|(usual, is)| *is || !usual)
            };
            let is_closing = !self.header.is_empty()
                && rest.len() < MOST_CLOSING.min(before)
                && !is_row(text)
                && !rest.iter().any(|(_, text)| is_row(text));
            let told = format!("lines {line} to {last} behind the last row are none and were left out: {why}");
            return if is_closing { Ok(Some(told)) } else { Err(why) };
        }
        Ok(None)
    }

    /// The events of a sensor whose axes these columns are; none where all three cells are empty. `time_ns` reads the time from the
    /// column `time`.
    pub fn stream(
        &'a self,
        time: usize,
        axes: [usize; 3],
        time_ns: impl Fn(&Cells<'a>) -> Result<i64, RecordingError>,
    ) -> Result<Stream<Vector3<f64>>, RecordingError> {
        let mut stream = Stream::default();
        let cut = self.rows(|cells| {
            let time_ns = time_ns(cells)?;
            if let Some(value) = cells.vector(axes)? {
                stream.add(time_ns, value, || [cells.place(time), cells.place(axes[0])])?;
            }
            Ok(())
        })?;
        stream.cut = cut;
        Ok(stream)
    }
}

fn delimiter(line: &[u8]) -> Delimiter {
    let mark = [b'\t', b';', b','].into_iter().find(|mark| line.contains(mark));
    let blanks = line.trim_ascii().iter().any(u8::is_ascii_whitespace);
    // numbers with tabs and blanks between them
    let is_number = |cell: &[u8]| str::from_utf8(cell).is_ok_and(|cell| is_number(cell, false));
    let mut numbers = line.split(u8::is_ascii_whitespace).filter(|cell| !cell.is_empty());
    match mark {
        Some(b'\t') if line.trim_ascii().contains(&b' ') && numbers.all(is_number) => Delimiter::Blanks,
        Some(mark) => Delimiter::Mark(mark),
        None if blanks => Delimiter::Blanks,
        None => Delimiter::Mark(b','),
    }
}

/// The cells of a line as names.
pub(super) fn header_of(line: &[u8]) -> Vec<String> {
    names(line, delimiter(line))
}

fn names(line: &[u8], delimiter: Delimiter) -> Vec<String> {
    let mut record = Record::default();
    record.split(line, delimiter);
    record.texts()
}

/// The column that `#4` means, counted from 0.
pub(super) fn numbered(name: &str) -> Option<usize> {
    name.strip_prefix('#')?.parse::<usize>().ok()?.checked_sub(1)
}

fn is_number(text: &str, decimal_commas: bool) -> bool {
    if decimal_commas { text.replace(',', ".").parse::<f64>().is_ok() } else { text.parse::<f64>().is_ok() }
}

fn is_nothing(text: &[u8]) -> bool {
    text.is_empty() || NOTHING.iter().any(|word| text.eq_ignore_ascii_case(word.as_bytes()))
}

/// What may stand around a unit below a name.
const BRACKETS: [char; 4] = ['(', ')', '[', ']'];

/// Whether a cell below a name is a unit of a time or of a sensor.
fn is_unit(text: &str) -> bool {
    let unit = text.trim_matches(BRACKETS).to_lowercase();
    let is_of = |kind| written_factor(kind, &unit).is_some();
    written_time_ns(&unit).is_some() || [Kind::Field, Kind::Up, Kind::Rate].into_iter().any(is_of)
}

/// Whether a cell is a word and no number, no date, and not empty.
pub(super) fn is_word(text: &str) -> bool {
    text.starts_with(char::is_alphabetic) && !is_nothing(text.as_bytes()) && text.parse::<f64>().is_err()
}

impl Cells<'_> {
    /// How many cells the row has.
    pub fn len(&self) -> usize {
        self.record.len()
    }

    pub fn is_number(&self, column: usize) -> bool {
        self.number(column).is_ok()
    }

    /// The text of a cell, without blanks around it; empty where the row ends before.
    pub fn text(&self, column: usize) -> String {
        self.record.get(column).map_or_else(String::new, |cell| String::from_utf8_lossy(cell).trim().to_owned())
    }

    pub fn place(&self, column: usize) -> Place {
        let name = self.sheet.header.get(column).map(|name| shorten(name)).unwrap_or_default();
        Place { path: self.sheet.path().to_owned(), line: self.record.line, column: Some((column + 1, name)) }
    }

    pub fn wrong(&self, column: usize, expected: &str) -> RecordingError {
        let text = self.text(column);
        let found = if text.is_empty() { "an empty cell".to_owned() } else { format!("'{}'", shorten(&text)) };
        RecordingError::Form { place: self.place(column), expected: expected.to_owned(), found }
    }

    /// A cell with a decimal point, whatever mark the file uses; empty where it is no text.
    fn point(&self, column: usize) -> Cow<'_, str> {
        let text = str::from_utf8(self.record.get(column).unwrap_or_default()).unwrap_or_default().trim();
        let is_comma = self.sheet.has_decimal_commas() && text.contains(',');
        if is_comma { text.replace(',', ".").into() } else { text.into() }
    }

    pub fn number(&self, column: usize) -> Result<f64, RecordingError> {
        self.point(column).parse().map_err(|_| self.wrong(column, "a number"))
    }

    /// Whether a cell has no value.
    pub fn is_nothing(&self, column: usize) -> bool {
        is_nothing(self.record.get(column).unwrap_or_default().trim_ascii())
    }

    /// Three numbers; none where all three cells are empty.
    pub fn vector(&self, columns: [usize; 3]) -> Result<Option<Vector3<f64>>, RecordingError> {
        if columns.iter().all(|column| self.is_nothing(*column)) {
            return Ok(None);
        }
        let [x, y, z] = columns;
        Ok(Some(Vector3::new(self.number(x)?, self.number(y)?, self.number(z)?)))
    }

    /// A time in units of so many nanoseconds, exact to the nanosecond where it is written without an exponent; or a date with a time.
    pub fn time_ns(&self, column: usize, unit_ns: i64) -> Result<i64, RecordingError> {
        let text = self.point(column);
        time_ns(&text, unit_ns).or_else(|| dates::parse_ns(&text)).ok_or_else(|| {
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
