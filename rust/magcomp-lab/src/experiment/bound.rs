//! Fig. 2: error of the ellipsoid fit over the Cramer-Rao bound, for both residuals of the core.
//!
//! Each run draws N even orientations and noise, fits both residuals to the same samples, and adds its squared errors
//! and its bound: ratio = sqrt(sum of squared errors / sum of smallest variances) over runs and over a group of three
//! parameters. A ratio of 1 is as good as an unbiased estimate can be.

use crate::crb::FisherInformation;
use crate::parameters::{GROUPS, ParameterSet, Parameters};
use crate::random::{Purpose, Random};
use crate::simulate::Noise;
use magcomp::nalgebra::Vector3;
use magcomp::{FitOptions, Residual, fit_ellipsoid};
use magcomp_replay::error::RunError;
use magcomp_replay::plot::{Colour, Panel, Series, draw};
use magcomp_replay::progress;
use magcomp_replay::report::Report;
use magcomp_replay::table::{Table, number};
use serde::Serialize;

/// Sizes of fig. 2.
pub const SAMPLES: [usize; 8] = [100, 200, 500, 1000, 2000, 3000, 4000, 6500];
/// Signal-to-noise ratios of fig. 2 and of figs. 4 and 5, dB.
pub const SNR_DB: [f64; 3] = [30.0, 35.0, 40.0];
/// Field of the simulation, uT; the ratios do not depend on it.
const FIELD_UT: f64 = 40.0;

/// Options of the experiment.
#[derive(Clone, Debug)]
pub struct BoundOptions {
    /// True parameters.
    pub truth: Parameters,
    /// Runs for every N and SNR. The ratio's own error is about 1 / sqrt(6 runs).
    pub runs: usize,
    /// Samples P that are averaged at each orientation.
    pub averaged: usize,
    /// Names the random numbers.
    pub seed: u64,
    /// Sample counts N.
    pub samples: Vec<usize>,
    /// Signal-to-noise ratios, dB.
    pub snr_db: Vec<f64>,
}

impl Default for BoundOptions {
    fn default() -> Self {
        Self {
            truth: ParameterSet::Ref.parameters(),
            runs: 400,
            averaged: 1,
            seed: 1,
            samples: SAMPLES.to_vec(),
            snr_db: SNR_DB.to_vec(),
        }
    }
}

/// One N at one SNR.
#[derive(Clone, Debug, Serialize)]
pub struct BoundRow {
    /// Signal-to-noise ratio, dB.
    pub snr_db: f64,
    /// Samples in each fit.
    pub samples: usize,
    /// Runs that gave an ellipsoid with both residuals.
    pub runs: usize,
    /// Root of the mean bound per group (M diagonal, M off-diagonal, b), |h| = 1.
    pub bound: [f64; 3],
    /// RMSE over bound per group, eq. (10) as written.
    pub algebraic: [f64; 3],
    /// RMSE over bound per group, divided by its gradient.
    pub corrected: [f64; 3],
    /// RMSE over bound of all nine parameters together, of either residual.
    pub together: [f64; 2],
}

/// Fig. 2 as numbers.
#[derive(Clone, Debug, Serialize)]
pub struct BoundResult {
    /// Samples P averaged at each orientation.
    pub averaged: usize,
    /// A row for every SNR and N.
    pub rows: Vec<BoundRow>,
}

/// Runs the experiment.
pub fn run(options: &BoundOptions) -> Result<BoundResult, RunError> {
    let work: usize = options.samples.iter().sum::<usize>() * options.snr_db.len();
    let bar = progress::bar(work * options.runs, "fig. 2");
    let mut rows = Vec::new();
    for snr_db in &options.snr_db {
        for samples in &options.samples {
            rows.push(cell(options, *snr_db, *samples, |done| bar.inc(done))?);
        }
    }
    bar.finish_and_clear();
    Ok(BoundResult { averaged: options.averaged, rows })
}

