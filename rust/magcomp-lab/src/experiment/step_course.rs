//! All runs of the step experiment over time: what figs. 4 and 5 draw.

use super::step_trace::{BEFORE, Trace, size};
use magcomp_replay::plot::Band;

/// Samples between two points of fig. 4.
const POINT: usize = 10;
/// Samples that make one point of the envelopes of fig. 5.
const GROUP: usize = 25;
/// Samples before the step that fig. 5 shows.
const SHOWN_BEFORE: usize = 500;

/// The runs over time; x counts samples.
#[derive(Clone, Debug, Default)]
pub struct Course {
    pub runs: usize,
    /// The nine true parameters.
    pub truth: [Vec<(f64, f64)>; 9],
    /// For each parameter the median of the runs.
    pub median: [Vec<(f64, f64)>; 9],
    /// For each parameter the band of nine runs in ten.
    pub most: [Band; 9],
    /// Lowest and highest error of azimuth and elevation in any run, degrees, the constant-field parameters kept.
    pub kept_deg: [Band; 2],
    /// The same of the method.
    pub method_deg: [Band; 2],
}

impl Course {
    /// Of these runs; the first has the truth.
    pub(super) fn of(runs: &[Trace]) -> Self {
        let mut course = Self { runs: runs.len(), ..Self::default() };
        let Some(first) = runs.first() else { return course };
        let mut values = Vec::with_capacity(runs.len());
        for (k, truth) in first.truth.iter().enumerate().step_by(POINT) {
            for (i, truth) in truth.iter().enumerate() {
                values.clear();
                values.extend(runs.iter().map(|run| truth + f64::from(run.relative[k][i]) * size(*truth)));
                values.sort_by(f64::total_cmp);
                let at = |percent: usize| values[(values.len() * percent / 100).min(values.len() - 1)];
                let x = k as f64;
                course.truth[i].push((x, *truth));
                course.median[i].push((x, at(50)));
                course.most[i].push((x, at(5), at(95)));
            }
        }
        course.kept_deg = envelopes(runs, |run| &run.kept_deg);
        course.method_deg = envelopes(runs, |run| &run.method_deg);
        course
    }
}

/// Lowest and highest azimuth and elevation error of each group of samples, over all runs.
fn envelopes(runs: &[Trace], errors: fn(&Trace) -> &Vec<(f64, f64)>) -> [Band; 2] {
    let samples = errors(&runs[0]).len();
    [|error: &(f64, f64)| error.0, |error: &(f64, f64)| error.1].map(|part: fn(&(f64, f64)) -> f64| {
        let starts = (BEFORE - SHOWN_BEFORE..samples).step_by(GROUP);
        let point = |start: usize| {
            let group = start..(start + GROUP).min(samples);
            // azimuths near the poles are not numbers and count for nothing
            let all = runs.iter().flat_map(|run| errors(run)[group.clone()].iter().map(part));
            let (low, high) = all
                .filter(|error| error.is_finite())
                .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), error| (low.min(error), high.max(error)));
            (start as f64, low, high)
        };
        starts.map(point).filter(|(_, low, high)| low <= high).collect()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bands_hold_the_runs_and_envelopes_their_extremes() {
        let samples = BEFORE + 100;
        let run = |share: f32, error: f64| Trace {
            truth: vec![[2.0; 9]; samples],
            relative: vec![[share; 9]; samples],
            method_deg: (0..samples).map(|k| (if k % 2 == 0 { f64::NAN } else { error }, -error)).collect(),
            kept_deg: vec![(0.0, 3.0); samples],
            ..Trace::default()
        };
        let runs: Vec<Trace> = (0..20_u8).map(|k| run(f32::from(k) / 20.0, f64::from(k))).collect();
        let course = Course::of(&runs);
        assert_eq!(course.truth[8][0], (0.0, 2.0));
        assert_eq!(course.median[0][0], (0.0, 3.0));
        let (_, low, high) = course.most[4][1];
        assert!((low - 2.1).abs() < 1e-6 && (high - 3.9).abs() < 1e-6, "{low} {high}");
        assert_eq!(course.method_deg[0][0], ((BEFORE - SHOWN_BEFORE) as f64, 0.0, 19.0));
        assert_eq!(course.method_deg[1].last().map(|point| (point.1, point.2)), Some((-19.0, 0.0)));
        assert_eq!(course.kept_deg[1][3].1, 3.0);
    }
}
