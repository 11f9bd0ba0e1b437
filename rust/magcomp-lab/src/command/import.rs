//! `magcomp import`.

use super::common::{Common, input, output, refuse_outputs, warn, warn_of};
use super::import_options::ImportArguments;
use crate::atomic::write_atomically;
use crate::error::LabError;
use crate::replay::session_table;
use crate::report::Report;
use clap::Args;
use magcomp_recordings::import::import;
use std::path::{Path, PathBuf};

/// Make a phone logger's session into a recording; `replay` takes the same inputs.
///
/// IN is a zip, a folder, or CSV files of Sensor Logger, phyphox, GnssLogger (and loggers of its form) or MATLAB Mobile, or plain CSV
/// whose columns --columns names; with the feature formats (cargo install --path rust/magcomp-lab --features formats) also a bag of
/// ROS 2 (mcap), Parquet or Arrow (a file, Feather 2, or a stream). Each sensor keeps its own times and rate: a row leaves the cells of
/// the others empty. The field that the operating system calibrated is kept as sys_mx,sys_my,sys_mz.
#[derive(Debug, Args)]
pub(super) struct Import {
    /// The session: a zip, a folder, or its files
    #[arg(value_name = "IN", required = true, value_parser = input)]
    inputs: Vec<PathBuf>,
    /// The recording to write; gzipped when the name ends in .gz
    #[arg(short, long, value_name = "OUT.csv.gz", value_parser = output)]
    output: PathBuf,
    #[command(flatten)]
    options: ImportArguments,
    #[command(flatten)]
    common: Common,
}

impl Import {
    pub fn run(self) -> Result<(), LabError> {
        let inputs: Vec<&Path> = self.inputs.iter().map(PathBuf::as_path).collect();
        refuse_outputs(&inputs, &[("--output", &self.output)], self.common.report.as_deref())?;
        let (events, summary) = import(&self.inputs, &self.options.into())?;
        write_atomically(&self.output, |out| events.write(out))?;
        warn(&summary.warnings);
        warn_of(&summary.conventions);
        let table = session_table(&summary);
        self.common.finish_beside(Some(&self.output), std::slice::from_ref(&table), &summary, || {
            let mut report = Report::new("A session imported", "What the logger recorded.");
            report.table(&table);
            summary.warnings.iter().for_each(|warning| report.section("Warning", warning));
            let findings = &summary.conventions.findings;
            findings.iter().for_each(|finding| report.section("Conventions", &finding.text));
            Ok(report)
        })
    }
}
