//! The pictures of a replay, drawn: heading and status over time, then the sphere, then why, one panel below the other.

use super::figures::{Figures, Inside, LANES};
use super::sphere_view::show;
use crate::error::RunError;
use crate::judge::off_deg;
use crate::plot::{Band, Colour, FINE, Layers, Panel, Series, Span, Thin, draw, x_axis};
use crate::report::{Moment, Report, Time};

/// The test ratio above which a sample is not used.
const GATE: f64 = 1.0;
/// Shown of the heading error: this many times the two sigmas that half of the readings stay below, degrees at least and at most.
/// Of the total field: this many times the length that most corrected samples stay below.
const ROOM: f64 = 2.0;
const LEAST_DEG: f64 = 5.0;
const MOST_DEG: f64 = 60.0;
/// Size of a panel, pixels: where a page shows it 830 pixels wide, its letters have 12.
const SIZE: (u32, u32) = (660, 170);

impl Figures {
    /// Adds the pictures to a report; `recording` is the recording's name.
    pub fn finish(&self, report: &mut Report, name: &str, recording: &str) -> Result<(), RunError> {
        report.moments(&self.told_moments());
        let with_reference = self.extent.first_reference.is_some();
        // what the person who recorded asks first: the heading, then why
        let mut first = vec![self.heading_panel()];
        first.extend(with_reference.then(|| self.heading_error_panel()));
        let mut why = vec![self.field_panel()];
        why.push(panel(
            "dip: angle of the field below the horizon",
            "deg",
            vec![self.line("", Colour::Ink, &self.dip)],
        ));
        why.extend(with_reference.then(|| self.sample_errors_panel()));
        why.extend(self.parameter_panels());
        why.extend(self.any_sigma_t.then(|| self.window_panel()));
        why.extend(self.inside.iter().flat_map(|inside| self.inside_panels(inside)));
        let until_s = self.extent.duration_s();
        let marks = self.marks();
        first.push(self.status_panel(marks.clone()));
        let (strip, others) = first.split_last_mut().expect("it was pushed");
        strip.x_range = Some((0.0, until_s)).filter(|_| until_s > 0.0);
        // the moments of the events in every panel; the strip names them
        for panel in others.iter_mut().chain(&mut why) {
            panel.x_range = strip.x_range;
            panel.layers.marks = marks.iter().map(|(x, _)| (*x, String::new())).collect();
        }
        let time = Time { axis: x_axis(SIZE.0), until_s };
        report.figure_over_time(name, draw(&first, 1, SIZE)?, &self.caption(recording), time);
        show(&self.sphere, report, name, recording);
        let caption = format!(
            "{recording}: total field and dip; heading errors of raw and corrected samples, where there is a reference; b and M with one \
             sigma (dashed: the true b, where it is known); what the estimator expected, what may have changed, and the noise it has \
             learned, where that was asked for."
        );
        report.folded("Why: field, dip, M and b over time", |report| {
            report.figure_over_time(&format!("{name}_why"), draw(&why, 1, SIZE)?, &caption, time);
            Ok(())
        })
    }

    /// For the cursor: north by the reference about its median.
    fn told_moments(&self) -> Vec<Moment> {
        let centre_deg = self.heading_error.centre_deg();
        let told = |(time_s, heading, two_sigma, north_deg, status): &Moment| {
            (*time_s, *heading, *two_sigma, north_deg.map(|deg| off_deg(deg, centre_deg)), *status)
        };
        self.moments.iter().map(told).collect()
    }

    /// What happened and what a tester noted, in the order of time.
    fn marks(&self) -> Vec<(f64, String)> {
        let mut marks = self.sphere.marks();
        marks.extend(self.noted.iter().map(|(at_s, name)| (*at_s, format!("noted: {name}"))));
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        marks
    }

    fn series(&self, name: &str, colour: Colour, points: Vec<(f64, f64)>) -> Series {
        Series { fine: self.extent.rows > FINE, ..Series::new(name, colour, points) }
    }

    fn line(&self, name: &str, colour: Colour, line: &Thin) -> Series {
        self.series(name, colour, line.points())
    }

    fn heading_panel(&self) -> Panel {
        Panel {
            y_range: Some((0.0, 360.0)),
            layers: banded(vec![(Colour::Ink, self.heading_band.clone())]),
            ..panel("heading, and its 2-sigma band", "deg", vec![self.series("", Colour::Ink, self.heading.clone())])
        }
    }

    /// Closer than the errors of the samples, with its band.
    fn heading_error_panel(&self) -> Panel {
        let range = (ROOM * self.two_sigma.at(500).unwrap_or(MOST_DEG)).clamp(LEAST_DEG, MOST_DEG);
        Panel {
            y_range: Some((-range, range)),
            layers: banded(vec![(Colour::Ink, self.band.clone())]),
            ..panel(
                &format!("error of the heading, and its 2-sigma band (within {range:.0} deg)"),
                "deg",
                vec![self.series("", Colour::Ink, self.heading_error.points())],
            )
        }
    }

