//! A line of text as cells. A quotation mark never reaches beyond its line: one that nothing closes there is data.

/// What is between cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Delimiter {
    /// One of this character.
    Mark(u8),
    /// Any number of blanks and tabs.
    Blanks,
}

/// The cells of a line, and which line it is.
#[derive(Clone, Debug, Default)]
pub(crate) struct Record {
    bytes: Vec<u8>,
    ends: Vec<usize>,
    /// Line of the file, counted from 1.
    pub line: u64,
}

impl Record {
    pub fn len(&self) -> usize {
        self.ends.len()
    }

    /// A cell; none where the line ends before.
    pub fn get(&self, column: usize) -> Option<&[u8]> {
        let end = *self.ends.get(column)?;
        let start = column.checked_sub(1).map_or(0, |before| self.ends[before]);
        Some(&self.bytes[start..end])
    }

    /// Its cells as text, without blanks around them.
    pub fn texts(&self) -> Vec<String> {
        (0..self.len())
            .map(|column| String::from_utf8_lossy(self.get(column).unwrap_or_default()).trim().to_owned())
            .collect()
    }

    /// Takes the cells of another line, which has no line end.
    pub fn split(&mut self, line: &[u8], delimiter: Delimiter) {
        self.bytes.clear();
        self.ends.clear();
        match delimiter {
            Delimiter::Mark(mark) => self.split_at(line, mark),
            Delimiter::Blanks => {
                for cell in line.split(u8::is_ascii_whitespace).filter(|cell| !cell.is_empty()) {
                    self.bytes.extend_from_slice(cell);
                    self.ends.push(self.bytes.len());
                }
            }
        }
    }

    fn split_at(&mut self, line: &[u8], mark: u8) {
        let mut rest = line;
        loop {
            if let Some((cell, after)) = quoted(rest, mark) {
                self.bytes.extend(cell);
                self.ends.push(self.bytes.len());
                match after {
                    Some(after) => rest = after,
                    None => return,
                }
                continue;
            }
            let end = rest.iter().position(|byte| *byte == mark);
            self.bytes.extend_from_slice(&rest[..end.unwrap_or(rest.len())]);
            self.ends.push(self.bytes.len());
            match end {
                Some(end) => rest = &rest[end + 1..],
                None => return,
            }
        }
    }
}

/// A cell within quotation marks, in which a mark is written twice, and what follows the delimiter behind it; none where the cell is not
/// closed on its line.
fn quoted(line: &[u8], mark: u8) -> Option<(Vec<u8>, Option<&[u8]>)> {
    let mut rest = line.trim_ascii_start().strip_prefix(b"\"")?;
    let mut cell = Vec::new();
    loop {
        let end = rest.iter().position(|byte| *byte == b'"')?;
        cell.extend_from_slice(&rest[..end]);
        rest = &rest[end + 1..];
        if let Some(more) = rest.strip_prefix(b"\"") {
            cell.push(b'"');
            rest = more;
            continue;
        }
        let blank = |byte: &&u8| **byte != mark && byte.is_ascii_whitespace();
        let behind = &rest[rest.iter().take_while(blank).count()..];
        return match behind {
            [] => Some((cell, None)),
            [first, after @ ..] => (*first == mark).then_some((cell, Some(after))),
        };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cells(line: &str, delimiter: Delimiter) -> Vec<String> {
        let mut record = Record::default();
        record.split(line.as_bytes(), delimiter);
        record.texts()
    }

    #[test]
    fn quotation_marks_that_are_closed_hold_a_cell_and_others_are_data() {
        let comma = Delimiter::Mark(b',');
        for (line, expected) in [
            ("1,2,,3", &["1", "2", "", "3"][..]),
            ("1,\"a, \"\"b\"\"\" ,3", &["1", "a, \"b\"", "3"]),
            ("1,\"broken", &["1", "\"broken"]),
            ("1,\"broken,3", &["1", "\"broken", "3"]),
            ("1,closed\",3", &["1", "closed\"", "3"]),
            ("1,\"a\"b,3", &["1", "\"a\"b", "3"]),
            ("\"\",", &["", ""]),
        ] {
            assert_eq!(cells(line, comma), expected, "{line}");
        }
        assert_eq!(cells("  1.5\t 2  -3 ", Delimiter::Blanks), ["1.5", "2", "-3"]);
        assert_eq!(cells("a\t\tb", Delimiter::Mark(b'\t')), ["a", "", "b"]);
    }
}
