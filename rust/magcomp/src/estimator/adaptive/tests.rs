//! Each rule can be switched off, and each is seen to work on a stream that is made for it.

use super::{Adaptive, Tuning};
use crate::reading::{EventKind, Status};
use nalgebra::{Matrix3, Rotation3, Vector3};

const PERIOD_S: f64 = 0.02;
const MAGNET_UT: Vector3<f64> = Vector3::new(20.0, -15.0, 12.0);
const FIELD_UT: Vector3<f64> = Vector3::new(0.0, 22.0, -42.0);

/// splitmix64 and Box-Muller.
struct Random(u64);

impl Random {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64
    }

    fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }

    fn vector(&mut self, sd: f64) -> Vector3<f64> {
        Vector3::new(self.normal(), self.normal(), self.normal()) * sd
    }
}

/// A device in a hand, of which everything may be changed at any time.
struct World {
    random: Random,
    time_s: f64,
    attitude: Rotation3<f64>,
    /// How fast it turns about each of its axes, rad/s.
    turns: Vector3<f64>,
    soft_iron: Matrix3<f64>,
    hard_iron_ut: Vector3<f64>,
    drift_ut_s: Vector3<f64>,
    /// The place's field beside the Earth's: steady, and how uneven.
    place_ut: Vector3<f64>,
    uneven_ut: f64,
    local_ut: Vector3<f64>,
    /// Noise of the magnetometer that lasts for 3 s.
    wander_ut: f64,
    wandered_ut: Vector3<f64>,
    /// How far the hand tilts the vertical, and the accelerometer's bias.
    tilt_rad: f64,
    tilted: Vector3<f64>,
    bias_m_s2: Vector3<f64>,
    has_gravity: bool,
    /// The magnetometer repeats one value.
    repeats: bool,
    raw_ut: Vector3<f64>,
    zero_ns: i64,
    adaptive: Adaptive,
    found: Found,
}

/// What came of it since it was last asked.
#[derive(Clone, Copy, Debug, Default)]
struct Found {
    samples: f64,
    answered: f64,
    square_rad2: f64,
    z2: f64,
    b_square_ut2: f64,
    steps: u32,
    suspect: f64,
}

impl Found {
    /// Root mean square; a right angle where nothing is told.
    fn off_deg(&self) -> f64 {
        let silent_deg2 = 90.0 * 90.0 * (self.samples - self.answered);
        ((self.square_rad2 * 1f64.to_degrees().powi(2) + silent_deg2) / self.samples).sqrt()
    }

    fn off_ut(&self) -> f64 {
        (self.b_square_ut2 / self.answered).sqrt()
    }
}

impl World {
    fn new(tuning: Tuning, seed: u64) -> Self {
        let mut random = Random(seed);
        let (e, x) = (random.vector(0.03), random.vector(0.02));
        Self {
            time_s: 0.0,
            attitude: Rotation3::new(random.vector(1.0)),
            turns: Vector3::repeat(1.0),
            soft_iron: Matrix3::new(1.0 + e.x, x.x, x.y, x.x, 1.0 + e.y, x.z, x.y, x.z, 1.0 + e.z),
            hard_iron_ut: random.vector(40.0),
            random,
            drift_ut_s: Vector3::zeros(),
            place_ut: Vector3::zeros(),
            uneven_ut: 0.0,
            local_ut: Vector3::zeros(),
            wander_ut: 0.0,
            wandered_ut: Vector3::zeros(),
            tilt_rad: 0.0,
            tilted: Vector3::zeros(),
            bias_m_s2: Vector3::zeros(),
            has_gravity: true,
            repeats: false,
            raw_ut: Vector3::zeros(),
            zero_ns: 0,
            adaptive: Adaptive::new(tuning, None, None),
            found: Found::default(),
        }
    }

    fn run(&mut self, seconds: f64) -> Found {
        self.found = Found::default();
        for _ in 0..(seconds / PERIOD_S) as usize {
            self.sample();
        }
        self.found
    }

