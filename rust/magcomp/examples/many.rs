//! Many compensators at once: bytes of each, and what a sample costs, in processor time, in turns on one thread and on all cores, against one compensator
//! alone. `cargo run --release -p magcomp --example many [COUNT]`, on Linux, which tells both. The times depend on what else the machine does.

#[path = "../benches/common/mod.rs"]
#[allow(dead_code, reason = "the other examples use the rest")]
mod common;

use common::turning;
use magcomp::{Compensator, Config, MagneticSample, RotationRateSample, UpSample};
use std::hint::black_box;

const RATE_HZ: usize = 100;
/// Samples of each compensator.
const EACH: usize = 60;
/// Samples until one holds all that it ever will.
const WARM: usize = 2500;

type Stream = [(RotationRateSample, UpSample, MagneticSample)];

fn main() {
    let count: usize = std::env::args().nth(1).map_or(10_000, |count| count.parse().expect("a count"));
    let stream = turning(RATE_HZ, 2 * EACH);

    let before = resident_bytes();
    let mut many: Vec<_> = (0..count).map(|_| made()).collect();
    run(&mut many, &stream[..EACH / 2]);
    println!(
        "{count} compensators: {} bytes each, of which {} outside the heap",
        (resident_bytes() - before) / count,
        size_of::<Compensator>()
    );
    let ns_many = run(&mut many, &stream[EACH / 2..EACH]);
    println!(
        "  in turns on one thread: {:.2} times the processor time of one alone",
        ns_many / alone(&stream, EACH / 2, EACH)
    );

    let cores = std::thread::available_parallelism().expect("a number of cores").get();
    let parts = many.chunks_mut(count.div_ceil(cores));
    let times: Vec<f64> = std::thread::scope(|scope| {
        let threads: Vec<_> = parts.map(|part| scope.spawn(|| run(part, &stream[EACH..2 * EACH]))).collect();
        threads.into_iter().map(|thread| thread.join().expect("no panic")).collect()
    });
    let ns_parallel = times.iter().sum::<f64>() / times.len() as f64;
    println!("  over {} threads at once: {:.2} times, each", times.len(), ns_parallel / alone(&stream, EACH, 2 * EACH));

    let warm = count.div_ceil(20);
    let before = resident_bytes();
    run(&mut many[..warm], &turning(RATE_HZ, 2 * EACH + WARM)[2 * EACH..]);
    println!("  after {} s more: {} bytes more each", WARM / RATE_HZ, (resident_bytes() - before) / warm);
}

fn made() -> Compensator {
    Compensator::new(Config::default()).expect("a valid config")
}

/// A hundred, one after the other, over the same samples.
fn alone(stream: &Stream, from: usize, to: usize) -> f64 {
    let times = (0..100).map(|_| {
        let mut one = [made()];
        run(&mut one, &stream[..from]);
        run(&mut one, &stream[from..to])
    });
    times.sum::<f64>() / 100.0
}

/// Each sample to every compensator, then the next; ns of this thread's processor time a sample and compensator.
fn run(compensators: &mut [Compensator], stream: &Stream) -> f64 {
    let begin = processor_ns();
    for (rate, up, sample) in stream.iter().copied() {
        for compensator in &mut *compensators {
            compensator.push_rotation_rate(rate).expect("a plausible rate");
            compensator.push_up(up).expect("a plausible acceleration");
            black_box(compensator.push(sample));
        }
    }
    (processor_ns() - begin) as f64 / (stream.len() * compensators.len()) as f64
}

fn processor_ns() -> u64 {
    let text = std::fs::read_to_string("/proc/thread-self/schedstat").expect("Linux");
    text.split(' ').next().and_then(|ns| ns.parse().ok()).expect("ns on a processor")
}

fn resident_bytes() -> usize {
    let text = std::fs::read_to_string("/proc/self/status").expect("Linux");
    let line = text.lines().find(|line| line.starts_with("VmRSS:")).expect("VmRSS");
    line.split_whitespace().nth(1).and_then(|kb| kb.parse::<usize>().ok()).expect("kB") * 1024
}
