//! The comparison as tables and as a picture.

use super::compare::{BOUND_AT, MethodScore, NO_ANSWER_DEG, TOLD_AT};
use super::compare_recording::RecordingScore;
use magcomp_replay::error::RunError;
use magcomp_replay::plot::{Colour, DotRow, Dots, Panel, Series, draw};
use magcomp_replay::report::Report;
use magcomp_replay::table::{Table, number};

/// Methods drawn, and how: of the magnetometer alone, and with gyroscope and accelerometer.
const DRAWN: [(&str, Colour); 11] = [
    ("adaptive", Colour::Blue),
    ("paper-half-range", Colour::Orange),
    ("extended", Colour::Green),
    ("unscented", Colour::Purple),
    ("linear", Colour::Red),
    ("constant", Colour::Grey),
    ("aided", Colour::Blue),
    ("aided-sample", Colour::Green),
    ("vqf-raw", Colour::Orange),
    ("vqf-corrected", Colour::Purple),
    ("fusion", Colour::Red),
];
/// The sensors that the methods of a table were given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Given {
    /// The magnetometer alone.
    Magnetometer,
    /// Gyroscope and accelerometer too.
    Inertial,
}

impl Given {
    /// The error that is judged.
    fn error(self) -> &'static str {
        match self {
            Self::Magnetometer => "direction error",
            Self::Inertial => "heading error with gyroscope and accelerometer",
        }
    }

    fn what(self) -> &'static str {
        match self {
            Self::Magnetometer => "magnetometer alone",
            Self::Inertial => "with gyroscope and accelerometer",
        }
    }
}

/// Largest error shown, degrees.
const SHOWN_DEG: f64 = 40.0;

/// A line for each method, the best of a column marked; and their error over the bound.
pub fn case_table(scenario: &str, runs: u32, methods: &[MethodScore], given: Given) -> Vec<Table> {
    if methods.is_empty() {
        return Vec::new();
    }
    let told = TOLD_AT.map(|k| format!("at {k}"));
    let mut columns = vec!["", "tuned", "before", "after", "steady"];
    columns.extend(told.iter().map(String::as_str));
    columns.extend(["< 5 deg s", "< 2 deg s", "< 1 deg s", "/ held", "us", "99.9 %", "max"]);
    let mut table = Table::new(&format!("{scenario}: {} rms, deg ({runs} runs)", given.error()), &columns);
    let best = |value: &dyn Fn(&MethodScore) -> f64| methods.iter().map(value).fold(f64::INFINITY, f64::min);
    let (best_after, best_steady) = (best(&|m| m.after_deg), best(&|m| m.steady_deg));
    let marked = |value: f64, best: f64| {
        let text = degrees(value, 2);
        if methods.len() > 1 && value <= best { format!("*{text}") } else { text }
    };
    for m in methods {
        let mut cells = vec![m.name.clone(), m.tuned.map_or_else(String::new, tuned)];
        cells.push(degrees(m.before_deg, 2));
        cells.extend([marked(m.after_deg, best_after), marked(m.steady_deg, best_steady)]);
        cells.extend(m.told_deg.iter().map(|v| degrees(*v, 2)));
        cells.extend(m.settled_s.map(|s| s.median.map_or_else(|| "never".to_owned(), |s| format!("{s:.1}"))));
        cells.push(number(Some(m.worst_over_held), 2));
        cells.extend(m.push_ns.map(|v| number(Some(v / 1000.0), 1)));
        table.row(cells);
    }
    table.note(
        "Tuned: the method's one free number. Before: the last 1000 samples before the change. After: all samples after it. Steady: \
         from 1000 samples after it on. *: the best of all. At n: n samples after the change. < 5 deg: seconds after the change until the 95th \
         percentile over the trailing second stays below for good, median run. / held: the largest ratio, over 50 samples, to the error of the \
         method's own parameters from before. -: no answer at all; single samples without one count as 90 deg. us: time for a sample in microseconds: mean, 99.9th percentile, maximum.",
    );
    if given == Given::Inertial {
        table.note(
            "aided, vqf-raw, vqf-corrected and fusion give north by their own attitude; aided-sample gives the corrected sample without \
             its noise.",
        );
    }
    let mut tables = vec![table];
    if methods.iter().any(|m| m.over_bound.is_some()) {
        let columns: Vec<String> = std::iter::once(String::new()).chain(BOUND_AT.map(|n| format!("n = {n}"))).collect();
        let columns: Vec<&str> = columns.iter().map(String::as_str).collect();
        let mut bound = Table::new(&format!("{scenario}: error over the bound, n samples after the change"), &columns);
        for m in methods {
            if let Some(ratios) = &m.over_bound {
                let cells = ratios.iter().map(|[diagonal, off, b]| format!("{diagonal:.2} / {off:.2} / {b:.2}"));
                bound.row(std::iter::once(m.name.clone()).chain(cells).collect());
            }
        }
        bound.note(
            "Each cell: M's diagonal / M's other elements / b, their rms error over the runs divided by the Cramer-Rao bound of the samples \
             since the change. Few samples bound nothing, and the ratio is near 0.",
        );
        tables.push(bound);
    }
    tables
}

