//! `magcomp compare`.

use super::common::SEED;
use crate::baseline::Contestant;
use crate::catalogue::{COMPARED, Variant, find};
use crate::experiment::compare::{MethodScore, run_variant, tune};
use crate::experiment::compare_recording::{RecordingScore, compare_rows};
use crate::experiment::compare_view::{Given, add_case, case_table, dots, overview, recording_figure, recording_table};
use crate::parallel::cores;
use crate::simulate::Noise;
use crate::trials::{Entry, compare_folder};
use clap::{Args, ValueEnum, value_parser};
use magcomp_recordings::import::{ImportOptions, open};
use magcomp_recordings::recording::name_of;
use magcomp_replay::command::{Common, finite, input, refuse_outputs, warn};
use magcomp_replay::error::RunError;
use magcomp_replay::progress;
use magcomp_replay::report::Report;
use serde::Serialize;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Methods side by side on the same samples: scenarios, or recordings.
///
/// Each method answers every sample before it sees the next, from a cold start. A method's one free number (window, process
/// noise, threshold, rate of learning) is tuned for every scenario on other seeds. For the Kalman filters the true noise is given.
#[derive(Debug, Args)]
#[command(allow_negative_numbers = true)]
pub(super) struct Compare {
    /// Recordings instead of scenarios
    #[arg(value_name = "IN", value_parser = input)]
    recordings: Vec<PathBuf>,
    /// Variants of the catalogue (`magcomp evaluate --list`); the paper's and the usual phones when none is named
    #[arg(long, value_name = "VARIANT", value_delimiter = ',', conflicts_with = "recordings", value_parser = find)]
    scenario: Vec<Variant>,
    /// Methods; all when none is named
    #[arg(long, value_enum, value_delimiter = ',')]
    method: Vec<Contestant>,
    /// Runs of a scenario
    #[arg(long, default_value_t = 50, value_parser = value_parser!(u32).range(1..))]
    runs: u32,
    /// Signal-to-noise ratio of a scenario, dB; 30, or 40 for the phones, when not given
    #[arg(long, value_parser = finite)]
    snr: Option<f64>,
    /// Scenarios: print the overview alone, as markdown
    #[arg(long, conflicts_with_all = ["recordings", "folder", "json"])]
    markdown: bool,
    /// A folder: print a line of CSV for each recording and method instead of tables: docs/data/comparison.csv
    #[arg(long, requires = "folder", conflicts_with = "json")]
    csv: bool,
    /// Instead of scenarios: the recordings of a folder that have a reference orientation, beside VQF, the system's own field and others
    ///
    /// The recordings are those that `evaluate --recordings` takes; NAME_oscal beside NAME_uncal gives the operating system's field.
    #[arg(long = "recordings", value_name = "DIR", conflicts_with_all = ["recordings", "scenario", "method", "snr"])]
    folder: Option<PathBuf>,
    /// Groups of the recordings, as of `evaluate --index`
    ///
    /// More columns may be there. magnet_s: from when to when a magnet sat on the sensor, as 45.1-99.8. calibration: the name of a
    /// recording of the same device and day in a constant field, of which a calibration is made beforehand for the methods that need one. judged_s: headings
    /// are judged from this second after the first row on, by the constant angle of the rows before.
    #[arg(long, value_name = "CSV", requires = "folder")]
    index: Option<PathBuf>,
    /// A program of your own beside the methods: a folder with its answers to each recording (benchmarks/README.md)
    #[arg(long, value_name = "NAME=DIR", requires = "folder")]
    entry: Vec<Entry>,
    #[arg(long, default_value_t = 1, help = SEED)]
    seed: u64,
    #[command(flatten)]
    common: Common,
}

#[derive(Serialize)]
struct Scenario {
    scenario: String,
    runs: u32,
    /// From the magnetometer alone.
    methods: Vec<MethodScore>,
    /// With gyroscope and accelerometer.
    aided: Vec<MethodScore>,
}

impl Scenario {
    fn of(&self, given: Given) -> (&str, &[MethodScore]) {
        (&self.scenario, if given == Given::Inertial { &self.aided } else { &self.methods })
    }
}

#[derive(Serialize)]
struct Recorded {
    recording: String,
    methods: Vec<RecordingScore>,
    aided: Vec<RecordingScore>,
}

const BOTH: [Given; 2] = [Given::Magnetometer, Given::Inertial];

/// The picture of all scenarios or recordings, where there is more than one method.
fn add_dots(report: &mut Report, errors: &[(&str, f64)], dot: &str, given: Given) -> Result<(), RunError> {
    let is_compared = errors.iter().any(|(name, _)| *name != errors[0].0);
    if is_compared {
        let name = if given == Given::Inertial { "compare_inertial" } else { "compare" };
        report.figure(name, dots(errors, dot, given)?, "Errors of each method");
    }
    Ok(())
}

impl Compare {
    pub fn run(self) -> Result<(), RunError> {
        if let Some(folder) = &self.folder {
            return self.beside(folder);
        }
        if self.recordings.is_empty() { self.scenarios() } else { self.recorded() }
    }

