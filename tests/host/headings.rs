//! Headings against facts worked out by hand and against attitudes known in the world frame.

use magcomp::nalgebra::{Rotation3, Unit, UnitQuaternion, Vector3};
use magcomp::{
    Compensator, Config, HeadedAxis, HeadingAid, HeadingConfig, HeadingSample, NorthReference, ReferenceAxis,
    ScreenRotation, heading,
};
use magcomp_tests::{Phone, REF, Random, calibration, vectors};
use serde::Deserialize;
use std::collections::BTreeMap;

const AXES: [ReferenceAxis; 3] = [ReferenceAxis::TopEdge, ReferenceAxis::Camera, ReferenceAxis::Auto];
const ROTATIONS: [ScreenRotation; 4] =
    [ScreenRotation::Deg0, ScreenRotation::Deg90, ScreenRotation::Deg180, ScreenRotation::Deg270];

#[derive(Deserialize)]
struct Headings {
    facts: Vec<Fact>,
    attitudes: Vec<Attitude>,
}

#[derive(Deserialize)]
struct Fact {
    name: String,
    screen_rotation_deg: usize,
    field_ut: Vector3<f64>,
    up: Vector3<f64>,
    inclination_deg: f64,
    #[serde(flatten)]
    expected: Expected,
}

#[derive(Deserialize)]
struct Attitude {
    field_ut: Vector3<f64>,
    up: Vector3<f64>,
    inclination_deg: f64,
    screen_rotations: BTreeMap<usize, Expected>,
}

#[derive(Deserialize)]
struct Expected {
    top_edge_deg: Option<f64>,
    camera_deg: Option<f64>,
    auto_deg: Option<f64>,
}

impl Expected {
    fn of(&self, axis: ReferenceAxis) -> Option<f64> {
        match axis {
            ReferenceAxis::TopEdge => self.top_edge_deg,
            ReferenceAxis::Camera => self.camera_deg,
            ReferenceAxis::Auto => self.auto_deg,
        }
    }
}

/// Smallest angle between two bearings, degrees.
fn apart(a: f64, b: f64) -> f64 {
    let d = (a - b).rem_euclid(360.0);
    d.min(360.0 - d)
}

#[test]
fn facts_worked_out_by_hand() {
    for fact in vectors::<Headings>("headings.json").facts {
        let rotation = ROTATIONS[fact.screen_rotation_deg / 90];
        for axis in AXES {
            // up of any length, field of any strength
            for (field_scale, up_scale) in [(1.0, 1.0), (0.5, 9.81), (3.0, 1e-3)] {
                let found = heading(&(fact.field_ut * field_scale), &(fact.up * up_scale), axis, rotation);
                match (found, fact.expected.of(axis)) {
                    (None, None) => {}
                    (Some(found), Some(expected)) => {
                        let off = apart(found.heading_deg, expected);
                        assert!(off < 1e-12, "{}, {axis:?}: {} not {expected}", fact.name, found.heading_deg);
                        assert!((0.0..360.0).contains(&found.heading_deg));
                        assert!((found.inclination_deg.unwrap() - fact.inclination_deg).abs() < 1e-12, "{}", fact.name);
                    }
                    (found, expected) => panic!("{}, {axis:?}: {found:?}, expected {expected:?}", fact.name),
                }
            }
        }
    }
}

#[test]
fn attitudes_of_the_reference() {
    let mut compared = 0;
    for attitude in vectors::<Headings>("headings.json").attitudes {
        for (rotation_deg, expected) in &attitude.screen_rotations {
            for axis in AXES {
                let Some(expected) = expected.of(axis) else { continue };
                let found = heading(&attitude.field_ut, &attitude.up, axis, ROTATIONS[rotation_deg / 90]);
                let found = found.expect("the axis is not vertical");
                let off = apart(found.heading_deg, expected);
                assert!(off < 1e-9, "{axis:?}, {rotation_deg}: {} not {expected}", found.heading_deg);
                assert!((found.inclination_deg.unwrap() - attitude.inclination_deg).abs() < 1e-9);
                compared += 1;
            }
        }
    }
    assert!(compared > 1000, "{compared}");
}

#[derive(Deserialize)]
struct PlatformEvents {
    inclination_deg: f64,
    cases: Vec<PlatformEvent>,
}

#[derive(Deserialize)]
struct PlatformEvent {
    name: String,
    axis: String,
    field_ut: Vector3<f64>,
    up_m_s2: Vector3<f64>,
    heading_deg: f64,
}

