//! How good a replay was, as far as a recording can tell: total field and dip by their means and spreads, the heading where there is
//! a reference orientation, and over full turns by the gyroscope ([`super::turns`]).
//!
//! Spreads are standard deviations in uT and degrees. A share of the mean would flatter the raw field, whose mean is mostly the hard
//! iron. Dip: the angle of the field below the horizon; the horizon is the reference's, else that of gyroscope and gravity
//! ([`super::level`]). The raw field's is not told: its hard iron, the same in every pose of a walk, hides the Earth's.
//!
//! Heading error: the corrected vector, turned to east-north-up by the reference, should point along one and the same
//! azimuth throughout. That azimuth (the place's declination against the reference's north) is taken out as the
//! circular median, and told. The first seconds, in which any method still collects, do not count.
//!
//! Honesty: the share of heading errors within one and two of the sigmas that were given with them. Disturbance: the
//! field of the place was not the usual one where | |c| / median |c| - 1 | > 15 %; precision is the share of the rows
//! called disturbed that were, recall the share of those that were which were called so. c can only tell this where the
//! calibration is right.

use super::absolute::Absolute;
use super::changes::{Changes, Declared};
use super::circle::{Circle, off_deg};
use super::directions::{Directions, Kinds};
use super::judgement::{Disturbance, Judgement};
use super::known::Known;
use super::level::Level;
use super::turns::Turns;
use crate::play::Step;
use crate::statistics::{FEWEST, Sizes, Spread};
use magcomp::nalgebra::Vector3;
use magcomp::{Event, Reading, ReferenceAxis, RejectReason, Status};
use magcomp_recordings::recording::{Extent, Recording, Row};
use std::collections::BTreeMap;
use std::ops::Range;

/// Seconds at the start that do not count, but never more than half of a recording.
const WARM_UP_S: f64 = 20.0;
/// Deviation of the total field from the usual one that makes a row disturbed.
const DISTURBED: f64 = 0.15;

/// The part of a recording of this length that counts when nothing else was asked for, s.
pub fn usual_part(extent: &Extent) -> Range<f64> {
    WARM_UP_S.min(extent.duration_s() / 2.0)..f64::INFINITY
}

/// Judges a replay row by row, in memory that does not grow with it. Headings are right to 0.001 degrees, the usual total field
/// to 0.001 uT.
#[derive(Debug, Default)]
pub struct Judge {
    extent: Extent,
    part: Range<f64>,
    from_s: f64,
    rows: usize,
    answered: usize,
    first_s: Option<f64>,
    ours: Directions,
    carried: Directions,
    published: Circle,
    known: Known,
    absolute: Absolute,
    raw: Directions,
    system: Directions,
    level: Level,
    /// Of the system's, compensated.
    dips: [Spread; 2],
    turns: Turns,
    changes: Changes,
    declination_deg: Option<f64>,
    samples_at_rail: usize,
    total_field: Sizes,
    /// The total field of the rows called disturbed.
    called_disturbed: Sizes,
    events: Vec<Event>,
    status: BTreeMap<&'static str, usize>,
    push_ns: Sizes,
    sum_push_ns: u64,
    max_push_ns: u64,
}

impl Judge {
    /// Figures are formed from the rows that lie in `part`, s after the first row. The one azimuth that is taken out is that of
    /// the usual part, so that an error that lasts through a shorter part is one. `axis` is the one whose heading was published.
    pub fn new(extent: &Extent, part: Range<f64>, axis: ReferenceAxis) -> Self {
        Self {
            from_s: usual_part(extent).start.min(part.start),
            extent: *extent,
            part,
            absolute: Absolute::new(axis),
            known: Known::new(axis),
            push_ns: Sizes::new(1.0),
            ..Self::default()
        }
    }

    /// The next row and the compensator's step for it.
    pub fn add(&mut self, row: &Row, step: &Step) {
        let Step { reading, push_ns, .. } = step;
        let after_s = row.time_s - self.extent.start_s;
        self.rows += 1;
        *self.status.entry(reading.status.label()).or_insert(0) += 1;
        self.push_ns.add(*push_ns as f64);
        self.sum_push_ns += push_ns;
        self.max_push_ns = self.max_push_ns.max(*push_ns);
        if reading.field_ut.is_some() {
            self.answered += 1;
            self.first_s.get_or_insert(after_s);
        }
        let event = reading.event.filter(|event| self.events.last() != Some(event));
        self.events.extend(event);
        self.changes.add(row.time_ns, step, event.as_ref());
        if let Some(heading) = reading.heading {
            self.declination_deg = heading.true_heading_deg.map(|true_deg| off_deg(true_deg, heading.heading_deg));
        }
        if matches!(reading.status, Status::Rejected(RejectReason::Saturated { .. })) {
            self.samples_at_rail += 1;
        }
        self.level.add(row);
        self.known.see(row, &self.level, reading.status);
        let counted = after_s > self.part.start && after_s <= self.part.end;
        if counted {
            self.known.add(reading);
        }
        if let Some(c) = reading.field_ut.filter(|_| counted) {
            self.total_field.add(c.norm());
            if matches!(reading.status, Status::Disturbed { .. }) {
                self.called_disturbed.add(c.norm());
            }
        }
        let fields = reading.field_ut.filter(|_| counted).map(|c| [Some(row.field_ut), row.system_ut, Some(c)]);
        if let Some(level) = self.level.attitude() {
            self.turns.add(after_s, &level, fields);
        }
        if let Some(fields) = fields {
            self.add_dips(row, [fields[1], fields[2]]);
        }
        let is_judged = after_s > self.from_s;
        let error_deg = self.absolute.add(row, step, after_s, counted);
        if let Some(error_deg) = error_deg.filter(|_| is_judged) {
            // where north seems to lie by this heading
            let sigma_deg = reading.heading.and_then(|heading| heading.heading_sigma_deg);
            self.published.add(-error_deg, sigma_deg, counted);
        }
        if is_judged {
            self.add_vectors(row, reading, counted);
        }
    }

