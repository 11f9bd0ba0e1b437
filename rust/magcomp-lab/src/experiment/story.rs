//! One recording as a story: what each method makes of a magnet.

use super::compare_recording::{FIELD_UT, NOISE_UT, push_inertial};
use super::put_on::{Course, Drawn, Heading, HeadingJudge, middle_s, picture, with_magnet};
use crate::baseline::{Contestant, Known};
use magcomp::MagneticSample;
use magcomp_recordings::recording::Recording;
use magcomp_replay::error::RunError;
use magcomp_replay::plot::Colour;
use serde::Serialize;

/// The methods with their one free number, their names, and the colours of those that are drawn.
const TOLD: [(Contestant, f64, &str, Option<Colour>); 5] = [
    (Contestant::None, 0.0, "raw field", Some(Colour::Grey)),
    (Contestant::PaperHalfRange, 0.5, "the paper's method", None),
    (Contestant::Adaptive, 0.0, "magcomp, magnetometer alone: corrected sample", None),
    (Contestant::VqfRaw, 9.0, "VQF on the raw field", Some(Colour::Orange)),
    (Contestant::Aided, 0.0, "magcomp: heading", Some(Colour::Blue)),
];

/// What a method's heading came to.
#[derive(Clone, Debug, Serialize)]
pub struct Told {
    pub method: &'static str,
    #[serde(flatten)]
    pub heading: Option<Heading>,
    #[serde(skip)]
    colour: Option<Colour>,
    #[serde(skip)]
    course: Course,
}

/// All methods on a recording, in the order of the tables.
#[derive(Clone, Debug, Serialize)]
pub struct Story {
    pub recording: String,
    /// Second after the first row from which on a magnet was added by arithmetic, and from which on headings are judged.
    pub magnet_s: Option<f64>,
    /// The raw field first; magcomp's heading is the last.
    pub methods: Vec<Told>,
}

impl Story {
    /// Of a recording as it is, or with a magnet put on in its middle.
    pub fn of(recording: &Recording, puts_on: bool) -> Result<Self, RunError> {
        let extent = recording.extent();
        let on_s = puts_on.then(|| middle_s(&extent));
        let known = Known {
            seed: 0,
            noise_ut: NOISE_UT,
            field_ut: FIELD_UT,
            parameters: None,
            initial: None,
            reference: false,
        };
        let mut methods = Vec::new();
        for (contestant, value, method, colour) in TOLD {
            let Some(mut running) = contestant.make(value, &known)? else { continue };
            let mut judge = HeadingJudge::new(&extent, on_s);
            for row in recording.rows.iter().cloned().map(|row| with_magnet(row, on_s.unwrap_or(f64::INFINITY))) {
                if contestant.is_aided() {
                    push_inertial(running.as_mut(), &row);
                }
                running.push(&MagneticSample { time_ns: row.time_ns, field_ut: row.field_ut });
                judge.add(&row, running.latest(&row.field_ut).as_ref(), running.sigma_deg());
            }
            methods.push(Told { method, heading: judge.heading(0.0), colour, course: judge.course() });
        }
        Ok(Self { recording: recording.name(), magnet_s: on_s.map(|on_s| on_s - extent.start_s), methods })
    }

    /// Rms heading error of a method, degrees.
    pub fn rms_deg(&self, method: &str) -> f64 {
        self.methods.iter().find(|told| told.method == method).map_or(f64::NAN, Told::rms_deg)
    }

    /// The heading error over time.
    pub fn picture(&self, happened: &[(f64, &str)]) -> Result<String, RunError> {
        let line = |told: &'_ Told| -> Option<(String, Colour)> {
            let digits = usize::from(told.rms_deg() < 10.0);
            Some((format!("{} {:.digits$}", told.method, told.rms_deg()), told.colour?))
        };
        let drawn: Vec<Drawn<'_>> = (self.methods.iter())
            .filter_map(|told| line(told).map(|(name, colour)| Drawn { name, colour, course: &told.course }))
            .collect();
        picture(&drawn, happened)
    }
}

impl Told {
    fn rms_deg(&self) -> f64 {
        self.heading.map_or(f64::NAN, |heading| heading.rms_deg)
    }
}
