//! The verdict on a recording: how well its heading is known, what the place was like, why, and what to do next.

use super::sentences::{EARTH_UT, short};
use crate::judge::Judgement;
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
/// Share of the time in which there must be a heading.
const ANSWERED: f64 = 0.5;
/// Share of the time in which the heading must be known as well as is told.
const MOSTLY: f64 = 0.6;
/// Two sigmas from which on a heading is doubtful, degrees.
const WIDE_DEG: f64 = 20.0;

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

/// What the place's field was like.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Place {
    /// Much the same everywhere.
    Even,
    /// As among furniture and walls.
    Uneven,
    /// As beside magnets, cars and shelves of steel.
    Magnetic,
    /// Nothing was corrected, so nothing is known.
    Unknown,
}

/// The verdict: of the heading, which is what people come for, and of the place.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Verdict {
    /// How good the heading is; bad where there is none.
    pub grade: Grade,
    /// A convention of the recording is wrong, or the heading is against its reference.
    pub is_wrong: bool,
    /// The heading in one sentence.
    pub heading: String,
    /// What speaks against it, the worst first.
    pub why: Vec<String>,
    /// What the place was like.
    pub place: Place,
    /// Why, the worst first.
    pub place_why: Vec<String>,
    /// What to do next.
    pub next: Vec<String>,
    /// What else is worth knowing.
    pub notes: Vec<String>,
}

const TURN: &str = "hold the device clear of iron and turn it once about each of its axes";
const AGAIN: &str = "record again away from steel, cars and magnets";

impl Verdict {
    /// Of a replay, the recording's conventions, and the warnings about what was lost or left out.
    pub fn of(judgement: &Judgement, conventions: &Conventions, warnings: &[String]) -> Self {
        let mut conventions = conventions.clone();
        if let Some(earth) = judgement.earth {
            conventions.judge_sign(earth.dip_deg);
        }
        let mut heading = Found::default();
        for finding in &conventions.findings {
            match finding.weight {
                Weight::Fault => heading.add(Grade::Bad, finding.text.clone(), ""),
                // the estimator copes with both kinds, or its sigma grows
                Weight::Doubt if finding.kind != "two_kinds" => {
                    heading.add(Grade::Doubtful, finding.text.clone(), "");
                }
                _ => heading.notes.push(finding.text.clone()),
            }
        }
        warnings.iter().for_each(|warning| heading.add(Grade::Doubtful, warning.clone(), ""));
        add_heading(&mut heading, judgement, &conventions);
        let (place, place_why) = place_of(judgement, &mut heading.notes);
        // what the corrected field does there is not what the estimator reckons with
        if place == Place::Magnetic && heading.grade == Grade::Good {
            heading.add(Grade::Doubtful, "beside magnets or steel it may be wrong by more".to_owned(), AGAIN);
        }
        let told = told_heading(judgement);
        heading.finish(told, place, place_why)
    }

    /// As the lines that a summary begins with.
    pub fn lines(&self) -> Vec<String> {
        let because = |mark: &str, why: &[String]| {
            if why.is_empty() { String::new() } else { format!("{mark} {}", why.join("; ")) }
        };
        // the sentence of the heading may have a colon of its own
        let why = because(";", &self.why);
        let heading = match self.grade {
            Grade::Good => format!("Heading: {}.", self.heading),
            Grade::Doubtful => format!("Heading: doubtful, {}{why}.", self.heading),
            Grade::Bad => format!("Heading: bad, {}{why}.", self.heading),
        };
        let place = format!("Place: {}{}.", self.place_words(), because(":", &self.place_why));
        let next = (!self.next.is_empty()).then(|| format!("Next: {}.", self.next.join("; ")));
        let notes = self.notes.iter().map(|note| format!("Note: {note}."));
        [heading, place].into_iter().chain(next).chain(notes).collect()
    }

