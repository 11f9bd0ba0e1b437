//! The layers of a panel behind its lines: bands, lanes of coloured spans, marks at moments.

use super::colour::{Colour, INK};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;

/// Half the height of a lane's span, in lanes.
const HALF_LANE: f64 = 0.36;
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
        }
        for (x, name) in &self.marks {
            chart.draw_series([PathElement::new(vec![(*x, low), (*x, high)], INK.stroke_width(1))])?;
            if name.is_empty() {
                continue;
            }
            let text = ("sans-serif", 12).into_font().color(&INK);
            chart.draw_series([Text::new(format!(" {name}"), (*x, high), text)])?;
        }
        Ok(())
    }
}
