//! Pairing of sensor events by time.

use super::{EventRejection, InertialPairing};
use nalgebra::{UnitQuaternion, Vector3};

const MS: i64 = 1_000_000;

fn rate(t_s: f64) -> Vector3<f64> {
    Vector3::new((3.0 * t_s).sin(), 0.5 * (2.0 * t_s).cos(), 0.2 * t_s)
}

/// How `rate` turns a device between two times.
fn turned(from_s: f64, to_s: f64) -> UnitQuaternion<f64> {
    let steps = ((to_s - from_s) / 1e-4).ceil();
    let step_s = (to_s - from_s) / steps;
    (0..steps as usize).fold(UnitQuaternion::identity(), |q, k| {
        q * UnitQuaternion::from_scaled_axis(rate(from_s + (k as f64 + 0.5) * step_s) * step_s)
    })
}

/// Feeds gyroscope events of one rate and magnetometer samples of another, `late_ns` late; the product of all increments
/// must be the whole rotation.
fn total_error(gyro_ns: i64, magnetometer_ns: i64, late_ns: i64, jitter_ns: i64) -> f64 {
    let mut pairing = InertialPairing::default();
    let (mut next_gyro, mut product) = (0, UnitQuaternion::identity());
    let mut first = None;
    let mut last = 0;
    let mut state = 1u64;
    for k in 0..200 {
        let time = 500 * MS + k * magnetometer_ns;
        while next_gyro + late_ns <= time {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let jitter = (state >> 33) as i64 % (jitter_ns + 1);
            let at = next_gyro + jitter;
            pairing.push_rotation_rate(at, rate(at as f64 * 1e-9)).unwrap();
            next_gyro += gyro_ns;
        }
        let paired = pairing.pair(time);
        if let Some(rotation) = paired.rotation {
            if first.is_none() {
                first = Some(time - magnetometer_ns);
            }
            product *= UnitQuaternion::from_scaled_axis(rotation.increment_rad);
            last = time;
        }
    }
    product.angle_to(&turned(first.unwrap() as f64 * 1e-9, last as f64 * 1e-9))
}

#[test]
fn no_rotation_is_lost_at_any_pair_of_rates() {
    for (gyro_hz, magnetometer_hz) in [(400, 50), (400, 10), (100, 100), (25, 100), (25, 25), (200, 15), (10, 50)] {
        let (gyro_ns, magnetometer_ns) = (1_000_000_000 / gyro_hz, 1_000_000_000 / magnetometer_hz);
        let error = total_error(gyro_ns, magnetometer_ns, 0, 0);
        let one_step = gyro_ns as f64 * 1e-9;
        assert!(error < 2e-3 + 3.0 * one_step * one_step, "{gyro_hz} and {magnetometer_hz} Hz: {error}");
        let error = total_error(gyro_ns, magnetometer_ns, 30 * MS, gyro_ns / 3);
        assert!(error < 6e-3 + 0.15 * (one_step + 0.03), "{gyro_hz} and {magnetometer_hz} Hz, late, jitter: {error}");
    }
}

#[test]
fn a_constant_rate_is_exact_even_when_events_come_late() {
    let mut pairing = InertialPairing::default();
    let w = Vector3::new(0.3, -0.2, 0.1);
    pairing.push_rotation_rate(0, w).unwrap();
    pairing.pair(5 * MS);
    for k in 1..100 {
        let paired = pairing.pair(5 * MS + k * 20 * MS).rotation.unwrap();
        assert!((paired.increment_rad - w * 0.02).norm() < 1e-12, "{k}");
        // the events of that interval arrive only now
        for j in 0..4 {
            pairing.push_rotation_rate((k - 1) * 20 * MS + j * 5 * MS + MS, w).unwrap();
        }
    }
}

