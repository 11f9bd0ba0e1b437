//! What a sample costs during an hour on a table: each minute against the first, so that what dies out and grows slow (subnormal numbers) or piles up shows.
//! `cargo run --release -p magcomp --example rest`. Of each minute the median of its seconds, which another process seldom disturbs; read ratios, not times.

#[path = "../benches/common/mod.rs"]
#[allow(dead_code, reason = "the other examples use the rest")]
mod common;

use common::{normal, turning};
use magcomp::nalgebra::Vector3;
use magcomp::{Compensator, Config};
use std::hint::black_box;
use std::time::Instant;

const RATE_HZ: usize = 100;
/// In a hand beforehand.
const TURNED_S: usize = 30;

fn main() {
    println!("| sensors at rest | last minute | dearest minute |");
    println!("|---|---|---|");
    for (name, has_gyroscope, noise) in [
        ("all three", true, 1.0),
        ("all three, without noise", true, 0.0),
        ("no gyroscope", false, 1.0),
        ("no gyroscope, without noise", false, 0.0),
    ] {
        let minutes = hour(has_gyroscope, noise);
        let dearest = minutes.iter().copied().fold(0.0, f64::max);
        println!("| {name} | {:.2} | {:.2} |", minutes[59] / minutes[0], dearest / minutes[0]);
    }
}

/// Of each minute at rest what a sample with its events costs, any unit.
fn hour(has_gyroscope: bool, noise: f64) -> Vec<f64> {
    let mut compensator = Compensator::new(Config::default()).expect("a valid config");
    let mut push = |(rate, up, sample)| {
        if has_gyroscope {
            compensator.push_rotation_rate(rate).expect("a plausible rate");
        }
        compensator.push_up(up).expect("a plausible acceleration");
        black_box(compensator.push(sample));
    };
    let turned = turning(RATE_HZ, TURNED_S * RATE_HZ);
    turned.iter().copied().for_each(&mut push);
    let (mut rate, mut up, mut sample) = turned[turned.len() - 1];
    let (up_m_s2, field_ut) = (up.up_m_s2, sample.field_ut);
    let mut normal = normal();
    let mut about = |mean: Vector3<f64>, sd: f64| mean + Vector3::new(normal(), normal(), normal()) * (sd * noise);
    let mut second = || {
        let mut samples = Vec::with_capacity(RATE_HZ);
        for _ in 0..RATE_HZ {
            sample.time_ns += 1_000_000_000 / RATE_HZ as i64;
            (rate.time_ns, up.time_ns) = (sample.time_ns, sample.time_ns);
            (rate.rate_rad_s, up.up_m_s2) = (about(Vector3::new(0.01, -0.02, 0.015), 0.003), about(up_m_s2, 0.05));
            sample.field_ut = about(field_ut, 0.5);
            samples.push((rate, up, sample));
        }
        let begin = Instant::now();
        samples.into_iter().for_each(&mut push);
        begin.elapsed().as_secs_f64()
    };
    let mut minute = || {
        let mut seconds: Vec<f64> = (0..60).map(|_| second()).collect();
        seconds.sort_by(f64::total_cmp);
        seconds[30]
    };
    (0..60).map(|_| minute()).collect()
}
