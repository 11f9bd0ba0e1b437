//! What a replay comes to, for whoever plays it: the command, the page in a browser.

use crate::draw::Figures;
use crate::error::RunError;
use crate::judge::Judge;
use crate::judge::Judgement;
use crate::judge::{Bearing, Bearings, Mark};
use crate::judge::{Legs, Waypoint};
use crate::play::{Courses, Step};
use crate::report::Report;
use crate::say::Verdict;
use crate::say::table;
use crate::table::{Table, number};
use magcomp::{Explanation, ReferenceAxis};
use magcomp_recordings::conventions::Conventions;
use magcomp_recordings::import::Summary;
use magcomp_recordings::place::EarthField;
use magcomp_recordings::recording::{Extent, Row};
use std::ops::Range;

/// Judgement and pictures of a replay in the making.
pub struct Gathering {
    judge: Judge,
    legs: Legs,
    marks: Vec<Mark>,
    bearings: Bearings,
    figures: Option<Figures>,
}

impl Gathering {
    /// Before the first row; `part` and `axis` are those of [`Judge::new`].
    pub fn new(extent: &Extent, part: Range<f64>, axis: ReferenceAxis, waypoints: &[Waypoint], is_drawn: bool) -> Self {
        let judge = Judge::new(extent, part, axis);
        let figures = is_drawn.then(|| Figures::new(extent));
        let bearings = Bearings::new(&[], extent.start_s);
        Self { judge, legs: Legs::new(waypoints), marks: Vec::new(), bearings, figures }
    }

    /// The same with what a tester noted.
    pub fn noted(self, marks: &[Mark], bearings: &[Bearing]) -> Self {
        let figures = self.figures.map(|figures| figures.with(marks));
        Self { marks: marks.to_vec(), bearings: self.bearings.with(bearings), figures, ..self }
    }

    /// The next row and the compensator's step for it; the explanation is drawn.
    pub fn add(&mut self, row: &Row, step: &Step, explanation: Option<&Explanation>) {
        self.judge.add(row, step);
        self.legs.add(row, step);
        self.bearings.add(row, step);
        self.figures.iter_mut().for_each(|figures| figures.add(row, step, explanation));
    }

    /// After the last row, under the recording's and the method's names. `known` is what was found when
    /// the recording was opened.
    pub fn finish(self, recording: &str, method: &str, earth: Option<EarthField>, known: &Known) -> Outcome {
        let judged = self.judge.finish();
        let marks = self.marks.iter().map(|mark| mark.told(&judged.events)).collect();
        let judgement = Judgement {
            legs: self.legs.finish(),
            marks,
            bearings: self.bearings.finish(),
            earth,
            courses_used: known.courses.used,
            ..judged
        };
        let mut verdict = Verdict::of(&judgement, &known.conventions, &known.warnings);
        verdict.notes.extend(known.notes.iter().cloned());
        verdict.notes.extend(known.courses.told());
        let mut summary = table(recording, method, &judgement);
        summary.lead.splice(0..0, verdict.lines());
        // the summary first: it says what all of it comes to
        let tables = std::iter::once(summary).chain(known.session.clone()).collect();
        Outcome { judgement, verdict, tables, recording: recording.to_owned(), figures: self.figures }
    }
}

/// What was found when a recording was opened.
#[derive(Clone, Debug, Default)]
pub struct Known {
    /// The content of the logger's session that it was made from.
    pub session: Option<Table>,
    /// Whether units, signs, axes and clocks are what they are taken for.
    pub conventions: Conventions,
    /// Parts that were lost or left out.
    pub warnings: Vec<String>,
    /// What is worth knowing and no doubt.
    pub notes: Vec<String>,
    /// What became of the headings from outside.
    pub courses: Courses,
}

/// What a replay came to.
pub struct Outcome {
    /// In numbers.
    pub judgement: Judgement,
    /// In a word, with reasons.
    pub verdict: Verdict,
    /// In tables: the summary, and the session's content where there was one.
    pub tables: Vec<Table>,
    recording: String,
    figures: Option<Figures>,
}

impl Outcome {
    /// As a page, with the pictures where they were drawn.
    pub fn report(&self) -> Result<Report, RunError> {
        let rule =
            "Every sample went through the compensator in order; nothing later than a sample went into its answer.";
        let verdict = &self.verdict;
        let lines = verdict.lines().len();
        let mut report = Report::new(&format!("{} replayed", self.recording), rule);
        let list =
            |first: String, more: &[String]| std::iter::once(first).chain(more.iter().cloned()).collect::<Vec<_>>();
        let heading = list(format!("Heading: {}", verdict.heading), &[&verdict.why[..], &verdict.notes[..]].concat());
        report.card(verdict.grade.word(), &heading, &verdict.next);
        let place = list(format!("Place: {}", verdict.place_words()), &verdict.place_why);
        report.card(verdict.place_grade().word(), &place, &[]);
        let rest = &self.tables[0].lead[lines..];
        if !rest.is_empty() {
            report.folded("In figures", |report| {
                rest.iter().for_each(|sentence| report.text(sentence));
                Ok::<(), RunError>(())
            })?;
        }
        self.figures.as_ref().map_or(Ok(()), |figures| figures.finish(&mut report, "replay", &self.recording))?;
        // the card has the lead
        report.table(&Table { lead: Vec::new(), ..self.tables[0].clone() });
        self.tables[1..].iter().for_each(|table| report.table(table));
        Ok(report)
    }
}

/// The content of a session as a table.
pub fn session_table(summary: &Summary) -> Table {
    let mut table =
        Table::new(&format!("{} session", summary.logger), &["sensor", "events", "rate Hz", "longest pause s"]);
    for sensor in &summary.sensors {
        let (rate, pause) = (number(sensor.rate_hz, 1), number(sensor.longest_pause_s, 3));
        table.row(vec![sensor.sensor.to_owned(), sensor.events.to_string(), rate, pause]);
    }
    summary.notes.iter().for_each(|note| table.note(note));
    table
}