#[test]
fn bad_events_are_refused_by_name_and_change_nothing() {
    let mut pairing = InertialPairing::default();
    for k in 0..10 {
        pairing.push_rotation_rate(k * 10 * MS, Vector3::new(0.1, 0.0, 0.0)).unwrap();
        pairing.push_up(k * 10 * MS, Vector3::new(0.0, 0.0, 9.8)).unwrap();
    }
    pairing.pair(55 * MS);
    let before = pairing.clone();
    let good = Vector3::new(0.1, 0.0, 0.0);
    let refusals = [
        (pairing.push_rotation_rate(60 * MS, Vector3::new(f64::NAN, 0.0, 0.0)), EventRejection::NotFinite),
        (pairing.push_rotation_rate(61 * MS, Vector3::new(1e6, 0.0, 0.0)), EventRejection::OutOfRange),
        (pairing.push_rotation_rate(60 * MS, good), EventRejection::Duplicate),
        (pairing.push_rotation_rate(20 * MS, good), EventRejection::Late),
        (pairing.push_rotation_rate(i64::MIN, good), EventRejection::Late),
        (pairing.push_rotation_rate(i64::MAX, good), EventRejection::Ahead),
        (pairing.push_up(20 * MS, good), EventRejection::Late),
        (pairing.push_up(90 * MS, good), EventRejection::Duplicate),
        (pairing.push_up(95 * MS, Vector3::new(0.0, f64::INFINITY, 0.0)), EventRejection::NotFinite),
    ];
    for (result, reason) in refusals {
        assert_eq!(result, Err(reason));
    }
    assert_eq!(pairing, before);
    // time running backwards at the magnetometer gives nothing and changes nothing
    assert_eq!(pairing.pair(55 * MS).rotation, None);
    assert_eq!(pairing, before);
}

#[test]
fn events_out_of_order_find_their_place() {
    let run = |order: &[i64]| {
        let mut pairing = InertialPairing::default();
        pairing.push_rotation_rate(0, rate(0.0)).unwrap();
        pairing.push_up(0, rate(0.0)).unwrap();
        pairing.pair(5 * MS);
        for &k in order {
            pairing.push_rotation_rate(k * 10 * MS, rate(k as f64 * 0.01)).unwrap();
            pairing.push_up(k * 10 * MS, rate(k as f64 * 0.01)).unwrap();
        }
        pairing.pair(42 * MS)
    };
    assert_eq!(run(&[1, 2, 3, 4, 5]), run(&[3, 1, 5, 2, 4]));
}

#[test]
fn a_gap_breaks_the_chain_once_and_absence_is_told() {
    let mut pairing = InertialPairing::default();
    let w = Vector3::new(0.0, 0.0, 1.0);
    let mut told = Vec::new();
    for k in 0..400 {
        let time = k * 10 * MS;
        if !(100..200).contains(&k) {
            pairing.push_rotation_rate(time, w).unwrap();
            pairing.push_up(time, w * 9.8).unwrap();
        }
        let paired = pairing.pair(time);
        told.push((paired.rotation.is_some(), paired.up_m_s2.is_some()));
        if let Some(rotation) = paired.rotation {
            assert!((rotation.increment_rad - w * 0.01).norm() < 1e-9, "{k}");
        }
    }
    // held for the stale limit, then absent, then back after one sample
    assert_eq!(told[120], (true, true));
    assert_eq!(told[150], (false, false));
    assert_eq!(told[200], (false, true));
    assert_eq!(told[201], (true, true));
}

#[test]
fn a_flood_of_events_is_folded_and_nothing_is_lost() {
    let mut pairing = InertialPairing::default();
    pairing.push_rotation_rate(0, rate(0.0)).unwrap();
    pairing.pair(0);
    for k in 1..=1_000 {
        pairing.push_rotation_rate(k * MS, rate(k as f64 * 1e-3)).unwrap();
    }
    let got = pairing.pair(1_000 * MS).rotation.unwrap().increment_rad;
    assert!(UnitQuaternion::from_scaled_axis(got).angle_to(&turned(0.0, 1.0)) < 1e-5, "{got}");
}

