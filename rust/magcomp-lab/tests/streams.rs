//! Streams as phones deliver them: other rates for every sensor, jitter, gaps, a gyroscope that comes and goes.

use magcomp::nalgebra::Vector3;
use magcomp::{Compensator, Config, HeadingConfig, Reading, SensorMode};
use magcomp_lab::catalogue::find;
use magcomp_lab::random::{Purpose, Random};
use magcomp_lab::simulate::Simulation;
use magcomp_recordings::recording;
use magcomp_replay::{Ignore, replay};

/// Samples a second of the stream that others are picked from.
const FINE_HZ: f64 = 1000.0;

/// One of `fine`'s events every 1 / `rate_hz`, each early or late by up to a quarter of that at random.
fn picked<T: Clone>(fine: &[T], rate_hz: f64, random: &mut Random) -> Vec<T> {
    let period = FINE_HZ / rate_hz;
    let count = (fine.len() as f64 / period) as usize;
    // rounded by less than the room that the jitter leaves, so that times still increase
    let at = |k: usize, jitter: f64| (((k as f64 + 0.5 + jitter) * period) as usize).min(fine.len() - 1);
    (0..count).map(|k| fine[at(k, random.uniform(-0.25, 0.25))].clone()).collect()
}

/// A minute of tumbling, magnetometer, gyroscope and accelerometer at rates of their own.
fn stream(seed: u64, [magnetometer, gyroscope, accelerometer]: [f64; 3]) -> Simulation {
    let mut phone = find("phone-steady").unwrap().in_an_even_place();
    phone.sensors = phone.sensors.at_rate(FINE_HZ);
    phone.sensors.gyro_bias_deg_s = (1.0, 1.0);
    let fine = phone.stream(seed);
    let mut random = Random::new(seed, Purpose::Bootstrap);
    let samples: Vec<_> = fine.magnetic.iter().copied().zip(fine.truth.iter().copied()).collect();
    let (magnetic, truth) = picked(&samples, magnetometer, &mut random).into_iter().unzip();
    let rotation_rates = picked(&fine.rotation_rates, gyroscope, &mut random);
    let ups = picked(&fine.ups, accelerometer, &mut random);
    Simulation { magnetic, truth, rotation_rates, ups, rate_hz: magnetometer, ..fine }
}

/// Every event in the order of its time; what came out, and how far its direction is off, degrees.
fn run(stream: &Simulation) -> Vec<(Reading, Option<f64>)> {
    let heading = HeadingConfig { tilt_sigma_deg: 0.0, ..HeadingConfig::default() };
    let mut compensator = Compensator::new(Config { heading, ..Config::default() }).unwrap();
    let mut rates = stream.rotation_rates.iter().peekable();
    let mut ups = stream.ups.iter().peekable();
    let samples = stream.magnetic.iter().zip(&stream.truth);
    let answers = samples.map(|(sample, truth)| {
        while let Some(event) = rates.next_if(|event| event.time_ns <= sample.time_ns) {
            compensator.push_rotation_rate(*event).unwrap();
        }
        while let Some(event) = ups.next_if(|event| event.time_ns <= sample.time_ns) {
            compensator.push_up(*event).unwrap();
        }
        let reading = compensator.push(*sample);
        let finite = |v: Option<Vector3<f64>>| v.is_none_or(|v| v.iter().all(|c| c.is_finite()));
        assert!(finite(reading.field_ut) && finite(reading.filtered_field_ut), "{reading:?}");
        let sigma = reading.heading.and_then(|heading| heading.heading_sigma_deg);
        assert!(sigma.is_none_or(|sigma| (0.0..=180.0).contains(&sigma)), "{reading:?}");
        assert!(reading.field_sigma_ut.is_none_or(|sigma| sigma.is_finite() && sigma >= 0.0), "{reading:?}");
        let pointing = reading.filtered_field_ut.or(reading.field_ut);
        (reading, pointing.map(|field| field.angle(&truth.field_ut).to_degrees()))
    });
    answers.collect()
}

fn within(answers: &[(Reading, Option<f64>)], from_s: f64, to_s: f64) -> &[(Reading, Option<f64>)] {
    let at = |s: f64| answers.partition_point(|(reading, _)| (reading.time_ns as f64) < s * 1e9);
    &answers[at(from_s)..at(to_s)]
}

/// Root mean square; every one of them must have an answer.
fn rms_deg(answers: &[(Reading, Option<f64>)]) -> f64 {
    let squares: f64 = answers.iter().map(|(_, error)| error.expect("an answer").powi(2)).sum();
    (squares / answers.len() as f64).sqrt()
}

/// Mean sigma of the attitude, which does not depend on how steep an axis is, degrees; every one of them must have one.
fn sigma_deg(answers: &[(Reading, Option<f64>)]) -> f64 {
    let sigmas = answers.iter().map(|(reading, _)| reading.attitude.unwrap().sigma_deg.unwrap());
    sigmas.sum::<f64>() / answers.len() as f64
}

#[test]
fn any_rates_with_jitter() {
    for (seed, rates) in [
        [10.0, 100.0, 50.0],
        [25.0, 25.0, 25.0],
        [50.0, 200.0, 100.0],
        [100.0, 50.0, 400.0],
        [400.0, 100.0, 10.0],
        [400.0, 400.0, 400.0],
    ]
    .into_iter()
    .enumerate()
    {
        let answers = run(&stream(300 + seed as u64, rates));
        let late = within(&answers, 20.0, 60.0);
        assert!(late.iter().all(|(reading, _)| reading.mode == SensorMode::GyroscopeAndGravity), "{rates:?}");
        let rms = rms_deg(late);
        println!("{rates:?} Hz: {rms:.2} deg");
        assert!(rms < 2.0, "{rates:?}: {rms} deg");
    }
}

