//! What a tester noted: when something was done to the device, and where it pointed. Each is set beside what the compensator said.

use super::changes::Declared;
use super::circle::off_deg;
use crate::play::Step;
use magcomp_recordings::recording::Row;
use serde::Serialize;
use std::str::FromStr;

/// An event that began so long before or after a mark is about it, s: a hand that notes a time is off by a second or two, a decision may wait for motion.
const ABOUT_S: (f64, f64) = (3.0, 30.0);
/// Headings within this of a bearing's time are compared with it, s.
const AROUND_S: f64 = 1.0;

/// A moment that somebody noted.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// s after the first row.
    pub at_s: f64,
    /// What was done.
    pub name: String,
}

/// A direction that somebody noted: of the axis whose heading is judged, degrees from north, at s after the first row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bearing {
    at_s: f64,
    bearing_deg: f64,
}

/// A mark beside the events.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MarkTold {
    /// s after the first row.
    pub at_s: f64,
    /// What was done.
    pub name: String,
    /// The kind of the first event about it; none where no event is.
    pub event: Option<String>,
    /// How long after the mark that event was decided, s.
    pub decided_after_s: Option<f64>,
}

/// A bearing beside the published heading.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct BearingTold {
    /// s after the first row.
    pub at_s: f64,
    /// As noted, degrees.
    pub bearing_deg: f64,
    /// The mean heading about then, degrees: of true north where a declination is known; none without a heading.
    pub heading_deg: Option<f64>,
    /// Its mean sigma, degrees.
    pub sigma_deg: Option<f64>,
}

/// Seconds and what follows the equals sign.
fn parted(text: &str) -> Option<(f64, &str)> {
    let (at_s, rest) = text.split_once('=')?;
    let at_s = at_s.trim().parse().ok().filter(|at_s: &f64| *at_s >= 0.0 && at_s.is_finite())?;
    Some((at_s, rest.trim())).filter(|(_, rest)| !rest.is_empty())
}

impl FromStr for Mark {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (at_s, name) = parted(text).ok_or("expected seconds after the first row and a word, such as 52=cover")?;
        Ok(Self { at_s, name: name.to_owned() })
    }
}

impl FromStr for Bearing {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let expected = "expected seconds after the first row and degrees from north, such as 120=87";
        let (at_s, bearing) = parted(text).ok_or(expected)?;
        let bearing_deg = bearing.parse().ok().filter(|deg: &f64| (-360.0..=360.0).contains(deg)).ok_or(expected)?;
        Ok(Self { at_s, bearing_deg })
    }
}

impl Mark {
    /// Beside the events of a replay.
    pub fn told(&self, events: &[Declared]) -> MarkTold {
        let about = |event: &&Declared| {
            let since_s = event.since_s - self.at_s;
            event.decided_s >= self.at_s && (-ABOUT_S.0..=ABOUT_S.1).contains(&since_s)
        };
        let event = events.iter().find(about);
        MarkTold {
            at_s: self.at_s,
            name: self.name.clone(),
            event: event.map(|event| event.kind.clone()),
            decided_after_s: event.map(|event| event.decided_s - self.at_s),
        }
    }
}

/// Bearings and the headings about their times, row by row.
#[derive(Clone, Debug)]
pub struct Bearings {
    start_s: f64,
    /// Each with the sum of the differences of headings from it, of their sigmas, and their number.
    all: Vec<(Bearing, [f64; 3])>,
}

impl Bearings {
    /// For a recording that starts then.
    pub fn new(bearings: &[Bearing], start_s: f64) -> Self {
        Self { start_s, all: bearings.iter().map(|bearing| (*bearing, [0.0; 3])).collect() }
    }

    /// The same with these.
    pub fn with(self, bearings: &[Bearing]) -> Self {
        Self::new(bearings, self.start_s)
    }

    /// The next row and the compensator's step for it.
    pub fn add(&mut self, row: &Row, step: &Step) {
        let after_s = row.time_s - self.start_s;
        for (bearing, sums) in self.all.iter_mut().filter(|(it, _)| (after_s - it.at_s).abs() <= AROUND_S) {
            let Some(heading) = step.reading.heading else { continue };
            let heading_deg = heading.true_heading_deg.unwrap_or(heading.heading_deg);
            let sigma_deg = heading.heading_sigma_deg.unwrap_or(180.0);
            [off_deg(heading_deg, bearing.bearing_deg), sigma_deg, 1.0]
                .iter()
                .zip(sums)
                .for_each(|(it, sum)| *sum += it);
        }
    }

    /// What they come to.
    pub fn finish(&self) -> Vec<BearingTold> {
        let told = |(Bearing { at_s, bearing_deg }, [off_deg, sigma_deg, count]): &(Bearing, [f64; 3])| BearingTold {
            at_s: *at_s,
            bearing_deg: *bearing_deg,
            heading_deg: (*count > 0.0).then(|| (bearing_deg + off_deg / count).rem_euclid(360.0)),
            sigma_deg: (*count > 0.0).then(|| sigma_deg / count),
        };
        self.all.iter().map(told).collect()
    }
}

impl std::fmt::Display for MarkTold {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { at_s, name, .. } = self;
        match (&self.event, self.decided_after_s) {
            (Some(event), Some(after_s)) => write!(f, "{name} at {at_s:.1} s: {event}, told {after_s:.1} s later"),
            _ => write!(f, "{name} at {at_s:.1} s: no change was told"),
        }
    }
}

impl std::fmt::Display for BearingTold {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { at_s, bearing_deg, .. } = self;
        match (self.heading_deg, self.sigma_deg) {
            (Some(heading_deg), Some(sigma_deg)) => {
                let off_deg = off_deg(heading_deg, *bearing_deg);
                write!(f, "at {at_s:.1} s {heading_deg:.1} +- {sigma_deg:.1} deg, {off_deg:+.1} from the bearing noted")
            }
            _ => write!(f, "at {at_s:.1} s no heading"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_is_told_by_the_first_event_about_it() {
        let event = |since_s, decided_s| Declared { kind: "DeviceStep".to_owned(), since_s, decided_s };
        let events = [event(10.0, 11.0), event(51.0, 53.5), event(60.0, 61.0), event(120.0, 121.0)];
        let told = |text: &str| text.parse::<Mark>().unwrap().told(&events).to_string();
        assert_eq!(told("52=cover"), "cover at 52.0 s: DeviceStep, told 1.5 s later");
        // told before it was done: of something else
        assert_eq!(told("53.9=late"), "late at 53.9 s: DeviceStep, told 7.1 s later");
        assert_eq!(told("70.5=charger in"), "charger in at 70.5 s: no change was told");
        for wrong in ["cover", "52=", "=cover", "-1=cover", "nan=cover"] {
            assert!(wrong.parse::<Mark>().unwrap_err().contains("52=cover"), "{wrong}");
        }
        for wrong in ["120", "120=north", "120=400", "x=3"] {
            assert!(wrong.parse::<Bearing>().unwrap_err().contains("120=87"), "{wrong}");
        }
    }

    #[test]
    fn a_bearing_is_compared_across_north() {
        let mut bearings = Bearings::new(&["5=359".parse().unwrap(), "50=90".parse().unwrap()], 0.0);
        bearings.all[0].1 = [3.0 * 2.0, 2.0 * 1.5, 2.0];
        let told: Vec<String> = bearings.finish().iter().map(ToString::to_string).collect();
        assert_eq!(told, ["at 5.0 s 2.0 +- 1.5 deg, +3.0 from the bearing noted", "at 50.0 s no heading"]);
    }
}
