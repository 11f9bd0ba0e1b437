//! Lines that begin with a time and the name of their sensor, in either order, as competitions and many loggers write them; the rest of a line is the
//! value, and of an uncalibrated sensor the system's estimate of its bias:
//!
//! ```text
//! 1574572522414<tab>TYPE_MAGNETIC_FIELD_UNCALIBRATED<tab>x<tab>y<tab>z<tab>bias x<tab>bias y<tab>bias z<tab>accuracy
//! ```
//!
//! uT, rad/s and m/s^2 with Android's sign; the time is in the unit in which the field's steps are those of a sensor. Tabs, semicolons, commas or
//! blanks stand between the cells.

use super::document::Document;
use super::layout::SECOND_NS;
use super::names::{likeness, sensor_in, unit_of_steps};
use super::session::Session;
use super::sheet::{Cells, Sheet, is_word};
use super::stream::Stream;
use super::units::{Kind, Units};
use crate::error::RecordingError;
use crate::recording::Delimiter;
use magcomp::nalgebra::Vector3;

/// Bytes of a file that tell its form, and how many lines of the field they hold at least.
const START: usize = 100_000;
const FEWEST: usize = 2;
/// Words of what the system makes of its sensors.
const NO_SENSORS: [&str; 2] = ["grav", "vector"];
/// Lines of the field that tell the unit of time.
const TIMED: usize = 200;

/// Where a line has its time and the name of its sensor; the three numbers of its value follow both.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Form {
    time: usize,
    kind: usize,
    delimiter: Delimiter,
}

impl Form {
    /// The sensor of a line, and whether its value is uncalibrated; none where the line is of another form, or of no sensor that is read.
    fn sensor(self, cells: &Cells<'_>) -> Option<(Kind, bool)> {
        let word = cells.text(self.kind).to_lowercase();
        let kind = sensor_in(&word).filter(|_| is_word(&word) && !is_word(&cells.text(self.time)))?;
        let is_other = NO_SENSORS.iter().any(|other| word.contains(other));
        let has_value = cells.vector(self.value(0)).is_ok_and(|value| value.is_some());
        (has_value && !is_other).then_some((kind, word.contains("uncal")))
    }

    /// The three cells behind so many values.
    fn value(self, values: usize) -> [usize; 3] {
        let first = 1 + self.time.max(self.kind) + 3 * values;
        [first, first + 1, first + 2]
    }

    /// That of a file; none of a table whose header names sensors.
    fn of(document: &Document) -> Option<Self> {
        let start = Document::of_text(document.path.clone(), document.text[..document.text.len().min(START)].to_vec());
        if likeness(&Sheet::new(&start).header) >= 3 {
            return None;
        }
        let marks = [b'\t', b';', b','].map(Delimiter::Mark).into_iter().chain([Delimiter::Blanks]);
        let forms = marks.flat_map(|delimiter| [(0, 1), (1, 0)].map(|(time, kind)| Self { time, kind, delimiter }));
        forms.into_iter().find(|form| {
            let mut found = 0;
            // the last line of the part may be cut: its error is no matter
            let _ = Sheet::of_lines(&start, form.delimiter).lines(|cells| {
                found += usize::from(form.sensor(cells).is_some_and(|(kind, _)| kind == Kind::Field));
                if found < FEWEST { Ok(()) } else { Err(cells.wrong(0, "enough")) }
            });
            found >= FEWEST
        })
    }
}

/// Whether a file is of this form.
pub(super) fn is_log(document: &Document) -> bool {
    Form::of(document).is_some()
}

