//! Magnets put on recordings, as a table: a row for each group and magnet.

use super::figures::Worse;
use super::magnets::{MAGNETS, MagnetScore, MagnetTrials};
use super::score::Summary;
use magcomp_replay::error::RunError;
use magcomp_replay::plot::{Colour, DotRow, Dots};
use magcomp_replay::report::Report;
use magcomp_replay::table::{Table, number};

const COLUMNS: [&str; 15] = [
    "group",
    "magnet",
    "n",
    "before",
    "after",
    "settled",
    "worst",
    "answered %",
    "in 2 s %",
    "z^2",
    "lie s",
    "told after s",
    "missed",
    "again /h",
    "b off uT",
];

impl MagnetTrials {
    /// A row for each group and magnet.
    pub fn table(&self) -> Table {
        let mut table = Table::new(&format!("Magnets put on recordings: {}", self.label), &COLUMNS);
        for (group, magnet) in self.groups.iter().flat_map(|group| MAGNETS.iter().map(move |it| (group, it.name))) {
            let own: Vec<&MagnetScore> =
                self.runs.iter().filter(|run| run.group == *group && run.magnet == magnet).collect();
            if !own.is_empty() {
                table.row(cells(group, magnet, self.label, &own));
            }
        }
        table.note(
            "A hard iron of this size (and soft iron) in a random direction is added to the raw samples of each recording, from a time drawn between 45 and 60 % of \
             it on; no saturation, no change of other sensors. Median / nine of ten are not worse / worst of the recordings; of told after s, of the changes \
             that are told. before: error of the published heading over the 10 s before the magnet; after: from it on; settled: from 5 s after the end of the \
             change on; rms in degrees, less the constant that the rows from 20 s to the magnet have. worst: its largest error from the magnet on. Where nothing \
             is put on: the second half.",
        );
        table.note(
            "in 2 s: errors within two published sigmas (95 is right). z^2: mean square of error over sigma (1 is right). lie: longest time of status tracking with \
             an error beyond three sigmas. told after: until a device step says so. missed: changes that none does. again: steps an hour that tell a change \
             twice, or a change that is none (false). b off: hard iron at the end, less what it was before and what was added.",
        );
        table
    }

    /// Adds a picture of each group and the table to a report.
    pub fn add_to(&self, report: &mut Report) -> Result<(), RunError> {
        let groups = self.groups.iter().filter(|group| self.runs.iter().any(|run| run.group == **group));
        for (k, group) in groups.enumerate() {
            let row = |name: &'static str| {
                let own = self.runs.iter().filter(|run| run.group == *group && run.magnet == name);
                let values = own.filter_map(|run| run.figures.error.heading_deg).collect();
                DotRow { name: name.to_owned(), values, colour: Colour::Blue }
            };
            let rows = MAGNETS.iter().map(|magnet| row(magnet.name)).filter(|row| !row.values.is_empty()).collect();
            let x_label = "error of the published heading from the magnet on, rms, deg";
            let dots = Dots::new(group, "a recording", x_label, rows, true);
            report.figure(&format!("magnets{}", k + 1), dots.draw()?, &format!("{group}: {}", self.label));
        }
        report.table(&self.table());
        Ok(())
    }
}

fn cells(group: &str, magnet: &str, label: &str, own: &[&MagnetScore]) -> Vec<String> {
    let three = |values: Vec<f64>, worse, digits| {
        let cell = |value| number(Some(value), digits);
        Summary::of(values, worse)
            .map_or_else(|| "-".to_owned(), |it| [it.median, it.p90, it.worst].map(cell).join("/"))
    };
    let of = |value: fn(&MagnetScore) -> Option<f64>, worse, digits| {
        three(own.iter().filter_map(|run| value(run)).collect(), worse, digits)
    };
    let sum = |count: fn(&MagnetScore) -> usize| own.iter().map(|run| count(run)).sum::<usize>();
    let hours: f64 = own.iter().map(|run| run.hours).sum();
    let due = sum(|run| run.figures.due);
    vec![
        group.to_owned(),
        if magnet == MAGNETS[0].name { magnet.to_owned() } else { format!("{magnet} ({label})") },
        own.len().to_string(),
        of(|run| run.figures.before.heading_deg, Worse::Large, 1),
        of(|run| run.figures.error.heading_deg, Worse::Large, 1),
        of(|run| run.settled_deg, Worse::Large, 1),
        of(|run| run.worst_deg, Worse::Large, 1),
        of(|run| run.figures.answered.map(|share| 100.0 * share), Worse::Small, 0),
        of(|run| run.figures.within.map(|[_, two]| 100.0 * two), Worse::Small, 0),
        of(|run| run.figures.z2, Worse::Large, 2),
        of(|run| Some(run.figures.lie_s), Worse::Large, 1),
        three(own.iter().flat_map(|run| run.told_s.iter().flatten().copied()).collect(), Worse::Large, 1),
        if due > 0 { format!("{} of {due}", sum(|run| run.figures.missed)) } else { "-".to_owned() },
        number(Some(sum(|run| run.figures.again + run.figures.false_steps) as f64 / hours), 1),
        of(|run| run.hard_iron_off_ut, Worse::Large, 1),
    ]
}
