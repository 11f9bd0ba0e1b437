//! Phones as they are carried, with the sensors' usual errors and delays: 48 uT and a dip of 63 degrees where not said otherwise, in rooms
//! ([`Place`]), |b| of 10 to 250 uT, noise of 0.4 uT in steps of 0.15, stamps 5 ms late, a gyroscope with bias, drift, scale and axes of its own,
//! accelerations of the motion.

use super::group::Group;
use super::happening::{By, Happening, When};
use super::phones::{PhoneChange, phone};
use super::sensors::Sensors;
use super::variant::{DeviceKind, Place, Variant};
use crate::motion::Motion::{self, Call, Drive, DriveHand, Game, Look, Mixed, Pocket, Table, Text};
use crate::simulate::Noise;
use magcomp::nalgebra::Vector3;

/// The usual length of a stream, and when the device changes, s.
const DURATION_S: f64 = 80.0;
const CHANGE_S: f64 = 40.0;
/// How long the usual change takes, s: a cover put on.
const PUT_ON_S: f64 = 0.2;
/// Its random part in each element of M.
const SOFT: f64 = 0.02;

pub(super) fn variants() -> Vec<Variant> {
    [latitudes(), steps(), motions(), places(), sensors(), faults(), vec![half_hour()]].concat()
}

pub(super) fn carried(
    group: Group,
    name: &str,
    about: &str,
    motion: Motion,
    duration_s: f64,
    happens: Vec<Happening>,
) -> Variant {
    let is_uneven = happens.iter().any(|it| matches!(it, Happening::Uneven(..)));
    Variant {
        about: about.to_owned(),
        group,
        duration_s,
        earth: (48.0, 63.0),
        place: if is_uneven { Place::Even } else { Place::of(motion) },
        device: DeviceKind::Carried(10.0, 250.0),
        change_s: CHANGE_S,
        happens,
        sensors: Sensors::carried(),
        ..phone(name, motion, PhoneChange::Nothing)
    }
}

/// The device changes by so much.
fn change(at_s: f64, size_ut: f64, soft: f64) -> Happening {
    let by = By::Random(size_ut, size_ut, soft);
    Happening::Step { when: When::At(at_s), by, over_s: PUT_ON_S, for_s: None }
}

pub(super) const BOTH: [(Motion, &str); 2] = [(Text, "walk"), (Game, "game")];

fn latitudes() -> Vec<Variant> {
    let earths = [(23, -45), (33, 0), (40, 45), (55, 75), (60, -75), (58, 85), (65, -85)]
        .map(|(f, dip)| (f64::from(f), f64::from(dip)));
    let one = |earth: (f64, f64), (motion, way): (Motion, &str)| {
        let (strength_ut, dip_deg) = earth;
        let name = format!("latitude.{strength_ut}ut{dip_deg}-{way}");
        let about = format!("{way}, {strength_ut} uT, dip {dip_deg} deg, b steps by 20 uT");
        let happens = vec![change(CHANGE_S, 20.0, SOFT)];
        Variant { earth, ..carried(Group::Latitude, &name, &about, motion, DURATION_S, happens) }
    };
    earths.into_iter().flat_map(|earth| BOTH.map(|way| one(earth, way))).collect()
}

fn steps() -> Vec<Variant> {
    let walk = |name: &str, about: &str, duration_s, happens| {
        carried(Group::Steps, &format!("steps.{name}"), about, Text, duration_s, vec![happens])
    };
    let sizes = [2.0, 5.0, 10.0, 20.0, 50.0, 150.0, 600.0].into_iter();
    let mut all: Vec<Variant> = sizes
        .flat_map(|size| {
            [(0.0, "", ""), (0.04, "-m", ", M by 4 %")].map(|(soft, suffix, words)| {
                let about = format!("b steps by {size} uT{words}");
                walk(&format!("b{size}{suffix}"), &about, DURATION_S, change(CHANGE_S, size, soft))
            })
        })
        .collect();
    let held = |size_ut: f64, over_s, for_s| {
        let by = By::Random(size_ut, size_ut, SOFT);
        Happening::Step { when: When::At(CHANGE_S), by, over_s, for_s }
    };
    all.extend([3.0, 10.0, 60.0].map(|for_s| {
        let about = format!("a cover of 30 uT on, off after {for_s} s");
        walk(&format!("off{for_s}s"), &about, DURATION_S + for_s, held(30.0, PUT_ON_S, Some(for_s)))
    }));
    all.extend([3.0, 15.0].map(|over_s| {
        let about = format!("a cover of 40 uT slid on over {over_s} s");
        walk(&format!("slow{over_s}s"), &about, DURATION_S, held(40.0, over_s, None))
    }));
    all.push(walk("folio", "a folio with a magnet opened and closed", 140.0, Happening::Folio));
    all.push(charger());
    all.extend([0.02, 0.05, 0.1, 0.2].map(|rate| {
        let gone_ut = 200.0 * rate;
        let drift = Happening::Ramp { from_s: CHANGE_S, over_s: 200.0, by: By::Random(gone_ut, gone_ut, 0.0) };
        walk(&format!("drift{rate}"), &format!("b drifts by {rate} uT/s from 40 s on"), 240.0, drift)
    }));
    all.extend([0.1, 0.5].map(|hz| {
        walk(&format!("load{hz}hz"), &format!("a load of 5 uT switched, {hz} Hz"), 120.0, Happening::Load(5.0, hz))
    }));
    all.extend([50.0, 60.0].map(|hz| {
        walk(&format!("hum{hz}hz"), &format!("alternating current of 2 uT, {hz} Hz"), 100.0, Happening::Hum(2.0, hz))
    }));
    all
}