pub(super) fn read(documents: &[Document], units: &Units) -> Result<Session, RecordingError> {
    let mut all = Sensors::default();
    let mut first: Option<&Document> = None;
    for document in documents {
        let Some(form) = Form::of(document) else { continue };
        if let Some(first) = first.replace(document) {
            return Err(RecordingError::several(&first.path, &document.path));
        }
        let sheet = Sheet::of_lines(document, form.delimiter);
        let unit_ns = units.time_ns.or_else(|| time_unit(&sheet, form)).unwrap_or(SECOND_NS);
        let mut joined = 0;
        let cut = sheet.lines(|cells| {
            let Some((kind, is_uncalibrated)) = form.sensor(cells) else { return Ok(()) };
            let time_ns = cells.time_ns(form.time, unit_ns)?;
            let value = form.value(0);
            let Some(measured) = cells.vector(value)? else { return Ok(()) };
            let factor = units.factor(kind).unwrap_or(1.0);
            let places = |column: usize| move || [cells.place(form.time), cells.place(column)];
            all.stream(kind, is_uncalibrated).add(time_ns, measured * factor, places(value[0]))?;
            let bias = form.value(1);
            if kind == Kind::Field && is_uncalibrated && cells.is_number(bias[2]) {
                let system = (measured - cells.vector(bias)?.unwrap_or_default()) * factor;
                all.uncalibrated.system.add(time_ns, system, places(bias[0]))?;
            }
            joined += usize::from(
                (bias[0]..cells.len()).any(|column| sensor_in(&cells.text(column).to_lowercase()).is_some()),
            );
            Ok(())
        })?;
        let notes = &mut all.uncalibrated;
        notes.notes.extend(cut);
        if joined > 0 {
            let path = document.path.display();
            notes.warnings.push(format!("{path}: {joined} lines hold two records, of which the second was left out"));
        }
        notes.is_time_told = units.time_ns.is_some();
    }
    Ok(all.settle())
}

/// The unit of the times, by the steps from one sample of the field to the next of the same kind.
fn time_unit(sheet: &Sheet<'_>, form: Form) -> Option<i64> {
    let mut times = [Vec::new(), Vec::new()];
    let _ = sheet.lines(|cells| {
        if let Some((Kind::Field, is_uncalibrated)) = form.sensor(cells) {
            times[usize::from(is_uncalibrated)].push(cells.number(form.time)?);
        }
        if times.iter().all(|times| times.len() < TIMED) { Ok(()) } else { Err(cells.wrong(0, "enough")) }
    });
    let [calibrated, uncalibrated] = times;
    unit_of_steps(if uncalibrated.len() > calibrated.len() { &uncalibrated } else { &calibrated })
}

/// The sensors of a log that may hold each both uncalibrated and as the system calibrates it.
#[derive(Default)]
pub(super) struct Sensors {
    /// Whose samples are uncalibrated; with all else of the session.
    pub uncalibrated: Session,
    pub calibrated: Session,
}

impl Sensors {
    pub fn stream(&mut self, kind: Kind, is_uncalibrated: bool) -> &mut Stream<Vector3<f64>> {
        if is_uncalibrated { self.uncalibrated.stream(kind) } else { self.calibrated.stream(kind) }
    }

    /// Samples of the magnetometer.
    pub fn samples(&self) -> usize {
        self.uncalibrated.raw.events.len() + self.calibrated.raw.events.len()
    }

    /// The uncalibrated sensors, and the others where these are not there; the system's field is the calibrated one, else the uncalibrated one less its
    /// bias.
    pub fn settle(self) -> Session {
        let Self { uncalibrated: mut session, calibrated } = self;
        if session.raw.events.is_empty() && !calibrated.raw.events.is_empty() {
            session.raw = calibrated.raw;
            let note = "the magnetometer is the one that the system calibrates: the log has no uncalibrated one";
            session.notes.push(note.to_owned());
        } else if !calibrated.raw.events.is_empty() {
            session.system = calibrated.raw;
        }
        for (uncalibrated, calibrated) in [(&mut session.rate, calibrated.rate), (&mut session.up, calibrated.up)] {
            if uncalibrated.events.is_empty() {
                *uncalibrated = calibrated;
            }
        }
        session
    }
}
