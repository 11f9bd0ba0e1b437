//! Where a recording or a session is read from.

use crate::error::RecordingError;
use std::fs::File;
use std::io::{self, Cursor, Read, Seek};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A file, or what one holds, in memory.
#[derive(Debug)]
pub enum Content {
    /// On disk.
    File(File),
    /// In memory.
    Memory(Cursor<Bytes>),
}

/// Bytes of which copies are free.
#[derive(Clone, Debug)]
pub struct Bytes(Arc<Vec<u8>>);

impl AsRef<[u8]> for Bytes {
    fn as_ref(&self) -> &[u8] {
        &self.0
    }
}

impl Content {
    /// The same from its first byte on. Of a file, what was returned before must not be read any further.
    pub fn again(&self) -> io::Result<Self> {
        Ok(match self {
            Self::File(file) => {
                let mut file = file.try_clone()?;
                file.rewind()?;
                Self::File(file)
            }
            Self::Memory(bytes) => Self::Memory(Cursor::new(bytes.get_ref().clone())),
        })
    }

    /// How many bytes it has.
    pub fn bytes(&self) -> io::Result<u64> {
        match self {
            Self::File(file) => Ok(file.metadata()?.len()),
            Self::Memory(bytes) => Ok(bytes.get_ref().0.len() as u64),
        }
    }
}

impl From<File> for Content {
    fn from(file: File) -> Self {
        Self::File(file)
    }
}

impl From<Vec<u8>> for Content {
    fn from(bytes: Vec<u8>) -> Self {
        Self::Memory(Cursor::new(Bytes(Arc::new(bytes))))
    }
}

impl Read for Content {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        match self {
            Self::File(file) => file.read(buffer),
            Self::Memory(bytes) => bytes.read(buffer),
        }
    }
}

/// The files of a folder, by name.
pub fn files_of(folder: &Path) -> Result<Vec<PathBuf>, RecordingError> {
    let entries = std::fs::read_dir(folder).and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect());
    let mut paths: Vec<PathBuf> = entries.map_err(RecordingError::read(folder))?;
    paths.retain(|path| path.is_file());
    paths.sort();
    Ok(paths)
}
