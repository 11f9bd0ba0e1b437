//! The paper's experiments and the aided method beside it, each a function from options to a result that prints as a table, JSON and figures.

pub mod adaptive;
pub mod aided;
mod aided_change;
pub mod aided_score;
mod aided_view;
pub mod bound;
pub mod compare;
pub mod compare_recording;
pub mod compare_view;
pub mod evaluate;
mod evaluate_view;
pub mod nees;
pub mod sensitivity;
pub mod situation;
pub mod step;
mod step_course;
mod step_score;
mod step_trace;
mod step_view;
pub mod surroundings;

use magcomp::{Config, HeadingConfig, Method};
use serde::Serialize;

/// The config of every run: the default, but with a tilt sigma of 0. Headings are judged by the true attitude here, so sigma
/// must not count the tilt of `up`.
#[must_use]
pub fn config(method: Method) -> Config {
    let heading = HeadingConfig { tilt_sigma_deg: 0.0, ..HeadingConfig::default() };
    Config { method, heading, ..Config::default() }
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
    #[must_use]
    pub fn of(values: &[f64]) -> Self {
        let count = values.len().max(1) as f64;
        let mean = values.iter().sum::<f64>() / count;
        let squares: f64 = values.iter().map(|v| (v - mean).powi(2)).sum();
        let max = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        Self { mean, sd: (squares / (count - 1.0).max(1.0)).sqrt(), max }
    }

    /// `mean +- sd`.
    #[must_use]
    pub fn text(&self, digits: usize) -> String {
        format!("{:.digits$} +- {:.digits$}", self.mean, self.sd)
    }
}
