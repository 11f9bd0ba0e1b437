//! The runs of one scenario in a line.

use super::figures::Figures;
use super::stretch::{Begin, Stretch};
use magcomp_replay::statistics::median;
use serde::Serialize;

/// Median and worst run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Runs {
    /// None where half of the runs have none.
    pub median: Option<f64>,
    /// None where a run has none.
    pub worst: Option<f64>,
}

impl Runs {
    /// Of one value a run, the largest being the worst.
    pub fn of(values: impl Iterator<Item = Option<f64>>) -> Self {
        let values: Vec<f64> = values.map(|value| value.unwrap_or(f64::INFINITY)).collect();
        let known = |value: Option<f64>| value.filter(|value| value.is_finite());
        let worst = values.iter().copied().reduce(f64::max);
        Self { median: known(median(values)), worst: known(worst) }
    }
}

/// A scenario's runs.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Line {
    /// Share of judged samples with a heading, mean over the runs with judged samples.
    pub answered: Option<f64>,
    /// Until the heading, or where none is judged f or the calibration, is below 5 degrees for good, s: of all stretches that begin with a
    /// change; of those from the start where nothing changes.
    pub settled_s: Runs,
    /// Error of the headings, over the runs that have some.
    pub heading_deg: Runs,
    /// Error of f, over the runs that have one.
    pub carried_deg: Runs,
    /// Error of the calibration, over the runs that have one.
    pub calibration_deg: Runs,
    /// Share of heading errors within one and two sigmas, mean over the runs with headings.
    pub within: Option<[f64; 2]>,
    /// Mean square of error over sigma, mean over the runs with headings.
    pub z2: Option<f64>,
    /// Median sigma, the median run's.
    pub sigma_deg: Option<f64>,
    /// Longest lie, worst run.
    pub lie_s: f64,
    /// Changes that must be declared, all runs.
    pub due: usize,
    /// Those that were not.
    pub missed: usize,
    /// False device steps an hour, mean.
    pub false_per_h: f64,
    /// Stretches behind a change that last 8 s at least, all runs.
    pub stretches: usize,
    /// Those that were lost.
    pub lost: usize,
}

impl Line {
    /// Of these runs.
    pub fn of(runs: &[Figures]) -> Self {
        let mean = |values: Vec<f64>| (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64);
        let known = |of: fn(&Figures) -> Option<f64>| runs.iter().filter_map(of).collect::<Vec<f64>>();
        let error = |of: fn(&Figures) -> Option<f64>| Runs::of(runs.iter().map(of).filter(Option::is_some));
        let stretches = || runs.iter().flat_map(|run| &run.stretches);
        let changed: Vec<&Stretch> =
            stretches().filter(|one| one.begin != Begin::Start && one.settled.is_some()).collect();
        let judged = if changed.is_empty() { stretches().collect() } else { changed.clone() };
        let within = [0, 1].map(|k| mean(runs.iter().filter_map(|run| run.within).map(|within| within[k]).collect()));
        let settled = || judged.iter().filter_map(|one| one.settled);
        let settled_s = match settled().any(|settled| settled.heading_s.is_some()) {
            true => Runs::of(settled().filter_map(|settled| settled.heading_s).map(|limits| limits[0])),
            false => Runs::of(settled().map(|settled| settled.main_s[0])),
        };
        Self {
            answered: mean(known(|run| run.answered)),
            settled_s,
            heading_deg: error(|run| run.error.heading_deg),
            carried_deg: error(|run| run.error.carried_deg),
            calibration_deg: error(|run| run.error.calibration_deg),
            within: within[0].zip(within[1]).map(|(one, two)| [one, two]),
            z2: mean(known(|run| run.z2)),
            sigma_deg: median(known(|run| run.sigma_deg)),
            lie_s: runs.iter().map(|run| run.lie_s).fold(0.0, f64::max),
            due: runs.iter().map(|run| run.due).sum(),
            missed: runs.iter().map(|run| run.missed).sum(),
            false_per_h: mean(runs.iter().map(|run| run.false_per_h).collect()).unwrap_or(0.0),
            stretches: changed.len(),
            lost: changed.iter().filter(|one| one.is_lost).count(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_without_a_value_are_the_worst() {
        assert_eq!(Runs::of([Some(3.0), None, Some(1.0)].into_iter()), Runs { median: Some(3.0), worst: None });
        assert_eq!(Runs::of([None, None, Some(1.0)].into_iter()), Runs { median: None, worst: None });
        assert_eq!(Runs::of([Some(2.0), Some(1.0)].into_iter()), Runs { median: Some(1.5), worst: Some(2.0) });
        assert_eq!(Runs::of(std::iter::empty()), Runs { median: None, worst: None });
    }
}