/// Kotlin and Swift assert the same file from the platforms' events on.
#[test]
fn attitudes_of_the_platform_events() {
    let events = vectors::<PlatformEvents>("platform_events.json");
    assert_eq!(events.cases.len(), 50);
    for case in events.cases {
        let axis = match case.axis.as_str() {
            "top_edge" => ReferenceAxis::TopEdge,
            "camera" => ReferenceAxis::Camera,
            other => panic!("{other}"),
        };
        let found =
            heading(&case.field_ut, &case.up_m_s2, axis, ScreenRotation::Deg0).expect("the axis is not vertical");
        let off = apart(found.heading_deg, case.heading_deg);
        assert!(off < 1e-9, "{}: {} not {}", case.name, found.heading_deg, case.heading_deg);
        assert!((found.inclination_deg.unwrap() - events.inclination_deg).abs() < 1e-9, "{}", case.name);
    }
}

/// The bearing of a device axis, from the attitude (device to east, north, up): (bearing, its sine to the vertical).
fn bearing(axis: ReferenceAxis, rotation: ScreenRotation, attitude: &Rotation3<f64>) -> (f64, f64) {
    let (right, top) = match rotation {
        ScreenRotation::Deg0 => ([1.0, 0.0, 0.0], [0.0, 1.0, 0.0]),
        ScreenRotation::Deg90 => ([0.0, -1.0, 0.0], [1.0, 0.0, 0.0]),
        ScreenRotation::Deg180 => ([-1.0, 0.0, 0.0], [0.0, -1.0, 0.0]),
        ScreenRotation::Deg270 => ([0.0, 1.0, 0.0], [-1.0, 0.0, 0.0]),
    };
    let (right, top) = (attitude * Vector3::from(right), attitude * Vector3::from(top));
    let camera = attitude * Vector3::new(0.0, 0.0, -1.0);
    let world = match axis {
        ReferenceAxis::TopEdge => top,
        ReferenceAxis::Camera => camera,
        ReferenceAxis::Auto => {
            // square to the right edge and level; the camera takes over from 45 deg of rise to 64 deg
            let flat = right.x.hypot(right.y);
            let share = ((right.z.abs() - 0.707) / (0.9 - 0.707)).clamp(0.0, 1.0);
            let level = if flat > 0.0 { Vector3::new(-right.y / flat, right.x / flat, 0.0) } else { Vector3::zeros() };
            level * (1.0 - share) + camera * share
        }
    };
    (world.x.atan2(world.y).to_degrees().rem_euclid(360.0), world.x.hypot(world.y))
}

/// Field and up in the device frame.
fn seen(attitude: &Rotation3<f64>, dip_deg: f64, strength_ut: f64) -> (Vector3<f64>, Vector3<f64>) {
    let (sin, cos) = dip_deg.to_radians().sin_cos();
    let back = attitude.inverse();
    (back * Vector3::new(0.0, strength_ut * cos, -strength_ut * sin), back * Vector3::z())
}

/// How far the two formulas are apart, as a share of what is allowed: 1e-9 deg; nearer to a pole than 1e-4 (of the axis
/// or the field) what the rounding of the inputs alone makes of it.
fn disagreement(attitude: &Rotation3<f64>, dip_deg: f64, strength_ut: f64) -> f64 {
    const ROUNDING_DEG: f64 = 8.0 * f64::EPSILON * 180.0 / std::f64::consts::PI;
    let (field, up) = seen(attitude, dip_deg, strength_ut);
    let mut worst = 0.0_f64;
    for rotation in ROTATIONS {
        for axis in AXES {
            let (expected, sine) = bearing(axis, rotation, attitude);
            let pole = sine.min(dip_deg.to_radians().cos());
            // within 1e-6 of a pole there is no heading; leave the border itself open
            if pole < 2e-6 {
                continue;
            }
            let found = heading(&field, &up, axis, rotation).expect("away from the poles there is a heading");
            let allowed = f64::max(1e-9, ROUNDING_DEG / pole);
            worst = worst.max(apart(found.heading_deg, expected) / allowed);
            worst = worst.max((found.inclination_deg.unwrap() - dip_deg).abs() / 1e-9);
        }
    }
    worst
}

#[test]
fn a_million_attitudes() {
    let mut random = Random::new(60);
    for k in 0..1_000_000 {
        let attitude = random.attitude().to_rotation_matrix();
        let dip_deg = random.between(-89.9, 89.9);
        let off = disagreement(&attitude, dip_deg, random.between(20.0, 70.0));
        assert!(off < 1.0, "attitude {k}: {off} of the tolerance");
    }
}