    fn beside(&self, folder: &Path) -> Result<(), RunError> {
        let inputs: Vec<&Path> =
            std::iter::once(folder).chain(self.entry.iter().map(|it| it.folder.as_path())).collect();
        refuse_outputs(&inputs, &[], self.common.report.as_deref())?;
        let comparison = compare_folder(folder, self.index.as_deref(), &self.entry, cores())?;
        warn(&comparison.warnings);
        let report = || {
            Report::new("Methods side by side on recordings", "Each on the same samples, causal.")
                .with(|report| comparison.add_to(report))
        };
        if self.csv {
            write!(std::io::stdout(), "{}", comparison.csv())?;
            self.common.report.as_deref().map(|folder| report()?.write(folder)).transpose()?;
            return Ok(());
        }
        self.common.finish(&comparison.tables(), &comparison, report)
    }

    fn methods(&self) -> Vec<Contestant> {
        if self.method.is_empty() { Contestant::value_variants().to_vec() } else { self.method.clone() }
    }

    fn scenarios(self) -> Result<(), RunError> {
        let usual = || COMPARED.iter().map(|name| find(name)).collect::<Result<Vec<_>, _>>().map_err(RunError::Usage);
        let variants = if self.scenario.is_empty() { usual()? } else { self.scenario.clone() };
        let methods = self.methods();
        let seeds = self.seed..self.seed + u64::from(self.runs);
        let bar = progress::bar(variants.len() * methods.len(), "compare");
        let mut all = Vec::new();
        for variant in variants {
            let variant = variant.with_noise(self.snr.map(Noise::SnrDb));
            let (mut scores, mut aided) = (Vec::new(), Vec::new());
            for contestant in &methods {
                let value = tune(&variant, self.seed, *contestant)?;
                if let Some((before, runs)) = run_variant(&variant, seeds.clone(), *contestant, value)? {
                    let tuned = (contestant.grid().len() > 1).then_some(value);
                    let score = MethodScore::of(&contestant.name(), tuned, before, &runs);
                    if contestant.is_aided() { aided.push(score) } else { scores.push(score) }
                }
                bar.inc(1);
            }
            all.push(Scenario { scenario: variant.name, runs: self.runs, methods: scores, aided });
        }
        bar.finish_and_clear();
        let overview: Vec<_> =
            BOTH.into_iter().flat_map(|given| overview(all.iter().map(|one| one.of(given)), given)).collect();
        if self.markdown {
            overview.iter().try_for_each(|table| writeln!(std::io::stdout(), "{}", table.markdown()))?;
            return Ok(());
        }
        let tables = all.iter().flat_map(|one| {
            BOTH.into_iter().flat_map(|given| case_table(&one.scenario, one.runs, one.of(given).1, given))
        });
        let tables: Vec<_> = tables.chain(overview.clone()).collect();
        self.common.finish(&tables, &all, || {
            let mut report = Report::new(
                "Methods side by side",
                "Of the magnetometer alone: direction error of what each method makes of the noise-free sample. With gyroscope and \
                 accelerometer: error of its heading. Over the samples since the change.",
            );
            for given in BOTH {
                let errors = all.iter().flat_map(|one| one.of(given).1).map(|it| (it.name.as_str(), it.after_deg));
                add_dots(&mut report, &errors.collect::<Vec<_>>(), "a scenario", given)?;
            }
            overview.iter().for_each(|table| report.table(table));
            for one in &all {
                report.section(&one.scenario, "The change is at 0.");
                for given in BOTH {
                    add_case(&mut report, &one.scenario, one.runs, one.of(given).1, given)?;
                }
            }
            Ok(report)
        })
    }

    fn recorded(self) -> Result<(), RunError> {
        let inputs: Vec<&Path> = self.recordings.iter().map(PathBuf::as_path).collect();
        refuse_outputs(&inputs, &[], self.common.report.as_deref())?;
        let methods = self.methods();
        let mut all = Vec::new();
        for path in &self.recordings {
            let mut opened = open(std::slice::from_ref(path), &ImportOptions::default())?;
            warn(&opened.warnings);
            let extent = *opened.source.extent();
            let scores = compare_rows(&extent, opened.source.rows()?, &methods, self.seed)?;
            let (aided, methods): (Vec<_>, Vec<_>) = scores.into_iter().partition(|score| score.aided);
            all.push(Recorded { recording: name_of(path), methods, aided });
        }
        let groups = |one: &Recorded| -> Vec<_> {
            let groups = BOTH.into_iter().zip([one.methods.clone(), one.aided.clone()]);
            groups.filter(|(_, scores)| !scores.is_empty()).collect()
        };
        let table = |one: &Recorded, given, scores: &[RecordingScore]| recording_table(&one.recording, scores, given);
        let tables: Vec<_> = (all.iter())
            .flat_map(|one| groups(one).into_iter().map(|(given, scores)| table(one, given, &scores)))
            .collect();
        self.common.finish(&tables, &all, || {
            let mut report = Report::new("Methods side by side on recordings", "Each on the same samples, causal.");
            for given in BOTH {
                let all = all.iter().flat_map(|one| if given == Given::Inertial { &one.aided } else { &one.methods });
                let errors = all.filter_map(|it| Some((it.name.as_str(), it.vectors.heading?.rms_deg)));
                add_dots(&mut report, &errors.collect::<Vec<_>>(), "a recording", given)?;
            }
            for one in &all {
                report.section(&one.recording, "Heading error, rms over a second, up to one constant.");
                let name = one.recording.split('.').next().unwrap_or_default();
                for (given, scores) in groups(one) {
                    let suffix = if given == Given::Inertial { "_inertial" } else { "" };
                    let figure = recording_figure(&scores, given)?;
                    report.figure(&format!("compare_{name}{suffix}"), figure, &one.recording);
                    report.table(&table(one, given, &scores));
                }
            }
            Ok(report)
        })
    }
}