    fn sample_errors_panel(&self) -> Panel {
        let raw = self.series("raw", Colour::Grey, self.raw_error.points());
        let corrected = self.series("corrected", Colour::Blue, self.corrected_error.points());
        panel("heading errors of the samples", "deg", vec![raw, corrected])
    }

    fn field_panel(&self) -> Panel {
        let usual = self.total_field.at(980);
        // a raw field that is far larger is left out, so that the corrected one can be seen
        let beyond = usual.zip(self.raw_field.at(500)).filter(|(usual, raw)| *raw > ROOM * usual);
        let title = beyond.map_or_else(
            || "total field".to_owned(),
            |(_, raw)| format!("total field (raw: mostly {raw:.0} uT, beyond this)"),
        );
        let system = if self.extent.system { "the system's" } else { "" };
        let lines = vec![
            self.line("raw", Colour::Grey, &self.raw),
            self.line(system, Colour::System, &self.system),
            self.line("corrected", Colour::Blue, &self.corrected),
        ];
        Panel { y_range: beyond.map(|(usual, _)| (0.0, ROOM * usual)), ..panel(&title, "uT", lines) }
    }

    /// b, then M, three lines each with their bands; dashed: the true b.
    fn parameter_panels(&self) -> [Panel; 3] {
        let truth = self.truth.iter().map(Thin::points).filter(|b| is_any(b));
        let truth = truth.map(|b| Series { dashed: true, ..self.series("", Colour::Grey, b) });
        let three = |first: usize, title: &str, unit: &str, names: [&str; 3], mut lines: Vec<Series>| {
            let mut bands = Vec::new();
            for (k, name) in names.into_iter().enumerate() {
                lines.push(self.line(name, Colour::Axes(k), &self.parameters[first + k]));
                bands.push((Colour::Axes(k), self.parameter_bands[first + k].clone()));
            }
            Panel { layers: banded(bands), ..panel(title, unit, lines) }
        };
        [
            three(0, "hard iron b, and one sigma", "uT", ["b_x", "b_y", "b_z"], truth.collect()),
            three(3, "soft iron M less 1, and one sigma", "", ["M_xx", "M_yy", "M_zz"], Vec::new()),
            three(6, "soft iron M, and one sigma", "", ["M_xy", "M_xz", "M_yz"], Vec::new()),
        ]
    }

    fn window_panel(&self) -> Panel {
        let window = self.line("N / 2000", Colour::Grey, &self.window);
        panel("sigma_T, and window N / 2000", "", vec![window, self.line("sigma_T", Colour::Ink, &self.sigma_t)])
    }

    fn inside_panels(&self, inside: &Inside) -> Vec<Panel> {
        let [ratio, log_odds] = [&inside.ratio, &inside.log_odds].map(Thin::points);
        let mut panels = Vec::new();
        if is_any(&ratio) {
            let gate = Series::new("", Colour::Grey, [(0.0, GATE), (self.extent.duration_s(), GATE)]);
            let lines = vec![self.series("", Colour::Ink, ratio), Series { dashed: true, ..gate }];
            let title = "test ratio of the innovation; above 1 a sample is not used";
            panels.push(Panel { y_range: Some((0.0, 2.0 * GATE)), ..panel(title, "", lines) });
        }
        if is_any(&log_odds) {
            let lines = vec![self.series("", Colour::Ink, log_odds)];
            let title = "log odds of the second likeliest change";
            panels.push(Panel { y_range: Some((-30.0, 0.0)), ..panel(title, "", lines) });
        }
        let white = self.line("white noise", Colour::Grey, &inside.white_ut);
        let place = self.line("of the place", Colour::Ink, &inside.local_ut);
        panels.push(panel("noise as it is learned, an axis", "uT", vec![white, place]));
        panels
    }

    fn status_panel(&self, marks: Vec<(f64, String)>) -> Panel {
        let spans = self.lanes.iter().enumerate().flat_map(|(lane, spans)| {
            spans.iter().map(move |(from, to)| Span { lane, from: *from, to: *to, colour: LANES[lane].1 })
        });
        let lanes = LANES.map(|(name, _)| name).to_vec();
        Panel {
            layers: Layers { lanes, spans: spans.collect(), marks, ..Layers::default() },
            ..panel("status, and events since when", "", Vec::new())
        }
    }

    fn caption(&self, recording: &str) -> String {
        let (error, band) = match self.extent.first_reference {
            Some(_) => (
                " its error against the reference, up to one constant;",
                " The band also allows for errors that few references show: an uneven place, axes of the sensors that differ, an \
                 accelerometer that leans. A steep field multiplies them, and at rest they do not average out.",
            ),
            None => ("", ""),
        };
        format!(
            "{recording}: the heading with two sigmas;{error} the status, one row each. Vertical lines: onsets of events, named in the \
             strip by the kinds that were decided.{band}"
        )
    }
}

fn banded(bands: Vec<(Colour, Band)>) -> Layers {
    Layers { bands, ..Layers::default() }
}

fn is_any(points: &[(f64, f64)]) -> bool {
    points.iter().any(|(_, value)| value.is_finite())
}

fn panel(title: &str, y_label: &str, series: Vec<Series>) -> Panel {
    Panel::new(title, "time, s", y_label, series)
}