    /// The place in words.
    pub fn place_words(&self) -> &'static str {
        match self.place {
            Place::Even => "even",
            Place::Uneven => "uneven",
            Place::Magnetic => "magnets or steel are near",
            Place::Unknown => "could not be told, because no field was corrected",
        }
    }

    /// The colour that the place's card has.
    pub(crate) fn place_grade(&self) -> Grade {
        match self.place {
            Place::Even => Grade::Good,
            Place::Uneven | Place::Unknown => Grade::Doubtful,
            Place::Magnetic => Grade::Bad,
        }
    }

    /// As the first words of an error.
    pub fn reason(&self) -> String {
        self.why.first().cloned().unwrap_or_else(|| self.heading.clone())
    }
}

/// The heading by its own sigma.
fn told_heading(judgement: &Judgement) -> String {
    let known = &judgement.known;
    match (known.two_sigma_deg, &known.none_because) {
        (Some(two_sigma_deg), _) => {
            let percent = 100.0 * known.within_share;
            format!("known to +-{} deg (two sigmas) in {percent:.0} % of the time", short(two_sigma_deg))
        }
        (None, Some(why)) => format!("no heading, because {why}"),
        (None, None) => "no heading".to_owned(),
    }
}

fn add_heading(found: &mut Found, judgement: &Judgement, conventions: &Conventions) {
    let known = &judgement.known;
    let Some(two_sigma_deg) = known.two_sigma_deg else {
        // the sentence says why
        found.grade = Grade::Bad;
        found.next.push(TURN.to_owned());
        return;
    };
    if known.share < ANSWERED {
        let text = format!("there is one in {:.0} % of the time only", 100.0 * known.share);
        found.add(Grade::Doubtful, text, TURN);
    }
    if two_sigma_deg > WIDE_DEG {
        found.add(Grade::Doubtful, "that is wide".to_owned(), TURN);
    } else if known.share >= ANSWERED && known.within_share < MOSTLY {
        found.add(Grade::Doubtful, "in the rest it is wider, or there is none".to_owned(), TURN);
    }
    if known.is_unmoved() && judgement.courses_used == 0 {
        let turned_deg = known.turned_deg.unwrap_or(0.0);
        let text = format!("not enough motion to tell, for the device was turned by {turned_deg:.0} deg in all");
        found.add(Grade::Doubtful, text, TURN);
    }
    if let Some(error) = judgement.published_heading.or(judgement.heading) {
        let text = format!("it is {} deg rms off the reference", short(error.rms_deg));
        let grade = if error.rms_deg > HEADING_DEG[1] { Grade::Bad } else { Grade::Doubtful };
        if error.rms_deg > HEADING_DEG[0] {
            found.add(grade, text, AGAIN);
        }
    }
    if let Some(how) = conventions.askew_untested().filter(|_| !has_north_from_outside(judgement)) {
        let text =
            "the recording does not tell whether the magnetometer sits askew, which would turn each heading by as much";
        found.add(Grade::Doubtful, text.to_owned(), how);
    }
}

/// Where courses are used, or the reference's north agrees, an askew magnetometer shows.
fn has_north_from_outside(judgement: &Judgement) -> bool {
    judgement.courses_used > 0 || judgement.absolute_heading.rms_deg.is_some_and(|rms_deg| rms_deg < HEADING_DEG[0])
}

