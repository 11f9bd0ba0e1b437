//! `magcomp sensitivity`.

use super::common::Seeds;
use crate::catalogue::Group;
use crate::error::LabError;
use crate::sensitivity::{SensitivityOptions, run};
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The recordings of the repository.
const OURS: &str = "tests/recordings";

/// Every choice of the estimators halved and doubled, every mechanism off, on simulated groups and recordings, as markdown (docs/dev/TUNING.md)
#[derive(Debug, Args)]
pub(super) struct Sensitivity {
    /// Folders of recordings with a reference orientation, as of `magcomp evaluate --recordings`; may be given more than once
    #[arg(long, value_name = "DIR", default_value = OURS)]
    recordings: Vec<PathBuf>,
    /// Groups and declinations of recordings, as of `magcomp evaluate --index`, for folders that have no INDEX.csv
    #[arg(long, value_name = "CSV")]
    index: Option<PathBuf>,
    /// Simulated groups; all when not given
    #[arg(long, value_enum, num_args = 1.., value_delimiter = ',')]
    group: Vec<Group>,
    /// Choices and mechanisms by a part of their name; all when not given
    #[arg(long, value_name = "NAME", num_args = 1.., value_delimiter = ',')]
    only: Vec<String>,
    /// Mechanisms alone, no choices
    #[arg(long)]
    switches: bool,
    /// A stream of each variant for each of these seeds, two at least
    #[arg(long, value_name = "FIRST-LAST", default_value = "1-8")]
    seeds: Seeds,
}

impl Sensitivity {
    pub fn run(self) -> Result<(), LabError> {
        let started = Instant::now();
        if self.recordings.iter().any(|folder| folder == Path::new(OURS) && !folder.is_dir()) {
            let why = format!("{OURS} is not here: run it in the repository, or name a folder with --recordings");
            return Err(LabError::Usage(why));
        }
        let seeds = self.seeds.range();
        let Self { recordings, index, group: groups, only, switches, .. } = self;
        let page = run(&SensitivityOptions { recordings, index, groups, only, switches, seeds })?;
        let mut out = std::io::stdout().lock();
        write!(out, "{}", page.markdown())?;
        out.flush()?;
        eprintln!("sensitivity: {:.1} minutes", started.elapsed().as_secs_f64() / 60.0);
        Ok(())
    }
}
