//! A logger's session: each sensor's events with their own times, as its files tell them.

use super::document::Document;
use super::fix::LEAST_M_S;
use super::order::{sessions, tell};
use super::stream::Stream;
use super::units::{Frames, Kind, LeftOver, Shifts};
use crate::conventions::{self, Conventions, Streams};
use crate::error::RecordingError;
use crate::place::{Day, GeoPoint};
use crate::recording::{Course, Events};
use crate::time::MOST_NS;
use magcomp::nalgebra::{UnitQuaternion, Vector3};
use serde::Serialize;
use std::fmt::Display;
use std::ops::Range;
use std::path::{Path, PathBuf};

/// Sessions that a message tells, at most.
const MOST_TOLD: usize = 5;

/// All sensors of a session, in the device's axes, uT, rad/s, m/s^2 with Android's sign.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Session {
    pub raw: Stream<Vector3<f64>>,
    pub up: Stream<Vector3<f64>>,
    pub rate: Stream<Vector3<f64>>,
    pub system: Stream<Vector3<f64>>,
    pub attitude: Stream<UnitQuaternion<f64>>,
    /// Courses of fixes, from true north.
    pub course: Stream<Course>,
    /// How many fixes have none.
    pub without_course: usize,
    /// Notes for the user.
    pub notes: Vec<String>,
    /// Parts that were left out, or may be wrong.
    pub warnings: Vec<String>,
    /// When it began, ns since 1970, where the events' own times do not say so.
    pub start_unix_ns: Option<i64>,
    /// Where it was recorded.
    pub position: Option<GeoPoint>,
    /// The unit of the times is known and not taken for granted.
    pub is_time_told: bool,
    /// Sensors of a recording's own form whose columns have other names.
    pub left_over: Option<Vec<LeftOver>>,
}

/// The number, rate and longest pause of one sensor's events.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Sensor {
    /// Its name.
    pub sensor: &'static str,
    /// Its events.
    pub events: usize,
    /// Its median rate, Hz; none of fewer than two events.
    pub rate_hz: Option<f64>,
    /// Its longest pause, s.
    pub longest_pause_s: Option<f64>,
}

/// The content of a session.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The logger, or plain CSV.
    pub logger: &'static str,
    /// Its sensors.
    pub sensors: Vec<Sensor>,
    /// Notes for the user.
    pub notes: Vec<String>,
    /// Parts that were left out, or may be wrong.
    pub warnings: Vec<String>,
    /// Whether units, signs, axes and clocks are what they are taken for.
    pub conventions: Conventions,
    /// The day of the first event (UTC), where the session says so.
    #[serde(skip)]
    pub day: Option<Day>,
    /// Where it was recorded, where the session says so.
    #[serde(skip)]
    pub position: Option<GeoPoint>,
}

impl Session {
    pub fn stream(&mut self, kind: Kind) -> &mut Stream<Vector3<f64>> {
        match kind {
            Kind::Field => &mut self.raw,
            Kind::Up => &mut self.up,
            Kind::Rate => &mut self.rate,
            Kind::System => &mut self.system,
        }
    }

    /// The events of the first of these files that has some, and which file that is. Files that cannot be read are left out
    /// with a warning: the sensor is one that a session can do without.
    pub fn optional(
        &mut self,
        sensor: &str,
        documents: &[Option<&Document>],
        read: impl Fn(&Document) -> Result<Stream<Vector3<f64>>, RecordingError>,
    ) -> Option<(usize, Stream<Vector3<f64>>)> {
        for (k, document) in documents.iter().enumerate() {
            let Some(document) = document else { continue };
            match read(document) {
                Ok(stream) if !stream.events.is_empty() => return Some((k, stream)),
                Ok(_) => self.leave_out(sensor, format!("{}: it has no rows", document.path.display())),
                Err(why) => self.leave_out(sensor, why),
            }
        }
        None
    }

    /// Tells that a file of this sensor was left out: a warning, but of what no heading needs.
    pub fn leave_out(&mut self, sensor: &str, why: impl Display) {
        let is_needed = ![Kind::System.word(), "location"].contains(&sensor);
        let told = if is_needed { &mut self.warnings } else { &mut self.notes };
        told.push(format!("a file was left out ({sensor}): {why}"));
    }

    /// Tells the sensors of a file whose columns were not taken: a sensor that the session lacks was lost, of another one it is worth knowing.
    pub fn tell_left_over(&mut self, path: &Path, sensors: &[LeftOver]) {
        for (kind, column, count) in sensors {
            let (path, word) = (path.display(), kind.word());
            let text =
                format!("{path}: {count} columns look like a sensor's ({word}) and were not taken, '{column}' first");
            if self.stream(*kind).events.is_empty() {
                self.warnings.push(format!("{text}; name them by --columns"));
            } else {
                self.notes.push(text);
            }
        }
    }

