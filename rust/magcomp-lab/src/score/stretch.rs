//! The time from a change, or the start, to the next change or the end.

use super::errors::{Mode, Sample};
use crate::simulate::{Change, ChangeKind};
use magcomp::Event;
use magcomp_replay::statistics::rms;
use serde::Serialize;

/// Shorter stretches are not judged, s.
const LEAST_S: f64 = 8.0;
/// The end of a stretch, s, and the error at which it is lost, degrees.
const END_S: f64 = 5.0;
const LOST_DEG: f64 = 5.0;
/// Settled: below these limits, degrees. The error of no answer, degrees.
const LIMITS_DEG: [f64; 2] = [5.0, 2.0];
const NO_ANSWER_DEG: f64 = 180.0;
/// b is compared so long after a change, s.
const COMPARED_S: f64 = 3.0;

/// A change explains a step from so long before it until so long after it, s.
const EXPLAINS_S: (f64, f64) = (5.0, 12.0);

/// What a stretch begins with.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
pub enum Begin {
    /// The start of the stream.
    Start,
    /// The device changes.
    Device,
    /// The device changes while no sensor sees it.
    Unseen,
    /// A vehicle closes around it.
    Vehicle,
}

/// Seconds until an error is below 5, and below 2 degrees for good; none when never.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Settled {
    /// Of the heading; none where the device is steep all the time.
    pub heading_s: Option<[Option<f64>; 2]>,
    /// Of f, or of the calibration where no f is ever given.
    pub main_s: [Option<f64>; 2],
    /// Of the calibration.
    pub calibration_s: [Option<f64>; 2],
}

/// One stretch.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Stretch {
    /// What it begins with.
    pub begin: Begin,
    /// When, s.
    pub begins_s: f64,
    /// Its length, s.
    pub long_s: f64,
    /// Change of b, uT.
    pub size_ut: f64,
    /// From its begin until a step that it explains is declared, s.
    pub declared_s: Option<f64>,
    /// From its begin until the status says suspect or disturbed, s.
    pub alarm_s: Option<f64>,
    /// Largest error of f, or of the calibration, degrees.
    pub worst_deg: Option<f64>,
    /// |b - true b| 3 s after its begin, uT.
    pub hard_iron_ut: Option<f64>,
    /// Settled; none where it is too short.
    pub settled: Option<Settled>,
    /// It ended wrong; false where it is too short.
    pub is_lost: bool,
}

/// The stretches of a run.
pub(super) fn all(
    samples: &[Sample],
    changes: &[Change],
    device_steps: &[Event],
    rate_hz: f64,
    is_carried: bool,
) -> Vec<Stretch> {
    let end_s = samples.last().map_or(0.0, |sample| sample.time_s + 1e-3);
    let start = Change { begins_s: 0.0, ends_s: 0.0, size_ut: 0.0, kind: ChangeKind::Device };
    let begins = || std::iter::once(&start).chain(changes);
    let ends = changes.iter().map(|change| change.begins_s).chain([end_s]);
    let of = |(k, (change, to_s)): (usize, (&Change, f64))| {
        let begin = match (k, change.kind) {
            (0, _) => Begin::Start,
            (_, ChangeKind::Device) => Begin::Device,
            (_, ChangeKind::Unseen) => Begin::Unseen,
            (_, ChangeKind::Vehicle) => Begin::Vehicle,
        };
        let declared = device_steps
            .iter()
            .filter(|event| explains((change.begins_s, change.ends_s), event) && (event.since_ns as f64) < to_s * 1e9);
        let declared_s = declared.map(|event| event.decided_ns as f64 / 1e9 - change.begins_s).reduce(f64::min);
        let from = samples.partition_point(|sample| sample.time_s < change.begins_s);
        let to = samples.partition_point(|sample| sample.time_s < to_s);
        let own = &samples[from..to];
        Stretch::of(begin, change, to_s, declared_s, own, rate_hz, is_carried)
    };
    begins().zip(ends).enumerate().map(of).collect()
}

