//! How good a replay was, as far as a recording can tell: the spread of the total field, and the heading where there is
//! a reference orientation.
//!
//! Heading error: the corrected vector, turned to east-north-up by the reference, should point along one and the same
//! azimuth throughout. That azimuth (the place's declination against the reference's north) is taken out as the
//! circular median. The first seconds, in which any method still collects, do not count.
//!
//! Honesty: the share of heading errors within one and two of the sigmas that were given with them. Disturbance: the
//! field of the place was not the usual one where | |c| / median |c| - 1 | > 15 %; precision is the share of the rows
//! called disturbed that were, recall the share of those that were which were called so. c can only tell this where the
//! calibration is right.

use super::Step;
use crate::recording::{Recording, Row};
use magcomp::nalgebra::Vector3;
use magcomp::{ReferenceAxis, ScreenRotation, Status, heading};
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::Range;

/// Seconds at the start that do not count, but never more than half of a recording.
const WARM_UP_S: f64 = 20.0;
/// Fewest rows a figure is formed from.
const FEWEST: usize = 50;
/// Sine of the elevation of an axis whose heading is not judged any more, 60 degrees.
const STEEP: f64 = 0.866;
/// Deviation of the total field from the usual one that makes a row disturbed.
const DISTURBED: f64 = 0.15;

/// Error of the heading against the reference, up to one constant, degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeadingError {
    /// Root mean square.
    pub rms_deg: f64,
    /// 95th percentile of its size.
    pub p95_deg: f64,
    /// Share of the errors within one and within two of their sigmas; none where no sigma was given.
    pub within_sigma: Option<[f64; 2]>,
}

/// How well a disturbed field was called so.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Disturbance {
    /// Share of the rows in which the total field is off.
    pub share: f64,
    /// Share of the rows called disturbed in which it is; none when none was called so.
    pub precision: Option<f64>,
    /// Share of the rows in which it is that were called disturbed; none when there are none.
    pub recall: Option<f64>,
}

/// Something that the compensator declared.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Declared {
    /// What happened.
    pub kind: String,
    /// When it began, s after the first row.
    pub since_s: f64,
    /// When it was decided, s after the first row.
    pub decided_s: f64,
}

/// What one replay came to.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// Rows of the recording.
    pub rows: usize,
    /// Share of them with a corrected vector, 0 to 1.
    pub answered: f64,
    /// Time of the first corrected vector after the first row, s.
    pub first_s: Option<f64>,
    /// The part that the figures below are formed from, s after the first row.
    pub counted_s: (f64, f64),
    /// Standard deviation of |h| over its mean, percent.
    pub spread_percent: Option<f64>,
    /// The same of the raw field.
    pub raw_spread_percent: Option<f64>,
    /// Heading error; none without a reference.
    pub heading: Option<HeadingError>,
    /// That of the carried field f, on the rows that have one.
    pub carried_heading: Option<HeadingError>,
    /// That of the published heading, by its own `up`; rows whose axis is within 60 degrees of the horizontal.
    pub published_heading: Option<HeadingError>,
    /// Heading error of the raw field.
    pub raw_heading: Option<HeadingError>,
    /// The heading against the legs of the way; none without waypoints.
    pub legs: Option<super::LegJudgement>,
    /// How well a disturbed field was called so.
    pub disturbance: Option<Disturbance>,
    /// What was declared, in the whole recording.
    pub events: Vec<Declared>,
    /// Rows by status.
    pub status: BTreeMap<&'static str, usize>,
    /// Mean time in `push`, nanoseconds.
    pub mean_push_ns: f64,
    /// Time in `push` that 99.9 % stay below, nanoseconds.
    pub p999_push_ns: u64,
    /// Longest time in `push`, nanoseconds: on a shared machine, mostly the scheduler's.
    pub max_push_ns: u64,
}

/// A row, a vector found for it, and the sigma of that vector's azimuth, degrees.
type Found = (Row, Vector3<f64>, Option<f64>);

