//! Dots in rows: a row a method, a dot a recording, a bar at the median, errors on a scale of equal ratios.

use super::colour::{Colour, INK, MESH, PAPER, with_dark_style};
use crate::error::RunError;
use crate::statistics::median;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Width of a picture, heights of its rows and of what is above and below them, pixels: as the panels of a page.
const WIDTH: u32 = 660;
const ROW: u32 = 22;
const ABOVE: u32 = 52;
const BELOW: u32 = 44;
/// Mean width of a name's character, pixels; no font is measured here.
const CHARACTER: f64 = 5.9;
/// Values on the axis.
const TICKS: [f64; 12] = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0, 200.0, 500.0];

/// A row of dots.
#[derive(Clone, Debug)]
pub struct DotRow {
    /// Its name, at the left.
    pub name: String,
    /// What each recording came to; those that are no positive number are left out.
    pub values: Vec<f64>,
    /// Of the dots.
    pub colour: Colour,
}

/// Rows of dots on one scale.
#[derive(Clone, Debug)]
pub struct Dots {
    /// Above it.
    pub title: String,
    /// What a dot is, for the legend.
    pub dot: String,
    /// Below the scale, with the unit.
    pub x_label: String,
    /// From the top.
    pub rows: Vec<DotRow>,
    /// The rows are rivals: the one of the least median is marked.
    pub marks_best: bool,
}

impl Dots {
    /// Rows of that name, what a dot is, and the scale's name.
    pub fn new(title: &str, dot: &str, x_label: &str, rows: Vec<DotRow>, marks_best: bool) -> Self {
        Self { title: title.to_owned(), dot: dot.to_owned(), x_label: x_label.to_owned(), rows, marks_best }
    }

    /// Draws them.
    pub fn draw(&self) -> Result<String, RunError> {
        let mut svg = String::new();
        {
            let height = ABOVE + BELOW + ROW * self.rows.len() as u32;
            let root = SVGBackend::with_string(&mut svg, (WIDTH, height)).into_drawing_area();
            let drawn = self.draw_on(&root).and_then(|()| root.present());
            drawn.map_err(|error| RunError::Plot { name: self.title.clone(), reason: error.to_string() })?;
        }
        Ok(with_dark_style(&svg))
    }

    fn draw_on<Backend: DrawingBackend>(
        &self,
        root: &DrawingArea<Backend, plotters::coord::Shift>,
    ) -> Result<(), DrawingAreaErrorKind<Backend::ErrorType>> {
        let text = |size: u32| ("sans-serif", size).into_font().color(&INK);
        let to = |h, v| Pos::new(h, v);
        root.fill(&PAPER)?;
        root.draw(&Text::new(self.title.clone(), (12, 8), text(15)))?;
        let rows: Vec<(&DotRow, Vec<f64>)> = (self.rows.iter())
            .map(|row| (row, row.values.iter().copied().filter(|value| value.is_finite() && *value > 0.0).collect()))
            .collect();
        let all = || rows.iter().flat_map(|(_, values)| values.iter().copied());
        let (low, high) = all().fold((f64::INFINITY, 0.0_f64), |(low, high), value| (low.min(value), high.max(value)));
        let (low, high) = if low > high { (1.0, 10.0) } else { (low / 1.15, high * 1.15) };
        let longest = rows.iter().map(|(row, _)| row.name.chars().count()).max().unwrap_or(0);
        let (left, right) = (24 + (longest as f64 * CHARACTER) as i32, WIDTH as i32 - 24);
        let x = |value: f64| left + ((value / low).ln() / (high / low).ln() * f64::from(right - left)) as i32;
        let bottom = (ABOVE + ROW * rows.len() as u32) as i32;
        for tick in TICKS.into_iter().filter(|tick| (low..=high).contains(tick)) {
            root.draw(&PathElement::new(vec![(x(tick), ABOVE as i32), (x(tick), bottom)], MESH))?;
            root.draw(&Text::new(format!("{tick}"), (x(tick), bottom + 4), text(12).pos(to(HPos::Center, VPos::Top))))?;
        }
        root.draw(&PathElement::new(vec![(left, bottom), (right, bottom)], INK))?;
        let below = (left + right) / 2;
        root.draw(&Text::new(self.x_label.clone(), (below, bottom + 22), text(13).pos(to(HPos::Center, VPos::Top))))?;
        let medians: Vec<Option<f64>> = rows.iter().map(|(_, values)| median(values.clone())).collect();
        let least = medians.iter().flatten().copied().fold(f64::INFINITY, f64::min);
        for (k, ((row, values), median)) in rows.iter().zip(&medians).enumerate() {
            let y = (ABOVE + ROW * k as u32 + ROW / 2) as i32;
            let colour = row.colour.rgb();
            root.draw(&Text::new(row.name.clone(), (12, y), text(12).pos(to(HPos::Left, VPos::Center))))?;
            for value in values {
                root.draw(&Circle::new((x(*value), y), 3, colour.mix(0.6).filled()))?;
            }
            let Some(median) = *median else { continue };
            root.draw(&Rectangle::new([(x(median) - 1, y - 8), (x(median) + 2, y + 8)], INK.filled()))?;
            if self.marks_best && median <= least {
                root.draw(&Circle::new((x(median), y), 10, INK.stroke_width(2)))?;
            }
        }
        self.draw_legend(root)
    }

    /// What dot, bar and ring mean.
    fn draw_legend<Backend: DrawingBackend>(
        &self,
        root: &DrawingArea<Backend, plotters::coord::Shift>,
    ) -> Result<(), DrawingAreaErrorKind<Backend::ErrorType>> {
        let text = ("sans-serif", 12).into_font().color(&INK).pos(Pos::new(HPos::Left, VPos::Center));
        let (mut left, y) = (16, 38);
        let mut name = |name: &str| {
            let at = left;
            left += 26 + (name.chars().count() as f64 * CHARACTER) as i32;
            root.draw(&Text::new(name.to_owned(), (at + 10, y), text.clone())).map(|()| at)
        };
        let dot = name(&self.dot)?;
        root.draw(&Circle::new((dot, y), 3, Colour::Grey.rgb().filled()))?;
        let bar = name("the median")?;
        root.draw(&Rectangle::new([(bar - 1, y - 7), (bar + 2, y + 7)], INK.filled()))?;
        if self.marks_best {
            let ring = name("the best median")?;
            root.draw(&Circle::new((ring, y), 6, INK.stroke_width(2)))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_dot_each_and_a_ring_about_the_best() {
        let row = |name: &str, values: &[f64]| DotRow {
            name: name.to_owned(),
            values: values.to_vec(),
            colour: Colour::Blue,
        };
        let rows = vec![row("one", &[1.0, 2.0, 9.0]), row("other", &[3.0, f64::NAN, 4.0]), row("none", &[])];
        let mut dots = Dots::new("title", "a recording", "deg", rows, true);
        let circles = |svg: &str| svg.matches("<circle").count();
        let svg = dots.draw().unwrap();
        // five dots and one of the legend; a ring and one of the legend
        assert_eq!(circles(&svg), 8, "{svg}");
        dots.marks_best = false;
        assert_eq!(circles(&dots.draw().unwrap()), 6);
        assert_eq!((median(vec![1.0, 4.0, 2.0, 3.0]), median(Vec::new())), (Some(2.5), None));
        dots.rows.clear();
        assert!(dots.draw().unwrap().contains("a recording"));
    }
}
