//! The heading of a walk against its surveyed legs: where no reference orientation was recorded, the way itself is one.
//!
//! A leg is the straight way between two waypoints at least 3 m apart. Its error is the circular mean of the heading over the
//! middle 60 % of its time less its azimuth on the map; the map's own rotation and how the phone was held are one constant, so
//! that the figure is the circular standard deviation over the legs: sqrt(-2 ln |mean of exp(i error)|).

use super::level::AveragedUp;
use crate::beside::read_table;
use crate::play::Step;
use magcomp::{ReferenceAxis, ScreenRotation, heading};
use magcomp_recordings::error::RecordingError;
use magcomp_recordings::recording::Row;
use serde::{Deserialize, Serialize};
use std::ops::Range;
use std::path::Path;

const SHORTEST_M: f64 = 3.0;
/// Share of a leg's time at either end that is left out: the walker still turns.
const END: f64 = 0.2;

/// One surveyed position and when the walker was there.
#[derive(Clone, Copy, Debug, PartialEq, Deserialize)]
pub struct Waypoint {
    t_s: f64,
    x_m: f64,
    y_m: f64,
}

/// How well the heading follows the legs.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct LegJudgement {
    /// Legs that count.
    pub legs: usize,
    /// Circular standard deviation over the legs, degrees.
    pub deviation_deg: f64,
    /// The same of the recording's own field.
    pub raw_deviation_deg: f64,
}

/// Reads waypoints: CSV with the header t_s,x_m,y_m (s; m, x right and y up on the map), gzipped or not.
pub fn read_waypoints(path: &Path) -> Result<Vec<Waypoint>, RecordingError> {
    read_table(path, "waypoints with the columns t_s,x_m,y_m")
}

/// Judges the headings of a replay row by row.
#[derive(Clone, Debug)]
pub struct Legs {
    legs: Vec<Leg>,
    /// The raw heading's.
    up: AveragedUp,
}

/// A leg, and the sums of the sines and cosines of the headings on it.
#[derive(Clone, Debug)]
struct Leg {
    azimuth_deg: f64,
    middle: Range<f64>,
    ours: (f64, f64),
    raw: (f64, f64),
    rows: usize,
}

impl Legs {
    /// The legs between waypoints.
    pub fn new(waypoints: &[Waypoint]) -> Self {
        let legs = waypoints.windows(2).filter_map(|leg| {
            let (dx, dy) = (leg[1].x_m - leg[0].x_m, leg[1].y_m - leg[0].y_m);
            let over_s = leg[1].t_s - leg[0].t_s;
            let middle = leg[0].t_s + END * over_s..leg[1].t_s - END * over_s;
            let azimuth_deg = dx.atan2(dy).to_degrees();
            let leg = Leg { azimuth_deg, middle, ours: (0.0, 0.0), raw: (0.0, 0.0), rows: 0 };
            (dx.hypot(dy) >= SHORTEST_M).then_some(leg)
        });
        Self { legs: legs.collect(), up: AveragedUp::default() }
    }

    /// The next row and the compensator's step for it.
    pub fn add(&mut self, row: &Row, step: &Step) {
        let raw_deg = self.raw_heading_deg(row);
        let (Some(heading), Some(raw_deg)) = (step.reading.heading, raw_deg) else { return };
        for leg in self.legs.iter_mut().filter(|leg| leg.middle.contains(&row.time_s)) {
            leg.ours = plus(leg.ours, heading.heading_deg);
            leg.raw = plus(leg.raw, raw_deg);
            leg.rows += 1;
        }
    }

