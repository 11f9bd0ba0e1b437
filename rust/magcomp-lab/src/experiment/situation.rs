//! The situations of `magcomp evaluate`: simulated phones ([`Phone`]) with an ordinary motion or a turn about one axis, and one
//! thing that happens to them at 30 s.

use super::surroundings::Surroundings;
use crate::motion::{Motion, Trajectory};
use crate::phone::{CHANGE_S, DURATION_S, FIELD_UT, PLACE_S, Phone, PhoneChange};
use crate::random::{Purpose, Random};
use crate::schedule::{Change, Schedule};
use crate::simulate::{Scenario, Simulation};
use crate::time::time_ns;
use clap::ValueEnum;
use magcomp::nalgebra::Vector3;
use magcomp::{Config, EventKind};

/// Hard iron that a cover adds, uT.
const COVER_UT: Vector3<f64> = Vector3::new(20.0, -15.0, 10.0);
/// How long it stays where it comes off again, how long a charger stays, and when one is put on in another room, s.
const STAYS_S: f64 = 10.0;
/// Hard iron that a charger adds along x, uT. The sensor's full scale is smaller, so x reads the full scale.
const CHARGER_UT: f64 = 400.0;
const FULL_SCALE_UT: f64 = 300.0;
/// Change of b during a pause, or of the field in another room, uT, in a random direction.
const RANDOM_CHANGE_UT: f64 = 20.0;
/// How long the device stays in another room, s.
const ROOM_S: f64 = 60.0;
/// An event counts for a change when it is decided within this time after the change has ended, s.
const DECIDED_WITHIN_S: f64 = 20.0;

/// Situations that are shown in one table.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Group {
    /// With gyroscope: nothing happens, a change of the device or the place, a drift, spikes, a poor gyroscope
    Ordinary,
    /// With gyroscope: a cover that is slid on slowly or comes off again, a charger that saturates an axis
    Device,
    /// With gyroscope: steel doors, uneven fields, a cover put on in another room, a car
    Surroundings,
    /// With gyroscope: turned about one axis from a cold start
    OneAxis,
    /// With gyroscope: all sensors pause
    Pause,
    /// Without gyroscope
    Alone,
}

impl Group {
    /// The table's title.
    #[must_use]
    pub fn title(self) -> &'static str {
        match self {
            Self::Ordinary => "With gyroscope and accelerometer",
            Self::Device => "The device's own disturbance, with gyroscope",
            Self::Surroundings => "The surroundings, with gyroscope",
            Self::OneAxis => "Turned about one axis from a cold start, with gyroscope",
            Self::Pause => "All sensors pause at 30 s, walking, with gyroscope",
            Self::Alone => "Magnetometer and accelerometer, no gyroscope",
        }
    }

    /// Its situations, in the order of the table.
    #[must_use]
    pub fn situations(self) -> Vec<Situation> {
        use Happening::{Charger, Cover, CoverOnOff, Nothing, Pause, Room, Through, Usual};
        use Motion::{Pedestrian, Stroll, Tumble};
        use Surroundings::{Braking, Car, Doors, Uneven};
        let usual = |motion, change| Situation::of(motion, Usual(change));
        let walked = |happening| Situation::of(Pedestrian, happening);
        match self {
            Self::Ordinary => vec![
                usual(Tumble, PhoneChange::Nothing),
                usual(Pedestrian, PhoneChange::Nothing),
                usual(Tumble, PhoneChange::Parameters),
                usual(Pedestrian, PhoneChange::Offset),
                Situation { spikes: 0.01, ..usual(Pedestrian, PhoneChange::Offset) },
                Situation { has_poor_gyroscope: true, ..usual(Pedestrian, PhoneChange::Offset) },
                usual(Tumble, PhoneChange::Place),
                usual(Pedestrian, PhoneChange::Place),
                Situation::of(Tumble, Room { is_covered_there: false }),
                walked(Room { is_covered_there: false }),
                usual(Tumble, PhoneChange::Drift),
                usual(Pedestrian, PhoneChange::Drift),
            ],
            Self::Device => {
                let covers = [1.0, 5.0, 15.0].map(|over_s| walked(Cover { over_s }));
                let others = [
                    Situation::of(Tumble, CoverOnOff),
                    walked(CoverOnOff),
                    walked(Charger { is_full_scale_set: false }),
                    walked(Charger { is_full_scale_set: true }),
                ];
                covers.into_iter().chain(others).collect()
            }
            Self::Surroundings => {
                let through = [Doors, Uneven(3.0), Uneven(10.0), Car, Braking].map(|it| walked(Through(it)));
                std::iter::once(walked(Room { is_covered_there: true })).chain(through).collect()
            }
            Self::OneAxis => {
                let axes = [true, false].into_iter();
                let wobbles = |vertical| [0.0, 0.1, 0.3, 0.6, 1.0].map(|wobble_deg| (vertical, wobble_deg));
                axes.flat_map(wobbles)
                    .map(|about| Situation { one_axis: Some(about), ..Situation::of(Motion::Planar, Nothing) })
                    .collect()
            }
            Self::Pause => {
                let pauses = [0.2, 1.0, 2.0, 5.0, 20.0].into_iter();
                pauses.flat_map(|for_s| [false, true].map(|changes| walked(Pause { for_s, changes }))).collect()
            }
            Self::Alone => [
                usual(Tumble, PhoneChange::Nothing),
                usual(Stroll, PhoneChange::Nothing),
                usual(Tumble, PhoneChange::Offset),
                usual(Stroll, PhoneChange::Offset),
                usual(Tumble, PhoneChange::Place),
                usual(Tumble, PhoneChange::Drift),
            ]
            .map(|one| Situation { has_gyroscope: false, ..one })
            .into(),
        }
    }
}

