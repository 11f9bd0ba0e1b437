//! The layers of a panel behind its lines: bands, lanes of coloured spans, marks at moments.

use super::colour::{Colour, INK};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

/// Half the height of a lane's span, in lanes.
const HALF_LANE: f64 = 0.36;
/// Mean width of a name's character and height of its line, pixels.
const CHARACTER: f64 = 7.2;
const NAME: u32 = 14;
/// Opacity of a band.
const BAND: f64 = 0.3;

/// A stretch of time in a lane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// Lane, counted from the bottom.
    pub lane: usize,
    /// Where it begins, x.
    pub from: f64,
    /// Where it ends, x.
    pub to: f64,
    /// Its colour.
    pub colour: Colour,
}

/// (x, low, high) in the order of x; points that are not finite interrupt it.
pub type Band = Vec<(f64, f64, f64)>;

/// Behind the lines.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Layers {
    /// Bands and their colours.
    pub bands: Vec<(Colour, Band)>,
    /// Names of lanes, from the bottom; y then counts lanes.
    pub lanes: Vec<&'static str>,
    /// The spans in the lanes.
    pub spans: Vec<Span>,
    /// Moments and their names, which may be empty: vertical lines.
    pub marks: Vec<(f64, String)>,
}

type Area<'a, Backend> = ChartContext<'a, Backend, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

impl Layers {
    /// The range of y that the lanes need.
    pub(super) fn y_range(&self) -> Option<(f64, f64)> {
        (!self.lanes.is_empty()).then(|| (-0.5, self.lanes.len() as f64 - 0.5))
    }

    /// The name of the lane at y.
    pub(super) fn lane(&self, y: f64) -> String {
        let lane = (y - y.round()).abs() < 1e-6 && y > -0.5;
        self.lanes.get(y.round().max(0.0) as usize).filter(|_| lane).map_or_else(String::new, |name| (*name).to_owned())
    }

    pub(super) fn draw<Backend: DrawingBackend>(
        &self,
        chart: &mut Area<'_, Backend>,
        (low, high): (f64, f64),
    ) -> Result<(), DrawingAreaErrorKind<Backend::ErrorType>> {
        for (colour, band) in &self.bands {
            for piece in band.split(|(_, from, to)| !(from + to).is_finite()).filter(|piece| piece.len() > 1) {
                let below = piece.iter().map(|(x, from, _)| (*x, from.clamp(low, high)));
                let above = piece.iter().rev().map(|(x, _, to)| (*x, to.clamp(low, high)));
                let outline: Vec<(f64, f64)> = below.chain(above).collect();
                chart.draw_series([Polygon::new(outline, colour.rgb().mix(BAND))])?;
            }
        }
        for span in &self.spans {
            let corners = [(span.from, span.lane as f64 - HALF_LANE), (span.to, span.lane as f64 + HALF_LANE)];
            chart.draw_series([Rectangle::new(corners, span.colour.rgb().filled())])?;
            // pale colours stand out by their outline
            chart.draw_series([Rectangle::new(corners, INK.stroke_width(1))])?;
        }
        let (x_range, pixels) = (chart.x_range(), chart.plotting_area().dim_in_pixel());
        let per_pixel = (x_range.end - x_range.start) / f64::from(pixels.0.max(1));
        for (x, _) in &self.marks {
            chart.draw_series([PathElement::new(vec![(*x, low), (*x, high)], INK.stroke_width(1))])?;
        }
        for (x, row, name) in places(&self.marks, per_pixel, x_range.end) {
            let y = high - row as f64 * f64::from(NAME) * (high - low) / f64::from(pixels.1.max(1));
            let text = ("sans-serif", 12).into_font().color(&INK);
            chart.draw_series([Text::new(format!(" {name}"), (x, y), text)])?;
        }
        Ok(())
    }
}

/// Where the names of the marks stand: x, row from the top, and the name. Marks of one name that would stand within another's name are told
/// once, with how many they are; other names that would run into each other go below, and none runs out of the picture.
fn places(marks: &[(f64, String)], per_pixel: f64, end: f64) -> Vec<(f64, usize, String)> {
    let width = |name: &str| (name.chars().count() + 1) as f64 * CHARACTER * per_pixel;
    let counted = |name: &str, count: usize| if count > 1 { format!("{name} ({count})") } else { name.to_owned() };
    let mut groups: Vec<(f64, &str, usize)> = Vec::new();
    for (x, name) in marks.iter().filter(|(_, name)| !name.is_empty()) {
        let near = |(from, own, count): &&mut (f64, &str, usize)| {
            own == name && *x <= *from + width(&counted(own, *count + 1))
        };
        match groups.iter_mut().rev().find(near) {
            Some((_, _, count)) => *count += 1,
            None => groups.push((*x, name, 1)),
        }
    }
    // where the latest name in each row ends
    let mut ends: Vec<f64> = Vec::new();
    let place = |(x, name, count): (f64, &str, usize)| {
        let name = counted(name, count);
        let x = x.min(end - width(&name));
        let row = ends.iter().position(|before| *before < x).unwrap_or(ends.len());
        ends.resize(ends.len().max(row + 1), f64::NEG_INFINITY);
        ends[row] = x + width(&name);
        (x, row, name)
    };
    groups.into_iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_marks_do_not_run_into_each_other_nor_out_of_the_picture() {
        let marks = [1.0, 2.0, 3.0, 3.5, 60.0, 99.0].map(|x: f64| (x, "DeviceStep".to_owned()));
        let mut marks: Vec<_> =
            marks.into_iter().chain([(2.5, "PlaceChanged".to_owned()), (50.0, String::new())]).collect();
        marks.sort_by(|a, b| a.0.total_cmp(&b.0));
        let per_pixel = 100.0 / 600.0;
        let placed = places(&marks, per_pixel, 100.0);
        let names: Vec<&str> = placed.iter().map(|(.., name)| name.as_str()).collect();
        assert_eq!(names, ["DeviceStep (4)", "PlaceChanged", "DeviceStep", "DeviceStep"]);
        assert_eq!(placed.iter().map(|(_, row, _)| *row).collect::<Vec<_>>(), [0, 1, 0, 0]);
        let end = |(x, _, name): &(f64, usize, String)| x + (name.len() + 1) as f64 * CHARACTER * per_pixel;
        for (k, one) in placed.iter().enumerate() {
            assert!(end(one) <= 100.0 + 1e-9, "{one:?}");
            for other in placed[..k].iter().filter(|other| other.1 == one.1) {
                assert!(end(other) <= one.0, "{other:?} runs into {one:?}");
            }
        }
    }
}
