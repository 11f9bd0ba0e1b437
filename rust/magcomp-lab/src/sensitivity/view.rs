//! The page docs/dev/TUNING.md.

use super::score::{Kind, MOVED, MOVED_IN_A_GROUP, Moved, Moves, Unit, Way, absolute_deg};
use crate::catalogue::{Group, Variant};
use magcomp::{Choice, Mechanism};
use magcomp_replay::table::Table;
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

/// A choice, a mechanism, or two that read the same state.
#[derive(Clone, Copy)]
pub(super) enum Subject {
    Choice(&'static Choice),
    Mechanism(&'static Mechanism),
    Pair(&'static Mechanism, &'static Mechanism),
}

/// One of them, in one way.
pub(super) struct Row {
    pub part: &'static str,
    pub subject: Subject,
    pub way: Way,
    /// Half and double, off, or both off beyond the sum of each.
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
    pub fn name(self) -> String {
        match self {
            Self::Choice(choice) => choice.name.to_owned(),
            Self::Mechanism(mechanism) => mechanism.name.to_owned(),
            Self::Pair(one, other) => format!("{} + {}", one.name, other.name),
        }
    }

    /// Whether it is this mechanism.
    pub fn is(self, mechanism: &Mechanism) -> bool {
        matches!(self, Self::Mechanism(own) if own == mechanism)
    }

    fn kind(self) -> &'static str {
        match self {
            Self::Choice(_) => "choice",
            Self::Mechanism(_) => "mechanism",
            Self::Pair(..) => "pair",
        }
    }

    /// What its settings are called, in their order.
    fn settings(self) -> &'static [&'static str] {
        match self {
            Self::Choice(_) => &["half", "double"],
            Self::Mechanism(_) => &["off"],
            Self::Pair(..) => &["both off beyond each"],
        }
    }

    fn value(self) -> String {
        match self {
            Self::Choice(choice) => format!("{}", choice.value),
            Self::Mechanism(_) | Self::Pair(..) => "on".to_owned(),
        }
    }
}

const COLUMNS: [&str; 6] = ["part", "choice or mechanism", "value", "tried", "what moves", "what it is"];
/// A row says in so many words what it is of.
const WORDS: usize = 12;
/// The columns of the CSV.
const CSV: &str = "part,name,kind,value,unit,tried,setting,figure,by,noise,moves";
/// Digits of its numbers behind the point.
const DIGITS: usize = 4;

pub(super) fn page(found: &Found<'_>) -> Table {
    let mut table = Table::new("# Choices of the estimators, and what each is worth", &COLUMNS);
    table.left = true;
    table.lead.push(summary(&found.rows));
    let ways = found.variants.iter().map(|(way, _)| usual(*way, &found.units));
    table.lead.push(ways.collect::<Vec<_>>().join(" "));
    table.lead.push(made(found));
    found
        .rows
        .iter()
        .filter(|row| row.moves.iter().any(|it| !it.moved().is_empty()))
        .for_each(|row| table.row(cells(row)));
    table.note(&format!(
        "A row: a choice halved / doubled, the estimator without the mechanism, or without two, against the usual one. Of two: what leaving out both changes \
         beyond the sum of what each does. The magnetometer alone begins each recording at 0, 3, 6, 9 and 12 s. A row is here if a figure moves by more than \
         {MOVED} times its noise, and by 1 %; that of the group that moves most by {MOVED_IN_A_GROUP} times. By chance one figure in twenty does. All rows: \
         docs/data/tuning.csv.",
    ));
    table.note(
        "All is judged from 20 s on. error: root mean square of a stream's published heading, of a recording but for one constant, at most 30 deg, which counts \
         where there is none; geometric mean. z2: mean square of error over sigma, 1 where sigma is right; geometric mean. recorded: of the recordings; false \
         steps: their device steps an hour that no magnet explains; worst: the largest error with the constant left in. magnets: put on those recordings that \
         have none (arithmetic), from 5 s after the change on; their steps: missed, told again or false, an hour. After +-: the noise of the change, by streams \
         that differ in their seed alone, or by recordings; of the worst, how far the third worst is from it.",
    );
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
    let of = |kind: &'static str| all.iter().filter(move |(_, it, _)| it.kind() == kind);
    let still = |kind: &'static str| {
        let names = of(kind).filter(|(_, _, moves)| !moves).map(|(part, it, _)| format!("{part} {}", it.name()));
        let names: Vec<String> = names.collect();
        let list = if names.is_empty() || kind == "pair" { String::new() } else { format!(" ({})", names.join(", ")) };
        format!("{}{list}", names.len())
    };
    format!(
        "Tried were {} choices, {} mechanisms that can be switched off and {} pairs of these that read the same state. {} of the choices and {} of the \
         mechanisms move nothing; {} of the pairs do no more than the sum of both.",
        of("choice").count(),
        of("mechanism").count(),
        of("pair").count(),
        still("choice"),
        still("mechanism"),
        still("pair"),
    )
}

