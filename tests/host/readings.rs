//! Golden readings: every bit of every reading of short streams and of two recordings, for each method, as one hash a run. A change of structure
//! keeps them; a change of an estimator writes them anew, in a commit that says so:
//! `MAGCOMP_WRITE_GOLDEN=1 cargo test -p magcomp-tests --test readings`.
//!
//! Hashes hold on every platform. `tests/determinism.sh` runs this test on some, and has every reading written to the file that
//! MAGCOMP_WRITE_READINGS names.

use flate2::read::GzDecoder;
use magcomp::nalgebra::{Rotation3, Vector3};
use magcomp::{Calibration, Compensator, Config, MagneticSample, Method, Reading, RotationRateSample, UpSample};
use magcomp_tests::{REF, Random, calibration};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::{File, read_to_string, write};
use std::io::{BufRead, BufReader, BufWriter, Write};

const METHODS: [Method; 4] = [Method::Auto, Method::Adaptive, Method::Windowed, Method::Constant];
const GOLDEN: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/vectors/readings.json");

/// What is kept of a run.
#[derive(Debug, Deserialize, PartialEq, Serialize)]
struct Run {
    hash: String,
    /// Of the last reading that has them, to three decimals, for who reads the file.
    heading_deg: Option<f64>,
    hard_iron_ut: Option<[f64; 3]>,
}

/// The events of one magnetometer sample.
struct Events {
    time_ns: i64,
    rate_rad_s: Option<Vector3<f64>>,
    up_m_s2: Option<Vector3<f64>>,
    field_ut: Vector3<f64>,
}

/// A stream of 20 s at 50 Hz and what is special in it.
#[derive(Clone, Copy)]
enum Special {
    Nothing,
    Walk,
    Step,
    SmallStep,
    StepAndBack,
    Place,
    PlaceThenStep,
    Rest,
    NoGyroscope,
    Gaps,
    Drift,
    Spikes,
    /// A magnet is passed every three seconds, of 5 to 180 uT; from the start on, or once settled.
    Magnets {
        from: usize,
    },
    /// 20 uT at 16.7 Hz for six seconds.
    Tram,
    PauseAndStep,
}

const SPECIAL: [(&str, Special); 16] = [
    ("nothing", Special::Nothing),
    ("walk", Special::Walk),
    ("step", Special::Step),
    ("small step", Special::SmallStep),
    ("step and back", Special::StepAndBack),
    ("place", Special::Place),
    ("place, then step", Special::PlaceThenStep),
    ("rest", Special::Rest),
    ("gyroscope gone", Special::NoGyroscope),
    ("gaps", Special::Gaps),
    ("drift", Special::Drift),
    ("spikes", Special::Spikes),
    ("magnets", Special::Magnets { from: 400 }),
    ("magnets from the start", Special::Magnets { from: 0 }),
    ("tram", Special::Tram),
    ("pause, with a step", Special::PauseAndStep),
];

/// As a sensor gives it: in steps, within which the platforms' sines and logarithms differ, so that the stream is the same on all.
fn read(v: Vector3<f64>) -> Vector3<f64> {
    const STEPS: f64 = 16384.0;
    v.map(|v| (v * STEPS).round() / STEPS)
}

fn stream(special: Special, seed: u64) -> Vec<Events> {
    let mut random = Random::new(seed);
    let start = calibration(&REF.map(|v| v * 0.5 + 0.5 * f64::from(u8::from(v > 0.9))), 48.0);
    let (mut attitude, mut time_ns) = (Rotation3::identity(), 0);
    let event = |k: usize| {
        let (t, late) = (k as f64 * 0.02, k >= 600);
        let rests = matches!(special, Special::Rest) && (400..800).contains(&k);
        let (fast, about) = if matches!(special, Special::Walk) { (0.4, 0.3) } else { (1.0, 1.0) };
        let rate =
            Vector3::new((0.9 * t).sin() * about, (1.3 * t + 1.0).cos() * about, 0.8 * (0.5 * t).sin() + 0.3) * fast;
        let rate = if rests { Vector3::zeros() } else { rate };
        attitude *= Rotation3::new(rate * 0.02);
        time_ns += match special {
            Special::Gaps if k == 500 => 700_000_000,
            Special::Gaps if k == 700 => 4_000_000_000,
            Special::PauseAndStep if k == 600 => 6_000_000_000,
            _ => 20_000_000,
        };
        let off_ut = match special {
            Special::Step | Special::PauseAndStep if late => 27.0,
            Special::SmallStep if late => 6.0,
            Special::StepAndBack if (400..700).contains(&k) => 27.0,
            Special::PlaceThenStep if k >= 800 => 27.0,
            Special::Drift => 0.4 * t,
            _ => 0.0,
        };
        let placed = matches!(special, Special::Place) && (400..700).contains(&k)
            || matches!(special, Special::PlaceThenStep) && k >= 400;
        let place_ut = match special {
            Special::Magnets { from } if k >= from => {
                // 0.8 s of every 3, nearer and nearer
                let apart_s = (t % 3.0 - 1.5) / 0.4;
                let size_ut = (5.0 + 9.0 * t) * (1.0 - apart_s * apart_s).max(0.0);
                Vector3::new(0.6, (0.7 * t).sin(), (0.7 * t).cos()) * size_ut
            }
            Special::Tram if (500..800).contains(&k) => Vector3::new(20.0, 8.0, -12.0) * (104.9 * t).sin(),
            _ if placed => Vector3::new(15.0, -5.0, 12.0),
            _ => Vector3::zeros(),
        };
        let spike = if matches!(special, Special::Spikes) && k % 50 == 49 { 60.0 } else { 0.0 };
        let b = start.hard_iron_ut() + Vector3::new(0.6, -0.7, 0.4) * off_ut;
        let truth = Calibration::new(*start.soft_iron(), b, 48.0).expect("a phone's");
        let field = attitude.inverse() * (Vector3::new(0.0, 21.0, -43.0) + place_ut);
        let is_gone = matches!(special, Special::NoGyroscope) && (500..800).contains(&k);
        let rate_rad_s = rate + Vector3::new(0.01, -0.02, 0.015) + random.normal3() * 0.003;
        let up_m_s2 = attitude.inverse() * Vector3::new(0.0, 0.0, 9.81) + random.normal3() * 0.05;
        let field_ut = truth.distort(&field) + random.normal3() * 0.5 + Vector3::new(spike, 0.0, -spike);
        Events {
            time_ns,
            rate_rad_s: (!is_gone).then_some(read(rate_rad_s)),
            up_m_s2: Some(read(up_m_s2)),
            field_ut: read(field_ut),
        }
    };
    (0..1000).map(event).collect()
}

