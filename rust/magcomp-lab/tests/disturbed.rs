//! Disturbed or changed, from the magnetometer alone and with gravity: a place whose field changes by 20 uT for ten seconds,
//! a device whose hard iron does, and recordings where nothing does. The accelerometer is that of a shaking hand.

use magcomp::nalgebra::Vector3;
use magcomp::{Compensator, Config, Method, Status};
use magcomp_lab::catalogue::{By, CHANGE_S, Happening, PLACE_S, PhoneChange, Variant, phone};
use magcomp_lab::motion::Motion;
use magcomp_lab::simulate::Simulation;
use magcomp_recordings::recording::read;
use magcomp_replay::{Ignore, replay};

/// Standard deviation of the accelerometer's noise, m/s^2: a hand that shakes, not the sensor.
const SHAKE_M_S2: f64 = 0.3;

fn stream(seed: u64, motion: Motion, change: PhoneChange) -> Simulation {
    let mut variant = phone("shaken", motion, change).in_an_even_place();
    variant.sensors = variant.sensors.without_gyroscope();
    variant.sensors.accel_noise = SHAKE_M_S2;
    variant.stream(seed)
}

struct Seen {
    statuses: Vec<Status>,
    hard_iron_ut: Vec<Option<Vector3<f64>>>,
    errors_deg: Vec<f64>,
}

fn follow(stream: &Simulation, gravity: bool) -> Seen {
    follow_by(Config { method: Method::Adaptive, ..Config::default() }, stream, gravity)
}

fn follow_by(config: Config, stream: &Simulation, gravity: bool) -> Seen {
    let mut compensator = Compensator::new(config).expect("a valid config");
    let mut ups = stream.ups.iter().peekable();
    let mut seen = Seen { statuses: Vec::new(), hard_iron_ut: Vec::new(), errors_deg: Vec::new() };
    for (sample, truth) in stream.magnetic.iter().zip(&stream.truth) {
        while let Some(up) = ups.next_if(|up| up.time_ns <= sample.time_ns) {
            if gravity {
                compensator.push_up(*up).expect("events in order");
            }
        }
        seen.statuses.push(compensator.push(*sample).status);
        let found = compensator.calibration();
        seen.hard_iron_ut.push(found.map(|found| *found.hard_iron_ut()));
        let error = found.map(|found| found.correct(&truth.clean_ut).angle(&truth.field_ut).to_degrees());
        seen.errors_deg.push(error.unwrap_or(90.0));
    }
    seen
}

/// Samples from the change to the end of the disturbance, and to its having been over for a second and a half.
const CHANGED: usize = (CHANGE_S * 100.0) as usize;
const OVER: usize = ((CHANGE_S + PLACE_S) * 100.0) as usize;
const SETTLED: usize = OVER + 200;

impl Seen {
    fn disturbed(&self, range: std::ops::Range<usize>) -> impl Iterator<Item = usize> {
        range.filter(|k| matches!(self.statuses[*k], Status::Disturbed { .. }))
    }

    /// How far b has gone from where it was before the change, uT.
    fn moved_ut(&self, range: std::ops::Range<usize>) -> f64 {
        let before = self.hard_iron_ut[CHANGED - 1].expect("a calibration");
        self.hard_iron_ut[range].iter().flatten().map(|b| (b - before).norm()).fold(0.0, f64::max)
    }
}

#[test]
fn with_gravity_a_disturbed_place_is_reported_and_not_learned() {
    let (mut reported, mut kept) = (0, 0);
    for seed in 900..932 {
        let seen = follow(&stream(seed, Motion::Tumble, PhoneChange::Place), true);
        let first = seen.disturbed(CHANGED..OVER).next().map(|k| k - CHANGED);
        let share = seen.disturbed(CHANGED + 300..OVER).count() as f64 / (OVER - CHANGED - 300) as f64;
        let (moved, end) = (seen.moved_ut(CHANGED..seen.statuses.len()), seen.errors_deg[SETTLED..].iter());
        let worst = end.fold(0.0_f64, |worst, error| worst.max(*error));
        let late = seen.disturbed(SETTLED..seen.statuses.len()).count();
        println!(
            "{seed}: disturbed after {first:?}, {:.0} % of the time from 3 s on; b by {moved:.2} uT; then {worst:.2} deg, \
             disturbed for {late} samples more",
            100.0 * share
        );
        reported += usize::from(first.is_some_and(|samples| samples <= 400) && share > 0.9);
        kept += usize::from(worst < 2.0);
    }
    // a device that is hardly turned while the field changes may have changed as well: that is weighed, and b moves meanwhile
    // 18 and 19 were found; where half of the runs are right, 10 or fewer of 32 are seen once in 40
    assert!(reported > 10 && kept > 10, "reported {reported}, kept {kept} of 32");
}

