//! What happens to a device and its place, as data, and what a seed makes of it.

use crate::course::{Course, DevicePart};
use crate::motion::Trajectory;
use crate::parameters::Parameters;
use crate::random::Random;
use crate::simulate::{Change, ChangeKind};
use crate::surroundings::Surrounding;
use magcomp::nalgebra::{Matrix3, Vector3};
use std::f64::consts::TAU;

/// From one change to the next where the paper's parameters change again and again, s.
const PERIOD_S: f64 = 15.0;
/// How long another room takes to come and to go, s: the time to walk into it.
const ROOM_COMES_S: f64 = 0.5;

/// When something happens.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum When {
    /// At this time, s.
    At(f64),
    /// 4 s before the device is picked up from the table for the fourth time.
    Lying,
    /// While it is picked up for the fourth time.
    PickedUp,
}

impl When {
    fn seconds(self, trajectory: &Trajectory) -> f64 {
        let spans = &trajectory.picked_up_s;
        let fourth = spans.get(3).or_else(|| spans.last()).copied().unwrap_or_default();
        match self {
            Self::At(at_s) => at_s,
            Self::Lying => fourth.0 - 4.0,
            Self::PickedUp => (fourth.0 + fourth.1) / 2.0,
        }
    }
}

/// By what the device changes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum By {
    /// b by so much in a random direction, uT, between these; and each element of M by a random symmetric part of this root mean square.
    Random(f64, f64, f64),
    /// b by this, uT.
    Offset([f64; 3]),
    /// b by this, field strengths.
    OffsetInFields([f64; 3]),
    /// M - I and b are multiplied by this.
    Deviation(f64),
    /// M and b are multiplied by this.
    Everything(f64),
    /// b is multiplied by this.
    HardIron(f64),
}

impl By {
    fn part(self, course: Course, device: &Parameters, field_ut: f64, random: &mut Random) -> DevicePart {
        let whole = |soft_iron, hard_iron: Vector3<f64>| DevicePart {
            soft_iron,
            ..DevicePart::offset(course.clone(), hard_iron * field_ut)
        };
        let none = Matrix3::zeros();
        match self {
            Self::Random(least_ut, most_ut, soft) => {
                let size_ut = between((least_ut, most_ut), random);
                let hard_iron = random.direction() * (size_ut / field_ut);
                whole(if soft > 0.0 { symmetric(soft, random) } else { none }, hard_iron)
            }
            Self::Offset(by) => whole(none, Vector3::from(by) / field_ut),
            Self::OffsetInFields(by) => whole(none, Vector3::from(by)),
            Self::Deviation(factor) => {
                whole((device.soft_iron - Matrix3::identity()) * (factor - 1.0), device.hard_iron * (factor - 1.0))
            }
            Self::Everything(factor) => whole(device.soft_iron * (factor - 1.0), device.hard_iron * (factor - 1.0)),
            Self::HardIron(factor) => whole(none, device.hard_iron * (factor - 1.0)),
        }
    }
}

/// How a place's field swings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Swing {
    /// Another one so many times a second, of a normal distribution.
    Noise(f64),
    /// A sine of about this frequency, Hz, in one direction.
    Wave(f64),
}

impl Swing {
    fn draw(self, size_ut: f64, from_until_s: (f64, f64), random: &mut Random) -> Surrounding {
        match self {
            Self::Noise(hz) => Surrounding::noise(size_ut, hz, from_until_s, random),
            Self::Wave(hz) => {
                let hz_phase = (wandering_hz(hz, random), random.uniform(0.0, TAU));
                Surrounding::Wave { from_until_s, hz_phase, field_ut: random.direction() * size_ut }
            }
        }
    }
}