/// The part of a recording of this length that counts when nothing else was asked for, s.
#[must_use]
pub fn usual_part(recording: &Recording) -> Range<f64> {
    WARM_UP_S.min(recording.duration_s() / 2.0)..f64::INFINITY
}

/// Judges a replay; figures are formed from the rows that lie in `part`, s after the first row. The one azimuth that is
/// taken out is that of the usual part, so that an error that lasts through a shorter part is one. `axis` is the one whose
/// heading was published.
#[must_use]
pub fn judge(recording: &Recording, steps: &[Step], part: Range<f64>, axis: ReferenceAxis) -> Judgement {
    let start_s = recording.rows.first().map_or(0.0, |row| row.time_s);
    let pairs = || recording.rows.iter().zip(steps);
    let mut status = BTreeMap::new();
    steps.iter().for_each(|step| *status.entry(step.reading.status.label()).or_insert(0) += 1);
    let mut times_ns: Vec<u64> = steps.iter().map(|step| step.push_ns).collect();
    times_ns.sort_unstable();
    let inside = |row: &Row| row.time_s - start_s > part.start && row.time_s - start_s <= part.end;
    let live = || pairs().filter(|(row, _)| inside(row));
    let from_s = usual_part(recording).start.min(part.start);
    let warm = || pairs().filter(|(row, _)| row.time_s - start_s > from_s);
    let ours: Vec<Found> = warm().filter_map(corrected).collect();
    let carried: Vec<Found> = warm().filter_map(carried).collect();
    let published: Vec<Found> = warm().filter_map(|pair| published(pair, axis)).collect();
    // raw and corrected are judged on the same rows
    let raw: Vec<Found> = ours.iter().map(|(row, ..)| (*row, row.field_ut, None)).collect();
    let mut answers = pairs().filter(|(_, step)| step.reading.field_ut.is_some());
    let first = answers.next();
    let answered = answers.count() + usize::from(first.is_some());
    Judgement {
        rows: steps.len(),
        answered: answered as f64 / steps.len().max(1) as f64,
        first_s: first.map(|(row, _)| row.time_s - start_s),
        counted_s: (part.start, part.end.min(recording.duration_s())),
        spread_percent: spread_percent(&ours, inside),
        raw_spread_percent: spread_percent(&raw, inside),
        heading: heading_error(&ours, inside),
        carried_heading: heading_error(&carried, inside),
        published_heading: heading_error(&published, inside),
        raw_heading: heading_error(&raw, inside),
        legs: None,
        disturbance: disturbance(live()),
        events: declared(recording, steps),
        status,
        mean_push_ns: times_ns.iter().sum::<u64>() as f64 / steps.len().max(1) as f64,
        p999_push_ns: times_ns.get(times_ns.len() * 999 / 1000).copied().unwrap_or(0),
        max_push_ns: times_ns.last().copied().unwrap_or(0),
    }
}

/// c, with its own sigma over its horizontal part.
fn corrected((row, step): (&Row, &Step)) -> Option<Found> {
    let c = step.reading.field_ut?;
    let across_ut = row.attitude.map(|attitude| attitude * c).map_or(f64::NAN, |earth| earth.x.hypot(earth.y));
    Some((*row, c, step.reading.field_sigma_ut.map(|sigma_ut| sigma_ut.atan2(across_ut).to_degrees())))
}

/// f, with the sigma of the heading, which it carries.
fn carried((row, step): (&Row, &Step)) -> Option<Found> {
    let sigma_deg = step.reading.heading.and_then(|heading| heading.heading_sigma_deg);
    Some((*row, step.reading.filtered_field_ut?, sigma_deg))
}

