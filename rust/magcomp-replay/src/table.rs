//! Tables of text: for the terminal, and the same cells for the report.

use std::fmt;

/// Longest line of a note on the terminal, and of one in a markdown page, characters.
const NOTE: usize = 120;
const PAGE: usize = 158;

/// A heading, column names, rows of cells. The first column is aligned left, the others right where they are not texts.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Table {
    /// One line above the table.
    pub title: String,
    /// Paragraphs between title and columns: what the numbers come to. They are wrapped where they are shown.
    pub lead: Vec<String>,
    /// Names of the columns.
    pub columns: Vec<String>,
    /// Rows, each with one cell for every column.
    pub rows: Vec<Vec<String>>,
    /// All columns are texts, aligned left.
    pub left: bool,
    /// Paragraphs below the table: what the numbers mean. They are wrapped where they are shown.
    pub notes: Vec<String>,
}

impl Table {
    /// An empty table.
    pub fn new(title: &str, columns: &[&str]) -> Self {
        Self {
            title: title.to_owned(),
            columns: columns.iter().map(|name| (*name).to_owned()).collect(),
            ..Self::default()
        }
    }

    /// One more row.
    pub fn row(&mut self, cells: Vec<String>) {
        self.rows.push(cells);
    }

    /// The same with blocks of columns below each other where they are wider than so many characters; the first column is in each.
    pub fn within(&self, width: Option<usize>) -> String {
        let widths = self.widths();
        let Some(width) = width.filter(|width| widths.iter().map(|column| column + 2).sum::<usize>() > *width) else {
            return self.to_string();
        };
        let first = widths.first().map_or(0, |first| first + 2);
        let mut blocks: Vec<Vec<usize>> = vec![vec![0]];
        let mut used = first;
        for (column, own) in widths.iter().enumerate().skip(1) {
            if used + own + 2 > width && used > first {
                blocks.push(vec![0]);
                used = first;
            }
            used += own + 2;
            blocks.last_mut().expect("there is one").push(column);
        }
        let last = blocks.len() - 1;
        let part = |(k, columns): (usize, &Vec<usize>)| {
            let chosen =
                |cells: &Vec<String>| columns.iter().filter_map(|column| cells.get(*column).cloned()).collect();
            let part = Self {
                title: if k == 0 { self.title.clone() } else { String::new() },
                lead: if k == 0 { self.lead.clone() } else { Vec::new() },
                columns: chosen(&self.columns),
                rows: self.rows.iter().map(chosen).collect(),
                notes: if k == last { self.notes.clone() } else { Vec::new() },
                ..self.clone()
            };
            part.text(width)
        };
        blocks.iter().enumerate().map(part).collect::<Vec<_>>().concat()
    }

    fn widths(&self) -> Vec<usize> {
        let lines = || std::iter::once(&self.columns).chain(&self.rows);
        let width = |column: usize| {
            lines().filter_map(|cells| cells.get(column)).map(|cell| cell.chars().count()).max().unwrap_or(0)
        };
        (0..self.columns.len()).map(width).collect()
    }

    /// Texts wrapped at so many characters at most.
    fn text(&self, width: usize) -> String {
        let note = NOTE.min(width.saturating_sub(2)).max(20);
        let mut out = format!("{}\n", self.title);
        let wrapped_line = |line: String| format!("  {line}\n");
        out.extend(self.lead.iter().flat_map(|text| wrapped(text, note)).map(wrapped_line));
        let widths = self.widths();
        for (k, cells) in std::iter::once(&self.columns).chain(&self.rows).enumerate() {
            let mut line = String::new();
            for (column, (cell, width)) in cells.iter().zip(&widths).enumerate() {
                let is_left = column == 0 || self.left;
                line.push_str(&if is_left { format!("  {cell:<width$}") } else { format!("  {cell:>width$}") });
            }
            out += &format!("{}\n", line.trim_end());
            if k == 0 {
                out +=
                    &format!("  {}\n", "-".repeat(widths.iter().sum::<usize>() + 2 * widths.len().saturating_sub(1)));
            }
        }
        out.extend(self.notes.iter().flat_map(|text| wrapped(text, note)).map(wrapped_line));
        out
    }

    /// One more paragraph below.
    pub fn note(&mut self, text: &str) {
        self.notes.push(text.to_owned());
    }

    /// As markdown; a cell that begins with * is bold.
    pub fn markdown(&self) -> String {
        let line = |cells: &[String]| {
            let cell = |cell: &String| match cell.strip_prefix('*') {
                Some(best) => format!(" **{best}** |"),
                None => format!(" {cell} |"),
            };
            format!("|{}\n", cells.iter().map(cell).collect::<String>())
        };
        let rule = format!("|{}\n", "---|".repeat(self.columns.len()));
        let rows: String = self.rows.iter().map(|row| line(row)).collect();
        let page = |text: &String| wrapped(text, PAGE).join("\n");
        let lead: String = self.lead.iter().map(|text| format!("{}\n\n", page(text))).collect();
        let notes: String = self.notes.iter().map(|note| format!("{}\n", page(note))).collect();
        format!("{}\n\n{lead}{}{rule}{rows}\n{notes}", self.title, line(&self.columns))
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.text(NOTE + 2))
    }
}

/// A text in lines of at most `width` characters, broken between words.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.last_mut().expect("there is a line");
        if !last.is_empty() && last.chars().count() + 1 + word.chars().count() > width {
            lines.push(word.to_owned());
        } else {
            *last += if last.is_empty() { "" } else { " " };
            *last += word;
        }
    }
    lines
}

/// A number with `digits` after the point; a dash where there is none.
pub fn number(value: Option<f64>, digits: usize) -> String {
    value.filter(|v| v.is_finite()).map_or_else(|| "-".to_owned(), |v| format!("{v:.digits$}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn columns_line_up() {
        let mut table = Table::new("Title", &["name", "uT"]);
        table.row(vec!["a".into(), number(Some(1.25), 1)]);
        table.row(vec!["long name".into(), number(None, 1)]);
        table.note("what it means");
        let expected =
            "Title\n  name        uT\n  --------------\n  a          1.2\n  long name    -\n  what it means\n";
        assert_eq!(table.to_string(), expected);
        let words = "word ".repeat(50);
        let lines = wrapped(&words, NOTE);
        assert!(lines.len() == 3 && lines.iter().all(|line| line.len() <= NOTE), "{lines:?}");
        assert_eq!(lines.join(" "), words.trim());
        table.row(vec!["best".into(), "*0.5".into()]);
        table.lead.push("what it comes to".to_owned());
        assert!(table.to_string().starts_with("Title\n  what it comes to\n  name"), "{table}");
        // blocks of columns, the first in each
        table.columns.push("more".to_owned());
        table.rows.iter_mut().for_each(|row| row.push("x".to_owned()));
        let narrow = table.within(Some(20));
        assert!(
            narrow.lines().all(|line| line.chars().count() <= 20) && narrow.matches("long name").count() == 2,
            "{narrow}"
        );
        assert_eq!(table.within(Some(200)), table.to_string());
        table.columns.pop();
        table.rows.iter_mut().for_each(|row| drop(row.pop()));
        let expected = "Title\n\nwhat it comes to\n\n| name | uT |\n|---|---|\n| a | 1.2 |\n| long name | - |\n| best | **0.5** |\n\nwhat it means\n";
        assert_eq!(table.markdown(), expected);
    }
}
