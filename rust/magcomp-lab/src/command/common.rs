//! Shared by all verbs: options, reading of numbers, printing of tables.

use crate::error::LabError;
use crate::report::Report;
use crate::table::Table;
use clap::Args;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Options of every verb.
#[derive(Clone, Debug, Args)]
pub(super) struct Common {
    /// Names the random numbers: the same seed gives the same result (replay draws none)
    #[arg(long, default_value_t = 1)]
    pub seed: u64,
    /// Print the numbers as JSON instead of a table
    #[arg(long)]
    pub json: bool,
    /// Write pictures (SVG) and one HTML page that shows them into this folder
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
}

impl Common {
    /// Prints tables, or `json` where it was asked for; then writes the report where it was asked for.
    pub fn finish(
        &self,
        tables: &[Table],
        json: &impl Serialize,
        report: impl FnOnce() -> Result<Report, LabError>,
    ) -> Result<(), LabError> {
        let page = self.report.as_ref().map(|folder| report()?.write(folder)).transpose()?;
        let mut out = std::io::stdout().lock();
        if self.json {
            serde_json::to_writer_pretty(&mut out, json).map_err(std::io::Error::from)?;
            writeln!(out)?;
        } else {
            for (k, table) in tables.iter().enumerate() {
                if k > 0 {
                    writeln!(out)?;
                }
                write!(out, "{table}")?;
            }
            if let Some(page) = page {
                writeln!(out, "\nreport: {}", page.display())?;
            }
        }
        out.flush()?;
        Ok(())
    }
}

/// A number, neither NaN nor infinite.
pub(super) fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| "expected a number".to_owned())
}

/// A number from `low` to `high`.
pub(super) fn between(text: &str, low: f64, high: f64) -> Result<f64, String> {
    let inside = finite(text).ok().filter(|v| (low..=high).contains(v));
    inside.ok_or_else(|| format!("expected a number from {low} to {high}"))
}

/// Refuses to write a file that is read, by whatever name or link it is called.
pub(super) fn refuse_same(input: &Path, output: &Path) -> Result<(), LabError> {
    // devices and pipes can be both, and opening a pipe to look at it would wait for the other end
    let is_file = |path: &Path| std::fs::metadata(path).is_ok_and(|there| there.is_file());
    if is_file(input) && is_file(output) && same_file::is_same_file(input, output).map_err(LabError::read(output))? {
        let (input, output) = (input.display(), output.display());
        return Err(LabError::Usage(format!("--output {output} is the input {input}; name another file")));
    }
    Ok(())
}
