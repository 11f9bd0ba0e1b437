//! Carried phones in fields and hands that users meet: a place's field that swings, a device that is shaken, boards with magnets, changes that go
//! back, a second launch. Each group is a table of what happens, and what it happens to: a line and a way of carrying make a variant.

use super::families::{BOTH, carried};
use super::group::Group;
use super::happening::{By, Happening, Swing, When};
use super::sensors::Sensors;
use super::variant::{Kept, Variant};
use crate::motion::Motion::{self, Drive, Game, Look, Lying, Mixed, Pocket, Text};
use crate::motion::Shake;

/// From when on a field swings, s, and for how long.
const SWINGS_S: (f64, f64) = (40.0, 12.0);
const G_M_S2: f64 = crate::inertial::GRAVITY_M_S2;
/// An earlier launch is so long ago, s.
const HOUR_S: u32 = 3600;

pub(super) fn variants() -> Vec<Variant> {
    [swinging(), shaken(), magnets(), back(), launches()].concat()
}

/// What happens: name, in a few words, the happenings, and the sensors.
pub(super) struct Line {
    pub name: &'static str,
    pub about: &'static str,
    pub happens: Vec<Happening>,
    pub sensors: Sensors,
}

/// With the usual sensors.
fn line(name: &'static str, about: &'static str, happens: Vec<Happening>) -> Line {
    Line { name, about, happens, sensors: Sensors::carried() }
}

/// Each line in each motion, for so long, s.
pub(super) fn table(group: Group, ways: &[(Motion, &str)], duration_s: f64, lines: Vec<Line>) -> Vec<Variant> {
    let one = |line: &Line, (motion, way): (Motion, &str)| {
        let (name, about) = (format!("{}.{}-{way}", group.name(), line.name), format!("{way}, {}", line.about));
        let variant = carried(group, &name, &about, motion, duration_s, line.happens.clone());
        Variant { sensors: line.sensors, ..variant }
    };
    lines.iter().flat_map(|line| ways.iter().map(|way| one(line, *way))).collect()
}

fn swinging() -> Vec<Variant> {
    let ways = [(Text, "walk"), (Game, "game"), (Look, "look"), (Drive, "drive"), (Mixed, "mixed")];
    let (from_s, for_s) = SWINGS_S;
    let swings = |swing, size_ut, for_s| vec![Happening::Swings(swing, size_ut, from_s, for_s)];
    let lines = vec![
        Line {
            sensors: Sensors::carried().at_rate(10.0),
            ..line(
                "bridge",
                "a steel bridge: 14 uT an axis, another each 0.1 s, for 12 s; rows of 10 Hz",
                swings(Swing::Noise(10.0), (14.0, 14.0), for_s),
            )
        },
        line("tram", "a tram: 10 to 30 uT at 16.7 Hz for 12 s", swings(Swing::Wave(16.7), (10.0, 30.0), for_s)),
        line("mains", "mains: 10 to 30 uT at 50 Hz for 12 s", swings(Swing::Wave(50.0), (10.0, 30.0), for_s)),
        line("noise", "noise of 12 uT an axis for 5 s", swings(Swing::Noise(100.0), (12.0, 12.0), 5.0)),
    ];
    table(Group::Swinging, &ways, 90.0, lines)
}

/// Turned by rad, at Hz, moved at m/s^2, in step with the turns: name, and in a few words.
const SHAKES: [(&str, &str, Shake); 9] = [
    ("step1g", "fast, in step, 1 g", fast(1.0, true)),
    ("step2g", "fast, in step, 2 g", fast(2.0, true)),
    ("step3g", "fast, in step, 3 g", fast(3.0, true)),
    ("free1g", "fast, not in step, 1 g", fast(1.0, false)),
    ("free2g", "fast, not in step, 2 g", fast(2.0, false)),
    ("free3g", "fast, not in step, 3 g", fast(3.0, false)),
    ("sway", "swayed by 0.2 rad at 0.5 Hz, moved at 4 m/s^2 in step", gentle(0.5, 0.2, 4.0)),
    ("sway1g", "swayed by 0.3 rad at 0.5 Hz, moved at 1 g in step", gentle(0.5, 0.3, G_M_S2)),
    ("sway-wide", "swayed by 0.4 rad at 0.5 Hz, moved at 8 m/s^2 in step", gentle(0.5, 0.4, 8.0)),
];

