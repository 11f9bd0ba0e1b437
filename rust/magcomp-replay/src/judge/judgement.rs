//! The figures of one replay.

use super::absolute::AbsoluteHeading;
use super::changes::{Declared, DeviceChange, PlaceDiffered};
use super::circle::HeadingError;
use super::directions::Kinds;
use super::known::KnownHeading;
use super::legs::LegJudgement;
use super::told::{BearingTold, MarkTold};
use super::turns::TurnJudgement;
use crate::statistics::MeanSpread;
use magcomp_recordings::place::EarthField;
use serde::Serialize;
use std::collections::BTreeMap;

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

/// The figures of one replay.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Judgement {
    /// Rows of the recording.
    pub rows: usize,
    /// Time from the first row to the last, s.
    pub duration_s: f64,
    /// Share of the rows with a corrected vector, 0 to 1.
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
    /// How well it is known by its own sigma.
    pub known: KnownHeading,
    /// Headings from outside that were used.
    pub courses_used: usize,
    /// The published heading against the reference's own north, on the same rows.
    pub absolute_heading: AbsoluteHeading,
    /// Heading error of the raw field.
    pub raw_heading: Option<HeadingError>,
    /// That of the field that the operating system calibrated, on the same rows; none where it was not recorded.
    pub system_heading: Option<HeadingError>,
    /// The heading against the legs of the way; none without waypoints.
    pub legs: Option<LegJudgement>,
    /// What a tester noted, beside the events.
    pub marks: Vec<MarkTold>,
    /// Bearings that a tester noted, beside the published heading.
    pub bearings: Vec<BearingTold>,
    /// How well a disturbed field was called so.
    pub disturbance: Option<Disturbance>,
    /// Events that were declared in the whole recording.
    pub events: Vec<Declared>,
    /// Changes of the device in the whole recording.
    pub device_changes: Vec<DeviceChange>,
    /// Times in the whole recording in which the place's field was not the usual one.
    pub places: Vec<PlaceDiffered>,
    /// Samples that were rejected because a component was at the sensor's rail, as given or found.
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
