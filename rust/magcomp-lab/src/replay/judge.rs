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

use super::changes::{Changes, DeviceChange, PlaceDiffered};
use super::circle::{Circle, FEWEST, HeadingError, off_deg};
use super::kinds::Kinds;
use super::legs::LegJudgement;
use super::level::Level;
use super::player::Step;
use super::sizes::Sizes;
use super::turns::{TurnJudgement, Turns};
use crate::place::EarthField;
use crate::recording::{Extent, Recording, Row};
use magcomp::nalgebra::Vector3;
use magcomp::{Event, ReferenceAxis, RejectReason, ScreenRotation, Status, heading};
use serde::Serialize;
use std::collections::BTreeMap;
use std::ops::Range;

/// Seconds at the start that do not count, but never more than half of a recording.
const WARM_UP_S: f64 = 20.0;
/// Resolution of total fields, uT: far below the noise of every sensor.
const FIELD_STEP_UT: f64 = 0.001;
/// Length of a span of the heading's course, s, and the most spans of one.
const SPAN_S: f64 = 1.0;
const MOST_SPANS: f64 = 2000.0;
/// Sine of the elevation of an axis whose heading is not judged any more, 60 degrees.
const STEEP: f64 = 0.866;
/// Deviation of the total field from the usual one that makes a row disturbed.
const DISTURBED: f64 = 0.15;

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
    /// The kind of the event.
    pub kind: String,
    /// When it began, s after the first row.
    pub since_s: f64,
    /// When it was decided, s after the first row.
    pub decided_s: f64,
}

/// Mean and standard deviation, in the unit that the field's name tells.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MeanSpread {
    /// Mean.
    pub mean: f64,
    /// Standard deviation.
    pub spread: f64,
}

/// The figures of one replay.
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
    /// Total field, uT.
    pub total_field_ut: Kinds<MeanSpread>,
    /// Dip, degrees below the horizon; none of the raw field, whose hard iron would hide it, and without a reference or an
    /// accelerometer.
    pub dip_deg: Kinds<MeanSpread>,
    /// The field that the world magnetic model gives for the place; none where no place was given.
    pub earth: Option<EarthField>,
    /// Swing of the field's azimuth over full turns by the gyroscope; none without one.
    pub full_turns: Option<TurnJudgement>,
    /// Heading error; none without a reference.
    pub heading: Option<HeadingError>,
    /// That of the carried field f, on the rows that have one.
    pub carried_heading: Option<HeadingError>,
    /// That of the published heading, by its own `up`; rows whose axis is within 60 degrees of the horizontal.
    pub published_heading: Option<HeadingError>,
    /// Heading error of the raw field.
    pub raw_heading: Option<HeadingError>,
    /// That of the field that the operating system calibrated, on the same rows; none where it was not recorded.
    pub system_heading: Option<HeadingError>,
    /// The heading against the legs of the way; none without waypoints.
    pub legs: Option<LegJudgement>,
    /// How well a disturbed field was called so.
    pub disturbance: Option<Disturbance>,
    /// Events that were declared in the whole recording.
    pub events: Vec<Declared>,
    /// Changes of the device in the whole recording.
    pub device_changes: Vec<DeviceChange>,
    /// Times in the whole recording in which the place's field was not the usual one.
    pub places: Vec<PlaceDiffered>,
    /// Samples that were rejected because a component was at the sensor's rail; 0 where no rail was given.
    pub samples_at_rail: usize,
    /// Rows by status.
    pub status: BTreeMap<&'static str, usize>,
    /// Mean time in `push`, nanoseconds.
    pub mean_push_ns: f64,
    /// Time in `push` that 99.9 % stay below, nanoseconds.
    pub p999_push_ns: u64,
    /// Longest time in `push`, nanoseconds: on a shared machine, mostly the scheduler's.
    pub max_push_ns: u64,
}

/// Mean and standard deviation of numbers that come one by one (Welford's recurrence).
#[derive(Clone, Copy, Debug, Default)]
struct Spread {
    count: usize,
    mean: f64,
    squares: f64,
}

impl Spread {
    fn add(&mut self, value: f64) {
        if value.is_finite() {
            self.count += 1;
            let off = value - self.mean;
            self.mean += off / self.count as f64;
            self.squares += off * (value - self.mean);
        }
    }

