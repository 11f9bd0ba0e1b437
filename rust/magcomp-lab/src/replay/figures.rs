//! A replay as a picture over time: total field, heading error with the sigma that was given with it, hard iron, status.

use super::Step;
use super::judge::{azimuth_deg, centred};
use crate::error::LabError;
use crate::plot::{Colour, Layers, Panel, Series, Span, draw};
use crate::recording::Recording;
use crate::report::Report;
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

/// A replay and its times from the first row on.
struct View<'a> {
    recording: &'a Recording,
    steps: &'a [Step],
}

/// Adds what a number cannot show.
///
/// # Errors
/// [`LabError::Plot`].
pub fn figures(report: &mut Report, name: &str, recording: &Recording, steps: &[Step]) -> Result<(), LabError> {
    let view = View { recording, steps };
    let mut panels = vec![view.strength()];
    if recording.rows.iter().any(|row| row.attitude.is_some()) {
        panels.extend(view.heading());
    }
    panels.push(view.hard_iron());
    if steps.iter().any(|step| step.reading.sigma_t.is_some()) {
        panels.push(view.window());
    }
    panels.push(view.status());
    let caption = format!(
        "{}: raw field (grey) and what the compensator made of it; heading error against the reference, with the band \
         of two sigmas that was given with it; hard iron (dashed: the truth, where it is known); status and events.",
        recording.name()
    );
    report.figure(name, draw(&panels, 1, (1100, 220))?, &caption);
    Ok(())
}

impl View<'_> {
    fn time_s(&self, k: usize) -> f64 {
        self.recording.rows[k].time_s - self.recording.rows[0].time_s
    }

    fn line(&self, value: impl Fn(usize) -> Option<f64>) -> Vec<(f64, f64)> {
        (0..self.steps.len()).map(|k| (self.time_s(k), value(k).unwrap_or(f64::NAN))).collect()
    }

    fn raw(&self, k: usize) -> Vector3<f64> {
        self.recording.rows[k].field_ut
    }

    fn strength(&self) -> Panel {
        let corrected = |k: usize| Some(self.steps[k].reading.field_ut?.norm());
        let series = vec![
            Series::new("raw", Colour::Grey, self.line(|k| Some(self.raw(k).norm()))),
            Series::new("compensated", Colour::Blue, self.line(corrected)),
        ];
        panel("total field", "uT", series)
    }

    /// Everything's heading error, then that of what carries the heading, closer, with its band.
    fn heading(&self) -> [Panel; 2] {
        let errors = |vector: &dyn Fn(usize) -> Option<Vector3<f64>>| {
            let azimuth = |k: usize| azimuth_deg(&self.recording.rows[k], &vector(k)?);
            centred((0..self.steps.len()).map(azimuth).collect())
        };
        let reading = |k: usize| &self.steps[k].reading;
        let raw = errors(&|k| Some(self.raw(k)));
        let corrected = errors(&|k| reading(k).field_ut);
        let pointing = errors(&|k| reading(k).filtered_field_ut.or(reading(k).field_ut));
        let all = panel(
            "heading error against the reference",
            "deg",
            vec![
                Series::new("raw", Colour::Grey, self.line(|k| raw[k])),
                Series::new("compensated", Colour::Blue, self.line(|k| corrected[k])),
            ],
        );
        let two_sigma = |k: usize| Some(2.0 * reading(k).heading?.heading_sigma_deg?);
        let mut sigmas: Vec<f64> = (0..self.steps.len()).filter_map(two_sigma).collect();
        sigmas.sort_by(f64::total_cmp);
        let usual = sigmas.get(sigmas.len() * 9 / 10).copied().unwrap_or(MOST_DEG);
        let range = (ROOM * usual).clamp(LEAST_DEG, MOST_DEG);
        // what carries the heading goes through the noise of the samples: no more than one point a pixel is needed
        let stride = (self.steps.len() / 1000).max(1);
        let band = (0..self.steps.len()).step_by(stride).map(|k| {
            let sigma = two_sigma(k).unwrap_or(f64::NAN);
            (self.time_s(k), -sigma, sigma)
        });
        let carried = Panel {
            y_range: Some((-range, range)),
            layers: Layers { band: band.collect(), ..Layers::default() },
            ..panel(
                "error of the heading given, and its 2-sigma band",
                "deg",
                vec![Series::new("heading", Colour::Blue, self.line(|k| pointing[k]))],
            )
        };
        [all, carried]
    }

    fn hard_iron(&self) -> Panel {
        let axes = [("b_x", Colour::Blue), ("b_y", Colour::Orange), ("b_z", Colour::Green)].into_iter().enumerate();
        let (mut truth, mut estimated) = (Vec::new(), Vec::new());
        for (i, (name, colour)) in axes {
            let known = self.line(|k| Some(self.recording.rows[k].hard_iron_ut?[i]));
            if known.iter().any(|(_, b)| b.is_finite()) {
                truth.push(Series { dashed: true, ..Series::new("", Colour::Grey, known) });
            }
            let found = self.line(|k| Some(self.steps[k].calibration?.hard_iron_ut()[i]));
            estimated.push(Series::new(name, colour, found));
        }
        panel("hard iron", "uT", truth.into_iter().chain(estimated).collect())
    }

    fn window(&self) -> Panel {
        let reading = |k: usize| &self.steps[k].reading;
        let series = vec![
            Series::new("N / 2000", Colour::Grey, self.line(|k| Some(reading(k).window as f64 / 2000.0))),
            Series::new("sigma_T", Colour::Blue, self.line(|k| reading(k).sigma_t)),
        ];
        panel("sigma_T, and window N / 2000", "", series)
    }

    fn status(&self) -> Panel {
        let mut spans: Vec<Span> = Vec::new();
        for (k, step) in self.steps.iter().enumerate() {
            let label = step.reading.status.label();
            let Some(lane) = LANES.iter().position(|(name, _)| *name == label) else { continue };
            let to = self.time_s((k + 1).min(self.steps.len() - 1));
            match spans.last_mut() {
                Some(span) if span.lane == lane => span.to = to,
                _ => spans.push(Span { lane, from: self.time_s(k), to, colour: LANES[lane].1 }),
            }
        }
        let mut events: Vec<_> = self.steps.iter().filter_map(|step| step.reading.event).collect();
        events.dedup();
        let start_ns = self.recording.rows.first().map_or(0, |row| row.time_ns);
        let mark = |event: &magcomp::Event| ((event.since_ns - start_ns) as f64 / 1e9, format!("{:?}", event.kind));
        Panel {
            layers: Layers {
                lanes: LANES.map(|(name, _)| name).to_vec(),
                spans,
                marks: events.iter().map(mark).collect(),
                ..Layers::default()
            },
            ..panel("status, and events since when", "", Vec::new())
        }
    }
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
