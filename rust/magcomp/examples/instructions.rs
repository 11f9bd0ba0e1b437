//! Work to count instructions of: `tests/instructions.sh` runs it under valgrind with two counts and takes the difference.
//!
//! `instructions CASE COUNT`, CASE one of: fit-100 fit-2000 direct-2000 push-100 push-2000; or `instructions CASE COUNT RATE_HZ`, of: aided adaptive
//! windowed constant vqf. `instructions events COUNT RATE_HZ` prints the events of the latter for other languages, as c/examples/stream.c reads them.

#[path = "../benches/common/mod.rs"]
mod common;

use common::{FIELD_UT, OFFSET_UT, compensator, direct_fit, samples, stream_options, turning, warm_start};
use magcomp::nalgebra::Vector3;
use magcomp::{Compensator, Config, MagneticSample, Method, Moments, Residual};
use std::hint::black_box;
use vqf_rs::VQF;

fn main() {
    let arguments: Vec<String> = std::env::args().collect();
    let (Some(case), Some(count)) = (arguments.get(1), arguments.get(2).and_then(|count| count.parse().ok())) else {
        eprintln!(
            "usage: instructions fit-100|fit-2000|direct-2000|push-100|push-2000 COUNT, or aided|adaptive|windowed|constant|vqf|events COUNT RATE_HZ"
        );
        std::process::exit(2);
    };
    let rate_hz = arguments.get(3).and_then(|rate| rate.parse().ok()).unwrap_or(100);
    match case.as_str() {
        "fit-100" => fit(100, count),
        "fit-2000" => fit(2000, count),
        "push-100" => push(100, count),
        "push-2000" => push(2000, count),
        "aided" => hand_held(Method::Auto, rate_hz, count),
        "adaptive" => hand_held(Method::Adaptive, rate_hz, count),
        "windowed" => hand_held(Method::Windowed, rate_hz, count),
        "constant" => hand_held(Method::Constant, rate_hz, count),
        "events" => events(rate_hz, count),
        "vqf" => vqf(rate_hz, count),
        _ => direct(count),
    }
}

fn fit(window: usize, count: usize) {
    let points = samples(4000);
    let options = stream_options(Residual::Corrected);
    let mut moments = Moments::new(OFFSET_UT, FIELD_UT);
    points[..window].iter().for_each(|point| moments.add(point));
    let mut calibration = moments.fit(&options).expect("an even window fits").calibration;
    for next in window..window + count {
        moments.add(&points[next % 4000]);
        moments.remove(&points[next - window]);
        calibration = moments.refine(black_box(&calibration), &options).expect("an even window fits");
    }
    black_box(calibration);
}

fn push(window: usize, count: usize) {
    let points = samples(10_000);
    let mut compensator = compensator(window);
    for k in 0..7000 + count {
        let sample = MagneticSample { time_ns: k as i64 * 10_000_000, field_ut: points[k % points.len()] };
        black_box(compensator.push(sample));
    }
}

fn hand_held(method: Method, rate_hz: usize, count: usize) {
    #[allow(clippy::field_reassign_with_default, reason = "outside its crate a config can't be written as one literal")]
    let config = {
        let mut config = Config::default();
        config.method = method;
        config
    };
    let mut compensator = Compensator::new(config).expect("a valid config");
    // made whole whatever the count is, so that its own cost is not in the difference of two counts
    let stream = turning(rate_hz, 80 * rate_hz);
    for (rate, up, sample) in stream[..30 * rate_hz + count].iter().copied() {
        compensator.push_rotation_rate(rate).expect("a plausible rate");
        compensator.push_up(up).expect("a plausible acceleration");
        black_box(compensator.push(sample));
    }
}

/// Those of `hand_held`.
fn events(rate_hz: usize, count: usize) {
    for (rate, up, sample) in &turning(rate_hz, 80 * rate_hz)[..30 * rate_hz + count] {
        let line = |sensor, time_ns, v: &Vector3<f64>| println!("{sensor} {time_ns} {} {} {}", v.x, v.y, v.z);
        line('g', rate.time_ns, &rate.rate_rad_s);
        line('a', up.time_ns, &up.up_m_s2);
        line('m', sample.time_ns, &sample.field_ut);
    }
}

/// VQF on the same stream, for comparison.
fn vqf(rate_hz: usize, count: usize) {
    let dt_s = 1.0 / rate_hz as f64;
    let mut filter = VQF::new(dt_s, Some(dt_s), Some(dt_s), None);
    for (rate, up, sample) in turning(rate_hz, 80 * rate_hz)[..30 * rate_hz + count].iter().copied() {
        filter.update(rate.rate_rad_s.into(), up.up_m_s2.into(), Some(sample.field_ut.into()));
        black_box(filter.quat_9d());
    }
}

fn direct(count: usize) {
    let points = samples(2000);
    let start = warm_start(&points);
    for _ in 0..count {
        black_box(direct_fit(black_box(&points), start));
    }
}
