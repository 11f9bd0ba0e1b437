//! The output of `magcomp evaluate`: a table for each group, and a list of the bad lines.

use super::evaluate::{EvaluateResult, GroupResult, VariantResult};
use crate::error::LabError;
use crate::plot::{Colour, DotRow, Dots};
use crate::report::Report;
use crate::table::{Table, number};

/// Characters of a line of the page, but of its tables.
const WIDTH: usize = 160;
/// A line is bad when less than this share of the errors lies within two sigmas (95 % is right) ...
const LEAST_WITHIN_TWO: f64 = 0.90;
/// ... when a lie lasts longer than this, s ...
const MOST_LIE_S: f64 = 1.0;
/// ... or when there are more false device steps an hour than this.
const MOST_FALSE_PER_H: f64 = 10.0;

/// Seeds from here on judge: nobody runs them while developing.
const LEAST_JUDGED: u64 = 10_000;

/// What the columns mean, in short.
const LEGEND: [&str; 2] = [
    "answered: share of the samples with a heading. < 5 deg: seconds from a change, or from the start, until the heading stays right to 5 degrees; \
     median and worst run. error: rms of the heading against the truth, median and worst run. 1 sigma, 2 sigma: errors within one and two sigmas; 68 \
     and 95 are right. z2: mean square of error over sigma; 1 is right.",
    "f: angle between the carried field and the Earth's, calibration: that of a sample by the calibration; median runs. lie: longest time of status \
     tracking with an error beyond three sigmas. missed: changes of the device that are not told. false: changes told that did not happen. lost: changes \
     after which the carried field is still wrong by 5 degrees when the next comes.",
];

/// What the columns mean.
const NOTES: &str = "\
* This page uses random seeds above 10 000, which nobody runs while developing. It is made once a release and published as it comes out.
* Each run has its own device, motion and noise, and a cold start; each sample is answered before the next is seen. The config is the default, with
  headings of the automatic axis. Phones have 60 s at 100 Hz, a field of 50 uT with a dip of 60 degrees, white noise of 0.5 uT, and what happens,
  happens at 30 s. Carried phones have 80 s and more, the errors and delays that sensors of phones have, and accelerations of the motion; their device
  changes at 40 s where not said otherwise. `magcomp evaluate --list` has the names, and the lab's `catalogue` the data.
* Places are no more even than rooms: 1 to 1.5 uT on each axis along a way through the whole room, with the spectrum that walks with motion capture have
  (the lab's `surroundings` says how it was measured), less the mean of the run's own way. A device at rest has a constant field, one in a car the same
  unevenness eight times as long, a guess. Where a line tells the unevenness there is no other; two lines say that the place is even, and the paper's are.
* The lab's `score` defines each word. All is judged from 20 s on, where it does not say otherwise.
* In the groups from swinging fields to gyroscopes at fault a line is one thing that users met, made up, in two or more ways of carrying; the device does not
  change where it is not said. The lab's tests hold that each stream is what its line says, not that its figures are good.
* answered: share of the samples with a heading, percent, but for those whose x axis is steep.
* < 5 deg: seconds from a change, or from the start where the device does not change, until the 95th percentile of the heading's error over the
  trailing second stays below 5 degrees, up to the next change or the end (1.0 s is the least that this measure can give); median and worst of all
  changes. Without an accelerometer there is no heading, and this is the calibration's error.
* error: root mean square of the published heading against the truth in the Earth's field, degrees, median and worst run.
* 1 sigma, 2 sigma: percent of the errors within one and two of the sigmas published with them; 68 and 95 are right. z2: the mean square of error over
  sigma; 1 is right. sigma: its median, degrees.
* f: root mean square of the angle between the carried field and the Earth's, degrees, median run. calibration: that between what the calibration
  makes of the sample without noise and the field there.
* lie: the longest time, in seconds, in which the status is `Tracking` and the error beyond three sigmas; worst run.
* missed: how many changes of the device, of 5 uT at least, are not told. false: how many changes an hour are told that did not happen. lost: how often the
  carried field (without a gyroscope the calibration) is still more than 5 degrees wrong when the next change comes or the run ends.
";

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
    pub fn add_to(&self, report: &mut Report) -> Result<(), LabError> {
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

    /// The whole page, docs/EVALUATION.md.
    pub fn markdown(&self) -> String {
        let (first, last) = self.seeds;
        let tables: String = self.tables().iter().map(|table| format!("## {}\n", table.markdown())).collect();
        let lines = || self.groups.iter().flat_map(|group| group.variants.iter().map(move |line| (group.title, line)));
        let faults = |fault: &dyn Fn(&VariantResult) -> Option<String>| {
            let found: String = lines()
                .filter_map(|(group, one)| {
                    let told = format!("* {}: {}", one.about, fault(one)?);
                    let between = if told.len() + group.len() + " ()".len() > WIDTH { "\n  " } else { " " };
                    Some(format!("{told}{between}({group})\n"))
                })
                .collect();
            if found.is_empty() { "None.\n".to_owned() } else { found }
        };
        let lies = faults(&|one| (one.line.lie_s > MOST_LIE_S).then(|| format!("{:.1} s", one.line.lie_s)));
        let narrow = faults(&|one| {
            let [_, two] = one.line.within?;
            (two < LEAST_WITHIN_TWO).then(|| format!("{:.0} % within two sigmas", 100.0 * two))
        });
        let never = faults(&|one| {
            let settled = one.line.settled_s.median.is_none();
            settled.then(|| format!("answered {:.0} % of the time", 100.0 * one.line.answered.unwrap_or(0.0)))
        });
        let events = faults(&|one| {
            let line = &one.line;
            let is_wrong = line.missed > 0 || line.false_per_h > MOST_FALSE_PER_H;
            is_wrong.then(|| {
                format!("{} of {} changes missed, {:.0} false steps an hour", line.missed, line.due, line.false_per_h)
            })
        });
        let option = if first >= LEAST_JUDGED { "--judge".to_owned() } else { format!("--seeds {first}-{last}") };
        format!(
            "# Evaluation\n\nMade by `magcomp evaluate {option} --markdown` ({} runs a line); do not edit.\n\n{NOTES}\n\
             {tables}## Where it is bad\n\n\
             A lie lasts more than {MOST_LIE_S} s, worst run:\n\n{lies}\n\
             Less than {:.0} % of the errors lie within two sigmas:\n\n{narrow}\n\
             The median run never stays below 5 degrees:\n\n{never}\n\
             A change is missed, or there are more than {MOST_FALSE_PER_H} false device steps an hour:\n\n{events}",
            last - first + 1,
            100.0 * LEAST_WITHIN_TWO,
        )
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
