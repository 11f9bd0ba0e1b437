//! A report: SVG files in a folder and one HTML page that shows them, with the command that made it.

use crate::error::LabError;
use crate::recording::write_atomically;
use crate::table::Table;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A page in the making.
#[derive(Clone, Debug)]
pub struct Report {
    title: String,
    lead: String,
    body: String,
    /// Headings of the sections so far: the page's contents.
    sections: Vec<String>,
    /// Tables so far.
    tables: usize,
    /// Files beside the page: name and content.
    figures: Vec<(String, String)>,
}

/// Fewest sections of a page that has its contents at the top.
const CONTENTS: usize = 4;
const STYLE: &str = include_str!("report.css");

impl Report {
    /// A page with a title and a first paragraph.
    #[must_use]
    pub fn new(title: &str, lead: &str) -> Self {
        Self {
            title: title.to_owned(),
            lead: lead.to_owned(),
            body: String::new(),
            sections: Vec::new(),
            tables: 0,
            figures: Vec::new(),
        }
    }

    /// Begins a section.
    pub fn section(&mut self, heading: &str, text: &str) {
        self.sections.push(heading.to_owned());
        let (number, heading, text) = (self.sections.len(), escape(heading), escape(text));
        let _ = write!(self.body, "<h2 id=\"section{number}\">{heading}</h2>\n<p>{text}</p>\n");
    }

    /// Adds a paragraph.
    pub fn text(&mut self, text: &str) {
        let _ = writeln!(self.body, "<p>{}</p>", escape(text));
    }

    /// Folds what `add` adds under one line that opens it.
    ///
    /// # Errors
    /// Those of `add`.
    pub fn folded<E>(&mut self, line: &str, add: impl FnOnce(&mut Self) -> Result<(), E>) -> Result<(), E> {
        let _ = writeln!(self.body, "<details><summary>{}</summary>", escape(line));
        let added = add(self);
        self.body.push_str("</details>\n");
        added
    }

    /// Links to the sections, where there are enough of them to lose the way.
    fn contents(&self) -> String {
        if self.sections.len() < CONTENTS {
            return String::new();
        }
        let link =
            |(k, heading): (usize, &String)| format!("<li><a href=\"#section{}\">{}</a></li>", k + 1, escape(heading));
        let links: String = self.sections.iter().enumerate().map(link).collect();
        format!("<nav aria-label=\"Contents\"><ol>{links}</ol></nav>\n")
    }

    /// Adds a table.
    pub fn table(&mut self, table: &Table) {
        self.tables += 1;
        let number = self.tables;
        let cells = |tag: &str, cells: &[String]| -> String {
            cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", escape(cell))).collect()
        };
        let _ = write!(
            self.body,
            "<figure class=\"table\"><p class=\"title\" id=\"table{number}\">{}</p>\n{}\
             <div class=\"{}\"><table aria-labelledby=\"table{number}\">\n<thead><tr>{}</tr></thead>\n<tbody>\n",
            escape(&table.title),
            table.lead.iter().map(|text| format!("<p>{}</p>\n", escape(text))).collect::<String>(),
            setting(table),
            cells("th", &table.columns)
        );
        for row in &table.rows {
            let _ = writeln!(self.body, "<tr>{}</tr>", cells("td", row));
        }
        let notes: String = table.notes.iter().map(|note| format!("<p>{}</p>", escape(note))).collect();
        let _ = writeln!(self.body, "</tbody></table></div><figcaption>{notes}</figcaption></figure>");
    }

    /// Adds a picture, written as `name`.svg beside the page.
    pub fn figure(&mut self, name: &str, svg: String, caption: &str) {
        let caption = escape(caption);
        let _ = writeln!(
            self.body,
            "<figure><a href=\"{name}.svg\"><img src=\"{name}.svg\" alt=\"{caption}\"></a><figcaption>{caption}</figcaption></figure>"
        );
        self.figures.push((format!("{name}.svg"), svg));
    }