    /// Takes the sensors of another file, which are others than those that are there.
    pub fn take(&mut self, part: Self) {
        let pairs = [
            (&mut self.raw, part.raw),
            (&mut self.up, part.up),
            (&mut self.rate, part.rate),
            (&mut self.system, part.system),
        ];
        pairs.into_iter().filter(|(_, more)| !more.events.is_empty()).for_each(|(stream, more)| *stream = more);
        self.attitude.events.extend(part.attitude.events);
        self.course.events.extend(part.course.events);
        self.without_course += part.without_course;
        self.notes.extend(part.notes);
        self.warnings.extend(part.warnings);
        self.position = self.position.or(part.position);
    }

    /// Where the first fix was: degrees, north and east positive; m. What is not a number is not known.
    pub fn stand_at(&mut self, latitude_deg: f64, longitude_deg: f64, height_m: f64) {
        let known =
            latitude_deg.abs() <= 90.0 && longitude_deg.abs() <= 180.0 && (latitude_deg, longitude_deg) != (0.0, 0.0);
        let height_m = if height_m.is_finite() { height_m } else { 0.0 };
        let place = known.then_some(GeoPoint { latitude_deg, longitude_deg, height_m });
        self.position = self.position.or(place);
    }

    /// Tells how many fixes say nothing of where one moves.
    pub fn tell_fixes(&mut self) {
        let (without, all) = (self.without_course, self.without_course + self.course.events.len());
        if without > 0 {
            self.notes.push(format!(
                "{without} of {all} fixes have no course: they tell no direction, no time of the sensors' clock, or a speed of less than {LEAST_M_S} m/s"
            ));
        }
    }

    /// When it began, ns since 1970, if that is known.
    pub fn begun_unix_ns(&self) -> Option<i64> {
        self.start_unix_ns.or_else(|| self.raw.events.first().map(|(time_ns, _)| *time_ns))
    }

    /// Whether its units, signs, axes and clocks are what they are taken for.
    pub fn conventions(&self) -> Conventions {
        conventions::check(&Streams {
            field: &self.raw.events,
            up: &self.up.events,
            rate: &self.rate.events,
            attitude: &self.attitude.events,
        })
    }

    /// Adds to the times of each sensor.
    pub fn shift(&mut self, shifts: &Shifts) {
        let Shifts { field_ns, up_ns, rate_ns } = *shifts;
        let pairs =
            [(&mut self.raw, field_ns), (&mut self.system, field_ns), (&mut self.up, up_ns), (&mut self.rate, rate_ns)];
        for (stream, shift_ns) in pairs {
            let shifted = |time_ns: i64| time_ns.saturating_add(shift_ns).clamp(1 - MOST_NS, MOST_NS - 1);
            stream.events.iter_mut().for_each(|(time_ns, _)| *time_ns = shifted(*time_ns));
        }
    }

    /// Sorts every sensor's events and turns them into the device's axes. Of several sessions in one file it keeps the one that `which`
    /// says, counted from 1. Loss is told, and refused where it is most of a sensor, unless it is wanted all the same.
    pub fn order(&mut self, frames: &Frames, which: Option<usize>, force: bool) -> Result<(), RecordingError> {
        for stream in [&mut self.raw, &mut self.up, &mut self.rate, &mut self.system] {
            self.notes.extend(stream.cut.take());
        }
        self.pick(which)?;
        let orders = [
            ("magnetometer", self.raw.order(|v| *v = frames.field.turn(v))),
            ("accelerometer", self.up.order(|v| *v = frames.up.turn(v))),
            ("gyroscope", self.rate.order(|v| *v = frames.rate.turn(v))),
            ("system's field", self.system.order(|v| *v = frames.field.turn(v))),
            ("reference", self.attitude.order(|_| ())),
            ("course", self.course.order(|_| ())),
        ];
        tell(&orders, force, &mut self.notes, &mut self.warnings)
    }

