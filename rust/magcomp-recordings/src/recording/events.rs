//! The events of a recording, sensor by sensor, and their merging in the order of time.

use super::columns::Line;
use super::rows::{Course, Row};
use crate::time::seconds;
use magcomp::nalgebra::{UnitQuaternion, Vector3};
use std::io::{self, Write};
use std::sync::Arc;

/// Times below this (ns) keep their nanoseconds when they are read as seconds; others are counted from the first event.
const EXACT_NS: i64 = 4_000_000_000_000_000;

/// Times, ns, and values of each sensor, in the order of time, no time twice.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Events {
    /// Raw field, uT, device frame.
    pub field: Vec<(i64, Vector3<f64>)>,
    /// Accelerometer, m/s^2, Android's sign.
    pub up: Vec<(i64, Vector3<f64>)>,
    /// Gyroscope, rad/s.
    pub rate: Vec<(i64, Vector3<f64>)>,
    /// The field that the operating system calibrated, uT.
    pub system: Vec<(i64, Vector3<f64>)>,
    /// Reference orientation, device to east-north-up.
    pub attitude: Vec<(i64, UnitQuaternion<f64>)>,
    /// Headings from outside.
    pub course: Vec<(i64, Course)>,
}

impl Events {
    /// Counts times from the first event where they are too large for seconds to tell their nanoseconds. Returns whether they were.
    pub(crate) fn count_from_start(&mut self) -> bool {
        let start_ns = Merged::heads(self, &[0; 6]).min().unwrap_or(0);
        let last = [self.field.last(), self.up.last(), self.rate.last(), self.system.last()];
        let end_ns = last.into_iter().flatten().map(|(time_ns, _)| *time_ns).max();
        let is_counted = start_ns < -EXACT_NS || end_ns.unwrap_or(0) > EXACT_NS;
        if is_counted {
            for events in [&mut self.field, &mut self.up, &mut self.rate, &mut self.system] {
                events.iter_mut().for_each(|(time_ns, _)| *time_ns -= start_ns);
            }
            self.attitude.iter_mut().for_each(|(time_ns, _)| *time_ns -= start_ns);
            self.course.iter_mut().for_each(|(time_ns, _)| *time_ns -= start_ns);
        }
        is_counted
    }

    /// Writes them as a recording: a line for each time, in which other sensors' cells are empty.
    pub fn write(&self, out: &mut dyn Write) -> io::Result<()> {
        write!(out, "t_s,mx,my,mz,ax,ay,az,gx,gy,gz")?;
        write!(out, "{}", if self.system.is_empty() { "" } else { ",sys_mx,sys_my,sys_mz" })?;
        write!(out, "{}", if self.attitude.is_empty() { "" } else { ",qw,qx,qy,qz" })?;
        writeln!(out, "{}", if self.course.is_empty() { "" } else { ",course_deg,course_sigma_deg" })?;
        let mut next = [0; 6];
        while let Some(Line { field_ut, row: line }) = Merged::line(self, &mut next) {
            write_time(out, line.time_ns)?;
            vector(out, field_ut)?;
            vector(out, line.up_m_s2)?;
            vector(out, line.rate_rad_s)?;
            if !self.system.is_empty() {
                vector(out, line.system_ut)?;
            }
            if !self.attitude.is_empty() {
                match line.attitude {
                    Some(q) => write!(out, ",{},{},{},{}", q.w, q.i, q.j, q.k)?,
                    None => write!(out, ",,,,")?,
                }
            }
            if !self.course.is_empty() {
                match line.course {
                    Some(Course { heading_deg, sigma_deg }) => write!(out, ",{heading_deg},{sigma_deg}")?,
                    None => write!(out, ",,")?,
                }
            }
            writeln!(out)?;
        }
        Ok(())
    }
}

fn vector(out: &mut dyn Write, v: Option<Vector3<f64>>) -> io::Result<()> {
    match v {
        Some(v) => write!(out, ",{},{},{}", v.x, v.y, v.z),
        None => write!(out, ",,,"),
    }
}

