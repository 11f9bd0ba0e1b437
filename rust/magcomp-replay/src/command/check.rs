//! `magcomp check`.

use super::common::{Common, input, warn};
use super::import::ImportArguments;
use crate::error::RunError;
use crate::report::Report;
use crate::table::{Table, number};
use clap::Args;
use magcomp_recordings::conventions::{Answer, Conventions, Weight};
use magcomp_recordings::import::open;
use magcomp_recordings::place::{GeoPoint, earth_field_near};
use magcomp_recordings::recording::name_of;
use serde::Serialize;
use std::path::PathBuf;

/// Check a recording's units, signs, axes and clocks, each sensor by another.
///
/// Each question has one of three answers: sound, wrong (with the option that mends it), or could not be tested (with the motion or the sensor that
/// would). The gyroscope is asked by the turn of the field and of gravity, the field by its size and turn, the accelerometer's sign by the dip.
/// `replay` begins with the same. Exit code 3: something is wrong.
#[derive(Debug, Args)]
pub struct Check {
    /// The recording, or the session of a phone logger as of `magcomp import`
    #[arg(value_name = "IN", required = true, value_parser = input)]
    inputs: Vec<PathBuf>,
    #[command(flatten)]
    import: ImportArguments,
    /// Where it was recorded (degrees, north and east positive; metres): tells the sign of the dip
    #[arg(long, value_name = "LAT,LON[,HEIGHT_M]", allow_hyphen_values = true)]
    place: Option<GeoPoint>,
    #[command(flatten)]
    common: Common,
}

/// What is printed as JSON.
#[derive(Serialize)]
struct Told {
    recording: String,
    warnings: Vec<String>,
    #[serde(flatten)]
    conventions: Conventions,
}

impl Check {
    /// Runs the verb.
    pub fn run(self) -> Result<(), RunError> {
        let opened = open(&self.inputs, &self.import.into())?;
        warn(&opened.warnings);
        let recording = name_of(opened.source.path());
        let mut conventions = opened.conventions;
        // the sign of the dip hardly changes with the years: any day of the model will do
        let day = opened.day.or_else(|| "2025-01-01".parse().ok());
        let place = self.place.or(opened.position).zip(day);
        let earth = place.and_then(|(place, day)| earth_field_near(place, day).ok()).map(|(earth, _)| earth);
        if let Some(earth) = earth {
            conventions.judge_sign(earth.dip_deg);
        }
        let is_wrong = conventions.findings.iter().any(|finding| finding.weight == Weight::Fault);
        let mut table = table(&recording, &conventions);
        opened.session.iter().flat_map(|session| &session.notes).for_each(|note| table.note(note));
        let told = Told { recording: recording.clone(), warnings: opened.warnings, conventions };
        self.common.finish(std::slice::from_ref(&table), &told, || {
            let mut report =
                Report::new(&format!("{recording} checked"), "Units, signs, axes and clocks, each sensor by another.");
            report.table(&table);
            Ok(report)
        })?;
        if is_wrong {
            return Err(RunError::Bad(format!("{recording}: {}", told.conventions.findings[0].text)));
        }
        Ok(())
    }
}

fn table(recording: &str, conventions: &Conventions) -> Table {
    let mut table = Table::new(&format!("{recording}, conventions"), &["", "answer", "by"]);
    table.lead = conventions.findings.iter().map(|finding| sentence(&finding.text)).collect();
    let untested = conventions.tested.iter().filter(|tested| tested.answer == Answer::Untested).count();
    if conventions.tested.is_empty() || untested == conventions.tested.len() {
        table.lead.push("Nothing could be tested.".to_owned());
    } else if untested > 0 {
        let amiss = if table.lead.is_empty() { "Nothing is amiss in what was tested; " } else { "" };
        table.lead.push(sentence(&format!(
            "{amiss}{untested} of {} questions could not be tested",
            conventions.tested.len()
        )));
    } else if table.lead.is_empty() {
        table.lead.push("Nothing is amiss.".to_owned());
    }
    for tested in &conventions.tested {
        let answer = match tested.answer {
            Answer::Sound => "sound",
            Answer::Wrong => "wrong",
            Answer::Untested => "could not be tested",
        };
        table.row(vec![tested.what.to_owned(), answer.to_owned(), tested.how.clone()]);
    }
    let delay_ms = conventions.field_delay_s.map(|delay_s| 1000.0 * delay_s);
    for (what, value, digits) in [
        ("field about its centre, uT", conventions.radius_ut, 1),
        ("dip about that centre, deg", conventions.dip_deg, 1),
        ("field behind the gyroscope, ms", delay_ms, 0),
    ] {
        table.row(vec![what.to_owned(), number(value, digits), String::new()]);
    }
    table
}

/// With a capital and a point.
fn sentence(text: &str) -> String {
    let mut letters = text.chars();
    let first = letters.next().map_or_else(String::new, |first| first.to_uppercase().to_string());
    format!("{first}{}.", letters.as_str())
}
