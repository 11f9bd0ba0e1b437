//! One replay, a chunk of rows at a time, so that the page can show how far it is.

use magcomp::{Config, HeadingConfig, ReferenceAxis};
use magcomp_recordings::conventions::{Conventions, Finding};
use magcomp_recordings::import::{ImportOptions, Opened, open_bytes};
use magcomp_recordings::place::{Day, EarthField, GeoPoint, earth_field};
use magcomp_recordings::recording::{Rows, Source, name_of};
use magcomp_replay::report::quoted;
use magcomp_replay::{
    Gathering, Ignore, Known, Player, calibration_json, session_table, usual_part, write_header, write_row,
};
use serde::{Deserialize, Serialize};

/// Rows of a chunk: some tens of milliseconds.
const CHUNK: usize = 4096;

/// What the page asks for; empty: not said.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Settings {
    /// top, camera or auto.
    axis: String,
    /// LAT,LON[,HEIGHT_M].
    place: String,
    /// YYYY-MM-DD.
    date: String,
}

/// What was opened.
#[derive(Serialize)]
struct Told<'a> {
    rows: usize,
    duration_s: f64,
    warnings: &'a [String],
}

/// A replay under way.
pub struct Run {
    source: Source,
    rows: Rows,
    known: Known,
    earth: Option<EarthField>,
    player: Player,
    gathering: Gathering,
    /// As one types it.
    command: String,
    has_begun: bool,
}

/// An error in words that fit a page.
fn words(error: impl std::fmt::Display) -> String {
    without_options(&error.to_string())
}

/// A finding in words that fit a page.
fn plain(finding: Finding) -> Finding {
    Finding { text: without_options(&finding.text), ..finding }
}

/// A text without the command's options: a page has none. What stands before an option says what is wrong.
fn without_options(text: &str) -> String {
    let mut kept = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find("--") {
        let before = rest[..at].trim_end();
        let near = |marks: &[char], most: usize| before.rfind(marks).filter(|cut| before.len() - cut < most);
        // back to the mark that leads to the option; a question stays
        let asks = before.ends_with('?').then_some(before.len());
        let cut = asks.or_else(|| near(&[':', ';', '('], 35)).or_else(|| near(&[','], 30)).unwrap_or(before.len());
        kept.push_str(before[..cut].trim_end());
        // over its value, to the end of the parenthesis or of the part of the sentence
        let mut depth = usize::from(before[cut..].starts_with('('));
        let end = rest[at..].char_indices().find(|(_, mark)| {
            match mark {
                '(' => depth += 1,
                ')' if depth == 0 => return true,
                ')' => depth -= 1,
                ';' if depth == 0 => return true,
                _ => {}
            }
            false
        });
        rest = end.map_or("", |(end, _)| &rest[at + end..]);
    }
    kept.push_str(rest);
    kept
}

