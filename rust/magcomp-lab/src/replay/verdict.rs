//! The verdict on a recording: good, doubtful or bad, why, and what to do next.

use super::judgement::Judgement;
use super::sentences::{EARTH_UT, short};
use crate::statistics::MeanSpread;
use crate::table::Table;
use magcomp_recordings::conventions::{Conventions, Weight};
use magcomp_recordings::error::shorten;
use serde::Serialize;

/// Limits from which on a figure is doubtful, and bad. Quiet rooms have a spread of the dip of 1 to 3 deg and of the total field of 2 to 5 %;
/// among shelves and cars both are several times as large.
const DIP_SPREAD_DEG: [f64; 2] = [6.0, 15.0];
const FIELD_SPREAD: [f64; 2] = [0.10, 0.25];
const SWING_DEG: [f64; 2] = [8.0, 20.0];
const HEADING_DEG: [f64; 2] = [8.0, 20.0];
/// Off the model of the place: dip, degrees; total field, a share of it.
const OFF_DIP_DEG: [f64; 2] = [6.0, 15.0];
const OFF_FIELD: [f64; 2] = [0.10, 0.25];
/// Total fields that iron near by makes of the Earth's, uT.
const NEAR_IRON_UT: (f64, f64) = (15.0, 90.0);
/// Share of the rows that must be answered.
const ANSWERED: f64 = 0.5;

/// How good a recording is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Grade {
    /// Nothing speaks against it.
    Good,
    /// Something may be wrong.
    Doubtful,
    /// It is of no use as it is.
    Bad,
}

impl Grade {
    /// One word.
    pub fn word(self) -> &'static str {
        match self {
            Self::Good => "good",
            Self::Doubtful => "doubtful",
            Self::Bad => "bad",
        }
    }
}

/// The verdict.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// How good.
    pub grade: Grade,
    /// Why, the worst first.
    pub why: Vec<String>,
    /// What to do next.
    pub next: Vec<String>,
}

impl Verdict {
    /// Of a replay, the recording's conventions, and the warnings about what was lost or left out.
    pub fn of(judgement: &Judgement, conventions: &Conventions, warnings: &[String]) -> Self {
        let mut found = Found::default();
        let mut conventions = conventions.clone();
        if let Some(earth) = judgement.earth {
            conventions.judge_sign(earth.dip_deg);
        }
        for finding in &conventions.findings {
            let grade = match finding.weight {
                Weight::Fault => Grade::Bad,
                Weight::Doubt => Grade::Doubtful,
                Weight::Note => Grade::Good,
            };
            found.add(grade, finding.text.clone(), "");
        }
        warnings.iter().for_each(|warning| found.add(Grade::Doubtful, warning.clone(), ""));
        // a heading that a reference proves is of use, however the field swings
        found.is_proven =
            judgement.published_heading.or(judgement.heading).is_some_and(|error| error.rms_deg <= HEADING_DEG[1]);
        let again = "record again away from steel, cars and magnets, and turn the device once about each of its axes at the beginning";
        add_answers(&mut found, judgement);
        if let Some(error) = judgement.published_heading.or(judgement.heading) {
            let text = format!("the heading is {} deg rms off the reference", short(error.rms_deg));
            found.limit(error.rms_deg, HEADING_DEG, text, again);
        }
        if let Some(field) = judgement.total_field_ut.compensated {
            add_field(&mut found, judgement, field, again);
        }
        if let Some(dip) = judgement.dip_deg.compensated {
            let text = format!("the dip spreads by {} deg", short(dip.spread));
            found.limit(dip.spread, DIP_SPREAD_DEG, text, again);
            if let Some(earth) = judgement.earth {
                let text = format!("the dip is {:.0} deg, and the place has {:.0}", dip.mean, earth.dip_deg);
                found.limit((dip.mean - earth.dip_deg).abs(), OFF_DIP_DEG, text, again);
            }
        }
        if let Some(swing) = judgement.full_turns.and_then(|full| full.rms_deg.compensated) {
            let text = format!("north swings by {} deg within a full turn", short(swing));
            found.limit(swing, SWING_DEG, text, again);
        }
        found.finish()
    }

    /// As the lines that a summary begins with.
    pub fn lines(&self) -> Vec<String> {
        let why = if self.why.is_empty() { String::new() } else { format!(": {}", self.why.join("; ")) };
        let verdict = format!("Verdict: {}{why}.", self.grade.word());
        let next = (!self.next.is_empty()).then(|| format!("Next: {}.", self.next.join("; ")));
        std::iter::once(verdict).chain(next).collect()
    }

