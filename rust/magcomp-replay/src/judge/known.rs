//! How well the published heading is known by its own sigma, and why there is none: what a user without a reference can be told.

use super::level::Level;
use crate::statistics::Sizes;
use magcomp::nalgebra::{UnitQuaternion, Vector3};
use magcomp::{Reading, ReferenceAxis, Status};
use magcomp_recordings::recording::Row;
use serde::Serialize;

/// A heading whose two sigmas are more than this is of no use, degrees.
const USELESS_DEG: f64 = 60.0;
/// The widest two sigmas that are still told of most of the headings, degrees; where they are wider, fewer are told.
const WIDE_DEG: f64 = 20.0;
/// Shares of the headings, thousandths, that are told in this order.
const SHARES: [u64; 3] = [950, 800, 500];
/// Cosine of the angle to the vertical within which an axis has no heading, 30 degrees.
const STEEP: f64 = 0.866;
/// Attitudes are compared this far apart, s; one that differs by less from the latest that counted has not turned, degrees.
const APART_S: f64 = 0.5;
const TURNED_DEG: f64 = 3.0;
/// A device that turned by less in all shows too little of its iron, degrees.
const ENOUGH_DEG: f64 = 360.0;

/// How well the published heading is known.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct KnownHeading {
    /// Share of the counted rows whose heading has two sigmas of at most 60 degrees.
    pub share: f64,
    /// Two sigmas that `within_share` of the counted rows have at most, degrees; none without headings.
    pub two_sigma_deg: Option<f64>,
    /// That share of the counted rows.
    pub within_share: f64,
    /// Median of the sigmas of all headings, degrees.
    pub sigma_deg: Option<f64>,
    /// How far the device was turned in all, degrees; none without gyroscope and accelerometer.
    pub turned_deg: Option<f64>,
    /// Why there is no heading; none where there are some.
    pub none_because: Option<String>,
}

impl KnownHeading {
    /// The device hardly turned.
    pub fn is_unmoved(&self) -> bool {
        self.turned_deg.is_some_and(|turned_deg| turned_deg < ENOUGH_DEG)
    }
}

/// The above in the making.
#[derive(Debug, Default)]
pub(super) struct Known {
    axis: ReferenceAxis,
    rows: usize,
    useful: Sizes,
    sigmas: Sizes,
    has_up: bool,
    steep: usize,
    level: usize,
    last: Option<Status>,
    before: Option<(f64, UnitQuaternion<f64>)>,
    turned_deg: Option<f64>,
}

impl Known {
    /// For a heading of this axis.
    pub fn new(axis: ReferenceAxis) -> Self {
        Self { axis, ..Self::default() }
    }

    /// Any row, after its sensors were added to `level`, and what was said to it.
    pub fn see(&mut self, row: &Row, level: &Level, status: Status) {
        self.last = Some(status);
        self.has_up |= row.latest_up().is_some();
        if let Some(up) = level.up() {
            let axis = match self.axis {
                ReferenceAxis::TopEdge => Some(Vector3::y()),
                ReferenceAxis::Camera => Some(-Vector3::z()),
                // the better of both is hardly ever steep
                _ => None,
            };
            self.level += 1;
            self.steep += usize::from(axis.is_some_and(|axis| up.dot(&axis).abs() > STEEP * up.norm()));
        }
        if self.before.is_none_or(|(before_s, _)| row.time_s - before_s >= APART_S)
            && let Some(attitude) = level.attitude()
        {
            let turned_deg = self.turned_deg.get_or_insert(0.0);
            // a slow turn adds up to one that counts
            let before = self.before.map_or(attitude, |(_, before)| before);
            let by_deg = attitude.angle_to(&before).to_degrees();
            let has_turned = by_deg > TURNED_DEG;
            *turned_deg += if has_turned { by_deg } else { 0.0 };
            self.before = Some((row.time_s, if has_turned { attitude } else { before }));
        }
    }

    /// The reading of a row that counts.
    pub fn add(&mut self, reading: &Reading) {
        self.rows += 1;
        if let Some(sigma_deg) = reading.heading.and_then(|heading| heading.heading_sigma_deg) {
            self.sigmas.add(sigma_deg);
            if 2.0 * sigma_deg <= USELESS_DEG {
                self.useful.add(2.0 * sigma_deg);
            }
        }
    }

    pub fn finish(&self, duration_s: f64, is_corrected: bool) -> KnownHeading {
        let rows = self.rows.max(1) as f64;
        let share = self.useful.count() as f64 / rows;
        let told = SHARES.into_iter().find(|share| self.useful.at(*share).is_some_and(|deg| deg <= WIDE_DEG));
        let told = told.unwrap_or(SHARES[SHARES.len() - 1]);
        KnownHeading {
            share,
            two_sigma_deg: self.useful.at(told),
            within_share: share * told as f64 / 1000.0,
            sigma_deg: self.sigmas.at(500),
            turned_deg: self.turned_deg,
            none_because: (self.useful.count() == 0).then(|| self.reason(duration_s, is_corrected)),
        }
    }

    fn reason(&self, duration_s: f64, is_corrected: bool) -> String {
        let steep = self.steep as f64 / self.level.max(1) as f64;
        let name = if self.axis == ReferenceAxis::Camera { "the camera" } else { "the top edge" };
        match self.last {
            Some(last) if !is_corrected => format!("after {duration_s:.0} s it says: {last}"),
            _ if !self.has_up => {
                "the recording has no acceleration with gravity: record the accelerometer too".to_owned()
            }
            _ if steep > 0.5 => format!(
                "{name} points up or down in {:.0} % of the time, where it has no heading: --axis {}",
                100.0 * steep,
                if self.axis == ReferenceAxis::Camera { "top or --axis auto" } else { "camera or --axis auto" }
            ),
            _ if self.sigmas.count() > 0 => {
                format!("its two sigmas stay above {USELESS_DEG:.0} deg: the field tells too little of north")
            }
            Some(last) => format!("at the end it says: {last}"),
            None => format!("the recording lasts {duration_s:.1} s"),
        }
    }
}
