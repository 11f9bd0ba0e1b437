//! The page docs/dev/TUNING.md.

use super::score::{MOVED, MOVED_IN_A_GROUP, Moved, Moves, Unit, Way, absolute_deg};
use crate::catalogue::{Group, Variant};
use crate::table::Table;
use magcomp::{Choice, Mechanism};
use std::ops::RangeInclusive;
use std::path::PathBuf;

/// What is tried, and on what.
#[derive(Clone, Debug)]
pub struct SensitivityOptions {
    /// Folders of recordings with a reference.
    pub recordings: Vec<PathBuf>,
    /// Groups and declinations of those that have no index of their own.
    pub index: Option<PathBuf>,
    /// Simulated groups; all when empty.
    pub groups: Vec<Group>,
    /// Parts of the names of choices and mechanisms; all when empty.
    pub only: Vec<String>,
    /// Mechanisms alone.
    pub switches: bool,
    /// A stream of each variant for each seed; two at least, or there is no noise.
    pub seeds: RangeInclusive<u64>,
}

/// A choice or a mechanism.
#[derive(Clone, Copy)]
pub(super) enum Subject {
    Choice(&'static Choice),
    Mechanism(&'static Mechanism),
}

/// One of them, in one way.
pub(super) struct Row {
    pub part: &'static str,
    pub subject: Subject,
    pub way: Way,
    /// Half and double, or off.
    pub moves: Vec<Moves>,
}

/// A page in the making.
pub(super) struct Found<'a> {
    pub options: &'a SensitivityOptions,
    pub rows: Vec<Row>,
    pub units: Vec<Unit>,
    pub variants: Vec<(Way, Vec<Variant>)>,
    /// Samples that were played.
    pub samples: usize,
}

impl Subject {
    pub fn name(self) -> &'static str {
        match self {
            Self::Choice(choice) => choice.name,
            Self::Mechanism(mechanism) => mechanism.name,
        }
    }
}

const COLUMNS: [&str; 15] = [
    "part",
    "choice or mechanism",
    "value",
    "unit",
    "tried",
    "groups: error %",
    "z2 %",
    "most in one group",
    "recordings: error %",
    "z2 %",
    "false steps /h",
    "worst deg",
    "what moves",
    "what it is",
    "source",
];
/// Of a row in which no figure moves, and in the summary.
const NOTHING: &str = "moves nothing";

pub(super) fn page(found: &Found<'_>) -> Table {
    let mut table = Table::new("# Choices of the estimators, and what each is worth", &COLUMNS);
    table.lead.push(summary(&found.rows));
    let ways = found.variants.iter().map(|(way, _)| usual(*way, &found.units));
    table.lead.push(ways.collect::<Vec<_>>().join(" "));
    table.lead.push(made(found));
    found.rows.iter().for_each(|row| table.row(cells(row)));
    table.note(&format!(
        "A row: a choice halved / doubled, or the estimator without the mechanism, against the usual one; with the gyroscope, or from magnetometer and \
         accelerometer alone, where a recording is begun at 0, 3, 6, 9 and 12 s. All is judged from 20 s on. Error: of the published heading, root mean \
         square of each stream, a recording's but for one constant, at most 30 deg, which counts where there is none; geometric mean. z2: mean square of error over sigma, 1 \
         where sigma is right; geometric mean. False steps: device steps of the recordings that no magnet explains. Worst: the largest error of a recording's \
         heading with the constant left in, deg. After +-: the noise of the change, by streams that differ in their seed alone, or by recordings; of the worst, \
         how far the third worst is from it. A figure moves by more than {MOVED} times its noise, and by 1 %; that of the group that moves most by {MOVED_IN_A_GROUP} times. \
         By chance one figure in twenty does.",
    ));
    table
}