/// The first 6000 rows of a recording; `NaN` is no event.
fn recording(name: &str) -> Vec<Events> {
    let path = format!("{}/recordings/{name}.csv.gz", env!("CARGO_MANIFEST_DIR"));
    let lines = BufReader::new(GzDecoder::new(File::open(path).expect("a recording"))).lines();
    let row = |line: String| line.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect::<Vec<f64>>();
    let events = |row: Vec<f64>| {
        let three =
            |k: usize| Some(Vector3::new(row[k], row[k + 1], row[k + 2])).filter(|v| v.iter().all(|v| v.is_finite()));
        Events {
            time_ns: (row[0] * 1e9) as i64,
            rate_rad_s: three(7),
            up_m_s2: three(4),
            field_ut: three(1).unwrap_or(Vector3::repeat(f64::NAN)),
        }
    };
    lines.skip(1).map(|line| events(row(line.expect("a text")))).take(6000).collect()
}

/// FNV-1a (Fowler, Noll, Vo), 64 bits.
fn add(hash: &mut u64, text: &str) {
    for byte in text.bytes() {
        *hash = (*hash ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
    }
}

fn run(events: &[Events], method: Method, mut told: impl FnMut(&str)) -> Run {
    let mut compensator = Compensator::new(Config { method, ..Config::default() }).expect("a valid config");
    let (mut hash, mut last) = (0xcbf2_9ce4_8422_2325, None);
    for it in events {
        let Events { time_ns, rate_rad_s, up_m_s2, field_ut } = *it;
        if let Some(rate_rad_s) = rate_rad_s {
            let _ = compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s });
        }
        if let Some(up_m_s2) = up_m_s2 {
            let _ = compensator.push_up(UpSample { time_ns, up_m_s2 });
        }
        let reading: Reading = compensator.push(MagneticSample { time_ns, field_ut });
        let text = serde_json::to_string(&reading).expect("plain data");
        add(&mut hash, &text);
        told(&text);
        last = reading.heading.map(|heading| heading.heading_deg).or(last);
    }
    let round = |v: f64| (v * 1e3).round() / 1e3;
    Run {
        hash: format!("{hash:016x}"),
        heading_deg: last.map(round),
        hard_iron_ut: compensator.calibration().map(|it| (*it.hard_iron_ut()).map(round).into()),
    }
}

#[test]
fn readings_are_those_of_the_golden_file() {
    let mut found = BTreeMap::new();
    let mut readings = std::env::var_os("MAGCOMP_WRITE_READINGS")
        .map(|path| BufWriter::new(File::create(path).expect("a file that can be written")));
    let mut add_runs = |name: &str, events: &[Events]| {
        for method in METHODS {
            let name = format!("{name}, {method:?}");
            let tell = |text: &str| {
                if let Some(readings) = &mut readings {
                    writeln!(readings, "{name}\t{text}").expect("room");
                }
            };
            let run = run(events, method, tell);
            found.insert(name, run);
        }
    };
    for (seed, (name, special)) in SPECIAL.into_iter().enumerate() {
        add_runs(name, &stream(special, 40 + seed as u64));
    }
    for name in ["broad_01_slow_rotation_A", "broad_34_attached_magnet_3cm"] {
        add_runs(name, &recording(name));
    }
    assert_eq!(found.len(), 72);
    if let Some(readings) = &mut readings {
        readings.flush().expect("room"); // a panic in WebAssembly drops nothing
    }
    if std::env::var_os("MAGCOMP_WRITE_GOLDEN").is_some() {
        write(GOLDEN, serde_json::to_string_pretty(&found).expect("plain data") + "\n").expect("a writable folder");
    }
    let expected: BTreeMap<String, Run> =
        serde_json::from_str(&read_to_string(GOLDEN).expect("the golden file")).expect("what this test wrote");
    assert!(expected.keys().eq(found.keys()), "other runs than in the golden file");
    let changed: Vec<&String> = found.keys().filter(|name| expected[*name] != found[*name]).collect();
    assert!(changed.is_empty(), "readings have changed; a change of structure must not do that: {changed:#?}");
}