/// Where in the device the published heading has north: its error against that of the same axis by the reference.
fn published((row, step): (&Row, &Step), axis: ReferenceAxis) -> Option<Found> {
    let published = step.reading.heading?;
    let to_device = row.attitude?.inverse();
    let (north, up) = (to_device * Vector3::y(), to_device * Vector3::z());
    let level = match axis {
        ReferenceAxis::TopEdge => up.y.abs() < STEEP,
        ReferenceAxis::Camera => up.z.abs() < STEEP,
        ReferenceAxis::Auto => true,
    };
    let reference = heading(&north, &up, axis, ScreenRotation::Deg0).filter(|_| level)?;
    let off = (reference.heading_deg - published.heading_deg).to_radians();
    Some((*row, to_device * Vector3::new(off.sin(), off.cos(), 0.0), published.heading_sigma_deg))
}

fn declared(recording: &Recording, steps: &[Step]) -> Vec<Declared> {
    let start_ns = recording.rows.first().map_or(0, |row| row.time_ns);
    let seconds = |time_ns: i64| (time_ns - start_ns) as f64 / 1e9;
    let mut events: Vec<_> = steps.iter().filter_map(|step| step.reading.event).collect();
    events.dedup();
    let declared = |event: &magcomp::Event| Declared {
        kind: format!("{:?}", event.kind),
        since_s: seconds(event.since_ns),
        decided_s: seconds(event.decided_ns),
    };
    events.iter().map(declared).collect()
}

fn disturbance<'a>(rows: impl Iterator<Item = (&'a Row, &'a Step)>) -> Option<Disturbance> {
    let rows: Vec<(f64, bool)> = rows
        .filter_map(|(_, step)| Some((step.reading.field_ut?.norm(), step.reading.status)))
        .map(|(size_ut, status)| (size_ut, matches!(status, Status::Disturbed { .. })))
        .collect();
    let mut sizes: Vec<f64> = rows.iter().map(|(size_ut, _)| *size_ut).collect();
    sizes.sort_by(f64::total_cmp);
    let usual_ut = *sizes.get(sizes.len() / 2).filter(|_| sizes.len() >= FEWEST)?;
    let off = |size_ut: f64| (size_ut / usual_ut - 1.0).abs() > DISTURBED;
    let count = |of: &dyn Fn(&(f64, bool)) -> bool| rows.iter().filter(|row| of(row)).count() as f64;
    let (is, called) = (count(&|(size, _)| off(*size)), count(&|(_, called)| *called));
    let both = count(&|(size, called)| *called && off(*size));
    let share = |whole: f64| (whole > 0.0).then(|| both / whole);
    Some(Disturbance { share: is / rows.len() as f64, precision: share(called), recall: share(is) })
}

/// What the vectors of a method on a recording came to, without the first seconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Vectors {
    /// Share of the rows with a vector, 0 to 1.
    pub answered: f64,
    /// Standard deviation of the length over its mean, percent.
    pub spread_percent: Option<f64>,
    /// Heading error; none without a reference.
    pub heading: Option<HeadingError>,
}

/// Judges the vectors of a method, one for each row where it has one.
#[must_use]
pub fn judge_vectors(recording: &Recording, vectors: &[Option<Vector3<f64>>]) -> Vectors {
    let start_s = recording.rows.first().map_or(0.0, |row| row.time_s);
    let warm_up_s = WARM_UP_S.min(recording.duration_s() / 2.0);
    let answered = vectors.iter().flatten().count() as f64 / vectors.len().max(1) as f64;
    let live: Vec<Found> = (recording.rows.iter().zip(vectors))
        .filter_map(|(row, vector)| Some((*row, (*vector)?, None)))
        .filter(|(row, ..)| row.time_s - start_s > warm_up_s)
        .collect();
    Vectors { answered, spread_percent: spread_percent(&live, |_| true), heading: heading_error(&live, |_| true) }
}