    /// Where the fields of a row point.
    fn add_vectors(&mut self, row: &Row, reading: &Reading, counted: bool) {
        if let Some(c) = reading.field_ut {
            // c, with its own sigma over its horizontal part; raw on the same rows
            let across_ut = row.attitude.map(|attitude| attitude * c).map_or(f64::NAN, |earth| earth.x.hypot(earth.y));
            let sigma_deg = reading.field_sigma_ut.map(|sigma_ut| sigma_ut.atan2(across_ut).to_degrees());
            self.ours.add(row, &c, sigma_deg, counted);
            self.raw.add(row, &row.field_ut, None, counted);
            row.system_ut.iter().for_each(|system| self.system.add(row, system, None, counted));
        }
        if let Some(f) = reading.filtered_field_ut {
            // f, with the sigma of the heading, which it carries
            self.carried.add(row, &f, reading.heading.and_then(|heading| heading.heading_sigma_deg), counted);
        }
    }

    /// The dips of the system's field and of the corrected one.
    fn add_dips(&mut self, row: &Row, fields: [Option<Vector3<f64>>; 2]) {
        let up = match self.extent.first_reference {
            Some(_) => row.attitude.map(|attitude| attitude.inverse() * Vector3::z()),
            None => self.level.up(),
        };
        let Some(up) = up else { return };
        for (dip, field) in self.dips.iter_mut().zip(fields) {
            let level = |field: Vector3<f64>| field.dot(&up) / (field.norm() * up.norm());
            field.iter().for_each(|field| dip.add(-level(*field).clamp(-1.0, 1.0).asin().to_degrees()));
        }
    }

    /// The figures.
    pub fn finish(self) -> Judgement {
        let rows = self.rows.max(1) as f64;
        let seconds = |time_ns: i64| (time_ns - self.extent.start_ns) as f64 / 1e9;
        let declared = |event: &Event| Declared {
            kind: format!("{:?}", event.kind),
            since_s: seconds(event.since_ns),
            decided_s: seconds(event.decided_ns),
        };
        // the published heading is a true one where a declination was given; so are the others then
        let heading = |directions: &Directions| {
            let north_deg = self.declination_deg.unwrap_or(0.0);
            directions.azimuths.heading_error(north_deg)
        };
        let [system_dip, dip] = self.dips.map(|dip| dip.mean_spread());
        let (device_changes, places) = self.changes.finish(self.extent.start_ns);
        Judgement {
            rows: self.rows,
            duration_s: self.extent.duration_s(),
            answered: self.answered as f64 / rows,
            first_s: self.first_s,
            counted_s: (self.part.start, self.part.end.min(self.extent.duration_s())),
            total_field_ut: Kinds {
                raw: self.raw.lengths.mean_spread(),
                system: self.system.lengths.mean_spread(),
                compensated: self.ours.lengths.mean_spread(),
            },
            dip_deg: Kinds { raw: None, system: system_dip, compensated: dip },
            earth: None,
            full_turns: self.turns.finish(),
            heading: heading(&self.ours),
            carried_heading: heading(&self.carried),
            published_heading: self.published.heading_error(0.0),
            courses_used: 0,
            known: self.known.finish(self.extent.duration_s(), self.answered > 0),
            absolute_heading: self.absolute.finish(),
            raw_heading: heading(&self.raw),
            system_heading: heading(&self.system),
            legs: None,
            marks: Vec::new(),
            bearings: Vec::new(),
            disturbance: self.disturbance(),
            events: self.events.iter().map(declared).collect(),
            device_changes,
            places,
            samples_at_rail: self.samples_at_rail,
            mean_push_ns: self.sum_push_ns as f64 / rows,
            p999_push_ns: self.push_ns.at(999).unwrap_or(0.0) as u64,
            max_push_ns: self.max_push_ns,
            status: self.status,
        }
    }

    fn disturbance(&self) -> Option<Disturbance> {
        let usual_ut = self.total_field.at(500).filter(|_| self.total_field.count() >= FEWEST)?;
        let off = |sizes: &Sizes| {
            let usual = sizes.between(usual_ut * (1.0 - DISTURBED), usual_ut * (1.0 + DISTURBED));
            (sizes.count() - usual) as f64
        };
        let (is, called, both) =
            (off(&self.total_field), self.called_disturbed.count() as f64, off(&self.called_disturbed));
        let share = |whole: f64| (whole > 0.0).then(|| both / whole);
        let rows = self.total_field.count() as f64;
        Some(Disturbance { share: is / rows, precision: share(called), recall: share(is) })
    }
}

/// Judges a replay in memory, as a [`Judge`].
pub fn judge(recording: &Recording, steps: &[Step], part: Range<f64>, axis: ReferenceAxis) -> Judgement {
    let mut judge = Judge::new(&recording.extent(), part, axis);
    recording.rows.iter().zip(steps).for_each(|(row, step)| judge.add(row, step));
    judge.finish()
}
