//! The figures of a recording: name, how it is shown, which of two is worse, and where it comes from.

use magcomp_replay::{AbsoluteHeading, HeadingError, Judgement};

/// Which values of a figure are bad.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Worse {
    /// Large ones.
    Large,
    /// Small ones.
    Small,
    /// It has no bad side, so groups do not sum it up.
    Neither,
}

/// One figure.
#[derive(Clone, Copy, Debug)]
pub struct Figure {
    /// Its name in JSON, with its unit; a share has none.
    pub name: &'static str,
    /// Its column in tables.
    pub column: &'static str,
    /// Shown times this, with so many digits after the point.
    pub shown: (f64, usize),
    /// Which values are bad.
    pub worse: Worse,
    /// Its value, by the judgement and the bound, degrees.
    pub of: fn(&Judgement, Option<f64>) -> Option<f64>,
}

const AS_IS: f64 = 1.0;
const PERCENT: f64 = 100.0;

/// Fewest headings that the figures of the published heading are formed from: a few moments would not stand for a recording.
const FEWEST: usize = 100;

/// All figures, in the order of the columns.
pub const FIGURES: [Figure; 18] = [
    large("heading_rms_deg", "heading", |found, _| Some(published(found)?.rms_deg)),
    large("heading_p95_deg", "p95", |found, _| Some(published(found)?.p95_deg)),
    large("heading_absolute_deg", "absolute", |found, _| absolute(found)?.rms_deg),
    Figure {
        worse: Worse::Neither,
        ..large("constant_deg", "constant", |found, _| Some(published(found)?.constant_deg))
    },
    Figure { worse: Worse::Neither, ..large("bound_deg", "bound", |_, bound_deg| bound_deg) },
    Figure {
        shown: (AS_IS, 2),
        ..large("over_bound", "/ bound", |found, bound_deg| Some(published(found)?.rms_deg / bound_deg?))
    },
    large("corrected_rms_deg", "c", |found, _| Some(found.heading?.rms_deg)),
    large("corrected_absolute_deg", "c abs.", |found, _| Some(found.heading?.absolute_rms_deg)),
    large("carried_rms_deg", "f", |found, _| Some(found.carried_heading?.rms_deg)),
    large("carried_absolute_deg", "f abs.", |found, _| Some(found.carried_heading?.absolute_rms_deg)),
    small("within_one_sigma", "in 1 s %", |found, _| Some(absolute(found)?.within_sigma?[0])),
    small("within_two_sigma", "in 2 s %", |found, _| Some(absolute(found)?.within_sigma?[1])),
    Figure { shown: (AS_IS, 2), ..large("z_squared", "z^2", |found, _| absolute(found)?.z_squared) },
    large("sigma_deg", "sigma", |found, _| absolute(found)?.sigma_deg),
    large("longest_lie_s", "lie s", |found, _| absolute(found)?.longest_lie_s),
    large("device_steps_per_hour", "steps/h", |found, _| {
        let hours = found.duration_s / 3600.0;
        (hours > 0.0).then(|| found.device_changes.len() as f64 / hours)
    }),
    large("first_s", "first s", |found, _| found.absolute_heading.first_s),
    small("answered", "answered %", |found, _| {
        let AbsoluteHeading { rows, headings, .. } = found.absolute_heading;
        (rows > 0).then(|| headings as f64 / rows as f64)
    }),
];

/// A figure of which large values are bad, shown with a digit after the point.
const fn large(name: &'static str, column: &'static str, of: fn(&Judgement, Option<f64>) -> Option<f64>) -> Figure {
    Figure { name, column, shown: (AS_IS, 1), worse: Worse::Large, of }
}

/// A share of which small values are bad, shown in percent.
const fn small(name: &'static str, column: &'static str, of: fn(&Judgement, Option<f64>) -> Option<f64>) -> Figure {
    Figure { name, column, shown: (PERCENT, 0), worse: Worse::Small, of }
}

pub(super) fn absolute(found: &Judgement) -> Option<AbsoluteHeading> {
    Some(found.absolute_heading).filter(|heading| heading.headings >= FEWEST)
}

pub(super) fn published(found: &Judgement) -> Option<HeadingError> {
    found.published_heading.filter(|_| absolute(found).is_some())
}
