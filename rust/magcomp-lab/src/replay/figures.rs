//! A replay as a picture over time: heading with its sigma, total field and dip, M and b with their sigmas, status and events;
//! with a reference the errors too. Then the sphere.

use super::circle::{Circle, off_deg};
use super::directions::azimuth_deg;
use super::marks::marks;
use super::player::Step;
use super::sizes::Sizes;
use super::sphere::Sphere;
use super::sphere_view::show;
use crate::error::LabError;
use crate::plot::{Band, Colour, FINE, Layers, Panel, Series, Span, Thin, draw};
use crate::recording::{Extent, Recording, Row};
use crate::report::Report;
use magcomp::nalgebra::Vector3;
use magcomp::{Calibration, Event};

/// Lanes of the status strip, from the bottom, and their colours.
const LANES: [(&str, Colour); 6] = [
    ("rejected", Colour::Purple),
    ("disturbed", Colour::Red),
    ("suspect", Colour::Orange),
    ("tracking", Colour::Green),
    ("held", Colour::Blue),
    ("collecting", Colour::Grey),
];
/// Shown of the heading error: this many times the two sigmas that half of the readings stay below, degrees at least and at most.
/// Of the total field: this many times the length that most corrected samples stay below.
const ROOM: f64 = 2.0;
const LEAST_DEG: f64 = 5.0;
const MOST_DEG: f64 = 60.0;
/// Resolution of total fields, uT.
const FIELD_STEP_UT: f64 = 0.001;
/// Resolution of sigmas, degrees.
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
    band: Band,
    system: Thin,
    total_field: Sizes,
    raw_field: Sizes,
    heading: Vec<(f64, f64)>,
    heading_band: Band,
    dip: Thin,
    truth: [Thin; 3],
    /// b, then M_xx M_yy M_zz less 1 and M_xy M_xz M_yz, with one sigma to both sides.
    parameters: [Thin; 9],
    parameter_bands: [Band; 9],
    sphere: Sphere,
    window: Thin,
    sigma_t: Thin,
    any_sigma_t: bool,
    /// For each lane of the status strip, from when to when, s.
    lanes: [Vec<(f64, f64)>; LANES.len()],
    /// The lane of the latest row.
    lane: Option<usize>,
    events: Vec<Event>,
}