#[test]
fn a_batch_of_events_ahead_of_its_samples_is_spread_over_them() {
    let mut pairing = InertialPairing::default();
    let (mut product, mut truth) = (UnitQuaternion::identity(), UnitQuaternion::identity());
    let (mut count, mut worst) = (0, 0.0_f64);
    for batch in 0..20 {
        let times = (1..=50).map(|k| (batch * 50 + k) * 10 * MS);
        for time in times.clone() {
            pairing.push_rotation_rate(time, rate(time as f64 * 1e-9)).unwrap();
        }
        for time in times {
            let Some(rotation) = pairing.pair(time).rotation else { continue };
            product *= UnitQuaternion::from_scaled_axis(rotation.increment_rad);
            truth *= turned((time - 10 * MS) as f64 * 1e-9, time as f64 * 1e-9);
            (count, worst) = (count + 1, worst.max(product.angle_to(&truth)));
        }
    }
    assert!(count > 950, "{count} of 1000 samples");
    // a third of a second taken as even, of a rate that changes by 1 rad/s in it
    assert!(worst < 0.06 && product.angle_to(&truth) < 0.01, "{worst} rad");
}

#[test]
fn a_pause_of_the_magnetometer_is_bridged_by_a_gyroscope_with_errors() {
    let (bias, scale) = (Vector3::new(0.05, -0.08, 0.02), Vector3::new(0.01, -0.02, 0.015));
    let reading = |t_s: f64| (rate(t_s) + bias).component_div(&scale.map(|s| 1.0 - s));
    let mut pairing = InertialPairing::default();
    pairing.assume(bias, scale);
    pairing.push_rotation_rate(0, reading(0.0)).unwrap();
    pairing.pair(0);
    for k in 1..=500 {
        pairing.push_rotation_rate(k * 10 * MS, reading(k as f64 * 0.01)).unwrap();
    }
    let got = pairing.pair(5_000 * MS).rotation.unwrap().increment_rad;
    let theta = got - got.component_mul(&scale) - bias * 5.0;
    let error = UnitQuaternion::from_scaled_axis(theta).angle_to(&turned(0.0, 5.0));
    assert!(error < 1e-3, "{error} rad");
}

/// Mean of what is reported per sample, over the q T^3 / 12 of a rate that wanders with density q.
fn reported_share(period_ns: i64, mut rate: impl FnMut() -> Vector3<f64>, density: f64) -> f64 {
    let mut pairing = InertialPairing::default();
    let (count, mut sum) = (4_000, 0.0);
    for k in 0..count {
        pairing.push_rotation_rate(k * period_ns, rate()).unwrap();
        sum += pairing.pair(k * period_ns).rotation.map_or(0.0, |rotation| rotation.variance_rad2);
    }
    let period_s = period_ns as f64 * 1e-9;
    sum / count as f64 / (density * period_s.powi(3) / 12.0)
}

#[test]
fn what_a_wandering_rate_did_between_its_events_is_counted_and_smooth_motion_is_not() {
    for (period_ns, period_s) in [(40 * MS, 0.04_f64), (10 * MS, 0.01)] {
        let mut state = 1u64;
        // uniform, variance 1
        let mut draw = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            ((state >> 11) as f64 / (1u64 << 53) as f64 - 0.5) * 12.0_f64.sqrt()
        };
        let density = 0.6_f64;
        let mut now = Vector3::zeros();
        let wandering = || {
            now = now * 0.999 + Vector3::new(draw(), draw(), draw()) * (density * period_s).sqrt();
            now
        };
        let share = reported_share(period_ns, wandering, density);
        assert!((0.7..1.6).contains(&share), "{share} at {period_ns} ns");
        let mut k = 0;
        let smooth = || {
            k += 1;
            rate(f64::from(k) * period_s)
        };
        let share = reported_share(period_ns, smooth, density);
        assert!(share < 1e-3, "{share} of a smooth motion at {period_ns} ns");
    }
}

/// By hand: the rate changes by 1, -1, 3 and 4 rad/s^2, so its slope by -2, 4 and 1. -d d' T / 3 is 0.8 / 3 and then -0.4 / 3, and is remembered for half a
/// second.
#[test]
fn the_wander_between_events_is_that_of_the_changes_of_slope() {
    let mut pairing = InertialPairing::default();
    let mut told = |k: i64, x: f64| {
        pairing.push_rotation_rate(k * 100 * MS, Vector3::new(x, 0.0, 0.0)).unwrap();
        pairing.pair(k * 100 * MS).rotation.map(|rotation| rotation.variance_rad2)
    };
    assert_eq!([told(0, 0.0), told(1, 0.1), told(2, 0.0)], [None, Some(0.0), Some(0.0)]);
    let learns = 0.2;
    let first = learns * 0.8 / 3.0;
    let next = first + learns * (-0.4 / 3.0 - first);
    assert!((told(3, 0.3).unwrap() / (first * 1e-3 / 12.0) - 1.0).abs() < 1e-9);
    assert!((told(4, 0.7).unwrap() / (next * 1e-3 / 12.0) - 1.0).abs() < 1e-9);
    // slopes of 7 and 14, which are 3 and 7 more: the mean falls below 0 and counts as 0
    assert_eq!((told(5, 1.4), told(6, 2.8)), (Some(0.0), Some(0.0)));
}

