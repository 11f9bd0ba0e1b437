//! Shared by the lab's verbs.

use magcomp_replay::error::RunError;
use std::ops::RangeInclusive;
use std::path::Path;
use std::str::FromStr;

/// Help of the option that names random numbers.
pub(super) const SEED: &str = "Names the random numbers: the same seed gives the same result";

/// The recordings of the repository.
pub(super) const OURS: &str = "tests/recordings";

/// Says what to do where the repository's recordings are meant and not there.
pub(super) fn ours_is_here(folder: &Path) -> Result<(), RunError> {
    if folder != Path::new(OURS) || folder.is_dir() {
        return Ok(());
    }
    Err(RunError::Usage(format!("{OURS} is not here: run it in the repository, or name a folder with --recordings")))
}

/// Seeds from the first to the last, both included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Seeds(pub u64, pub u64);

impl Seeds {
    pub fn range(self) -> RangeInclusive<u64> {
        self.0..=self.1
    }
}

impl FromStr for Seeds {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (first, last) = text.split_once('-').unwrap_or((text, text));
        let seeds = first.parse().ok().zip(last.parse().ok()).filter(|(first, last)| first <= last);
        seeds.map(|(first, last)| Self(first, last)).ok_or_else(|| "expected seeds such as 1-10 or 7".to_owned())
    }
}
