//! The fuzzer's work as a plain loop: `MAGCOMP_FUZZ` inputs of each kind, or few enough to take seconds. `fuzz/` has it under
//! libFuzzer. An input that was found to fail is kept in `tests/vectors/fuzz/`.

use magcomp::{Compensator, Config};
use magcomp_tests::Random;
use magcomp_tests::fuzz::{kept, stream};

fn rounds(usual: u64) -> u64 {
    std::env::var("MAGCOMP_FUZZ").map_or(usual, |rounds| rounds.parse().expect("a count"))
}

/// Runs `work`; the input of one that panics is named by its seed.
fn each(rounds: u64, name: &str, input: impl Fn(&mut Random) -> Vec<u8>, work: fn(&[u8])) {
    for seed in 0..rounds {
        let data = input(&mut Random::new(seed));
        if let Err(panic) = std::panic::catch_unwind(|| work(&data)) {
            eprintln!("{name}: the input of seed {seed} fails");
            std::panic::resume_unwind(panic);
        }
    }
}

/// What a text of numbers is made of.
const DIGITS: &[u8] = b"0123456789-+.eE,[]{}\"n ";

fn byte(random: &mut Random) -> u8 {
    random.between(0.0, 256.0) as u8
}

#[test]
fn streams_of_any_events_give_finite_readings_and_refusals_change_nothing() {
    let input = |random: &mut Random| (0..2000).map(|_| byte(random)).collect();
    each(rounds(8), "stream", input, stream);
}

#[test]
fn kept_texts_of_any_kind_are_refused_or_taken_whole() {
    let mut compensator = Compensator::new(Config::default()).unwrap();
    let given = magcomp::Calibration::identity(48.0).unwrap();
    compensator.adopt(&magcomp::KeptCalibration::given(given, 2.0).unwrap(), None);
    let whole = magcomp::KeptCalibration::given(given, 2.0).unwrap().to_json();
    let input = |random: &mut Random| {
        let mut text = whole.clone().into_bytes();
        for _ in 0..1 + byte(random) % 4 {
            let at = random.between(0.0, text.len().max(1) as f64) as usize;
            match byte(random) % 4 {
                0 if at < text.len() => drop(text.remove(at)),
                1 if at < text.len() => text[at] = byte(random),
                2 => text.truncate(at),
                _ => text.insert(at, DIGITS[usize::from(byte(random)) % DIGITS.len()]),
            }
        }
        text
    };
    each(rounds(5_000), "kept", input, kept);
}

#[test]
fn inputs_that_failed_once_do_not_fail_again() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/vectors/fuzz");
    let mut found = 0;
    for file in std::fs::read_dir(folder).into_iter().flatten().flatten() {
        let (name, data) = (file.file_name().into_string().unwrap(), std::fs::read(file.path()).unwrap());
        found += 1;
        match name.split('-').next() {
            Some("stream") => stream(&data),
            Some("kept") => kept(&data),
            _ => panic!("{name}: of which kind is it?"),
        }
    }
    println!("{found} inputs");
}