#[test]
fn attitudes_at_the_poles() {
    let mut random = Random::new(61);
    for k in 0..100_000 {
        // turn one axis of the device to the vertical, then off it by a small angle
        let axis = [Vector3::x(), Vector3::y(), Vector3::z()][k % 3];
        let vertical = if random.normal() > 0.0 { Vector3::z() } else { -Vector3::z() };
        let to = Rotation3::rotation_between(&axis, &vertical)
            .unwrap_or_else(|| Rotation3::from_axis_angle(&Unit::new_normalize(axis.yzx()), std::f64::consts::PI));
        let yaw = Rotation3::from_axis_angle(&Vector3::z_axis(), random.between(-3.1, 3.1));
        let off_deg = 10.0_f64.powf(random.between(-4.0, 1.0));
        let off = Rotation3::from_axis_angle(&Unit::new_normalize(random.direction()), off_deg.to_radians());
        // and the field near the magnetic poles, every other time
        let dip_deg = if k % 2 == 0 { 60.0 } else { 90.0 - 10.0_f64.powf(random.between(-3.0, 0.0)) };
        let off = disagreement(&(yaw * off * to), dip_deg * random.normal().signum(), 50.0);
        assert!(off < 1.0, "attitude {k}: {off} of the tolerance");
    }
}

#[test]
fn nothing_is_said_where_there_is_no_heading() {
    let (north, up) = (Vector3::new(0.0, 20.0, -40.0), Vector3::z());
    for rotation in ROTATIONS {
        for axis in AXES {
            for (field, up) in [
                (Vector3::z() * 50.0, up),
                (Vector3::z() * -50.0, up),
                (Vector3::zeros(), up),
                (north, Vector3::zeros()),
                (Vector3::new(f64::NAN, 20.0, 0.0), up),
                (north, Vector3::new(0.0, f64::INFINITY, 1.0)),
            ] {
                assert_eq!(heading(&field, &up, axis, rotation), None, "{field} {up} {axis:?}");
            }
        }
        assert_eq!(heading(&north, &up, ReferenceAxis::Camera, rotation), None);
    }
    assert_eq!(heading(&north, &Vector3::y(), ReferenceAxis::TopEdge, ScreenRotation::Deg0), None);
}

/// Yaw clockwise from north, then the top edge up, then the right edge down.
fn attitude(yaw_deg: f64, pitch_deg: f64, roll_deg: f64) -> Rotation3<f64> {
    let turn = |axis, deg: f64| Rotation3::from_axis_angle(&axis, deg.to_radians());
    turn(Vector3::z_axis(), -yaw_deg) * turn(Vector3::x_axis(), pitch_deg) * turn(Vector3::y_axis(), roll_deg)
}

fn automatic(attitude: &Rotation3<f64>, rotation: ScreenRotation) -> f64 {
    let (field, up) = seen(attitude, 63.0, 48.0);
    heading(&field, &up, ReferenceAxis::Auto, rotation).expect("the automatic axis is level").heading_deg
}

/// Flat, upright, overhead, upside down and back: the automatic heading stays that of the person.
#[test]
fn the_automatic_axis_does_not_flip_with_pitch() {
    for yaw in [0.0, 77.0, 180.0, 301.5] {
        for step in 0..=3600 {
            let found = automatic(&attitude(yaw, f64::from(step) * 0.1, 0.0), ScreenRotation::Deg0);
            assert!(apart(found, yaw) < 1e-9, "yaw {yaw}, pitch {}: {found}", f64::from(step) * 0.1);
        }
    }
}

#[test]
fn the_automatic_axis_does_not_jump_with_roll() {
    // the right edge level to 40 deg up or down, any pitch: a twentieth of a degree never moves it by a degree
    for roll in [-40.0, -20.0, 10.0, 40.0] {
        let mut latest = automatic(&attitude(120.0, 0.0, roll), ScreenRotation::Deg0);
        for step in 1..=7200 {
            let now = automatic(&attitude(120.0, f64::from(step) * 0.05, roll), ScreenRotation::Deg0);
            assert!(apart(now, latest) < 1.0, "roll {roll}, pitch {}: {latest} to {now}", f64::from(step) * 0.05);
            latest = now;
        }
    }
}

