//! Phones of 60 s, from a cold start: one recipe for the figures that the documents quote. What happens, happens at 30 s.

use super::group::Group;
use super::happening::{By, Happening, When};
use super::sensors::Sensors;
use super::variant::{DeviceKind, Place, Variant};
use crate::motion::Motion;
use crate::simulate::Spikes;
use clap::ValueEnum;

/// Field of the place, uT.
pub const FIELD_UT: f64 = 50.0;
/// Its dip, degrees.
const DIP_DEG: f64 = 60.0;
/// Length of a stream, s.
const DURATION_S: f64 = 60.0;
/// When it changes, s.
pub const CHANGE_S: f64 = 30.0;
/// Hard iron that a walker's magnet or cover adds, uT.
const COVER_UT: [f64; 3] = [20.0, -15.0, 10.0];
/// A change of the place: its size, uT ...
const PLACE_UT: f64 = 20.0;
/// ... how long it lasts where it is short, s ...
pub const PLACE_S: f64 = 10.0;
/// ... and where it is long.
const ROOM_S: f64 = 60.0;
/// A drift of b over the whole stream, uT/s.
const DRIFT_UT_S: f64 = 0.5;
/// Share of samples hit by a spike, and its size, uT.
const SPIKES_UT: (f64, f64) = (30.0, 150.0);
/// A charger's hard iron along x, uT, and the full scale of a sensor that it saturates.
const CHARGER_UT: [f64; 3] = [400.0, 0.0, 0.0];
const FULL_SCALE_UT: f64 = 300.0;

/// What changes at [`CHANGE_S`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum PhoneChange {
    /// Nothing
    #[default]
    Nothing,
    /// The device: M - I and b become 1.5 times what they were
    Parameters,
    /// The device: b steps by (20, -15, 10) uT
    Offset,
    /// The place: 20 uT in a random direction of the world for 10 s
    Place,
    /// The device: b drifts by 0.5 uT/s in a random direction, from the start to the end
    Drift,
}

impl PhoneChange {
    fn happens(self) -> Vec<Happening> {
        match self {
            Self::Nothing => Vec::new(),
            Self::Parameters => vec![step(By::Deviation(1.5))],
            Self::Offset => vec![step(By::Offset(COVER_UT))],
            Self::Place => vec![Happening::Room(PLACE_UT, CHANGE_S, PLACE_S)],
            Self::Drift => {
                let gone_ut = DRIFT_UT_S * DURATION_S;
                vec![Happening::Ramp { from_s: 0.0, over_s: DURATION_S, by: By::Random(gone_ut, gone_ut, 0.0) }]
            }
        }
    }

    fn words(self) -> &'static str {
        match self {
            Self::Nothing => "nothing changes",
            Self::Parameters => "M - I and b grow by half",
            Self::Offset => "b steps by 27 uT",
            Self::Place => "the place differs by 20 uT for 10 s",
            Self::Drift => "b drifts by 0.5 uT/s from the start",
        }
    }
}

fn step(by: By) -> Happening {
    Happening::Step { when: When::At(CHANGE_S), by, over_s: 0.0, for_s: None }
}

/// A phone with all sensors.
pub fn phone(name: &str, motion: Motion, change: PhoneChange) -> Variant {
    let moves = match motion {
        Motion::Tumble => "tumbling",
        Motion::Walk | Motion::Stroll => "walking",
        Motion::Planar => "turned about one axis",
        Motion::Still => "at rest",
        _ => "carried",
    };
    Variant {
        name: name.to_owned(),
        about: format!("{moves}, {}", change.words()),
        group: Group::Ordinary,
        duration_s: DURATION_S,
        motion,
        one_axis: None,
        shaken: None,
        earth: (FIELD_UT, DIP_DEG),
        place: Place::of(motion),
        device: DeviceKind::Phone,
        change_s: CHANGE_S,
        happens: change.happens(),
        pause_s: None,
        sensors: Sensors::plain(),
        is_known: false,
        kept: None,
        rail_ut: None,
    }
}

impl Variant {
    /// In other words.
    pub(super) fn about(self, about: &str) -> Self {
        Self { about: about.to_owned(), ..self }
    }

    /// With this behind the words that it has.
    fn and(self, what: &str) -> Self {
        Self { about: format!("{}, {what}", self.about), ..self }
    }

    /// With samples hit by spikes.
    pub fn with_spikes(mut self, share: f64) -> Self {
        self.sensors.magnetometer.spikes = (share > 0.0).then_some(Spikes { share, size_ut: SPIKES_UT });
        self
    }

    /// In a place that differs for a minute, during which other things may happen.
    fn in_a_room(self, besides: Vec<Happening>) -> Self {
        let happens = [vec![Happening::Room(PLACE_UT, CHANGE_S, ROOM_S)], besides].concat();
        Self { happens, duration_s: DURATION_S + ROOM_S, ..self }
    }
}

