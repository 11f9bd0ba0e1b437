//! Colours that are legible on light and on dark pages.

use plotters::style::RGBColor;

/// Text and axes; exchanged on dark pages.
pub(super) const INK: RGBColor = RGBColor(0x22, 0x26, 0x2b);
/// Lines of the mesh; exchanged on dark pages.
pub(super) const MESH: RGBColor = RGBColor(0xdd, 0xe1, 0xe6);
/// Background; exchanged on dark pages.
pub(super) const PAPER: RGBColor = RGBColor(0xff, 0xff, 0xff);
/// Ink, mesh and paper, and their colours on dark pages, in CSS.
pub(super) const DARK: [(&str, &str); 3] = [("#22262B", "#e4e7eb"), ("#DDE1E6", "#343a42"), ("#FFFFFF", "#181b20")];

/// Colours of series, legible on light and dark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// This project's own results.
    Blue,
    /// Results that ours are compared with.
    Orange,
    /// A second result.
    Green,
    /// A third.
    Purple,
    /// Truth, raw data, limits.
    Grey,
    /// Errors and faults.
    Red,
}

impl Colour {
    /// As in SVG and CSS.
    pub(crate) fn hex(self) -> String {
        let RGBColor(red, green, blue) = self.rgb();
        format!("#{red:02x}{green:02x}{blue:02x}")
    }

    pub(super) fn rgb(self) -> RGBColor {
        match self {
            Self::Blue => RGBColor(0x2f, 0x7f, 0xd6),
            Self::Orange => RGBColor(0xe0, 0x7a, 0x2c),
            Self::Green => RGBColor(0x2c, 0x9c, 0x69),
            Self::Purple => RGBColor(0x95, 0x68, 0xcf),
            Self::Grey => RGBColor(0x88, 0x8f, 0x99),
            Self::Red => RGBColor(0xd0, 0x44, 0x44),
        }
    }
}
