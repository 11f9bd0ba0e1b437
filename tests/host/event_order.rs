//! Events in the order of their times: the shared vectors, a direct sort of the whole stream, and what holds for any delivery.

use magcomp::nalgebra::Vector3;
use magcomp::{EventQueue, MagneticSample, RotationRateSample, SensorEvent, UpSample};
use magcomp_tests::vectors;
use proptest::prelude::*;
use serde::Deserialize;

const MS: i64 = 1_000_000;

/// An event of a sensor (0 rotation rate, 1 up, 2 magnetic) that carries its number.
fn event(sensor: usize, time_ns: i64, number: usize) -> SensorEvent {
    let value = Vector3::new(number as f64, 0.0, 0.0);
    match sensor {
        0 => SensorEvent::RotationRate(RotationRateSample { time_ns, rate_rad_s: value }),
        1 => SensorEvent::Up(UpSample { time_ns, up_m_s2: value }),
        _ => SensorEvent::Magnetic(MagneticSample { time_ns, field_ut: value }),
    }
}

fn number(event: &SensorEvent) -> usize {
    let value = match event {
        SensorEvent::RotationRate(sample) => sample.rate_rad_s,
        SensorEvent::Up(sample) => sample.up_m_s2,
        SensorEvent::Magnetic(sample) => sample.field_ut,
    };
    value.x as usize
}

/// The numbers of what goes out after each delivery, and after the flush.
fn released(hold_s: f64, deliveries: &[(usize, i64)]) -> Vec<Vec<usize>> {
    let mut queue = EventQueue::new(hold_s).unwrap();
    let mut steps: Vec<Vec<usize>> = Vec::new();
    for (k, (sensor, time_ns)) in deliveries.iter().enumerate() {
        let mut gone = Vec::new();
        queue.push(event(*sensor, *time_ns, k), |event| gone.push(number(&event)));
        steps.push(gone);
    }
    let mut gone = Vec::new();
    queue.flush(|event| gone.push(number(&event)));
    steps.push(gone);
    steps
}

#[derive(Deserialize)]
struct Vectors {
    cases: Vec<Case>,
}

#[derive(Deserialize)]
struct Case {
    name: String,
    hold_s: f64,
    deliveries: Vec<(usize, i64)>,
    released: Vec<Vec<usize>>,
}

/// Kotlin and Swift are held to the same file.
#[test]
fn deliveries_of_the_reference() {
    let cases = vectors::<Vectors>("event_order.json").cases;
    assert!(cases.len() >= 20);
    for case in cases {
        assert_eq!(released(case.hold_s, &case.deliveries), case.released, "{}", case.name);
    }
}

#[test]
fn a_hold_out_of_range_is_named() {
    for hold_s in [-0.01, 0.26, f64::NAN] {
        let error = EventQueue::new(hold_s).unwrap_err();
        assert_eq!((error.field, error.expected.as_str()), ("hold_s", "0.0 to 0.25 s"));
    }
    assert!(EventQueue::new(0.0).is_ok() && EventQueue::new(0.25).is_ok());
}

/// Each sensor: its period, where it begins, and how late each event is, ms. A later event never overtakes one of its own sensor.
fn sensors(latest_ms: i64) -> impl Strategy<Value = Vec<(i64, i64, Vec<i64>)>> {
    let sensor = (2_i64..40, 0_i64..40, prop::collection::vec(0..latest_ms, 60));
    prop::collection::vec(sensor, 3)
}

fn deliveries(sensors: &[(i64, i64, Vec<i64>)]) -> Vec<(usize, i64)> {
    let mut all = Vec::new();
    for (sensor, (period, begin, late)) in sensors.iter().enumerate() {
        let mut delivered = 0;
        for (k, late) in late.iter().enumerate() {
            let time = begin + period * k as i64;
            delivered = delivered.max(time + late);
            all.push((delivered, all.len(), (sensor, time * MS)));
        }
    }
    // of what comes at one moment, in an order that has nothing to do with its times
    all.sort_by_key(|(delivered, number, _)| (*delivered, number * 7919 % 101, *number));
    let mut in_order: Vec<(usize, i64)> = all.iter().map(|(_, _, event)| *event).collect();
    // but each sensor's own events in the order of theirs
    for sensor in 0..3 {
        let mut times: Vec<i64> = in_order.iter().filter(|event| event.0 == sensor).map(|event| event.1).collect();
        times.sort_unstable();
        let places = in_order.iter_mut().filter(|event| event.0 == sensor);
        places.zip(times).for_each(|(event, time)| event.1 = time);
    }
    in_order
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_comes_less_than_the_hold_late_goes_out_sorted(sensors in sensors(90)) {
        let deliveries = deliveries(&sensors);
        let order: Vec<usize> = released(0.09, &deliveries).concat();
        let mut sorted: Vec<usize> = (0..deliveries.len()).collect();
        sorted.sort_by_key(|k| (deliveries[*k].1, deliveries[*k].0, *k));
        prop_assert_eq!(order, sorted);
    }

    #[test]
    fn none_is_lost_and_none_waits_longer_than_the_hold(
        deliveries in prop::collection::vec((0_usize..3, prop_oneof![0_i64..400 * MS, any::<i64>()]), 0..600),
        hold_ms in 0_i64..250,
    ) {
        let steps = released(hold_ms as f64 * 1e-3, &deliveries);
        let mut all = steps.concat();
        all.sort_unstable();
        prop_assert_eq!(all, (0..deliveries.len()).collect::<Vec<_>>());
        let mut waiting = Vec::new();
        for (k, gone) in steps.iter().take(deliveries.len()).enumerate() {
            waiting.push(k);
            waiting.retain(|k| !gone.contains(k));
            prop_assert!(waiting.len() < 256);
            // the newest of the sensor that spoke is at least this one
            let longest = waiting.iter().map(|waits| deliveries[k].1.saturating_sub(deliveries[*waits].1)).max();
            prop_assert!(longest.is_none_or(|longest| longest < hold_ms.max(1) * MS));
        }
    }
}
