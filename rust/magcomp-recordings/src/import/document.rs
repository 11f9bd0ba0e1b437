//! The text files of a session: named files, those of a folder, those of a zip.

use super::columnar::as_csv;
use super::forms::is_columnar;
use super::guard::guarded;
use super::input::{Budget, Input, ZIP};
use crate::error::RecordingError;
use crate::recording::{GZIP, files_of, name_of};
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io;
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};

/// Bytes of a file in which a zero means that it is no text.
const START: usize = 1024;
/// Endings of names that are read from folders and zips; other files there (pictures, sound, databases) are passed over.
const TEXT: [&str; 6] = [".csv", ".txt", ".csv.gz", ".parquet", ".arrow", ".feather"];

/// About a bag of ROS 2 that is a database.
const SQLITE: &str = "a bag in SQLite is not read; `ros2 bag convert` makes an mcap file of it";

const ROS1: &[u8] = b"#ROSBAG";
const ROS1_WAY: &str = "a bag of ROS 1 is not read; `rosbags-convert --src IN.bag --dst OUT --dst-storage mcap` (pip install rosbags) makes one of ROS 2 of it";
const JSON_WAY: &str = "JSON is not read; export the session as CSV (Sensor Logger: zipped CSV)";

/// Files of a session, at most.
const MOST_FILES: usize = 2000;
/// Lines before a table, at most, and their length, bytes.
const MOST_TITLES: usize = 50;
const LONGEST_TITLE: usize = 10_000;

/// One text file, unzipped.
#[derive(Clone, Debug)]
pub(super) struct Document {
    /// Where it lies; of one in a zip, the zip's path and the name in it.
    pub path: PathBuf,
    /// Its content, without a byte order mark and the lines before its table.
    pub text: Vec<u8>,
    pub lines_before: u64,
    /// Its packed form is cut off.
    pub is_cut: bool,
}

impl Document {
    fn new(path: PathBuf, bytes: Vec<u8>, budget: &mut Budget) -> Result<Self, RecordingError> {
        let (mut text, mut is_cut) = (bytes, false);
        if text.starts_with(&GZIP) {
            let packed_bytes = text.len() as u64;
            let plain = budget.unpack_cut(MultiGzDecoder::new(text.as_slice()), packed_bytes);
            (text, is_cut) = plain.map_err(RecordingError::read(&path))?;
        }
        if is_columnar(&text) {
            let csv = as_csv(&path, text)?;
            return Ok(Self::of_text(PathBuf::from(format!("{} as CSV", path.display())), csv));
        }
        if text.starts_with(b"\xef\xbb\xbf") {
            text.drain(..3);
        }
        if let Some(why) = not_table(&text) {
            return Err(RecordingError::NoSession(format!("{}: {why}", path.display())));
        }
        if text.iter().take(START).any(|byte| *byte == 0) {
            return Err(RecordingError::NoSession(format!("{}: {}", path.display(), not_text(&text))));
        }
        Ok(Self { is_cut, ..Self::of_text(path, text) })
    }

    pub fn of_text(path: PathBuf, text: Vec<u8>) -> Self {
        Self { path, text, lines_before: 0, is_cut: false }
    }

    pub fn skip_lines(&mut self, lines: u64) {
        let mark = self.line_end();
        let (mut at, mut skipped) = (0, 0);
        while skipped < lines && at < self.text.len() {
            at += self.text[at..].iter().position(|byte| *byte == mark).map_or(self.text.len() - at, |end| end + 1);
            skipped += 1;
        }
        self.text.drain(..at);
        self.lines_before += skipped;
    }

    /// Without the lines before the first one of its beginning that `is_header`.
    pub fn begin_at(&mut self, is_header: impl Fn(&[u8]) -> bool) {
        let title = |line: &[u8]| line.len() <= LONGEST_TITLE;
        let found =
            self.lines().take(MOST_TITLES).take_while(|(_, line)| title(line)).find(|(_, line)| is_header(line));
        if let Some(line) = found.map(|(line, _)| line) {
            self.skip_lines(line - 1 - self.lines_before);
        }
    }

    /// What ends its lines: a line feed, or the carriage return of old computers.
    fn line_end(&self) -> u8 {
        if self.text.contains(&b'\n') { b'\n' } else { b'\r' }
    }

    /// Its lines that are no comment and not empty, each with its number in the file, counted from 1.
    pub fn lines(&self) -> impl Iterator<Item = (u64, &[u8])> {
        let mark = self.line_end();
        let lines = (self.lines_before + 1..).zip(self.text.split(move |byte| *byte == mark));
        let trimmed = lines.map(|(number, line)| (number, line.strip_suffix(b"\r").unwrap_or(line)));
        trimmed.filter(|(_, line)| !line.starts_with(b"#") && !line.starts_with(b"%") && !line.trim_ascii().is_empty())
    }

