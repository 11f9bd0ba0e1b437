//! A long run of mixed motion through one method, for days of a phone's time, by name:
//! `cargo run --release -p magcomp-tests --example soak -- ...`. What it must show: no change of the hard iron is missed, headings are as sure as
//! they say, memory stays what it was.
//!
//! `soak METHOD SAMPLES STATE.json` goes on from STATE.json, where there is one, and writes it every million samples with one line of progress. A run
//! that goes on adopts the kept calibration, as an app does that was closed. `soak METHOD rest SAMPLES` lies still for that long, then b
//! changes by 20 uT and the phone is turned.

use magcomp::nalgebra::{Rotation3, Vector3};
use magcomp::{Compensator, Config, KeptCalibration, MagneticSample, Method, Reading, RotationRateSample, UpSample};
use magcomp_tests::{REF, Random, calibration};
use serde::{Deserialize, Serialize};
use std::error::Error;
use std::fs;
use std::process::ExitCode;
use std::time::Instant;

type Outcome<T> = Result<T, Box<dyn Error>>;

const PERIOD_NS: i64 = 10_000_000;
/// Written after so many samples.
const BLOCK: u64 = 1_000_000;
/// b is as good as followed when it is known to this, uT: an eighth of the median change.
const FOLLOWED_UT: f64 = 4.0;
/// A change counts as missed when nothing was told of it and b is still wrong by more, in its own sigmas.
const SIGMAS: f64 = 3.0;
/// What an allocator may keep beyond the first block, kB.
const GROWTH_KB: u64 = 2048;

#[derive(Clone, Copy, Deserialize, Serialize)]
enum Motion {
    /// About all axes.
    Turned,
    /// Held level, on a winding way.
    Walk,
    Rest,
}

/// The phone and its world, which hold no random numbers: each block has its own.
#[derive(Clone, Deserialize, Serialize)]
struct Phone {
    time_ns: i64,
    attitude: Rotation3<f64>,
    hard_iron_ut: Vector3<f64>,
    motion: Motion,
    /// Samples until another motion.
    motion_left: u64,
    /// Samples until b changes.
    change_left: u64,
    /// When it did.
    changed_ns: Option<i64>,
}

#[derive(Clone, Default, Deserialize, Serialize)]
struct Counts {
    samples: u64,
    changes: u64,
    /// An event was told between the change and the next.
    told: u64,
    /// b was known again before the next.
    followed: u64,
    /// Neither.
    missed: u64,
    headings: u64,
    beyond_three_sigmas: u64,
    /// Starts from a kept calibration.
    launches: u64,
}

#[derive(Deserialize, Serialize)]
struct State {
    method: Method,
    phone: Phone,
    counts: Counts,
    kept: Option<String>,
}

impl Phone {
    fn new() -> Self {
        let truth = calibration(&REF, 48.0);
        Self {
            time_ns: 0,
            attitude: Rotation3::identity(),
            hard_iron_ut: *truth.hard_iron_ut(),
            motion: Motion::Turned,
            motion_left: 6000,
            change_left: 30_000,
            changed_ns: None,
        }
    }

    fn heading_deg(&self) -> f64 {
        let top = self.attitude * Vector3::y();
        top.x.atan2(top.y).to_degrees()
    }

    /// Another motion and another b where it is time; the first motion after a change may be any, the second turns the phone.
    fn live(&mut self, random: &mut Random) -> bool {
        let changes = self.change_left == 0;
        if changes {
            let away = random.direction() * random.between(10.0, 60.0);
            let start = *calibration(&REF, 48.0).hard_iron_ut();
            // around where it began, so that it stays within a phone's range
            self.hard_iron_ut = start + away;
            self.changed_ns = Some(self.time_ns);
            self.change_left = random.between(18_000.0, 48_000.0) as u64;
            self.motion_left = self.motion_left.min(1500);
        }
        if self.motion_left == 0 {
            let since_s = self.changed_ns.map_or(0.0, |then| (self.time_ns - then) as f64 * 1e-9);
            let any = random.between(0.0, 1.0);
            (self.motion, self.motion_left) = match any {
                _ if since_s < 16.0 => (Motion::Turned, 4000),
                0.0..0.4 => (Motion::Turned, random.between(1000.0, 6000.0) as u64),
                0.4..0.8 => (Motion::Walk, random.between(1000.0, 6000.0) as u64),
                _ => (Motion::Rest, random.between(500.0, 9000.0) as u64),
            };
        }
        self.motion_left -= 1;
        self.change_left -= 1;
        changes
    }