/// An upright phone turned in the plane of its screen, the content locked, from one landscape to the other: the camera
/// keeps looking the same way, and the heading stays.
#[test]
fn the_automatic_axis_follows_the_camera_into_landscape() {
    for yaw in [10.0, 190.0] {
        for step in -950..=950 {
            let in_plane = Rotation3::from_axis_angle(&Vector3::z_axis(), (f64::from(step) * 0.1).to_radians());
            let upright = attitude(yaw, 90.0, 0.0) * in_plane;
            let found = automatic(&upright, ScreenRotation::Deg0);
            assert!(apart(found, yaw) < 1e-6, "yaw {yaw}, turned by {}: {found}", f64::from(step) * 0.1);
        }
    }
}

#[test]
fn turning_the_content_with_the_device_changes_nothing() {
    let mut random = Random::new(62);
    for _ in 0..10_000 {
        let base = random.attitude();
        for (k, rotation) in ROTATIONS.into_iter().enumerate() {
            // the device turned counter-clockwise by 90 deg k, its content clockwise
            let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), k as f64 * std::f64::consts::FRAC_PI_2);
            let (field, up) = seen(&(base * turn).to_rotation_matrix(), 60.0, 50.0);
            let (plain_field, plain_up) = seen(&base.to_rotation_matrix(), 60.0, 50.0);
            for axis in AXES {
                let turned = heading(&field, &up, axis, rotation).expect("a heading").heading_deg;
                let plain =
                    heading(&plain_field, &plain_up, axis, ScreenRotation::Deg0).expect("a heading").heading_deg;
                assert!(apart(turned, plain) < 1e-9, "{axis:?}, {rotation:?}: {turned} {plain}");
            }
        }
    }
}

/// What one reading knows is the heading of every frame: a compensator of its own for each says the same.
#[test]
fn a_reading_has_the_heading_of_every_frame() {
    let truth = calibration(&REF.map(|v| v * 0.5 + 0.5 * f64::from(u8::from(v > 0.9))), 48.0);
    let declination_deg = Some(3.0);
    let mut all: Vec<_> = AXES
        .into_iter()
        .flat_map(|axis| ROTATIONS.map(|screen_rotation| (axis, screen_rotation)))
        .map(|(axis, screen_rotation)| {
            let heading = HeadingConfig { axis, screen_rotation, declination_deg, ..HeadingConfig::default() };
            let config = Config { heading, ..Config::default() };
            (axis, screen_rotation, Phone::new(1, truth), Compensator::new(config).unwrap())
        })
        .collect();
    let (mut headings, mut by_outside, mut nothing) = (0, 0, 0);
    for k in 0..3000 {
        let mut first = None;
        for (axis, rotation, phone, compensator) in &mut all {
            let sample = phone.sample(compensator);
            let (expected, pointing) = compensator.push_pointing(sample);
            if k > 2000 && k % 100 == 0 {
                let (time_ns, heading_deg) = (phone.time_ns, phone.heading_deg());
                let axis = HeadedAxis::Device(Vector3::y());
                let reference = NorthReference::Magnetic;
                compensator
                    .push_heading(HeadingSample { time_ns, heading_deg, sigma_deg: 1.0, reference, axis })
                    .unwrap();
            }
            assert_eq!(pointing.is_some(), expected.attitude.is_some());
            let pointing = *first.get_or_insert(pointing);
            let Some(pointing) = pointing else {
                nothing += 1;
                continue;
            };
            by_outside += i32::from(compensator.heading_aid() == Some(HeadingAid::Leads));
            let near = |a: Option<f64>, b: Option<f64>| (a.unwrap() - b.unwrap()).abs() < 1e-6 * b.unwrap().max(1.0);
            assert!(near(pointing.attitude().sigma_deg, expected.attitude.unwrap().sigma_deg));
            let (found, expected) = (pointing.heading(*axis, *rotation), expected.heading);
            assert_eq!(found.is_some(), expected.is_some());
            let (Some(found), Some(expected)) = (found, expected) else { continue };
            assert!(apart(found.heading_deg, expected.heading_deg) < 1e-7, "{found:?} {expected:?}");
            assert!(apart(found.true_heading_deg.unwrap(), expected.true_heading_deg.unwrap()) < 1e-7);
            assert!(
                near(found.heading_sigma_deg, expected.heading_sigma_deg),
                "{found:?} {expected:?} {axis:?} {rotation:?}"
            );
            headings += 1;
        }
    }
    assert!(headings > 20_000 && by_outside > 1000 && nothing > 0, "{headings} {by_outside} {nothing}");
}