fn cell(options: &BoundOptions, snr_db: f64, samples: usize, done: impl Fn(u64)) -> Result<BoundRow, RunError> {
    let truth = options.truth;
    let noise = Noise::SnrDb(snr_db).sigma_ut(1.0);
    let averaged = options.averaged as f64;
    // the same orientations and noise for every SNR: columns differ by the SNR alone
    let mut random = Random::new(options.seed ^ ((samples as u64) << 32), Purpose::ConstantField);
    let mut sums = [[0.0; 9]; 3];
    let mut good = 0;
    for _ in 0..options.runs {
        let mut information = FisherInformation::new(&truth, noise / averaged.sqrt())
            .ok_or_else(|| RunError::Experiment("true M has no inverse".to_owned()))?;
        let points: Vec<_> = (0..samples)
            .map(|_| {
                let u = random.direction();
                information.add(&u);
                let errors: Vector3<f64> = (0..options.averaged).map(|_| random.normal3()).sum();
                (truth.soft_iron * u + truth.hard_iron + errors * (noise / averaged)) * FIELD_UT
            })
            .collect();
        let errors = [Residual::Algebraic, Residual::Corrected].map(|residual| {
            let fit = fit_ellipsoid(&points, &fit_options(residual)).ok()?;
            let found = Parameters::of(&fit.calibration).theta();
            Some(std::array::from_fn::<f64, 9, _>(|i| (found[i] - truth.theta()[i]).powi(2)))
        });
        if let (Some(bound), [Some(algebraic), Some(corrected)]) = (information.smallest_variances(), errors) {
            for (sum, values) in sums.iter_mut().zip([bound, algebraic, corrected]) {
                (0..9).for_each(|i| sum[i] += values[i]);
            }
            good += 1;
        }
        done(samples as u64);
    }
    if good == 0 {
        return Err(RunError::Experiment(format!(
            "no ellipsoid in {} runs of {samples} samples at {snr_db} dB",
            options.runs
        )));
    }
    let group = |sum: &[f64; 9], k: usize| sum[GROUPS[k].1.clone()].iter().sum::<f64>();
    let ratio = |sum: &[f64; 9]| std::array::from_fn(|k| (group(sum, k) / group(&sums[0], k)).sqrt());
    Ok(BoundRow {
        snr_db,
        samples,
        runs: good,
        bound: std::array::from_fn(|k| (group(&sums[0], k) / (3 * good) as f64).sqrt()),
        algebraic: ratio(&sums[1]),
        corrected: ratio(&sums[2]),
        together: [1, 2].map(|k| (sums[k].iter().sum::<f64>() / sums[0].iter().sum::<f64>()).sqrt()),
    })
}

/// |h| is known, as the paper has it; nothing is refused for its size.
pub(crate) fn fit_options(residual: Residual) -> FitOptions {
    FitOptions { residual, field_strength_ut: Some(FIELD_UT), field_range_ut: (1.0, 1000.0), ..FitOptions::default() }
}