    /// Its name without folder and endings, in small letters: `magnetometer`.
    pub fn stem(&self) -> String {
        let name = name_of(&self.path).to_lowercase();
        name.split('.').next().unwrap_or_default().to_owned()
    }

    /// Whether some row of the first few hundred kilobytes begins with one of these names and then this mark.
    pub fn has_row_of(&self, kinds: &[&str], mark: u8) -> bool {
        let start = &self.text[..self.text.len().min(300_000)];
        let is_of = |line: &[u8]| {
            kinds.iter().any(|kind| line.strip_prefix(kind.as_bytes()).is_some_and(|rest| rest.first() == Some(&mark)))
        };
        start.split(|byte| *byte == b'\n').any(is_of)
    }

    /// The number of its first line that is no comment and not empty.
    pub fn first_line_number(&self) -> u64 {
        self.lines().next().map_or(1, |(number, _)| number)
    }
}

/// What the user can do with a text, or what begins as one, that is no table.
fn not_table(bytes: &[u8]) -> Option<&'static str> {
    let text = bytes.trim_ascii_start();
    if bytes.starts_with(ROS1) {
        Some(ROS1_WAY)
    } else if text.starts_with(b"{") || text.starts_with(b"[{") || text.starts_with(b"[[") {
        Some(JSON_WAY)
    } else if text.starts_with(b"<?xml") || text.starts_with(b"<!DOCTYPE") || text.starts_with(b"<html") {
        Some("XML and HTML are not read; export the recording as CSV")
    } else {
        None
    }
}

/// Names the form of a file that is no text, by its first bytes, and says what the user can do.
fn not_text(bytes: &[u8]) -> &'static str {
    if bytes.starts_with(b"MATLAB") {
        "a MATLAB file is not read; in MATLAB, writetimetable(MagneticField, \"MagneticField.csv\") makes a CSV of each sensor"
    } else if bytes.starts_with(b"FEA1") {
        "Feather of version 1 is not read; make version 2 of it: in Python, pandas.read_feather(IN).to_feather(OUT)"
    } else if bytes.starts_with(b"SQLite format 3") {
        SQLITE
    } else if bytes.starts_with(b"\x89HDF") {
        "an HDF5 file is not read; write its tables as CSV, one for each sensor"
    } else if bytes.starts_with(b"ULog") {
        "a log of PX4 is not read; `ulog2csv FILE` makes a CSV of each topic"
    } else if bytes.starts_with(b"\xff\xfe") || bytes.starts_with(b"\xfe\xff") {
        "UTF-16 text is not read; save it as UTF-8"
    } else {
        "this is no text file; a session is CSV, a folder of CSV files, or a zip of them"
    }
}

/// The text files of a session, and why others could not be read.
#[derive(Default)]
pub(super) struct Documents {
    pub read: Vec<Document>,
    pub unreadable: Vec<RecordingError>,
}

impl Documents {
    fn add(&mut self, document: Result<Document, RecordingError>) {
        match document {
            Ok(document) => self.read.push(document),
            Err(why) => self.unreadable.push(why),
        }
    }
}

/// All text files that `inputs` name.
pub(super) fn documents(inputs: &[Input]) -> Result<Documents, RecordingError> {
    let (mut found, mut budget) = (Documents::default(), Budget::default());
    for input in inputs {
        if input.is_dir {
            let (texts, others): (Vec<PathBuf>, Vec<PathBuf>) =
                files_of(&input.path)?.into_iter().partition(|path| is_text(path));
            require_few(&input.path, texts.len())?;
            let zips: Vec<PathBuf> = others.into_iter().filter(|path| texts.is_empty() && is_zip(path)).collect();
            if let [first, second, ..] = zips.as_slice() {
                return Err(RecordingError::several(first, second));
            }
            for path in texts.into_iter().chain(zips) {
                let bytes = File::open(&path).and_then(|file| budget.read(file)).map_err(RecordingError::read(&path));
                add(&mut found, &mut budget, path, bytes)?;
            }
            continue;
        }
        let bytes = input.open().and_then(|content| budget.read(content).map_err(RecordingError::read(&input.path)));
        if let Some(why) = add(&mut found, &mut budget, input.path.clone(), bytes)? {
            return Err(why);
        }
    }
    if found.read.is_empty() {
        if let Some(why) = found.unreadable.pop() {
            return Err(why);
        }
        return Err(nothing_in(inputs));
    }
    Ok(found)
}

