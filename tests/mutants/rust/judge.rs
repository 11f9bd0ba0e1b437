//! Simulated runs and recordings, of which each test prints what the readings are: tests/mutants/rust compares that with and without a mutant.
//! It is copied among the lab's tests.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::path::Path;

use magcomp::{Config, Method};
use magcomp_lab::catalogue::find;
use magcomp_lab::experiment::answers;
use magcomp_replay::{Ignore, Step, replay};
use magcomp_lab::score::Figures;
use magcomp_recordings::recording::read;

/// The readings to the last bit, and to six decimals.
fn hashes(steps: &[Step]) -> [u64; 2] {
    let [mut bits, mut decimals] = [DefaultHasher::new(), DefaultHasher::new()];
    for step in steps {
        let all = (&step.reading, &step.calibration, &step.sigma);
        format!("{all:?}").hash(&mut bits);
        format!("{all:.6?}").hash(&mut decimals);
    }
    [bits.finish(), decimals.finish()]
}

fn simulated(name: &str, method: Method, seeds: std::ops::RangeInclusive<u64>) {
    let ignore = Ignore { gyroscope: method == Method::Adaptive, ..Ignore::default() };
    for seed in seeds {
        let (simulation, _, steps) = answers(&find(name).unwrap(), seed, method, ignore).unwrap();
        let [bits, decimals] = hashes(&steps);
        let of = Figures::of(&simulation, &steps);
        let settled = of.stretches.iter().filter_map(|it| it.settled.as_ref()).map(|it| format!("{:?}", it.calibration_s[0]));
        println!(
            "judge {name} {seed} {bits:x} {decimals:x} heading {:?} within {:?} lie {} missed {} false {} settled {}",
            of.error.heading_deg, of.within, of.lie_s, of.missed, of.false_steps, settled.collect::<Vec<_>>().join("/")
        );
    }
}

fn recorded(name: &str, method: Method) {
    let recording = read(&Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings").join(name)).unwrap();
    let ignore = Ignore { gyroscope: method == Method::Adaptive, ..Ignore::default() };
    let [bits, decimals] = hashes(&replay(&recording, &Config { method, ..Config::default() }, ignore).unwrap());
    println!("judge {name} {bits:x} {decimals:x}");
}

macro_rules! runs {
    ($($test:ident: $name:literal, $seeds:expr;)+) => {
        mod with_gyroscope {
            $(#[test]
            fn $test() {
                super::simulated($name, magcomp::Method::Auto, $seeds);
            })+
        }
        mod without {
            $(#[test]
            fn $test() {
                super::simulated($name, magcomp::Method::Adaptive, $seeds);
            })+
        }
    };
}

runs! {
    hand: "phone-hand", 1..=3;
    walk: "phone-walk", 4..=6;
    walk_known: "phone-walk-known", 7..=9;
    hand_place: "phone-hand-place", 1..=2;
    walk_place: "phone-walk-place", 3..=4;
    walk_room: "phone-walk-room", 5..=6;
    walk_poor: "phone-walk-poor", 7..=8;
    walk_spikes: "phone-walk-spikes", 9..=9;
    drift: "phone-drift", 1..=1;
    walk_drift: "phone-walk-drift", 2..=2;
    planar: "phone-planar", 3..=3;
    still: "phone-still", 4..=4;
    step: "steps.b20", 5..=6;
    magnet: "steps.b50-m", 7..=8;
    pocket: "motion.pocket", 9..=9;
    covers: "covers", 1..=1;
    pulse: "pulse", 2..=2;
    random: "random-steps", 3..=3;
    ramp: "ramp", 4..=4;
}

#[test]
fn a_slow_rotation() {
    recorded("broad_01_slow_rotation_A.csv.gz", Method::Auto);
}

#[test]
fn a_slow_rotation_without() {
    recorded("broad_01_slow_rotation_A.csv.gz", Method::Adaptive);
}

#[test]
fn a_magnet() {
    recorded("broad_34_attached_magnet_3cm.csv.gz", Method::Auto);
}

#[test]
fn a_magnet_without() {
    recorded("broad_34_attached_magnet_3cm.csv.gz", Method::Adaptive);
}

#[test]
fn a_near_magnet() {
    recorded("broad_32_attached_magnet_1cm.csv.gz", Method::Auto);
}
