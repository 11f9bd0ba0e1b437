//! `magcomp evaluate`.

use super::common::{OURS, Seeds, ours_is_here};
use crate::catalogue::{self, Group, Variant};
use crate::experiment::evaluate::{EvaluateOptions, run};
use crate::parallel::cores;
use crate::trials::{judge_folder, put_on_folder};
use clap::Args;
use magcomp_replay::Ignore;
use magcomp_replay::command::{Common, MethodChoice, refuse_outputs, warn};
use magcomp_replay::error::RunError;
use magcomp_replay::report::Report;
use magcomp_replay::table::Table;
use std::io::Write;
use std::num::NonZero;
use std::path::{Path, PathBuf};

/// Seeds that judge: development and tests use those below 100.
const JUDGED: Seeds = Seeds(12_001, 12_010);
/// Seeds when none are named: a run each of a variant, a draw each of a magnet.
const USUAL: Seeds = Seeds(1, 10);
const ONE: Seeds = Seeds(1, 1);

/// Simulated phones in many situations with the default config: how wrong, how sure, how soon; docs/EVALUATION.md
#[derive(Debug, Args)]
pub(super) struct Evaluate {
    /// Tables; all when neither a table nor a variant is named
    #[arg(long, value_enum, num_args = 1.., value_delimiter = ',')]
    group: Vec<Group>,
    /// Variants by name, or a name's begin followed by *
    #[arg(long, num_args = 1.., value_delimiter = ',')]
    variant: Vec<String>,
    /// A run for each of these seeds, 1-10 when not given; with --magnets a direction and a time of each magnet, 1-1 when not given
    #[arg(long, value_name = "FIRST-LAST")]
    seeds: Option<Seeds>,
    /// The seeds that nobody runs while developing, for the published page: once a release
    #[arg(long, conflicts_with = "seeds")]
    judge: bool,
    /// How M and b are estimated
    #[arg(long, value_enum, default_value_t)]
    method: MethodChoice,
    /// Leave the gyroscope out
    #[arg(long)]
    without_gyroscope: bool,
    /// Threads that share the work; as many as there are cores when not given
    #[arg(long)]
    threads: Option<NonZero<usize>>,
    /// Print the names of the variants and run nothing
    #[arg(long)]
    list: bool,
    /// Print a line of CSV for each variant instead of a table: docs/data/evaluation.csv
    #[arg(long, conflicts_with = "json")]
    csv: bool,
    /// Instead of simulated phones: judge the recordings of a folder that have a reference orientation
    ///
    /// Each .csv or .csv.gz with the columns of `magcomp replay`, qw,qx,qy,qz among them, goes through the default config. Other files are
    /// passed over, and so is NAME_oscal beside NAME_uncal. Rows: a recording, then a group.
    #[arg(long, value_name = "DIR", conflicts_with_all = ["group", "variant", "method", "threads", "list", "csv"])]
    recordings: Option<PathBuf>,
    /// Put magnets on the recordings, those of tests/recordings when none are named: arithmetic, not a real magnet
    ///
    /// A hard iron of 8 to 300 uT is added to the raw samples in the middle of each recording, at once, slid on, with soft iron, taken off again.
    /// Rows: a group and a magnet. Recordings on which a magnet sits already (magnet_s in the index) are left out.
    #[arg(long, conflicts_with_all = ["group", "variant", "method", "threads", "list", "csv", "judge"])]
    magnets: bool,
    /// Groups of the recordings: CSV with the columns recording,group[,declination_deg]; DIR/INDEX.csv when not given
    ///
    /// `recording` is the name of a file without .csv or .csv.gz, or a pattern with * and ?. The first line that fits a recording counts.
    /// declination_deg: how far magnetic north is east of the reference's; 0 when empty. Without an index all are one group.
    #[arg(long, value_name = "CSV", requires = "recordings")]
    index: Option<PathBuf>,
    #[command(flatten)]
    common: Common,
}

