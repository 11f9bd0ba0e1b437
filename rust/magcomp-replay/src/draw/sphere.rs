//! The sphere: raw samples lie on an ellipsoid h_m = M h + b, corrected ones on a sphere of radius |h|. Samples are thinned as they
//! come, so that memory does not grow with a recording.

use crate::play::Step;
use magcomp::nalgebra::Vector3;
use magcomp::{Calibration, Event};
use magcomp_recordings::recording::{Extent, Row};
use serde::Serialize;

/// Samples kept, at most.
const MOST: usize = 4000;
/// Samples that an epoch needs to be shown.
pub(super) const FEWEST: usize = 20;
/// Events whose onsets are closer than this share a mark, ns: the later decision is about the same change.
const TOGETHER_NS: i64 = 500_000_000;
/// The page that turns and scrubs.
const PAGE: &str = include_str!("sphere.html");
/// Where the page's data go.
const DATA: &str = "/*DATA*/";

/// A sample of the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    /// s after the first row.
    pub time_s: f64,
    pub raw: Vector3<f64>,
    pub corrected: Option<Vector3<f64>>,
    /// The calibration in force, by its place in the list.
    pub calibration: Option<usize>,
}

/// A stretch of time between two decided changes.
#[derive(Clone, Debug)]
pub(super) struct Epoch<'a> {
    /// The event that began the stretch; none for the first.
    pub event: Option<Event>,
    /// From when to when, s after the first row.
    pub span_s: (f64, f64),
    pub samples: &'a [Sample],
    /// In force at its end.
    pub calibration: Option<Calibration>,
}

/// The sphere of a replay in the making.
#[derive(Clone, Debug, Default)]
pub struct Sphere {
    extent: Extent,
    every: usize,
    rows: usize,
    samples: Vec<Sample>,
    calibrations: Vec<Calibration>,
    events: Vec<Event>,
    course: Course,
}

/// The page's data over time; as many of each as there are samples.
#[derive(Clone, Debug, Default, Serialize)]
struct Course {
    heading: Vec<Option<f64>>,
    sigma: Vec<Option<f64>>,
    dip: Vec<Option<f64>>,
    status: Vec<&'static str>,
}

impl Sphere {
    /// For a recording of this extent.
    pub fn new(extent: &Extent) -> Self {
        Self { extent: *extent, every: extent.rows.div_ceil(MOST).max(1), ..Self::default() }
    }

    /// The next row and the compensator's step for it.
    pub fn add(&mut self, row: &Row, step: &Step) {
        let Step { reading, calibration, .. } = step;
        if let Some(event) = reading.event.filter(|event| self.events.last() != Some(event)) {
            self.events.push(event);
        }
        let shown = self.rows.is_multiple_of(self.every) && row.field_ut.iter().all(|value| value.is_finite());
        self.rows += 1;
        if !shown {
            return;
        }
        if let Some(calibration) = calibration.filter(|calibration| self.calibrations.last() != Some(calibration)) {
            self.calibrations.push(calibration);
        }
        let time_s = row.time_s - self.extent.start_s;
        self.samples.push(Sample {
            time_s,
            raw: row.field_ut,
            corrected: reading.field_ut,
            calibration: calibration.map(|_| self.calibrations.len() - 1),
        });
        let course = &mut self.course;
        course.heading.push(reading.heading.map(|heading| rounded(heading.heading_deg, 100.0)));
        course.sigma.push(reading.heading.and_then(|heading| heading.heading_sigma_deg).map(|s| rounded(s, 100.0)));
        course
            .dip
            .push(reading.heading.and_then(|heading| heading.inclination_deg).map(|dip_deg| rounded(dip_deg, 100.0)));
        course.status.push(reading.status.label());
    }

