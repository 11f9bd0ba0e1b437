//! A replay as a picture over time: total field, heading error with the sigma that was given with it, hard iron, status.

use super::circle::{Circle, off_deg};
use super::judge::azimuth_deg;
use super::player::Step;
use super::sizes::Sizes;
use crate::error::LabError;
use crate::plot::{Colour, FINE, Layers, Panel, Series, Span, Thin, draw};
use crate::recording::{Extent, Recording, Row};
use crate::report::Report;
use magcomp::Event;
use magcomp::nalgebra::Vector3;

/// Lanes of the status strip, from the bottom, and their colours.
const LANES: [(&str, Colour); 6] = [
    ("rejected", Colour::Purple),
    ("disturbed", Colour::Red),
    ("suspect", Colour::Orange),
    ("tracking", Colour::Green),
    ("held", Colour::Blue),
    ("collecting", Colour::Grey),
];
/// Shown of the heading error: this many times the two sigmas that most readings stay below, degrees at least and at most.
const ROOM: f64 = 2.0;
const LEAST_DEG: f64 = 5.0;
const MOST_DEG: f64 = 60.0;
/// Least difference of sigmas that is told, degrees.
const SIGMA_STEP_DEG: f64 = 0.001;

/// Pixels across a picture: the band has about one point a pixel, and spans of a lane that are less apart are drawn as one.
const PIXELS: usize = 1000;

/// A replay as a picture, made row by row in memory that does not grow with it.
#[derive(Clone, Debug)]
pub struct Figures {
    extent: Extent,
    rows: usize,
    raw: Thin,
    corrected: Thin,
    raw_error: ErrorLine,
    corrected_error: ErrorLine,
    heading_error: ErrorLine,
    two_sigma: Sizes,
    band: Vec<(f64, f64, f64)>,
    truth: [Thin; 3],
    hard_iron: [Thin; 3],
    window: Thin,
    sigma_t: Thin,
    any_sigma_t: bool,
    /// For each lane of the status strip, from when to when, s.
    lanes: [Vec<(f64, f64)>; LANES.len()],
    /// The lane of the latest row.
    lane: Option<usize>,
    events: Vec<Event>,
}

/// Azimuths as a line about their median, which is known only at the end. Within a stretch an azimuth is told by its difference
/// from another one, so that the lowest and the highest are those of one turn.
#[derive(Clone, Debug)]
struct ErrorLine {
    azimuths: Circle,
    line: Thin,
}

impl ErrorLine {
    fn add(&mut self, time_s: f64, azimuth_deg: Option<f64>) {
        let near = self.line.present().map(|(_, azimuth_deg)| azimuth_deg);
        if let Some(azimuth_deg) = azimuth_deg {
            self.azimuths.add(azimuth_deg, None, true);
        }
        let turned = |azimuth_deg: f64| near.map_or(azimuth_deg, |near| near + off_deg(azimuth_deg, near));
        self.line.add(time_s, azimuth_deg.map_or(f64::NAN, turned));
    }

    fn points(self) -> Vec<(f64, f64)> {
        let centre_deg = self.azimuths.centre_deg();
        self.line.points().into_iter().map(|(x, azimuth_deg)| (x, off_deg(azimuth_deg, centre_deg))).collect()
    }
}

impl Figures {
    /// For a recording of this extent.
    #[must_use]
    pub fn new(extent: &Extent) -> Self {
        let line = || Thin::new(extent.rows);
        let error = || ErrorLine { azimuths: Circle::default(), line: line() };
        Self {
            extent: *extent,
            rows: 0,
            raw: line(),
            corrected: line(),
            raw_error: error(),
            corrected_error: error(),
            heading_error: error(),
            two_sigma: Sizes::new(SIGMA_STEP_DEG),
            band: Vec::new(),
            truth: [line(), line(), line()],
            hard_iron: [line(), line(), line()],
            window: line(),
            sigma_t: line(),
            any_sigma_t: false,
            lanes: Default::default(),
            lane: None,
            events: Vec::new(),
        }
    }

    /// The next row and what came out for it.
    pub fn add(&mut self, row: &Row, step: &Step) {
        let Step { reading, calibration, .. } = step;
        let time_s = row.time_s - self.extent.start_s;
        self.raw.add(time_s, row.field_ut.norm());
        self.corrected.add(time_s, reading.field_ut.map_or(f64::NAN, |c| c.norm()));

        let azimuth = |vector: Option<Vector3<f64>>| azimuth_deg(row, &vector?);
        self.raw_error.add(time_s, azimuth(Some(row.field_ut)));
        self.corrected_error.add(time_s, azimuth(reading.field_ut));
        self.heading_error.add(time_s, azimuth(reading.filtered_field_ut.or(reading.field_ut)));
        let two_sigma = reading.heading.and_then(|heading| Some(2.0 * heading.heading_sigma_deg?));
        two_sigma.iter().for_each(|sigma| self.two_sigma.add(*sigma));
        // what carries the heading goes through the noise of the samples: no more than one point a pixel is needed
        if self.rows.is_multiple_of((self.extent.rows / PIXELS).max(1)) {
            let sigma = two_sigma.unwrap_or(f64::NAN);
            self.band.push((time_s, -sigma, sigma));
        }

        for i in 0..3 {
            self.truth[i].add(time_s, row.hard_iron_ut.map_or(f64::NAN, |b| b[i]));
            self.hard_iron[i].add(time_s, calibration.map_or(f64::NAN, |calibration| calibration.hard_iron_ut()[i]));
        }
        self.window.add(time_s, reading.window as f64 / 2000.0);
        self.sigma_t.add(time_s, reading.sigma_t.unwrap_or(f64::NAN));
        self.any_sigma_t |= reading.sigma_t.is_some();
        self.add_status(time_s, reading.status.label());
        if let Some(event) = reading.event.filter(|event| self.events.last() != Some(event)) {
            self.events.push(event);
        }
        self.rows += 1;
    }