impl Evaluate {
    pub fn run(self) -> Result<(), RunError> {
        let seeds = self.seeds.unwrap_or(USUAL);
        let common = &self.common;
        if self.magnets {
            return self.with_magnets(common);
        }
        if let Some(folder) = &self.recordings {
            return self.recorded(folder, common);
        }
        let variants = self.variants()?;
        if self.list {
            let mut table = Table { left: true, ..Table::new("variants", &["name", "what happens"]) };
            variants.iter().for_each(|variant| table.row(vec![variant.name.clone(), variant.about.clone()]));
            let names: Vec<&String> = variants.iter().map(|variant| &variant.name).collect();
            return common.finish(std::slice::from_ref(&table), &names, || Ok(Report::new("Variants", "")));
        }
        let result = run(&EvaluateOptions {
            variants,
            seeds: if self.judge { JUDGED } else { seeds }.range(),
            method: self.method.method(),
            ignore: self.ignore(),
            threads: self.threads.unwrap_or_else(cores),
        })?;
        let report = || {
            Report::new(
                "Evaluation",
                "Published headings of simulated phones with the default config, against the truth.",
            )
            .with(|report| result.add_to(report))
        };
        if self.csv {
            write!(std::io::stdout(), "{}", result.csv())?;
            common.report.as_deref().map(|folder| report()?.write(folder)).transpose()?;
            return Ok(());
        }
        common.finish(&result.told(), &result, report)
    }

    fn ignore(&self) -> Ignore {
        Ignore { gyroscope: self.without_gyroscope, accelerometer: false }
    }

    fn with_magnets(&self, common: &Common) -> Result<(), RunError> {
        let folder = self.recordings.as_deref().unwrap_or(Path::new(OURS));
        ours_is_here(folder)?;
        refuse_outputs(&[folder], &[], common.report.as_deref())?;
        let seeds = self.seeds.unwrap_or(ONE).range();
        let trials = put_on_folder(folder, self.index.as_deref(), &seeds, self.ignore(), cores())?;
        warn(&trials.warnings);
        common.finish(&[trials.table()], &trials, || {
            let rule = format!("A magnet was put on each recording by arithmetic: {}.", trials.label);
            Report::new("Magnets put on recordings", &rule).with(|report| trials.add_to(report))
        })
    }

    fn recorded(&self, folder: &Path, common: &Common) -> Result<(), RunError> {
        if self.seeds.is_some() {
            let why = "recordings have no seeds; with --magnets a seed draws their directions and times";
            return Err(RunError::Usage(why.to_owned()));
        }
        refuse_outputs(&[folder], &[], common.report.as_deref())?;
        let trials = judge_folder(folder, self.index.as_deref(), self.ignore(), cores())?;
        warn(&trials.warnings);
        let tables = trials.tables();
        common.finish(&tables, &trials, || {
            let rule =
                "Each recording went through the default config in order, and was judged by its reference orientation.";
            Report::new("Recordings judged", rule).with(|report| trials.add_to(report))
        })
    }

    fn variants(&self) -> Result<Vec<Variant>, RunError> {
        let fits = |variant: &Variant, pattern: &str| match pattern.strip_suffix('*') {
            Some(begin) => variant.name.starts_with(begin),
            None => variant.name == pattern,
        };
        let all = catalogue::all();
        if let Some(unknown) = self.variant.iter().find(|pattern| !all.iter().any(|variant| fits(variant, pattern))) {
            let why = format!("no variant is called {unknown}; `magcomp evaluate --list` has all names");
            return Err(RunError::Usage(why));
        }
        let everything = self.group.is_empty() && self.variant.is_empty();
        let is_chosen = |variant: &Variant| {
            everything
                || self.group.contains(&variant.group)
                || self.variant.iter().any(|pattern| fits(variant, pattern))
        };
        Ok(all.into_iter().filter(is_chosen).collect())
    }
}
