//! A followed change as tables and as a picture of its first run.

use super::follow::{AnswerResult, FollowMethod, FollowResult, name};
use crate::score::Runs;
use magcomp_replay::error::RunError;
use magcomp_replay::figures;
use magcomp_replay::report::Report;
use magcomp_replay::table::{Table, number};

impl FollowResult {
    /// A line for each answer, then one for each method.
    pub fn tables(&self) -> Vec<Table> {
        vec![self.answer_table(), self.method_table()]
    }

    fn answer_table(&self) -> Table {
        let title = format!("{} ({} runs)", self.scenario, self.runs);
        let columns = ["", "before deg", "worst", "< 5 deg s", "worst", "< 2 deg s", "worst", "b error uT", "worst"];
        let mut table = Table::new(&title, &columns);
        for AnswerResult { name, before_deg, below_5_deg, below_2_deg, hard_iron_ut } in &self.answers {
            let pair = |runs: &Runs, digits| [runs.median, runs.worst].map(|value| number(value, digits));
            let seconds = |runs: &Runs| {
                [runs.median, runs.worst].map(|s| s.map_or_else(|| "never".to_owned(), |s| format!("{s:.1}")))
            };
            let cells = [pair(before_deg, 2), seconds(below_5_deg), seconds(below_2_deg), pair(hard_iron_ut, 1)];
            table.row(std::iter::once(name.clone()).chain(cells.into_iter().flatten()).collect());
        }
        table.note(
            "Before: root mean square of the error over the 10 s before the change. < 5 deg, < 2 deg: seconds after it until the 95th percentile of the \
             error over the trailing second stays below (1.0 at the least). b error: 3 s after the change. Median and worst run.",
        );
        table.note(
            "f: the field that the gyroscope carries, judged by the Earth's. c: what the calibration makes of the sample, judged \
             by its direction without noise.",
        );
        table
    }

    fn method_table(&self) -> Table {
        let columns =
            ["", "heading deg", "1 sigma %", "2 sigma %", "alarm after s", "worst deg", "missed", "false /h", "lost"];
        let mut table = Table::new("published headings, events", &columns);
        for FollowMethod { method, line, alarm_s, worst_deg } in &self.methods {
            let within = |k: usize| number(line.within.map(|within| 100.0 * within[k]), 0);
            table.row(vec![
                name(*method),
                number(line.heading_deg.median, 2),
                within(0),
                within(1),
                number(alarm_s.median, 2),
                number(worst_deg.median, 1),
                format!("{} of {}", line.missed, line.due),
                number(Some(line.false_per_h), 0),
                format!("{} of {}", line.lost, line.stretches),
            ]);
        }
        table.note(
            "Heading: published, root mean square from 20 s on. Sigma: share of its errors within one and two sigmas. Alarm: the status says suspect or \
             disturbed. Worst: largest error of f, or of c without a gyroscope, after the change. Medians of the runs.",
        );
        table
    }

    /// The tables, and the first method in the first run.
    pub fn add_to(&self, report: &mut Report, figure: &str) -> Result<(), RunError> {
        self.tables().iter().for_each(|table| report.table(table));
        match &self.first {
            Some((recording, steps)) => figures(report, figure, recording, steps),
            None => Ok(()),
        }
    }
}