    /// Keeps one of several sessions that follow one another in one file.
    fn pick(&mut self, which: Option<usize>) -> Result<(), RecordingError> {
        let parts = sessions(&self.raw.events);
        let place = self.raw.first.as_ref().map_or_else(String::new, |[place, _]| place.path.display().to_string());
        let count = parts.len().max(1);
        if let Some(which) = which.filter(|which| *which > count) {
            let has = if count == 1 { "it holds one session".to_owned() } else { format!("it holds {count} sessions") };
            return Err(RecordingError::Usage(format!("{place}: --session {which}: {has}")));
        }
        if count == 1 {
            return Ok(());
        }
        let Some(which) = which else {
            return Err(RecordingError::Several { sessions: count, why: self.told(&place, &parts) });
        };
        self.notes.push(format!("session {which} of {count} in {place}"));
        let mut left_out = Vec::new();
        let mut part = |name: &str, parts: Vec<Range<usize>>| {
            if !parts.is_empty() && parts.len() != count {
                let times = |parts: usize| parts - 1;
                left_out.push(format!(
                    "{name} was left out: its time runs back {} times, the magnetometer's {}",
                    times(parts.len()),
                    times(count)
                ));
            }
            parts.get(which - 1).filter(|_| parts.len() == count).cloned().unwrap_or(0..0)
        };
        self.raw.keep(&parts[which - 1]);
        self.up.keep(&part("accelerometer", sessions(&self.up.events)));
        self.rate.keep(&part("gyroscope", sessions(&self.rate.events)));
        self.system.keep(&part("system's field", sessions(&self.system.events)));
        self.attitude.keep(&part("reference", sessions(&self.attitude.events)));
        self.course.keep(&part("course", sessions(&self.course.events)));
        self.warnings.append(&mut left_out);
        Ok(())
    }

    /// The sessions of one file in words.
    fn told(&self, place: &str, parts: &[Range<usize>]) -> String {
        let told = parts.iter().take(MOST_TOLD).enumerate().map(|(k, part)| {
            let events = &self.raw.events[part.clone()];
            let times = || events.iter().map(|(time_ns, _)| *time_ns);
            let [from_s, to_s] = [times().min(), times().max()].map(|time_ns| time_ns.unwrap_or(0) as f64 / 1e9);
            format!("{}: {from_s:.1} to {to_s:.1} s, {} magnetometer events", k + 1, events.len())
        });
        let told: Vec<String> = told.collect();
        let (count, more) = (parts.len(), if parts.len() > MOST_TOLD { "; ..." } else { "" });
        let told = told.join("; ");
        format!("{place}: its time runs back, so it holds {count} sessions ({told}{more}); name one by --session N")
    }

    /// Number, rate and longest pause of each sensor's events.
    pub fn sensors(&self) -> Vec<Sensor> {
        let names = ["magnetometer", "accelerometer", "gyroscope", "system's field"];
        let streams = [&self.raw, &self.up, &self.rate, &self.system];
        let mut sensors: Vec<Sensor> =
            names.into_iter().zip(streams).map(|(name, s)| sensor(name, &s.events)).collect();
        sensors.push(sensor("reference", &self.attitude.events));
        sensors.push(sensor("course", &self.course.events));
        sensors.retain(|sensor| sensor.events > 0);
        sensors
    }

    pub fn into_events(self) -> Events {
        Events {
            field: self.raw.events,
            up: self.up.events,
            rate: self.rate.events,
            system: self.system.events,
            attitude: self.attitude.events,
            course: self.course.events,
        }
    }

    /// Refuses a session without magnetometer, whose files are `paths`.
    pub fn require_magnetometer(&self, logger: &str, paths: &[PathBuf]) -> Result<(), RecordingError> {
        if !self.raw.events.is_empty() {
            return Ok(());
        }
        let names: Vec<String> = paths.iter().map(|path| path.display().to_string()).collect();
        let why = "no magnetometer event; record the magnetometer too, uncalibrated where the logger offers it";
        let named = match logger {
            "Sensor Logger" => {
                "; a file's name tells its sensor (MagnetometerUncalibrated.csv), which a pipe does not have"
            }
            "MATLAB Mobile" => "; a file's name tells its sensor (MagneticField.csv), which a pipe does not have",
            "plain CSV" => "; name its columns by --columns mx=NAME,my=NAME,mz=NAME where they are there",
            _ => "",
        };
        let left_out = self.warnings.first().map_or_else(String::new, |warning| format!("; {warning}"));
        Err(RecordingError::Usage(format!("{logger} session {}: {why}{named}{left_out}", names.join(", "))))
    }
}

fn sensor<T>(name: &'static str, events: &[(i64, T)]) -> Sensor {
    let mut steps: Vec<i64> = events.windows(2).map(|pair| pair[1].0 - pair[0].0).collect();
    steps.sort_unstable();
    let seconds = |step: Option<&i64>| step.map(|step| *step as f64 / 1e9);
    Sensor {
        sensor: name,
        events: events.len(),
        rate_hz: seconds(steps.get(steps.len() / 2)).map(f64::recip),
        longest_pause_s: seconds(steps.last()),
    }
}
