//! The recordings of a folder that have a reference.

use magcomp_recordings::error::RecordingError;
use magcomp_recordings::recording::{files_of, unzipped};
use magcomp_replay::error::RunError;
use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::path::{Path, PathBuf};

/// Bytes of a header that are looked at.
const HEADER: u64 = 1 << 16;
/// Endings of the two halves of a trial: the raw field, and the operating system's of the same times.
const RAW: &str = "_uncal";
const SYSTEM: &str = "_oscal";

/// The recordings of a folder whose header has a reference orientation, by name. A system's half of a pair is none.
pub(super) fn recordings(folder: &Path) -> Result<Vec<PathBuf>, RunError> {
    let paths = files_of(folder)?;
    let is_second_half = |path: &Path| {
        let raw = path.to_string_lossy().replace(SYSTEM, RAW);
        Path::new(&raw) != path && paths.binary_search(&PathBuf::from(raw)).is_ok()
    };
    let mut found = Vec::new();
    for path in &paths {
        if is_csv(path) && !is_second_half(path) && has_reference(path).map_err(RecordingError::read(path))? {
            found.push(path.clone());
        }
    }
    if found.is_empty() {
        let why = "no recording (.csv, .csv.gz) with a reference orientation, columns qw,qx,qy,qz, is in this folder";
        return Err(RunError::Usage(format!("{}: {why}", folder.display())));
    }
    Ok(found)
}

/// A recording's name in tables and for patterns: its file's without .csv or .csv.gz.
pub(super) fn name_of(path: &Path) -> String {
    let name = magcomp_recordings::recording::name_of(path);
    let short = name.strip_suffix(".gz").unwrap_or(&name);
    short.strip_suffix(".csv").unwrap_or(short).to_owned()
}

/// The operating system's half of a trial, where it lies beside the raw one.
pub(super) fn system_half(path: &Path) -> Option<PathBuf> {
    let name = magcomp_recordings::recording::name_of(path);
    let half = path.with_file_name(name.replace(RAW, SYSTEM));
    (half != path && half.is_file()).then_some(half)
}

fn is_csv(path: &Path) -> bool {
    let name = magcomp_recordings::recording::name_of(path);
    name.ends_with(".csv") || name.ends_with(".csv.gz")
}

/// Whether the header names a reference; whatever else is wrong with the file, its reader will tell.
fn has_reference(path: &Path) -> io::Result<bool> {
    let mut header = Vec::new();
    BufReader::new(unzipped(File::open(path)?)?.take(HEADER)).read_until(b'\n', &mut header)?;
    Ok(String::from_utf8_lossy(&header).split(',').any(|name| name.trim() == "qw"))
}
