//! One input that the user named, and how much of it is taken into memory.

use crate::error::RecordingError;
use crate::recording::Content;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

/// A zip with something in it.
pub(super) const ZIP: &[u8] = b"PK\x03\x04";

/// Bytes of text of a session and of a pipe, at most: it lies in memory while it is read. At 100 Hz ten sensors' CSV files are four hours.
pub(super) const MOST_BYTES: u64 = 1 << 30;
/// Packed text that is this many times its packed size is none of a sensor, and this much may be so all the same, bytes.
const MOST_TIMES: u64 = 100;
const SMALL_BYTES: u64 = 64 << 20;

/// A file, a folder, or what can be read only once: what a pipe gave, or memory.
pub(super) struct Input {
    pub path: PathBuf,
    /// Content of a pipe, or of a file that is in memory.
    copy: Option<Content>,
    pub is_dir: bool,
}

impl Input {
    /// Looks at `path`; of a pipe or a device all is read.
    pub fn new(path: &Path) -> Result<Self, RecordingError> {
        let kind = std::fs::metadata(path).map_err(RecordingError::read(path))?;
        let copy = if kind.is_dir() || kind.is_file() {
            None
        } else {
            let pipe = File::open(path).map_err(RecordingError::read(path))?;
            Some(copied(pipe).map_err(RecordingError::read(path))?.into())
        };
        Ok(Self { path: path.to_owned(), copy, is_dir: kind.is_dir() })
    }

    /// A file of this name, whose content is in memory.
    pub fn of_bytes(name: &str, bytes: Vec<u8>) -> Self {
        Self { path: PathBuf::from(name), copy: Some(bytes.into()), is_dir: false }
    }

    /// Whether it begins as a zip does.
    pub fn is_zip(&self) -> bool {
        let mut start = Vec::new();
        let read = self.open().map(|content| content.take(ZIP.len() as u64).read_to_end(&mut start));
        matches!(read, Ok(Ok(_))) && start == ZIP
    }

    pub fn all(paths: &[PathBuf]) -> Result<Vec<Self>, RecordingError> {
        paths.iter().map(|path| Self::new(path)).collect()
    }

    /// Its content from the first byte on. The file of an earlier call must not be read any further.
    pub fn open(&self) -> Result<Content, RecordingError> {
        let content = match &self.copy {
            None => File::open(&self.path).map(Content::from),
            Some(copy) => copy.again(),
        };
        content.map_err(RecordingError::read(&self.path))
    }
}

/// An unnamed temporary file with all that a pipe gives.
fn copied(pipe: File) -> io::Result<File> {
    let mut copy = tempfile::tempfile()?;
    if io::copy(&mut pipe.take(MOST_BYTES + 1), &mut copy)? > MOST_BYTES {
        let why = format!("a pipe of more than {} MiB is not read; give a file", MOST_BYTES >> 20);
        return Err(io::Error::new(io::ErrorKind::FileTooLarge, why));
    }
    Ok(copy)
}

/// How many more bytes of text a session may have.
pub(super) struct Budget(u64);

impl Default for Budget {
    fn default() -> Self {
        Self(MOST_BYTES)
    }
}

impl Budget {
    pub fn read(&mut self, content: impl Read) -> io::Result<Vec<u8>> {
        self.take(content, u64::MAX)
    }

    /// All of `content`, whose packed form has so many bytes.
    pub fn unpack(&mut self, content: impl Read, packed_bytes: u64) -> io::Result<Vec<u8>> {
        self.take(content, packed_bytes.saturating_mul(MOST_TIMES).max(SMALL_BYTES))
    }

    /// As [`Self::unpack`]; of what is cut off, as an app leaves it that was ended, what is before the cut, and that it is.
    pub fn unpack_cut(&mut self, content: impl Read, packed_bytes: u64) -> io::Result<(Vec<u8>, bool)> {
        let mut content = Cut { content, is_cut: false };
        let bytes = self.unpack(&mut content, packed_bytes)?;
        if content.is_cut && !bytes.contains(&b'\n') {
            return Err(io::Error::new(io::ErrorKind::UnexpectedEof, "the file is cut off"));
        }
        Ok((bytes, content.is_cut))
    }

    fn take(&mut self, content: impl Read, most: u64) -> io::Result<Vec<u8>> {
        let most = most.min(self.0);
        let mut bytes = Vec::new();
        content.take(most + 1).read_to_end(&mut bytes)?;
        let found = bytes.len() as u64;
        if found <= most {
            self.0 -= found;
            return Ok(bytes);
        }
        let why = if most == self.0 {
            format!("the session has more than {} MiB of text; import a shorter one", MOST_BYTES >> 20)
        } else {
            format!("it unpacks to more than {MOST_TIMES} times its size, as no sensor's text does")
        };
        Err(io::Error::new(io::ErrorKind::FileTooLarge, why))
    }
}

/// Content whose end may be missing.
struct Cut<R> {
    content: R,
    is_cut: bool,
}

impl<R: Read> Read for Cut<R> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self.content.read(buffer) {
            Err(why) if why.kind() == io::ErrorKind::UnexpectedEof => {
                self.is_cut = true;
                Ok(0)
            }
            read => read,
        }
    }
}
