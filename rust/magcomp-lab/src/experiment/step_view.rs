//! The step experiment as tables and as figs. 4 and 5.

use super::step::StepResult;
use super::step_score::{BEFORE, NormalisationResult, Peaks};
use crate::error::LabError;
use crate::parameters::NAMES;
use crate::plot::{Colour, Panel, Series, draw};
use crate::report::Report;
use crate::table::{Table, number};

impl StepResult {
    /// One table for the parameters, one for the angles.
    #[must_use]
    pub fn tables(&self) -> [Table; 2] {
        [self.parameter_table(), self.angle_table()]
    }

    fn parameter_table(&self) -> Table {
        let title = format!(
            "Fig. 4: all nine parameters step by 50 % ({}, {} dB, {} runs)",
            self.scenario, self.snr_db, self.runs
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
            "transient: samples after the step until the rms over runs of the relative error stays below 5 % for good",
        );
        table.note("           (+- over resampled runs); steady error: rms over the last 1000 samples, mean +- spread over runs");
        table.note("paper (fig. 4): transient about 700, steady error about 20 % for b and M_yx");
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
        table.note("azimuth only where sin(theta) >= 0.5: near the poles it is unbounded for any estimator");
        table.note("paper (fig. 5): 23 and 33 deg with the parameters kept, 10 and 8 deg with its method");
        table
    }

    /// Figs. 4 and 5 of the first run.
    ///
    /// # Errors
    /// [`LabError::Plot`].
    pub fn add_to(&self, report: &mut Report) -> Result<(), LabError> {
        let [parameters, angles] = self.tables();
        if let Some(first) = self.normalisations.first() {
            report.figure(
                "fig4_parameters",
                draw(&nine_panels(first), 3, (400, 250))?,
                "Fig. 4: estimated (blue) and true (grey) parameters over the samples of one run; all nine step by 50 % \
                 after 2500 samples. |h| = 1.",
            );
        }
        report.table(&parameters);
        if let Some(first) = self.normalisations.first() {
            report.figure(
                "fig5_angles",
                draw(&angle_panels(first), 1, (1100, 280))?,
                "Fig. 5: errors of azimuth (where sin theta is at least 0.5) and elevation in the same run, with the \
                 constant-field parameters kept (orange) and with the method (blue).",
            );
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

fn nine_panels(result: &NormalisationResult) -> Vec<Panel> {
    let line = |values: &[[f64; 9]], i: usize| {
        values.iter().enumerate().map(|(k, theta)| (k as f64, theta[i])).collect::<Vec<_>>()
    };
    let trace = &result.trace;
    let panel = |(i, name): (usize, &&str)| {
        let true_values = line(&trace.truth, i);
        // the range of the truth and half its step around it: a transient excursion must not flatten the rest
        let (low, high) =
            true_values.iter().fold((f64::MAX, f64::MIN), |(low, high), (_, v)| (low.min(*v), high.max(*v)));
        let room = (high - low).max(0.02);
        Panel {
            title: (*name).to_owned(),
            x_label: if i >= 6 { "sample".to_owned() } else { String::new() },
            y_label: String::new(),
            y_range: Some((low - room, high + room)),
            series: vec![
                Series::new(if i == 0 { "estimated" } else { "" }, Colour::Blue, line(&trace.estimated, i)),
                Series::new(if i == 0 { "true" } else { "" }, Colour::Grey, true_values),
            ],
            ..Panel::default()
        }
    };
    NAMES.iter().enumerate().map(panel).collect()
}

fn angle_panels(result: &NormalisationResult) -> Vec<Panel> {
    let trace = &result.trace;
    let from = BEFORE - 500;
    let line = |errors: &[(f64, f64)], part: fn(&(f64, f64)) -> f64| {
        let points = errors.iter().enumerate().skip(from).map(|(k, error)| (k as f64, part(error)));
        // azimuth near the poles is left out, not a gap in the line
        points.filter(|(_, error)| error.is_finite()).collect::<Vec<_>>()
    };
    let panel = |name: &str, part: fn(&(f64, f64)) -> f64| Panel {
        title: format!("{name} error"),
        x_label: "sample".to_owned(),
        y_label: "deg".to_owned(),
        series: vec![
            Series::new("parameters kept", Colour::Orange, line(&trace.kept_deg, part)),
            Series::new("method", Colour::Blue, line(&trace.method_deg, part)),
        ],
        ..Panel::default()
    };
    vec![panel("azimuth", |error| error.0), panel("elevation", |error| error.1)]
}
