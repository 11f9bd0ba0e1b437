//! What the public interface promises whichever estimator answers: refused input changes nothing, headings alone follow
//! their settings, one known field strength serves every method, a snapshot is taken over whole or not at all, and every
//! number has a range.

use magcomp::nalgebra::{Matrix3, Rotation3, Vector3};
use magcomp::{
    Calibration, CalibrationError, Compensator, Config, ConstantField, Disturbance, EventRejection, FactoryErrors,
    HeadingConfig, MagneticSample, Method, Reading, ReferenceAxis, RejectReason, Restored, RotationRateSample,
    SNAPSHOT_VERSION, ScreenRotation, SnapshotError, Status, UpSample,
};
use magcomp_tests::{REF, Random, calibration, difference};
use std::panic::{AssertUnwindSafe, catch_unwind};

const METHODS: [Method; 5] = [Method::Auto, Method::Aided, Method::Adaptive, Method::Windowed, Method::Constant];
const PERIOD_NS: i64 = 10_000_000;

fn compensator(config: &Config) -> Compensator {
    Compensator::new(config.clone()).expect("a valid config")
}

/// A phone in a hand at 100 Hz, with a gyroscope and an accelerometer.
#[derive(Clone)]
struct Phone {
    attitude: Rotation3<f64>,
    field_ut: Vector3<f64>,
    truth: Calibration,
    noise: u64,
    time_ns: i64,
    gyroscope: bool,
    moving: bool,
}

impl Phone {
    fn new(seed: u64, truth: Calibration) -> Self {
        Self {
            attitude: Rotation3::identity(),
            field_ut: Vector3::new(0.0, 0.5, -0.75_f64.sqrt()) * truth.field_strength_ut(),
            truth,
            noise: seed,
            time_ns: 0,
            gyroscope: true,
            moving: true,
        }
    }

    /// Noise of variance 1, near enough to normal: a phone can be cloned, a `Random` can't.
    fn normal3(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| {
            let uniform = |_| {
                self.noise = self.noise.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                (self.noise >> 11) as f64 / (1_u64 << 53) as f64
            };
            (0..12).map(uniform).sum::<f64>() - 6.0
        })
    }

    /// The next sample, after the events that belong to it.
    fn sample(&mut self, compensator: &mut Compensator) -> MagneticSample {
        let t = self.time_ns as f64 * 1e-9;
        let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin());
        let rate = if self.moving { rate } else { Vector3::zeros() };
        self.attitude *= Rotation3::new(rate * 0.01);
        self.time_ns += PERIOD_NS;
        let time_ns = self.time_ns;
        let rate_rad_s = rate + self.normal3() * 0.003 + Vector3::new(0.01, -0.02, 0.015);
        let up_m_s2 = self.attitude.inverse() * Vector3::new(0.0, 0.0, 9.81) + self.normal3() * 0.05;
        if self.gyroscope {
            let _ = compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s });
        }
        let _ = compensator.push_up(UpSample { time_ns, up_m_s2 });
        let carried = self.attitude.inverse() * self.field_ut;
        MagneticSample { time_ns, field_ut: self.truth.distort(&carried) + self.normal3() * 0.4 }
    }

    fn advance(&mut self, compensator: &mut Compensator) -> Reading {
        let sample = self.sample(compensator);
        compensator.push(sample)
    }

    fn run(&mut self, compensator: &mut Compensator, samples: usize) {
        (0..samples).for_each(|_| _ = self.advance(compensator));
    }
}

// 1. refused input

/// Nothing of a compensator changes while `refuse` runs.
fn unchanged(compensator: &mut Compensator, what: &str, refuse: impl FnOnce(&mut Compensator)) {
    let before = compensator.snapshot();
    refuse(compensator);
    assert!(compensator.snapshot() == before, "{what}: the state has changed");
}