    /// Mean and standard deviation; none of fewer than 50.
    fn mean_spread(&self) -> Option<MeanSpread> {
        let spread = (self.squares / self.count as f64).sqrt();
        (self.count >= FEWEST).then_some(MeanSpread { mean: self.mean, spread })
    }

    /// Standard deviation over mean.
    fn percent(&self) -> Option<f64> {
        let deviation = (self.squares / self.count as f64).sqrt();
        (self.count >= FEWEST && self.mean > 0.0).then(|| 100.0 * deviation / self.mean)
    }
}

/// Vectors of one kind: the spread of their lengths, and the azimuths they have by the reference.
#[derive(Clone, Debug, Default)]
struct Directions {
    lengths: Spread,
    azimuths: Circle,
}

impl Directions {
    /// A vector with the sigma of its azimuth, degrees; `counted`: it is part of the figures, not of the one azimuth alone.
    fn add(&mut self, row: &Row, vector: &Vector3<f64>, sigma_deg: Option<f64>, counted: bool) {
        if counted {
            self.lengths.add(vector.norm());
        }
        if let Some(azimuth_deg) = azimuth_deg(row, vector) {
            self.azimuths.add(azimuth_deg, sigma_deg, counted);
        }
    }
}

/// The part of a recording of this length that counts when nothing else was asked for, s.
#[must_use]
pub fn usual_part(extent: &Extent) -> Range<f64> {
    WARM_UP_S.min(extent.duration_s() / 2.0)..f64::INFINITY
}

