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

const AXES: [u32; 3] = [0x0080_40f0, 0x00b0_5010, 0x0070_90e0];
const STATUSES: [u32; 6] = [0x00a2_57c9, 0x009c_1c1c, 0x00e8_930c, 0x001f_9e6e, 0x006c_c5f0, 0x00f0_e07a];

/// Colours of series, legible on light and dark.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Colour {
    /// Headings that magcomp publishes; the colour of the text.
    Ink,
    /// What the operating system has made of the field.
    System,
    /// The device's axes, in this order.
    Axes(usize),
    /// The statuses, in the order of the status strip from the bottom: rejected, disturbed, suspect, tracking, held, collecting.
    Status(usize),
    /// This project's own results; corrected samples.
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
        let of = |hex: u32| RGBColor((hex >> 16) as u8, (hex >> 8) as u8, hex as u8);
        match self {
            Self::Ink => INK,
            Self::System => of(0x00b8_860b),
            Self::Axes(axis) => of(AXES[axis % AXES.len()]),
            Self::Status(lane) => of(STATUSES[lane % STATUSES.len()]),
            Self::Blue => RGBColor(0x2f, 0x7f, 0xd6),
            Self::Orange => RGBColor(0xd9, 0x74, 0x24),
            Self::Green => RGBColor(0x2c, 0x9c, 0x69),
            Self::Purple => RGBColor(0x95, 0x68, 0xcf),
            Self::Grey => RGBColor(0x88, 0x8f, 0x99),
            Self::Red => RGBColor(0xd0, 0x44, 0x44),
        }
    }
}

/// Puts the rule that exchanges ink and paper behind the opening tag.
pub(crate) fn with_dark_style(svg: &str) -> String {
    let rules: String = DARK
        .iter()
        .map(|(from, to)| format!("[fill=\"{from}\"]{{fill:{to}}}[stroke=\"{from}\"]{{stroke:{to}}}"))
        .collect();
    let style = format!("<style>@media (prefers-color-scheme: dark){{{rules}}}</style>");
    match svg.find('>') {
        Some(end) => format!("{}{style}{}", &svg[..=end], &svg[end + 1..]),
        None => svg.to_owned(),
    }
}

/// How far two colours stand out from one another, 1 to 21 (WCAG 2.2, relative luminance).
#[cfg(test)]
pub(crate) fn contrast(one: RGBColor, other: RGBColor) -> f64 {
    let luminance = |RGBColor(red, green, blue): RGBColor| {
        let linear = [red, green, blue].map(|value| {
            let c = f64::from(value) / 255.0;
            if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        0.2126 * linear[0] + 0.7152 * linear[1] + 0.0722 * linear[2] + 0.05
    };
    let (a, b) = (luminance(one), luminance(other));
    a.max(b) / a.min(b)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Linear light to linear light as it looks without the cones for green, and without those for red (Machado, Oliveira and Fernandes 2009).
    const SEEN: [[[f64; 3]; 3]; 3] = [
        [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]],
        [[0.367_322, 0.860_646, -0.227_968], [0.280_085, 0.672_501, 0.047_413], [-0.011_820, 0.042_940, 0.968_881]],
        [[0.152_286, 1.052_583, -0.204_868], [0.114_503, 0.786_281, 0.099_216], [-0.003_882, -0.048_116, 1.051_998]],
    ];
    /// sRGB to XYZ, and the white of D65.
    const XYZ: [[f64; 3]; 3] = [[0.4124, 0.3576, 0.1805], [0.2126, 0.7152, 0.0722], [0.0193, 0.1192, 0.9505]];
    const WHITE: [f64; 3] = [0.9505, 1.0, 1.089];

    fn times(m: &[[f64; 3]; 3], v: [f64; 3]) -> [f64; 3] {
        m.map(|row| row.iter().zip(v).map(|(a, b)| a * b).sum())
    }

    /// CIELAB of a colour as it is seen.
    fn lab(colour: RGBColor, seen: &[[f64; 3]; 3]) -> [f64; 3] {
        let linear = [colour.0, colour.1, colour.2].map(|value| {
            let c = f64::from(value) / 255.0;
            if c <= 0.040_45 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        });
        let xyz = times(&XYZ, times(seen, linear).map(|c| c.clamp(0.0, 1.0)));
        let part = |k: usize| {
            let v = xyz[k] / WHITE[k];
            if v > 0.008_856 { v.cbrt() } else { 7.787 * v + 16.0 / 116.0 }
        };
        let [x, y, z] = [part(0), part(1), part(2)];
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    }

    /// The least difference (CIE76) between any two, for whoever sees worst.
    fn least_apart(colours: &[RGBColor]) -> f64 {
        let mut least = f64::INFINITY;
        for (k, one) in colours.iter().enumerate() {
            for other in &colours[..k] {
                for seen in &SEEN {
                    let (a, b) = (lab(*one, seen), lab(*other, seen));
                    least = least.min(a.iter().zip(b).map(|(a, b)| (a - b).powi(2)).sum::<f64>().sqrt());
                }
            }
        }
        least
    }

    /// Lines of series are told from the paper, light and dark: 3 to 1, as marks want it (WCAG 2.2, 1.4.11); text and axes 4.5 to 1. Spans of
    /// the status strip have the outline of the ink.
    #[test]
    fn lines_and_text_stand_out_from_the_paper() {
        let of = |hex: &str| {
            let part = |k: usize| u8::from_str_radix(&hex[k..k + 2], 16).unwrap();
            RGBColor(part(1), part(3), part(5))
        };
        let axes = [0, 1, 2].map(Colour::Axes);
        let named =
            [Colour::System, Colour::Blue, Colour::Orange, Colour::Green, Colour::Purple, Colour::Grey, Colour::Red];
        for colour in axes.into_iter().chain(named) {
            for paper in [DARK[2].0, DARK[2].1] {
                let contrast = contrast(colour.rgb(), of(paper));
                assert!(contrast >= 3.0, "{colour:?} on {paper}: {contrast}");
            }
        }
        for (ink, paper) in [(DARK[0].0, DARK[2].0), (DARK[0].1, DARK[2].1)] {
            assert!(contrast(of(ink), of(paper)) >= 4.5, "{ink} on {paper}");
        }
        let [black, white] = [RGBColor(0, 0, 0), RGBColor(255, 255, 255)];
        assert!((contrast(black, white) - 21.0).abs() < 1e-9 && (contrast(white, white) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn who_sees_no_red_or_no_green_tells_the_lines_of_a_panel_apart() {
        let rgb = |colours: &[Colour]| colours.iter().map(|colour| colour.rgb()).collect::<Vec<_>>();
        let dark = RGBColor(0xe4, 0xe7, 0xeb);
        let statuses = rgb(&[0, 1, 2, 3, 4, 5].map(Colour::Status));
        let axes = rgb(&[Colour::Axes(0), Colour::Axes(1), Colour::Axes(2), Colour::Grey]);
        let field = rgb(&[Colour::Grey, Colour::System, Colour::Blue]);
        let errors = rgb(&[Colour::Grey, Colour::Orange, Colour::Ink]);
        let on_dark = [Colour::Grey.rgb(), Colour::Orange.rgb(), dark];
        for colours in [statuses, axes, field, errors, on_dark.to_vec()] {
            let apart = least_apart(&colours);
            assert!(apart > 25.0, "{apart}: {colours:?}");
        }
    }
}
