//! A recording on disk or in memory, checked once, read as often as it is wanted.

use super::content::Content;
use super::events::{Events, Merged};
use super::read::{Origin, Rows, Text};
use super::rows::{Extent, Recording};
use crate::error::RecordingError;
use flate2::read::MultiGzDecoder;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// First bytes of a gzip file.
pub(crate) const GZIP: [u8; 2] = [0x1f, 0x8b];

/// A recording. It was read once, so every row is known to be good.
#[derive(Debug)]
pub struct Source {
    path: PathBuf,
    kind: Kind,
    extent: Extent,
}

#[derive(Debug)]
enum Kind {
    /// Gzipped or not; its rows are not in memory.
    Text(Content),
    Events(Arc<Events>),
}

impl Source {
    /// The recording in `content`, under the name it came from. Every row is checked.
    pub fn of(path: &Path, content: Content) -> Result<Self, RecordingError> {
        Self::checked(path, Kind::Text(content))
    }

    /// A session's events as a recording, under the name it came from.
    pub fn of_events(path: &Path, events: Events) -> Result<Self, RecordingError> {
        Self::checked(path, Kind::Events(Arc::new(events)))
    }

    fn checked(path: &Path, kind: Kind) -> Result<Self, RecordingError> {
        let mut source = Self { path: path.to_owned(), kind, extent: Extent::default() };
        for row in source.rows()? {
            source.extent.add(&row?);
        }
        if source.extent.rows == 0 {
            return Err(RecordingError::Empty { path: path.to_owned(), what: "a header but no rows" });
        }
        Ok(source)
    }

    /// Where it came from.
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// How many rows it has, and over what time.
    pub fn extent(&self) -> &Extent {
        &self.extent
    }

    /// Its rows from the first on. The rows of an earlier call must not be read any further.
    pub fn rows(&mut self) -> Result<Rows, RecordingError> {
        Ok(Rows(match &self.kind {
            Kind::Text(content) => Origin::Text(Box::new(text(&self.path, content)?)),
            Kind::Events(events) => Origin::Events(Merged::new(events)),
        }))
    }
}

/// The lines of a recording's text from the first on. What was returned before must not be read any further.
pub(crate) fn text(path: &Path, content: &Content) -> Result<Text, RecordingError> {
    let content = content.again().and_then(unzipped).map_err(RecordingError::read(path))?;
    Text::new(path, content)
}

/// Reads a whole recording into memory; `path` is its name in messages.
pub fn read_from(path: &Path, source: impl Read + 'static) -> Result<Recording, RecordingError> {
    let text = Text::new(path, unzipped(source).map_err(RecordingError::read(path))?)?;
    let rows = Rows(Origin::Text(Box::new(text)));
    Ok(Recording { path: path.to_owned(), rows: rows.collect::<Result<_, _>>()? })
}

/// Opens `path` and reads a whole recording into memory.
pub fn read(path: &Path) -> Result<Recording, RecordingError> {
    read_from(path, File::open(path).map_err(RecordingError::read(path))?)
}

/// The content of `source`, gzipped or not.
pub fn unzipped(source: impl Read + 'static) -> io::Result<Box<dyn Read>> {
    let mut source = BufReader::new(source);
    let zipped = source.fill_buf()?.starts_with(&GZIP);
    Ok(if zipped { Box::new(MultiGzDecoder::new(source)) } else { Box::new(source) })
}
