//! The output of `magcomp evaluate`: a table for each group, pictures, and every line as CSV.

use super::evaluate::{EvaluateResult, GroupResult, VariantResult};
use magcomp_replay::error::RunError;
use magcomp_replay::plot::{Colour, DotRow, Dots};
use magcomp_replay::report::Report;
use magcomp_replay::table::{Table, number};

/// What the columns mean, in short.
const LEGEND: [&str; 2] = [
    "answered: share of the samples with a heading. < 5 deg: seconds from a change, or from the start, until the heading stays right to 5 degrees; \
     median and worst run. error: rms of the heading against the truth, median and worst run. 1 sigma, 2 sigma: errors within one and two sigmas; 68 \
     and 95 are right. z2: mean square of error over sigma; 1 is right.",
    "f: angle between the carried field and the Earth's, calibration: that of a sample by the calibration; median runs. lie: longest time of status \
     tracking with an error beyond three sigmas. missed: changes of the device that are not told. false: changes told that did not happen. lost: changes \
     after which the carried field is still wrong by 5 degrees when the next comes.",
];

/// Columns of the CSV, each with its unit; docs/EVALUATION.md says what they mean.
const CSV: &str = "group,situation,name,answered_percent,settled_median_s,settled_worst_s,error_median_deg,error_worst_deg,within_1_sigma_percent,\
                   within_2_sigma_percent,z2,sigma_deg,carried_deg,calibration_deg,lie_s,missed,due,false_per_h,lost,stretches";

impl EvaluateResult {
    /// A table for each group.
    pub fn tables(&self) -> Vec<Table> {
        self.groups.iter().map(GroupResult::table).collect()
    }

    /// The same with what the columns mean below the last.
    pub fn told(&self) -> Vec<Table> {
        let mut tables = self.tables();
        if let Some(last) = tables.last_mut() {
            LEGEND.iter().for_each(|text| last.note(text));
        }
        tables
    }

    /// Adds a picture and a table for each group to a report.
    pub fn add_to(&self, report: &mut Report) -> Result<(), RunError> {
        for (k, (group, table)) in self.groups.iter().zip(self.told()).enumerate() {
            let row = |variant: &VariantResult| {
                let values = variant.runs.iter().filter_map(|run| run.error.heading_deg).collect();
                DotRow { name: variant.about.clone(), values, colour: Colour::Blue }
            };
            let rows: Vec<DotRow> = group.variants.iter().map(row).filter(|row| !row.values.is_empty()).collect();
            if !rows.is_empty() {
                let x_label = "error of the published heading, rms, deg";
                let dots = Dots::new(group.title, "a run", x_label, rows, false);
                report.figure(
                    &format!("group{}", k + 1),
                    dots.draw()?,
                    &format!("{}: errors of the published heading", group.title),
                );
            }
            report.table(&table);
        }
        Ok(())
    }

    /// Every line as CSV, docs/data/evaluation.csv. An empty cell: nothing was judged; `never` in seconds: not before the end.
    pub fn csv(&self) -> String {
        let mut out = format!("{CSV}\n");
        for (group, one) in self.groups.iter().flat_map(|group| group.variants.iter().map(move |one| (group, one))) {
            let line = &one.line;
            let cell =
                |value: Option<f64>, digits: usize| value.map_or_else(String::new, |value| format!("{value:.digits$}"));
            let percent = |share: Option<f64>| cell(share.map(|share| 100.0 * share), 0);
            let seconds = |value: Option<f64>| value.map_or_else(|| "never".to_owned(), |value| format!("{value:.1}"));
            let cells = [
                format!("\"{}\"", group.title),
                format!("\"{}\"", one.about),
                one.name.clone(),
                percent(line.answered),
                seconds(line.settled_s.median),
                seconds(line.settled_s.worst),
                cell(line.heading_deg.median, 1),
                cell(line.heading_deg.worst, 1),
                percent(line.within.map(|within| within[0])),
                percent(line.within.map(|within| within[1])),
                cell(line.z2, 2),
                cell(line.sigma_deg, 1),
                cell(line.carried_deg.median, 1),
                cell(line.calibration_deg.median, 1),
                cell(Some(line.lie_s), 1),
                line.missed.to_string(),
                line.due.to_string(),
                cell(Some(line.false_per_h), 0),
                line.lost.to_string(),
                line.stretches.to_string(),
            ];
            out += &cells.join(",");
            out.push('\n');
        }
        out
    }
}

impl GroupResult {
    fn table(&self) -> Table {
        let heading =
            ["", "answered %", "< 5 deg after s", "worst", "error deg", "worst", "1 sigma %", "2 sigma %", "z2"];
        let others = ["sigma deg", "f deg", "calibration deg", "lie s", "missed", "false /h", "lost"];
        let mut table = Table::new(self.title, &[&heading[..], &others].concat());
        for VariantResult { about, line, .. } in &self.variants {
            let within = |k: usize| number(line.within.map(|within| 100.0 * within[k]), 0);
            let seconds = |value: Option<f64>| value.map_or_else(|| "never".to_owned(), |value| format!("{value:.1}"));
            let of = |count: usize, all: usize| if all > 0 { format!("{count} of {all}") } else { "-".to_owned() };
            table.row(vec![
                about.clone(),
                number(line.answered.map(|share| 100.0 * share), 0),
                seconds(line.settled_s.median),
                seconds(line.settled_s.worst),
                number(line.heading_deg.median, 1),
                number(line.heading_deg.worst, 1),
                within(0),
                within(1),
                number(line.z2, 2),
                number(line.sigma_deg, 1),
                number(line.carried_deg.median, 1),
                number(line.calibration_deg.median, 1),
                format!("{:.1}", line.lie_s),
                of(line.missed, line.due),
                format!("{:.0}", line.false_per_h),
                of(line.lost, line.stretches),
            ]);
        }
        table
    }
}
