//! Trials as tables: a row a recording, then a row a group.

use super::figures::{FIGURES, Figure, Worse};
use super::score::{GroupScore, Score, Summary, Trials};
use magcomp_replay::error::RunError;
use magcomp_replay::plot::{Colour, DotRow, Dots};
use magcomp_replay::report::Report;
use magcomp_replay::table::{Table, number};

impl Trials {
    /// The table of the recordings, then that of the groups.
    pub fn tables(&self) -> [Table; 2] {
        [recordings(&self.recordings), groups(&self.groups)]
    }

    /// Adds a picture and the tables to a report, the groups first.
    pub fn add_to(&self, report: &mut Report) -> Result<(), RunError> {
        let row = |group: &GroupScore| {
            let own = self.recordings.iter().filter(|score| score.group == group.group);
            let values = own.filter_map(|score| score.figures["heading_rms_deg"]).collect();
            DotRow { name: group.group.clone(), values, colour: Colour::Blue }
        };
        let rows = self.groups.iter().map(row).collect();
        let x_label = "error, rms up to one constant, deg";
        let dots = Dots::new("published heading", "a recording", x_label, rows, false);
        report.figure("groups", dots.draw()?, "Errors of the published heading by groups");
        self.tables().iter().rev().for_each(|table| report.table(table));
        Ok(())
    }
}

fn recordings(scores: &[Score]) -> Table {
    let columns = FIGURES.iter().map(|figure| figure.column);
    let columns: Vec<&str> = ["recording", "group"].into_iter().chain(columns).collect();
    let mut table = Table::new("Recordings against their reference", &columns);
    for score in scores {
        let cells = FIGURES.iter().map(|figure| cell(figure, score.figures[figure.name]));
        table.row([score.recording.clone(), score.group.clone()].into_iter().chain(cells).collect());
    }
    table
}

fn groups(groups: &[GroupScore]) -> Table {
    let summed = || FIGURES.iter().filter(|figure| figure.worse != Worse::Neither);
    let columns = summed().map(|figure| figure.column);
    let columns: Vec<&str> = ["group", "n", "steps/h in all"].into_iter().chain(columns).collect();
    let mut table = Table::new("Groups: median / nine of ten are not worse / worst", &columns);
    for group in groups {
        let cells = summed().map(|figure| {
            let of = |value: fn(Summary) -> f64| cell(figure, group.figures[figure.name].map(value));
            [of(|summary| summary.median), of(|summary| summary.p90), of(|summary| summary.worst)].join("/")
        });
        let steps = number(Some(group.device_steps as f64 / group.hours), 1);
        table.row([group.group.clone(), group.recordings.to_string(), steps].into_iter().chain(cells).collect());
    }
    table.note(
        "Angles in degrees, over rows after 20 s with a reference. heading, p95, c, f: rms (95th percentile) of the error of the published heading, of \
         the corrected sample and of the carried field, up to one constant; constant: the one of the published heading, positive clockwise. bound: what \
         the best carrier between the place's unevenness and the gyroscope's drift could have, both by the reference; / bound: heading over it. \
         absolute, abs.: rms without taking it out. The published heading counts where its axis, the top edge, is within 60 deg of the \
         horizontal, in 100 rows at least.",
    );
    table.note(
        "in 1 s, in 2 s: absolute errors within one and two published sigmas (68 and 95 are right). z^2: mean square of error over sigma, each at \
         most 100 (1 is right, less is too wide). sigma: its median. lie: longest time of status tracking with an error beyond three sigmas; breaks \
         under 0.2 s do not end it. steps/h: device steps declared. first: until the first heading. answered: of the judged rows.",
    );
    table
}

fn cell(figure: &Figure, value: Option<f64>) -> String {
    let (times, digits) = figure.shown;
    number(value.map(|value| value * times), digits)
}
