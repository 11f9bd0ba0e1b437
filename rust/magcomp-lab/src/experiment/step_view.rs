//! The step experiment as tables and as figs. 4 and 5.

use super::step::StepResult;
use super::step_course::Course;
use super::step_score::{NormalisationResult, Peaks};
use crate::parameters::NAMES;
use magcomp_replay::error::RunError;
use magcomp_replay::plot::{Band, Colour, Layers, Panel, Series, draw};
use magcomp_replay::report::Report;
use magcomp_replay::table::{Table, number};

impl StepResult {
    /// One table for the parameters, one for the angles.
    pub fn tables(&self) -> [Table; 2] {
        [self.parameter_table(), self.angle_table()]
    }

    fn parameter_table(&self) -> Table {
        let title = format!(
            "Fig. 4: all nine parameters step by the factor {} ({}, {} dB, {} runs)",
            self.factor, self.scenario, self.snr_db, self.runs
        );
        let mut columns = vec!["parameter".to_owned()];
        for result in &self.normalisations {
            columns.push(format!("{:?}: transient", result.normalisation));
            columns.push("steady error %".to_owned());
        }
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        let mut table = Table::new(&title, &columns);
        for (i, name) in NAMES.iter().enumerate() {
            let mut cells = vec![(*name).to_owned()];
            for result in &self.normalisations {
                let parameter = &result.parameters[i];
                cells.push(transient(parameter.transient_samples, Some(parameter.transient_sd)));
                cells.push(parameter.steady_percent.text(2));
            }
            table.row(cells);
        }
        let mut summary = |name: &str, text: &dyn Fn(&NormalisationResult) -> (String, String)| {
            let mut cells = vec![name.to_owned()];
            for result in &self.normalisations {
                let (left, right) = text(result);
                cells.extend([left, right]);
            }
            table.row(cells);
        };
        summary("longest", &|result| (transient(result.transient_samples, None), String::new()));
        summary("sigma_T", &|result| (result.sigma_t.text(3), String::new()));
        summary("window N", &|result| (result.window.text(0), String::new()));
        table.note(
            "Transient: samples after the step until the rms over the runs of the relative error stays below 5 % for good, +- over \
             resampled runs. Steady error: rms over the last 1000 samples, mean +- spread over the runs. \
             The error of a parameter below 0.001 is relative to |h|.",
        );
        table.note("The paper (fig. 4): transient about 700 samples, steady error about 20 % for b and M_yx.");
        table
    }

    fn angle_table(&self) -> Table {
        let mut table = Table::new(
            "Fig. 5: peak errors of azimuth and elevation after the step, deg, with the noise of the sensor",
            &["", "azimuth: mean +- sd", "max", "elevation: mean +- sd", "max"],
        );
        let mut row = |name: String, peaks: &Peaks| {
            let (azimuth, elevation) = (&peaks.azimuth_deg, &peaks.elevation_deg);
            let max = |v: f64| number(Some(v), 1);
            table.row(vec![name, azimuth.text(1), max(azimuth.max), elevation.text(1), max(elevation.max)]);
        };
        for (k, result) in self.normalisations.iter().enumerate() {
            if k == 0 {
                row("constant-field parameters kept".to_owned(), &result.kept);
            }
            row(format!("{:?}, during the transient", result.normalisation), &result.during);
            row(format!("{:?}, after it", result.normalisation), &result.after);
            row(format!("{:?}, after it, noise-free samples", result.normalisation), &result.after_clean);
        }
        table.note("Azimuths count where sin(theta) is at least 0.5: near the poles their error is unbounded for any estimator.");
        table.note("The paper (fig. 5): 23 and 33 deg with the parameters kept, 10 and 8 deg with its method.");
        table
    }

    /// Figs. 4 and 5 of all runs, for the first normalisation.
    pub fn add_to(&self, report: &mut Report) -> Result<(), RunError> {
        let [parameters, angles] = self.tables();
        let first = self.normalisations.first();
        if let Some(first) = first {
            let caption = format!(
                "Fig. 4: the nine parameters over the samples, {:?}. Blue: the median of {} runs, and the band that holds nine runs \
                 in ten. Grey: the true parameters, which step after 2500 samples. |h| = 1.",
                first.normalisation, self.runs
            );
            report.figure("fig4_parameters", draw(&nine_panels(&first.course), 3, (400, 250))?, &caption);
        }
        report.table(&parameters);
        if let Some(first) = first {
            let caption = format!(
                "Fig. 5: errors of azimuth (where sin theta is at least 0.5) and elevation in the same {} runs. Each area reaches \
                 from the lowest to the highest error of any run, the noise of the sensor included. Orange: the constant-field \
                 parameters kept. Blue: the method.",
                self.runs
            );
            report.figure("fig5_angles", draw(&angle_panels(&first.course), 1, (1100, 280))?, &caption);
        }
        report.table(&angles);
        Ok(())
    }
}

/// Samples, with their spread where there is one.
fn transient(samples: Option<usize>, sd: Option<f64>) -> String {
    match (samples, sd) {
        (None, _) => "never".to_owned(),
        (Some(samples), None) => samples.to_string(),
        (Some(samples), Some(sd)) => format!("{samples} +- {sd:.0}"),
    }
}

fn nine_panels(course: &Course) -> Vec<Panel> {
    let panel = |(i, name): (usize, &&str)| {
        // the range of the truth and its step once more around it: a transient excursion must not flatten the rest
        let truth = course.truth[i].iter().map(|(_, truth)| *truth);
        let (low, high) = truth.fold((f64::MAX, f64::MIN), |(low, high), v| (low.min(v), high.max(v)));
        let room = (high - low).max(0.02);
        let lines = [
            Series::new(if i == 0 { "true" } else { "" }, Colour::Grey, course.truth[i].clone()),
            Series::new(if i == 0 { "median" } else { "" }, Colour::Blue, course.median[i].clone()),
        ];
        Panel {
            y_range: Some((low - room, high + room)),
            layers: Layers { bands: vec![(Colour::Blue, course.most[i].clone())], ..Layers::default() },
            ..Panel::new(name, if i >= 6 { "sample" } else { "" }, "", lines)
        }
    };
    NAMES.iter().enumerate().map(panel).collect()
}

fn angle_panels(course: &Course) -> Vec<Panel> {
    let edges = |name: &str, colour, band: &Band| {
        let low = Series::new(name, colour, band.iter().map(|(x, low, _)| (*x, *low)));
        [low, Series::new("", colour, band.iter().map(|(x, _, high)| (*x, *high)))]
    };
    let panel = |name: &str, i: usize| {
        let (kept, method) = (&course.kept_deg[i], &course.method_deg[i]);
        let kept_edges = edges("parameters kept", Colour::Orange, kept);
        let lines = kept_edges.into_iter().chain(edges("method", Colour::Blue, method));
        let bands = vec![(Colour::Orange, kept.clone()), (Colour::Blue, method.clone())];
        let layers = Layers { bands, ..Layers::default() };
        Panel { layers, ..Panel::new(&format!("{name} error"), "sample", "deg", lines) }
    };
    vec![panel("azimuth", 0), panel("elevation", 1)]
}
