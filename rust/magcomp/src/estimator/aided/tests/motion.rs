//! Up: what motion does to it, and what is told of that.

use nalgebra::{Matrix3, Vector3};

use super::super::motion::Motion;
use super::super::state::Filter;
use super::super::step::Known;
use super::super::tuning::Tuning;
use super::simulator::Random;
use crate::math::turn::Turn;

/// A bias known to 0.001 rad/s.
fn known() -> Known {
    Known { bias_sd_rad_s: 0.001, ..Known::of(&Filter::default()) }
}

#[test]
fn a_turn_on_an_arm_does_not_tilt_up() {
    // 4 m/s^2 towards the axis, always the same in the device: gravity and motion together lean by 22 deg
    let (rate, dt_s) = (Vector3::z() * 3.0, 0.01);
    let felt = Vector3::new(4.0, 0.0, 9.80665);
    let r = Turn::by(&-(rate * dt_s)).rotation;
    let tuning = Tuning::default();
    let mut motion = Motion::new();
    let mut worst_deg: f64 = 0.0;
    for k in 0..4_000 {
        motion.carry_up(&r, Some(felt), &known(), 0.0, dt_s, &tuning);
        if k > 2_000 {
            worst_deg = worst_deg.max(motion.up.unwrap().angle(&Vector3::z()).to_degrees());
        }
    }
    assert!(worst_deg < 2.0, "{worst_deg} deg");
    // 22 deg of motion over a memory of 5 s
    let sigma_deg = motion.tilt_rad2(motion.common_rad2(f64::INFINITY, &tuning), &tuning).sqrt().to_degrees();
    assert!((0.4..2.0).contains(&sigma_deg), "{sigma_deg} deg");
}

#[test]
fn a_car_that_speeds_up_and_brakes_is_told() {
    // 2 m/s^2 forwards, then backwards, 10 s each; and the same in 0.1 s, which averages out
    let tuning = Tuning::default();
    let [slow, quick] = [10.0, 0.1].map(|half_s| {
        let mut motion = Motion::new();
        let (mut squares, mut variances) = (0.0, 0.0);
        for k in 0..12_000 {
            let t_s = f64::from(k) * 0.01;
            let felt = Vector3::new(if (t_s / half_s) as i64 % 2 == 0 { 2.0 } else { -2.0 }, 0.0, 9.80665);
            motion.carry_up(&Matrix3::identity(), Some(felt), &known(), 0.0, 0.01, &tuning);
            if t_s > 20.0 {
                // the angle is that about both horizontal axes
                squares += 0.5 * motion.up.unwrap().angle(&Vector3::z()).powi(2) / 1e4;
                variances += motion.tilt_rad2(motion.common_rad2(f64::INFINITY, &tuning), &tuning) / 1e4;
            }
        }
        [squares, variances].map(|v| f64::sqrt(v).to_degrees())
    });
    // what alternates as regularly averages out better than what sigma allows for
    assert!((1.0..2.5).contains(&slow[0]) && (1.0..4.0).contains(&(slow[1] / slow[0])), "{slow:?} deg");
    // 0.001 rad/s of bias over 5 s
    assert!(quick[0] < 0.1 && (0.25..0.4).contains(&quick[1]), "{quick:?} deg");
}

#[test]
fn an_up_that_is_wrong_is_no_motion() {
    // a hand shakes the device; then the gyroscope has tilted `up` by 20 deg, and it rests
    let tuning = Tuning::default();
    let mut motion = Motion::new();
    let see = |motion: &mut Motion, felt| {
        motion.carry_up(&Matrix3::identity(), Some(felt), &known(), 0.0, 0.01, &tuning);
    };
    for k in 0..6_000 {
        see(&mut motion, Vector3::new(0.5 * (f64::from(k) * 0.1).sin(), 0.0, 9.80665));
    }
    let gravity = Turn::by(&Vector3::x_axis().scale(20_f64.to_radians())).rotation * Vector3::z() * 9.80665;
    for _ in 0..3_000 {
        see(&mut motion, gravity);
    }
    // 30 s at rest; where it counted as motion, 7 deg were left
    let off_deg = motion.up.unwrap().angle(&gravity).to_degrees();
    assert!((1.0..4.5).contains(&off_deg), "{off_deg} deg");
}

