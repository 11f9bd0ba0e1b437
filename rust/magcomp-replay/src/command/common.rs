//! Shared by all verbs: options, reading of numbers, printing of tables.

use crate::error::RunError;
use crate::report::Report;
use crate::table::Table;
use clap::{Args, ValueEnum};
use magcomp::{Method, Normalisation, Residual};
use magcomp_recordings::conventions::{Conventions, Weight};
use magcomp_recordings::error::RecordingError;
use serde::Serialize;
use std::convert::Infallible;
use std::io::{self, IsTerminal, Write};
use std::path::{Component, Path, PathBuf};

/// The standard output where it is asked for as `-`: nothing else goes there then.
const STDOUT: &str = "/dev/fd/1";

/// Options of every verb.
#[derive(Clone, Debug, Args)]
pub struct Common {
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
        report: impl FnOnce() -> Result<Report, RunError>,
    ) -> Result<(), RunError> {
        self.finish_beside(None, tables, json, report)
    }

    /// The same beside the output of this name: where that is the standard output, what is printed goes to the standard error.
    pub fn finish_beside(
        &self,
        output: Option<&Path>,
        tables: &[Table],
        json: &impl Serialize,
        report: impl FnOnce() -> Result<Report, RunError>,
    ) -> Result<(), RunError> {
        let page = self.report.as_ref().map(|folder| report()?.write(folder)).transpose()?;
        let is_taken = output.is_some_and(|output| output == Path::new(STDOUT));
        let mut out: Box<dyn Write> = if is_taken { Box::new(io::stderr()) } else { Box::new(io::stdout().lock()) };
        if self.json {
            serde_json::to_writer_pretty(&mut out, json).map_err(io::Error::from)?;
            writeln!(out)?;
        } else {
            let is_terminal = if is_taken { io::stderr().is_terminal() } else { io::stdout().is_terminal() };
            let width = terminal_size::terminal_size().filter(|_| is_terminal).map(|(width, _)| usize::from(width.0));
            for (k, table) in tables.iter().enumerate() {
                if k > 0 {
                    writeln!(out)?;
                }
                write!(out, "{}", table.within(width))?;
            }
            if let Some(page) = page {
                writeln!(out, "\nreport: {}", page.display())?;
            }
        }
        out.flush()?;
        Ok(())
    }
}

/// How M and b are estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum MethodChoice {
    /// The best that the recording's sensors allow
    #[default]
    Auto,
    /// That with a gyroscope alone: without one it keeps its calibration
    Aided,
    /// The magnetometer alone, changes noticed by themselves
    Adaptive,
    /// The paper's: an ellipsoid over the latest N samples
    Windowed,
    /// The paper's first step alone: one calibration, then kept
    Constant,
}

impl MethodChoice {
    /// As the core calls it.
    pub fn method(self) -> Method {
        match self {
            Self::Auto => Method::Auto,
            Self::Adaptive => Method::Adaptive,
            Self::Windowed => Method::Windowed,
            Self::Constant => Method::Constant,
            Self::Aided => Method::Aided,
        }
    }
}

/// Which residual the windowed fits use, as the command line names it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum ResidualChoice {
    /// Divided by its own gradient, free of the noise bias
    #[default]
    Corrected,
    /// Eq. (10) as written
    Algebraic,
}

impl From<ResidualChoice> for Residual {
    fn from(choice: ResidualChoice) -> Self {
        match choice {
            ResidualChoice::Corrected => Self::Corrected,
            ResidualChoice::Algebraic => Self::Algebraic,
        }
    }
}

/// How sigma_T is normalised, as the command line names it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum NormalisationChoice {
    /// By 180 and 90 degrees: even orientations give 0.72
    HalfRange,
    /// By an even sphere: even orientations give 1
    EvenSphere,
}

impl From<NormalisationChoice> for Normalisation {
    fn from(choice: NormalisationChoice) -> Self {
        match choice {
            NormalisationChoice::HalfRange => Self::HalfRange,
            NormalisationChoice::EvenSphere => Self::EvenSphere,
        }
    }
}