impl Stretch {
    fn of(
        begin: Begin,
        change: &Change,
        to_s: f64,
        declared_s: Option<f64>,
        own: &[Sample],
        rate_hz: f64,
        is_carried: bool,
    ) -> Self {
        let begins_s = change.begins_s;
        let long_s = to_s - begins_s;
        let since = |sample: &Sample| sample.time_s - begins_s;
        let settled = |error: &dyn Fn(&Sample) -> Option<f64>, is_judged: &dyn Fn(&Sample) -> bool| {
            let of = |sample: &&Sample| (since(sample), error(sample).unwrap_or(NO_ANSWER_DEG).abs());
            let errors: Vec<(f64, f64)> = own.iter().filter(|sample| is_judged(sample)).map(|one| of(&one)).collect();
            (errors.len() >= rate_hz as usize)
                .then(|| LIMITS_DEG.map(|limit| settled(&errors, rate_hz as usize, limit)))
        };
        let everywhere = |_: &Sample| true;
        let main = |sample: &Sample| sample.main(is_carried);
        let end = own.iter().filter(|sample| sample.time_s > to_s - END_S);
        Self {
            begin,
            begins_s,
            long_s,
            size_ut: change.size_ut,
            declared_s,
            alarm_s: own.iter().find(|sample| sample.mode == Mode::Alarm).map(since),
            worst_deg: own.iter().filter_map(main).reduce(f64::max),
            hard_iron_ut: own.iter().find(|sample| since(sample) >= COMPARED_S).and_then(|sample| sample.hard_iron_ut),
            settled: (long_s >= LEAST_S).then(|| Settled {
                heading_s: settled(&|sample| sample.heading_deg, &|sample| sample.is_level),
                main_s: settled(&main, &everywhere).unwrap_or_default(),
                calibration_s: settled(&|sample| sample.calibration_deg, &everywhere).unwrap_or_default(),
            }),
            is_lost: long_s >= LEAST_S && rms(end.filter_map(main)).is_none_or(|rms| rms > LOST_DEG),
        }
    }
}

/// From which time on at most one in twenty of the trailing errors reaches `limit`; none when not even at the end. Pairs of time and error.
pub(crate) fn settled(errors: &[(f64, f64)], trailing: usize, limit: f64) -> Option<f64> {
    let (mut bad, mut since) = (0_usize, None);
    for (k, (time_s, error)) in errors.iter().enumerate() {
        bad += usize::from(*error >= limit);
        if k + 1 < trailing {
            continue;
        }
        if 20 * bad <= trailing {
            since = since.or(Some(*time_s));
        } else {
            since = None;
        }
        bad -= usize::from(errors[k + 1 - trailing].1 >= limit);
    }
    since
}

/// Whether a step's onset is near enough to a change, and its decision not before it.
pub(super) fn explains(change_s: (f64, f64), event: &Event) -> bool {
    is_explained(change_s, event.since_ns as f64 / 1e9, event.decided_ns as f64 / 1e9)
}

/// The same of a step that began at `since_s` and was decided at `decided_s`.
pub(crate) fn is_explained(change_s: (f64, f64), since_s: f64, decided_s: f64) -> bool {
    let near = change_s.0 - EXPLAINS_S.0..=change_s.1 + EXPLAINS_S.1;
    near.contains(&since_s) && decided_s >= change_s.0
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settled_is_for_good() {
        let errors = |values: &[f64]| values.iter().enumerate().map(|(k, v)| (k as f64, *v)).collect::<Vec<_>>();
        let mut values = vec![9.0; 50];
        values.extend([1.0; 400]);
        // the last window with six bad samples ends at sample 44 + 99
        assert_eq!(settled(&errors(&values), 100, 5.0), Some(144.0));
        values[300..310].fill(9.0);
        assert_eq!(settled(&errors(&values), 100, 5.0), Some(404.0));
        assert_eq!(settled(&errors(&values), 100, 0.5), None);
        assert_eq!(settled(&errors(&[1.0; 200]), 100, 5.0), Some(99.0));
        assert_eq!(settled(&errors(&[1.0; 50]), 100, 5.0), None);
    }
}
