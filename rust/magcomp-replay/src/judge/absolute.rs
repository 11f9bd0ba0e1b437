//! The published heading against the reference's own north, with nothing taken out: how wrong it is, and how honest its sigma.
//!
//! Only rows count whose axis is within 60 degrees of the horizontal by the reference: a heading means little beyond. Where a declination
//! was given, the published heading is the true one, and the reference's north has to be the true one too.

use super::circle::off_deg;
use crate::play::Step;
use crate::statistics::{FEWEST, Sizes};
use magcomp::nalgebra::Vector3;
use magcomp::{ReferenceAxis, ScreenRotation, Status, heading};
use magcomp_recordings::recording::Row;
use serde::Serialize;

/// Sine of the elevation of an axis whose heading is not judged any more, 60 degrees.
const STEEP: f64 = 0.866_025_403_784_438_6;
/// An error that is more sigmas than this counts as so many in the mean square: one flip would hide all other rows.
const MOST_SIGMAS: f64 = 10.0;
/// An error beyond so many sigmas, while the status says that all is well, is a lie.
const LIE_SIGMAS: f64 = 3.0;
/// Lies that are not further apart are one, s.
const TOGETHER_S: f64 = 0.2;

/// The published heading against the reference's own north.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct AbsoluteHeading {
    /// Rows with a reference whose axis is within 60 degrees of the horizontal.
    pub rows: usize,
    /// Those of them that have a heading.
    pub headings: usize,
    /// Time of the first heading of all after the first row, s.
    pub first_s: Option<f64>,
    /// Root mean square of the error, degrees; none of fewer than 50 headings, as all below.
    pub rms_deg: Option<f64>,
    /// Share of the errors within one and within two of their sigmas.
    pub within_sigma: Option<[f64; 2]>,
    /// Mean square of error over sigma, each at most 100: 1 is right, less is too wide a sigma.
    pub z_squared: Option<f64>,
    /// Median of the sigmas, degrees.
    pub sigma_deg: Option<f64>,
    /// Longest time with the status `tracking` and an error beyond three sigmas, s; breaks under 0.2 s do not end it.
    pub longest_lie_s: Option<f64>,
}

/// Sums of the above, row by row.
#[derive(Clone, Debug, Default)]
pub(super) struct Absolute {
    axis: ReferenceAxis,
    first_s: Option<f64>,
    rows: usize,
    headings: usize,
    squares_deg2: f64,
    with_sigma: usize,
    within: [usize; 2],
    squares_of_sigma: f64,
    sigmas_deg: Sizes,
    /// From when to when the latest lie was, s.
    lie: Option<(f64, f64)>,
    longest_lie_s: f64,
}

impl Absolute {
    /// Before the first row, for a heading of this axis.
    pub fn new(axis: ReferenceAxis) -> Self {
        Self { axis, ..Self::default() }
    }

    /// The next row, `after_s` after the first one; `counted`: it is part of the figures. Gives the error of its heading, degrees,
    /// positive where the heading is too far clockwise, where that can be told.
    pub fn add(&mut self, row: &Row, step: &Step, after_s: f64, counted: bool) -> Option<f64> {
        let published = step.reading.heading;
        if published.is_some() {
            self.first_s.get_or_insert(after_s);
        }
        let reference_deg = reference_heading_deg(row, self.axis)?;
        self.rows += usize::from(counted);
        let published = published?;
        let error_deg = off_deg(published.true_heading_deg.unwrap_or(published.heading_deg), reference_deg);
        if counted {
            self.headings += 1;
            self.squares_deg2 += error_deg * error_deg;
            if let Some(sigma_deg) = published.heading_sigma_deg.filter(|sigma_deg| *sigma_deg > 0.0) {
                let is_tracking = matches!(step.reading.status, Status::Tracking);
                self.add_sigma(after_s, error_deg.abs() / sigma_deg, sigma_deg, is_tracking);
            }
        }
        Some(error_deg)
    }

    fn add_sigma(&mut self, after_s: f64, sigmas: f64, sigma_deg: f64, is_tracking: bool) {
        self.with_sigma += 1;
        for (within, limit) in self.within.iter_mut().zip([1.0, 2.0]) {
            *within += usize::from(sigmas < limit);
        }
        self.squares_of_sigma += sigmas.min(MOST_SIGMAS).powi(2);
        self.sigmas_deg.add(sigma_deg);
        if is_tracking && sigmas > LIE_SIGMAS {
            let since_s =
                self.lie.filter(|(_, to_s)| after_s - to_s <= TOGETHER_S).map_or(after_s, |(since_s, _)| since_s);
            self.lie = Some((since_s, after_s));
            self.longest_lie_s = self.longest_lie_s.max(after_s - since_s);
        }
    }

    /// The figures.
    pub fn finish(&self) -> AbsoluteHeading {
        let share = |part: usize, whole: usize| part as f64 / whole.max(1) as f64;
        let has_sigmas = self.with_sigma >= FEWEST;
        AbsoluteHeading {
            rows: self.rows,
            headings: self.headings,
            first_s: self.first_s,
            rms_deg: (self.headings >= FEWEST).then(|| (self.squares_deg2 / self.headings as f64).sqrt()),
            within_sigma: has_sigmas.then(|| self.within.map(|within| share(within, self.with_sigma))),
            z_squared: has_sigmas.then(|| self.squares_of_sigma / self.with_sigma as f64),
            sigma_deg: self.sigmas_deg.at(500).filter(|_| has_sigmas),
            longest_lie_s: has_sigmas.then_some(self.longest_lie_s),
        }
    }
}

/// Heading of the axis by the reference, degrees; none where the axis is steep or there is no reference.
pub fn reference_heading_deg(row: &Row, axis: ReferenceAxis) -> Option<f64> {
    let to_device = row.attitude?.inverse();
    let (north, up) = (to_device * Vector3::y(), to_device * Vector3::z());
    let is_level = match axis {
        ReferenceAxis::TopEdge => up.y.abs() < STEEP,
        ReferenceAxis::Camera => up.z.abs() < STEEP,
        ReferenceAxis::Auto => true,
    };
    let reference = heading(&north, &up, axis, ScreenRotation::Deg0).filter(|_| is_level)?;
    Some(reference.heading_deg)
}