/// What happens at 30 s.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Happening {
    Nothing,
    Usual(PhoneChange),
    Cover {
        over_s: f64,
    },
    CoverOnOff,
    /// The place differs for a minute; a cover is put on there or not.
    Room {
        is_covered_there: bool,
    },
    Through(Surroundings),
    /// x is at the sensor's full scale for 10 s; `rail_ut` of the config is set or not.
    Charger {
        is_full_scale_set: bool,
    },
    /// No sensor delivers anything; b changes meanwhile or not.
    Pause {
        for_s: f64,
        changes: bool,
    },
}

/// A phone, its sensors and the change that it goes through.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Situation {
    motion: Motion,
    /// About the vertical or a random axis, and how far the axis wobbles, degrees.
    one_axis: Option<(bool, f64)>,
    happening: Happening,
    spikes: f64,
    has_poor_gyroscope: bool,
    has_gyroscope: bool,
}

/// An event that belongs to a change.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Expected {
    /// Decided not before, s.
    pub from_s: f64,
    /// Nor after, s.
    pub until_s: f64,
    /// What changed.
    pub change: Changed,
    /// Whether an event must be declared. Where it need not be, as after a pause, it may be.
    pub is_due: bool,
}

/// What changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Changed {
    /// The device: a device step, there or back.
    Device,
    /// The place.
    Place,
    /// Nothing shows whether the device or the place has changed: an event of either kind counts.
    Either,
}

impl Expected {
    /// Whether an event tells of this change.
    #[must_use]
    pub fn is(&self, kind: EventKind) -> bool {
        let is_device = matches!(kind, EventKind::DeviceStep | EventKind::DeviceStepBack);
        match self.change {
            Changed::Device => is_device,
            Changed::Place => kind == EventKind::PlaceChanged,
            Changed::Either => true,
        }
    }
}

/// A stream, and the answers that are expected to it.
#[derive(Clone, Debug)]
pub struct Stream {
    /// The events of the sensors, and the truth.
    pub simulation: Simulation,
    /// The place's undisturbed field, east-north-up, uT.
    pub earth_ut: Vector3<f64>,
    /// When the thing happens; the start where nothing does, s.
    pub happens_s: f64,
    /// Headings are judged from here on, s.
    pub judged_from_s: f64,
    /// Events that belong to the changes.
    pub expected: Vec<Expected>,
}

impl Situation {
    fn of(motion: Motion, happening: Happening) -> Self {
        Self { motion, one_axis: None, happening, spikes: 0.0, has_poor_gyroscope: false, has_gyroscope: true }
    }