/// Heading error rms over every `span_s`: (middle, s; degrees), where there are a reference and vectors.
#[must_use]
pub fn heading_course(recording: &Recording, vectors: &[Option<Vector3<f64>>], span_s: f64) -> Vec<(f64, f64)> {
    let azimuths = recording.rows.iter().zip(vectors).map(|(row, vector)| azimuth_deg(row, &(*vector)?));
    let errors = centred(azimuths.collect());
    let start_s = recording.rows.first().map_or(0.0, |row| row.time_s);
    let span = |row: &Row| ((row.time_s - start_s) / span_s) as usize;
    let mut sums = vec![(0.0, 0.0); recording.rows.last().map_or(0, |row| span(row) + 1)];
    for (row, error) in recording.rows.iter().zip(errors) {
        if let Some(error) = error {
            sums[span(row)].0 += error * error;
            sums[span(row)].1 += 1.0;
        }
    }
    let known = sums.iter().enumerate().filter(|(_, (_, count))| *count > 0.0);
    known.map(|(k, (sum, count))| ((k as f64 + 0.5) * span_s, (sum / count).sqrt())).collect()
}

fn spread_percent(rows: &[Found], inside: impl Fn(&Row) -> bool) -> Option<f64> {
    let rows = rows.iter().filter(|(row, ..)| inside(row));
    let strengths: Vec<f64> = rows.map(|(_, h, _)| h.norm()).filter(|strength| strength.is_finite()).collect();
    let count = strengths.len() as f64;
    let mean = strengths.iter().sum::<f64>() / count;
    let variance = strengths.iter().map(|strength| (strength - mean).powi(2)).sum::<f64>() / count;
    (strengths.len() >= FEWEST && mean > 0.0).then(|| 100.0 * variance.sqrt() / mean)
}

fn heading_error(rows: &[Found], inside: impl Fn(&Row) -> bool) -> Option<HeadingError> {
    let errors = centred(rows.iter().map(|(row, h, _)| azimuth_deg(row, h)).collect());
    let counted = errors.iter().zip(rows).filter(|(_, (row, ..))| inside(row));
    let counted: Vec<(f64, Option<f64>)> =
        counted.filter_map(|(error, (.., sigma))| Some((error.as_ref()?.abs(), *sigma))).collect();
    let sigmas: Vec<f64> =
        counted.iter().filter_map(|(error, sigma)| Some(error / (*sigma)?)).filter(|ratio| ratio.is_finite()).collect();
    let within = |limit: f64| sigmas.iter().filter(|sigma| **sigma <= limit).count() as f64 / sigmas.len() as f64;
    let mut sizes: Vec<f64> = counted.iter().map(|(error, _)| *error).collect();
    if sizes.len() < FEWEST {
        return None;
    }
    sizes.sort_by(f64::total_cmp);
    Some(HeadingError {
        rms_deg: (sizes.iter().map(|error| error * error).sum::<f64>() / sizes.len() as f64).sqrt(),
        p95_deg: sizes[(sizes.len() * 95 / 100).min(sizes.len() - 1)],
        within_sigma: (sigmas.len() >= FEWEST).then(|| [within(1.0), within(2.0)]),
    })
}

/// Azimuth of a device-frame vector by the reference orientation, degrees from north, clockwise.
pub(super) fn azimuth_deg(row: &Row, field_ut: &Vector3<f64>) -> Option<f64> {
    let earth = row.attitude? * field_ut;
    Some(earth.x.atan2(earth.y).to_degrees()).filter(|azimuth| azimuth.is_finite())
}

/// Azimuths less their circular median, -180 to 180.
pub(super) fn centred(azimuths: Vec<Option<f64>>) -> Vec<Option<f64>> {
    let median = |part: fn(f64) -> f64| {
        let mut values: Vec<f64> = azimuths.iter().flatten().map(|azimuth| part(azimuth.to_radians())).collect();
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or(0.0)
    };
    let centre = median(f64::sin).atan2(median(f64::cos)).to_degrees();
    azimuths.iter().map(|azimuth| azimuth.map(|a| (a - centre + 540.0).rem_euclid(360.0) - 180.0)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_constant_azimuth_is_no_error_and_wraps() {
        let errors = centred([179.0, -179.0, 178.0, -178.0, 180.0].map(Some).to_vec());
        assert!(errors.iter().flatten().all(|error| error.abs() <= 2.1), "{errors:?}");
        assert_eq!(centred(vec![None, Some(5.0)])[0], None);
    }
}