#[test]
fn a_slow_gyroscope_is_believed_for_less_long() {
    // a car again; between its events the gyroscope loses 2 deg a root of a second, or nothing
    let tuning = Tuning::default();
    let [none, much] = [0.0, 2_f64.to_radians().powi(2)].map(|rad2_s| {
        let mut motion = Motion::new();
        for k in 0..12_000 {
            let felt = Vector3::new(if (k / 500) % 2 == 0 { 2.0 } else { -2.0 }, 0.0, 9.80665);
            motion.carry_up(&Matrix3::identity(), Some(felt), &known(), rad2_s * 0.01, 0.01, &tuning);
        }
        // then it turns by 10 deg, and the gyroscope does not tell
        let gravity = Turn::by(&Vector3::x_axis().scale(10_f64.to_radians())).rotation * Vector3::z() * 9.80665;
        let sigma_deg = motion.tilt_rad2(motion.common_rad2(f64::INFINITY, &tuning), &tuning).sqrt().to_degrees();
        for k in 12_000..13_000 {
            let felt = gravity + Vector3::x() * if (k / 500) % 2 == 0 { 2.0 } else { -2.0 };
            motion.carry_up(&Matrix3::identity(), Some(felt), &known(), rad2_s * 0.01, 0.01, &tuning);
        }
        (sigma_deg, motion.up.unwrap().angle(&gravity).to_degrees())
    });
    let (wider, nearer) = (much.0 / none.0, much.1 / none.1);
    assert!((1.5..4.0).contains(&wider) && (0.4..0.8).contains(&nearer), "{none:?}, {much:?} deg");
}

/// A gyroscope that loses so much a root of a second carries `up` and m; an accelerometer with motion draws the one, samples the other. Variance of `up` about
/// a horizontal axis: what it is, and what is said of it.
fn carried_beside_a_field(follow: bool, seed: u64) -> [f64; 2] {
    let tuning = Tuning { follow, ..Tuning::default() };
    let (mut random, mut motion) = (Random(seed), Motion::new());
    let (dt_s, walk_rad, hand_m_s2, seen_rad) = (0.01_f64, 1_f64.to_radians(), 2.0, 0.1);
    let gain = walk_rad * dt_s.sqrt() / seen_rad;
    // at this gain its variance is walk_rad^2 dt / (2 gain)
    let field_rad2 = walk_rad.powi(2) * dt_s / (2.0 * gain);
    let (mut m, mut squares, mut variances) = (Vector3::y(), 0.0, 0.0);
    for k in 0..60_000 {
        let lost = random.vector(walk_rad * dt_s.sqrt());
        let r = Turn::by(&lost).rotation;
        m = r * m;
        let felt = Vector3::z() * 9.80665 + random.vector(hand_m_s2);
        motion.carry_up(&r, Some(felt), &known(), walk_rad.powi(2) * dt_s, dt_s, &tuning);
        let turn = m.cross(&(Vector3::y() + random.vector(seen_rad))) * gain;
        m = (m + turn.cross(&m)).normalize();
        motion.follow(&turn, field_rad2, &tuning);
        if k > 6_000 {
            let up = motion.up.unwrap();
            // about the axis along which m says something
            squares += up.y.powi(2);
            variances += motion.tilt_rad2(motion.common_rad2(field_rad2, &tuning), &tuning);
        }
    }
    [squares, variances].map(|sum| sum / 54_000.0)
}

#[test]
fn an_up_that_follows_the_field_is_nearer_and_says_so() {
    let mean = |follow| {
        let [is, said] = [1, 2, 3, 4]
            .map(|seed| carried_beside_a_field(follow, seed))
            .into_iter()
            .fold([0.0; 2], |sum, it| [sum[0] + it[0] / 4.0, sum[1] + it[1] / 4.0]);
        (is, said)
    };
    let (alone, follows) = (mean(false), mean(true));
    for (is, said) in [alone, follows] {
        assert!((0.5..1.0).contains(&(is / said)), "{is} {said}");
    }
    assert!(follows.0 < 0.85 * alone.0 && follows.1 < 0.85 * alone.1, "{alone:?} {follows:?}");
}
