//! `magcomp evaluate --recordings`.

use super::common::{Common, refuse_outputs, warn};
use crate::error::LabError;
use crate::parallel::cores;
use crate::report::Report;
use crate::trials::judge_folder;
use clap::Args;
use std::path::{Path, PathBuf};

/// Options of `evaluate` for recordings.
#[derive(Clone, Debug, Args)]
pub(super) struct EvaluateRecordings {
    /// Instead of simulated phones: judge the recordings of a folder that have a reference orientation
    ///
    /// Each .csv or .csv.gz with the columns of `magcomp replay`, qw,qx,qy,qz among them, goes through the default config. Other files are
    /// passed over, and so is NAME_oscal beside NAME_uncal. Rows: a recording, then a group.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["group", "variant", "seeds", "method", "without_gyroscope", "threads", "list", "markdown"])]
    recordings: Option<PathBuf>,
    /// Groups of the recordings: CSV with the columns recording,group[,declination_deg]; DIR/INDEX.csv when not given
    ///
    /// `recording` is the name of a file without .csv or .csv.gz, or a pattern with * and ?. The first line that fits a recording counts.
    /// declination_deg: how far magnetic north is east of the reference's; 0 when empty. Without an index all are one group.
    #[arg(long, value_name = "CSV", requires = "recordings")]
    index: Option<PathBuf>,
}

impl EvaluateRecordings {
    /// The folder, where recordings are to be judged.
    pub fn folder(&self) -> Option<&Path> {
        self.recordings.as_deref()
    }

    pub fn run(&self, folder: &Path, common: &Common) -> Result<(), LabError> {
        refuse_outputs(&[folder], &[], common.report.as_deref())?;
        let trials = judge_folder(folder, self.index.as_deref(), cores())?;
        warn(&trials.warnings);
        let tables = trials.tables();
        common.finish(&tables, &trials, || {
            let rule =
                "Each recording went through the default config in order, and was judged by its reference orientation.";
            let mut report = Report::new("Recordings judged", rule);
            trials.add_to(&mut report)?;
            Ok(report)
        })
    }
}