/// How many there are, and which move nothing.
fn summary(rows: &[Row]) -> String {
    let mut all: Vec<(&str, Subject, bool)> = Vec::new();
    for row in rows {
        let moves = row.moves.iter().any(|moves| !moves.moved().is_empty());
        match all.iter_mut().find(|(part, it, _)| *part == row.part && it.name() == row.subject.name()) {
            Some((_, _, before)) => *before |= moves,
            None => all.push((row.part, row.subject, moves)),
        }
    }
    let of = |is_choice: bool| all.iter().filter(move |(_, it, _)| matches!(it, Subject::Choice(_)) == is_choice);
    let still = |is_choice: bool| {
        let names = of(is_choice).filter(|(_, _, moves)| !moves).map(|(part, it, _)| format!("{part} {}", it.name()));
        let names: Vec<String> = names.collect();
        let list = if names.is_empty() { String::new() } else { format!(" ({})", names.join(", ")) };
        format!("{}{list}", names.len())
    };
    format!(
        "{} choices and {} mechanisms that can be switched off were tried. Nothing anywhere is moved by {} of the choices and {} of the mechanisms.",
        of(true).count(),
        of(false).count(),
        still(true),
        still(false),
    )
}

/// The figures of the usual setting.
fn usual(way: Way, units: &[Unit]) -> String {
    let of = |is_trial: bool| units.iter().filter(move |unit| unit.way == way && unit.is_trial == is_trial);
    let mut text = vec![format!("Usual, {}:", way.name())];
    for (is_trial, name) in [(false, "groups"), (true, "recordings")] {
        let count = of(is_trial).count();
        if count == 0 {
            continue;
        }
        // each variant has as many seeds
        let mean = |figure: fn(&Unit) -> f64| (of(is_trial).map(figure).sum::<f64>() / count as f64).exp();
        let (error, z2) = (mean(|unit| unit.outcomes[0].error), mean(|unit| unit.outcomes[0].z2));
        text.push(format!(
            "{name} ({count} streams) error {error:.2} deg, z2 {z2:.2}{}",
            if is_trial { "," } else { ";" }
        ));
    }
    let trials: Vec<&Unit> = of(true).collect();
    let sum = |figure: fn(&Unit) -> f64| trials.iter().map(|unit| figure(unit)).sum::<f64>();
    if !trials.is_empty() {
        let steps = sum(|unit| unit.outcomes[0].false_steps) / sum(|unit| unit.outcomes[0].hours);
        text.push(format!("{steps:.1} false device steps an hour"));
    }
    if let Some((worst, name)) = absolute_deg(&trials, 0).first() {
        text.push(format!("and worst absolute heading {worst:.1} deg ({name})"));
    }
    format!("{}.", text.join(" ").trim_end_matches([';', ',']))
}

/// How the page was made.
fn made(found: &Found<'_>) -> String {
    let options = found.options;
    let (first, last) = (options.seeds.start(), options.seeds.end());
    let mut command = format!("cargo run --release -- sensitivity --seeds {first}-{last}");
    let mut add = |name: &str, value: &str| command += &format!(" {name} {value}");
    // the folder's own name: where it lies is not the page's business
    let folders = options.recordings.iter().filter_map(|path| path.file_name()).map(|name| name.to_string_lossy());
    folders.for_each(|name| add("--recordings", &name));
    options.index.iter().filter_map(|path| path.file_name()).for_each(|name| add("--index", &name.to_string_lossy()));
    options.groups.iter().for_each(|group| add("--group", &group.name()));
    options.only.iter().for_each(|name| add("--only", name));
    if options.switches {
        command += " --switches";
    }
    let tried = found.variants.iter().filter(|(_, variants)| !variants.is_empty()).map(|(way, variants)| {
        let names: Vec<&str> = variants.iter().map(|variant| variant.name.as_str()).collect();
        format!("{}: {}", way.name(), names.join(", "))
    });
    let tried: Vec<String> = tried.collect();
    format!(
        "Made by `{command}`, which plays {:.1} million samples and says how far it is. Seeds {first} to {last} of these variants: {}.",
        found.samples as f64 / 1e6,
        tried.join("; "),
    )
}

