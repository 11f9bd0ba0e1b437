//! A square panel of a picture as SVG: frame, axes, points, lines and rings in microtesla.

use crate::plot::{Colour, with_dark_style};
use magcomp::nalgebra::Vector2;
use std::fmt::Write as _;

/// Edge of a panel, pixels.
pub(super) const PANEL: f64 = 275.0;

/// A picture of this size, light and dark.
pub(super) fn picture(width: f64, height: f64, draw: impl FnOnce(&mut String)) -> String {
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#FFFFFF\"/>\n"
    );
    draw(&mut out);
    out.push_str("</svg>\n");
    with_dark_style(&out)
}

/// A square panel whose middle is the origin.
pub(super) struct Square {
    /// Pixels from the left and the top of the picture.
    pub left: f64,
    pub top: f64,
    /// Pixels in a microtesla.
    pub scale: f64,
}

impl Square {
    pub fn begin(&self, out: &mut String, title: &str) {
        let (x, y, edge) = (self.left + 6.0, self.top - 8.0, PANEL - 12.0);
        text(out, x + 4.0, y, 12, title);
        // an inner svg clips points outside its frame
        let _ = writeln!(
            out,
            "<svg x=\"{x}\" y=\"{}\" width=\"{edge}\" height=\"{edge}\" viewBox=\"{x} {} {edge} {edge}\">\
             <rect x=\"{x}\" y=\"{}\" width=\"{edge}\" height=\"{edge}\" fill=\"none\" stroke=\"#DDE1E6\"/>",
            self.top, self.top, self.top
        );
        let (across, down) = (self.left + PANEL / 2.0, self.top + PANEL / 2.0 - 6.0);
        let _ = writeln!(
            out,
            "<path d=\"M{x} {down}h{edge}M{across} {}v{edge}\" fill=\"none\" stroke=\"#DDE1E6\"/>",
            self.top
        );
    }

    pub fn end(&self, out: &mut String) {
        out.push_str("</svg>\n");
    }

    fn at(&self, v: &Vector2<f64>) -> (f64, f64) {
        let size = |value: f64| (value * self.scale).clamp(-2.0 * PANEL, 2.0 * PANEL);
        (self.left + PANEL / 2.0 + size(v.x), self.top + PANEL / 2.0 - 6.0 - size(v.y))
    }

    pub fn points(&self, out: &mut String, points: impl Iterator<Item = Vector2<f64>>, colour: Colour) {
        let mut path = String::new();
        for point in points {
            let (x, y) = self.at(&point);
            let _ = write!(path, "M{x:.1} {y:.1}h0");
        }
        let stroke = colour.hex();
        let _ = writeln!(
            out,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"2.4\" stroke-linecap=\"round\" opacity=\"0.55\"/>"
        );
    }

    pub fn line(&self, out: &mut String, points: impl Iterator<Item = Vector2<f64>>, colour: Colour, opacity: f64) {
        let mut path = String::new();
        for (k, point) in points.enumerate() {
            let (x, y) = self.at(&point);
            let _ = write!(path, "{}{x:.1} {y:.1}", if k == 0 { 'M' } else { 'L' });
        }
        let stroke = colour.hex();
        let _ = writeln!(
            out,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"1.3\" opacity=\"{opacity}\"/>"
        );
    }

    pub fn ring(&self, out: &mut String, at: Vector2<f64>, opacity: f64) {
        let ((x, y), stroke) = (self.at(&at), Colour::Red.hex());
        let _ = writeln!(
            out,
            "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"3.5\" fill=\"none\" stroke=\"{stroke}\" stroke-width=\"1.4\" opacity=\"{opacity}\"/>"
        );
    }
}

/// A line of text.
pub(super) fn text(out: &mut String, x: f64, y: f64, size: u32, text: &str) {
    let text = text.replace('&', "&amp;").replace('<', "&lt;");
    let _ = writeln!(out, "<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\" fill=\"#22262B\">{text}</text>");
}