    /// The result; none with fewer than two legs on which there was a heading.
    pub fn finish(&self) -> Option<LegJudgement> {
        let errors = |of: fn(&Leg) -> (f64, f64)| {
            let known = self.legs.iter().filter(|leg| leg.rows > 0);
            let errors = known.map(move |leg| {
                let (east, north) = of(leg);
                east.atan2(north).to_degrees() - leg.azimuth_deg
            });
            errors.collect::<Vec<f64>>()
        };
        let deviation_deg = |errors: Vec<f64>| {
            let (east, north) = errors.iter().fold((0.0, 0.0), |sum, error| plus(sum, *error));
            (-2.0 * (east.hypot(north) / errors.len() as f64).ln()).max(0.0).sqrt().to_degrees()
        };
        let (ours, raw) = (errors(|leg| leg.ours), errors(|leg| leg.raw));
        (ours.len() > 1).then(|| LegJudgement {
            legs: ours.len(),
            deviation_deg: deviation_deg(ours),
            raw_deviation_deg: deviation_deg(raw),
        })
    }

    /// Tilt-compensated heading of the field as recorded.
    fn raw_heading_deg(&mut self, row: &Row) -> Option<f64> {
        let found = heading(&row.field_ut, &self.up.after(row)?, ReferenceAxis::TopEdge, ScreenRotation::default())?;
        Some(found.heading_deg)
    }
}

/// A sum of sines and cosines, and one more angle, degrees.
fn plus(sum: (f64, f64), angle_deg: f64) -> (f64, f64) {
    let (sin, cos) = angle_deg.to_radians().sin_cos();
    (sum.0 + sin, sum.1 + cos)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Ignore, replay};
    use magcomp::nalgebra::Vector3;
    use magcomp::{Config, Method};
    use magcomp_recordings::recording::Recording;

    #[test]
    fn a_turned_map_is_no_error_and_a_wrong_field_is() {
        // flat, walking north then east for 10 s each; the map is turned by 30 deg
        let row = |k: usize| {
            let time_s = k as f64 * 0.1;
            let (east, north) = if time_s < 10.0 { (0.0, 20.0) } else { (-20.0, 0.0) };
            Row {
                time_s,
                time_ns: (time_s * 1e9) as i64,
                field_ut: Vector3::new(east, north, -40.0),
                up_m_s2: Some(Vector3::new(0.0, 0.0, 9.8)),
                ..Row::default()
            }
        };
        let recording = Recording { path: "walk.csv".into(), rows: (0..200).map(row).collect() };
        let way = |turned_deg: f64| {
            let (sin, cos) = turned_deg.to_radians().sin_cos();
            let at = |t_s, x: f64, y: f64| Waypoint { t_s, x_m: x * cos + y * sin, y_m: y * cos - x * sin };
            [at(0.0, 0.0, 0.0), at(10.0, 0.0, 12.0), at(20.0, 12.0, 12.0)]
        };
        let judge_legs = |steps: &[Step], waypoints: &[Waypoint]| {
            let mut legs = Legs::new(waypoints);
            recording.rows.iter().zip(steps).for_each(|(row, step)| legs.add(row, step));
            legs.finish()
        };
        let config = Config { method: Method::Windowed, ..Config::default() };
        let mut steps = replay(&recording, &config, Ignore::default()).unwrap();
        assert_eq!(judge_legs(&steps, &way(0.0)), None, "there was no heading");
        for (step, row) in steps.iter_mut().zip(&recording.rows) {
            let up = Vector3::z();
            step.reading.heading = heading(&row.field_ut, &up, ReferenceAxis::TopEdge, ScreenRotation::default());
        }
        let found = judge_legs(&steps, &way(30.0)).unwrap();
        assert_eq!(found.legs, 2);
        assert!(found.deviation_deg < 1e-6 && found.raw_deviation_deg < 1e-6, "{found:?}");
        // +-10 deg about the mean: the sd is 10 deg, to the order of its cube
        let wrong: Vec<_> = way(0.0).iter().map(|w| Waypoint { x_m: w.x_m + 0.364 * (w.y_m - w.x_m), ..*w }).collect();
        assert!(judge_legs(&steps, &wrong).unwrap().deviation_deg > 5.0);
    }
}