    /// Lengthens the span of the row before, then begins another one or goes on with one that is not a pixel away.
    fn add_status(&mut self, time_s: f64, label: &str) {
        if let Some(span) = self.lane.and_then(|lane| self.lanes[lane].last_mut()) {
            span.1 = time_s;
        }
        self.lane = LANES.iter().position(|(name, _)| *name == label);
        let Some(lane) = self.lane else { return };
        let pixel_s = self.extent.duration_s() / PIXELS as f64;
        match self.lanes[lane].last_mut() {
            Some(span) if time_s - span.1 < pixel_s => span.1 = time_s,
            _ => self.lanes[lane].push((time_s, time_s)),
        }
    }

    /// Adds what a number cannot show; `recording` is its name.
    ///
    /// # Errors
    /// [`LabError::Plot`].
    pub fn finish(self, report: &mut Report, name: &str, recording: &str) -> Result<(), LabError> {
        let fine = self.extent.rows > FINE;
        let series = |name: &str, colour, points| Series { fine, ..Series::new(name, colour, points) };
        let mut panels = vec![panel(
            "total field",
            "uT",
            vec![
                series("raw", Colour::Grey, self.raw.points()),
                series("compensated", Colour::Blue, self.corrected.points()),
            ],
        )];
        if self.extent.first_reference.is_some() {
            // everything's heading error, then that of what carries the heading, closer, with its band
            panels.push(panel(
                "heading error against the reference",
                "deg",
                vec![
                    series("raw", Colour::Grey, self.raw_error.points()),
                    series("compensated", Colour::Blue, self.corrected_error.points()),
                ],
            ));
            let range = (ROOM * self.two_sigma.at(900).unwrap_or(MOST_DEG)).clamp(LEAST_DEG, MOST_DEG);
            panels.push(Panel {
                y_range: Some((-range, range)),
                layers: Layers { band: self.band, ..Layers::default() },
                ..panel(
                    "error of the heading given, and its 2-sigma band",
                    "deg",
                    vec![series("heading", Colour::Blue, self.heading_error.points())],
                )
            });
        }
        let truth = self.truth.map(Thin::points).into_iter().filter(|b| b.iter().any(|(_, b)| b.is_finite()));
        let truth = truth.map(|b| Series { dashed: true, ..series("", Colour::Grey, b) });
        let axes = [("b_x", Colour::Blue), ("b_y", Colour::Orange), ("b_z", Colour::Green)];
        let estimated = self.hard_iron.map(Thin::points).into_iter().zip(axes);
        let estimated = estimated.map(|(b, (name, colour))| series(name, colour, b));
        panels.push(panel("hard iron", "uT", truth.chain(estimated).collect()));
        if self.any_sigma_t {
            panels.push(panel(
                "sigma_T, and window N / 2000",
                "",
                vec![
                    series("N / 2000", Colour::Grey, self.window.points()),
                    series("sigma_T", Colour::Blue, self.sigma_t.points()),
                ],
            ));
        }
        let spans = self.lanes.iter().enumerate().flat_map(|(lane, spans)| {
            spans.iter().map(move |(from, to)| Span { lane, from: *from, to: *to, colour: LANES[lane].1 })
        });
        let start_ns = self.extent.start_ns;
        let mark = |event: &Event| ((event.since_ns - start_ns) as f64 / 1e9, format!("{:?}", event.kind));
        panels.push(Panel {
            layers: Layers {
                lanes: LANES.map(|(name, _)| name).to_vec(),
                spans: spans.collect(),
                marks: self.events.iter().map(mark).collect(),
                ..Layers::default()
            },
            ..panel("status, and events since when", "", Vec::new())
        });
        let caption = format!(
            "{recording}: raw field (grey) and what the compensator made of it; heading error against the reference, with \
             the band of two sigmas that was given with it; hard iron (dashed: the truth, where it is known); status and events."
        );
        report.figure(name, draw(&panels, 1, (1100, 220))?, &caption);
        Ok(())
    }
}

/// Adds the picture of a replay in memory, as [`Figures`].
///
/// # Errors
/// [`LabError::Plot`].
pub fn figures(report: &mut Report, name: &str, recording: &Recording, steps: &[Step]) -> Result<(), LabError> {
    let mut figures = Figures::new(&recording.extent());
    recording.rows.iter().zip(steps).for_each(|(row, step)| figures.add(row, step));
    figures.finish(report, name, &recording.name())
}

fn panel(title: &str, y_label: &str, series: Vec<Series>) -> Panel {
    Panel {
        title: title.to_owned(),
        x_label: "time, s".to_owned(),
        y_label: y_label.to_owned(),
        series,
        ..Panel::default()
    }
}