    /// Adds a page of its own, written as `name`.html beside this one and shown in it.
    pub fn page(&mut self, name: &str, html: String, title: &str) {
        let title = escape(title);
        let _ = writeln!(
            self.body,
            "<figure><iframe src=\"{name}.html\" title=\"{title}\" loading=\"lazy\"></iframe>\
             <figcaption><a href=\"{name}.html\">{title}</a>, as a page of its own: one file that needs no network.</figcaption></figure>"
        );
        self.figures.push((format!("{name}.html"), html));
    }

    /// Writes the pictures and `index.html` into `folder`, which is made where it is missing. Returns the page's path.
    ///
    /// # Errors
    /// [`LabError::Write`].
    pub fn write(&self, folder: &Path) -> Result<PathBuf, LabError> {
        std::fs::create_dir_all(folder).map_err(LabError::write(folder))?;
        for (name, svg) in &self.figures {
            write_atomically(&folder.join(name), |out| out.write_all(svg.as_bytes()))?;
        }
        let page = folder.join("index.html");
        let (title, lead, command) = (escape(&self.title), escape(&self.lead), escape(&command_line()));
        let html = format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n<p class=\"lead\">{lead}</p>\n\
             {}{}<footer><p>Made by</p><pre><code>{command}</code></pre><p>magcomp {}</p></footer>\n</main>\n</body>\n</html>\n",
            self.contents(),
            self.body,
            env!("CARGO_PKG_VERSION")
        );
        write_atomically(&page, |out| out.write_all(html.as_bytes()))?;
        Ok(page)
    }
}

/// How a table is set: its class. A page of 1200 pixels has room for about 110 characters, a column's padding being worth 2.5.
fn setting(table: &Table) -> &'static str {
    let cell = |column: usize| {
        // headers are broken between words and behind hyphens
        let header = table.columns[column].split_inclusive([' ', '-']).map(|word| word.trim().chars().count());
        let cells = table.rows.iter().filter_map(|row| row.get(column)).map(|cell| cell.chars().count());
        header.chain(cells).max().unwrap_or(0)
    };
    let characters: f64 = (0..table.columns.len()).map(|column| cell(column) as f64 + 2.5).sum();
    match characters {
        ..110.0 => "scroll",
        ..140.0 => "scroll wide",
        _ => "scroll wider",
    }
}

/// The command as it was typed, the program by its name alone.
fn command_line() -> String {
    let arguments = std::env::args().skip(1).map(|argument| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+".contains(c);
        if !argument.is_empty() && argument.chars().all(plain) {
            argument
        } else {
            format!("'{}'", argument.replace('\'', "'\\''"))
        }
    });
    std::iter::once("magcomp".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn page_and_pictures_are_written() {
        let folder = tempfile::tempdir().unwrap();
        let mut report = Report::new("A & B", "lead");
        report.section("Section", "text");
        for k in 2..=CONTENTS {
            assert!(!report.contents().contains("<nav"), "{k}");
            report.section(&format!("Section {k}"), "text");
        }
        report
            .folded("more <of it>", |report| {
                report.text("inside");
                Ok::<(), LabError>(())
            })
            .unwrap();
        report.table(&Table::new("table", &["a", "b"]));
        report.figure("picture", "<svg></svg>".to_owned(), "what it shows");
        let page = report.write(&folder.path().join("deep/er")).unwrap();
        let html = std::fs::read_to_string(&page).unwrap();
        let mut wide = Table::new("wide", &["column"; 12]);
        wide.row(vec!["0.123456".to_owned(); 12]);
        assert_eq!([setting(&Table::new("table", &["a", "b"])), setting(&wide)], ["scroll", "scroll wide"]);
        let folded = "<details><summary>more &lt;of it&gt;</summary>\n<p>inside</p>\n</details>";
        assert!(
            html.contains(folded)
                && html.contains("<a href=\"#section4\">Section 4</a>")
                && html.contains("<h2 id=\"section4\">")
        );
        assert!(html.contains("<h1>A &amp; B</h1>") && html.contains("picture.svg") && html.contains("what it shows"));
        assert_eq!(std::fs::read_to_string(page.with_file_name("picture.svg")).unwrap(), "<svg></svg>");
    }
}
