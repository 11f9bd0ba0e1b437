//! The text files of a session: named files, those of a folder, those of a zip.

use super::columnar::as_csv;
use super::forms::{ZIP, is_columnar};
use super::guard::guarded;
use super::input::{Budget, Input};
use crate::error::LabError;
use crate::recording::{GZIP, files_of};
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io;
use std::panic::AssertUnwindSafe;
use std::path::{Path, PathBuf};

/// Bytes of a file in which a zero means that it is no text.
const START: usize = 1024;
/// Endings of names that are read from folders and zips; other files there (pictures, sound, databases) are passed over.
const TEXT: [&str; 6] = [".csv", ".txt", ".csv.gz", ".parquet", ".arrow", ".feather"];

/// One text file, unzipped.
#[derive(Clone, Debug)]
pub(super) struct Document {
    /// Where it lies; of one in a zip, the zip's path and the name in it.
    pub path: PathBuf,
    /// Its content, without a byte order mark.
    pub text: Vec<u8>,
}

impl Document {
    fn new(path: PathBuf, bytes: Vec<u8>, budget: &mut Budget) -> Result<Self, LabError> {
        let mut text = bytes;
        if text.starts_with(&GZIP) {
            let packed_bytes = text.len() as u64;
            let plain = budget.unpack(MultiGzDecoder::new(text.as_slice()), packed_bytes);
            text = plain.map_err(LabError::read(&path))?;
        }
        if is_columnar(&text) {
            let csv = as_csv(&path, text)?;
            return Ok(Self { path: PathBuf::from(format!("{} as CSV", path.display())), text: csv });
        }
        if text.starts_with(b"\xef\xbb\xbf") {
            text.drain(..3);
        }
        if text.iter().take(START).any(|byte| *byte == 0) {
            return Err(LabError::Usage(format!("{}: {}", path.display(), not_text(&text))));
        }
        Ok(Self { path, text })
    }

    /// Its name without folder and endings, in small letters: `magnetometer`.
    pub fn stem(&self) -> String {
        let name = self.path.file_name().map_or_else(String::new, |name| name.to_string_lossy().to_lowercase());
        name.split('.').next().unwrap_or_default().to_owned()
    }

    /// Its first line that is no comment and not empty.
    pub fn first_line(&self) -> String {
        let mut lines = self.text.split(|byte| *byte == b'\n').map(<[u8]>::trim_ascii);
        let line = lines.find(|line| !line.is_empty() && !line.starts_with(b"#"));
        line.map_or_else(String::new, |line| String::from_utf8_lossy(line).into_owned())
    }
}

/// Names the form of a file that is no text, by its first bytes, and says what the user can do.
fn not_text(bytes: &[u8]) -> &'static str {
    if bytes.starts_with(b"MATLAB") {
        "a MATLAB file is not read; in MATLAB, writetimetable(MagneticField, \"MagneticField.csv\") makes a CSV of each sensor"
    } else if bytes.starts_with(b"FEA1") {
        "Feather of version 1 is not read; make version 2 of it: in Python, pandas.read_feather(IN).to_feather(OUT)"
    } else if bytes.starts_with(b"SQLite format 3") {
        "a bag in SQLite is not read; `ros2 bag convert` makes an mcap file of it"
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
    pub unreadable: Vec<LabError>,
}

impl Documents {
    fn add(&mut self, document: Result<Document, LabError>) {
        match document {
            Ok(document) => self.read.push(document),
            Err(why) => self.unreadable.push(why),
        }
    }
}

/// All text files that `inputs` name.
pub(super) fn documents(inputs: &[Input]) -> Result<Documents, LabError> {
    let (mut found, mut budget) = (Documents::default(), Budget::default());
    for input in inputs {
        if input.is_dir {
            for path in files_of(&input.path)?.into_iter().filter(|path| is_text(path)) {
                let bytes = File::open(&path).and_then(|file| budget.read(file)).map_err(LabError::read(&path));
                found.add(bytes.and_then(|bytes| Document::new(path, bytes, &mut budget)));
            }
            continue;
        }
        let bytes = budget.read(input.open()?).map_err(LabError::read(&input.path))?;
        if bytes.starts_with(ZIP) {
            unzip(&input.path, &bytes, &mut budget, &mut found)?
        } else {
            found.add(Document::new(input.path.clone(), bytes, &mut budget))
        }
    }
    if found.read.is_empty() {
        if let Some(why) = found.unreadable.pop() {
            return Err(why);
        }
        let names: Vec<String> = inputs.iter().map(|input| input.path.display().to_string()).collect();
        return Err(LabError::Usage(format!("{}: no file there ends in {}", names.join(", "), TEXT.join(", "))));
    }
    Ok(found)
}

fn is_text(path: &Path) -> bool {
    let name = path.file_name().map_or_else(String::new, |name| name.to_string_lossy().to_lowercase());
    // "._Gyroscope.csv" is what macOS adds beside a file
    !name.starts_with("._") && TEXT.iter().any(|ending| name.ends_with(ending))
}

fn unzip(path: &Path, bytes: &[u8], budget: &mut Budget, found: &mut Documents) -> Result<(), LabError> {
    let archive = guarded(|| zip::ZipArchive::new(io::Cursor::new(bytes))).map_err(io::Error::other);
    let archive = archive.and_then(|archive| archive.map_err(io::Error::from));
    let mut archive = archive.map_err(LabError::read(path))?;
    for index in 0..archive.len() {
        let name = archive.name_for_index(index).map(PathBuf::from).unwrap_or_default();
        if !is_text(&name) {
            continue;
        }
        let name = path.join(name);
        let entry = guarded(AssertUnwindSafe(|| {
            let mut entry = archive.by_index(index).map_err(io::Error::from)?;
            let packed_bytes = entry.compressed_size();
            entry.is_file().then(|| budget.unpack(&mut entry, packed_bytes)).transpose()
        }));
        match entry.map_err(io::Error::other).and_then(|entry| entry).map_err(LabError::read(&name)) {
            Ok(None) => {}
            Ok(Some(bytes)) => found.add(Document::new(name, bytes, budget)),
            Err(why) => found.add(Err(why)),
        }
    }
    Ok(())
}