    /// In a few words.
    #[must_use]
    pub fn name(&self) -> String {
        let motion = match (self.one_axis, self.motion) {
            (Some((vertical, wobble_deg)), _) => {
                format!("{} axis, wobble {wobble_deg} deg", if vertical { "vertical" } else { "random" })
            }
            (_, Motion::Tumble) => "tumbling".to_owned(),
            _ => "walking".to_owned(),
        };
        let happens = match self.happening {
            Happening::Nothing => String::new(),
            Happening::Usual(change) => match change {
                PhoneChange::Nothing => ", nothing changes".to_owned(),
                PhoneChange::Parameters => ", M - I and b grow by half".to_owned(),
                PhoneChange::Offset => ", b steps by 27 uT".to_owned(),
                PhoneChange::Place => ", the place differs by 20 uT for 10 s".to_owned(),
                PhoneChange::Drift => ", b drifts by 0.5 uT/s from the start".to_owned(),
            },
            Happening::Cover { over_s } => format!(", cover slid on over {over_s} s"),
            Happening::CoverOnOff => ", cover on, off after 10 s".to_owned(),
            Happening::Room { is_covered_there: false } => ", the place differs by 20 uT for 60 s".to_owned(),
            Happening::Room { is_covered_there: true } => ", another room, and a cover put on there".to_owned(),
            Happening::Through(Surroundings::Doors) => ", a steel door every 10 s".to_owned(),
            Happening::Through(Surroundings::Uneven(rms_ut)) => format!(", the place uneven by {rms_ut} uT"),
            Happening::Through(Surroundings::Car) => return "held in a car that turns, its body 30 uT".to_owned(),
            Happening::Through(Surroundings::Braking) => return "held in a car that speeds up and brakes".to_owned(),
            Happening::Charger { is_full_scale_set: false } => ", charger saturates x for 10 s".to_owned(),
            Happening::Charger { is_full_scale_set: true } => ", the same with rail_ut set".to_owned(),
            Happening::Pause { for_s, changes } => {
                return format!("{for_s} s, b {}", if changes { "changes by 20 uT" } else { "stays" });
            }
        };
        let spikes = if self.spikes > 0.0 { ", 1 % spikes" } else { "" };
        let poor = if self.has_poor_gyroscope { ", poor gyroscope at 25 Hz" } else { "" };
        format!("{motion}{happens}{spikes}{poor}")
    }

    /// The default config with the change that the name says.
    #[must_use]
    pub fn config(&self) -> Config {
        let rail_ut = (self.happening == Happening::Charger { is_full_scale_set: true }).then_some(FULL_SCALE_UT);
        Config { rail_ut, ..Config::default() }
    }

    /// The stream of a seed, with a gyroscope of that skew ([`Phone::gyro_skew_deg`]).
    #[must_use]
    pub fn stream(&self, seed: u64, gyro_skew_deg: f64) -> Stream {
        let change = if let Happening::Usual(change) = self.happening { change } else { PhoneChange::Nothing };
        let longer_s = match self.happening {
            Happening::Pause { for_s, .. } => for_s,
            Happening::Room { .. } | Happening::Through(_) => ROOM_S,
            _ => 0.0,
        };
        let mut phone = Phone {
            seed,
            motion: self.motion,
            change,
            spikes: self.spikes,
            duration_s: DURATION_S + longer_s,
            gyro_skew_deg,
            ..Phone::default()
        };
        if self.has_poor_gyroscope {
            phone = Phone { rate_hz: 25.0, gyro_bias_deg_s: 5.0, gyro_scale_percent: 1.0, gyro_late_ms: 10.0, ..phone };
        }
        let mut scenario = phone.scenario();
        if !self.has_gyroscope {
            scenario.gyroscope = None;
        }
        self.disturb(&mut scenario);
        let mut simulation = match self.one_axis {
            None => scenario.run(),
            Some((vertical, wobble_deg)) => {
                let mut random = Random::new(seed, Purpose::Motion);
                let duration_s = scenario.duration_s();
                scenario.along(&Trajectory::about_one_axis(duration_s, vertical, wobble_deg, &mut random))
            }
        };
        match self.happening {
            Happening::Charger { .. } => {
                for sample in &mut simulation.magnetic {
                    sample.field_ut.x = sample.field_ut.x.clamp(-FULL_SCALE_UT, FULL_SCALE_UT);
                }
            }
            Happening::Pause { for_s, .. } => pause(&mut simulation, CHANGE_S, CHANGE_S + for_s),
            Happening::Through(what) => what.push(&mut simulation, seed, CHANGE_S),
            _ => {}
        }
        let is_calm = matches!(self.happening, Happening::Nothing | Happening::Usual(PhoneChange::Nothing));
        let is_drift = self.happening == Happening::Usual(PhoneChange::Drift);
        let happens_s = if is_calm || is_drift { 0.0 } else { CHANGE_S };
        Stream {
            simulation,
            earth_ut: scenario.world_ut.start,
            happens_s,
            judged_from_s: if is_drift { CHANGE_S } else { happens_s },
            expected: self.expected(),
        }
    }