    fn sample(&mut self) {
        let t = self.time_s;
        let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin() + 0.3);
        self.attitude *= Rotation3::new(rate.component_mul(&self.turns) * PERIOD_S);
        self.time_s += PERIOD_S;
        self.hard_iron_ut += self.drift_ut_s * PERIOD_S;
        let mut lasts = |x: &mut Vector3<f64>, sd: f64, time_s: f64| {
            let phi = (-PERIOD_S / time_s).exp();
            *x = *x * phi + self.random.vector(sd * (1.0 - phi * phi).sqrt());
        };
        lasts(&mut self.local_ut, self.uneven_ut, 0.5);
        lasts(&mut self.wandered_ut, self.wander_ut, 3.0);
        lasts(&mut self.tilted, self.tilt_rad, 0.5);
        let to_device = self.attitude.inverse();
        let field_ut = to_device * (FIELD_UT + self.place_ut + self.local_ut);
        if !self.repeats {
            self.raw_ut = self.soft_iron * field_ut + self.hard_iron_ut + self.wandered_ut + self.random.vector(0.5);
        }
        let up = Rotation3::new(self.tilted) * Vector3::z() * 9.81;
        let up = to_device * up + self.bias_m_s2 + self.random.vector(0.05);
        let before = self.adaptive.decision.event;
        let time_ns = (self.time_s * 1e9).round() as i64 + self.zero_ns;
        let up = self.has_gravity.then_some(up);
        let (status, answer) = self.adaptive.push(time_ns, &self.raw_ut, up);
        let found = &mut self.found;
        found.samples += 1.0;
        found.suspect += f64::from(u8::from(matches!(status, Status::Suspect { .. })));
        if let Some(event) = answer.event.filter(|_| answer.event != before) {
            found.steps += u32::from(event.kind != EventKind::PlaceChanged);
        }
        if let (Some(c), Some(p), Some(known)) =
            (answer.field_ut, answer.field_covariance_ut2, self.adaptive.calibration())
        {
            found.answered += 1.0;
            found.square_rad2 += c.angle(&field_ut).powi(2);
            let across = c / c.norm() - field_ut / field_ut.norm();
            found.z2 += across.norm_squared() * c.norm_squared() / (p.trace() - (c.dot(&(p * c)) / c.norm_squared()));
            let off = known.hard_iron_ut() - self.hard_iron_ut;
            found.b_square_ut2 += off.norm_squared();
        }
    }
}

fn without(rule: &str) -> Tuning {
    let mut tuning = Tuning::USED;
    assert!(rule.is_empty() || tuning.switch_off(rule), "{rule}");
    tuning
}

