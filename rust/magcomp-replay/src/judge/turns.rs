//! The heading over full turns by the gyroscope: where no reference was recorded, the gyroscope is one for as long as a turn lasts.
//!
//! In the frame that gyroscope and gravity carry ([`super::level`]) the field should point along one azimuth while the device turns
//! once about the vertical. A hard iron that is left over swings it to either side and back. The end of a turn against its start alone
//! would not show that: any field, even the raw one, returns with the device. What the corrected field lacks to that is the gyroscope's
//! own drift, which is taken out evenly.

use super::circle::off_deg;
use super::directions::Kinds;
use magcomp::nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;
use std::collections::VecDeque;

/// A turn that takes longer does not count, s: the gyroscope's own drift would be told as the field's.
const LONGEST_S: f64 = 60.0;
/// Time between two points of a turn, s.
const STEP_S: f64 = 0.1;
/// Fewest points of a turn, and how many of them tell an end of it.
const FEWEST_POINTS: usize = 8;
const END_POINTS: usize = 3;
/// A longer pause, s, breaks a turn off.
const PAUSE_S: f64 = 0.5;

/// How far the field's azimuth swings within full turns.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TurnJudgement {
    /// Full turns about the vertical that took at most 60 s.
    pub turns: usize,
    /// Root mean square of the azimuth within a turn about its mean there, less the gyroscope's drift, degrees.
    pub rms_deg: Kinds<f64>,
}

/// Points of the turn in the making, and the sums of those that were made.
#[derive(Clone, Debug, Default)]
pub(super) struct Turns {
    before: Option<(f64, UnitQuaternion<f64>)>,
    /// Turned so far about the vertical, degrees.
    turned_deg: f64,
    points: VecDeque<Point>,
    turns: usize,
    /// Sum of squares, and number, of each kind.
    sums: [(f64, usize); 3],
}

#[derive(Clone, Copy, Debug)]
struct Point {
    time_s: f64,
    turned_deg: f64,
    /// Of raw, the system's, compensated.
    azimuths_deg: [Option<f64>; 3],
}

impl Turns {
    /// The next row: the attitude by gyroscope and gravity, and the field raw, the system's and compensated; `fields` is none where no
    /// figure is wanted of the row.
    pub fn add(&mut self, time_s: f64, attitude: &UnitQuaternion<f64>, fields: Option<[Option<Vector3<f64>>; 3]>) {
        match self.before {
            Some((before_s, before)) if time_s - before_s <= PAUSE_S => {
                let since = attitude * before.inverse();
                self.turned_deg += off_deg(2.0 * since.k.atan2(since.w).to_degrees(), 0.0);
            }
            _ => self.points.clear(),
        }
        self.before = Some((time_s, *attitude));
        let Some(fields) = fields else { return };
        if self.points.back().is_some_and(|latest| time_s - latest.time_s < STEP_S) {
            return;
        }
        let azimuth_deg = |field: Vector3<f64>| {
            let level = attitude * field;
            Some(level.x.atan2(level.y).to_degrees()).filter(|azimuth| azimuth.is_finite())
        };
        let azimuths_deg = fields.map(|field| field.and_then(azimuth_deg));
        self.points.push_back(Point { time_s, turned_deg: self.turned_deg, azimuths_deg });
        while self.points.front().is_some_and(|first| time_s - first.time_s > LONGEST_S) {
            self.points.pop_front();
        }
        let whole = |point: &Point| (self.turned_deg - point.turned_deg).abs() >= 360.0;
        if let Some(start) = self.points.iter().rposition(whole) {
            self.points.drain(..start);
            self.finish_turn();
        }
    }

    fn finish_turn(&mut self) {
        let points = std::mem::take(&mut self.points);
        if points.len() < FEWEST_POINTS {
            return;
        }
        self.turns += 1;
        let (first, latest) = (points[0], points[points.len() - 1]);
        let compensated = |point: &Point| point.azimuths_deg[2];
        let ends = [
            mean_deg(points.iter().take(END_POINTS).filter_map(compensated)),
            mean_deg(points.iter().rev().take(END_POINTS).filter_map(compensated)),
        ];
        let drift_deg_s = off_deg(ends[1], ends[0]) / (latest.time_s - first.time_s);
        for (kind, (squares, count)) in self.sums.iter_mut().enumerate() {
            let azimuths = || {
                points
                    .iter()
                    .filter_map(|point| Some(point.azimuths_deg[kind]? - drift_deg_s * (point.time_s - first.time_s)))
            };
            let centre_deg = mean_deg(azimuths());
            *squares += azimuths().map(|azimuth_deg| off_deg(azimuth_deg, centre_deg).powi(2)).sum::<f64>();
            *count += azimuths().count();
        }
    }

    /// The figures; none without a full turn.
    pub fn finish(&self) -> Option<TurnJudgement> {
        let [raw, system, compensated] =
            self.sums.map(|(squares, count)| (count > 0).then(|| (squares / count as f64).sqrt()));
        (self.turns > 0).then_some(TurnJudgement { turns: self.turns, rms_deg: Kinds { raw, system, compensated } })
    }
}

/// Circular mean, degrees.
fn mean_deg(azimuths_deg: impl Iterator<Item = f64>) -> f64 {
    let (sin, cos) = azimuths_deg.fold((0.0, 0.0), |(sin, cos), azimuth_deg| {
        let (s, c) = azimuth_deg.to_radians().sin_cos();
        (sin + s, cos + c)
    });
    f64::atan2(sin, cos).to_degrees()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Turned evenly in the horizontal plane, the field (0, 20, -40) uT with a hard iron of 5 uT on the device's y; the attitude
    /// drifts.
    fn turned(seconds: f64, turns: f64, drift_deg_s: f64) -> Option<TurnJudgement> {
        let mut found = Turns::default();
        for k in 0..(seconds * 50.0) as usize {
            let time_s = k as f64 / 50.0;
            let angle = std::f64::consts::TAU * turns * time_s / seconds;
            let attitude = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
            let field = attitude.inverse() * Vector3::new(0.0, 20.0, -40.0);
            let attitude =
                UnitQuaternion::from_axis_angle(&Vector3::z_axis(), (drift_deg_s * time_s).to_radians()) * attitude;
            let raw = field + Vector3::new(0.0, 5.0, 0.0);
            found.add(time_s, &attitude, Some([Some(raw), None, Some(field)]));
        }
        found.finish()
    }

    #[test]
    fn a_hard_iron_swings_the_azimuth_within_a_turn() {
        let found = turned(31.0, 3.1, 0.0).unwrap();
        // asin(5 / 20) is 14.48 deg at most; rms of atan(sin / (4 + cos)) over a turn is 10.21
        assert_eq!(found.turns, 3);
        assert!((found.rms_deg.raw.unwrap() - 10.21).abs() < 0.1, "{found:?}");
        assert!(found.rms_deg.compensated.unwrap() < 1e-9 && found.rms_deg.system.is_none(), "{found:?}");
    }

    #[test]
    fn the_gyroscopes_drift_is_taken_out() {
        let found = turned(31.0, 3.1, 1.0).unwrap();
        assert!(found.rms_deg.compensated.unwrap() < 0.3, "{found:?}");
        assert!((found.rms_deg.raw.unwrap() - 10.21).abs() < 0.5, "{found:?}");
    }

    #[test]
    fn half_turns_and_slow_ones_do_not_count() {
        assert_eq!(turned(10.0, 0.9, 0.0), None);
        assert_eq!(turned(200.0, 3.0, 0.0), None);
    }
}
