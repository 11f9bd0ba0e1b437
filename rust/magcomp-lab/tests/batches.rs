//! Sensors whose events come in batches: put in order by the queue they give the readings of a stream without batches, and what
//! they give without it.

use magcomp::{Compensator, Config, EventQueue, Reading, SensorEvent};
use magcomp_lab::catalogue::find;
use magcomp_lab::simulate::Simulation;

const MS: i64 = 1_000_000;

/// A minute of a phone in a hand, all sensors at 100 Hz.
fn stream(seed: u64) -> Simulation {
    let mut phone = find("phone-steady").unwrap().in_an_even_place();
    phone.sensors.gyro_bias_deg_s = (1.0, 1.0);
    phone.stream(seed)
}

/// All events with the time at which the system delivers them: at the end of the batch they fall into.
fn delivered(stream: &Simulation, inertial_ns: i64, magnetic_ns: i64) -> Vec<SensorEvent> {
    let rates = stream.rotation_rates.iter().map(|sample| SensorEvent::RotationRate(*sample));
    let ups = stream.ups.iter().map(|sample| SensorEvent::Up(*sample));
    let magnetic = stream.magnetic.iter().map(|sample| SensorEvent::Magnetic(*sample));
    let mut all: Vec<(i64, SensorEvent)> = Vec::new();
    // of one moment the magnetometer's first: the worst for those that come after it
    for (event, batch_ns) in magnetic.map(|e| (e, magnetic_ns)).chain(rates.chain(ups).map(|e| (e, inertial_ns))) {
        let at_ns = if batch_ns == 0 { event.time_ns() } else { (event.time_ns() / batch_ns + 1) * batch_ns };
        all.push((at_ns, event));
    }
    all.sort_by_key(|(at_ns, _)| *at_ns);
    all.into_iter().map(|(_, event)| event).collect()
}

/// In the order of their times, inertial ones first.
fn sorted(stream: &Simulation) -> Vec<SensorEvent> {
    let mut all = delivered(stream, 0, 0);
    all.sort_by_key(|event| (event.time_ns(), matches!(event, SensorEvent::Magnetic(_))));
    all
}

/// The readings, and how many events were refused.
#[derive(Default)]
struct Answers {
    readings: Vec<Reading>,
    refused: usize,
}

fn give(compensator: &mut Compensator, event: SensorEvent, answers: &mut Answers) {
    let taken = match event {
        SensorEvent::RotationRate(sample) => compensator.push_rotation_rate(sample),
        SensorEvent::Up(sample) => compensator.push_up(sample),
        SensorEvent::Magnetic(sample) => {
            answers.readings.push(compensator.push(sample));
            Ok(())
        }
    };
    answers.refused += usize::from(taken.is_err());
}

/// Through a queue, or as they come.
fn answers(events: Vec<SensorEvent>, hold_s: Option<f64>) -> Answers {
    let mut compensator = Compensator::new(Config::default()).unwrap();
    let mut queue = EventQueue::new(hold_s.unwrap_or(0.0)).unwrap();
    let mut answers = Answers::default();
    for event in events {
        queue.push(event, |event| give(&mut compensator, event, &mut answers));
    }
    queue.flush(|event| give(&mut compensator, event, &mut answers));
    answers
}

/// Root mean square error of the carried field from 20 s on, degrees.
fn rms_deg(stream: &Simulation, answers: &Answers) -> f64 {
    assert_eq!(stream.truth.len(), answers.readings.len());
    let errors = stream.truth.iter().zip(&answers.readings).filter(|(_, reading)| reading.time_ns > 20_000 * MS);
    let squares: Vec<f64> = errors
        .map(|(truth, reading)| {
            let field = reading.filtered_field_ut.or(reading.field_ut).expect("calibrated by then");
            field.angle(&truth.field_ut).to_degrees().powi(2)
        })
        .collect();
    (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
}

#[test]
fn batches_in_order_give_the_readings_of_a_stream_without_batches() {
    for seed in 500..503 {
        let stream = stream(seed);
        let plain = answers(sorted(&stream), None);
        assert_eq!(plain.refused, 0);
        let plain_deg = rms_deg(&stream, &plain);
        for (batch_ms, hold_s) in [(20, EventQueue::DEFAULT_HOLD_S), (100, 0.12), (200, 0.25)] {
            for magnetic_ms in [0, batch_ms] {
                let events = delivered(&stream, batch_ms * MS, magnetic_ms * MS);
                let in_order = answers(events.clone(), Some(hold_s));
                assert_eq!(in_order.refused, 0);
                assert!(
                    in_order.readings == plain.readings,
                    "seed {seed}, {batch_ms} ms, magnetometer {magnetic_ms} ms"
                );
                let as_they_come = answers(events, None);
                let deg = rms_deg(&stream, &as_they_come);
                println!(
                    "seed {seed}, batches of {batch_ms} ms, the magnetometer's of {magnetic_ms} ms: {plain_deg:.2} deg in order, \
                     {deg:.2} deg as they come, {} events refused",
                    as_they_come.refused
                );
                if batch_ms >= 100 {
                    assert!(deg > 1.5 * plain_deg, "seed {seed}: {deg} deg without the queue, {plain_deg} with it");
                }
            }
        }
    }
}
