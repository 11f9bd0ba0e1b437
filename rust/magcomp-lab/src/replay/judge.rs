//! How good a replay was, as far as a recording can tell: the spread of the total field, and the heading where there is
//! a reference orientation.
//!
//! Heading error: the corrected vector, turned to east-north-up by the reference, should point along one and the same
//! azimuth throughout. That azimuth (the place's declination against the reference's north) is taken out as the
//! circular median. The first seconds, in which any method still collects, do not count.

use super::Step;
use crate::recording::{Recording, Row};
use magcomp::nalgebra::Vector3;
use serde::Serialize;
use std::collections::BTreeMap;

/// Seconds at the start that do not count, but never more than half of a recording.
const WARM_UP_S: f64 = 20.0;
/// Fewest rows a figure is formed from.
const FEWEST: usize = 50;

/// Error of the heading against the reference, up to one constant, degrees.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct HeadingError {
    /// Root mean square.
    pub rms_deg: f64,
    /// 95th percentile of its size.
    pub p95_deg: f64,
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
    /// Seconds at the start that the figures below leave out.
    pub warm_up_s: f64,
    /// Standard deviation of |h| over its mean, percent.
    pub spread_percent: Option<f64>,
    /// The same of the raw field.
    pub raw_spread_percent: Option<f64>,
    /// Heading error; none without a reference.
    pub heading: Option<HeadingError>,
    /// That of the carried field f, on the rows that have one.
    pub carried_heading: Option<HeadingError>,
    /// Heading error of the raw field.
    pub raw_heading: Option<HeadingError>,
    /// Rows by status.
    pub status: BTreeMap<&'static str, usize>,
    /// Mean time in `push`, nanoseconds.
    pub mean_push_ns: f64,
    /// Time in `push` that 99 % stay below, nanoseconds.
    pub p99_push_ns: u64,
    /// Longest time in `push`, nanoseconds: on a shared machine, mostly the scheduler's.
    pub max_push_ns: u64,
}

/// Judges a replay.
#[must_use]
pub fn judge(recording: &Recording, steps: &[Step]) -> Judgement {
    let start_s = recording.rows.first().map_or(0.0, |row| row.time_s);
    let corrected = |(row, step): (&Row, &Step)| Some((*row, step.reading.field_ut?));
    let pairs = || recording.rows.iter().zip(steps);
    let answered: Vec<_> = pairs().filter_map(corrected).collect();
    let mut status = BTreeMap::new();
    steps.iter().for_each(|step| *status.entry(step.reading.status.label()).or_insert(0) += 1);
    let mut times_ns: Vec<u64> = steps.iter().map(|step| step.push_ns).collect();
    times_ns.sort_unstable();
    // raw and corrected are judged on the same rows
    let warm_up_s = WARM_UP_S.min(recording.duration_s() / 2.0);
    let live = |(row, _): &&(Row, Vector3<f64>)| row.time_s - start_s > warm_up_s;
    let ours: Vec<_> = answered.iter().filter(live).copied().collect();
    let carried = |(row, step): (&Row, &Step)| Some((*row, step.reading.filtered_field_ut?));
    let carried: Vec<_> = pairs().filter_map(carried).collect();
    let carried: Vec<_> = carried.iter().filter(live).copied().collect();
    let raw: Vec<_> = ours.iter().map(|(row, _)| (*row, row.field_ut)).collect();
    Judgement {
        rows: steps.len(),
        answered: answered.len() as f64 / steps.len().max(1) as f64,
        first_s: answered.first().map(|(row, _)| row.time_s - start_s),
        warm_up_s,
        spread_percent: spread_percent(&ours),
        raw_spread_percent: spread_percent(&raw),
        heading: heading_error(&ours),
        carried_heading: heading_error(&carried),
        raw_heading: heading_error(&raw),
        status,
        mean_push_ns: times_ns.iter().sum::<u64>() as f64 / steps.len().max(1) as f64,
        p99_push_ns: times_ns.get(times_ns.len() * 99 / 100).copied().unwrap_or(0),
        max_push_ns: times_ns.last().copied().unwrap_or(0),
    }
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
    let live: Vec<_> = (recording.rows.iter().zip(vectors))
        .filter_map(|(row, vector)| Some((*row, (*vector)?)))
        .filter(|(row, _)| row.time_s - start_s > warm_up_s)
        .collect();
    Vectors { answered, spread_percent: spread_percent(&live), heading: heading_error(&live) }
}

fn spread_percent(rows: &[(Row, Vector3<f64>)]) -> Option<f64> {
    let strengths: Vec<f64> = rows.iter().map(|(_, h)| h.norm()).filter(|strength| strength.is_finite()).collect();
    let count = strengths.len() as f64;
    let mean = strengths.iter().sum::<f64>() / count;
    let variance = strengths.iter().map(|strength| (strength - mean).powi(2)).sum::<f64>() / count;
    (strengths.len() >= FEWEST && mean > 0.0).then(|| 100.0 * variance.sqrt() / mean)
}

fn heading_error(rows: &[(Row, Vector3<f64>)]) -> Option<HeadingError> {
    let errors: Vec<f64> =
        centred(rows.iter().map(|(row, h)| azimuth_deg(row, h)).collect()).into_iter().flatten().collect();
    if errors.len() < FEWEST {
        return None;
    }
    let mut sizes: Vec<f64> = errors.iter().map(|error| error.abs()).collect();
    sizes.sort_by(f64::total_cmp);
    let rms_deg = (errors.iter().map(|error| error * error).sum::<f64>() / errors.len() as f64).sqrt();
    Some(HeadingError { rms_deg, p95_deg: sizes[(sizes.len() * 95 / 100).min(sizes.len() - 1)] })
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
