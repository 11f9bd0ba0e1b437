//! Errors of a run. Each is one line.

use magcomp_recordings::error::RecordingError;
use std::io;
use std::path::{Path, PathBuf};

/// Why the command failed. Each is one line.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// An input could not be read.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// A file could not be written; a file that was there before is untouched.
    #[error("{}: cannot be written: {source}", path.display())]
    Write {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
    },
    /// Standard output is gone or full.
    #[error("standard output: {0}")]
    Stdout(#[from] io::Error),
    /// The core refused its configuration.
    #[error(transparent)]
    Config(#[from] magcomp::ConfigError),
    /// Options that do not go together.
    #[error("{0}")]
    Usage(String),
    /// A recording was read, and is bad: all was printed and written.
    #[error("{0}")]
    Bad(String),
    /// An experiment had nothing to average.
    #[error("{0}")]
    Experiment(String),
    /// A plot could not be drawn.
    #[error("plot {name}: {reason}")]
    Plot {
        /// Which.
        name: String,
        /// Why.
        reason: String,
    },
}

impl RunError {
    /// For `map_err` on writing `path`.
    pub fn write(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Write { path, source }
    }

    /// Whether the options were wrong, or the input was several recordings at once.
    pub fn is_usage(&self) -> bool {
        matches!(self, Self::Usage(_) | Self::Recording(RecordingError::Usage(_) | RecordingError::Several { .. }))
    }

    /// Whether the reader of our output has closed it, which is no failure.
    pub fn is_broken_pipe(&self) -> bool {
        matches!(self, Self::Stdout(source) | Self::Write { source, .. } if source.kind() == io::ErrorKind::BrokenPipe)
    }
}