/// Something that happens to the device or its place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Happening {
    /// The device changes over `over_s`, and back after `for_s` where it does.
    Step {
        /// When.
        when: When,
        /// By what.
        by: By,
        /// s.
        over_s: f64,
        /// s.
        for_s: Option<f64>,
    },
    /// The device changes evenly.
    Ramp {
        /// s.
        from_s: f64,
        /// s.
        over_s: f64,
        /// By what.
        by: By,
    },
    /// A cover with a magnet, opened and closed for 5 to 20 s each, from 30 to 115 s.
    Folio,
    /// b goes there and back in a sine, uT; a period in s.
    Sway(f64, f64),
    /// A current in the phone, switched at random, uT; about so often a second. From 40 s on.
    Load(f64, f64),
    /// An alternating current of about this frequency, uT, Hz, from 40 s on.
    Hum(f64, f64),
    /// All parameters are drawn anew within half every 15 s.
    Redrawn,
    /// All parameters are multiplied by 1.5 and divided again, every 15 s.
    Covers,
    /// Steps that stay and steps that go, other rooms in between, at random for half an hour.
    HalfHour,
    /// Another place: size, uT; from, s; for, s.
    Room(f64, f64, f64),
    /// A steel door: size, uT; when it is nearest, s; how long it matters, s.
    Door(f64, f64, f64),
    /// Boards with magnets are passed, here and there: each one's largest field, uT, between these; for how long it is beyond half of that, s; a board
    /// each so many seconds, on average; from, s.
    Boards((f64, f64), f64, f64, f64),
    /// The place's field swings: amplitude of a sine or standard deviation of each component, uT, between these; from, s; for, s.
    Swings(Swing, (f64, f64), f64, f64),
    /// The place is uneven: root mean square, uT; from, s.
    Uneven(f64, f64),
    /// A car's body closes around the device: its field, uT; when, s; the share of the Earth's field that it keeps out.
    Vehicle(f64, f64, f64),
}

/// What a happening must know of its variant.
#[derive(Clone, Copy)]
pub(super) struct Setting {
    /// Of the Earth's field, uT.
    pub strength_ut: f64,
    pub duration_s: f64,
    pub change_s: f64,
}

/// What a seed makes of what happens.
#[derive(Default)]
pub(super) struct Drawn {
    pub device: Vec<DevicePart>,
    pub surroundings: Vec<Surrounding>,
    pub changes: Vec<Change>,
}

/// When a current is switched, s: about so many times a second from 40 s on.
fn switched(hz: f64, until_s: f64, random: &mut Random) -> Vec<f64> {
    let mut at_s = 40.0;
    let next = |_: usize| {
        at_s += random.exponential(0.35 / hz) + 0.15 / hz;
        at_s
    };
    (0..2000).map(next).take_while(|at_s| *at_s < until_s).collect()
}

impl Happening {
    /// Adds what this seed makes of it.
    pub(super) fn draw(
        self,
        setting: &Setting,
        device: &Parameters,
        trajectory: &Trajectory,
        random: &mut Random,
        drawn: &mut Drawn,
    ) {
        let field_ut = setting.strength_ut;
        let mut part =
            |course, by: By, random: &mut Random| drawn.device.push(by.part(course, device, field_ut, random));
        match self {
            Self::Step { when, by, over_s, for_s } => {
                let at_s = when.seconds(trajectory);
                part(Course::Held { at_s, over_s, until_s: for_s.map(|for_s| at_s + for_s) }, by, random);
            }
            Self::Ramp { from_s, over_s, by } => part(Course::Even { from_s, over_s }, by, random),
            Self::Sway(ut, period_s) => {
                part(Course::Sine { from_s: 0.0, hz: 1.0 / period_s }, By::Random(ut, ut, 0.0), random);
            }
            Self::Hum(ut, hz) => {
                let hz = wandering_hz(hz, random);
                part(Course::Sine { from_s: 40.0, hz }, By::Random(ut, ut, 0.0), random);
            }
            Self::Load(ut, hz) => {
                let edges = switched(hz, setting.duration_s, random);
                part(Course::Switched(edges), By::Random(ut, ut, 0.0), random);
            }
            Self::Folio => folio(random, &mut drawn.device),
            Self::Redrawn | Self::Covers => self.again_and_again(setting, device, random, &mut drawn.device),
            Self::HalfHour => half_hour(setting, device, random, drawn),
            Self::Room(size_ut, from_s, for_s) => drawn.surroundings.push(room(size_ut, from_s, for_s, random)),
            Self::Door(size_ut, at_s, for_s) => {
                drawn.surroundings.push(Surrounding::door(at_s, size_ut, for_s, random));
            }
            Self::Boards(size_ut, wide_s, every_s, from_s) => {
                let mut at_s = from_s + random.exponential(every_s);
                while at_s < setting.duration_s {
                    drawn.surroundings.push(Surrounding::board(at_s, between(size_ut, random), wide_s, random));
                    at_s += random.exponential(every_s);
                }
            }
            Self::Swings(swing, size_ut, from_s, for_s) => {
                drawn.surroundings.push(swing.draw(between(size_ut, random), (from_s, from_s + for_s), random));
            }
            Self::Uneven(rms_ut, from_s) => {
                let place = Surrounding::uneven(rms_ut, from_s, setting.duration_s, trajectory, random);
                drawn.surroundings.push(place);
            }
            Self::Vehicle(size_ut, at_s, shield) => {
                let field_ut = random.direction() * size_ut;
                drawn.surroundings.push(Surrounding::Vehicle { at_s, field_ut, shield });
                let kind = ChangeKind::Vehicle;
                drawn.changes.push(Change { begins_s: at_s, ends_s: at_s + 2.0, size_ut, kind });
            }
        }
    }