#[test]
fn a_refused_sample_changes_nothing() {
    for method in METHODS {
        let config = Config { method, range_ut: 6000.0, ..Config::default() };
        let mut free = compensator(&config);
        let mut railed = compensator(&Config { rail_ut: Some(1000.0), ..config });
        let mut phone = Phone::new(10, calibration(&REF, 45.0));
        phone.clone().run(&mut railed, 400);
        phone.run(&mut free, 400);
        let (now, good) = (phone.time_ns, Vector3::new(40.0, -10.0, 20.0));
        let at = |time_ns: i64, field_ut: Vector3<f64>| MagneticSample { time_ns, field_ut };
        let next = now + PERIOD_NS;
        let refused = |compensator: &mut Compensator, sample: MagneticSample, name: &str| {
            unchanged(compensator, &format!("{method:?}, {name}"), |compensator| {
                let Status::Rejected(reason) = compensator.push(sample).status else {
                    panic!("{method:?}, {name}: it was taken")
                };
                assert!(format!("{reason:?}").starts_with(name), "{method:?}, {name}: {reason:?}");
            });
        };
        refused(&mut free, at(next, Vector3::new(0.0, f64::NAN, 0.0)), "NotFinite");
        refused(&mut free, at(next, Vector3::new(f64::INFINITY, 0.0, 0.0)), "NotFinite");
        refused(&mut free, at(next, Vector3::new(0.0, 0.0, -6001.0)), "OutOfRange");
        refused(&mut railed, at(next, Vector3::new(0.0, 0.0, -1000.0)), "Saturated");
        refused(&mut free, at(now, good), "TimeNotAfter");
        refused(&mut free, at(i64::MIN, good), "TimeNotAfter");
        refused(&mut free, at(now + 700_000 * 1_000_000_000, good), "TimeJump");
        // what the config allows no estimator refuses
        let reading = free.push(at(next, Vector3::new(0.0, 0.0, -5500.0)));
        assert!(!matches!(reading.status, Status::Rejected(_)), "{method:?}: {}", reading.status);
        for k in 1..50 {
            free.push(at(next + k * PERIOD_NS, good));
        }
        free.push(at(next + 50 * PERIOD_NS, good));
        refused(&mut free, at(next + 51 * PERIOD_NS, good), "Stuck");
    }
}

#[test]
fn a_refused_event_changes_nothing() {
    for method in METHODS {
        let mut compensator = compensator(&Config { method, ..Config::default() });
        let mut phone = Phone::new(11, calibration(&REF, 45.0));
        phone.run(&mut compensator, 300);
        let now = phone.time_ns;
        // more than any buffer holds: the oldest have been folded
        let ahead: Vec<i64> = (1..=40).map(|k| now + k * 1_000_000).collect();
        for &time_ns in &ahead {
            let rate_rad_s = Vector3::new(0.1, 0.2, time_ns as f64 * 1e-12);
            assert_eq!(compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s }), Ok(()));
            assert_eq!(compensator.push_up(UpSample { time_ns, up_m_s2: Vector3::new(0.1, 0.2, 9.8) }), Ok(()));
        }
        let three = Vector3::new(0.3, 0.2, 0.1);
        let newest = ahead[39];
        for (time_ns, value, expected) in [
            (newest, three, EventRejection::Duplicate),
            (newest - 1_000_000, three, EventRejection::Duplicate),
            (newest - 7_000_000, three, EventRejection::Duplicate),
            (now - 1, three, EventRejection::Late),
            (ahead[0] + 1, three, EventRejection::Late),
            (newest + 1, Vector3::new(0.0, f64::NAN, 0.0), EventRejection::NotFinite),
            (newest + 1, Vector3::new(0.0, 1e4, 0.0), EventRejection::OutOfRange),
            (now + 11_000_000_000, three, EventRejection::Ahead),
        ] {
            let what = format!("{method:?}, {expected:?} at {time_ns}");
            unchanged(&mut compensator, &what, |compensator| {
                let rate = RotationRateSample { time_ns, rate_rad_s: value };
                assert_eq!(compensator.push_rotation_rate(rate), Err(expected), "{what}");
                assert_eq!(compensator.push_up(UpSample { time_ns, up_m_s2: value }), Err(expected), "{what}");
            });
        }
    }
}