impl Run {
    /// Opens a recording or a session: names and contents.
    pub fn open(files: Vec<(String, Vec<u8>)>, settings: Settings) -> Result<Self, String> {
        let mut command: Vec<String> = std::iter::once("replay".to_owned()).collect();
        command.extend(files.iter().map(|(name, _)| name.clone()));
        let axis = match settings.axis.as_str() {
            "top" => ReferenceAxis::TopEdge,
            "camera" => ReferenceAxis::Camera,
            "auto" => ReferenceAxis::Auto,
            other => return Err(format!("axis is {other:?}; it must be top, camera or auto")),
        };
        for (name, value, usual) in
            [("--axis", &settings.axis, "top"), ("--place", &settings.place, ""), ("--date", &settings.date, "")]
        {
            if value != usual {
                command.extend([name.to_owned(), value.clone()]);
            }
        }
        command.extend(["--report".to_owned(), "magcomp-report".to_owned()]);
        let place: Option<GeoPoint> = (!settings.place.is_empty())
            .then(|| settings.place.parse())
            .transpose()
            .map_err(|why| format!("place: {why}"))?;
        let date: Option<Day> = (!settings.date.is_empty())
            .then(|| settings.date.parse())
            .transpose()
            .map_err(|why| format!("date: {why}"))?;

        let Opened { mut source, session, warnings, conventions, day, position } =
            open_bytes(files, &ImportOptions::default()).map_err(words)?;
        let earth = match (place, date.or(day)) {
            (Some(place), Some(day)) => Some(earth_field(place, day).map_err(words)?),
            (Some(_), None) => {
                return Err("the recording's times do not say the date that the place needs; give the date".to_owned());
            }
            // a log's own position; it may be older than the model
            (None, day) => position.zip(day).and_then(|(place, day)| earth_field(place, day).ok()),
        };
        let declination_deg = earth.map(|earth| earth.declination_deg);
        let heading = HeadingConfig { axis, declination_deg, ..HeadingConfig::default() };
        let config = Config { heading, ..Config::default() };
        let player = Player::new(&config, Ignore::default()).map_err(words)?;
        let extent = *source.extent();
        let gathering = Gathering::new(&extent, usual_part(&extent), axis, &[], true);
        let rows = source.rows().map_err(words)?;
        let conventions =
            Conventions { findings: conventions.findings.into_iter().map(plain).collect(), ..conventions };
        let warnings = warnings.iter().map(|warning| without_options(warning)).collect();
        let known = Known { session: session.as_ref().map(session_table), conventions, warnings, ..Known::default() };
        let command = quoted(command.into_iter());
        Ok(Self { source, rows, known, earth, player, gathering, command, has_begun: false })
    }

    /// What was opened, as JSON.
    pub fn opened(&self) -> Vec<u8> {
        let extent = self.source.extent();
        let told = Told { rows: extent.rows, duration_s: extent.duration_s(), warnings: &self.known.warnings };
        serde_json::to_vec(&told).expect("numbers and texts")
    }

    /// Plays the next rows: how many, and their lines of CSV.
    pub fn play(&mut self) -> Result<(i32, Vec<u8>), String> {
        let (mut lines, mut played) = (Vec::new(), 0);
        let has_true_heading = self.earth.is_some();
        let unwritten = |error: std::io::Error| error.to_string();
        if !std::mem::replace(&mut self.has_begun, true) {
            write_header(&mut lines, has_true_heading).map_err(unwritten)?;
        }
        for row in self.rows.by_ref().take(CHUNK) {
            let row = row.map_err(words)?;
            let step = self.player.play(&row);
            let explanation = self.player.compensator().explain();
            write_row(&mut lines, &row, &step, has_true_heading).map_err(unwritten)?;
            self.gathering.add(&row, &step, Some(&explanation));
            played += 1;
        }
        Ok((played, lines))
    }

    /// The calibration in force, as JSON; empty where there is none.
    pub fn calibration(&self) -> String {
        let end_s = self.source.extent().end_s;
        calibration_json(self.player.compensator(), &name_of(self.source.path()), end_s).unwrap_or_default()
    }

    /// The report as one page.
    pub fn report(self) -> Result<String, String> {
        let outcome = self.gathering.finish(&name_of(self.source.path()), "auto", self.earth, &self.known);
        Ok(outcome.report().map_err(words)?.alone(&self.command))
    }
}

#[cfg(test)]
mod tests {
    use super::without_options;

    #[test]
    fn a_page_names_no_option() {
        for (text, expected) in [
            (
                "the gyroscope is in deg/s, not rad/s: --units g=deg/s and --frame g=y,x,-z",
                "the gyroscope is in deg/s, not rad/s",
            ),
            ("the Earth has 22 to 67: milligauss? --units m=mG", "the Earth has 22 to 67: milligauss?"),
            ("it is of Apple's sign: --units a=-m/s2 (or all axes: --frame m=-x,-y,-z)", "it is of Apple's sign"),
            ("it holds 2 sessions (1: a; 2: b); name one by --session N", "it holds 2 sessions (1: a; 2: b)"),
            ("no value (2012-01-01; --date names another day)", "no value (2012-01-01)"),
            ("stamp both with the sensors' own times, or --shift m=0.03", "stamp both with the sensors' own times"),
            ("nothing to leave out", "nothing to leave out"),
        ] {
            assert_eq!(without_options(text), expected);
        }
    }
}
