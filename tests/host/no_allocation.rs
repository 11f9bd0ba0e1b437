//! `push` takes no memory after construction: every allocation of this thread is counted.
#![allow(unsafe_code)]

use magcomp::nalgebra::{Rotation3, Vector3};
use magcomp::{
    Compensator, Config, EventQueue, HeadingConfig, HoldReason, KeptCalibration, MagneticSample, Method,
    RotationRateSample, SensorEvent, SensorMode, Status, UpSample,
};
use magcomp_tests::{REF, Random, calibration, sample};
use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;

struct Counting;

thread_local! {
    static TAKEN: Cell<usize> = const { Cell::new(0) };
}

fn count() {
    // a thread that ends has no counter any more
    let _ = TAKEN.try_with(|taken| taken.set(taken.get() + 1));
}

// SAFETY: every call goes to the system's allocator unchanged.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: by the caller
        unsafe { System.alloc(layout) }
    }
    unsafe fn alloc_zeroed(&self, layout: Layout) -> *mut u8 {
        count();
        // SAFETY: by the caller
        unsafe { System.alloc_zeroed(layout) }
    }
    unsafe fn realloc(&self, block: *mut u8, layout: Layout, size: usize) -> *mut u8 {
        count();
        // SAFETY: by the caller
        unsafe { System.realloc(block, layout, size) }
    }
    unsafe fn dealloc(&self, block: *mut u8, layout: Layout) {
        // SAFETY: by the caller
        unsafe { System.dealloc(block, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

fn taken() -> usize {
    TAKEN.with(Cell::get)
}

#[test]
fn the_counter_counts() {
    let before = taken();
    let block = std::hint::black_box(vec![1_u8; 100]);
    assert_eq!(taken() - before, 1);
    drop(block);
}

/// From the first sample on, in every method: collecting, tracking, a step, a bad sample, one axis, rest, a gyroscope that goes
/// and comes back, another clock.
#[test]
fn push_takes_no_memory() {
    for method in [Method::Auto, Method::Aided, Method::Adaptive, Method::Windowed, Method::Constant] {
        // ours listen to gyroscope and gravity
        let turns = matches!(method, Method::Auto | Method::Aided | Method::Adaptive);
        let mut attitude = Rotation3::identity();
        let heading = HeadingConfig { declination_deg: Some(3.0), ..HeadingConfig::default() };
        let mut compensator =
            Compensator::new(Config { method, heading, ..Config::default() }).expect("a valid config");
        let (before, after) = (calibration(&REF, 40.0), calibration(&REF.map(|v| v * 1.2), 40.0));
        let mut random = Random::new(400);
        // collecting, tracking, rejected, suspect, held for uniformity, held for a refused fit or by the method
        let mut seen = [false; 6];
        let (mut headings, mut another_clock, mut alone) = (0, false, false);
        for k in 0..14_000_usize {
            // a smooth motion, seen by the gyroscope, for the methods that listen to it
            let phase = k as f64 * 0.004;
            let rate_rad_s = Vector3::new(phase.sin(), (1.7 * phase).cos(), 0.7 * (0.6 * phase).sin());
            attitude *= Rotation3::new(rate_rad_s * 0.01);
            let carried = attitude.inverse() * Vector3::new(0.0, 20.0, -34.6);
            let field = match k {
                _ if turns && k < 6000 => before.distort(&carried) + random.normal3() * 0.3,
                _ if turns => after.distort(&carried) + random.normal3() * 0.3,
                0..3000 => random.raw_one(&before, 0.5),
                3000..6000 => random.raw_one(&after, 0.5),
                6000..8000 => after.distort(&Vector3::new(20.0, 10.0, -35.0)) + random.normal3() * 0.3,
                8000..12_000 => {
                    let turn = Rotation3::from_axis_angle(&Vector3::z_axis(), k as f64 * 0.013);
                    after.distort(&(turn * Vector3::new(20.0, 10.0, -35.0))) + random.normal3() * 0.3
                }
                _ => random.raw_one(&before, 0.5),
            };
            let field = if k % 101 == 7 { Vector3::new(f64::NAN, 0.0, 0.0) } else { field };
            let MagneticSample { time_ns, field_ut } = sample(k, field);
            // another clock, that of a device that was started anew
            let time_ns = if k < 12_500 { time_ns } else { time_ns - 125_000_000_000 };
            let start = taken();
            let rate = RotationRateSample { time_ns, rate_rad_s };
            // the gyroscope goes and comes back
            let gone = (4000..5000).contains(&k);
            let turned = if gone { Ok(()) } else { compensator.push_rotation_rate(rate) };
            let up_m_s2 = attitude.inverse() * Vector3::new(0.0, 0.0, 9.8 + 1e-3 * f64::from(k as u32 % 2));
            let up = compensator.push_up(UpSample { time_ns, up_m_s2 });
            let reading = compensator.push(MagneticSample { time_ns, field_ut });
            std::hint::black_box(compensator.explain());
            assert_eq!(taken() - start, 0, "{method:?}, sample {k}: {}", reading.status);
            assert!(k >= 12_500 || turned.is_ok() && up.is_ok());
            another_clock |= k > 12_600 && !matches!(reading.status, Status::Rejected(_));
            alone |= gone && reading.mode == SensorMode::GravityOnly;
            headings += usize::from(reading.heading.is_some());
            seen[match reading.status {
                Status::Collecting(_) => 0,
                Status::Tracking => 1,
                Status::Rejected(_) => 2,
                Status::Suspect { .. } => 3,
                Status::Held(HoldReason::LowUniformity) => 4,
                Status::Held(_) => 5,
                Status::Disturbed { .. } => continue,
            }] = true;
        }
        let all = match method {
            Method::Constant => [true, false, true, true, false, true],
            Method::Windowed => [true; 6],
            Method::Auto | Method::Aided | Method::Adaptive => [true, true, true, true, false, false],
        };
        for (kind, expected) in all.into_iter().enumerate() {
            assert!(seen[kind] || !expected, "{method:?}: status {kind} never came, so it was not tested");
        }
        assert!(headings > 1000 && another_clock && alone);
        let start = taken();
        let (given, system) = (KeptCalibration::given(before, 2.0), KeptCalibration::system(before, 13.0));
        let learned = compensator.keep(0);
        for kept in [given.ok(), system.ok(), learned] {
            compensator.adopt(&kept.expect("in range, and learned"), Some(3600));
        }
        compensator.reset();
        assert_eq!(taken() - start, 0, "{method:?}: keep, adopt and reset");
    }
}

/// Nor does the push of a clone, wherever in the stream it was made.
#[test]
fn a_clones_push_takes_no_memory() {
    for method in [Method::Auto, Method::Aided, Method::Adaptive, Method::Windowed, Method::Constant] {
        let mut compensator = Compensator::new(Config { method, ..Config::default() }).expect("a valid config");
        let truth = calibration(&REF, 40.0);
        let mut random = Random::new(401);
        for k in 0..1_500 {
            let field_ut = random.raw_one(&truth, 0.3);
            if k % 37 == 5 {
                let mut clone = compensator.clone();
                let start = taken();
                clone.push(sample(k, field_ut));
                assert_eq!(taken() - start, 0, "{method:?}, clone at sample {k}");
            }
            compensator.push(sample(k, field_ut));
        }
    }
}

/// In order, in batches, with more events than there is room for, over a pause and another clock.
#[test]
fn the_queue_takes_no_memory() {
    let mut queue = EventQueue::new(0.25).expect("in range");
    let mut out = 0;
    let start = taken();
    for k in 0..20_000_i64 {
        let time_ns = match k {
            0..10_000 => (k ^ 63) * 1_000_000,
            10_000..15_000 => 20_000_000_000 + k * 10_000,
            _ => k * 2_000_000,
        };
        let value = Vector3::repeat(k as f64);
        let event = match k % 3 {
            0 => SensorEvent::Magnetic(MagneticSample { time_ns, field_ut: value }),
            1 => SensorEvent::Up(UpSample { time_ns, up_m_s2: value }),
            _ => SensorEvent::RotationRate(RotationRateSample { time_ns, rate_rad_s: value }),
        };
        queue.push(event, |_| out += 1);
    }
    queue.flush(|_| out += 1);
    assert_eq!((taken() - start, out), (0, 20_000));
}
