//! Figures of the change itself: when the method notices it, how far the carried heading errs, how far b moves.

use crate::phone::{CHANGE_S, PLACE_S, PhoneChange};
use crate::replay::Step;
use crate::simulate::Simulation;
use crate::time::time_ns;
use magcomp::Status;
use magcomp::nalgebra::Vector3;
use serde::Serialize;

/// The aided method's reaction to the change.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ChangeResult {
    /// From the change to the first status that is not `Tracking`, s: median and worst; none where half of the runs never say so.
    pub noticed_s: [Option<f64>; 2],
    /// Largest direction error of f from the change on, in the field of the undisturbed place, degrees: median and worst.
    pub carried_worst_deg: [f64; 2],
    /// Furthest that b moved from where it was at the change, uT: median and worst. Only where b should not move.
    pub hard_iron_moved_ut: Option<[f64; 2]>,
    /// Share of the samples of a changed place called `Disturbed`: median and worst.
    pub called_disturbed: Option<[f64; 2]>,
}

/// One run.
#[derive(Clone, Copy, Debug)]
pub struct Noticed {
    after_s: f64,
    carried_worst_deg: f64,
    hard_iron_moved_ut: f64,
    called_disturbed: f64,
}

impl Noticed {
    /// Of a run in a place whose undisturbed field is `earth_ut`, east-north-up.
    pub fn of(stream: &Simulation, steps: &[Step], earth_ut: Vector3<f64>) -> Self {
        let at = |time_s: f64| stream.magnetic.partition_point(|sample| sample.time_ns < time_ns(time_s));
        let (change, over) = (at(CHANGE_S), at(CHANGE_S + PLACE_S));
        let hard_iron = |step: &Step| step.calibration.map(|found| *found.hard_iron_ut());
        let before = change.checked_sub(1).and_then(|k| hard_iron(&steps[k]));
        let mut worst =
            Self { after_s: f64::INFINITY, carried_worst_deg: 0.0, hard_iron_moved_ut: 0.0, called_disturbed: 0.0 };
        for (k, step) in steps.iter().enumerate().skip(change) {
            let status = step.reading.status;
            if worst.after_s.is_infinite() && matches!(status, Status::Suspect { .. } | Status::Disturbed { .. }) {
                worst.after_s = (stream.magnetic[k].time_ns - time_ns(CHANGE_S)) as f64 / 1e9;
            }
            let earth = stream.truth[k].attitude.inverse() * earth_ut;
            let error = step.reading.filtered_field_ut.map_or(180.0, |f| f.angle(&earth).to_degrees());
            worst.carried_worst_deg = worst.carried_worst_deg.max(error);
            let moved = hard_iron(step).zip(before).map_or(f64::INFINITY, |(now, before)| (now - before).norm());
            worst.hard_iron_moved_ut = worst.hard_iron_moved_ut.max(moved);
            let called = k < over && matches!(status, Status::Disturbed { .. });
            worst.called_disturbed += f64::from(u8::from(called)) / (over - change) as f64;
        }
        worst
    }
}

impl ChangeResult {
    /// Many runs in a line; none where nothing changes at once.
    pub fn of(change: PhoneChange, runs: &[Noticed]) -> Option<Self> {
        let sorted = |value: fn(&Noticed) -> f64| {
            let mut values: Vec<f64> = runs.iter().map(value).collect();
            values.sort_by(f64::total_cmp);
            values
        };
        let most = |value| {
            let values = sorted(value);
            Some([*values.get(values.len() / 2)?, *values.last()?])
        };
        let finite = |value: f64| Some(value).filter(|value| value.is_finite());
        let place = change == PhoneChange::Place;
        match change {
            PhoneChange::Nothing | PhoneChange::Drift => None,
            PhoneChange::Parameters | PhoneChange::Offset | PhoneChange::Place => Some(Self {
                noticed_s: most(|run| run.after_s)?.map(finite),
                carried_worst_deg: most(|run| run.carried_worst_deg)?,
                hard_iron_moved_ut: most(|run| run.hard_iron_moved_ut).filter(|_| place),
                called_disturbed: most(|run| -run.called_disturbed).filter(|_| place).map(|shares| shares.map(|v| -v)),
            }),
        }
    }
}