    /// As the first words of an error.
    pub fn reason(&self) -> String {
        self.why.first().cloned().unwrap_or_default()
    }
}

fn add_answers(found: &mut Found, judgement: &Judgement) {
    let turn = "hold the device clear of iron and turn it once about each of its axes";
    if judgement.answered == 0.0 {
        found.add(Grade::Doubtful, "no row was answered".to_owned(), turn);
    } else if judgement.answered < ANSWERED {
        let text = format!("only {:.0} % of the rows were answered", 100.0 * judgement.answered);
        found.add(Grade::Doubtful, text, turn);
    }
}

fn add_field(found: &mut Found, judgement: &Judgement, field: MeanSpread, again: &str) {
    let MeanSpread { mean, spread } = field;
    let text = format!("the total field spreads by {} of {mean:.0} uT", short(spread));
    found.limit(spread / mean.max(1e-9), FIELD_SPREAD, text, again);
    match judgement.earth {
        Some(earth) => {
            let text = format!("the total field is {mean:.0} uT, and the place has {:.0}", earth.total_field_ut);
            found.limit((mean / earth.total_field_ut - 1.0).abs(), OFF_FIELD, text, again);
        }
        None if !(EARTH_UT.0..=EARTH_UT.1).contains(&mean) => {
            let near = (NEAR_IRON_UT.0..=NEAR_IRON_UT.1).contains(&mean);
            let text = format!("the total field is {mean:.0} uT, and the Earth has 22 to 67");
            let grade = if near || found.is_proven { Grade::Doubtful } else { Grade::Bad };
            found.add(grade, text, again);
        }
        None => {}
    }
}

/// What speaks against a recording.
#[derive(Default)]
struct Found {
    against: Vec<(Grade, String)>,
    next: Vec<String>,
    /// A reference proves the heading.
    is_proven: bool,
}

impl Found {
    fn add(&mut self, grade: Grade, text: String, next: &str) {
        if !next.is_empty() && grade > Grade::Good && !self.next.iter().any(|known| known == next) {
            self.next.push(next.to_owned());
        }
        self.against.push((grade, text));
    }

    fn limit(&mut self, value: f64, [doubtful, bad]: [f64; 2], text: String, next: &str) {
        if value > bad && !self.is_proven {
            self.add(Grade::Bad, text, next);
        } else if value > doubtful {
            self.add(Grade::Doubtful, text, next);
        }
    }

    fn finish(mut self) -> Verdict {
        self.against.sort_by_key(|(grade, _)| std::cmp::Reverse(*grade));
        let grade = self.against.first().map_or(Grade::Good, |(grade, _)| *grade);
        let mended = self.against.iter().any(|(grade, text)| *grade > Grade::Good && text.contains("--"));
        if mended {
            // the options that the reasons name come first
            self.next.insert(0, "replay it again with the option that is named".to_owned());
        }
        Verdict { grade, why: self.against.into_iter().map(|(_, text)| text).collect(), next: self.next }
    }
}

/// A recording of several: its name, and what it came to or why it could not be read.
pub type Played = (String, Result<(Judgement, Verdict), String>);

/// The recordings of one call, a line each.
pub fn verdicts_table(title: &str, lines: &[Played]) -> Table {
    let columns = ["recording", "verdict", "s", "answered, %", "field, uT", "dip, deg", "why"];
    let mut table = Table::new(title, &columns);
    let dash = || "-".to_owned();
    for (name, outcome) in lines {
        let cells = match outcome {
            Ok((judgement, verdict)) => {
                let told = |it: MeanSpread| format!("{:.1} +- {:.1}", it.mean, it.spread);
                let mean = |figure: Option<MeanSpread>| figure.map_or_else(dash, told);
                vec![
                    name.clone(),
                    verdict.grade.word().to_owned(),
                    format!("{:.0}", judgement.duration_s),
                    format!("{:.0}", 100.0 * judgement.answered),
                    mean(judgement.total_field_ut.compensated),
                    mean(judgement.dip_deg.compensated),
                    shorten(&verdict.reason()),
                ]
            }
            Err(why) => vec![name.clone(), "not read".to_owned(), dash(), dash(), dash(), dash(), shorten(why)],
        };
        table.row(cells);
    }
    table
}
