//! Raw samples where they lie, about b, and the corrected ones about the origin: what a device's own disturbance does to a field.

use super::square::{PANEL, Square, picture, text};
use crate::play::Step;
use crate::plot::Colour;
use magcomp::nalgebra::{Vector2, Vector3};
use magcomp_recordings::recording::Recording;
use std::ops::Range;

/// Height of the line above a panel, pixels.
const TITLE: f64 = 44.0;
/// Points of a kind in a panel, at most.
const MOST_POINTS: usize = 1500;
/// Half the width of a panel in extents of what it shows.
const ROOM: f64 = 1.08;

/// A picture with one panel for each stretch of time, s after the first row, with its title; all in the plane of two axes of the device.
pub fn offset_picture(
    recording: &Recording,
    steps: &[Step],
    axes: (usize, usize),
    stretches: &[(Range<f64>, &str)],
) -> String {
    let names = ["x", "y", "z"];
    let flat = |v: &Vector3<f64>| Vector2::new(v[axes.0], v[axes.1]);
    let start_s = recording.extent().start_s;
    let both: Vec<_> = recording.rows.iter().zip(steps).collect();
    let within = |range: &Range<f64>| {
        let rows: Vec<_> = both.iter().filter(|(row, _)| range.contains(&(row.time_s - start_s))).collect();
        let every = rows.len().div_ceil(MOST_POINTS).max(1);
        let raw: Vec<_> = rows.iter().step_by(every).map(|(row, _)| flat(&row.field_ut)).collect();
        let corrected: Vec<_> =
            rows.iter().step_by(every).filter_map(|(_, step)| step.reading.field_ut.as_ref().map(flat)).collect();
        let found = rows.iter().rev().find_map(|(_, step)| step.calibration);
        (raw, corrected, found.map(|found| *found.hard_iron_ut()))
    };
    let shown: Vec<_> = stretches.iter().map(|(range, title)| (within(range), *title)).collect();
    let size = |v: &Vector2<f64>| v.amax();
    let extent =
        shown.iter().flat_map(|((raw, ..), _)| raw.iter().map(size)).filter(|it| it.is_finite()).fold(1.0, f64::max);
    picture(PANEL * shown.len() as f64, PANEL + TITLE, |out| {
        for (column, ((raw, corrected, found), title)) in shown.iter().enumerate() {
            let panel = Square { left: column as f64 * PANEL, top: TITLE, scale: 0.5 * PANEL / (ROOM * extent) };
            text(out, panel.left + 10.0, 16.0, 13, title);
            let told =
                found.map_or_else(|| "no calibration yet".to_owned(), |b| format!("b found: {:.1} uT", b.norm()));
            panel.begin(out, &format!("{} right, {} up; {told}", names[axes.0], names[axes.1]));
            panel.points(out, raw.iter().copied(), Colour::Grey);
            panel.points(out, corrected.iter().copied(), Colour::Blue);
            if let Some(found) = found {
                panel.line(out, [Vector2::zeros(), flat(found)].into_iter(), Colour::Red, 1.0);
                panel.ring(out, flat(found), 1.0);
            }
            panel.end(out);
        }
    })
}