fn charger() -> Variant {
    let by = By::Random(300.0, 1000.0, 0.06);
    let charged = Happening::Step { when: When::At(CHANGE_S), by, over_s: 0.3, for_s: Some(40.0) };
    let about = "turned on the spot, a charger of 300 to 1000 uT for 40 s";
    let mut variant = carried(Group::Steps, "steps.charger", about, Look, 120.0, vec![charged]);
    variant.sensors.magnetometer.soft_limits_ut = Some(Vector3::new(1300.0, 1300.0, 2500.0));
    Variant { device: DeviceKind::Carried(10.0, 80.0), ..variant }
}

fn motions() -> Vec<Variant> {
    let ways = [
        (Text, "walk", "in the hand"),
        (Call, "call", "at the ear"),
        (Pocket, "pocket", "in a pocket"),
        (Game, "game", "in both hands"),
        (Look, "look", "turned on the spot"),
    ];
    let one = |motion, name: &str, about: &str, duration_s, happening| {
        let about = format!("{about}, b steps by 20 uT");
        carried(Group::Motion, &format!("motion.{name}"), &about, motion, duration_s, vec![happening])
    };
    let mut all = ways.map(|(motion, name, about)| one(motion, name, about, 120.0, change(50.0, 20.0, SOFT))).to_vec();
    all.push(one(Drive, "drive", "in a mount in a car", 240.0, change(100.0, 20.0, SOFT)));
    let by = By::Random(20.0, 20.0, SOFT);
    let put_on = |when| Happening::Step { when, by, over_s: PUT_ON_S, for_s: None };
    all.push(one(Table, "table", "lying on a table", 200.0, put_on(When::Lying)));
    all.push(one(Table, "table-in-hand", "picked up from a table", 200.0, put_on(When::PickedUp)));
    all
}

fn places() -> Vec<Variant> {
    let one = |name: &str, about: &str, motion, duration_s, happens| {
        carried(Group::Places, &format!("places.{name}"), about, motion, duration_s, happens)
    };
    let uneven = [2.0, 5.0, 10.0].map(|rms_ut| {
        let about = format!("the place uneven by {rms_ut} uT from 30 s on");
        one(&format!("uneven{rms_ut}"), &about, Text, 160.0, vec![Happening::Uneven(rms_ut, 30.0)])
    });
    let even = |(motion, way): (Motion, &str)| {
        let about = format!("{way}, b steps by 20 uT, the place even");
        let happens = vec![change(CHANGE_S, 20.0, SOFT)];
        let variant = one(&format!("even-{way}"), &about, motion, DURATION_S, happens);
        Variant { place: Place::Even, ..variant }
    };
    let doors = [50.0, 75.0, 100.0, 125.0].map(|at_s| Happening::Door(30.0, at_s, 2.0));
    let room = |for_s| Happening::Room(25.0, 50.0, for_s);
    let cover = By::Offset([20.0, -15.0, 10.0]);
    let covered = Happening::Step { when: When::At(60.0), by: cover, over_s: PUT_ON_S, for_s: None };
    let car = || vec![Happening::Vehicle(30.0, 30.0, 0.2)];
    (BOTH.map(even).into_iter())
        .chain(uneven)
        .chain([
            one("doors", "four steel doors of 30 uT", Text, 160.0, doors.to_vec()),
            one("room10s", "another room by 25 uT for 10 s", Text, 120.0, vec![room(10.0)]),
            one("room60s", "another room by 25 uT for 60 s", Text, 160.0, vec![room(60.0)]),
            one("room-cover", "another room for 60 s, a cover put on there", Text, 160.0, vec![room(60.0), covered]),
            one("car-mount", "in a mount, a car of 30 uT closes at 30 s", Drive, 300.0, car()),
            one("car-hand", "in a hand, a car of 30 uT closes at 30 s", DriveHand, 300.0, car()),
        ])
        .collect()
}