/// Rms over 16 runs, degrees, from 10 to 30 s after b began to drift for 30 s and in the 30 s after that, and in how many of them
/// an error ever exceeds 20 degrees; in rooms that may be uneven, as they are by default. Walking the calibration of an earlier
/// session is given.
fn late_drift(motion: Motion, rate_ut_s: f64, begins_s: f64) -> ([f64; 2], usize) {
    let mut errors = Vec::new();
    for seed in 900..916 {
        let gone_ut = Vector3::new(0.6, -0.5, 0.62).normalize() * (rate_ut_s * 30.0);
        let by = By::Offset([gone_ut.x, gone_ut.y, gone_ut.z]);
        let variant = Variant {
            duration_s: begins_s + 60.0,
            happens: vec![Happening::Ramp { from_s: begins_s, over_s: 30.0, by }],
            is_known: motion != Motion::Tumble,
            ..phone("late-drift", motion, PhoneChange::Nothing).in_an_even_place()
        };
        let scenario = variant.scenario(seed);
        let initial = variant.initial(&scenario);
        let config = Config { method: Method::Adaptive, initial, ..Config::default() };
        errors.push(follow_by(config, &scenario.run(), false).errors_deg);
    }
    let of = |from_s: f64, to_s: f64| {
        let range = ((begins_s + from_s) * 100.0) as usize..((begins_s + to_s) * 100.0) as usize;
        errors.iter().flat_map(move |run| run[range.clone()].iter().copied()).collect::<Vec<f64>>()
    };
    let rms = |values: Vec<f64>| (values.iter().map(|error| error * error).sum::<f64>() / values.len() as f64).sqrt();
    let begins = (begins_s * 100.0) as usize;
    let far = errors.iter().filter(|run| run[begins..].iter().any(|error| *error > 20.0)).count();
    ([rms(of(10.0, 30.0)), rms(of(30.0, 60.0))], far)
}

#[test]
fn a_drift_that_begins_late_is_followed() {
    for (motion, rate_ut_s, begins_s, limits, most_far) in [
        (Motion::Tumble, 0.5, 30.0, [1.0, 0.6], 0),
        (Motion::Tumble, 0.1, 60.0, [1.0, 0.5], 0),
        (Motion::Stroll, 0.5, 30.0, [1.3, 0.9], 0),
        (Motion::Stroll, 1.0, 10.0, [1.4, 0.9], 0),
    ] {
        let (found, far) = late_drift(motion, rate_ut_s, begins_s);
        println!("{motion:?}, {rate_ut_s} uT/s from {begins_s} s: {found:.2?} deg, {far} runs over 20 deg");
        assert!(found.iter().zip(limits).all(|(found, limit)| *found < limit), "{motion:?}, {rate_ut_s}: {found:?}");
        assert!(far <= most_far, "{motion:?}, {rate_ut_s}: {far} runs over 20 deg");
    }
}

#[test]
fn with_gravity_a_device_that_changes_is_relearned_nearly_as_soon() {
    let (mut with, mut without) = (Vec::new(), Vec::new());
    for seed in 920..936 {
        let stream = stream(seed, Motion::Tumble, PhoneChange::Offset);
        for (gravity, settled) in [(true, &mut with), (false, &mut without)] {
            let seen = follow(&stream, gravity);
            let last = seen.errors_deg[CHANGED..].iter().rposition(|error| *error > 5.0);
            settled.push(last.map_or(0, |last| last + 1));
        }
    }
    println!("below 5 deg after, with gravity: {with:?}, without: {without:?}");
    with.sort_unstable();
    without.sort_unstable();
    assert!(with[8] < 150 && with[8] < without[8] + 50, "median {} against {}", with[8], without[8]);
}

#[test]
fn on_recordings_of_undisturbed_places_nothing_is_reported() {
    let path =
        std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../tests/recordings/broad_01_slow_rotation_A.csv.gz");
    let recording = read(&path).expect("a recording");
    let config = Config { method: Method::Adaptive, ..Config::default() };
    let steps = replay(&recording, &config, Ignore { gyroscope: true, ..Ignore::default() }).expect("a valid config");
    let disturbed = steps.iter().filter(|step| matches!(step.reading.status, Status::Disturbed { .. })).count();
    assert_eq!(disturbed, 0, "of {}", steps.len());
}
