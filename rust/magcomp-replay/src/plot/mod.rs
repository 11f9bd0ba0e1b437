//! Line plots as SVG: panels on a grid, each with a few series. One file works on light and dark pages: the ink and the
//! paper are exchanged by a style rule of the SVG itself.

mod colour;
mod dots;
mod layers;
mod thin;

pub use colour::Colour;
#[cfg(test)]
pub(crate) use colour::contrast;
pub(crate) use colour::with_dark_style;
pub use dots::{DotRow, Dots};
pub use layers::{Band, Layers, Span};
pub use thin::Thin;

use crate::error::RunError;
use colour::{INK, MESH, PAPER};
use plotters::prelude::*;

/// A line; points that are not finite interrupt it.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name in the legend; none when empty.
    pub name: String,
    /// Its colour.
    pub colour: Colour,
    /// Broken into dashes.
    pub dashed: bool,
    /// Drawn one pixel wide, as a line of many points is.
    pub fine: bool,
    /// (x, y) in the order of x.
    pub points: Vec<(f64, f64)>,
}

impl Series {
    /// A line of that name and colour.
    pub fn new(name: &str, colour: Colour, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let points: Vec<_> = points.into_iter().collect();
        Self { name: name.to_owned(), colour, dashed: false, fine: points.len() > FINE, points }
    }
}

/// One set of axes.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// Above it.
    pub title: String,
    /// Below the x axis, with the unit.
    pub x_label: String,
    /// Left of the y axis, with the unit.
    pub y_label: String,
    /// Fixed range of x; by the data when none.
    pub x_range: Option<(f64, f64)>,
    /// Fixed range of y; by the data when none.
    pub y_range: Option<(f64, f64)>,
    /// Lines, later ones on top.
    pub series: Vec<Series>,
    /// The layers behind the lines.
    pub layers: Layers,
}

/// Around a panel, right of its axes, and left of them for the labels, pixels.
const MARGIN: u32 = 10;
const MARGIN_RIGHT: u32 = 18;
const Y_LABELS: u32 = 58;

/// Where the x axis of panels below each other begins and ends, as shares of a picture of this width.
pub fn x_axis(width: u32) -> (f64, f64) {
    let share = |pixels: u32| f64::from(pixels) / f64::from(width);
    (share(MARGIN + Y_LABELS), share(width - MARGIN_RIGHT))
}

/// Height of the row with title and legend, pixels.
const TITLE_ROW: u32 = 34;
/// Mean width of a legend's character, pixels; no font is measured here.
const CHARACTER: f64 = 7.2;
/// Lines of more points are drawn one pixel wide.
pub const FINE: usize = 3000;

/// Draws panels row by row, `columns` of them in a row, each of `size` pixels.
pub fn draw(panels: &[Panel], columns: usize, size: (u32, u32)) -> Result<String, RunError> {
    let rows = panels.len().div_ceil(columns).max(1);
    let whole = (size.0 * columns as u32, size.1 * rows as u32);
    let mut svg = String::new();
    {
        let root = SVGBackend::with_string(&mut svg, whole).into_drawing_area();
        let failed = |error: &dyn std::fmt::Display| RunError::Plot {
            name: panels.first().map_or_else(String::new, |panel| panel.title.clone()),
            reason: error.to_string(),
        };
        root.fill(&PAPER).map_err(|error| failed(&error))?;
        for (panel, area) in panels.iter().zip(root.split_evenly((rows, columns))) {
            panel.draw(&area).map_err(|error| failed(&error))?;
        }
        root.present().map_err(|error| failed(&error))?;
    }
    Ok(with_dark_style(&svg))
}

impl Panel {
    /// Lines over axes of these names.
    pub fn new(title: &str, x_label: &str, y_label: &str, series: impl IntoIterator<Item = Series>) -> Self {
        let [title, x_label, y_label] = [title, x_label, y_label].map(str::to_owned);
        Self { title, x_label, y_label, series: series.into_iter().collect(), ..Self::default() }
    }