    /// The stretches between decided changes that have samples enough.
    pub(super) fn epochs(&self) -> Vec<Epoch<'_>> {
        let seconds = |time_ns: i64| (time_ns - self.extent.start_ns) as f64 / 1e9;
        let mut begins = vec![(None, f64::NEG_INFINITY)];
        begins.extend(self.events.iter().map(|event| (Some(*event), seconds(event.since_ns))));
        let ends = begins.iter().skip(1).map(|(_, begin_s)| *begin_s).chain([f64::INFINITY]).collect::<Vec<_>>();
        let epochs = begins.into_iter().zip(ends).filter_map(|((event, from_s), to_s)| {
            let first = self.samples.partition_point(|sample| sample.time_s < from_s);
            let last = self.samples.partition_point(|sample| sample.time_s < to_s);
            let samples = self.samples.get(first..last).filter(|samples| samples.len() >= FEWEST)?;
            let span_s = (samples[0].time_s, samples[samples.len() - 1].time_s);
            let calibration = samples[samples.len() - 1].calibration.map(|index| self.calibrations[index]);
            Some(Epoch { event, span_s, samples, calibration })
        });
        epochs.collect()
    }

    /// The onsets of the events so far, s after the first row, each with the kinds that were decided for it.
    pub(super) fn marks(&self) -> Vec<(f64, String)> {
        marks(&self.events, self.extent.start_ns)
    }

    /// The interactive page; `recording` is the recording's name.
    pub(super) fn page(&self, recording: &str) -> String {
        PAGE.replace(DATA, &self.data(recording).replace('<', "\\u003c"))
    }

    fn data(&self, recording: &str) -> String {
        #[derive(Serialize)]
        struct Fit {
            b: [f64; 3],
            m: [f64; 9],
            f: f64,
        }
        #[derive(Serialize)]
        struct Mark {
            t: f64,
            kind: String,
        }
        #[derive(Serialize)]
        struct Data<'a> {
            title: &'a str,
            t: Vec<f64>,
            raw: Vec<[f64; 3]>,
            fixed: Vec<Option<[f64; 3]>>,
            fit: Vec<Option<usize>>,
            fits: Vec<Fit>,
            marks: Vec<Mark>,
            #[serde(flatten)]
            course: &'a Course,
        }
        let tenths = |v: &Vector3<f64>| [v.x, v.y, v.z].map(|value| rounded(value, 100.0));
        let fit = |calibration: &Calibration| Fit {
            b: tenths(calibration.hard_iron_ut()),
            // row by row; M is symmetric
            m: std::array::from_fn(|i| rounded(calibration.soft_iron()[(i / 3, i % 3)], 1e5)),
            f: rounded(calibration.field_strength_ut(), 1000.0),
        };
        let data = Data {
            title: recording,
            t: self.samples.iter().map(|sample| rounded(sample.time_s, 1000.0)).collect(),
            raw: self.samples.iter().map(|sample| tenths(&sample.raw)).collect(),
            fixed: self.samples.iter().map(|sample| sample.corrected.as_ref().map(tenths)).collect(),
            fit: self.samples.iter().map(|sample| sample.calibration).collect(),
            fits: self.calibrations.iter().map(fit).collect(),
            marks: self.marks().into_iter().map(|(t, kind)| Mark { t: rounded(t, 1000.0), kind }).collect(),
            course: &self.course,
        };
        serde_json::to_string(&data).expect("numbers and names are JSON")
    }
}

fn rounded(value: f64, parts: f64) -> f64 {
    (value * parts).round() / parts
}

/// The onsets of events, s from the start, each with the kinds that were decided for it, in order.
fn marks(events: &[Event], start_ns: i64) -> Vec<(f64, String)> {
    let mut marks: Vec<(i64, Vec<String>)> = Vec::new();
    for event in events {
        let kind = format!("{:?}", event.kind);
        match marks.last_mut() {
            Some((since_ns, kinds)) if (event.since_ns - *since_ns).abs() < TOGETHER_NS => {
                if kinds.last() != Some(&kind) {
                    kinds.push(kind);
                }
            }
            _ => marks.push((event.since_ns, vec![kind])),
        }
    }
    let seconds = |since_ns: i64| (since_ns - start_ns) as f64 / 1e9;
    marks.into_iter().map(|(since_ns, kinds)| (seconds(since_ns), kinds.join(", then "))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use magcomp::EventKind;

    #[test]
    fn decisions_about_one_change_share_a_mark() {
        let event = |kind, since_s: f64, decided_s: f64| Event {
            kind,
            since_ns: (since_s * 1e9) as i64,
            decided_ns: (decided_s * 1e9) as i64,
        };
        let events = [
            event(EventKind::PlaceChanged, 11.0, 12.0),
            event(EventKind::PlaceChanged, 11.0, 14.0),
            event(EventKind::DeviceStep, 11.1, 18.0),
            event(EventKind::DeviceStepBack, 30.0, 31.0),
        ];
        let found = marks(&events, 1_000_000_000);
        let expected = [(10.0, "PlaceChanged, then DeviceStep"), (29.0, "DeviceStepBack")];
        assert_eq!(found, expected.map(|(s, name)| (s, name.to_owned())));
    }
}