    fn push(&mut self, compensator: &mut Compensator, random: &mut Random) -> Reading {
        let t = self.time_ns as f64 * 1e-9;
        let rate = match self.motion {
            Motion::Turned => Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin()),
            Motion::Rest => Vector3::zeros(),
            Motion::Walk => {
                // a level phone: what tilts it is turned back
                let up = self.attitude.inverse() * Vector3::z();
                up.cross(&Vector3::z()) * -2.0 + up * (0.4 * (0.11 * t).sin()) + Vector3::x() * (0.3 * (11.0 * t).sin())
            }
        };
        self.attitude *= Rotation3::new(rate * 0.01);
        if self.time_ns % (1000 * PERIOD_NS) == 0 {
            self.attitude.renormalize();
        }
        self.time_ns += PERIOD_NS;
        let time_ns = self.time_ns;
        let inverse = self.attitude.inverse();
        let rate_rad_s = rate + random.normal3() * 0.003 + Vector3::new(0.01, -0.02, 0.015);
        let up_m_s2 = inverse * Vector3::new(0.0, 0.0, 9.81) + random.normal3() * 0.05;
        let carried = inverse * Vector3::new(0.0, 0.5, -0.75_f64.sqrt()) * 48.0;
        let soft_iron = *calibration(&REF, 48.0).soft_iron();
        let field_ut = soft_iron * carried + self.hard_iron_ut + random.normal3() * 0.4;
        let _ = compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s });
        let _ = compensator.push_up(UpSample { time_ns, up_m_s2 });
        compensator.push(MagneticSample { time_ns, field_ut })
    }
}

fn hard_iron_error(compensator: &Compensator, truth: &Vector3<f64>) -> Option<(f64, f64)> {
    let error = (compensator.calibration()?.hard_iron_ut() - truth).norm();
    let sigma = compensator.covariance().map(|it| (it[(0, 0)] + it[(1, 1)] + it[(2, 2)]).sqrt());
    Some((error, sigma.unwrap_or(0.0)))
}

/// The change that is over: was it told, is b known?
fn judge(counts: &mut Counts, compensator: &Compensator, phone: &Phone, event_ns: Option<i64>) {
    let Some(changed_ns) = phone.changed_ns else { return };
    let (error, sigma) = hard_iron_error(compensator, &phone.hard_iron_ut).unwrap_or((f64::INFINITY, 0.0));
    let told = event_ns.is_some_and(|decided_ns| decided_ns >= changed_ns);
    let followed = error < FOLLOWED_UT.max(SIGMAS * sigma);
    counts.changes += 1;
    counts.told += u64::from(told);
    counts.followed += u64::from(followed);
    if !told && !followed {
        counts.missed += 1;
        println!("missed: the change at {:.2} s, b is wrong by {error:.1} uT", changed_ns as f64 * 1e-9);
    }
}

fn count_heading(counts: &mut Counts, reading: &Reading, phone: &Phone) {
    let Some(heading) = reading.heading else { return };
    let Some(sigma) = heading.heading_sigma_deg else { return };
    let off = (heading.heading_deg - phone.heading_deg() + 180.0).rem_euclid(360.0) - 180.0;
    counts.headings += 1;
    counts.beyond_three_sigmas += u64::from(off.abs() > SIGMAS * sigma);
}

/// Memory of this process, kB, where the system tells.
fn resident_kb() -> Option<u64> {
    let text = fs::read_to_string("/proc/self/status").ok()?;
    text.lines().find_map(|line| line.strip_prefix("VmRSS:"))?.split_whitespace().next()?.parse().ok()
}

fn compensator(method: Method) -> Outcome<Compensator> {
    Ok(Compensator::new(Config { method, ..Config::default() })?)
}