/// An error; a dash where no sample had an answer.
fn degrees(value: f64, digits: usize) -> String {
    number(Some(value).filter(|value| (value - NO_ANSWER_DEG).abs() > 1e-9), digits)
}

/// A tuned number: those of the Kalman filters are powers of ten.
fn tuned(value: f64) -> String {
    if value.abs() < 1e-3 { format!("{value:e}") } else { format!("{value}") }
}

/// All scenarios in two tables, a line for each, a column for each method: over all samples after the change, and from 1000
/// after it; and in which of them ours is not the best.
pub fn overview<'a>(scenarios: impl Iterator<Item = (&'a str, &'a [MethodScore])> + Clone, given: Given) -> Vec<Table> {
    let scenarios = scenarios.filter(|(_, methods)| !methods.is_empty());
    if scenarios.clone().next().is_none() {
        return Vec::new();
    }
    let names: Vec<&str> = scenarios
        .clone()
        .next()
        .map_or_else(Vec::new, |(_, methods)| methods.iter().map(|m| m.name.as_str()).collect());
    let columns: Vec<&str> = std::iter::once("").chain(names.iter().copied()).collect();
    let first = format!("{} rms after the change, deg", capital(given.error()));
    let tables = [first.as_str(), "The same from 1000 samples after it"].map(|title| {
        let value = |m: &MethodScore| if title.starts_with("The same") { m.steady_deg } else { m.after_deg };
        let mut table = Table::new(title, &columns);
        let mut won = Vec::new();
        for (scenario, methods) in scenarios.clone() {
            let text = |m: &MethodScore| degrees(value(m), if value(m) < 10.0 { 2 } else { 0 });
            let Some(best) = methods.iter().min_by(|a, b| value(a).total_cmp(&value(b))) else { continue };
            let cells = names.iter().map(|name| match methods.iter().find(|m| m.name == *name) {
                Some(m) if names.len() > 1 && text(m) == text(best) => format!("*{}", text(m)),
                Some(m) => text(m),
                None => "-".to_owned(),
            });
            table.row(std::iter::once(scenario.to_owned()).chain(cells).collect());
            if let Some(ours) = methods.iter().find(|m| m.name == names[0] && text(m) != text(best)) {
                won.push(format!("{scenario} ({} {} against {})", best.name, text(best), text(ours)));
            }
        }
        match (names.as_slice(), won.as_slice()) {
            ([] | [_], _) => {}
            ([first, ..], []) => table.note(&format!("{first} is the best or as good in all of them.")),
            (_, won) => table.note(&format!("Another one is better in: {}.", won.join(", "))),
        }
        table
    });
    tables.to_vec()
}