    /// The paper's parameters: each change goes on from where the one before it led.
    fn again_and_again(self, setting: &Setting, device: &Parameters, random: &mut Random, parts: &mut Vec<DevicePart>) {
        let count = ((setting.duration_s - setting.change_s) / PERIOD_S).ceil() as usize;
        let mut before = *device;
        for k in 0..count {
            let after = match self {
                Self::Redrawn => Parameters::from_theta(device.theta().map(|v| v * (1.0 + random.uniform(-0.5, 0.5)))),
                _ if k % 2 == 0 => device.times(1.5),
                _ => *device,
            };
            let course = Course::step(setting.change_s + PERIOD_S * k as f64);
            parts.push(DevicePart::between(course, &before, &after, setting.strength_ut));
            before = after;
        }
    }
}

/// Evenly in the logarithm.
fn between((least, most): (f64, f64), random: &mut Random) -> f64 {
    least * (most / least).powf(random.uniform(0.0, 1.0))
}

/// The mains wander, and so does the clock of the samples.
fn wandering_hz(hz: f64, random: &mut Random) -> f64 {
    (hz + 0.02 * random.normal()) * (1.0 + 0.002 * random.normal())
}

pub(crate) fn symmetric(rms: f64, random: &mut Random) -> Matrix3<f64> {
    let [xx, yy, zz, xy, xz, yz] = [(); 6].map(|()| random.normal() * rms);
    Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz)
}

fn room(size_ut: f64, from_s: f64, for_s: f64, random: &mut Random) -> Surrounding {
    let course = Course::Held { at_s: from_s, over_s: ROOM_COMES_S, until_s: Some(from_s + for_s) };
    Surrounding::Shift { course, field_ut: random.direction() * size_ut }
}

fn folio(random: &mut Random, parts: &mut Vec<DevicePart>) {
    let (offset_ut, detour_ut) = (random.direction() * 25.0, random.direction() * 30.0);
    let soft_iron = symmetric(0.02, random);
    let mut at_s = 30.0;
    while at_s < 115.0 {
        let until_s = at_s + random.uniform(5.0, 20.0);
        let course = Course::Held { at_s, over_s: random.uniform(0.3, 0.8), until_s: Some(until_s) };
        parts.push(DevicePart { soft_iron, detour_ut, ..DevicePart::offset(course, offset_ut) });
        at_s = until_s + random.uniform(5.0, 20.0);
    }
}

fn half_hour(setting: &Setting, device: &Parameters, random: &mut Random, drawn: &mut Drawn) {
    let mut at_s = random.uniform(120.0, 200.0);
    while at_s < setting.duration_s - 90.0 {
        let stays = random.uniform(0.0, 1.0) < 0.75;
        let size_ut = random.uniform(10.0, 60.0);
        let until_s = (!stays).then(|| at_s + random.uniform(8.0, 60.0));
        let course = Course::Held { at_s, over_s: 0.2, until_s };
        drawn.device.push(By::Random(size_ut, size_ut, 0.02).part(course, device, setting.strength_ut, random));
        let (from_s, for_s) = (at_s + random.uniform(65.0, 100.0), random.uniform(2.0, 20.0));
        let size_ut = random.uniform(10.0, 30.0);
        drawn.surroundings.push(room(size_ut, from_s, for_s, random));
        at_s += random.uniform(150.0, 280.0);
    }
}