pub(super) fn variants() -> Vec<Variant> {
    [ordinary(), one_axis(), pauses(), alone()].concat()
}

fn ordinary() -> Vec<Variant> {
    use Motion::{Planar, Still, Tumble, Walk};
    use PhoneChange::{Drift, Nothing, Offset, Parameters, Place};
    let walk = || phone("phone-walk", Walk, Offset);
    let poor =
        Sensors { gyro_bias_deg_s: (5.0, 5.0), gyro_scale: 0.01, gyro_late_s: 0.01, ..Sensors::plain().at_rate(25.0) };
    vec![
        phone("phone-steady", Tumble, Nothing),
        phone("phone-walk-steady", Walk, Nothing),
        phone("phone-hand", Tumble, Parameters),
        phone("phone-spikes", Tumble, Parameters).with_spikes(0.02).and("2 % spikes"),
        walk(),
        Variant { is_known: true, ..phone("phone-walk-known", Walk, Offset) }.and("calibrated before"),
        Variant { name: "phone-walk-spikes".into(), ..walk() }.with_spikes(0.01).and("1 % spikes"),
        Variant { name: "phone-walk-poor".into(), sensors: poor, ..walk() }.and("poor gyroscope at 25 Hz"),
        phone("phone-hand-place", Tumble, Place),
        phone("phone-walk-place", Walk, Place),
        phone("phone-hand-room", Tumble, Nothing)
            .in_a_room(Vec::new())
            .about("tumbling, the place differs by 20 uT for 60 s"),
        phone("phone-walk-room", Walk, Nothing)
            .in_a_room(Vec::new())
            .about("walking, the place differs by 20 uT for 60 s"),
        phone("phone-drift", Tumble, Drift),
        phone("phone-walk-drift", Walk, Drift),
        phone("phone-planar", Planar, Nothing),
        phone("phone-still", Still, Nothing),
        charger("phone-walk-charger", None, "walking, a charger saturates x for 10 s"),
        charger("phone-walk-charger-rail", Some(FULL_SCALE_UT), "walking, the same with rail_ut set"),
    ]
}

fn charger(name: &str, rail_ut: Option<f64>, about: &str) -> Variant {
    let by = By::Offset(CHARGER_UT);
    let charged = Happening::Step { when: When::At(CHANGE_S), by, over_s: 0.0, for_s: Some(10.0) };
    let mut variant = phone(name, Motion::Walk, PhoneChange::Nothing).about(about);
    variant.sensors.magnetometer.full_scale_ut = Some(FULL_SCALE_UT);
    Variant { happens: vec![charged], rail_ut, ..variant }
}

fn one_axis() -> Vec<Variant> {
    let about = |(vertical, wobble_deg): (bool, f64)| {
        let axis = if vertical { "vertical" } else { "random" };
        let name = format!("one-axis.{axis}-{wobble_deg}");
        Variant {
            group: Group::OneAxis,
            one_axis: Some((vertical, wobble_deg)),
            ..phone(&name, Motion::Planar, PhoneChange::Nothing)
        }
        .about(&format!("{axis} axis, wobble {wobble_deg} deg"))
    };
    let wobbles = |vertical| [0.0, 0.1, 0.3, 0.6, 1.0].map(|wobble_deg| (vertical, wobble_deg));
    [true, false].into_iter().flat_map(wobbles).map(about).collect()
}

fn pauses() -> Vec<Variant> {
    let pause = |(for_s, changes): (f64, bool)| {
        let when = When::At(CHANGE_S + for_s / 2.0);
        let change = Happening::Step { when, by: By::Random(20.0, 20.0, 0.0), over_s: 0.0, for_s: None };
        let what = if changes { "changes by 20 uT" } else { "stays" };
        let name = format!("pause.{for_s}s{}", if changes { "-b" } else { "" });
        Variant {
            group: Group::Pause,
            duration_s: DURATION_S + for_s,
            pause_s: Some(for_s),
            happens: changes.then_some(change).into_iter().collect(),
            ..phone(&name, Motion::Walk, PhoneChange::Nothing)
        }
        .about(&format!("{for_s} s, b {what}"))
    };
    [0.2, 1.0, 2.0, 5.0, 20.0].into_iter().flat_map(|for_s| [(for_s, false), (for_s, true)]).map(pause).collect()
}

fn alone() -> Vec<Variant> {
    use Motion::{Stroll, Tumble};
    use PhoneChange::{Drift, Nothing, Offset, Place};
    let alone = |name: &str, motion, change| Variant {
        group: Group::Alone,
        sensors: Sensors::plain().without_gyroscope(),
        ..phone(name, motion, change)
    };
    vec![
        alone("alone.steady", Tumble, Nothing),
        alone("alone.stroll-steady", Stroll, Nothing),
        alone("alone.step", Tumble, Offset),
        alone("alone.stroll-step", Stroll, Offset),
        alone("alone.place", Tumble, Place),
        alone("alone.drift", Tumble, Drift),
    ]
}