/// Azimuths as a line about their median, which is known only at the end. Within a stretch an azimuth is stored by its
/// difference from another one, so that the lowest and the highest are those of one turn.
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
            system: line(),
            total_field: Sizes::new(FIELD_STEP_UT),
            raw_field: Sizes::new(FIELD_STEP_UT),
            heading: Vec::new(),
            heading_band: Vec::new(),
            dip: line(),
            truth: [line(), line(), line()],
            parameters: std::array::from_fn(|_| line()),
            parameter_bands: Default::default(),
            sphere: Sphere::new(extent),
            window: line(),
            sigma_t: line(),
            any_sigma_t: false,
            lanes: Default::default(),
            lane: None,
            events: Vec::new(),
        }
    }

    /// The next row and the compensator's step for it.
    pub fn add(&mut self, row: &Row, step: &Step) {
        let Step { reading, calibration, sigma, .. } = step;
        self.sphere.add(row, step);
        let time_s = row.time_s - self.extent.start_s;
        self.raw.add(time_s, row.field_ut.norm());
        self.corrected.add(time_s, reading.field_ut.map_or(f64::NAN, |c| c.norm()));
        self.system.add(time_s, row.system_ut.map_or(f64::NAN, |system| system.norm()));
        self.raw_field.add(row.field_ut.norm());
        reading.field_ut.iter().for_each(|c| self.total_field.add(c.norm()));
        self.dip.add(time_s, reading.heading.map_or(f64::NAN, |heading| heading.inclination_deg));

        let azimuth = |vector: Option<Vector3<f64>>| azimuth_deg(row, &vector?);
        self.raw_error.add(time_s, azimuth(Some(row.field_ut)));
        self.corrected_error.add(time_s, azimuth(reading.field_ut));
        self.heading_error.add(time_s, azimuth(reading.filtered_field_ut.or(reading.field_ut)));
        let two_sigma = reading.heading.and_then(|heading| Some(2.0 * heading.heading_sigma_deg?));
        two_sigma.iter().for_each(|sigma| self.two_sigma.add(*sigma));
        // the heading's line runs within the noise of the samples: one point a pixel is enough
        let sampled = self.rows.is_multiple_of(self.extent.rows.div_ceil(PIXELS).max(1));
        if sampled {
            let sigma = two_sigma.unwrap_or(f64::NAN);
            self.band.push((time_s, -sigma, sigma));
            let heading_deg = reading.heading.map_or(f64::NAN, |heading| heading.heading_deg);
            // through north the line begins anew on the other side
            if self.heading.last().is_some_and(|(_, before)| (heading_deg - before).abs() > 180.0) {
                self.heading.push((time_s, f64::NAN));
                self.heading_band.push((time_s, f64::NAN, f64::NAN));
            }
            self.heading.push((time_s, heading_deg));
            self.heading_band.push((time_s, heading_deg - sigma, heading_deg + sigma));
        }

        let parameters = calibration.map(|calibration| parameters(&calibration));
        for i in 0..9 {
            let value = parameters.map_or(f64::NAN, |parameters| parameters[i]);
            self.parameters[i].add(time_s, value);
            if sampled {
                let sigma = sigma.map_or(f64::NAN, |sigma| sigma[i]);
                self.parameter_bands[i].push((time_s, value - sigma, value + sigma));
            }
        }
        for i in 0..3 {
            self.truth[i].add(time_s, row.hard_iron_ut.map_or(f64::NAN, |b| b[i]));
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

    /// Adds the pictures to a report; `recording` is the recording's name.
    ///
    /// # Errors
    /// [`LabError::Plot`].
    pub fn finish(self, report: &mut Report, name: &str, recording: &str) -> Result<(), LabError> {
        let fine = self.extent.rows > FINE;
        let series = |name: &str, colour, points| Series { fine, ..Series::new(name, colour, points) };
        let usual = self.total_field.at(980);
        // a raw field that is far larger is left out, so that the corrected one can be seen
        let beyond = usual.zip(self.raw_field.at(500)).filter(|(usual, raw)| *raw > ROOM * usual);
        let title = beyond.map_or_else(
            || "total field".to_owned(),
            |(_, raw)| format!("total field (raw: mostly {raw:.0} uT, beyond this)"),
        );
        let system = if self.extent.system { "the system's" } else { "" };
        let mut panels = vec![
            Panel {
                y_range: Some((0.0, 360.0)),
                layers: Layers { bands: vec![(Colour::Blue, self.heading_band)], ..Layers::default() },
                ..panel("heading, and its 2-sigma band", "deg", vec![series("", Colour::Blue, self.heading)])
            },
            Panel {
                y_range: beyond.map(|(usual, _)| (0.0, ROOM * usual)),
                ..panel(
                    &title,
                    "uT",
                    vec![
                        series("raw", Colour::Grey, self.raw.points()),
                        series(system, Colour::Green, self.system.points()),
                        series("compensated", Colour::Blue, self.corrected.points()),
                    ],
                )
            },
            panel(
                "dip: angle of the field below the horizon",
                "deg",
                vec![series("", Colour::Blue, self.dip.points())],
            ),
        ];
        if self.extent.first_reference.is_some() {
            // the heading errors of raw and corrected samples, then that of the published heading, closer, with its band
            panels.push(panel(
                "heading error against the reference",
                "deg",
                vec![
                    series("raw", Colour::Grey, self.raw_error.points()),
                    series("compensated", Colour::Blue, self.corrected_error.points()),
                ],
            ));
            let range = (ROOM * self.two_sigma.at(500).unwrap_or(MOST_DEG)).clamp(LEAST_DEG, MOST_DEG);
            panels.push(Panel {
                y_range: Some((-range, range)),
                layers: Layers { bands: vec![(Colour::Grey, self.band)], ..Layers::default() },
                ..panel(
                    "error of the heading given, and its 2-sigma band",
                    "deg",
                    vec![series("heading", Colour::Blue, self.heading_error.points())],
                )
            });
        }
        let truth = self.truth.map(Thin::points).into_iter().filter(|b| b.iter().any(|(_, b)| b.is_finite()));
        let truth = truth.map(|b| Series { dashed: true, ..series("", Colour::Grey, b) });
        let colours = [Colour::Blue, Colour::Orange, Colour::Green];
        let mut lines = self.parameters.map(Thin::points).into_iter().zip(self.parameter_bands);
        let mut three = |title: &str, unit: &str, names: [&str; 3], before: Vec<Series>| {
            let (mut all, mut bands) = (before, Vec::new());
            for ((name, colour), (line, band)) in names.into_iter().zip(colours).zip(lines.by_ref()) {
                all.push(series(name, colour, line));
                bands.push((colour, band));
            }
            Panel { layers: Layers { bands, ..Layers::default() }, ..panel(title, unit, all) }
        };
        panels.push(three("hard iron b, and one sigma", "uT", ["b_x", "b_y", "b_z"], truth.collect()));
        panels.push(three("soft iron M less 1, and one sigma", "", ["M_xx", "M_yy", "M_zz"], Vec::new()));
        panels.push(three("soft iron M, and one sigma", "", ["M_xy", "M_xz", "M_yz"], Vec::new()));
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
        let marks = marks(&self.events, self.extent.start_ns);
        // the moments of the events in every panel; the lowest names them
        for panel in &mut panels {
            panel.layers.marks = marks.iter().map(|(x, _)| (*x, String::new())).collect();
        }
        panels.push(Panel {
            layers: Layers {
                lanes: LANES.map(|(name, _)| name).to_vec(),
                spans: spans.collect(),
                marks,
                ..Layers::default()
            },
            ..panel("status, and events since when", "", Vec::new())
        });
        let error = match self.extent.first_reference {
            Some(_) => {
                " heading errors against the reference, up to one constant, the lower with the band of two sigmas that was given \
                 with it;"
            }
            None => "",
        };
        let band = match self.extent.first_reference {
            Some(_) => {
                " The heading's band also allows for errors that few references show: an uneven place, axes of the sensors that \
                 differ, an accelerometer that leans. A steep field multiplies them, and at rest they do not average out, so the \
                 band stays wide where the line is still."
            }
            None => "",
        };
        let caption = format!(
            "{recording}, all in one time: heading with two sigmas; total field and dip;{error} b and M with one sigma (dashed: the \
             true b, where it is known); status. Vertical lines: onsets of events, named below by the kinds that were decided.{band}"
        );
        show(&self.sphere, report, name, recording);
        report.figure(name, draw(&panels, 1, (1100, 220))?, &caption);
        Ok(())
    }
}

/// b (uT), M_xx M_yy M_zz less 1, M_xy M_xz M_yz: the order of `Compensator::covariance`.
fn parameters(calibration: &Calibration) -> [f64; 9] {
    let (b, m) = (calibration.hard_iron_ut(), calibration.soft_iron());
    [b.x, b.y, b.z, m.m11 - 1.0, m.m22 - 1.0, m.m33 - 1.0, m.m12, m.m13, m.m23]
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