/// All figures of all rows, a line each: those of logarithms in percent.
pub(super) fn csv(rows: &[Row]) -> String {
    let mut text = format!("{CSV}\n");
    for row in rows {
        let Row { part, subject, way, .. } = row;
        let unit = if let Subject::Choice(choice) = subject { choice.unit } else { "" };
        for (moves, setting) in row.moves.iter().zip(subject.settings()) {
            let moved = moves.moved();
            for (name, (by, noise)) in figures(moves) {
                let number = |value: f64| if value.is_finite() { format!("{value:.DIGITS$}") } else { String::new() };
                let (name_of, value, kind, way) = (subject.name(), subject.value(), subject.kind(), way.name());
                let is_moved = u8::from(moved.contains(&name));
                text += &format!(
                    "{part},{name_of},{kind},{value},{unit},{way},{setting},{name},{},{},{is_moved}\n",
                    number(by),
                    number(noise)
                );
            }
        }
    }
    text
}

/// Each figure that there is, with its noise: logarithms in percent.
fn figures(moves: &Moves) -> Vec<(&'static str, (f64, f64))> {
    let percent = |moved: Moved| (100.0 * moved.by.exp_m1(), 100.0 * moved.noise.exp_m1());
    let plain = |moved: Moved| (moved.by, moved.noise);
    let of = |both: Option<[Moved; 2]>, at: usize| both.map(|both| percent(both[at]));
    let found = [
        ("error", of(moves.streams, 0)),
        ("z2", of(moves.streams, 1)),
        ("a group", moves.most.as_ref().map(|(_, _, moved)| percent(*moved))),
        ("recorded error", of(moves.trials, 0)),
        ("recorded z2", of(moves.trials, 1)),
        ("false steps", moves.false_per_h.map(plain)),
        ("worst", moves.worst_deg.map(plain)),
        ("magnets' error", of(moves.magnets, 0)),
        ("magnets' z2", of(moves.magnets, 1)),
        ("magnets' steps", moves.wrong_per_h.map(plain)),
    ];
    found.into_iter().filter_map(|(name, moved)| Some((name, moved?))).collect()
}

