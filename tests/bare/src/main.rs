//! A stream of a minute through the compensator: on a microcontroller, with nothing but `alloc`, or on this machine. Prints a hash of every reading, and on
//! the microcontroller what memory that took. The stream is plain arithmetic and `libm`, so that it is the same on both.
#![cfg_attr(target_os = "none", no_std, no_main)]

use core::fmt::{self, Write};
use magcomp::nalgebra::{Matrix3, Vector3};
use magcomp::{Compensator, Config, MagneticSample, Method, RotationRateSample, UpSample};

/// FNV-1a (Fowler, Noll, Vo), 64 bits, of a text.
struct Hash(u64);

impl Write for Hash {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
        Ok(())
    }
}

/// Device to world at a time, s.
fn attitude(t: f64) -> Matrix3<f64> {
    let about = |angle: f64| (libm::sin(angle), libm::cos(angle));
    let ((s, c), (p, q), (v, w)) = (about(0.5 * t), about(0.6 * libm::sin(1.3 * t)), about(0.5 * libm::cos(0.9 * t)));
    Matrix3::new(c, -s, 0.0, s, c, 0.0, 0.0, 0.0, 1.0)
        * Matrix3::new(1.0, 0.0, 0.0, 0.0, q, -p, 0.0, p, q)
        * Matrix3::new(w, 0.0, v, 0.0, 1.0, 0.0, -v, 0.0, w)
}

/// 50 samples a second for a minute: a magnet is put on after 25 s, the gyroscope is gone from 40 to 50 s.
fn stream(compensator: &mut Compensator) -> (u64, Option<f64>) {
    const DT_S: f64 = 0.02;
    let soft_iron = Matrix3::new(1.04, 0.02, -0.01, 0.02, 0.97, 0.015, -0.01, 0.015, 1.0);
    let (mut hash, mut heading_deg, mut random) = (Hash(0xcbf2_9ce4_8422_2325), None, 1_u64);
    let mut noise = |size: f64| {
        Vector3::from_fn(|_, _| {
            // the sum of four, from xorshift (Marsaglia)
            let sum: f64 = (0..4)
                .map(|_| {
                    random ^= random << 13;
                    random ^= random >> 7;
                    random ^= random << 17;
                    (random >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
                })
                .sum();
            sum * size * 1.732
        })
    };
    for k in 1..=3000_i64 {
        let (time_ns, t) = (k * 20_000_000, k as f64 * DT_S);
        let (before, to_world, after) = (attitude(t - 0.5 * DT_S), attitude(t), attitude(t + 0.5 * DT_S));
        let turn = before.transpose() * after;
        let rate = Vector3::new(turn[(2, 1)] - turn[(1, 2)], turn[(0, 2)] - turn[(2, 0)], turn[(1, 0)] - turn[(0, 1)]) * (0.5 / DT_S);
        let magnet_ut = if t < 25.0 { Vector3::zeros() } else { Vector3::new(20.0, -15.0, 10.0) };
        let field = to_world.transpose() * Vector3::new(0.0, 21.0, -43.0);
        let field_ut = soft_iron * field + Vector3::new(120.0, -80.0, 250.0) + magnet_ut + noise(0.4);
        let up_m_s2 = to_world.transpose() * Vector3::new(0.0, 0.0, 9.81) + noise(0.05);
        let rate_rad_s = rate + Vector3::new(0.01, -0.02, 0.015) + noise(0.003);
        if !(40.0..50.0).contains(&t) {
            let _ = compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s });
        }
        let _ = compensator.push_up(UpSample { time_ns, up_m_s2 });
        let reading = compensator.push(MagneticSample { time_ns, field_ut });
        write!(hash, "{reading:?}").expect("a hash takes every text");
        heading_deg = reading.heading.map(|it| it.heading_deg).or(heading_deg);
    }
    (hash.0, heading_deg)
}

const METHODS: [Method; 4] = [Method::Auto, Method::Aided, Method::Adaptive, Method::Windowed];

fn compensator(method: Method) -> Compensator {
    let mut config = Config::default();
    config.method = method;
    Compensator::new(config).expect("a valid config")
}

/// What both say: readings, and that they are of a compensator that has learned.
fn say(mut out: impl Write, method: Method, compensator: &mut Compensator) {
    let (hash, heading_deg) = stream(compensator);
    let hard_iron_ut = compensator.calibration().map(|it| it.hard_iron_ut().x);
    writeln!(out, "{method:?}: readings {hash:016x}, last heading {heading_deg:?}, b_x {hard_iron_ut:?}").expect("an output");
}

#[cfg(not(target_os = "none"))]
fn main() {
    let mut text = String::new();
    for method in METHODS {
        say(&mut text, method, &mut compensator(method));
    }
    print!("{text}");
}

#[cfg(target_os = "none")]
mod bare {
    use super::{METHODS, compensator, say};
    use core::fmt::Write;
    use core::mem::{MaybeUninit, size_of};
    use core::ptr::{addr_of_mut, read_volatile, write_volatile};
    use cortex_m_semihosting::{debug, hio};
    use embedded_alloc::LlffHeap;

    const HEAP_BYTES: usize = 1 << 20;
    const STACK_BYTES: usize = 1 << 18;
    const PAINT: u32 = 0x5741_5953;
    static mut MEMORY: [MaybeUninit<u8>; HEAP_BYTES] = [MaybeUninit::uninit(); HEAP_BYTES];

    #[global_allocator]
    static HEAP: LlffHeap = LlffHeap::empty();

    #[panic_handler]
    fn panicked(info: &core::panic::PanicInfo<'_>) -> ! {
        if let Ok(mut out) = hio::hstderr() {
            let _ = writeln!(out, "{info}");
        }
        debug::exit(debug::EXIT_FAILURE);
        loop {}
    }

    /// The stack's words from its deepest: painted, and how many bytes of it were used since.
    fn stack() -> (*mut u32, usize) {
        let here = cortex_m::register::msp::read() as usize - 256;
        ((here - STACK_BYTES) as *mut u32, STACK_BYTES / 4)
    }

    #[cortex_m_rt::entry]
    fn main() -> ! {
        // SAFETY: once, before anything is allocated
        unsafe { HEAP.init(addr_of_mut!(MEMORY) as usize, HEAP_BYTES) }
        let mut out = hio::hstdout().expect("a semihosted machine");
        for method in METHODS {
            let (deepest, words) = stack();
            for k in 0..words {
                // SAFETY: below the stack pointer, where nothing is but what this function will call
                unsafe { write_volatile(deepest.add(k), PAINT) }
            }
            let before = HEAP.used();
            let mut it = compensator(method);
            let made = HEAP.used() - before;
            say(&mut out, method, &mut it);
            let grown = HEAP.used() - before - made;
            // SAFETY: as above
            let unused = (0..words).take_while(|k| unsafe { read_volatile(deepest.add(*k)) } == PAINT).count();
            let own = size_of::<magcomp::Compensator>();
            writeln!(out, "{method:?}: memory {} = {own} of its own + {made} of the heap, which grew by {grown}; stack {}", own + made, STACK_BYTES - 4 * unused)
                .expect("an output");
        }
        debug::exit(debug::EXIT_SUCCESS);
        loop {}
    }
}