fn cells(row: &Row) -> Vec<String> {
    let (value, unit, what, source) = match row.subject {
        Subject::Choice(choice) => (format!("{}", choice.value), choice.unit, choice.meaning, choice.source),
        Subject::Mechanism(mechanism) => ("on".to_owned(), "", mechanism.meaning, ""),
    };
    let each = |cell: &dyn Fn(&Moves) -> String| row.moves.iter().map(cell).collect::<Vec<_>>().join(" / ");
    let both = |found: Option<[Moved; 2]>, at: usize| found.map_or_else(dash, |both| percent(&both[at]));
    let mut moved: Vec<&str> = Vec::new();
    for name in row.moves.iter().flat_map(Moves::moved) {
        if !moved.contains(&name) {
            moved.push(name);
        }
    }
    vec![
        row.part.to_owned(),
        row.subject.name().to_owned(),
        value,
        unit.to_owned(),
        row.way.name().to_owned(),
        each(&|it| both(it.streams, 0)),
        each(&|it| both(it.streams, 1)),
        each(&|it| {
            it.most.as_ref().map_or_else(dash, |(group, figure, moved)| format!("{group}: {figure} {}", percent(moved)))
        }),
        each(&|it| both(it.trials, 0)),
        each(&|it| both(it.trials, 1)),
        each(&|it| it.false_per_h.as_ref().map_or_else(dash, plain)),
        each(&|it| it.worst_deg.as_ref().map_or_else(dash, plain)),
        if moved.is_empty() { format!("*{NOTHING}") } else { moved.join(", ") },
        what.trim().to_owned(),
        source.to_owned(),
    ]
}

fn dash() -> String {
    "-".to_owned()
}

/// A change of a logarithm.
fn percent(moved: &Moved) -> String {
    let per_cent = |of: f64| 100.0 * of.exp_m1();
    shown(per_cent(moved.by), per_cent(moved.noise), 0)
}

fn plain(moved: &Moved) -> String {
    shown(moved.by, moved.noise, 1)
}

/// A change and its noise; 0 where nothing at all changes.
fn shown(by: f64, noise: f64, digits: usize) -> String {
    if by == 0.0 {
        return "0".to_owned();
    }
    // what would be shown as nothing needs a digit more
    let digits = if by.abs() < 9.5 * 10_f64.powi(-(digits as i32)) { digits + 1 } else { digits };
    let noise = if noise.is_finite() { format!("{noise:.digits$}") } else { "?".to_owned() };
    format!("{by:+.digits$} +- {noise}")
}

#[cfg(test)]
mod tests {
    use super::*;
    use magcomp::Tunings;

    fn row(part: &'static str, subject: Subject, way: Way, by: &[f64]) -> Row {
        let moved = |by: &f64| Moved { by: *by, noise: 0.01 };
        let moves = |by| Moves { streams: Some([moved(by), moved(&0.0)]), ..Moves::default() };
        Row { part, subject, way, moves: by.iter().map(moves).collect() }
    }

    #[test]
    fn a_row_tells_each_setting_with_its_noise_and_what_moves() {
        let (part, choice) = Tunings::list().next().unwrap();
        let found = cells(&row(part, Subject::Choice(choice), Way::Alone, &[0.0953, -0.03]));
        assert_eq!(found[..4], [part, choice.name, &choice.value.to_string(), choice.unit]);
        assert_eq!(found[4..8], ["alone", "+10 +- 1 / -3.0 +- 1.0", "0 / 0", "- / -"]);
        assert_eq!((found[12].as_str(), found.len()), ("error", COLUMNS.len()));
        let still = cells(&row(part, Subject::Choice(choice), Way::Alone, &[0.019, -0.019]));
        assert_eq!(still[12], "*moves nothing");
        assert_eq!(shown(0.5, f64::INFINITY, 1), "+0.50 +- ?");
    }

    /// A choice that is tried in two ways is one, and moves something where it does so in either.
    #[test]
    fn the_summary_counts_what_moves_nothing_anywhere() {
        let mut choices = Tunings::list().map(|(part, choice)| (part, Subject::Choice(choice)));
        let (first, second) = (choices.next().unwrap(), choices.next().unwrap());
        let mechanism = Tunings::mechanisms().map(|(part, it)| (part, Subject::Mechanism(it))).next().unwrap();
        let rows = [
            row(first.0, first.1, Way::WithGyroscope, &[0.0, 0.0]),
            row(first.0, first.1, Way::Alone, &[0.0, 0.5]),
            row(second.0, second.1, Way::Alone, &[0.019, 0.0]),
            row(mechanism.0, mechanism.1, Way::Alone, &[0.3]),
        ];
        let expected = format!(
            "2 choices and 1 mechanisms that can be switched off were tried. Nothing anywhere is moved by 1 ({} {}) of the choices and 0 of the mechanisms.",
            second.0,
            second.1.name()
        );
        assert_eq!(summary(&rows), expected);
    }
}