/// Judges a replay row by row, in memory that does not grow with it. Headings are right to 0.001 degrees, the usual total field
/// to 0.001 uT.
#[derive(Debug)]
pub struct Judge {
    extent: Extent,
    part: Range<f64>,
    from_s: f64,
    axis: ReferenceAxis,
    rows: usize,
    answered: usize,
    first_s: Option<f64>,
    ours: Directions,
    carried: Directions,
    published: Directions,
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
    #[must_use]
    pub fn new(extent: &Extent, part: Range<f64>, axis: ReferenceAxis) -> Self {
        Self {
            from_s: usual_part(extent).start.min(part.start),
            extent: *extent,
            part,
            axis,
            rows: 0,
            answered: 0,
            first_s: None,
            ours: Directions::default(),
            carried: Directions::default(),
            published: Directions::default(),
            raw: Directions::default(),
            system: Directions::default(),
            level: Level::default(),
            dips: Default::default(),
            turns: Turns::default(),
            changes: Changes::default(),
            declination_deg: None,
            samples_at_rail: 0,
            total_field: Sizes::new(FIELD_STEP_UT),
            called_disturbed: Sizes::new(FIELD_STEP_UT),
            events: Vec::new(),
            status: BTreeMap::new(),
            push_ns: Sizes::new(1.0),
            sum_push_ns: 0,
            max_push_ns: 0,
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
        let counted = after_s > self.part.start && after_s <= self.part.end;
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
        if after_s <= self.from_s {
            return;
        }
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
        if let Some((north, sigma_deg)) = published(row, step, self.axis) {
            self.published.add(row, &north, sigma_deg, counted);
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
    #[must_use]
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
            let declination_deg = self.declination_deg.unwrap_or(0.0);
            let error = directions.azimuths.heading_error()?;
            Some(HeadingError { constant_deg: off_deg(error.constant_deg + declination_deg, 0.0), ..error })
        };
        let [system_dip, dip] = self.dips.map(|dip| dip.mean_spread());
        let (device_changes, places) = self.changes.finish(self.extent.start_ns);
        Judgement {
            rows: self.rows,
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
            published_heading: self.published.azimuths.heading_error(),
            raw_heading: heading(&self.raw),
            system_heading: heading(&self.system),
            legs: None,
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
#[must_use]
pub fn judge(recording: &Recording, steps: &[Step], part: Range<f64>, axis: ReferenceAxis) -> Judgement {
    let mut judge = Judge::new(&recording.extent(), part, axis);
    recording.rows.iter().zip(steps).for_each(|(row, step)| judge.add(row, step));
    judge.finish()
}

/// Where in the device the published heading has north, by its error against that of the same axis by the reference; and its
/// sigma.
fn published(row: &Row, step: &Step, axis: ReferenceAxis) -> Option<(Vector3<f64>, Option<f64>)> {
    let published = step.reading.heading?;
    let to_device = row.attitude?.inverse();
    let (north, up) = (to_device * Vector3::y(), to_device * Vector3::z());
    let level = match axis {
        ReferenceAxis::TopEdge => up.y.abs() < STEEP,
        ReferenceAxis::Camera => up.z.abs() < STEEP,
        ReferenceAxis::Auto => true,
    };
    let reference = heading(&north, &up, axis, ScreenRotation::Deg0).filter(|_| level)?;
    let published_deg = published.true_heading_deg.unwrap_or(published.heading_deg);
    let off = (reference.heading_deg - published_deg).to_radians();
    Some((to_device * Vector3::new(off.sin(), off.cos(), 0.0), published.heading_sigma_deg))
}

/// The figures of a method's vectors on a recording, without the first seconds.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Vectors {
    /// Share of the rows with a vector, 0 to 1.
    pub answered: f64,
    /// Standard deviation of the length over its mean, percent.
    pub spread_percent: Option<f64>,
    /// Heading error; none without a reference.
    pub heading: Option<HeadingError>,
}

/// Judges the vectors of a method row by row, in memory that does not grow with them.
#[derive(Clone, Debug)]
pub struct VectorsJudge {
    extent: Extent,
    rows: usize,
    answered: usize,
    live: Directions,
    every: Circle,
    span_s: f64,
    /// For every span the first azimuth in it, degrees, and the differences of its others from that one.
    spans: Vec<Option<(f64, Spread)>>,
}

impl VectorsJudge {
    /// For a recording of this extent.
    #[must_use]
    pub fn new(extent: &Extent) -> Self {
        let span_s = (extent.duration_s() / MOST_SPANS).max(SPAN_S);
        let spans = vec![None; (extent.duration_s() / span_s) as usize + 1];
        let (live, every) = (Directions::default(), Circle::default());
        Self { extent: *extent, rows: 0, answered: 0, live, every, span_s, spans }
    }

    /// The next row, and the vector where the method has one.
    pub fn add(&mut self, row: &Row, vector: Option<&Vector3<f64>>) {
        self.rows += 1;
        let Some(vector) = vector else { return };
        self.answered += 1;
        let after_s = row.time_s - self.extent.start_s;
        if after_s > usual_part(&self.extent).start {
            self.live.add(row, vector, None, true);
        }
        if let Some(azimuth_deg) = azimuth_deg(row, vector) {
            self.every.add(azimuth_deg, None, true);
            if let Some(span) = self.spans.get_mut((after_s / self.span_s) as usize) {
                let (first_deg, others) = span.get_or_insert((azimuth_deg, Spread::default()));
                others.add(off_deg(azimuth_deg, *first_deg));
            }
        }
    }

    /// The figures.
    #[must_use]
    pub fn vectors(&self) -> Vectors {
        Vectors {
            answered: self.answered as f64 / self.rows.max(1) as f64,
            spread_percent: self.live.lengths.percent(),
            heading: self.live.azimuths.heading_error(),
        }
    }

    /// Heading error rms over every second, longer where there would be more than 2000 of them: (middle, s; degrees), where there
    /// are a reference and vectors. For a picture: azimuths of one second that lie on both sides of the centre's opposite are
    /// taken for neighbours.
    #[must_use]
    pub fn heading_course(&self) -> Vec<(f64, f64)> {
        let centre_deg = self.every.centre_deg();
        let known = self.spans.iter().enumerate().filter_map(|(k, span)| Some((k, (*span)?)));
        let point = |(k, (first_deg, others)): (usize, (f64, Spread))| {
            let mean_deg = off_deg(first_deg + others.mean, centre_deg);
            let variance = others.squares / others.count as f64;
            ((k as f64 + 0.5) * self.span_s, mean_deg.hypot(variance.sqrt()))
        };
        known.map(point).collect()
    }
}

/// Azimuth of a device-frame vector by the reference orientation, degrees from north, clockwise.
pub(super) fn azimuth_deg(row: &Row, field_ut: &Vector3<f64>) -> Option<f64> {
    let earth = row.attitude? * field_ut;
    Some(earth.x.atan2(earth.y).to_degrees()).filter(|azimuth| azimuth.is_finite())
}
