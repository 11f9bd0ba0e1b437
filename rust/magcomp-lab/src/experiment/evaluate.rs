//! Any part of the catalogue with one config, judged by the truth: a line for each variant, over its seeds.

use super::judge;
use crate::catalogue::{Group, Variant};
use crate::parallel::map_shown;
use crate::score::{Figures, Line};
use clap::ValueEnum;
use magcomp::Method;
use magcomp_replay::Ignore;
use magcomp_replay::error::RunError;
use serde::Serialize;
use std::num::NonZero;
use std::ops::RangeInclusive;

/// Options of the experiment.
#[derive(Clone, Debug)]
pub struct EvaluateOptions {
    /// What is run, in the order of the catalogue.
    pub variants: Vec<Variant>,
    /// A run each.
    pub seeds: RangeInclusive<u64>,
    /// How M and b are estimated.
    pub method: Method,
    /// Sensors that are left out.
    pub ignore: Ignore,
    /// How many threads share the work: they change nothing but the time.
    pub threads: NonZero<usize>,
}

impl EvaluateOptions {
    /// These variants with the default config.
    pub fn of(variants: Vec<Variant>, seeds: RangeInclusive<u64>) -> Self {
        let threads = crate::parallel::cores();
        Self { variants, seeds, method: Method::Auto, ignore: Ignore::default(), threads }
    }
}

/// A variant over its seeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VariantResult {
    /// On the command line.
    pub name: String,
    /// In a few words.
    pub about: String,
    /// What the runs come to.
    #[serde(flatten)]
    pub line: Line,
    /// Each run, in the order of the seeds.
    pub runs: Vec<Figures>,
}

/// A table.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct GroupResult {
    /// Its title.
    pub title: &'static str,
    /// Its lines.
    pub variants: Vec<VariantResult>,
}

/// All tables.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EvaluateResult {
    /// The first and the last seed.
    pub seeds: (u64, u64),
    /// The tables.
    pub groups: Vec<GroupResult>,
}

/// Runs the variants.
pub fn run(options: &EvaluateOptions) -> Result<EvaluateResult, RunError> {
    let seeds = options.seeds.clone().count();
    let jobs = options.variants.iter().flat_map(|variant| options.seeds.clone().map(move |seed| (variant, seed)));
    let jobs: Vec<(&Variant, u64)> = jobs.collect();
    let runs = map_shown("evaluate", &jobs, options.threads, |(variant, seed)| {
        judge(variant, *seed, options.method, options.ignore)
    });
    let mut runs = runs.into_iter();
    let mut results = Vec::new();
    for variant in &options.variants {
        let own: Vec<Figures> = runs.by_ref().take(seeds).collect::<Result<_, _>>()?;
        let (name, about) = (variant.name.clone(), variant.about.clone());
        results.push((variant.group, VariantResult { name, about, line: Line::of(&own), runs: own }));
    }
    let of = |group: &Group| GroupResult {
        title: group.title(),
        variants: results.iter().filter(|(own, _)| own == group).map(|(_, result)| result.clone()).collect(),
    };
    let groups = Group::value_variants().iter().map(of).filter(|group| !group.variants.is_empty()).collect();
    Ok(EvaluateResult { seeds: (*options.seeds.start(), *options.seeds.end()), groups })
}