/// 50 refused samples that follow one another begin another clock. How many there have been is no part of a snapshot.
#[test]
fn the_count_towards_another_clock_is_no_part_of_a_snapshot() {
    let mut one = compensator(&Config::default());
    let mut phone = Phone::new(12, calibration(&REF, 45.0));
    phone.run(&mut one, 600);
    let found = one.calibration().expect("calibrated");
    let sample =
        |k: i64| MagneticSample { time_ns: -(1 << 50) + k * PERIOD_NS, field_ut: Vector3::new(40.0, 1.0, 9.0) };
    unchanged(&mut one, "another clock", |one| {
        (0..49).for_each(|k| assert!(matches!(one.push(sample(k)).status, Status::Rejected(_))));
    });
    let mut other = compensator(&Config::default());
    assert_eq!(other.restore(&one.snapshot()), Ok(Restored::Everything));
    assert!(matches!(other.push(sample(49)).status, Status::Rejected(_)), "the count begins anew");
    assert!(!matches!(one.push(sample(49)).status, Status::Rejected(_)));
    let off = difference(&one.calibration().expect("the calibration stays"), &found);
    assert!(off < 0.01, "{off}");
}

// 2. headings

/// Every bit of a reading but the heading.
fn all_but_heading(reading: &Reading) -> String {
    serde_json::to_string(&Reading { heading: None, attitude: None, ..*reading }).expect("plain data")
}

/// Through a change of the device, a gyroscope that goes and comes back, and another clock.
#[test]
fn set_heading_changes_headings_alone() {
    for method in METHODS {
        let config = Config { method, ..Config::default() };
        let (mut one, mut other) = (compensator(&config), compensator(&config));
        let mut phones = [0; 2].map(|_| Phone::new(20, calibration(&REF, 45.0)));
        let mut differing = 0;
        for k in 0..2600 {
            if k == 300 {
                let heading = HeadingConfig {
                    axis: ReferenceAxis::Camera,
                    screen_rotation: ScreenRotation::Deg90,
                    declination_deg: Some(5.0),
                    tilt_sigma_deg: 2.0,
                };
                assert_eq!(other.set_heading(heading), Ok(()));
                assert_eq!(other.config().heading, heading);
            }
            for phone in &mut phones {
                phone.gyroscope = !(900..1500).contains(&k);
                if k == 1200 {
                    phone.truth = calibration(&REF.map(|v| v * 1.2), 45.0);
                }
                if k == 1700 {
                    phone.time_ns -= 1 << 45;
                }
            }
            let (expected, found) = (phones[0].advance(&mut one), phones[1].advance(&mut other));
            assert_eq!(all_but_heading(&found), all_but_heading(&expected), "{method:?}, sample {k}");
            assert_eq!(other.calibration(), one.calibration(), "{method:?}, sample {k}");
            assert_eq!(other.covariance(), one.covariance(), "{method:?}, sample {k}");
            differing += usize::from(found.heading != expected.heading);
        }
        assert!(differing > 1000, "{method:?}: {differing} headings differ");
    }
}

// 3. a known field strength

#[test]
fn a_known_field_strength_is_heard_by_every_method() {
    let field_ut = 48.0;
    // a sensor that reads a tenth too much: without the known strength that is the field's
    let mut parameters = [0.3, -0.2, 1.3, 1.15, 1.05, 1.10, 0.03, -0.02, 0.04];
    parameters[..3].iter_mut().for_each(|b| *b *= 1.1);
    let truth = calibration(&parameters, field_ut);
    for method in METHODS {
        let field_strength_ut = Some(field_ut);
        let mut compensator = compensator(&Config { method, field_strength_ut, ..Config::default() });
        let mut phone = Phone::new(30, truth);
        phone.run(&mut compensator, 6000);
        let (mut sums, count) = ([0.0; 2], 500);
        for _ in 0..count {
            let reading = phone.advance(&mut compensator);
            sums[0] += reading.total_field_ut.expect("calibrated") / f64::from(count);
            sums[1] += reading.filtered_field_ut.map_or(field_ut, |field| field.norm()) / f64::from(count);
        }
        let found = compensator.calibration().expect("calibrated");
        assert!((found.field_strength_ut() - field_ut).abs() < 1e-9, "{method:?}: {}", found.field_strength_ut());
        let near = |value: f64| (value / field_ut - 1.0).abs() < 0.02;
        assert!(sums.into_iter().all(near), "{method:?}: {sums:?}");
        let off = (found.soft_iron() - truth.soft_iron()).amax();
        assert!(off < 0.03, "{method:?}: M is off by {off}: {}", found.soft_iron());
        // M is free in scale no longer, and says how well it is known
        if let Some(covariance) = compensator.covariance() {
            let sd = covariance.diagonal().fixed_rows::<3>(3).amax().sqrt();
            assert!(off < 6.0 * sd, "{method:?}: M is off by {off}, sigma {sd}");
        }
    }
}