/// The place by the corrected field: how far its strength and dip spread, and what they are.
fn place_of(judgement: &Judgement, notes: &mut Vec<String>) -> (Place, Vec<String>) {
    let Some(MeanSpread { mean, spread }) = judgement.total_field_ut.compensated else {
        return (Place::Unknown, Vec::new());
    };
    let mut found: Vec<(Place, String)> = Vec::new();
    let mut limit = |value: f64, [uneven, magnetic]: [f64; 2], text: String| {
        if value > uneven {
            found.push((if value > magnetic { Place::Magnetic } else { Place::Uneven }, text));
        }
    };
    let share = spread / mean.max(1e-9);
    limit(share, FIELD_SPREAD, format!("the field's strength varies by {:.0} %", 100.0 * share));
    if let Some(dip) = judgement.dip_deg.compensated {
        limit(dip.spread, DIP_SPREAD_DEG, format!("its dip varies by {} deg", short(dip.spread)));
        if let Some(earth) = judgement.earth {
            let text = format!("its dip is {:.0} deg, and the place has {:.0}", dip.mean, earth.dip_deg);
            limit((dip.mean - earth.dip_deg).abs(), OFF_DIP_DEG, text);
        }
    }
    if let Some(swing) = judgement.full_turns.and_then(|full| full.rms_deg.compensated) {
        limit(swing, SWING_DEG, format!("north swings by {} deg within a full turn", short(swing)));
    }
    match judgement.earth {
        Some(earth) => {
            let off = (mean / earth.total_field_ut - 1.0).abs();
            let text = format!("the field is {mean:.0} uT, and the place has {:.0}", earth.total_field_ut);
            // the scales of phones' sensors are off by a tenth and more
            if off > OFF_FIELD[1] {
                limit(off, OFF_FIELD, text);
            } else if off > OFF_FIELD[0] {
                notes.push(text);
            }
        }
        None if !(EARTH_UT.0..=EARTH_UT.1).contains(&mean) => {
            found.push((Place::Magnetic, format!("the field is {mean:.0} uT, and the Earth has 22 to 67")));
        }
        None => {}
    }
    found.sort_by_key(|(place, _)| std::cmp::Reverse(*place));
    let place = found.first().map_or(Place::Even, |(place, _)| *place);
    (place, found.into_iter().map(|(_, text)| text).collect())
}

/// What speaks against a heading.
#[derive(Debug)]
struct Found {
    grade: Grade,
    against: Vec<(Grade, String)>,
    next: Vec<String>,
    notes: Vec<String>,
}

impl Default for Found {
    fn default() -> Self {
        Self { grade: Grade::Good, against: Vec::new(), next: Vec::new(), notes: Vec::new() }
    }
}

impl Found {
    fn add(&mut self, grade: Grade, text: String, next: &str) {
        if !next.is_empty() && !self.next.iter().any(|known| known == next) {
            self.next.push(next.to_owned());
        }
        self.grade = self.grade.max(grade);
        self.against.push((grade, text));
    }

    fn finish(mut self, heading: String, place: Place, place_why: Vec<String>) -> Verdict {
        self.against.sort_by_key(|(grade, _)| std::cmp::Reverse(*grade));
        let is_mended = self.against.iter().any(|(_, text)| text.contains("--")) || heading.contains("--");
        if is_mended {
            // the options that the reasons name come first
            self.next.insert(0, "replay it again with the option that is named".to_owned());
        }
        if place > Place::Even && place != Place::Unknown && !self.next.iter().any(|known| known == AGAIN) {
            self.next.push(AGAIN.to_owned());
        }
        let is_wrong = self.against.first().is_some_and(|(grade, _)| *grade == Grade::Bad);
        let why = self.against.into_iter().map(|(_, text)| text).collect();
        Verdict { grade: self.grade, is_wrong, heading, why, place, place_why, next: self.next, notes: self.notes }
    }
}

/// A recording of several: its name, and what it came to or why it could not be read.
pub type Played = (String, Result<(Judgement, Verdict), String>);

/// The recordings of one call, a line each.
pub fn verdicts_table(title: &str, lines: &[Played]) -> Table {
    let columns = ["recording", "heading", "s", "known to, deg", "of the time, %", "place", "why"];
    let mut table = Table::new(title, &columns);
    let dash = || "-".to_owned();
    for (name, outcome) in lines {
        let cells = match outcome {
            Ok((judgement, verdict)) => {
                let place = match verdict.place {
                    Place::Even => "even",
                    Place::Uneven => "uneven",
                    Place::Magnetic => "magnetic",
                    Place::Unknown => "-",
                };
                let why = if verdict.grade == Grade::Good { String::new() } else { shorten(&verdict.reason()) };
                vec![
                    name.clone(),
                    verdict.grade.word().to_owned(),
                    format!("{:.0}", judgement.duration_s),
                    judgement.known.two_sigma_deg.map_or_else(dash, short),
                    format!("{:.0}", 100.0 * judgement.known.within_share),
                    place.to_owned(),
                    why,
                ]
            }
            Err(why) => vec![name.clone(), "not read".to_owned(), dash(), dash(), dash(), dash(), shorten(why)],
        };
        table.row(cells);
    }
    table
}
