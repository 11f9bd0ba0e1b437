//! A recording on disk or in memory, checked once, read as often as it is wanted.

use super::content::Content;
use super::read::Rows;
use super::rows::{Extent, Recording};
use crate::error::LabError;
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// First bytes of a gzip file.
pub(crate) const GZIP: [u8; 2] = [0x1f, 0x8b];

/// A recording, gzipped or not. It was read once, so every row is known to be good; its rows are not in memory.
#[derive(Debug)]
pub struct Source {
    path: PathBuf,
    content: Content,
    extent: Extent,
}

impl Source {
    /// The recording in `content`, under the name it came from. Every row is checked.
    ///
    /// # Errors
    /// [`LabError::Recording`] for a file of another form, [`LabError::Empty`] for one without rows, [`LabError::Read`] when
    /// it cannot be read.
    pub fn of(path: &Path, content: Content) -> Result<Self, LabError> {
        let mut source = Self { path: path.to_owned(), content, extent: Extent::default() };
        for row in source.rows()? {
            source.extent.add(&row?);
        }
        if source.extent.rows == 0 {
            return Err(LabError::Empty { path: path.to_owned(), what: "a header but no rows" });
        }
        Ok(source)
    }

    /// Where it came from.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How many rows it has, and over what time.
    #[must_use]
    pub fn extent(&self) -> &Extent {
        &self.extent
    }

    /// Its rows from the first on. The rows of an earlier call must not be read any further.
    ///
    /// # Errors
    /// As of [`Source::of`].
    pub fn rows(&mut self) -> Result<Rows, LabError> {
        let content = self.content.again().and_then(unzipped).map_err(LabError::read(&self.path))?;
        Rows::new(&self.path, content)
    }
}

/// Reads a whole recording into memory; `path` is its name in messages.
///
/// # Errors
/// As of [`Source::of`].
pub fn read_from(path: &Path, source: impl Read + 'static) -> Result<Recording, LabError> {
    let rows = Rows::new(path, unzipped(source).map_err(LabError::read(path))?)?;
    Ok(Recording { path: path.to_owned(), rows: rows.collect::<Result<_, _>>()? })
}

/// Opens `path` and reads a whole recording into memory.
///
/// # Errors
/// As of [`Source::of`].
pub fn read(path: &Path) -> Result<Recording, LabError> {
    read_from(path, File::open(path).map_err(LabError::read(path))?)
}

/// The content of `source`, gzipped or not.
///
/// # Errors
/// When it cannot be read.
pub fn unzipped(source: impl Read + 'static) -> io::Result<Box<dyn Read>> {
    let mut source = BufReader::new(source);
    let zipped = source.fill_buf()?.starts_with(&GZIP);
    Ok(if zipped { Box::new(MultiGzDecoder::new(source)) } else { Box::new(source) })
}