/// Seconds, all nine digits.
fn write_time(out: &mut dyn Write, time_ns: i64) -> io::Result<()> {
    let (sign, size) = (if time_ns < 0 { "-" } else { "" }, time_ns.unsigned_abs());
    write!(out, "{sign}{}.{:09}", size / 1_000_000_000, size % 1_000_000_000)
}

/// The lines of events, one for each time.
pub(super) struct Merged {
    events: Arc<Events>,
    next: [usize; 6],
}

impl Merged {
    pub fn new(events: &Arc<Events>) -> Self {
        Self { events: Arc::clone(events), next: [0; 6] }
    }

    /// The time of each sensor's next event.
    fn heads(events: &Events, next: &[usize; 6]) -> impl Iterator<Item = i64> {
        let Events { field, up, rate, system, attitude, course } = events;
        let heads = [at(field, next[0]), at(up, next[1]), at(rate, next[2])];
        heads.into_iter().chain([at(system, next[3]), at(attitude, next[4]), at(course, next[5])]).flatten()
    }

    fn line(events: &Events, next: &mut [usize; 6]) -> Option<Line> {
        let time_ns = Self::heads(events, next).min()?;
        let [field, up, rate, system, attitude, course] = next;
        let row = Row {
            time_s: seconds(time_ns),
            time_ns,
            up_m_s2: take(&events.up, up, time_ns),
            rate_rad_s: take(&events.rate, rate, time_ns),
            system_ut: take(&events.system, system, time_ns),
            attitude: take(&events.attitude, attitude, time_ns),
            course: take(&events.course, course, time_ns),
            ..Row::default()
        };
        Some(Line { field_ut: take(&events.field, field, time_ns), row })
    }
}

impl Iterator for Merged {
    type Item = Line;

    fn next(&mut self) -> Option<Line> {
        Self::line(&self.events, &mut self.next)
    }
}

fn at<T>(events: &[(i64, T)], next: usize) -> Option<i64> {
    events.get(next).map(|(time_ns, _)| *time_ns)
}

/// The value at this time, if the event at `next` has it; then `next` moves on.
fn take<T: Copy>(events: &[(i64, T)], next: &mut usize, time_ns: i64) -> Option<T> {
    let (_, value) = events.get(*next).filter(|(at_ns, _)| *at_ns == time_ns)?;
    *next += 1;
    Some(*value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::{Source, read_from};
    use crate::time::time_ns;
    use std::path::Path;

    #[test]
    fn rows_of_events_are_those_of_the_text_that_they_are_written_as() {
        let vector = |k: i64| Vector3::new(20.0 + k as f64 / 3.0, -30.1, 0.7 * k as f64);
        let every = |step_ns: i64, count: i64| (0..count).map(move |k| (k * step_ns, vector(k)));
        let start_ns = 1_700_000_000_123_456_789;
        let mut events = Events {
            field: every(20_000_001, 200).map(|(t, v)| (start_ns + t, v)).collect(),
            up: every(10_000_000, 400).map(|(t, v)| (start_ns + t, v)).collect(),
            rate: every(7_000_003, 500).map(|(t, v)| (start_ns + t, v)).collect(),
            system: every(50_000_000, 70).map(|(t, v)| (start_ns + t, v)).collect(),
            attitude: Vec::new(),
            course: vec![(start_ns + 1_000_000_007, Course { heading_deg: 12.3, sigma_deg: 4.5 })],
        };
        assert!(events.count_from_start() && events.field[0].0 == 0 && !events.count_from_start());
        let mut text = Vec::new();
        events.write(&mut text).unwrap();
        let path = Path::new("r.csv");
        let written = read_from(path, io::Cursor::new(text)).unwrap();
        let mut source = Source::of_events(path, events).unwrap();
        let rows: Vec<_> = source.rows().unwrap().collect::<Result<_, _>>().unwrap();
        assert_eq!(rows, written.rows);
        assert_eq!(*source.extent(), written.extent());
        assert!(time_ns(rows[199].time_s) == 199 * 20_000_001 && rows.iter().any(|row| row.before.len() > 3));
    }
}