    /// A change that [`Phone`] does not have.
    fn disturb(&self, scenario: &mut Scenario) {
        let start = scenario.parameters.start;
        let with = |offset_ut: Vector3<f64>| crate::parameters::Parameters {
            hard_iron: start.hard_iron + offset_ut / FIELD_UT,
            ..start
        };
        scenario.parameters = match self.happening {
            Happening::Cover { over_s } => Schedule::ramp(start, CHANGE_S, over_s, with(COVER_UT)),
            Happening::CoverOnOff => Schedule::pulse(start, CHANGE_S, STAYS_S, with(COVER_UT)),
            Happening::Charger { .. } => Schedule::pulse(start, CHANGE_S, STAYS_S, with(Vector3::x() * CHARGER_UT)),
            Happening::Pause { for_s, changes: true } => {
                let direction = Random::new(scenario.seed, Purpose::Bootstrap).direction();
                let change =
                    Change { at_s: CHANGE_S + for_s / 2.0, over_s: 0.0, to: with(direction * RANDOM_CHANGE_UT) };
                Schedule { start, changes: vec![change] }
            }
            Happening::Through(what) => {
                let until_s = scenario.duration_s();
                scenario.world_ut = what.field(scenario.world_ut.start, scenario.seed, CHANGE_S, until_s);
                return;
            }
            Happening::Room { is_covered_there } => {
                let (world_ut, direction) =
                    (scenario.world_ut.start, Random::new(scenario.seed, Purpose::Bootstrap).direction());
                scenario.world_ut =
                    Schedule::pulse(world_ut, CHANGE_S, ROOM_S, world_ut + direction * RANDOM_CHANGE_UT);
                if !is_covered_there {
                    return;
                }
                Schedule::step(start, CHANGE_S + STAYS_S, with(COVER_UT))
            }
            Happening::Nothing | Happening::Usual(_) | Happening::Pause { changes: false, .. } => return,
        };
    }

    fn expected(&self) -> Vec<Expected> {
        let of = |change, is_due, from_s: f64, over_s: f64| Expected {
            from_s,
            until_s: from_s + over_s + DECIDED_WITHIN_S,
            change,
            is_due,
        };
        let device = |over_s| vec![of(Changed::Device, true, CHANGE_S, over_s)];
        match self.happening {
            Happening::Nothing
            | Happening::Usual(PhoneChange::Nothing | PhoneChange::Drift)
            | Happening::Pause { changes: false, .. } => Vec::new(),
            Happening::Usual(PhoneChange::Parameters | PhoneChange::Offset) => device(0.0),
            Happening::Usual(PhoneChange::Place) => {
                let place = Expected { until_s: CHANGE_S + PLACE_S, ..of(Changed::Place, true, CHANGE_S, 0.0) };
                vec![place]
            }
            // a field that changes on and on may be told at any time
            Happening::Through(Surroundings::Braking) => Vec::new(),
            Happening::Through(_) => vec![of(Changed::Place, false, CHANGE_S, ROOM_S)],
            Happening::Room { is_covered_there } => {
                let back = of(Changed::Place, false, CHANGE_S + ROOM_S, 0.0);
                let mut expected = vec![of(Changed::Place, true, CHANGE_S, 0.0), back];
                if is_covered_there {
                    expected[0].until_s = CHANGE_S + STAYS_S;
                    expected.insert(1, of(Changed::Device, true, CHANGE_S + STAYS_S, 0.0));
                }
                expected
            }
            Happening::Cover { over_s } => device(over_s),
            Happening::CoverOnOff => {
                let on = Expected { until_s: CHANGE_S + STAYS_S, ..of(Changed::Device, true, CHANGE_S, 0.0) };
                vec![on, of(Changed::Device, true, CHANGE_S + STAYS_S, 0.0)]
            }
            Happening::Charger { .. } => {
                [0.0, STAYS_S].map(|after_s| of(Changed::Either, false, CHANGE_S + after_s, 0.0)).into()
            }
            Happening::Pause { for_s, changes: true } => vec![of(Changed::Either, false, CHANGE_S, for_s)],
        }
    }
}

