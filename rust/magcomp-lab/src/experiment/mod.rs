//! The paper's experiments, methods side by side, and the catalogue judged by the truth, each a function from options to a result that
//! prints as a table, JSON and figures.

pub mod bound;
pub mod compare;
pub(crate) mod compare_recording;
pub(crate) mod compare_view;
pub mod evaluate;
mod evaluate_view;
pub(crate) mod follow;
mod follow_view;
pub mod nees;
pub(crate) mod put_on;
pub mod step;
mod step_course;
mod step_score;
mod step_trace;
mod step_view;
pub(crate) mod story;

use crate::catalogue::Variant;
use crate::score::Figures;
use crate::simulate::Simulation;
use magcomp::{Config, Method};
use magcomp_recordings::recording::Recording;
use magcomp_replay::error::RunError;
use magcomp_replay::{Ignore, Player, Step};
use serde::Serialize;

/// A variant's stream, and what a method makes of it.
pub fn answers(
    variant: &Variant,
    seed: u64,
    method: Method,
    ignore: Ignore,
) -> Result<(Simulation, Recording, Vec<Step>), RunError> {
    let scenario = variant.scenario(seed);
    let simulation = scenario.run();
    let config = Config { method, initial: variant.initial(&scenario), ..variant.config() };
    let recording = simulation.recording(&variant.name);
    let mut player = Player::new(&config, ignore)?.adopting(variant.kept(&scenario));
    let steps = recording.rows.iter().map(|row| player.play(row)).collect();
    Ok((simulation, recording, steps))
}

/// One run of a variant, judged.
pub fn judge(variant: &Variant, seed: u64, method: Method, ignore: Ignore) -> Result<Figures, RunError> {
    let (simulation, _, steps) = answers(variant, seed, method, ignore)?;
    Ok(Figures::of(&simulation, &steps))
}

/// Mean and spread over runs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Spread {
    /// Mean over runs.
    pub mean: f64,
    /// Standard deviation over runs.
    pub sd: f64,
    /// Largest over runs.
    pub max: f64,
}

impl Spread {
    /// Of one value a run.
    pub fn of(values: &[f64]) -> Self {
        let count = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { mean, sd: (squares / (count - 1.0).max(1.0)).sqrt(), max }
    }

    /// `mean +- sd`.
    pub fn text(&self, digits: usize) -> String {
        format!("{:.digits$} +- {:.digits$}", self.mean, self.sd)
    }
}
