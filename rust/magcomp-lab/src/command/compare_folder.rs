//! `magcomp compare --recordings`.

use super::common::{Common, refuse_outputs, warn};
use crate::error::LabError;
use crate::parallel::cores;
use crate::report::Report;
use crate::trials::{Entry, compare_folder};
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
    /// Groups of the recordings, as of `evaluate --index`
    ///
    /// Two more columns may be there. magnet_s: from when to when a magnet sat on the sensor, as 45.1-99.8. calibration: the name of a
    /// recording of the same device and day in a constant field, of which a calibration is made beforehand for the methods that need one.
    #[arg(long, value_name = "CSV", requires = "folder")]
    index: Option<PathBuf>,
    /// A program of your own beside the methods: a folder with its answers to each recording (benchmarks/README.md)
    #[arg(long, value_name = "NAME=DIR", requires = "folder")]
    entry: Vec<Entry>,
}

impl CompareFolder {
    /// The folder, where recordings are to be compared.
    pub fn folder(&self) -> Option<&Path> {
        self.folder.as_deref()
    }

    pub fn run(&self, folder: &Path, markdown: bool, common: &Common) -> Result<(), LabError> {
        let inputs: Vec<&Path> =
            std::iter::once(folder).chain(self.entry.iter().map(|it| it.folder.as_path())).collect();
        refuse_outputs(&inputs, &[], common.report.as_deref())?;
        let comparison = compare_folder(folder, self.index.as_deref(), &self.entry, cores())?;
        warn(&comparison.warnings);
        let tables = comparison.tables();
        if markdown {
            tables.iter().try_for_each(|table| writeln!(std::io::stdout(), "{}", table.markdown()))?;
            return Ok(());
        }
        common.finish(&tables, &comparison, || {
            let mut report = Report::new("Methods side by side on recordings", "Each on the same samples, causal.");
            comparison.add_to(&mut report)?;
            Ok(report)
        })
    }
}
