//! What a sample costs: the fitting part for windows of 100 and 2000 beside a direct per-sample fit, and a whole push,
//! windowed and aided.
//!
//! `cargo bench -p magcomp`; read ratios within one run, not times.

mod common;

use common::{FIELD_UT, OFFSET_UT, compensator, direct_fit, samples, stream_options, turning, warm_start};
use criterion::{Criterion, criterion_group, criterion_main};
use magcomp::nalgebra::Matrix3;
use magcomp::{Compensator, Config, MagneticSample, Moments, Residual};
use std::hint::black_box;

fn fitting(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("fitting part");
    for (name, residual) in [("eq. 10", Residual::Algebraic), ("corrected", Residual::Corrected)] {
        let options = stream_options(residual);
        for window in [100, 2000] {
            let points = samples(4000);
            let mut moments = Moments::new(OFFSET_UT, FIELD_UT);
            points[..window].iter().for_each(|point| moments.add(point));
            let mut calibration = moments.fit(&options).expect("an even window fits").calibration;
            let mut next = window;
            group.bench_function(format!("moments and iterations, {name}, window {window}"), |bencher| {
                bencher.iter(|| {
                    moments.add(&points[next % 4000]);
                    moments.remove(&points[(next + 4000 - window) % 4000]);
                    next += 1;
                    if let Ok(refined) = moments.refine(black_box(&calibration), &options) {
                        calibration = refined;
                    }
                });
            });
        }
    }
    let points = samples(2000);
    let start = warm_start(&points);
    group.bench_function("direct, eq. 10, window 2000, warm", |bencher| {
        bencher.iter(|| direct_fit(black_box(&points), start));
    });
    let cold = (Matrix3::identity() / FIELD_UT, OFFSET_UT * 1.05);
    group.bench_function("direct, eq. 10, window 2000, cold", |bencher| {
        bencher.iter(|| direct_fit(black_box(&points), cold));
    });
    group.finish();
}

fn push(criterion: &mut Criterion) {
    let mut group = criterion.benchmark_group("push");
    let points = samples(10_000);
    for window in [100, 2000] {
        let mut compensator = compensator(window);
        let mut k = 0_usize;
        let mut next = || {
            k += 1;
            MagneticSample { time_ns: k as i64 * 10_000_000, field_ut: points[k % points.len()] }
        };
        for _ in 0..8000 {
            compensator.push(next());
        }
        let reached = compensator.push(next()).window;
        group.bench_function(format!("whole push, window {window} ({reached})"), |bencher| {
            bencher.iter(|| compensator.push(black_box(next())));
        });
    }
    let stream = turning(100, 200_000);
    let mut compensator = Compensator::new(Config::default()).expect("a valid config");
    let mut next = stream.iter().cycle();
    group.bench_function("aided, with the gyroscope and accelerometer event of each sample", |bencher| {
        bencher.iter(|| {
            let (rate, up, sample) = next.next().expect("endless");
            if rate.time_ns == 10_000_000 {
                compensator.reset(); // the stream begins again
            }
            let _ = compensator.push_rotation_rate(*rate);
            let _ = compensator.push_up(*up);
            compensator.push(black_box(*sample))
        });
    });
    group.finish();
}

criterion_group! {
    name = benches;
    config = Criterion::default().without_plots().sample_size(30).measurement_time(std::time::Duration::from_secs(2));
    targets = fitting, push
}
criterion_main!(benches);