fn sensors() -> Vec<Variant> {
    let usual = Sensors::carried();
    let magnetic = |of: fn(&mut crate::simulate::Magnetometer)| {
        let mut sensors = usual;
        of(&mut sensors.magnetometer);
        sensors
    };
    let ideal = Sensors {
        gyro_bias_deg_s: (0.0, 0.001),
        gyro_walk_deg_s: 0.0,
        gyro_axis_scale: 0.0,
        gyro_lean_deg: 0.0,
        gyro_noise: 0.05_f64.to_radians(),
        ..usual
    };
    let late = Sensors { gyro_late_s: 0.010, ..magnetic(|sensor| sensor.late_s = 0.0) };
    let kinds = [
        ("ref", "usual sensors", usual),
        ("m25g100", "magnetometer 25 Hz, gyroscope 100", usual.at_rates(25.0, 100.0)),
        ("m50g200", "magnetometer 50 Hz, gyroscope 200", usual.at_rates(50.0, 200.0)),
        ("m100g400", "magnetometer 100 Hz, gyroscope 400", usual.at_rates(100.0, 400.0)),
        ("m200g400", "magnetometer 200 Hz, gyroscope 400", usual.at_rates(200.0, 400.0)),
        ("m200g100", "magnetometer 200 Hz, gyroscope 100", usual.at_rates(200.0, 100.0)),
        ("m25g400", "magnetometer 25 Hz, gyroscope 400", usual.at_rates(25.0, 400.0)),
        ("jitter5", "stamps that jitter by 5 ms", magnetic(|sensor| sensor.jitter_s = 0.005)),
        ("late10", "magnetometer 10 ms late", magnetic(|sensor| sensor.late_s = 0.010)),
        ("late40", "magnetometer 40 ms late", magnetic(|sensor| sensor.late_s = 0.040)),
        ("quant06", "steps of 0.6 uT", magnetic(|sensor| sensor.quantum_ut = 0.6)),
        ("missing5", "5 % of the samples missing", magnetic(|sensor| sensor.missing = 0.05)),
        ("noise02", "noise of 0.2 uT", magnetic(|sensor| sensor.noise = Noise::Ut(0.2))),
        ("noise1", "noise of 1 uT", magnetic(|sensor| sensor.noise = Noise::Ut(1.0))),
        ("gyroideal", "an ideal gyroscope", ideal),
        ("gyromis0", "the gyroscope's axes right", Sensors { gyro_lean_deg: 0.0, ..usual }),
        ("gyroscale0", "the gyroscope's scale right", Sensors { gyro_axis_scale: 0.0, ..usual }),
        ("level", "the accelerometer without bias", Sensors { accel_bias: 0.0, ..usual }),
        ("gyrolate10", "gyroscope 10 ms late", late),
        ("leaning3", "the magnetometer's axes lean by 3 deg", Sensors { leaning_deg: 3.0, ..usual }),
    ];
    let one = |(kind, about, sensors): (&str, &str, Sensors), (motion, way): (Motion, &str)| {
        let (name, about) = (format!("sensors.{kind}-{way}"), format!("{way}, {about}"));
        let happens = vec![change(CHANGE_S, 20.0, SOFT)];
        Variant { sensors, ..carried(Group::Sensors, &name, &about, motion, DURATION_S, happens) }
    };
    kinds.into_iter().flat_map(|kind| BOTH.map(|way| one(kind, way))).collect()
}

fn faults() -> Vec<Variant> {
    let usual = Sensors::carried();
    // 0.1 rad/s
    let biased_deg_s = 0.1_f64.to_degrees();
    let clipped = Sensors {
        magnetometer: crate::simulate::Magnetometer { full_scale_ut: Some(60.0), ..usual.magnetometer },
        ..usual
    };
    let kinds = [
        ("gyroflipped", "an axis of the gyroscope flipped", Sensors { gyro_axes: [1.0, -1.0, 1.0], ..usual }),
        ("gyrodead", "an axis of the gyroscope dead", Sensors { gyro_axes: [1.0, 1.0, 0.0], ..usual }),
        (
            "gyrobias",
            "gyroscope biased by 0.1 rad/s",
            Sensors { gyro_bias_deg_s: (biased_deg_s, biased_deg_s), ..usual },
        ),
        ("gyrolate200", "gyroscope 200 ms late", Sensors { gyro_late_s: 0.2, ..usual }),
        (
            "gyrostutter",
            "gyroscope silent for 0.3 s of each 2",
            Sensors { gyro_silent_s: Some((2.0, (0.3, 0.3))), ..usual },
        ),
        ("accelbias", "accelerometer biased by 0.5 m/s^2", Sensors { accel_bias: 0.5, ..usual }),
        ("clipped", "axes cut off at 60 uT, which is not told", clipped),
    ];
    let one = |(kind, about, sensors): (&str, &str, Sensors), (motion, way): (Motion, &str)| {
        let (name, about) = (format!("faults.{kind}-{way}"), format!("{way}, {about}"));
        let happens = vec![change(CHANGE_S, 20.0, SOFT)];
        let device = if kind == "clipped" { DeviceKind::Carried(10.0, 30.0) } else { DeviceKind::Carried(10.0, 250.0) };
        Variant { sensors, device, ..carried(Group::Faults, &name, &about, motion, DURATION_S, happens) }
    };
    kinds.into_iter().flat_map(|kind| BOTH.map(|way| one(kind, way))).collect()
}

fn half_hour() -> Variant {
    let happens = vec![Happening::HalfHour, Happening::Sway(4.0, 900.0)];
    let about = "rest, walking, turning over; steps, rooms, b sways by 4 uT";
    carried(Group::Long, "long.mixed30min", about, Mixed, 1800.0, happens)
}
