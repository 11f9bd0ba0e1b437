//! Errors of an input. Each is one line that names the place and the form that was expected there.

use std::fmt;
use std::io;
use std::path::{Path, PathBuf};

/// Longest text of a file that an error shows, characters.
const SHOWN: usize = 60;

/// A text of a file that an error can show: short, on one line.
pub fn shorten(text: &str) -> String {
    let text: String = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    if text.chars().count() <= SHOWN { text } else { text.chars().take(SHOWN).chain("...".chars()).collect() }
}

/// Where in a file: line and column, counted from 1.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Place {
    /// The file.
    pub path: PathBuf,
    /// Line, the header being 1.
    pub line: u64,
    /// Column of the table and its name; none when the whole line is meant.
    pub column: Option<(usize, String)>,
}

impl fmt::Display for Place {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: line {}", self.path.display(), self.line)?;
        match &self.column {
            Some((number, name)) if name.is_empty() => write!(f, ", column {number}"),
            Some((number, name)) => write!(f, ", column {number} ({name})"),
            None => Ok(()),
        }
    }
}

/// Why something could not be read. Each is one line.
#[derive(Debug, thiserror::Error)]
pub enum RecordingError {
    /// A recording does not have the form that `magcomp replay --help` states.
    #[error("{place}: expected {expected}, found {found}")]
    Form {
        /// Where.
        place: Place,
        /// The content that was expected there.
        expected: String,
        /// What was.
        found: String,
    },
    /// A recording has no rows.
    #[error("{}: a recording has a header t_s,mx,my,mz and rows; this file has {what}", path.display())]
    Empty {
        /// The file.
        path: PathBuf,
        /// The content that the file has instead.
        what: &'static str,
    },
    /// The input is no recording and no session, or has none in it.
    #[error("{0}")]
    NoSession(String),
    /// A file could not be read.
    #[error("{}: cannot be read: {source}", path.display())]
    Read {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// The command was built without the importer of a form.
    #[error("{}: this build does not read {form}; cargo install --path rust/magcomp-lab --features formats makes a command that does", path.display())]
    Feature {
        /// The file.
        path: PathBuf,
        /// Its form.
        form: &'static str,
    },
    /// No declination for that place and date.
    #[error("no declination: {0}")]
    Declination(String),
    /// Options that do not go together.
    #[error("{0}")]
    Usage(String),
    /// The input holds several recordings.
    #[error("{why}")]
    Several {
        /// How many follow one another in one file; 0 where they are several files.
        sessions: usize,
        /// The sentence about it, with what to do.
        why: String,
    },
}

impl RecordingError {
    /// For `map_err` on reading `path`.
    pub fn read(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| {
            let is_cut = source.kind() == io::ErrorKind::UnexpectedEof;
            let source = if is_cut { io::Error::new(source.kind(), "the file is cut off") } else { source };
            Self::Read { path, source }
        }
    }

    /// Of two files with the same sensor.
    pub(crate) fn several(first: &Path, second: &Path) -> Self {
        let (first, second) = (first.display(), second.display());
        let why =
            format!("{first} and {second} are of the same sensor: these are several recordings; give one at a time");
        Self::Several { sessions: 0, why }
    }
}