/// Turned by 0.5 rad twice a second: up to 6 rad/s.
const fn fast(moved_g: f64, in_step: bool) -> Shake {
    Shake { turned_rad: 0.5, hz: 2.0, moved_m_s2: moved_g * G_M_S2, in_step }
}

const fn gentle(hz: f64, turned_rad: f64, moved_m_s2: f64) -> Shake {
    Shake { turned_rad, hz, moved_m_s2, in_step: true }
}

fn shaken() -> Vec<Variant> {
    let one = |(name, about, shake): (&str, &str, Shake)| {
        let name = format!("shaken.{name}");
        Variant { shaken: Some(shake), ..carried(Group::Shaken, &name, about, Motion::Still, 90.0, Vec::new()) }
    };
    SHAKES.map(one).to_vec()
}

fn magnets() -> Vec<Variant> {
    // as among the boards of recorded walks, where a minute has six passes beyond 20 uT and one or two beyond 200, 0.5 to 2.5 s wide, in a place
    // that is uneven besides
    let recorded = |from_s| vec![Happening::Boards((10.0, 400.0), 1.0, 6.0, from_s), Happening::Uneven(5.0, from_s)];
    let boards = |every_s, from_s| vec![Happening::Boards((5.0, 180.0), 0.8, every_s, from_s)];
    let lines = vec![
        line("few", "boards of 5 to 180 uT, 0.8 s wide, one each 12 s, from 25 s on", boards(12.0, 25.0)),
        line("many", "boards of 5 to 180 uT, 0.8 s wide, one each 5 s, from 25 s on", boards(5.0, 25.0)),
        line("start-many", "boards of 5 to 180 uT, 0.8 s wide, one each 5 s, from the start", boards(5.0, 0.0)),
        line("strong", "boards of 10 to 400 uT, 1 s wide, one each 6 s, and 5 uT uneven, from 25 s on", recorded(25.0)),
        line("start-strong", "boards of 10 to 400 uT, 1 s wide, one each 6 s, and 5 uT uneven", recorded(0.0)),
    ];
    table(Group::Magnets, &[(Text, "walk"), (Pocket, "pocket")], 90.0, lines)
}

fn back() -> Vec<Variant> {
    let cover = |at_s, for_s| Happening::Step {
        when: When::At(at_s),
        by: By::Random(30.0, 30.0, 0.02),
        over_s: 0.2,
        for_s: Some(for_s),
    };
    // it stays to the end
    const STAYS_S: f64 = 1000.0;
    let place = |from_s, for_s| Happening::Room(25.0, from_s, for_s);
    let lines = vec![
        line("5s", "a cover of 30 uT for 5 s", vec![cover(40.0, 5.0)]),
        line("20s", "a cover of 30 uT for 20 s", vec![cover(40.0, 20.0)]),
        line(
            "thrice",
            "covers of 30 uT for 8 s, three times",
            [30.0, 50.0, 70.0].map(|at_s| cover(at_s, 8.0)).to_vec(),
        ),
        line(
            "place-stays",
            "the place changes by 25 uT for good, then a cover of 30 uT",
            vec![place(30.0, STAYS_S), cover(50.0, STAYS_S)],
        ),
        line(
            "place-back",
            "another place by 25 uT for 45 s, a cover of 30 uT on and off in it",
            vec![place(30.0, 45.0), cover(40.0, 20.0)],
        ),
        line(
            "over-place",
            "a cover of 30 uT on before another place by 25 uT, off in it",
            vec![cover(30.0, 25.0), place(40.0, 30.0)],
        ),
    ];
    table(Group::Back, &BOTH, 90.0, lines)
}

fn launches() -> Vec<Variant> {
    let ways = [(Lying, "at rest"), (Text, "walk")];
    let one = |off_ut: f64, (motion, way): (Motion, &str)| {
        let name = format!("launches.{off_ut}ut-{}", way.replace(' ', "-"));
        let about = format!("{way}, an hour after one that kept a calibration; b has changed by {off_ut} uT since");
        let kept = Some(Kept { off_ut, age_s: HOUR_S });
        Variant { kept, ..carried(Group::Launches, &name, &about, motion, 60.0, Vec::new()) }
    };
    [0.0, 8.0, 30.0].into_iter().flat_map(|off_ut| ways.map(|way| one(off_ut, way))).collect()
}
