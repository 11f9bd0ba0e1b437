//! `magcomp compare`.

use super::{Common, finite};
use crate::baseline::{Baseline, Ours};
use crate::error::LabError;
use crate::experiment::compare::{MethodScore, run_case};
use crate::report::Report;
use crate::scenario::Case;
use crate::table::{Table, number};
use clap::{Args, ValueEnum, value_parser};
use magcomp::Method;
use serde::Serialize;

/// Methods side by side on the same samples.
#[derive(Debug, Args)]
pub(super) struct Compare {
    /// Scenarios; all when none is named
    #[arg(long, value_enum, value_delimiter = ',')]
    scenario: Vec<Case>,
    /// Runs
    #[arg(long, default_value_t = 50, value_parser = value_parser!(u32).range(1..))]
    runs: u32,
    /// Signal-to-noise ratio, dB; 30, or 40 for the phones
    #[arg(long, value_parser = finite)]
    snr: Option<f64>,
    #[command(flatten)]
    common: Common,
}

#[derive(Serialize)]
struct Compared {
    scenario: String,
    methods: Vec<MethodScore>,
}

impl Compare {
    pub fn run(self) -> Result<(), LabError> {
        let cases = if self.scenario.is_empty() { Case::value_variants().to_vec() } else { self.scenario.clone() };
        let mut all = Vec::new();
        let mut tables = Vec::new();
        for case in cases {
            let seeds = self.common.seed..self.common.seed + u64::from(self.runs);
            let config = crate::experiment::aided::config(Method::Adaptive);
            let (before, runs) = run_case(case, seeds, self.snr, |_, _| {
                Box::new(Ours::new(config.clone()).expect("default config")) as Box<dyn Baseline>
            });
            if let Ok(range) = std::env::var("MDP") { // DBG
                let v: Vec<usize> = range.split(',').map(|x| x.parse().unwrap()).collect(); // DBG
                for k in (v[0]..v[1]).step_by(v[2]) { // DBG
                    let r = |f: &dyn Fn(&crate::experiment::compare::Run) -> f32| { let s: f32 = runs.iter().map(|x| f(x).powi(2)).sum(); (s / runs.len() as f32).sqrt() }; // DBG
                    let mut all: Vec<f32> = runs.iter().map(|x| x.errors_deg[before + k]).collect(); all.sort_by(f32::total_cmp); // DBG
                    eprintln!("{k}: {:.2} held {:.2} median {:.2} max {:.2}", r(&|x| x.errors_deg[before + k]), r(&|x| x.held_deg[before + k]), all[all.len() / 2], all[all.len() - 1]); // DBG
                } // DBG
                for (i, x) in runs.iter().enumerate() { let s: f32 = x.errors_deg[before..].iter().map(|e| e * e).sum(); eprint!("{i}:{:.2}/{:.2} ", (s / (x.errors_deg.len() - before) as f32).sqrt(), {let s: f32 = x.errors_deg[before-1000..before].iter().map(|e| e * e).sum(); (s/1000.0).sqrt()}); } eprintln!(); // DBG
            } // DBG
            let methods = vec![MethodScore::of("adaptive", before, &runs)];
            tables.push(table(case, &methods));
            eprintln!("{}", tables[tables.len() - 1]);
            all.push(Compared { scenario: case.name(), methods });
        }
        self.common.finish(&tables, &all, || Ok(Report::new("Methods side by side", "")))
    }
}

fn table(case: Case, methods: &[MethodScore]) -> Table {
    let mut table = Table::new(
        &case.name(),
        &[
            "", "before", "after", "steady", "100", "300", "700", "1500", "3000", "<5", "<2", "<1", "/held", "p99",
            "us", "p99.9", "max",
        ],
    );
    for m in methods {
        let mut cells = vec![m.name.clone()];
        cells.extend([m.before_deg, m.after_deg, m.steady_deg].map(|v| number(Some(v), 2)));
        cells.extend(m.told_deg.iter().map(|v| number(Some(*v), 2)));
        cells.extend(m.settled.map(|s| s.map_or_else(|| "never".to_owned(), |s| s.to_string())));
        cells.extend([m.worst_over_held, m.p99_over_held].map(|v| number(Some(v), 2)));
        cells.extend(m.push_ns.map(|v| number(Some(v / 1000.0), 1)));
        table.row(cells);
        if let Some(bound) = &m.over_bound {
            table.note(&format!(
                "over bound {}: {}",
                m.name,
                bound.iter().map(|b| format!("{:.2}/{:.2}/{:.2}", b[0], b[1], b[2])).collect::<Vec<_>>().join("  ")
            ));
        }
    }
    table
}