impl BoundResult {
    /// Smallest and largest ratio of the corrected residual.
    pub fn corrected_range(&self) -> (f64, f64) {
        let all = self.rows.iter().flat_map(|row| row.corrected);
        all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)))
    }

    /// The table.
    pub fn table(&self) -> Table {
        let each = ["off", "b", "all nine"];
        let columns = [&["SNR dB", "N", "runs", "(10): diag"][..], &each, &["corrected: diag"], &each];
        let columns = [&columns.concat()[..], &["bound: diag", "off", "b"]].concat();
        let mut table = Table::new("Fig. 2: RMSE over Cramer-Rao bound (1 = as good as possible)", &columns);
        for row in &self.rows {
            let mut cells = vec![format!("{}", row.snr_db), row.samples.to_string(), row.runs.to_string()];
            let [written, corrected] = &row.together;
            let ratios = row.algebraic.iter().chain([written]).chain(&row.corrected).chain([corrected]);
            cells.extend(ratios.map(|v| number(Some(*v), 2)));
            cells.extend(row.bound.iter().map(|v| number(Some(*v), 5)));
            table.row(cells);
        }
        let (low, high) = self.corrected_range();
        table.note(&format!("P = {} samples are averaged at each orientation.", self.averaged));
        table.note("(10): the paper's residual as written. Corrected: the residual divided by its own gradient.");
        table.note("Diag: M_xx, M_yy, M_zz. Off: M_xy, M_xz, M_yz. Bound: root of the mean bound, where |h| = 1.");
        table.note(&format!("The cells of the corrected residual go from {low:.3} to {high:.3}."));
        table
    }

    /// Fig. 2: a panel for every group, a line for every SNR and residual.
    pub fn add_to(&self, report: &mut Report) -> Result<(), RunError> {
        let all = self.rows.iter().flat_map(|row| row.algebraic.into_iter().chain(row.corrected));
        let top = all.fold(1.2, f64::max) * 1.05;
        let ratios = self.panels("samples N", "RMSE / bound", false, |row, _, ratio| (row.samples as f64, ratio));
        let ratios: Vec<Panel> = ratios.into_iter().map(|it| Panel { y_range: Some((0.5, top)), ..it }).collect();
        let errors = self.panels("log10 of the samples N", "log10 of the error", true, |row, k, ratio| {
            ((row.samples as f64).log10(), (ratio * row.bound[k]).log10())
        });
        report.figure(
            "fig2_bound",
            draw(&ratios, 3, (420, 340))?,
            "Fig. 2: error of the fit over the Cramer-Rao bound against the number of samples. Dashed: the paper's residual \
             (10) as written, biased in the diagonal of M. Solid: the residual divided by its own gradient, on the bound.",
        );
        report.figure(
            "fig2_error",
            draw(&errors, 3, (420, 340))?,
            "Fig. 2 as the paper draws it: bound (grey) and error over the number of samples, both as powers of ten, |h| = 1. \
             Dashed: the paper's residual (10) as written. Solid: divided by its own gradient.",
        );
        report.table(&self.table());
        Ok(())
    }

    /// A panel for every group, in it a line for every SNR and residual, and where that is asked for for the bound: `point` makes one
    /// of a row and a group's ratio to the bound.
    fn panels(
        &self,
        x_label: &str,
        y_label: &str,
        has_bound: bool,
        point: fn(&BoundRow, usize, f64) -> (f64, f64),
    ) -> Vec<Panel> {
        let mut snrs: Vec<f64> = self.rows.iter().map(|row| row.snr_db).collect();
        snrs.dedup();
        let panel = |k: usize| {
            let line = |snr: f64, colour: Colour, ratio: fn(&BoundRow, usize) -> f64| {
                let rows = self.rows.iter().filter(move |row| row.snr_db == snr);
                Series::new("", colour, rows.map(move |row| point(row, k, ratio(row, k))))
            };
            let colours = [Colour::Blue, Colour::Green, Colour::Purple];
            let lines = snrs.iter().zip(colours.into_iter().cycle()).flat_map(|(snr, colour)| {
                let bound = has_bound.then(|| line(*snr, Colour::Grey, |_, _| 1.0));
                let written = Series { dashed: true, ..line(*snr, colour, |row, k| row.algebraic[k]) };
                let name = if k == 0 { format!("{snr} dB") } else { String::new() };
                let corrected = Series { name, ..line(*snr, colour, |row, k| row.corrected[k]) };
                bound.into_iter().chain([written, corrected])
            });
            Panel::new(GROUPS[k].0, x_label, if k == 0 { y_label } else { "" }, lines)
        };
        (0..GROUPS.len()).map(panel).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn averaging_four_samples_halves_error_and_bound() {
        let options = |averaged| BoundOptions {
            averaged,
            runs: 100,
            samples: vec![3000],
            snr_db: vec![30.0],
            ..Default::default()
        };
        let [one, four] = [1, 4].map(|averaged| run(&options(averaged)).unwrap().rows.remove(0));
        for k in 0..3 {
            let bounds = one.bound[k] / four.bound[k];
            assert!((bounds - 2.0).abs() < 0.02, "{bounds}");
            // the ratio's own error is 1 / sqrt(6 runs), 0.04
            assert!((four.corrected[k] - 1.0).abs() < 0.15, "{:?}", four.corrected);
        }
        // what (10) adds is a bias of three variances of the noise, so it falls faster than the error
        let beyond = |row: &BoundRow| (row.algebraic[0].powi(2) - 1.0).sqrt() * row.bound[0];
        assert!((beyond(&one) / beyond(&four) - 4.0).abs() < 0.8, "{} and {}", beyond(&one), beyond(&four));
    }
}