#[test]
fn after_a_gap_sigma_has_grown_and_motion_mends_it() {
    let mut mended = Vec::new();
    for seed in 310..315 {
        let mut stream = stream(seed, [100.0, 200.0, 100.0]);
        let gap = |time_ns: i64| (30_000_000_000..34_000_000_000).contains(&time_ns);
        let kept: Vec<bool> = stream.magnetic.iter().map(|sample| !gap(sample.time_ns)).collect();
        let (mut magnetic, mut truth) = (kept.iter(), kept.iter());
        stream.magnetic.retain(|_| *magnetic.next().unwrap());
        stream.truth.retain(|_| *truth.next().unwrap());
        stream.rotation_rates.retain(|event| !gap(event.time_ns));
        stream.ups.retain(|event| !gap(event.time_ns));
        let answers = run(&stream);
        let before = sigma_deg(within(&answers, 28.0, 30.0));
        // the first samples may come before there is a rotation or gravity again: no sigma then, within a tenth of a second
        let sigma = |(reading, _): &(Reading, Option<f64>)| reading.attitude?.sigma_deg;
        let first = within(&answers, 34.0, 34.1).iter().find_map(sigma).unwrap();
        assert!(first > before, "seed {seed}: {first} deg after the gap, {before} before");
        let (after, rms) = (sigma_deg(within(&answers, 38.0, 40.0)), rms_deg(within(&answers, 38.0, 60.0)));
        println!("seed {seed}: sigma {before:.2}, {first:.2}, {after:.2} deg; error {rms:.2} deg");
        assert!(after < first && rms < 2.0, "seed {seed}: sigma {first}, then {after} deg, error {rms} deg");
        mended.push(after / first);
    }
    let mean = mended.iter().sum::<f64>() / mended.len() as f64;
    assert!(mean < 0.8, "sigma falls to {mended:.2?} of what it was");
}

#[test]
fn a_gyroscope_that_goes_and_comes_back() {
    for seed in 320..325 {
        let mut stream = stream(seed, [100.0, 200.0, 100.0]);
        stream.rotation_rates.retain(|event| !(25_000_000_000..40_000_000_000).contains(&event.time_ns));
        let answers = run(&stream);
        let modes = |from_s, to_s, mode| within(&answers, from_s, to_s).iter().all(|(reading, _)| reading.mode == mode);
        assert!(modes(20.0, 25.0, SensorMode::GyroscopeAndGravity), "seed {seed}");
        // it may hiccup for a second before the magnetometer goes on alone, by the windowed method
        assert!(modes(26.5, 40.0, SensorMode::GravityOnly), "seed {seed}");
        let alone = within(&answers, 26.5, 40.0);
        assert!(alone.iter().all(|(reading, _)| reading.filtered_field_ut.is_none()), "seed {seed}");
        assert!(modes(41.0, 60.0, SensorMode::GyroscopeAndGravity), "seed {seed}");
        let (alone, back) = (rms_deg(alone), rms_deg(within(&answers, 44.0, 60.0)));
        println!("seed {seed}: {alone:.2} deg alone, {back:.2} deg from 4 s after its return");
        assert!(alone < 5.0 && back < 2.0, "seed {seed}: {alone} deg alone, {back} deg after it");
    }
}

/// The heading as an app shows it, by the accelerometer's own up, against the optical reference. A moved accelerometer leans:
/// without a gyroscope to carry up, that is most of the error.
#[test]
fn headings_of_a_recording_err_as_their_sigma_says() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings");
    for (name, gyroscope) in [
        ("broad_34_attached_magnet_3cm.csv.gz", true),
        ("broad_34_attached_magnet_3cm.csv.gz", false),
        ("broad_01_slow_rotation_A.csv.gz", true),
        ("broad_01_slow_rotation_A.csv.gz", false),
    ] {
        let recording = recording::read(&path.join(name)).unwrap();
        let ignore = Ignore { gyroscope: !gyroscope, accelerometer: false };
        let steps = replay(&recording, &Config::default(), ignore).unwrap();
        let mut errors: Vec<(f64, f64)> = Vec::new();
        for (row, step) in recording.rows.iter().zip(&steps).filter(|(row, _)| row.time_s > 60.0) {
            let (Some(attitude), Some(heading)) = (row.attitude, step.reading.heading) else { continue };
            let top = attitude * Vector3::y();
            // a top edge that points up has no heading
            if let Some(sigma) = heading.heading_sigma_deg.filter(|_| top.z.abs() < 0.5) {
                errors.push((heading.heading_deg - top.x.atan2(top.y).to_degrees(), sigma));
            }
        }
        // north of the reference is not magnetic north: their angle, and all errors from it
        let (sin, cos) = errors.iter().fold((0.0, 0.0), |(sin, cos), (error, _)| {
            let angle = error.to_radians();
            (sin + angle.sin(), cos + angle.cos())
        });
        let north = f64::atan2(sin, cos).to_degrees();
        let off = |error: f64| ((error - north + 180.0).rem_euclid(360.0) - 180.0).abs();
        let share = |sigmas: f64| {
            errors.iter().filter(|(error, sigma)| off(*error) < sigmas * sigma).count() as f64 / errors.len() as f64
        };
        let (one, two) = (share(1.0), share(2.0));
        println!(
            "{name}, gyroscope {gyroscope}: {} headings, {one:.2} within a sigma, {two:.2} within two",
            errors.len()
        );
        assert!(errors.len() > 1000 && one > 0.6 && two > 0.9, "{name}, gyroscope {gyroscope}: {one} {two}");
    }
}
