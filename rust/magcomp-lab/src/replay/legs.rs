//! The heading of a walk against its surveyed legs: where no reference orientation was recorded, the way itself is one.
//!
//! A leg is the straight way between two waypoints at least 3 m apart. Its error is the circular mean of the heading over the
//! middle 60 % of its time less its azimuth on the map; the map's own rotation and how the phone was held are one constant, so
//! that the figure is the circular standard deviation over the legs: sqrt(-2 ln |mean of exp(i error)|).

use super::Step;
use crate::error::{LabError, Place};
use crate::recording::Recording;
use magcomp::nalgebra::Vector3;
use magcomp::{ReferenceAxis, ScreenRotation, heading};
use serde::{Deserialize, Serialize};
use std::path::Path;

const SHORTEST_M: f64 = 3.0;
/// Share of a leg's time at either end that is left out: the walker still turns.
const END: f64 = 0.2;
/// The raw heading's `up` is the accelerometer averaged over this time, s.
const UP_TIME_S: f64 = 1.0;

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
///
/// # Errors
/// [`LabError::Recording`] for a file of another form, [`LabError::Read`] when it cannot be read.
pub fn read_waypoints(path: &Path) -> Result<Vec<Waypoint>, LabError> {
    let file = crate::recording::open(path)?;
    let wrong = |error: csv::Error| LabError::Recording {
        place: Place { path: path.to_owned(), line: error.position().map_or(1, csv::Position::line), column: None },
        expected: "waypoints with the columns t_s,x_m,y_m".to_owned(),
        found: error.to_string(),
    };
    csv::Reader::from_reader(file).deserialize().collect::<Result<_, _>>().map_err(wrong)
}

/// Judges the headings of a replay; none with fewer than two legs on which there was a heading.
#[must_use]
pub fn judge_legs(recording: &Recording, steps: &[Step], waypoints: &[Waypoint]) -> Option<LegJudgement> {
    let ours: Vec<Option<f64>> = steps.iter().map(|step| Some(step.reading.heading?.heading_deg)).collect();
    let raw = raw_headings_deg(recording);
    let mut errors = Vec::new();
    for leg in waypoints.windows(2) {
        let (dx, dy) = (leg[1].x_m - leg[0].x_m, leg[1].y_m - leg[0].y_m);
        let over_s = leg[1].t_s - leg[0].t_s;
        let middle = leg[0].t_s + END * over_s..leg[1].t_s - END * over_s;
        let rows = recording.rows.iter().enumerate().filter(|(_, row)| middle.contains(&row.time_s));
        let rows: Vec<usize> = rows.map(|(k, _)| k).filter(|k| ours[*k].is_some() && raw[*k].is_some()).collect();
        if dx.hypot(dy) < SHORTEST_M || rows.is_empty() {
            continue;
        }
        let azimuth_deg = dx.atan2(dy).to_degrees();
        let error = |headings: &[Option<f64>]| {
            let (east, north) = sums(rows.iter().filter_map(|k| headings[*k]));
            east.atan2(north).to_degrees() - azimuth_deg
        };
        errors.push((error(&ours), error(&raw)));
    }
    let deviation_deg = |errors: &mut dyn Iterator<Item = f64>| {
        let count = errors.size_hint().0 as f64;
        let (east, north) = sums(errors);
        (-2.0 * (east.hypot(north) / count).ln()).max(0.0).sqrt().to_degrees()
    };
    (errors.len() > 1).then(|| LegJudgement {
        legs: errors.len(),
        deviation_deg: deviation_deg(&mut errors.iter().map(|(ours, _)| *ours)),
        raw_deviation_deg: deviation_deg(&mut errors.iter().map(|(_, raw)| *raw)),
    })
}

/// Sums of the sines and cosines of angles, degrees.
fn sums(angles_deg: impl Iterator<Item = f64>) -> (f64, f64) {
    angles_deg.map(|angle| angle.to_radians().sin_cos()).fold((0.0, 0.0), |sum, one| (sum.0 + one.0, sum.1 + one.1))
}

/// Tilt-compensated headings of the field as recorded.
fn raw_headings_deg(recording: &Recording) -> Vec<Option<f64>> {
    let mut up: Option<Vector3<f64>> = None;
    let mut before_s = f64::NEG_INFINITY;
    let heading_of = |row: &crate::recording::Row| {
        let gain = ((row.time_s - before_s) / UP_TIME_S).min(1.0);
        before_s = row.time_s;
        if let Some(measured) = row.up_m_s2 {
            let up = up.get_or_insert(measured);
            *up += (measured - *up) * gain;
        }
        let found = heading(&row.field_ut, &up?, ReferenceAxis::TopEdge, ScreenRotation::default())?;
        Some(found.heading_deg)
    };
    recording.rows.iter().map(heading_of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::Row;
    use crate::replay::{Ignore, replay};
    use magcomp::{Config, Method};

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
                rate_rad_s: None,
                attitude: None,
                hard_iron_ut: None,
            }
        };
        let recording = Recording { path: "walk.csv".into(), rows: (0..200).map(row).collect() };
        let way = |turned_deg: f64| {
            let (sin, cos) = turned_deg.to_radians().sin_cos();
            let at = |t_s, x: f64, y: f64| Waypoint { t_s, x_m: x * cos + y * sin, y_m: y * cos - x * sin };
            [at(0.0, 0.0, 0.0), at(10.0, 0.0, 12.0), at(20.0, 12.0, 12.0)]
        };
        let config = Config { method: Method::Windowed, ..Config::default() };
        let mut steps = replay(&recording, &config, Ignore::default()).unwrap();
        assert_eq!(judge_legs(&recording, &steps, &way(0.0)), None, "there was no heading");
        for (step, row) in steps.iter_mut().zip(&recording.rows) {
            let up = Vector3::z();
            step.reading.heading = heading(&row.field_ut, &up, ReferenceAxis::TopEdge, ScreenRotation::default());
        }
        let found = judge_legs(&recording, &steps, &way(30.0)).unwrap();
        assert_eq!(found.legs, 2);
        assert!(found.deviation_deg < 1e-6 && found.raw_deviation_deg < 1e-6, "{found:?}");
        // +-10 deg about the mean: the sd is 10 deg, to the order of its cube
        let wrong: Vec<_> = way(0.0).iter().map(|w| Waypoint { x_m: w.x_m + 0.364 * (w.y_m - w.x_m), ..*w }).collect();
        assert!(judge_legs(&recording, &steps, &wrong).unwrap().deviation_deg > 5.0);
    }
}