/// A rule, a stream that is made for it, and a figure of what comes of it; of five the mean without the best and the worst is at most the first number
/// with the rule, and at least the second without.
type Case = (&'static str, fn(&mut World) -> f64, f64, f64);

const CASES: [Case; 12] = [
    ("unevenness", in_an_uneven_place, 1.0, 1.5),
    ("tilting", in_a_hand_that_tilts, 8.0, 16.0),
    ("stays", in_a_rest_of_noise_that_lasts, 2.5, 4.0),
    ("looks", while_b_drifts, 1.2, 4.0),
    ("moves", while_b_drifts, 1.2, 2.5),
    ("moves", after_a_slow_slide, 1.0, 5.0),
    ("leap", after_a_magnet, 4.0, 20.0),
    ("gradual", after_a_magnet_that_slides, 30.0, 40.0),
    ("recall", while_a_magnet_is_taken_away_again, 5.0, 9.0),
    ("spread", told_of_turns_about_one_axis, 8.0, 14.0),
    ("twins", after_turns_about_one_axis, 20.0, 28.0),
    ("accelerometer_bias", suspected_with_a_biased_accelerometer, 0.1, 0.3),
];

fn in_an_uneven_place(world: &mut World) -> f64 {
    world.uneven_ut = 4.0;
    world.run(10.0);
    let found = world.run(20.0);
    found.z2 / found.answered
}

fn in_a_hand_that_tilts(world: &mut World) -> f64 {
    world.tilt_rad = 0.25;
    world.run(10.0);
    world.run(15.0).off_deg()
}

fn in_a_rest_of_noise_that_lasts(world: &mut World) -> f64 {
    world.wander_ut = 0.5;
    world.run(6.0);
    world.turns *= 0.0;
    world.run(30.0).off_deg()
}

fn while_b_drifts(world: &mut World) -> f64 {
    world.run(10.0);
    world.drift_ut_s = Vector3::new(0.6, -0.4, 0.5);
    world.run(10.0);
    world.run(10.0).off_ut()
}

fn after_a_slow_slide(world: &mut World) -> f64 {
    world.run(10.0);
    world.drift_ut_s = Vector3::new(15.0, -10.0, 10.0);
    world.run(3.0);
    world.drift_ut_s *= 0.0;
    world.run(3.0);
    world.run(5.0).off_ut()
}

fn after_a_magnet(world: &mut World) -> f64 {
    world.run(10.0);
    world.hard_iron_ut += 4.0 * MAGNET_UT;
    world.run(1.5);
    world.run(8.0).off_ut()
}

fn after_a_magnet_that_slides(world: &mut World) -> f64 {
    world.run(10.0);
    world.drift_ut_s = Vector3::new(200.0, -150.0, 100.0);
    world.run(0.3);
    world.drift_ut_s *= 0.0;
    world.run(1.5);
    world.run(8.0).off_ut()
}

fn while_a_magnet_is_taken_away_again(world: &mut World) -> f64 {
    world.run(20.0);
    world.hard_iron_ut += MAGNET_UT;
    world.run(30.0);
    world.turns *= 0.2;
    world.run(2.0);
    world.hard_iron_ut -= MAGNET_UT;
    world.run(4.0).off_ut()
}

/// What is wrong in what is told; silence is right.
fn told_of_turns_about_one_axis(world: &mut World) -> f64 {
    world.turns = Vector3::new(0.01, 0.01, 1.5);
    let found = world.run(10.0);
    (found.square_rad2 / found.samples).sqrt().to_degrees()
}

fn after_turns_about_one_axis(world: &mut World) -> f64 {
    world.turns = Vector3::new(0.01, 0.01, 1.5);
    world.run(10.0);
    world.run(20.0).off_ut()
}

fn suspected_with_a_biased_accelerometer(world: &mut World) -> f64 {
    world.bias_m_s2 = Vector3::new(0.2, -0.2, 0.3);
    world.turns = Vector3::new(0.02, 0.02, 1.5);
    world.run(10.0);
    let found = world.run(20.0);
    found.suspect / found.samples
}

#[test]
fn each_rule_is_seen_to_work_on_the_stream_that_is_made_for_it() {
    for (rule, figure, most, least) in CASES {
        let middle = |rule: &str| {
            let mut figures: Vec<f64> = (1..=5).map(|seed| figure(&mut World::new(without(rule), seed))).collect();
            figures.sort_unstable_by(f64::total_cmp);
            figures[1..4].iter().sum::<f64>() / 3.0
        };
        let (with, without) = (middle(""), middle(rule));
        assert!(with < most && without > least, "{rule}: {with} with it, {without} without");
    }
}

/// While b slides, it may be the place's field that is elsewhere: by what b has moved, the field is less sure.
#[test]
fn what_slides_counts_in_the_covariance_of_the_field() {
    let mut world = World::new(Tuning::USED, 2);
    world.run(10.0);
    let sd_ut = |world: &World| {
        let (u, answer) = (world.raw_ut / world.adaptive.unit_ut, |u| world.adaptive.answer(u));
        (answer(&u).field_covariance_ut2.expect("it is known").trace() / 3.0).sqrt()
    };
    let rests_ut = sd_ut(&world);
    world.drift_ut_s = Vector3::new(15.0, -10.0, 10.0);
    let slid_ut =
        |world: &World| world.adaptive.bank.best().map_or(0.0, |it| it.slid().norm() * world.adaptive.unit_ut);
    let most = (0..30)
        .map(|_| {
            world.run(0.1);
            (slid_ut(&world), sd_ut(&world))
        })
        .fold((0.0, 0.0), |a, b| if b.0 > a.0 { b } else { a });
    assert!(most.0 > 20.0 && most.1 > 0.5 * most.0 && rests_ut < 3.0, "{most:?}, {rests_ut} at rest");
    world.drift_ut_s *= 0.0;
    world.run(8.0);
    assert!(slid_ut(&world) == 0.0 && sd_ut(&world) < 3.0, "{} {}", slid_ut(&world), sd_ut(&world));
}

/// Combinations of rules, none of which may break another: by turns, and every second one.
#[test]
fn any_combination_of_rules_gives_finite_answers() {
    let names: Vec<&str> = Tuning::MECHANISMS.iter().map(|it| it.name).collect();
    for shift in 0..names.len() {
        let mut tuning = Tuning::USED;
        let is_off = |k: &usize| (k + shift) % names.len() < names.len() / 2 || (k * 7 + shift).is_multiple_of(3);
        (0..names.len()).filter(is_off).for_each(|k| assert!(tuning.switch_off(names[k])));
        let mut world = World::new(tuning, shift as u64 + 1);
        world.run(6.0);
        world.hard_iron_ut += MAGNET_UT;
        world.uneven_ut = 3.0;
        let found = world.run(3.0);
        assert!(found.square_rad2.is_finite() && found.b_square_ut2.is_finite(), "{shift}");
        is_sound(&world.adaptive);
    }
}

/// Every number of the state.
fn is_sound(adaptive: &Adaptive) {
    let text = format!("{adaptive:?}");
    let numbers =
        text.split(|c: char| !(c.is_alphanumeric() || "+-.".contains(c))).filter_map(|it| it.parse::<f64>().ok());
    let mut count = 0;
    for number in numbers {
        assert!(!number.is_nan() && !number.is_subnormal(), "{number:e}");
        count += 1;
    }
    assert!(count > 3_000, "{count}");
}

/// Numbers that die out would become subnormal, which processors are slow with.
#[test]
fn an_hour_at_rest_leaves_no_subnormal_number() {
    for values_repeat in [false, true] {
        let mut world = World::new(Tuning::USED, 3);
        world.run(8.0);
        world.turns *= 0.0;
        world.repeats = values_repeat;
        world.run(3600.0);
        is_sound(&world.adaptive);
    }
}

/// Where gravity is gone what is known of a tilt dies out while the device moves on.
#[test]
fn what_dies_out_is_nothing_in_the_end() {
    let mut world = World::new(Tuning::USED, 4);
    world.run(8.0);
    world.has_gravity = false;
    world.run(900.0);
    is_sound(&world.adaptive);
}

/// The clock's zero is anywhere: a stream says the same before it.
#[test]
fn times_below_zero_are_times_like_any_other() {
    let readings = |zero_s: f64| {
        let mut world = World::new(Tuning::USED, 5);
        world.zero_ns = (zero_s * 1e9) as i64;
        world.run(6.0);
        world.turns *= 0.0;
        world.run(3.0);
        world.turns = Vector3::repeat(1.0);
        world.hard_iron_ut += MAGNET_UT;
        let found = world.run(4.0);
        is_sound(&world.adaptive);
        (found.square_rad2, found.z2, found.steps)
    };
    assert_eq!(readings(-300.0), readings(0.0));
    assert_eq!(readings(-5.0), readings(0.0));
}
