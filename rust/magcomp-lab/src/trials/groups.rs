//! Which group a recording belongs to, and how far magnetic north is from its reference's: an index, CSV with the columns
//! recording,group[,declination_deg][,magnet_s][,calibration][,judged_s]. `recording` is a name or a pattern with * and ?; the first line that fits a recording counts.

use glob::Pattern;
use magcomp_recordings::error::{Place, RecordingError};
use magcomp_replay::beside::read_table;
use magcomp_replay::error::RunError;
use serde::Deserialize;
use std::path::{Path, PathBuf};

/// The index that a folder has itself.
pub(super) const INDEX: &str = "INDEX.csv";
/// The group of all, without an index; of those that no line fits, with one.
const ALL: &str = "all";
const OTHERS: &str = "others";

#[derive(Deserialize)]
struct Line {
    recording: String,
    group: String,
    #[serde(default)]
    declination_deg: Option<f64>,
    #[serde(default)]
    magnet_s: Option<String>,
    #[serde(default)]
    calibration: Option<String>,
    #[serde(default)]
    judged_s: Option<f64>,
}

/// What an index says of the recordings that fit a pattern.
#[derive(Default)]
pub(super) struct Rule {
    pattern: Pattern,
    pub group: String,
    /// How far magnetic north is east of the reference's, degrees; 0 where none is told.
    pub declination_deg: f64,
    /// From when to when a magnet sat on the sensor, s.
    pub magnet_s: Option<(f64, f64)>,
    /// The recording of the same device and day whose field is constant: what a calibration is made of beforehand.
    pub calibration: Option<String>,
    /// Headings are judged from this second after the first row on, by the constant angle of the rows before.
    pub judged_s: Option<f64>,
}

/// The lines of an index, in order.
pub(super) struct Groups {
    path: Option<PathBuf>,
    rules: Vec<Rule>,
    /// Of recordings that none of them fits.
    rest: Rule,
}

impl Groups {
    /// The index named, else the one of the folder, else none.
    pub fn of(folder: &Path, index: Option<&Path>) -> Result<Self, RunError> {
        let rest = |group: &str| Rule { group: group.to_owned(), ..Rule::default() };
        let own = folder.join(INDEX);
        let Some(path) = index.map(Path::to_owned).or_else(|| own.is_file().then_some(own)) else {
            return Ok(Self { path: None, rules: Vec::new(), rest: rest(ALL) });
        };
        let lines: Vec<Line> = read_table(
            &path,
            "an index with the columns recording,group[,declination_deg][,magnet_s][,calibration][,judged_s]",
        )?;
        let rule = |(k, line): (usize, Line)| {
            let wrong = |expected: &str, found: String| RecordingError::Form {
                place: Place { path: path.clone(), line: k as u64 + 2, column: None },
                expected: expected.to_owned(),
                found,
            };
            if let Some(judged_s) = line.judged_s.filter(|judged_s| !(judged_s.is_finite() && *judged_s > 0.0)) {
                return Err(wrong("from which second on headings are judged, above 0", judged_s.to_string()));
            }
            let pattern = Pattern::new(line.recording.trim());
            let pattern =
                pattern.map_err(|error| wrong("a recording's name or a pattern with * and ?", error.to_string()))?;
            let declination_deg = line.declination_deg.unwrap_or(0.0);
            if !(-180.0..=180.0).contains(&declination_deg) {
                return Err(wrong("a declination from -180 to 180 degrees", declination_deg.to_string()));
            }
            let magnet_s = line.magnet_s.filter(|told| !told.trim().is_empty()).map(|told| {
                let ends = told.split_once('-').map(|(on, off)| (on.trim().parse(), off.trim().parse()));
                let known = ends.and_then(|(on, off)| Some((on.ok()?, off.ok()?)));
                let known = known.filter(|(on, off): &(f64, f64)| 0.0 <= *on && on < off && off.is_finite());
                known.ok_or_else(|| wrong("from when to when a magnet sat there, such as 45.1-99.8, in seconds", told))
            });
            let magnet_s = magnet_s.transpose()?;
            let calibration = line.calibration.map(|name| name.trim().to_owned()).filter(|name| !name.is_empty());
            Ok(Rule {
                pattern,
                group: line.group.trim().to_owned(),
                declination_deg,
                magnet_s,
                calibration,
                judged_s: line.judged_s,
            })
        };
        let rules = lines.into_iter().enumerate().map(rule).collect::<Result<_, RecordingError>>()?;
        Ok(Self { path: Some(path), rules, rest: rest(OTHERS) })
    }

    /// What is told of a recording.
    pub fn find(&self, recording: &str) -> &Rule {
        self.rules.iter().find(|rule| rule.pattern.matches(recording)).unwrap_or(&self.rest)
    }

    /// The names of all groups, in the order of the index.
    pub fn names(&self) -> Vec<&str> {
        let mut names = Vec::new();
        for name in self.rules.iter().map(|rule| rule.group.as_str()).chain([OTHERS, ALL]) {
            if !names.contains(&name) {
                names.push(name);
            }
        }
        names
    }

    /// Warnings of lines that fit none of the recordings.
    pub fn unused<'a>(&self, recordings: impl Iterator<Item = &'a str> + Clone) -> Vec<String> {
        let Some(path) = &self.path else { return Vec::new() };
        let fits = |rule: &Rule| recordings.clone().any(|recording| rule.pattern.matches(recording));
        let unused = self.rules.iter().filter(|rule| !fits(rule));
        unused.map(|rule| format!("{}: '{}' fits no recording", path.display(), rule.pattern)).collect()
    }
}
