//! A report: SVG files in a folder and one HTML page that shows them, with the command that made it; or one page with all in it.

use crate::atomic::write_atomically;
use crate::error::RunError;
use crate::table::Table;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};

/// A page in the making.
#[derive(Clone, Debug)]
pub struct Report {
    title: String,
    lead: String,
    body: Vec<Part>,
    /// Headings of the sections so far: the page's contents.
    sections: Vec<String>,
    /// Tables so far.
    tables: usize,
}

/// The time axis of a picture: where it begins and ends, as shares of the width; from 0 to `until_s`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Time {
    /// Begin and end.
    pub axis: (f64, f64),
    /// Time at its end, s.
    pub until_s: f64,
}

/// What a reader at the cursor is told: time, s; heading and its two sigmas, degrees; its error, degrees, where there is a reference; status.
pub type Moment = (f64, Option<f64>, Option<f64>, Option<f64>, &'static str);

#[derive(Clone, Debug)]
enum Part {
    Html(String),
    Picture { name: String, svg: String, caption: String, time: Option<Time> },
    Page { name: String, html: String, title: String },
}

impl Part {
    /// The name of the file beside the page, and its content.
    fn file(&self) -> Option<(String, &str)> {
        match self {
            Self::Html(_) => None,
            Self::Picture { name, svg, .. } => Some((format!("{name}.svg"), svg)),
            Self::Page { name, html, .. } => Some((format!("{name}.html"), html)),
        }
    }

    /// As HTML that shows the files beside it.
    fn with_files(&self) -> String {
        match self {
            Self::Html(html) => html.clone(),
            Self::Picture { name, caption, time, .. } => {
                let image = format!("<a href=\"{name}.svg\"><img src=\"{name}.svg\" alt=\"{caption}\"></a>");
                format!("<figure>{}<figcaption>{caption}</figcaption></figure>\n", with_cursor(image, *time))
            }
            Self::Page { name, title, .. } => format!(
                "<figure><iframe src=\"{name}.html\" title=\"{title}\" loading=\"lazy\"></iframe>\
                 <figcaption><a href=\"{name}.html\">{title}</a>, as a page of its own: one file that needs no network.</figcaption></figure>\n"
            ),
        }
    }

    /// As HTML that has all in it.
    fn alone(&self) -> String {
        match self {
            Self::Html(html) => html.clone(),
            Self::Picture { svg, caption, time, .. } => {
                let svg = svg.chars().fold(String::with_capacity(svg.len()), |mut out, c| {
                    match c {
                        '%' | '#' | '"' | '&' | '\n' | '\t' => _ = write!(out, "%{:02X}", c as u32),
                        c => out.push(c),
                    }
                    out
                });
                let image = format!("<img src=\"data:image/svg+xml,{svg}\" alt=\"{caption}\">");
                format!("<figure>{}<figcaption>{caption}</figcaption></figure>\n", with_cursor(image, *time))
            }
            Self::Page { html, title, .. } => format!(
                "<figure><iframe srcdoc=\"{}\" title=\"{title}\"></iframe><figcaption>{title}.</figcaption></figure>\n",
                escape(html)
            ),
        }
    }
}

/// An image with the cursor that all pictures over time share.
fn with_cursor(image: String, time: Option<Time>) -> String {
    let Some(Time { axis: (from, to), until_s }) = time else { return image };
    format!(
        "<div class=\"time\" tabindex=\"0\" role=\"group\" aria-label=\"over time; arrow keys move the moment that is told\" data-from=\"{from:.5}\" data-to=\"{to:.5}\" data-until=\"{until_s:.3}\">{image}<i hidden></i><output hidden></output></div>"
    )
}

/// Fewest sections of a page that has its contents at the top.
const CONTENTS: usize = 4;
const STYLE: &str = include_str!("report.css");
const CURSOR: &str = include_str!("report.js");

impl Report {
    /// A page with a title and a first paragraph.
    pub fn new(title: &str, lead: &str) -> Self {
        Self { title: title.to_owned(), lead: lead.to_owned(), body: Vec::new(), sections: Vec::new(), tables: 0 }
    }

    /// The same with what `add` adds.
    pub fn with(mut self, add: impl FnOnce(&mut Self) -> Result<(), RunError>) -> Result<Self, RunError> {
        add(&mut self)?;
        Ok(self)
    }

    /// Begins a section.
    pub fn section(&mut self, heading: &str, text: &str) {
        self.sections.push(heading.to_owned());
        let (number, heading, text) = (self.sections.len(), escape(heading), escape(text));
        self.html(format!("<h2 id=\"section{number}\">{heading}</h2>\n<p>{text}</p>\n"));
    }

    /// Adds a card: a word, why, and what to do next.
    pub fn card(&mut self, word: &str, why: &[String], next: &[String]) {
        let list = |texts: &[String]| texts.iter().map(|text| format!("<li>{}</li>", shown(text))).collect::<String>();
        let why = if why.is_empty() { String::new() } else { format!("<ul>{}</ul>", list(why)) };
        let next = if next.is_empty() { String::new() } else { format!("<p>Next:</p><ul>{}</ul>", list(next)) };
        let word = escape(word);
        self.html(format!("<section class=\"card {word}\" aria-label=\"Verdict\"><p class=\"verdict\">{word}</p>{why}{next}</section>\n"));
    }

    /// Adds links to pages, each with a text.
    pub fn links(&mut self, links: &[(String, String)]) {
        let link = |(to, text): &(String, String)| format!("<li><a href=\"{}\">{}</a></li>", escape(to), escape(text));
        self.html(format!("<ul>{}</ul>\n", links.iter().map(link).collect::<String>()));
    }

    /// Adds a paragraph.
    pub fn text(&mut self, text: &str) {
        self.html(format!("<p>{}</p>\n", shown(text)));
    }

    /// Folds what `add` adds under one line that opens it.
    pub fn folded<E>(&mut self, line: &str, add: impl FnOnce(&mut Self) -> Result<(), E>) -> Result<(), E> {
        self.html(format!("<details><summary>{}</summary>\n", escape(line)));
        let added = add(self);
        self.html("</details>\n".to_owned());
        added
    }

    fn html(&mut self, html: String) {
        self.body.push(Part::Html(html));
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
            cells.iter().map(|cell| format!("<{tag}>{}</{tag}>", shown(cell))).collect()
        };
        let mut html = format!(
            "<figure class=\"table\"><p class=\"title\" id=\"table{number}\">{}</p>\n{}\
             <div class=\"{}\"><table aria-labelledby=\"table{number}\">\n<thead><tr>{}</tr></thead>\n<tbody>\n",
            escape(&table.title),
            table.lead.iter().map(|text| format!("<p>{}</p>\n", shown(text))).collect::<String>(),
            setting(table),
            cells("th", &table.columns)
        );
        for row in &table.rows {
            let _ = writeln!(html, "<tr>{}</tr>", cells("td", row));
        }
        let notes: String = table.notes.iter().map(|note| format!("<p>{}</p>", shown(note))).collect();
        let _ = writeln!(html, "</tbody></table></div><figcaption>{notes}</figcaption></figure>");
        self.html(html);
    }

    /// Adds a picture, written as `name`.svg beside the page.
    pub fn figure(&mut self, name: &str, svg: String, caption: &str) {
        self.body.push(Part::Picture { name: name.to_owned(), svg, caption: escape(caption), time: None });
    }

    /// Adds a picture whose panels lie below each other over one time axis; a cursor shows the same moment in all of them.
    pub fn figure_over_time(&mut self, name: &str, svg: String, caption: &str, time: Time) {
        self.body.push(Part::Picture { name: name.to_owned(), svg, caption: escape(caption), time: Some(time) });
    }

    /// What the cursor of the pictures over time tells: of one replay on a page.
    pub fn moments(&mut self, moments: &[Moment]) {
        let cell = |value: Option<f64>| value.map_or_else(|| "null".to_owned(), |value| format!("{value:.1}"));
        let moment = |(s, heading, two_sigma, error, status): &Moment| {
            format!("[{s:.2},{},{},{},\"{status}\"]", cell(*heading), cell(*two_sigma), cell(*error))
        };
        let moments = moments.iter().map(moment).collect::<Vec<_>>().join(",\n");
        self.html(format!("<script type=\"application/json\" class=\"moments\">[{moments}]</script>\n"));
    }

    /// Adds a page of its own, written as `name`.html beside this one and shown in it.
    pub fn page(&mut self, name: &str, html: String, title: &str) {
        self.body.push(Part::Page { name: name.to_owned(), html, title: escape(title) });
    }

    /// Writes the pictures and `index.html` into `folder`, which is made where it is missing. Returns the page's path.
    pub fn write(&self, folder: &Path) -> Result<PathBuf, RunError> {
        std::fs::create_dir_all(folder).map_err(RunError::write(folder))?;
        for (name, content) in self.body.iter().filter_map(Part::file) {
            write_atomically(&folder.join(name), |out| out.write_all(content.as_bytes()))?;
        }
        let page = folder.join("index.html");
        let html = self.whole(Part::with_files, &command_line());
        write_atomically(&page, |out| out.write_all(html.as_bytes()))?;
        Ok(page)
    }

    /// One page that needs no other file; `command` is what makes it.
    pub fn alone(&self, command: &str) -> String {
        self.whole(Part::alone, command)
    }

    fn whole(&self, shown: fn(&Part) -> String, command: &str) -> String {
        let (title, lead, command) = (escape(&self.title), escape(&self.lead), escape(command));
        let (contents, body) = (self.contents(), self.body.iter().map(shown).collect::<String>());
        let is_over_time = self.body.iter().any(|part| matches!(part, Part::Picture { time: Some(_), .. }));
        let script = if is_over_time { format!("<script>{CURSOR}</script>\n") } else { String::new() };
        format!(
            "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{title}</title>\n\
             <style>\n{STYLE}</style>\n</head>\n<body>\n<main>\n<h1>{title}</h1>\n<p class=\"lead\">{lead}</p>\n\
             {contents}{body}<footer><p>Made by</p><pre><code>{command}</code></pre><p>magcomp {}</p></footer>\n</main>\n{script}</body>\n</html>\n",
            env!("CARGO_PKG_VERSION")
        )
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

/// The command as it was typed, program, files and folders by their names alone: who shares a report shares no paths.
fn command_line() -> String {
    quoted(std::env::args().skip(1).map(|argument| without_folders(&argument)))
}

/// A path's last part; `--option=PATH` keeps the option.
fn without_folders(argument: &str) -> String {
    let (option, value) = match argument.split_once('=') {
        Some((option, value)) if option.starts_with('-') => (format!("{option}="), value),
        _ => (String::new(), argument),
    };
    let path = Path::new(value);
    let is_path =
        path.is_absolute() || path.parent().is_some_and(|folder| !folder.as_os_str().is_empty() && folder.exists());
    match path.file_name().filter(|_| is_path) {
        Some(name) => format!("{option}{}", name.to_string_lossy()),
        None => argument.to_owned(),
    }
}

/// The command with these arguments, as one types it into a shell.
pub fn quoted(arguments: impl Iterator<Item = String>) -> String {
    let arguments = arguments.map(|argument| {
        let plain = |c: char| c.is_ascii_alphanumeric() || "-_./,:=+".contains(c);
        if !argument.is_empty() && argument.chars().all(plain) {
            argument
        } else {
            format!("'{}'", argument.replace('\'', "'\\''"))
        }
    });
    std::iter::once("magcomp".to_owned()).chain(arguments).collect::<Vec<_>>().join(" ")
}

/// A text as the page shows it: without folders, as the command.
fn shown(text: &str) -> String {
    escape(&without_paths(text))
}

/// A text whose absolute paths are cut to their last part.
fn without_paths(text: &str) -> String {
    let cut = |word: &str| {
        let bare = word.trim_matches(|c: char| "'\"()[],;:".contains(c));
        let is_path = (bare.starts_with('/') || Path::new(bare).is_absolute()) && bare.matches(['/', '\\']).count() > 1;
        match Path::new(bare).file_name().filter(|_| is_path) {
            Some(name) => word.replace(bare, &name.to_string_lossy()),
            None => word.to_owned(),
        }
    };
    text.split(' ').map(cut).collect::<Vec<_>>().join(" ")
}

fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::contrast;
    use plotters::style::RGBColor;

    #[test]
    fn the_command_of_a_page_names_no_folder() {
        let told =
            ["/folder/a.csv", "src/report.rs", "--report=/folder/x", "m=uT,a=m/s^2", "--place=-33.9,18.4", "a.csv"];
        let shown = told.map(without_folders);
        assert_eq!(shown, ["a.csv", "report.rs", "--report=x", "m=uT,a=m/s^2", "--place=-33.9,18.4", "a.csv"]);
    }

    /// What a style sheet says of `name`, light and dark.
    fn colours(sheet: &str, name: &str) -> [RGBColor; 2] {
        let told = format!("--{name}: #");
        let found = sheet.split(&told).skip(1).map(|rest| {
            let part = |k: usize| u8::from_str_radix(&rest[k..k + 2], 16).unwrap();
            RGBColor(part(0), part(2), part(4))
        });
        found.collect::<Vec<_>>().try_into().unwrap_or_else(|_| panic!("--{name} is not told twice"))
    }

    /// Text stands out 4.5 to 1 from what it stands on, marks 3 to 1 (WCAG 2.2, 1.4.3 and 1.4.11), light and dark; so on the sphere's page.
    #[test]
    fn text_and_marks_stand_out() {
        let pairs = |sheet: &str, marks: &[&str], least: f64, grounds: &[&str]| {
            for name in marks {
                for ground in grounds {
                    for (one, other) in colours(sheet, name).into_iter().zip(colours(sheet, ground)) {
                        let contrast = contrast(one, other);
                        assert!(contrast >= least, "{name} on {ground}: {contrast:.2}");
                    }
                }
            }
        };
        pairs(STYLE, &["ink", "soft", "accent"], 4.5, &["paper", "card"]);
        // a button is the accent with the card's colour on it
        pairs(STYLE, &["card"], 4.5, &["accent"]);
        pairs(STYLE, &["good", "doubtful", "bad"], 3.0, &["paper", "card"]);
        pairs(include_str!("draw/sphere.html"), &["ink", "soft"], 4.5, &["paper"]);
        pairs(include_str!("draw/sphere.html"), &["fixed"], 3.0, &["paper"]);
    }

    #[test]
    fn a_text_names_no_folder() {
        let told = "/Users/ann/a.csv: 3 rows left out (see '/x/y/b.csv'), 9.8 m/s^2, 2 /h, a/b, https://x.org/y/z";
        let cut = "a.csv: 3 rows left out (see 'b.csv'), 9.8 m/s^2, 2 /h, a/b, https://x.org/y/z";
        assert_eq!(without_paths(told), cut);
        let mut report = Report::new("a", "b");
        report.card("good", &[told.to_owned()], &[]);
        report.text(told);
        let mut table = Table::new("table", &["a", "b"]);
        table.row(vec![told.to_owned(), String::new()]);
        table.note(told);
        report.table(&table);
        let page = report.alone("");
        assert!(!page.contains("/Users/ann") && page.matches("a.csv: 3 rows").count() == 4, "{page}");
    }

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
                Ok::<(), RunError>(())
            })
            .unwrap();
        report.table(&Table::new("table", &["a", "b"]));
        report.figure("picture", "<svg a=\"#1%\">\n&amp;</svg>".to_owned(), "what it shows");
        assert!(!report.alone("").contains("<script>"));
        report
            .moments(&[(0.0, None, None, None, "collecting"), (1.5, Some(359.96), Some(4.0), Some(-0.1), "tracking")]);
        let told = "<script type=\"application/json\" class=\"moments\">[[0.00,null,null,null,\"collecting\"],\n[1.50,360.0,4.0,-0.1,\"tracking\"]]</script>";
        assert!(report.alone("").contains(told));
        let time = Time { axis: (0.1, 0.97), until_s: 60.0 };
        report.figure_over_time("course", "<svg></svg>".to_owned(), "over time", time);
        report.page("turned", "<p class=\"a\">&amp;</p>".to_owned(), "turn it");
        let alone = report.alone("magcomp <1>");
        assert!(alone.contains("data:image/svg+xml,<svg a=%22%231%25%22>%0A%26amp;</svg>\""), "{alone}");
        assert!(
            alone.contains("srcdoc=\"&lt;p class=&quot;a&quot;&gt;&amp;amp;&lt;/p&gt;\"")
                && alone.contains("magcomp &lt;1&gt;")
        );
        assert!(
            alone.contains("data-from=\"0.10000\" data-to=\"0.97000\" data-until=\"60.000\"") && alone.contains(CURSOR)
        );
        assert!(!alone.contains("picture.svg") && !alone.contains("turned.html"));
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
        assert_eq!(
            std::fs::read_to_string(page.with_file_name("picture.svg")).unwrap(),
            "<svg a=\"#1%\">\n&amp;</svg>"
        );
        assert!(html.contains("src=\"turned.html\"") && page.with_file_name("turned.html").exists());
    }
}
