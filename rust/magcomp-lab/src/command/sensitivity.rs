//! `magcomp sensitivity`.

use super::common::{OURS, Seeds, ours_is_here};
use crate::catalogue::Group;
use crate::sensitivity::{SensitivityOptions, run};
use clap::Args;
use magcomp_replay::atomic::write_atomically;
use magcomp_replay::command::refuse_outputs;
use magcomp_replay::error::RunError;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// Every choice of the estimators halved and doubled, every mechanism off, on simulated groups and recordings, every two that read the same state, as markdown (docs/dev/TUNING.md)
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
    /// Write every figure of every row into this file; the page has those that move something
    #[arg(long, value_name = "CSV")]
    csv: Option<PathBuf>,
    /// Mechanisms alone, no choices
    #[arg(long)]
    switches: bool,
    /// A stream of each variant for each of these seeds, two at least
    #[arg(long, value_name = "FIRST-LAST", default_value = "1-8")]
    seeds: Seeds,
}

impl Sensitivity {
    pub fn run(self) -> Result<(), RunError> {
        let started = Instant::now();
        self.recordings.iter().try_for_each(|folder| ours_is_here(folder))?;
        let seeds = self.seeds.range();
        let Self { recordings, index, group: groups, only, switches, csv, .. } = self;
        let inputs: Vec<&Path> = recordings.iter().chain(&index).map(PathBuf::as_path).collect();
        let outputs: Vec<(&str, &Path)> = csv.iter().map(|path| ("--csv", path.as_path())).collect();
        refuse_outputs(&inputs, &outputs, None)?;
        let (page, figures) = run(&SensitivityOptions { recordings, index, groups, only, switches, seeds })?;
        if let Some(path) = &csv {
            write_atomically(path, |out| out.write_all(figures.as_bytes()))?;
        }
        let mut out = std::io::stdout().lock();
        write!(out, "{}", page.markdown())?;
        out.flush()?;
        eprintln!("sensitivity: {:.1} minutes", started.elapsed().as_secs_f64() / 60.0);
        Ok(())
    }
}