/// Removes the events of every sensor between two times, s.
fn pause(simulation: &mut Simulation, from_s: f64, until_s: f64) {
    let is_gone = |at_ns: i64| (time_ns(from_s)..time_ns(until_s)).contains(&at_ns);
    let mut times = simulation.magnetic.iter().map(|sample| sample.time_ns);
    simulation.truth.retain(|_| times.next().is_some_and(|at_ns| !is_gone(at_ns)));
    drop(times);
    simulation.magnetic.retain(|sample| !is_gone(sample.time_ns));
    simulation.rotation_rates.retain(|event| !is_gone(event.time_ns));
    simulation.ups.retain(|event| !is_gone(event.time_ns));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn streams(group: Group) -> Vec<Stream> {
        group.situations().iter().map(|situation| situation.stream(3, 0.0)).collect()
    }

    #[test]
    fn every_situation_has_a_name_of_its_own() {
        for group in Group::value_variants() {
            let mut names: Vec<_> = group.situations().iter().map(Situation::name).collect();
            let count = names.len();
            names.sort();
            names.dedup();
            assert_eq!(names.len(), count, "{names:?}");
        }
    }

    #[test]
    fn no_sensor_speaks_in_a_pause_and_the_truth_stays_with_its_sample() {
        for (situation, stream) in Group::Pause.situations().iter().zip(streams(Group::Pause)) {
            let Happening::Pause { for_s, changes } = situation.happening else { panic!("{situation:?}") };
            let all = stream.simulation;
            let gap_s =
                |times: Vec<i64>| times.windows(2).map(|pair| (pair[1] - pair[0]) as f64 / 1e9).fold(0.0, f64::max);
            for times in [
                all.magnetic.iter().map(|sample| sample.time_ns).collect(),
                all.rotation_rates.iter().map(|event| event.time_ns).collect(),
                all.ups.iter().map(|event| event.time_ns).collect::<Vec<_>>(),
            ] {
                assert!((gap_s(times) - for_s).abs() < 0.02, "{for_s}");
            }
            assert_eq!(all.magnetic.len(), all.truth.len());
            let off = all.magnetic.iter().zip(&all.truth).map(|(raw, truth)| (raw.field_ut - truth.clean_ut).norm());
            assert!(off.fold(0.0, f64::max) < 4.0, "a sample beside another's truth");
            let moved = (all.truth[3100].hard_iron_ut - all.truth[2900].hard_iron_ut).norm();
            assert!((moved - if changes { RANDOM_CHANGE_UT } else { 0.0 }).abs() < 1e-9, "{moved}");
        }
    }

    #[test]
    fn covers_slide_and_come_off_and_a_charger_saturates_x_alone() {
        let device = streams(Group::Device);
        let moved = |stream: &Stream, at_s: f64| {
            let b = |at_s: f64| stream.simulation.truth[(at_s * 100.0) as usize].hard_iron_ut;
            (b(at_s) - b(29.0)).norm()
        };
        assert!((moved(&device[2], 37.5) - COVER_UT.norm() / 2.0).abs() < 0.1 && moved(&device[2], 46.0) > 26.0);
        assert!(moved(&device[3], 35.0) > 26.0 && moved(&device[3], 41.0) < 1e-9);
        let charged = &device[5].simulation.magnetic[3001..3999];
        assert!(charged.iter().all(|sample| sample.field_ut.x == FULL_SCALE_UT));
        assert!(charged.iter().all(|sample| sample.field_ut.yz().amax() < FULL_SCALE_UT));
        let free = &device[5].simulation.magnetic[..2999];
        assert!(free.iter().all(|sample| sample.field_ut.amax() < FULL_SCALE_UT));
    }
}