fn mixed(method: Method, samples: u64, path: &str) -> Outcome<()> {
    let mut compensator = compensator(method)?;
    let mut state = match fs::read_to_string(path) {
        Ok(text) => serde_json::from_str(&text)?,
        Err(_) => State { method, phone: Phone::new(), counts: Counts::default(), kept: None },
    };
    if state.method != method {
        return Err(format!("{path} is of the method {:?}: name that one, or another file", state.method).into());
    }
    if let Some(text) = &state.kept {
        compensator.adopt(&KeptCalibration::from_json(text)?, Some(seconds(&state.phone)));
        state.counts.launches += 1;
    }
    let mut first_kb = None;
    while state.counts.samples < samples {
        let begin = Instant::now();
        // a stream of its own for each block, so that a run goes on with the same numbers
        let mut random = Random::new(9_000_000_000 + state.counts.samples / BLOCK);
        let mut event_ns = None;
        for _ in 0..BLOCK {
            let before = state.phone.clone();
            if state.phone.live(&mut random) {
                judge(&mut state.counts, &compensator, &before, event_ns);
            }
            let reading = state.phone.push(&mut compensator, &mut random);
            event_ns = reading.event.map(|event| event.decided_ns);
            count_heading(&mut state.counts, &reading, &state.phone);
            state.counts.samples += 1;
        }
        state.kept = compensator.keep(seconds(&state.phone)).map(|kept| kept.to_json());
        let next = format!("{path}.next");
        fs::write(&next, serde_json::to_string_pretty(&state)?)?;
        fs::rename(&next, path)?;
        let (now_kb, counts) = (resident_kb().unwrap_or(0), &state.counts);
        let least_kb = *first_kb.get_or_insert(now_kb);
        println!(
            "{:?}: {} million samples, {} changes, told {}, followed {}, missed {}; {} headings, {:.4} % beyond three sigmas; {} kB; {:.0} samples/s",
            method,
            counts.samples / BLOCK,
            counts.changes,
            counts.told,
            counts.followed,
            counts.missed,
            counts.headings,
            100.0 * counts.beyond_three_sigmas as f64 / counts.headings.max(1) as f64,
            now_kb,
            BLOCK as f64 / begin.elapsed().as_secs_f64(),
        );
        if now_kb > least_kb + GROWTH_KB {
            return Err(format!("memory grew from {least_kb} kB to {now_kb} kB").into());
        }
    }
    if state.counts.missed > 0 {
        return Err(format!("{} of {} changes were missed", state.counts.missed, state.counts.changes).into());
    }
    Ok(())
}

fn seconds(phone: &Phone) -> i64 {
    phone.time_ns / 1_000_000_000
}

fn rest(method: Method, samples: u64) -> Outcome<()> {
    let (mut compensator, mut phone, mut random) = (compensator(method)?, Phone::new(), Random::new(9_100_000_000));
    let mut run = |phone: &mut Phone, motion, samples| {
        phone.motion = motion;
        (0..samples).for_each(|_| _ = phone.push(&mut compensator, &mut random));
        let event = phone.push(&mut compensator, &mut random).event;
        (hard_iron_error(&compensator, &phone.hard_iron_ut), event, resident_kb())
    };
    let (known, _, first_kb) = run(&mut phone, Motion::Turned, 6000);
    let (_, at_rest, last_kb) = run(&mut phone, Motion::Rest, samples);
    let changed_ns = phone.time_ns;
    phone.hard_iron_ut += Vector3::new(12.0, -16.0, 0.0);
    let (_, told, _) = run(&mut phone, Motion::Rest, 1000);
    let (after, found, _) = run(&mut phone, Motion::Turned, 6000);
    let new = |event: Option<magcomp::Event>| event.filter(|event| event.decided_ns > changed_ns);
    println!("{method:?}: b wrong by {known:?} (uT, sigma) before {samples} samples at rest, events there {at_rest:?}");
    println!(
        "  told at rest {:?}, told in all {:?}; after a minute of turns b is wrong by {after:?}",
        new(told),
        new(found)
    );
    println!("  memory {first_kb:?} kB before, {last_kb:?} kB after");
    let grew = last_kb.zip(first_kb).is_some_and(|(last, first)| last > first + GROWTH_KB);
    if at_rest.is_some() || grew || !after.is_some_and(|(error, _)| error < FOLLOWED_UT) {
        return Err("something was told at rest, memory grew, or the change was not followed".into());
    }
    Ok(())
}

fn run() -> Outcome<()> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let method = |name: &str| serde_json::from_value::<Method>(name.into());
    match arguments.iter().map(String::as_str).collect::<Vec<_>>()[..] {
        [name, "rest", samples] => rest(method(name)?, samples.parse()?),
        [name, samples, path] => mixed(method(name)?, samples.parse()?, path),
        _ => Err("usage: soak Auto|Adaptive|Windowed|Constant SAMPLES STATE.json, or soak METHOD rest SAMPLES".into()),
    }
}

fn main() -> ExitCode {
    match run() {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("soak: {error}");
            ExitCode::FAILURE
        }
    }
}
