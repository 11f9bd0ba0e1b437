//! `magcomp compare --recordings`.

use super::common::{Common, refuse_outputs, warn};
use crate::error::LabError;
use crate::parallel::cores;
use crate::report::Report;
use crate::trials::compare_folder;
use clap::Args;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Options of `compare` for a folder.
#[derive(Clone, Debug, Args)]
pub(super) struct CompareFolder {
    /// Instead of scenarios: the recordings of a folder that have a reference orientation, beside VQF, the system's own field and others
    ///
    /// The recordings are those that `evaluate --recordings` takes; NAME_oscal beside NAME_uncal gives the operating system's field.
    #[arg(long = "recordings", value_name = "DIR", conflicts_with_all = ["recordings", "scenario", "method", "snr"])]
    folder: Option<PathBuf>,
    /// Groups of the recordings, as of `evaluate --index`; a column magnet_s tells from when to when a magnet sat on the sensor, as 45.1-99.8
    #[arg(long, value_name = "CSV", requires = "folder")]
    index: Option<PathBuf>,
}

impl CompareFolder {
    /// The folder, where recordings are to be compared.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    pub fn run(&self, folder: &Path, markdown: bool, common: &Common) -> Result<(), LabError> {
        refuse_outputs(&[folder], &[], common.report.as_deref())?;
        let comparison = compare_folder(folder, self.index.as_deref(), cores())?;
        warn(&comparison.warnings);
        let tables = comparison.tables();
        if markdown {
            tables.iter().try_for_each(|table| writeln!(std::io::stdout(), "{}", table.markdown()))?;
            return Ok(());
        }
        common.finish(&tables, &comparison, || {
            let mut report = Report::new("Methods side by side on recordings", "Each on the same samples, causal.");
            tables.iter().for_each(|table| report.table(table));
            Ok(report)
        })
    }
}
