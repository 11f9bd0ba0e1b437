//! The output of `magcomp evaluate`: a table for each group, and a list of the bad lines.

use super::evaluate::{EvaluateResult, GroupResult, SituationResult};
use crate::table::{Table, number};

/// A line is bad when less than this share of the errors lies within two sigmas (95 % is right) ...
const LEAST_WITHIN_TWO: f64 = 0.90;
/// ... or when it is `Tracking` beyond three sigmas for longer than this, s.
const MOST_BEYOND_S: f64 = 1.0;

/// What the columns mean.
const NOTES: &str = "\
* Every run has its own device, motion and noise: a field of 50 uT with a dip of 60 degrees, white noise of 0.5 uT, soft iron of 3 to 10 %,
  hard iron of 20 to 40 uT an axis, 60 s at 100 Hz, from a cold start. What happens, happens at 30 s. Each sample is answered before the next is
  seen. The config is the default.
* heading: that of the top edge, as published, against the truth in the undisturbed field of the place. Samples whose top edge is more than 60
  degrees off the horizontal are passed over. It is judged from 30 s on; where nothing changes, from the start.
* answered: share of these samples with a heading, percent.
* < 5 deg: seconds from the change, or from the start, until the 95th percentile over 100 judged samples stays below 5 degrees for good (1.0 s is
  the least that this measure can give at 100 Hz); median and worst run. A drift has no such moment: its seconds count from the start.
* error: root mean square in degrees over the headings that there are, median and worst run.
* 1 sigma, 2 sigma: percent of the errors within one and two of the sigmas published with them. 68 and 95 are right.
* beyond: the longest time without a break, in seconds, in which the status is `Tracking` and the error beyond three sigmas; worst run.
* missed: changes that no event of the right kind tells within 20 s, of all runs. false: events that belong to no change, in all runs.
";

impl EvaluateResult {
    /// A table for each group.
    #[must_use]
    pub fn tables(&self) -> Vec<Table> {
        self.groups.iter().map(GroupResult::table).collect()
    }

    /// The whole page, docs/EVALUATION.md.
    #[must_use]
    pub fn markdown(&self) -> String {
        let skew =
            if self.gyro_skew_deg > 0.0 { format!(" --gyro-skew {}", self.gyro_skew_deg) } else { String::new() };
        let command = format!("magcomp evaluate --runs {} --seed {}{skew} --markdown", self.runs, self.seed);
        let tables: String = self.tables().iter().map(|table| format!("## {}\n", table.markdown())).collect();
        let lines =
            || self.groups.iter().flat_map(|group| group.situations.iter().map(move |line| (group.title, line)));
        let faults = |fault: &dyn Fn(&SituationResult) -> Option<String>| {
            let found: String = lines()
                .filter_map(|(group, line)| fault(line).map(|text| format!("* {}: {text} ({group})\n", line.name)))
                .collect();
            if found.is_empty() { "None.\n".to_owned() } else { found }
        };
        let beyond = faults(&|line| {
            (line.tracking_beyond_s > MOST_BEYOND_S).then(|| format!("{:.1} s", line.tracking_beyond_s))
        });
        let narrow = faults(&|line| {
            let [_, two] = line.within_sigma?;
            (two < LEAST_WITHIN_TWO).then(|| format!("{:.0} % within two sigmas", 100.0 * two))
        });
        let never = faults(&|line| {
            let settled = line.settled_s.median.is_none();
            settled.then(|| format!("answered {:.0} % of the time", 100.0 * line.answered))
        });
        let events = faults(&|line| {
            let is_wrong = line.missed > 0 || line.false_events > 0;
            is_wrong.then(|| {
                format!("{} of {} changes missed, {} false events", line.missed, line.changes, line.false_events)
            })
        });
        format!(
            "# Evaluation\n\nMade by `{command}` ({} runs a line); do not edit.\n\n{NOTES}\n{tables}## Where it is bad\n\n\
             The status is `Tracking` and the error beyond three sigmas for more than {MOST_BEYOND_S} s, worst run:\n\n{beyond}\n\
             Less than {:.0} % of the errors lie within two sigmas:\n\n{narrow}\n\
             The median run never stays below 5 degrees:\n\n{never}\n\
             Events, in all {} runs:\n\n{events}",
            self.runs,
            100.0 * LEAST_WITHIN_TWO,
            self.runs,
        )
    }
}

impl GroupResult {
    fn table(&self) -> Table {
        let columns = [
            "",
            "answered %",
            "< 5 deg after s",
            "worst",
            "error deg",
            "worst",
            "1 sigma %",
            "2 sigma %",
            "beyond s",
            "missed",
            "false",
        ];
        let mut table = Table::new(self.title, &columns);
        for line in &self.situations {
            let within = |k: usize| number(line.within_sigma.map(|within| 100.0 * within[k]), 0);
            let seconds = |value: Option<f64>| value.map_or_else(|| "never".to_owned(), |value| format!("{value:.1}"));
            table.row(vec![
                line.name.clone(),
                format!("{:.0}", 100.0 * line.answered),
                seconds(line.settled_s.median),
                seconds(line.settled_s.worst),
                number(line.error_deg.median, 1),
                number(line.error_deg.worst, 1),
                within(0),
                within(1),
                format!("{:.1}", line.tracking_beyond_s),
                if line.changes > 0 { format!("{} of {}", line.missed, line.changes) } else { "-".to_owned() },
                line.false_events.to_string(),
            ]);
        }
        table
    }
}
