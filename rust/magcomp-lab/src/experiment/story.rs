//! One recording as a story: what each method makes of a magnet that is put on a sensor and taken off again.

use super::compare_recording::compare_rows;
use crate::baseline::Contestant;
use crate::error::LabError;
use crate::plot::{Colour, Layers, Panel, Series, draw};
use crate::replay::HeadingError;
use magcomp_recordings::recording::Recording;
use serde::Serialize;
use std::ops::Range;

/// The methods, their names, and the colours of those that are drawn.
const TOLD: [(Contestant, &str, Option<Colour>); 5] = [
    (Contestant::None, "raw field", Some(Colour::Grey)),
    (Contestant::PaperHalfRange, "the paper's method", Some(Colour::Orange)),
    (Contestant::VqfRaw, "VQF on the raw field", None),
    (Contestant::Adaptive, "magcomp, magnetometer alone: corrected sample", None),
    (Contestant::Aided, "magcomp: heading", Some(Colour::Ink)),
];
/// Largest error shown, degrees: more is drawn there.
const SHOWN_DEG: f64 = 60.0;
/// Size of the picture, pixels: README shows it 1.3 times as large, with letters of 12 pixels.
const SIZE: (u32, u32) = (640, 260);

/// What a method's heading came to.
#[derive(Clone, Debug, Serialize)]
pub struct Told {
    pub method: &'static str,
    /// Share of the rows with an answer, 0 to 1.
    pub answered: f64,
    pub heading: Option<HeadingError>,
    #[serde(skip)]
    colour: Option<Colour>,
    #[serde(skip)]
    course_deg: Vec<(f64, f64)>,
}

/// All methods on a recording, in the order of the tables.
#[derive(Clone, Debug, Serialize)]
pub struct Story {
    pub recording: String,
    /// The raw field first, then the paper's method; magcomp's heading is the last.
    pub methods: Vec<Told>,
}

impl Story {
    pub fn of(recording: &Recording) -> Result<Self, LabError> {
        let contestants = TOLD.map(|(contestant, ..)| contestant);
        let scores = compare_rows(&recording.extent(), recording.rows.iter().cloned().map(Ok), &contestants, 0)?;
        let told = |(contestant, method, colour): &(Contestant, &'static str, Option<Colour>)| {
            let score = scores.iter().find(|score| score.name == contestant.name())?;
            let course_deg = score.course_deg.clone();
            let (answered, heading) = (score.vectors.answered, score.vectors.heading);
            Some(Told { method, answered, heading, colour: *colour, course_deg })
        };
        Ok(Self { recording: recording.name(), methods: TOLD.iter().filter_map(told).collect() })
    }

    /// Rms heading errors up to one constant, degrees, of the methods that are drawn: raw, the paper's, magcomp's.
    pub fn drawn_deg(&self) -> [f64; 3] {
        let mut drawn = self.methods.iter().filter(|told| told.colour.is_some()).map(Told::rms_deg);
        [(); 3].map(|()| drawn.next().unwrap_or(f64::NAN))
    }

    /// The heading error over time; a magnet sat there from when to when, s after the first row.
    pub fn picture(&self, magnet_s: &Range<f64>) -> Result<String, LabError> {
        let series = self.methods.iter().filter_map(|told| {
            let digits = usize::from(told.rms_deg() < 10.0);
            let name = format!("{} {:.digits$}", told.method, told.rms_deg());
            Some(Series::new(&name, told.colour?, told.course_deg.iter().map(|(s, error)| (*s, error.min(SHOWN_DEG)))))
        });
        let names = [(magnet_s.start, "a magnet is put on"), (magnet_s.end, "and taken off")];
        let panel = Panel {
            // room below for a line near 0
            y_range: Some((-3.0, SHOWN_DEG * 1.15)),
            layers: Layers { marks: names.map(|(at_s, name)| (at_s, name.to_owned())).to_vec(), ..Layers::default() },
            ..Panel::new("", "s", "heading error, deg", series)
        };
        draw(&[panel], 1, SIZE)
    }
}

impl Told {
    fn rms_deg(&self) -> f64 {
        self.heading.map_or(f64::NAN, |heading| heading.rms_deg)
    }
}