    fn draw<Backend: DrawingBackend>(
        &self,
        area: &DrawingArea<Backend, plotters::coord::Shift>,
    ) -> Result<(), DrawingAreaErrorKind<Backend::ErrorType>> {
        let text = |size: u32| ("sans-serif", size).into_font().color(&INK);
        let points = || self.series.iter().flat_map(|series| &series.points);
        let spans = self.layers.spans.iter().flat_map(|span| [span.from, span.to]);
        let (x_low, x_high) = self.x_range.unwrap_or_else(|| range(points().map(|p| p.0).chain(spans), 0.0));
        let y_range = self.y_range.or(self.layers.y_range());
        let (y_low, y_high) = y_range.unwrap_or_else(|| range(points().map(|p| p.1), 0.06));
        let lanes = !self.layers.lanes.is_empty();
        let mut chart = ChartBuilder::on(area)
            .margin(MARGIN)
            .margin_top(TITLE_ROW)
            .margin_right(MARGIN_RIGHT)
            .x_label_area_size(if self.x_label.is_empty() { 22 } else { 38 })
            // one for all, so that the axes of panels below each other line up
            .y_label_area_size(Y_LABELS)
            .build_cartesian_2d(x_low..x_high, y_low..y_high)?;
        chart
            .configure_mesh()
            .x_labels(6)
            .y_labels(6)
            .max_light_lines(0)
            .bold_line_style(MESH)
            .axis_style(INK)
            .label_style(text(12))
            .axis_desc_style(text(13))
            .x_label_formatter(&|v| short(*v))
            .y_label_formatter(&|v| if lanes { self.layers.lane(*v) } else { short(*v) })
            .x_desc(&self.x_label)
            .y_desc(&self.y_label)
            .draw()?;
        self.layers.draw(&mut chart, (y_low, y_high))?;
        for series in &self.series {
            let mut thin = Thin::new(series.points.len());
            series.points.iter().for_each(|(x, y)| thin.add(*x, *y));
            let mut thin = thin.points();
            // a point outside the range is left out; plotters would draw it along the border
            thin.iter_mut().filter(|(_, y)| !(y_low..=y_high).contains(y)).for_each(|(_, y)| *y = f64::NAN);
            // a line of noise is drawn fine, so that the lines below it still show
            let style = series.colour.rgb().stroke_width(if series.fine { 1 } else { 2 });
            for piece in thin.split(|(x, y)| !(x + y).is_finite()).filter(|piece| !piece.is_empty()) {
                let line = piece.iter().copied();
                if series.dashed {
                    chart.draw_series(DashedLineSeries::new(line, 6, 4, style))?;
                } else {
                    chart.draw_series(LineSeries::new(line, style))?;
                }
            }
        }
        self.draw_title_row(area)
    }

    /// Title on the left, legend on the right, above the axes where they hide nothing.
    fn draw_title_row<Backend: DrawingBackend>(
        &self,
        area: &DrawingArea<Backend, plotters::coord::Shift>,
    ) -> Result<(), DrawingAreaErrorKind<Backend::ErrorType>> {
        let text = |size: u32| ("sans-serif", size).into_font().color(&INK);
        area.draw(&Text::new(self.title.clone(), (12, 10), text(15)))?;
        let mut right = area.dim_in_pixel().0 as i32 - 18;
        for series in self.series.iter().rev().filter(|series| !series.name.is_empty()) {
            let left = right - (series.name.chars().count() as f64 * CHARACTER) as i32;
            let style = series.colour.rgb().stroke_width(3);
            area.draw(&Text::new(series.name.clone(), (left, 12), text(12)))?;
            area.draw(&PathElement::new(vec![(left - 22, 18), (left - 6, 18)], style))?;
            right = left - 36;
        }
        Ok(())
    }
}

/// Smallest and largest, with a share of room at both ends; never empty.
fn range(values: impl Iterator<Item = f64>, room: f64) -> (f64, f64) {
    let finite = values.filter(|v| v.is_finite());
    let (low, high) = finite.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), v| (low.min(v), high.max(v)));
    if low > high {
        return (0.0, 1.0);
    }
    let width = if high > low { high - low } else { low.abs().max(1.0) * 0.1 };
    let extra = if high > low { width * room } else { width };
    (low - extra, high + extra)
}

/// A number with as many digits as a label needs.
fn short(v: f64) -> String {
    let text = if v.abs() >= 100.0 { format!("{v:.0}") } else { format!("{v:.3}") };
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::colour::DARK;
    use super::*;

    #[test]
    fn draws_an_svg_with_gaps_and_both_styles() {
        let points = (0..10_000).map(|k| (f64::from(k), if k == 5000 { f64::NAN } else { f64::from(k).sin() }));
        let panel = Panel::new("A < B", "sample", "uT", [Series::new("sine", Colour::Blue, points)]);
        let svg = draw(&[panel], 1, (400, 300)).unwrap();
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>"));
        assert!(svg.contains("A &lt; B") && svg.contains("prefers-color-scheme"));
        for (light, _) in DARK {
            assert!(svg.contains(&format!("\"{light}\"")), "{light} is not drawn any more");
        }
        assert!(svg.len() < 60_000, "{} bytes", svg.len());
    }

    #[test]
    fn labels_are_short() {
        assert_eq!([0.5, 0.0, 6500.0, -0.0001, 1.25].map(short), ["0.5", "0", "6500", "0", "1.25"]);
    }
}