/// After a hole the slope, and how it changed, begin anew: three events tell nothing, as at the beginning.
#[test]
fn a_hole_says_nothing_of_how_the_rate_wanders() {
    let told = |hole_ms: i64| {
        let mut pairing = InertialPairing::default();
        let mut all = Vec::new();
        for (time_ms, x) in
            [(0, 0.0), (100, 0.1), (200, 0.0), (200 + hole_ms, 0.5), (300 + hole_ms, 0.1), (400 + hole_ms, 0.6)]
        {
            pairing.push_rotation_rate(time_ms * MS, Vector3::new(x, 0.0, 0.0)).unwrap();
            all.push(pairing.pair(time_ms * MS).rotation.map(|rotation| rotation.variance_rad2));
        }
        all
    };
    assert!(told(250)[3].unwrap() > 0.0);
    assert_eq!(told(251)[3..], [None, Some(0.0), Some(0.0)]);
}

#[test]
fn a_pause_keeps_the_errors_of_the_gyroscope_and_the_time_alone() {
    let errors = |pairing: &mut InertialPairing| {
        pairing.assume(Vector3::new(0.05, -0.08, 0.02), Vector3::new(0.01, -0.02, 0.015));
    };
    let mut pairing = InertialPairing::default();
    errors(&mut pairing);
    for k in 0..10 {
        pairing.push_rotation_rate(k * 10 * MS, rate(k as f64 * 0.01)).unwrap();
        pairing.push_up(k * 10 * MS, Vector3::z()).unwrap();
    }
    pairing.pair(55 * MS);
    pairing.pause();
    let mut fresh = InertialPairing::default();
    errors(&mut fresh);
    fresh.pair(55 * MS);
    assert_eq!(pairing, fresh);
}

fn x(value: f64) -> Vector3<f64> {
    Vector3::new(value, 0.0, 0.0)
}

/// A pairing with the latest gyroscope event, and the latest sample, at 0: 1 rad/s.
fn begun() -> InertialPairing {
    let mut pairing = InertialPairing::default();
    pairing.push_rotation_rate(0, x(1.0)).unwrap();
    pairing.pair(0);
    pairing
}

/// Increment (rad) and rate (rad/s) about x of the sample at this time.
fn told(pairing: &mut InertialPairing, time_ms: i64) -> Option<(f64, f64)> {
    pairing.pair(time_ms * MS).rotation.map(|it| (it.increment_rad.x, it.rate_rad_s.x))
}

fn assert_told(told: Option<(f64, f64)>, expected: (f64, f64)) {
    let (increment, rate) = told.unwrap();
    assert!((increment - expected.0).abs() < 1e-12 && (rate - expected.1).abs() < 1e-12, "{increment} {rate}");
}

#[test]
fn between_two_events_the_rate_is_on_the_line_through_them() {
    let mut pairing = begun();
    pairing.push_rotation_rate(100 * MS, x(3.0)).unwrap();
    assert_told(told(&mut pairing, 25), (0.5 * (1.0 + 1.5) * 0.025, 1.5));
    assert_told(told(&mut pairing, 100), (0.5 * (1.5 + 3.0) * 0.075, 3.0));
}

#[test]
fn across_a_hole_the_rate_is_held_for_a_quarter_of_a_second() {
    for (hole_ms, expected) in [(250, (0.5 * (1.0 + 1.2) * 0.025, 1.2)), (251, (0.025, 1.0))] {
        let mut pairing = begun();
        pairing.push_rotation_rate(hole_ms * MS, x(3.0)).unwrap();
        assert_told(told(&mut pairing, 25), expected);
    }
    assert_told(told(&mut begun(), 250), (0.25, 1.0));
    assert_eq!(told(&mut begun(), 251), None);
}