// 4. and 5. snapshots

/// The checksum of zip and PNG.
fn crc32(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(u32::MAX, |remainder, byte| {
        (0..8).fold(remainder ^ u32::from(*byte), |r, _| if r & 1 == 1 { r >> 1 ^ 0xedb8_8320 } else { r >> 1 })
    })
}

/// The part of a snapshot between a name and the next quote.
fn part<'a>(snapshot: &'a str, name: &str) -> &'a str {
    let (_, rest) = snapshot.split_once(&format!("\"{name}\":\"")).expect("a snapshot has this part");
    rest.split_once('"').expect("a part ends with a quote").0
}

/// The bytes that the state of a snapshot consists of.
fn state_of(snapshot: &str) -> Vec<u8> {
    let digits = part(snapshot, "state").as_bytes();
    let nibble = |digit: u8| char::from(digit).to_digit(16).expect("a digit") as u8;
    digits.chunks(2).map(|pair| nibble(pair[0]) << 4 | nibble(pair[1])).collect()
}

/// A snapshot with another part in place of one, and the right checksum.
fn sealed(snapshot: &str, name: &str, other: &str) -> String {
    let text = snapshot.replacen(&format!("\"{}\"", part(snapshot, name)), &format!("\"{other}\""), 1);
    let (_, body) = text.split_once("\"library\"").expect("a snapshot names the library");
    let checksum = format!("{:08x}", crc32(format!("\"library\"{body}").as_bytes()));
    text.replacen(part(snapshot, "crc32"), &checksum, 1)
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// One way to spoil a state at a place, by number; its name.
fn spoil(state: &mut Vec<u8>, place: usize, way: usize) -> String {
    let numbers =
        [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e300, -1.0, 1e25, f64::MAX, f64::MIN, 0.0, 5e-324];
    // as postcard writes integers
    let counts: [&[u8]; 6] = [
        &[0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01],
        &[0xfe, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0x01],
        &[0xff, 0xff, 0xff, 0xff, 0x0f],
        &[0x80, 0x94, 0xeb, 0xdc, 0x03],
        &[0x7f],
        &[0x14],
    ];
    match way {
        0..8 => state[place] ^= 1 << way,
        8..19 => {
            let bytes = numbers[way - 8].to_le_bytes();
            let end = (place + 8).min(state.len());
            state[place..end].copy_from_slice(&bytes[..end - place]);
        }
        19..25 => drop(state.splice(place..=place, counts[way - 19].iter().copied())),
        25..31 => {
            // an integer of several bytes is replaced whole
            let length = state[place..].iter().take(10).take_while(|byte| **byte >= 0x80).count();
            let end = (place + length).min(state.len() - 1);
            drop(state.splice(place..=end, counts[way - 25].iter().copied()));
        }
        31 => state.truncate(place),
        _ => state.insert(place, 1),
    }
    format!("way {way} at byte {place}")
}
const WAYS: usize = 33;

/// Everything that a compensator says is finite.
fn is_sound(reading: &Reading, compensator: &Compensator) -> bool {
    let heading = reading.heading.map_or([0.0; 4], |found| {
        let or_zero = |value: Option<f64>| value.unwrap_or(0.0);
        [found.heading_deg, found.inclination_deg, or_zero(found.heading_sigma_deg), or_zero(found.true_heading_deg)]
    });
    let fields = [reading.field_ut, reading.filtered_field_ut].into_iter().flatten().flat_map(<[f64; 3]>::from);
    let numbers = [reading.field_sigma_ut, reading.total_field_ut, reading.sigma_t, reading.direction_sigma_deg];
    let rest = [reading.worst_sigma_deg, Some(reading.coverage)];
    let found = compensator.calibration();
    let calibration = found.iter().flat_map(|c| c.soft_iron().iter().chain(c.hard_iron_ut()).copied());
    heading
        .into_iter()
        .chain(fields)
        .chain(numbers.into_iter().chain(rest).flatten())
        .chain(calibration)
        .all(f64::is_finite)
        && compensator.covariance().is_none_or(|c| c.iter().all(|v| v.is_finite()))
        && !reading.status.to_string().contains("NaN")
}

/// A stream that goes through everything, and the snapshots taken on its way.
fn snapshots(config: &Config) -> Vec<(Phone, String)> {
    let mut compensator = compensator(config);
    let mut phone = Phone::new(40, calibration(&REF, 45.0));
    let mut taken = Vec::new();
    for k in 0..3200 {
        phone.gyroscope = !(2100..2500).contains(&k);
        phone.moving = !(2800..3000).contains(&k);
        if k == 1200 {
            phone.truth = calibration(&REF.map(|v| v * 1.2), 45.0);
        }
        if k == 1800 {
            phone.field_ut.y += 25.0;
        }
        if [0, 30, 120, 900, 1215, 1240, 1300, 1830, 2150, 2520, 2950].contains(&k) {
            taken.push((phone.clone(), compensator.snapshot()));
        }
        phone.advance(&mut compensator);
    }
    taken
}

/// A state with the right checksum and any content is taken over or refused, and never leads to a panic, an endless loop
/// or a number that is none.
#[test]
fn no_content_of_a_snapshot_does_harm() {
    // every place in every way is a night's work: `MAGCOMP_SPOILED=100000` tries that many of each snapshot
    let most = std::env::var("MAGCOMP_SPOILED").ok().and_then(|text| text.parse().ok()).unwrap_or(12);
    for method in METHODS {
        let config = Config { method, ..Config::default() };
        let mut victim = compensator(&config);
        Phone::new(41, calibration(&REF, 45.0)).run(&mut victim, 200);
        let before = victim.snapshot();
        let (mut refused, mut taken) = (0, 0);
        for (point, (phone, snapshot)) in snapshots(&config).into_iter().enumerate() {
            let mut sound = victim.clone();
            assert_eq!(sound.restore(&snapshot), Ok(Restored::Everything), "{method:?}, snapshot {point}");
            let state = state_of(&snapshot);
            let mut random = Random::new(4200 + point as u64);
            for _ in 0..most {
                let mut spoiled = state.clone();
                // the first half holds what is more than a list of samples
                let place = (random.between(0.0, 1.0).powi(2) * state.len() as f64) as usize;
                let what = spoil(&mut spoiled, place, random.between(0.0, WAYS as f64) as usize);
                let what = format!("{method:?}, snapshot {point}, {what} of {}", state.len());
                let text = sealed(&snapshot, "state", &hexadecimal(&spoiled));
                let went_well = catch_unwind(AssertUnwindSafe(|| {
                    let mut compensator = victim.clone();
                    match compensator.restore(&text) {
                        Err(error) => {
                            assert_eq!(error, SnapshotError::Damaged);
                            assert!(compensator.snapshot() == before, "refused, but something has changed");
                            refused += 1;
                        }
                        Ok(_) => {
                            taken += 1;
                            let mut phone = phone.clone();
                            for k in 0..2000 {
                                // the gyroscope goes and comes back, the device changes
                                phone.gyroscope = k % 500 < 300;
                                phone.truth = calibration(&REF.map(|v| v * if k < 1000 { 1.0 } else { 1.3 }), 45.0);
                                let reading = phone.advance(&mut compensator);
                                assert!(is_sound(&reading, &compensator), "sample {k}: {reading:?}");
                            }
                        }
                    }
                }));
                assert!(went_well.is_ok(), "{what}");
            }
        }
        println!("{method:?}: {refused} refused, {taken} taken over");
        assert!(refused > 2 * most && taken > 2 * most, "{method:?}: {refused} refused, {taken} taken over");
    }
}

/// The state of an earlier build is laid out otherwise; its calibration is not.
#[test]
fn a_snapshot_of_another_build_brings_its_calibration() {
    let mut source = compensator(&Config::default());
    Phone::new(50, calibration(&REF, 45.0)).run(&mut source, 900);
    let snapshot = source.snapshot();
    // the same version number, before it said which build it was; another version; another build
    for library in [env!("CARGO_PKG_VERSION"), "0.0.9", "7.0.0", "0.1.0+00000000"] {
        for state in ["", "00", "0102030405", &part(&snapshot, "state")[8..]] {
            let theirs = sealed(&sealed(&snapshot, "state", state), "library", library);
            let mut target = compensator(&Config::default());
            Phone::new(51, calibration(&REF, 45.0)).run(&mut target, 20);
            assert_eq!(target.restore(&theirs), Ok(Restored::CalibrationOnly), "{library}");
            assert_eq!(target.calibration(), source.calibration());
            assert_eq!(target.restore_calibration(&theirs), Ok(()));
            let broken = theirs.replacen("\"calibration\":\"01", "\"calibration\":\"00", 1);
            assert_eq!(target.restore(&broken), Err(SnapshotError::Damaged));
        }
    }
}

/// Written by the first build: the layout of a calibration never changes.
#[test]
fn a_calibration_that_was_kept_long_ago_is_read() {
    let kept = concat!(
        r#"{"magcomp_snapshot":1,"crc32":"47a2412f","library":"0.1.0","calibration":""#,
        "01000000000000f43f000000000000c03f000000000000b0bf000000000000c03f000000000000e83f000000000000a03f000000",
        "000000b0bf000000000000a03f000000000000f03f000000000000344000000000000024c000000000000044400000000000004440",
        r#"","state":""}"#,
    );
    let mut target = compensator(&Config::default());
    assert_eq!(target.restore(kept), Ok(Restored::CalibrationOnly));
    let expected = calibration(&[0.5, -0.25, 1.0, 1.25, 0.75, 1.0, 0.125, -0.0625, 0.03125], 40.0);
    assert_eq!(target.calibration(), Some(expected));
    // and one that is none is refused
    let zeros = format!("01{}", "0".repeat(2 * 8 * 13));
    assert_eq!(target.restore(&sealed(kept, "calibration", &zeros)), Err(SnapshotError::Damaged));
    assert_eq!(target.calibration(), Some(expected));
}

/// Written by the last build of version 1, whose state is laid out otherwise: its calibration alone is taken over.
#[test]
fn a_snapshot_of_version_1_brings_its_calibration() {
    let kept = concat!(
        r#"{"magcomp_snapshot":1,"crc32":"9a9d79c8","library":"0.1.0+e77e4914e69a1b60","calibration":""#,
        "01000000000000f03f7b14ae47e17a943f00000000000000007b14ae47e17a943f5c8fc2f5285cef3f7b14ae47e17a84bf00000000",
        "000000007b14ae47e17a84bf7b14ae47e17af03f0000000000005e4000000000000054c00000000000c072400000000000004840",
        r#"","state":""}"#,
    );
    let m = Matrix3::new(1.0, 0.02, 0.0, 0.02, 0.98, -0.01, 0.0, -0.01, 1.03);
    let expected = Calibration::new(m, Vector3::new(120.0, -80.0, 300.0), 48.0).expect("a phone's");
    let mut target = compensator(&Config::default());
    let today = target.snapshot();
    // even a state that this build would read
    let whole = sealed(&sealed(kept, "state", part(&today, "state")), "library", part(&today, "library"));
    for text in [kept, &whole] {
        Phone::new(52, calibration(&REF, 45.0)).run(&mut target, 20);
        assert_eq!(target.restore(text), Ok(Restored::CalibrationOnly));
        assert_eq!(target.calibration(), Some(expected));
    }
    assert!(today.starts_with(&format!("{{\"magcomp_snapshot\":{SNAPSHOT_VERSION},")));
    let newer = today.replacen(&format!(":{SNAPSHOT_VERSION},"), &format!(":{},", SNAPSHOT_VERSION + 1), 1);
    assert_eq!(target.restore(&newer), Err(SnapshotError::Newer { found: SNAPSHOT_VERSION + 1 }));
}

// 7. and 8. ranges

#[test]
fn a_calibration_no_phone_has_is_refused() {
    let build = |m: f64, b: f64, field: f64| {
        let (m, b) = (Matrix3::identity() * m, Vector3::new(0.0, b, 0.0));
        let both = [Calibration::new(m, b, field).map(|_| ()), Calibration::from_any(m, b, field).map(|_| ())];
        assert_eq!(both[0], both[1]);
        both[0]
    };
    for (m, b, field) in [(1.0, 1e5, 50.0), (1.0, -1e5, 50.0), (1e3, 0.0, 50.0), (1e-3, 0.0, 1e3), (1.0, 0.0, 1.0)] {
        assert_eq!(build(m, b, field), Ok(()), "{m}, {b}, {field}");
    }
    for (m, b, field, expected) in [
        (1.0, 1e6, 50.0, "hard iron component 1000000 uT is outside +-100000 uT; is the unit microtesla?"),
        (1.0, -100_001.0, 50.0, "hard iron component -100001 uT is outside +-100000 uT; is the unit microtesla?"),
        (1.0, 0.0, 0.9, "field strength is 0.9 uT, expected 1 to 1000 uT"),
        (1.0, 0.0, 1001.0, "field strength is 1001 uT, expected 1 to 1000 uT"),
        (1.0, 0.0, -50.0, "field strength is -50 uT, expected 1 to 1000 uT"),
        (1100.0, 0.0, 50.0, "an element of the soft iron matrix or of its inverse is 1100, outside +-1000"),
        (1e-4, 0.0, 50.0, "an element of the soft iron matrix or of its inverse is 10000, outside +-1000"),
    ] {
        let error = build(m, b, field).expect_err(expected);
        assert!(error.to_string().starts_with(expected), "{error}");
    }
    assert!(matches!(build(1.0, 1e300, 50.0), Err(CalibrationError::HardIron { .. })));
    assert!(matches!(build(f64::NAN, 0.0, 50.0), Err(CalibrationError::NotFinite)));
    assert!(Calibration::identity(f64::NAN).is_err() && Calibration::identity(1e-9).is_err());
    assert!(
        serde_json::from_str::<Calibration>(
            r#"{"soft_iron":[1,0,0,0,1,0,0,0,1],"hard_iron_ut":[1e300,0,0],"field_strength_ut":50}"#
        )
        .is_err()
    );
}

/// The extremes of what is allowed do no harm either.
#[test]
fn whatever_calibration_may_be_adopted_does_no_harm() {
    for method in METHODS {
        for (m, b, field) in [(1e3, 1e5, 1.0), (1e-3, -1e5, 1e3), (1.0, 0.0, 1e3), (1.0, 1e5, 50.0), (1e-3, 0.0, 1.0)] {
            let given = Calibration::new(Matrix3::identity() * m, Vector3::repeat(b), field).expect("allowed");
            for adopted in [false, true] {
                let config = Config { method, initial: Some(given).filter(|_| !adopted), ..Config::default() };
                let mut compensator = compensator(&config);
                let mut phone = Phone::new(70, calibration(&REF, 45.0));
                for k in 0..1500 {
                    phone.gyroscope = !(500..1000).contains(&k);
                    if adopted && k % 400 == 100 {
                        compensator.adopt(given, 2.0).unwrap();
                    }
                    let reading = phone.advance(&mut compensator);
                    assert!(is_sound(&reading, &compensator), "{method:?}, {m}, {b}, {field}, sample {k}: {reading:?}");
                    if k % 100 == 50 {
                        let snapshot = compensator.snapshot();
                        assert_eq!(
                            compensator.restore(&snapshot),
                            Ok(Restored::Everything),
                            "{method:?}, {m}, {b}, {field}, {k}"
                        );
                    }
                }
            }
        }
    }
}

#[test]
fn every_number_of_the_config_has_a_range() {
    type Set = fn(&mut Config, f64);
    let fields: [(&str, Set); 9] = [
        ("initial_sigma_ut", |c, v| c.initial_sigma_ut = v),
        ("range_ut", |c, v| c.range_ut = v),
        ("rail_ut", |c, v| c.rail_ut = Some(v)),
        ("field_strength_ut", |c, v| c.field_strength_ut = Some(v)),
        ("windowed.n_max", |c, v| c.windowed.n_max = v as usize),
        ("windowed.sigma_th", |c, v| c.windowed.sigma_th = v),
        ("windowed.noise_floor_ut", |c, v| c.windowed.noise_floor_ut = v),
        ("heading.declination_deg", |c, v| c.heading.declination_deg = Some(v)),
        ("heading.tilt_sigma_deg", |c, v| c.heading.tilt_sigma_deg = v),
    ];
    for (field, set) in fields {
        for value in [1e300, f64::MAX, f64::INFINITY, -1000.0, f64::NAN] {
            let mut config = Config::default();
            set(&mut config, value);
            let error = Compensator::new(config).expect_err(field);
            assert_eq!(error.field, field, "{value}");
            assert!(error.expected.chars().any(|c| c.is_ascii_digit()), "{field}: {}", error.expected);
        }
    }
}

/// What a stored config says: every setting may be left out, and none is unknown.
#[test]
fn a_config_has_sixteen_settings_each_with_a_default() {
    fn settings(value: &serde_json::Value) -> usize {
        value.as_object().map_or(1, |fields| fields.values().map(settings).sum())
    }
    let usual = Config::default();
    assert_eq!(settings(&serde_json::to_value(&usual).expect("plain data")), 16);
    let read = |text: &str| serde_json::from_str::<Config>(text);
    assert_eq!(read("{}").expect("all may be left out"), usual);
    let mut other = usual;
    (other.range_ut, other.windowed.n_min, other.heading.declination_deg) = (5000.0, 50, Some(2.5));
    let text = r#"{"range_ut": 5000, "windowed": {"n_min": 50}, "heading": {"declination_deg": 2.5}}"#;
    assert_eq!(read(text).expect("some may be left out"), other);
    for unknown in [r#"{"range": 5000}"#, r#"{"windowed": {"n": 50}}"#, r#"{"heading": {"field_sigma_ut": 1}}"#] {
        assert!(read(unknown).is_err(), "{unknown}");
    }
}

#[test]
fn a_session_of_orientations_refuses_what_no_sensor_reads() {
    let mut session = ConstantField::new(2);
    assert_eq!(session.add(&Vector3::new(1.0, 2.0, 3.0)), Ok(()));
    let refused = session.add(&Vector3::new(0.0, -1e300, 0.0));
    assert_eq!(refused, Err(RejectReason::OutOfRange { value_ut: -1e300, limit_ut: 100_000.0 }));
    assert_eq!(session.orientations(), 0);
}

#[test]
fn factory_errors_compose_to_numbers_or_are_refused() {
    let good = FactoryErrors { scale: Vector3::repeat(1.0), axes: Matrix3::identity(), offset_ut: Vector3::zeros() };
    let disturbance = Disturbance { soft_iron: Matrix3::identity(), hard_iron_ut: Vector3::new(1.0, 2.0, 3.0) };
    assert_eq!(good.compose(&disturbance), Ok((Matrix3::identity(), Vector3::new(1.0, 2.0, 3.0))));
    let nan = Vector3::new(f64::NAN, 0.0, 0.0);
    for (factory, disturbance) in [
        (FactoryErrors { scale: nan, ..good }, disturbance),
        (FactoryErrors { offset_ut: nan, ..good }, disturbance),
        (
            FactoryErrors { scale: Vector3::repeat(1e200), ..good },
            Disturbance { soft_iron: Matrix3::repeat(1e200), ..disturbance },
        ),
        (good, Disturbance { soft_iron: Matrix3::repeat(f64::INFINITY), ..disturbance }),
        (good, Disturbance { hard_iron_ut: nan, ..disturbance }),
    ] {
        assert_eq!(factory.compose(&disturbance), Err(CalibrationError::NotFinite), "{factory:?}, {disturbance:?}");
    }
    let flat = FactoryErrors { axes: Matrix3::repeat(1.0), ..good };
    assert!(matches!(flat.compose(&disturbance), Err(CalibrationError::Singular { .. })));
}