/// The figures of the usual setting.
fn usual(way: Way, units: &[Unit]) -> String {
    let of = |kind: Kind| units.iter().filter(move |unit| unit.way == way && unit.kind == kind);
    let mut text = vec![format!("Usual, {}:", way.name())];
    for (kind, name) in [(Kind::Stream, "groups"), (Kind::Trial, "recordings"), (Kind::Magnet, "magnets")] {
        let count = of(kind).count();
        if count == 0 {
            continue;
        }
        // each variant has as many seeds
        let mean = |figure: fn(&Unit) -> f64| (of(kind).map(figure).sum::<f64>() / count as f64).exp();
        let (error, z2) = (mean(|unit| unit.outcomes[0].error), mean(|unit| unit.outcomes[0].z2));
        text.push(format!("{name} ({count} streams) error {error:.2} deg, z2 {z2:.2};"));
    }
    let trials: Vec<&Unit> = of(Kind::Trial).collect();
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
    let what = match row.subject {
        Subject::Choice(choice) => choice.meaning,
        Subject::Mechanism(mechanism) => mechanism.meaning,
        Subject::Pair(..) => "",
    };
    let words: Vec<&str> = what.split_whitespace().collect();
    let what = words[..words.len().min(WORDS)].join(" ");
    let moved = |moves: &Moves| {
        let told = figures(moves).into_iter().filter(|(name, _)| moves.moved().contains(name));
        let told = told.map(|(name, (by, noise))| match (name, &moves.most) {
            ("a group", Some((group, figure, _))) => format!("{group}: {figure} {} %", shown(by, noise, 0)),
            ("false steps" | "magnets' steps", _) => format!("{name} {} /h", shown(by, noise, 1)),
            ("worst", _) => format!("{name} {} deg", shown(by, noise, 1)),
            _ => format!("{name} {} %", shown(by, noise, 0)),
        });
        let told: Vec<String> = told.collect();
        if told.is_empty() { "-".to_owned() } else { told.join(", ") }
    };
    let moves = row.moves.iter().map(moved).collect::<Vec<_>>().join(" / ");
    let unit = if let Subject::Choice(choice) = row.subject { choice.unit } else { "" };
    let value = format!("{} {unit}", row.subject.value()).trim_end().to_owned();
    vec![row.part.to_owned(), row.subject.name(), value, row.way.name().to_owned(), moves, what]
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

    /// Each with its part.
    type Named<T> = Vec<(&'static str, T)>;

    fn all() -> (Named<Subject>, Named<&'static Mechanism>) {
        let choices = Tunings::list().map(|(part, choice)| (part, Subject::Choice(choice)));
        (choices.collect(), Tunings::mechanisms().collect())
    }

    #[test]
    fn a_row_tells_what_moves_with_its_noise_and_the_csv_all() {
        let (part, subject) = all().0[0];
        let Subject::Choice(choice) = subject else { panic!("a choice") };
        let found = cells(&row(part, subject, Way::Alone, &[0.0953, -0.03]));
        let value = format!("{} {}", choice.value, choice.unit).trim_end().to_owned();
        assert_eq!(found[..4], [part, choice.name, &value, "alone"]);
        assert_eq!((found[4].as_str(), found.len()), ("error +10 +- 1 % / error -3.0 +- 1.0 %", COLUMNS.len()));
        assert!(found[5].split(' ').count() <= WORDS && choice.meaning.trim().starts_with(&found[5]), "{}", found[5]);
        assert_eq!(shown(0.5, f64::INFINITY, 1), "+0.50 +- ?");
        let lines = csv(&[row(part, subject, Way::Alone, &[0.0953, 0.0])]);
        let lines: Vec<&str> = lines.lines().collect();
        // two settings of two figures
        assert_eq!((lines[0], lines.len()), (CSV, 5));
        let begins = format!("{part},{},choice,{},{},alone,", choice.name, choice.value, choice.unit);
        assert_eq!(lines[1], format!("{begins}half,error,9.9989,1.0050,1"));
        assert_eq!(lines[4], format!("{begins}double,z2,0.0000,1.0050,0"));
    }

    /// A choice that is tried in two ways is one, and moves something where it does so in either; rows that move nothing are not on the page.
    #[test]
    fn the_summary_counts_what_moves_nothing_anywhere() {
        let (choices, mechanisms) = all();
        let (first, second, (part, mechanism)) = (choices[0], choices[1], mechanisms[0]);
        let pair = Subject::Pair(mechanism, mechanisms[1].1);
        let rows = vec![
            row(first.0, first.1, Way::WithGyroscope, &[0.0, 0.0]),
            row(first.0, first.1, Way::Alone, &[0.0, 0.5]),
            row(second.0, second.1, Way::Alone, &[0.019, 0.0]),
            row(part, Subject::Mechanism(mechanism), Way::Alone, &[0.3]),
            row(part, pair, Way::Alone, &[0.0]),
        ];
        let expected = format!(
            "Tried were 2 choices, 1 mechanisms that can be switched off and 1 pairs of these that read the same state. 1 ({} {}) of the choices and 0 of the \
             mechanisms move nothing; 1 of the pairs do no more than the sum of both.",
            second.0,
            second.1.name()
        );
        assert_eq!(summary(&rows), expected);
        let (recordings, groups, only) = Default::default();
        let options = SensitivityOptions { recordings, index: None, groups, only, switches: false, seeds: 1..=4 };
        let found = Found { options: &options, rows, units: Vec::new(), variants: Vec::new(), samples: 0 };
        let shown: Vec<String> = page(&found).rows.into_iter().map(|row| format!("{} {}", row[1], row[4])).collect();
        assert_eq!(shown.len(), 2, "{shown:?}");
        assert!(shown[0].ends_with("- / error +65 +- 1 %") && shown[1].ends_with("error +35 +- 1 %"), "{shown:?}");
    }
}