/// 40 events from 10 to 400 ms: of them 24, until 240 ms, are folded. Until 100 ms the turn was handed out already.
#[test]
fn of_a_flood_each_sample_gets_its_share_less_what_it_has() {
    let flooded = |rate: fn(i64) -> f64| {
        let mut pairing = begun();
        assert_told(told(&mut pairing, 100), (0.1, 1.0));
        (1..=40).for_each(|k| pairing.push_rotation_rate(k * 10 * MS, x(rate(k))).unwrap());
        pairing
    };
    let mut even = flooded(|_| 1.0);
    assert_told(told(&mut even, 120), (0.02, 1.0));
    assert_told(told(&mut even, 130), (0.01, 1.0));
    assert_told(told(&mut even, 240), (0.11, 1.0));
    let mut wandering = flooded(|k| 1.0 + 0.1 * (k % 3 - 1) as f64);
    let all_rad2 = wandering.gathered_rad2;
    let mut variance = |time_ms: i64| wandering.pair(time_ms * MS).rotation.unwrap().variance_rad2 / all_rad2;
    // of 140 ms
    for (time_ms, share) in [(120, 20.0 / 140.0), (170, 50.0 / 140.0), (240, 70.0 / 140.0)] {
        assert!((variance(time_ms) - share).abs() < 1e-9, "{time_ms}");
    }
}

#[test]
fn a_flood_behind_a_hole_tells_nothing() {
    let mut pairing = begun();
    (30..=60).for_each(|k| pairing.push_rotation_rate(k * 10 * MS, x(1.0)).unwrap());
    assert_eq!(told(&mut pairing, 200), None);
}

#[test]
fn up_between_two_events_is_on_the_line_through_them_unless_they_are_far_apart() {
    for (next_ms, expected) in [(100, 0.5), (250, 0.2), (251, 0.0)] {
        let mut pairing = InertialPairing::default();
        pairing.push_up(0, Vector3::new(0.0, 0.0, 10.0)).unwrap();
        pairing.push_up(next_ms * MS, Vector3::new(2.0, 0.0, 10.0)).unwrap();
        let up = pairing.pair(25 * MS).up_m_s2.unwrap();
        assert!((up - Vector3::new(expected, 0.0, 10.0)).norm() < 1e-12, "{next_ms}: {up}");
    }
}

#[test]
fn the_limits_of_what_is_taken_are_inside() {
    let mut pairing = begun();
    assert_eq!(pairing.push_rotation_rate(10 * MS, x(60.0)), Ok(()));
    assert_eq!(pairing.push_rotation_rate(20 * MS, x(-60.1)), Err(EventRejection::OutOfRange));
    assert_eq!(pairing.push_up(10 * MS, x(-200.0)), Ok(()));
    assert_eq!(pairing.push_up(20 * MS, x(200.1)), Err(EventRejection::OutOfRange));
    assert_eq!(pairing.push_rotation_rate(10_000 * MS, x(1.0)), Ok(()));
    assert_eq!(pairing.push_rotation_rate(10_001 * MS, x(1.0)), Err(EventRejection::Ahead));
}

#[test]
fn a_full_ring_refuses_what_is_older_than_all_and_names_a_duplicate() {
    let mut pairing = InertialPairing::default();
    (10..26).for_each(|k| pairing.push_rotation_rate(k * 10 * MS, x(1.0)).unwrap());
    assert_eq!(pairing.push_rotation_rate(50 * MS, x(1.0)), Err(EventRejection::Late));
    assert_eq!(pairing.push_rotation_rate(100 * MS, x(1.0)), Err(EventRejection::Duplicate));
}

#[test]
fn an_event_far_before_the_others_says_that_they_were_stamped_ahead() {
    for (ahead_ms, held) in [(250, 2), (251, 1), (1000, 1)] {
        let mut pairing = InertialPairing::default();
        pairing.push_rotation_rate(ahead_ms * MS, x(5.0)).unwrap();
        pairing.push_rotation_rate(0, x(1.0)).unwrap();
        assert_eq!(pairing.rates.len(), held, "{ahead_ms}");
    }
}
