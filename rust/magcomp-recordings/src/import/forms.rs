//! The forms of files, by their first bytes.

use super::input::Input;
use crate::error::RecordingError;
use crate::recording::{Content, files_of};
use std::fs::File;
use std::io::Read;
use std::path::PathBuf;

pub(super) const PARQUET: &[u8] = b"PAR1";
pub(super) const ARROW_FILE: &[u8] = b"ARROW1";
const ARROW_STREAM: &[u8] = b"\xff\xff\xff\xff";
const MCAP: &[u8] = b"\x89MCAP";
/// A zip of any kind.
const ANY_ZIP: &[u8] = b"PK";

/// Whether a file that begins with these bytes is Parquet or Arrow.
pub(super) fn is_columnar(start: &[u8]) -> bool {
    [PARQUET, ARROW_FILE, ARROW_STREAM].iter().any(|form| start.starts_with(form))
}

/// Whether a file that begins with these bytes is no text, but one of the forms that are imported.
pub(super) fn is_packed(start: &[u8]) -> bool {
    is_columnar(start) || [ANY_ZIP, MCAP].iter().any(|form| start.starts_with(form))
}

/// The mcap files that `inputs` name, or that lie in a folder of `inputs`; none where there are none.
pub(super) fn bags(inputs: &[Input]) -> Result<Vec<(PathBuf, Content)>, RecordingError> {
    let mut found = Vec::new();
    for input in inputs {
        if input.is_dir {
            let is_bag = |path: &PathBuf| path.extension().is_some_and(|extension| extension == "mcap");
            let (parts, others): (Vec<PathBuf>, Vec<PathBuf>) = files_of(&input.path)?.into_iter().partition(is_bag);
            if let [first, second, ..] = parts.as_slice()
                && !others.iter().any(|path| path.ends_with("metadata.yaml"))
            {
                let (first, second) = (first.display(), second.display());
                let why = format!(
                    "{first} and {second} are bags of their own, for no metadata.yaml beside them says that they are one: give one at a time"
                );
                return Err(RecordingError::Several { sessions: 0, why });
            }
            for path in parts {
                let file = File::open(&path).map_err(RecordingError::read(&path))?;
                found.push((path, file.into()));
            }
        } else {
            let mut start = Vec::new();
            input.open()?.take(MCAP.len() as u64).read_to_end(&mut start).map_err(RecordingError::read(&input.path))?;
            if start == MCAP {
                found.push((input.path.clone(), input.open()?));
            }
        }
    }
    Ok(found)
}
