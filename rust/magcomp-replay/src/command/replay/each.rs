//! Several recordings in one call: those of a folder, of a file with several sessions, or those that were named.

use super::Replay;
use crate::error::RunError;
use crate::report::Report;
use crate::{Judgement, Played, Verdict, verdicts_table};
use magcomp_recordings::error::RecordingError;
use magcomp_recordings::import::ImportOptions;
use magcomp_recordings::recording::{files_of, name_of, unzipped};
use serde::Serialize;
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// What a recording begins with.
const START: &[u8; 4] = b"t_s,";
impl Replay {
    /// Whether a folder was named that holds several recordings.
    pub(super) fn has_folder_of_recordings(&self) -> bool {
        self.inputs.iter().any(|input| holds_recordings(input))
    }

    /// Several recordings: a line each, and a page each where a report is wanted.
    pub(super) fn replay_each(&self, import: &ImportOptions, sessions: usize, why: String) -> Result<(), RunError> {
        let one_alone = self.output.is_some()
            || self.explain.is_some()
            || self.calibration.is_some()
            || self.waypoints.is_some()
            || !self.mark.is_empty()
            || !self.bearing.is_empty();
        if one_alone {
            return Err(RecordingError::Several { sessions, why }.into());
        }
        let parts = self.parts(import, sessions)?;
        if parts.len() < 2 {
            return Err(RecordingError::Several { sessions, why }.into());
        }
        let (mut lines, mut links) = (Vec::new(), Vec::new());
        for (name, path, options) in parts {
            let played = match self.play(std::slice::from_ref(&path), &options) {
                Ok(outcome) => {
                    if let Some(folder) = &self.common.report {
                        let place = format!("{:02}_{}", lines.len() + 1, name.replace([' ', ','], "_"));
                        outcome.report()?.write(&folder.join(&place))?;
                        links
                            .push((format!("{place}/index.html"), format!("{name}: {}", outcome.verdict.grade.word())));
                    }
                    Ok((outcome.judgement, outcome.verdict))
                }
                Err(why) => Err(why.to_string()),
            };
            lines.push((name, played));
        }
        let table = verdicts_table(&format!("{} recordings, a line each", lines.len()), &lines);
        let told: Vec<TableLine<'_>> = lines.iter().map(TableLine::of).collect();
        self.common.finish(std::slice::from_ref(&table), &told, || {
            let mut report = Report::new("Recordings replayed", "Each by itself: they are of different sessions.");
            report.links(&links);
            report.table(&table);
            Ok(report)
        })?;
        let bad = lines.iter().filter(|(_, played)| matches!(played, Ok((_, verdict)) if verdict.is_wrong)).count();
        let unread = lines.iter().filter(|(_, played)| played.is_err()).count();
        if unread == lines.len() {
            return Err(RunError::Usage(format!("none of the {unread} recordings could be read")));
        }
        if bad > 0 {
            return Err(RunError::Bad(format!("{bad} of {} recordings are bad", lines.len())));
        }
        Ok(())
    }

    /// The recordings of a file with several sessions, of a folder, or those that were named: name, place, how it is read.
    fn parts(
        &self,
        import: &ImportOptions,
        sessions: usize,
    ) -> Result<Vec<(String, PathBuf, ImportOptions)>, RunError> {
        if sessions > 0 {
            let part = |number: usize| {
                let options = ImportOptions { session: Some(number), ..import.clone() };
                (format!("{}, session {number}", name_of(&self.inputs[0])), self.inputs[0].clone(), options)
            };
            return Ok((1..=sessions).map(part).collect());
        }
        let paths = match self.inputs.as_slice() {
            [folder] if folder.is_dir() => recordings_of(folder)?,
            inputs => inputs.to_vec(),
        };
        Ok(paths.into_iter().map(|path| (name_of(&path), path, import.clone())).collect())
    }
}

/// One of several recordings as JSON.
#[derive(Serialize)]
struct TableLine<'a> {
    recording: &'a str,
    #[serde(skip_serializing_if = "Option::is_none")]
    verdict: Option<&'a Verdict>,
    #[serde(skip_serializing_if = "Option::is_none")]
    judgement: Option<&'a Judgement>,
    #[serde(skip_serializing_if = "Option::is_none")]
    error: Option<&'a str>,
}

impl<'a> TableLine<'a> {
    fn of((name, played): &'a Played) -> Self {
        let line = played.as_ref().ok();
        let error = played.as_ref().err().map(String::as_str);
        Self { recording: name, verdict: line.map(|line| &line.1), judgement: line.map(|line| &line.0), error }
    }
}

/// Whether a folder holds two recordings or more.
fn holds_recordings(folder: &Path) -> bool {
    let is_recording = |path: &PathBuf| {
        let mut start = [0; START.len()];
        let text = File::open(path).and_then(unzipped);
        text.is_ok_and(|mut text| text.read_exact(&mut start).is_ok()) && start == *START
    };
    folder.is_dir()
        && recordings_of(folder).is_ok_and(|paths| paths.iter().filter(|path| is_recording(path)).count() > 1)
}

/// The files of a folder that may be recordings: tables, zips and bags.
fn recordings_of(folder: &Path) -> Result<Vec<PathBuf>, RunError> {
    let endings = [".csv", ".csv.gz", ".txt", ".zip", ".mcap", ".parquet", ".arrow", ".feather"];
    let mut paths = files_of(folder)?;
    paths.retain(|path| {
        let name = name_of(path).to_lowercase();
        !name.starts_with('.') && endings.iter().any(|ending| name.ends_with(ending))
    });
    Ok(paths)
}
