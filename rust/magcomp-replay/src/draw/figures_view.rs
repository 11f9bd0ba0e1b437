//! The pictures of a replay, drawn: heading and status over time, then the sphere, then why, one panel below the other.

use super::figures::{Figures, Inside, LANES};
use super::sphere_view::show;
use crate::error::RunError;
use crate::judge::off_deg;
use crate::plot::{Colour, FINE, Layers, Panel, Series, Span, Thin, draw, x_axis};
use crate::report::{Report, Time};

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
    pub fn finish(self, report: &mut Report, name: &str, recording: &str) -> Result<(), RunError> {
        let mut moments = self.moments;
        let centre_deg = self.heading_error.centre_deg();
        for (_, _, _, north_deg, _) in &mut moments {
            *north_deg = north_deg.map(|deg| off_deg(deg, centre_deg));
        }
        report.moments(&moments);
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
        // what the person who recorded asks first: the heading, then why
        let mut first = vec![Panel {
            y_range: Some((0.0, 360.0)),
            layers: Layers { bands: vec![(Colour::Ink, self.heading_band)], ..Layers::default() },
            ..panel("heading, and its 2-sigma band", "deg", vec![series("", Colour::Ink, self.heading)])
        }];
        let mut panels = vec![
            Panel {
                y_range: beyond.map(|(usual, _)| (0.0, ROOM * usual)),
                ..panel(
                    &title,
                    "uT",
                    vec![
                        series("raw", Colour::Grey, self.raw.points()),
                        series(system, Colour::System, self.system.points()),
                        series("corrected", Colour::Blue, self.corrected.points()),
                    ],
                )
            },
            panel("dip: angle of the field below the horizon", "deg", vec![series("", Colour::Ink, self.dip.points())]),
        ];
        if self.extent.first_reference.is_some() {
            // the heading errors of raw and corrected samples; that of the heading closer, with its band
            panels.push(panel(
                "heading errors of the samples",
                "deg",
                vec![
                    series("raw", Colour::Grey, self.raw_error.points()),
                    series("corrected", Colour::Blue, self.corrected_error.points()),
                ],
            ));
            let range = (ROOM * self.two_sigma.at(500).unwrap_or(MOST_DEG)).clamp(LEAST_DEG, MOST_DEG);
            first.push(Panel {
                y_range: Some((-range, range)),
                layers: Layers { bands: vec![(Colour::Ink, self.band)], ..Layers::default() },
                ..panel(
                    &format!("error of the heading, and its 2-sigma band (within {range:.0} deg)"),
                    "deg",
                    vec![series("", Colour::Ink, self.heading_error.points())],
                )
            });
        }
        let truth = self.truth.map(Thin::points).into_iter().filter(|b| b.iter().any(|(_, b)| b.is_finite()));
        let truth = truth.map(|b| Series { dashed: true, ..series("", Colour::Grey, b) });
        let colours = [0, 1, 2].map(Colour::Axes);
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
                    series("sigma_T", Colour::Ink, self.sigma_t.points()),
                ],
            ));
        }
        if let Some(Inside { ratio, log_odds, white_ut, local_ut }) = self.inside {
            let [ratio, log_odds] = [ratio, log_odds].map(Thin::points);
            if is_any(&ratio) {
                panels.push(Panel {
                    y_range: Some((0.0, 2.0 * GATE)),
                    ..panel(
                        "test ratio of the innovation; above 1 a sample is not used",
                        "",
                        vec![
                            series("", Colour::Ink, ratio),
                            Series {
                                dashed: true,
                                ..Series::new("", Colour::Grey, [(0.0, GATE), (self.extent.duration_s(), GATE)])
                            },
                        ],
                    )
                });
            }
            if is_any(&log_odds) {
                panels.push(Panel {
                    y_range: Some((-30.0, 0.0)),
                    ..panel("log odds of the second likeliest change", "", vec![series("", Colour::Ink, log_odds)])
                });
            }
            let levels = [("white noise", Colour::Grey, white_ut), ("of the place", Colour::Ink, local_ut)];
            let levels = levels.map(|(name, colour, line)| series(name, colour, line.points()));
            panels.push(panel("noise as it is learned, an axis", "uT", levels.to_vec()));
        }
        let spans = self.lanes.iter().enumerate().flat_map(|(lane, spans)| {
            spans.iter().map(move |(from, to)| Span { lane, from: *from, to: *to, colour: LANES[lane].1 })
        });
        let mut marks = self.sphere.marks();
        marks.extend(self.noted.iter().map(|(at_s, name)| (*at_s, format!("noted: {name}"))));
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        // the moments of the events in every panel; the strip names them
        let end_s = self.extent.duration_s();
        for panel in first.iter_mut().chain(&mut panels) {
            panel.x_range = Some((0.0, end_s)).filter(|_| end_s > 0.0);
            panel.layers.marks = marks.iter().map(|(x, _)| (*x, String::new())).collect();
        }
        first.push(Panel {
            x_range: first[0].x_range,
            layers: Layers {
                lanes: LANES.map(|(name, _)| name).to_vec(),
                spans: spans.collect(),
                marks,
                ..Layers::default()
            },
            ..panel("status, and events since when", "", Vec::new())
        });
        let (error, band) = match self.extent.first_reference {
            Some(_) => (
                " its error against the reference, up to one constant;",
                " The band also allows for errors that few references show: an uneven place, axes of the sensors that differ, an \
                 accelerometer that leans. A steep field multiplies them, and at rest they do not average out.",
            ),
            None => ("", ""),
        };
        let caption = format!(
            "{recording}: the heading with two sigmas;{error} the status, one row each. Vertical lines: onsets of events, named in the \
             strip by the kinds that were decided.{band}"
        );
        let time = Time { axis: x_axis(SIZE.0), until_s: end_s };
        report.figure_over_time(name, draw(&first, 1, SIZE)?, &caption, time);
        show(&self.sphere, report, name, recording);
        let caption = format!(
            "{recording}: total field and dip; heading errors of raw and corrected samples, where there is a reference; b and M with one \
             sigma (dashed: the true b, where it is known); what the estimator expected, what may have changed, and the noise it has \
             learned, where that was asked for."
        );
        report.folded("Why: field, dip, M and b over time", |report| {
            report.figure_over_time(&format!("{name}_why"), draw(&panels, 1, SIZE)?, &caption, time);
            Ok::<_, RunError>(())
        })?;
        Ok(())
    }
}

fn is_any(points: &[(f64, f64)]) -> bool {
    points.iter().any(|(_, value)| value.is_finite())
}

fn panel(title: &str, y_label: &str, series: Vec<Series>) -> Panel {
    Panel::new(title, "time, s", y_label, series)
}
