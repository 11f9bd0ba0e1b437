//! `magcomp evaluate`.

use super::common::{Common, between};
use super::evaluate_recordings::EvaluateRecordings;
use crate::error::LabError;
use crate::experiment::evaluate::{EvaluateOptions, run};
use crate::experiment::situation::Group;
use crate::report::Report;
use clap::{Args, ValueEnum, value_parser};
use std::io::Write;

/// Simulated phones in many situations with the default config: how wrong, how sure, how soon; docs/EVALUATION.md
#[derive(Debug, Args)]
pub(super) struct Evaluate {
    /// Tables; all when none is named
    #[arg(long, value_enum, value_delimiter = ',')]
    group: Vec<Group>,
    /// Runs of each situation; run k has the seed --seed + k
    #[arg(long, default_value_t = 20, value_parser = value_parser!(u32).range(1..))]
    runs: u32,
    /// How far each axis of the gyroscope is off along each axis, degrees rms: errors drawn for each run
    #[arg(long, value_name = "DEG", default_value_t = 0.0, value_parser = |text: &str| between(text, 0.0, 5.0))]
    gyro_skew: f64,
    /// Print the page docs/EVALUATION.md: the meaning of the columns, the tables, a list of the bad lines
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
    #[command(flatten)]
    recordings: EvaluateRecordings,
    #[command(flatten)]
    common: Common,
}

impl Evaluate {
    pub fn run(self) -> Result<(), LabError> {
        if let Some(folder) = self.recordings.folder() {
            return self.recordings.run(folder, &self.common);
        }
        let groups = if self.group.is_empty() { Group::value_variants().to_vec() } else { self.group.clone() };
        let result = run(&EvaluateOptions {
            groups,
            runs: self.runs as usize,
            seed: self.common.seed,
            gyro_skew_deg: self.gyro_skew,
        })?;
        if self.markdown {
            write!(std::io::stdout(), "{}", result.markdown())?;
            return Ok(());
        }
        self.common.finish(&result.tables(), &result, || {
            let mut report = Report::new(
                "Evaluation",
                "Published headings of simulated phones with the default config, against the truth.",
            );
            result.tables().iter().for_each(|table| report.table(table));
            Ok(report)
        })
    }
}