/// A choice as it is typed on the command line.
pub fn as_typed(choice: &impl ValueEnum) -> String {
    choice.to_possible_value().map_or_else(String::new, |value| value.get_name().to_owned())
}

/// A path; `-` is the standard input.
pub fn input(text: &str) -> Result<PathBuf, Infallible> {
    Ok(PathBuf::from(if text == "-" { "/dev/stdin" } else { text }))
}

/// A path; `-` is the standard output.
pub fn output(text: &str) -> Result<PathBuf, Infallible> {
    Ok(PathBuf::from(if text == "-" { STDOUT } else { text }))
}

/// A number, neither NaN nor infinite.
pub fn finite(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|v: &f64| v.is_finite()).ok_or_else(|| "expected a number".to_owned())
}

/// A number from `low` to `high`.
pub fn between(text: &str, low: f64, high: f64) -> Result<f64, String> {
    let inside = finite(text).ok().filter(|v| (low..=high).contains(v));
    inside.ok_or_else(|| format!("expected a number from {low} to {high}"))
}

/// Prints warnings, one line each, on standard error.
pub fn warn(warnings: &[String]) {
    warnings.iter().for_each(|warning| eprintln!("magcomp: warning: {warning}"));
}

/// Prints what is wrong with a recording's conventions, one line each, on standard error.
pub fn warn_of(conventions: &Conventions) {
    let grave = conventions.findings.iter().filter(|finding| finding.weight > Weight::Note);
    grave.for_each(|finding| eprintln!("magcomp: warning: {}", finding.text));
}

/// Refuses, before anything is written, an output that is an input, lies in a folder that is one, or is another output, by
/// whatever name or link it is called. `report` is the folder that `--report` names.
pub fn refuse_outputs(inputs: &[&Path], outputs: &[(&str, &Path)], report: Option<&Path>) -> Result<(), RunError> {
    let refuse = |why: String| Err(RunError::Usage(why));
    let all = outputs.iter().copied().chain(report.map(|folder| ("--report", folder)));
    for (name, output) in all {
        for input in inputs {
            let shown = format!("{name} {}", output.display());
            if is_same_file(input, output)? {
                return refuse(format!("{shown} is the input {}; name another file", input.display()));
            }
            if input.is_dir() && resolved(output).starts_with(resolved(input)) {
                return refuse(format!("{shown} lies in the input {}; name a place outside", input.display()));
            }
        }
    }
    for (k, (name, output)) in outputs.iter().enumerate() {
        let shown = format!("{name} {}", output.display());
        for (other, before) in &outputs[..k] {
            if is_same_file(before, output)? || !is_device(output) && resolved(before) == resolved(output) {
                return refuse(format!("{shown} is {other} too; name another file"));
            }
        }
        let place = resolved(output);
        // a report has an index.html and pictures, right in its folder
        let is_page = place.extension().is_some_and(|extension| extension == "html" || extension == "svg");
        if is_page && report.is_some_and(|folder| place.parent() == Some(&resolved(folder))) {
            return refuse(format!("{shown} may be a page of --report; name another file"));
        }
    }
    Ok(())
}

fn is_device(path: &Path) -> bool {
    std::fs::metadata(path).is_ok_and(|there| !there.is_file() && !there.is_dir())
}

fn is_same_file(one: &Path, other: &Path) -> Result<bool, RunError> {
    // devices and pipes can be both, and opening a pipe to look at it would wait for the other end
    let is_file = |path: &Path| std::fs::metadata(path).is_ok_and(|there| there.is_file());
    if !is_file(one) || !is_file(other) {
        return Ok(false);
    }
    Ok(same_file::is_same_file(one, other).map_err(RecordingError::read(other))?)
}

/// The path without links and dots, of which the end may not exist yet.
fn resolved(path: &Path) -> PathBuf {
    let whole = std::path::absolute(path).unwrap_or_else(|_| path.to_owned());
    let mut found = PathBuf::new();
    for part in whole.components() {
        match part {
            Component::ParentDir => drop(found.pop()),
            part => found.push(part),
        }
        found = std::fs::canonicalize(&found).unwrap_or(found);
    }
    found
}
