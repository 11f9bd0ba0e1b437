//! One recording as a story: a magnet is put on a sensor and taken off again, and the heading error of the raw field, of the paper's method and of
//! ours over time.

use super::compare_recording::{RecordingScore, compare_rows};
use crate::baseline::Contestant;
use crate::error::LabError;
use crate::plot::{Colour, Layers, Panel, Series, draw};
use crate::recording::Recording;
use std::ops::Range;

/// The methods, their names, and their colours.
const TOLD: [(Contestant, &str, Colour); 3] = [
    (Contestant::None, "raw", Colour::Grey),
    (Contestant::PaperHalfRange, "the paper's method", Colour::Orange),
    (Contestant::Aided, "ours", Colour::Blue),
];
/// Largest error shown, degrees: more is drawn there.
const SHOWN_DEG: f64 = 60.0;

/// What the story comes to.
#[derive(Clone, Debug)]
pub struct Story {
    /// In the order of raw, the paper's and ours.
    scores: Vec<RecordingScore>,
    magnet_s: Range<f64>,
}

impl Story {
    /// Of a recording on which a magnet sat from when to when, s after its first row.
    ///
    /// # Errors
    /// [`LabError::Config`].
    pub fn of(recording: &Recording, magnet_s: Range<f64>) -> Result<Self, LabError> {
        let methods = TOLD.map(|(contestant, ..)| contestant);
        let scores = compare_rows(&recording.extent(), recording.rows.iter().cloned().map(Ok), &methods, 0)?;
        // with the gyroscope or without, each in its place
        let find = |contestant: &Contestant| scores.iter().find(|score| score.name == contestant.name()).cloned();
        Ok(Self { scores: methods.iter().filter_map(find).collect(), magnet_s })
    }

    /// Rms heading errors up to one constant, degrees: raw, the paper's, ours.
    #[must_use]
    pub fn errors_deg(&self) -> Vec<f64> {
        self.scores.iter().map(|score| score.vectors.heading.map_or(f64::NAN, |heading| heading.rms_deg)).collect()
    }

    /// The heading error over time.
    ///
    /// # Errors
    /// [`LabError::Plot`].
    pub fn picture(&self) -> Result<String, LabError> {
        let series = self.scores.iter().zip(TOLD).map(|(score, (_, name, colour))| {
            let name = format!("{name}: {:.0} deg rms", score.vectors.heading.map_or(f64::NAN, |it| it.rms_deg));
            Series::new(&name, colour, score.course_deg.iter().map(|(time_s, error)| (*time_s, error.min(SHOWN_DEG))))
        });
        let names = [(self.magnet_s.start, "a magnet is put on"), (self.magnet_s.end, "and taken off")];
        let panel = Panel {
            title: "heading error".to_owned(),
            x_label: "s".to_owned(),
            y_label: format!("deg (at most {SHOWN_DEG:.0} are shown)"),
            y_range: Some((0.0, SHOWN_DEG * 1.15)),
            series: series.collect(),
            layers: Layers { marks: names.map(|(at_s, name)| (at_s, name.to_owned())).to_vec(), ..Layers::default() },
        };
        draw(&[panel], 1, (1100, 340))
    }
}
