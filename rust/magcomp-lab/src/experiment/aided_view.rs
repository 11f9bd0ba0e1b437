//! The aided experiment as a table and as a picture of its first run.

use super::Spread;
use super::aided::AidedResult;
use super::aided_score::{MethodResult, Settling};
use crate::error::LabError;
use crate::replay::figures;
use crate::report::Report;
use crate::table::{Table, number};

impl AidedResult {
    /// One line for each method's answer.
    #[must_use]
    pub fn table(&self) -> Table {
        let title = format!("{} ({} runs)", self.scenario, self.runs);
        let mut table = Table::new(
            &title,
            &[
                "",
                "before deg",
                "< 5 deg",
                "worst",
                "< 2 deg",
                "worst",
                "b error uT",
                "1 sigma",
                "2 sigma",
                "steps",
                "others",
            ],
        );
        for method in &self.methods {
            table.row(line(method));
        }
        table.note(
            "Before: rms of the direction error in the 10 s before the step. < 5 deg, < 2 deg: samples after the step until the 95th \
             percentile over the trailing 100 samples stays below for good (100 at the least), median and worst run. b error: mean, \
             300 samples after the step. Sigma: share of the heading errors within one and two sigmas, percent. Steps, others: \
             device steps and other events that a run declares, mean.",
        );
        table.note(
            "f: the field that the gyroscope carries, judged by that of the undisturbed place. c: the corrected sample, judged by \
             its direction without noise.",
        );
        table
    }

    /// The line for every method and, where something changes at once, the aided method's reaction to it.
    #[must_use]
    pub fn tables(&self) -> Vec<Table> {
        std::iter::once(self.table()).chain(self.change_table()).collect()
    }

    fn change_table(&self) -> Option<Table> {
        let change = self.change?;
        let mut table = Table::new("the change, aided method", &["", "median", "worst run"]);
        let mut line = |name: &str, values: [Option<f64>; 2], digits| {
            table.row(vec![name.to_owned(), number(values[0], digits), number(values[1], digits)]);
        };
        line("suspect or disturbed after, s", change.noticed_s, 2);
        line("largest error of f from then on, deg", change.carried_worst_deg.map(Some), 2);
        if let Some(moved) = change.hard_iron_moved_ut {
            line("furthest b moved, uT", moved.map(Some), 2);
        }
        if let Some(called) = change.called_disturbed {
            line("called disturbed while it lasts, %", called.map(|share| Some(100.0 * share)), 0);
        }
        Some(table)
    }

    /// The tables, and the aided method in the first run.
    ///
    /// # Errors
    /// [`LabError::Plot`].
    pub fn add_to(&self, report: &mut Report, figure: &str) -> Result<(), LabError> {
        self.tables().iter().for_each(|table| report.table(table));
        match &self.first {
            Some((recording, steps)) => figures(report, figure, recording, steps),
            None => Ok(()),
        }
    }
}

fn line(method: &MethodResult) -> Vec<String> {
    let samples = |samples: Option<usize>| samples.map_or_else(|| "never".to_owned(), |samples| samples.to_string());
    let mean = |spread: Option<Spread>, digits| number(spread.map(|spread| spread.mean), digits);
    let percent = |share: Option<f64>| number(share.map(|share| 100.0 * share), 0);
    let Settling { median: median_5, worst: worst_5 } = method.below_5_deg;
    let Settling { median: median_2, worst: worst_2 } = method.below_2_deg;
    vec![
        method.name.to_owned(),
        mean(method.before_rms_deg, 2),
        samples(median_5),
        samples(worst_5),
        samples(median_2),
        samples(worst_2),
        mean(method.hard_iron_error_ut, 1),
        percent(method.within_sigma.map(|within| within[0])),
        percent(method.within_sigma.map(|within| within[1])),
        number(Some(method.device_events), 2),
        number(Some(method.other_events), 2),
    ]
}