fn capital(text: &str) -> String {
    text[..1].to_uppercase() + &text[1..]
}

/// A dot for each scenario or recording, a row for each method: `errors` are their names and errors, degrees.
pub fn dots(errors: &[(&str, f64)], dot: &str, given: Given) -> Result<String, RunError> {
    let mut rows: Vec<DotRow> = Vec::new();
    for (name, error) in errors {
        let is_ours = ["adaptive", "aided", "aided-sample"].contains(name);
        let colour = if is_ours { Colour::Blue } else { Colour::Orange };
        match rows.iter_mut().find(|row| row.name == *name) {
            Some(row) => row.values.push(*error),
            None => rows.push(DotRow { name: (*name).to_owned(), values: vec![*error], colour }),
        }
    }
    let x_label = format!("{}, rms, deg", given.error());
    Dots::new(given.what(), dot, &x_label, rows, true).draw()
}

/// The picture and the tables of a scenario.
pub fn add_case(
    report: &mut Report,
    scenario: &str,
    runs: u32,
    methods: &[MethodScore],
    given: Given,
) -> Result<(), RunError> {
    if methods.is_empty() {
        return Ok(());
    }
    let courses = methods.iter().map(|m| (m.name.as_str(), m.course_deg.as_slice()));
    let figure = courses_figure(given.error(), "samples after the change", &courses.collect::<Vec<_>>())?;
    let suffix = if given == Given::Inertial { "_inertial" } else { "" };
    let name = format!("compare_{}{suffix}", scenario.replace('-', "_"));
    let caption = format!("{scenario}: {}, rms over the runs; the change is at 0.", given.error());
    report.figure(&name, figure, &caption);
    case_table(scenario, runs, methods, given).iter().for_each(|table| report.table(table));
    Ok(())
}

/// The picture of a recording.
pub fn recording_figure(methods: &[RecordingScore], given: Given) -> Result<String, RunError> {
    let courses = methods.iter().map(|m| (m.name.as_str(), m.course_deg.as_slice()));
    let title = format!("heading error against the reference, {}", given.what());
    courses_figure(&title, "s", &courses.collect::<Vec<_>>())
}

/// Errors of those methods that are drawn, each with its name.
fn courses_figure(title: &str, x_label: &str, courses: &[(&str, &[(f64, f64)])]) -> Result<String, RunError> {
    let series = DRAWN.iter().filter_map(|(name, colour)| {
        let (_, course_deg) = courses.iter().find(|(own, _)| own == name)?;
        Some(Series::new(name, *colour, course_deg.iter().map(|(x, error)| (*x, error.min(SHOWN_DEG)))))
    });
    let y_label = format!("deg (at most {SHOWN_DEG:.0} are shown)");
    draw(&[Panel::new(title, x_label, &y_label, series)], 1, (1100, 300))
}

/// A line for each method on a recording.
pub fn recording_table(recording: &str, methods: &[RecordingScore], given: Given) -> Table {
    let columns = ["", "tuned", "answered %", "spread of |h| uT", "heading rms deg", "p95 deg"];
    let mut table = Table::new(&format!("{recording}, {}", given.what()), &columns);
    for m in methods {
        let v = &m.vectors;
        table.row(vec![
            m.name.clone(),
            m.value.map_or_else(String::new, tuned),
            number(Some(100.0 * v.answered), 1),
            number(v.total_field_ut.map(|field| field.spread), 2),
            number(v.heading.map(|heading| heading.rms_deg), 2),
            number(v.heading.map(|heading| heading.p95_deg), 2),
        ]);
    }
    table.note("The first 20 s do not count. Headings are judged by the reference orientation, up to one constant.");
    table.note(match given {
        Given::Magnetometer => "The network learns from that reference over the first 40 % of the recording. There is no Helmholtz coil for a recording.",
        Given::Inertial => {
            "aided, vqf-raw, vqf-corrected and fusion give north by their own attitude; vqf-corrected is given the samples of aided-sample."
        },
    });
    table
}