/// Why there is no file to read: the first thing in a folder that people may have meant, and what to do with it.
fn nothing_in(inputs: &[Input]) -> RecordingError {
    let ends = |path: &Path, endings: &[&str]| {
        let name = name_of(path).to_lowercase();
        endings.iter().any(|ending| name.ends_with(ending))
    };
    for input in inputs.iter().filter(|input| input.is_dir) {
        let mut within: Vec<PathBuf> =
            std::fs::read_dir(&input.path).into_iter().flatten().flatten().map(|entry| entry.path()).collect();
        within.sort();
        let told = within.iter().find_map(|path| {
            let why = if ends(path, &[".mcap.zstd", ".db3.zstd"]) {
                "a bag that is packed as a file is not read; unpack it: zstd -d".to_owned()
            } else if ends(path, &[".db3"]) {
                SQLITE.to_owned()
            } else if ends(path, &[".bag"]) {
                ROS1_WAY.to_owned()
            } else if ends(path, &[".json"]) {
                JSON_WAY.to_owned()
            } else if path.is_dir() {
                format!("it is a folder in {}; give each recording's own folder", input.path.display())
            } else {
                return None;
            };
            Some(RecordingError::NoSession(format!("{}: {why}", path.display())))
        });
        if let Some(told) = told {
            return told;
        }
    }
    let names: Vec<String> = inputs.iter().map(|input| input.path.display().to_string()).collect();
    RecordingError::NoSession(format!("{}: no file there ends in {}", names.join(", "), TEXT.join(", ")))
}

/// Adds a text file, or those of a zip; the error is that of an archive that is refused.
fn add(
    found: &mut Documents,
    budget: &mut Budget,
    path: PathBuf,
    bytes: Result<Vec<u8>, RecordingError>,
) -> Result<Option<RecordingError>, RecordingError> {
    match bytes {
        Ok(bytes) if bytes.starts_with(ZIP) => unzip(&path, &bytes, budget, found)?,
        Ok(bytes) => found.add(Document::new(path, bytes, budget)),
        Err(why) => return Ok(Some(why)),
    }
    Ok(None)
}

fn is_zip(path: &Path) -> bool {
    path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("zip"))
}

/// Refuses more files than any session has, before they are read.
fn require_few(path: &Path, files: usize) -> Result<(), RecordingError> {
    if files <= MOST_FILES {
        return Ok(());
    }
    let why = format!("{files} files are in it, and a session has at most {MOST_FILES}; give the session's own");
    Err(RecordingError::Usage(format!("{}: {why}", path.display())))
}

fn is_text(path: &Path) -> bool {
    let name = name_of(path).to_lowercase();
    // "._Gyroscope.csv" is what macOS adds beside a file
    !name.starts_with("._") && TEXT.iter().any(|ending| name.ends_with(ending))
}

fn unzip(path: &Path, bytes: &[u8], budget: &mut Budget, found: &mut Documents) -> Result<(), RecordingError> {
    let entries = entries(bytes).unwrap_or(0);
    require_few(path, entries)?;
    let archive = guarded(|| zip::ZipArchive::new(io::Cursor::new(bytes))).map_err(io::Error::other);
    let archive = archive.and_then(|archive| archive.map_err(io::Error::from));
    let mut archive = archive.map_err(RecordingError::read(path))?;
    if archive.len() < entries {
        let why = "two of its entries have the same name, of which one would be lost; unpack it, and give the folder";
        return Err(RecordingError::Usage(format!("{}: {why}", path.display())));
    }
    let mut left = bytes.len() as u64;
    for index in 0..archive.len() {
        let name = archive.name_for_index(index).map(PathBuf::from).unwrap_or_default();
        if !is_text(&name) {
            continue;
        }
        let name = path.join(name);
        let entry = guarded(AssertUnwindSafe(|| {
            let mut entry = archive.by_index(index).map_err(io::Error::from)?;
            let packed_bytes = entry.compressed_size();
            left =
                left.checked_sub(packed_bytes).ok_or_else(|| io::Error::other("its entries overlap: it is damaged"))?;
            entry.is_file().then(|| budget.unpack(&mut entry, packed_bytes)).transpose()
        }));
        match entry.map_err(io::Error::other).and_then(|entry| entry).map_err(RecordingError::read(&name)) {
            Ok(None) => {}
            Ok(Some(bytes)) => found.add(Document::new(name, bytes, budget)),
            Err(why) => found.add(Err(why)),
        }
    }
    Ok(())
}

/// How many entries a zip says that it has, in the record at its end; none where that record is not found.
fn entries(zip: &[u8]) -> Option<usize> {
    const MARK: &[u8] = b"PK\x05\x06";
    // the record has 22 bytes and a comment behind it
    let from = zip.len().saturating_sub(22 + usize::from(u16::MAX));
    let at = from + zip[from..].windows(MARK.len()).rposition(|bytes| bytes == MARK)?;
    let count: [u8; 2] = zip.get(at + 10..at + 12)?.try_into().ok()?;
    Some(usize::from(u16::from_le_bytes(count)))
}
