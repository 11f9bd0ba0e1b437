//! What a sensor's samples show by themselves: an axis that is dead, a field that was interpolated or held, two kinds of samples in one
//! stream, a rate too low, another clock, an axis that points up.

use super::finding::{Add, Weight};
use super::windows::{Event, Series, median};
use magcomp::nalgebra::{Matrix3, Vector3};

/// Fewer samples tell nothing.
pub(super) const FEWEST: usize = 50;
/// Fewer say nothing of an axis that never changes while the others change by some uT, m/s^2 or rad/s.
const FEWEST_OF_DEAD: usize = 500;
/// A magnetometer below this rate, and a gyroscope below the other, Hz.
const LEAST_FIELD_HZ: f64 = 4.0;
const LEAST_RATE_HZ: f64 = 10.0;
/// A step between samples of a second kind is larger than this, uT.
const LEAST_STEP_UT: f64 = 3.0;
/// The two kinds' difference has one direction in the device over this time, s; from this share on it is theirs.
const HELD_S: f64 = 10.0;
const FIXED: f64 = 0.8;
/// The device turns, rad/s.
const TURNING_RAD_S: f64 = 0.3;

pub(super) fn check(field: &Series, up: &Series, rate: &Series, add: &mut Add<'_>) {
    check_dead("magnetometer", "mx,my,mz", 5.0, field, add);
    check_dead("accelerometer", "ax,ay,az", 2.0, up, add);
    check_dead("gyroscope", "gx,gy,gz", 0.5, rate, add);
    check_kinds(field, add);
    check_interpolated(field, rate, add);
    check_rate(field, rate, add);
}

fn check_dead(name: &str, columns: &str, least_range: f64, series: &Series, add: &mut Add<'_>) {
    let Some((_, first)) = series.first().filter(|_| series.len() >= FEWEST_OF_DEAD) else { return };
    let is_dead = |axis: &usize| series.iter().all(|(_, value)| value[*axis] == first[*axis]);
    let (dead, alive): (Vec<usize>, Vec<usize>) = (0..3).partition(is_dead);
    let range = |axis: &usize| {
        let values = || series.iter().map(|(_, value)| value[*axis]);
        values().fold(f64::MIN, f64::max) - values().fold(f64::MAX, f64::min)
    };
    let axes: Vec<&str> = dead.iter().map(|axis| ["x", "y", "z"][*axis]).collect();
    let text = match dead.len() {
        0 => return,
        3 => format!("the {name} says the same throughout: is its sensor off? leave {columns} out"),
        _ if alive.iter().map(range).fold(0.0, f64::max) < least_range => return,
        _ => format!(
            "the {name}'s {} never {}: is it in the file under another name ({columns})?",
            axes.join(" and "),
            if dead.len() == 1 { "changes" } else { "change" }
        ),
    };
    let weight = if name == "magnetometer" && dead.len() < 3 { Weight::Fault } else { Weight::Doubt };
    add("dead_axis", weight, text);
}

/// Samples that are no numbers, of so many of a sensor.
pub(super) fn check_numbers(name: &str, numbers: usize, all: usize, add: &mut Add<'_>) {
    let share = 1.0 - numbers as f64 / all.max(1) as f64;
    if all >= FEWEST && share > 0.05 {
        let weight = if share > 0.5 { Weight::Fault } else { Weight::Doubt };
        let text = format!(
            "{:.0} % of the {name}'s samples are no numbers: was it switched off, or are its cells cut?",
            100.0 * share
        );
        add("no_numbers", weight, text);
    }
}

/// Two kinds of samples in one stream, such as calibrated and raw ones: steps from one to the other are all the same. A field of the mains that is sampled
/// about twice a period steps to and fro as well, but in the world's axes and not in the device's, and it beats.
fn check_kinds(field: &Series, add: &mut Add<'_>) {
    if field.len() < FEWEST {
        return;
    }
    let steps: Vec<Vector3<f64>> = field.windows(2).map(|pair| pair[1].1 - pair[0].1).collect();
    let mut sizes: Vec<f64> = steps.iter().map(Vector3::norm).collect();
    let over_two = median(field.windows(3).map(|three| (three[2].1 - three[0].1).norm()).collect());
    sizes.sort_by(f64::total_cmp);
    // by turns; or now and then, each step alike
    let usual = sizes[sizes.len() / 2];
    let by_turns = usual > LEAST_STEP_UT && over_two < 0.4 * usual;
    if by_turns && device_share(field) < FIXED {
        let text = format!(
            "a field of about {:.0} uT swings with half the rate of the samples, as the mains' does beside cables and supplies: it is the place's, and \
             does little harm",
            usual / 2.0
        );
        add("hum", Weight::Note, text);
        return;
    }
    let large_ut = (6.0 * sizes[sizes.len() / 4]).max(LEAST_STEP_UT);
    let large: Vec<&Vector3<f64>> = steps.iter().filter(|step| step.norm() > large_ut).collect();
    let is_common = large.len() as f64 > 0.05 * steps.len() as f64;
    let alike = large.first().map_or(0.0, |first| {
        let sum: Vector3<f64> = large.iter().map(|step| *step * step.dot(first).signum()).sum();
        sum.norm() / large.iter().map(|step| step.norm()).sum::<f64>()
    });
    if by_turns || is_common && alike > 0.95 {
        let step_ut = if by_turns { usual } else { median(large.iter().map(|step| step.norm()).collect()) };
        let text = format!(
            "two kinds of samples are in the magnetometer's stream, {step_ut:.0} uT apart: calibrated and uncalibrated ones? record one kind, or \
             take the columns of one: --columns"
        );
        add("two_kinds", Weight::Doubt, text);
    }
}

/// The share of what swings from sample to sample that has one direction in the device throughout, 0 to 1.
fn device_share(field: &Series) -> f64 {
    let swing = |(k, three): (usize, &[Event])| {
        let sign = if k % 2 == 0 { 0.25 } else { -0.25 };
        (three[0].1 - three[1].1 * 2.0 + three[2].1) * sign
    };
    let swings: Vec<Vector3<f64>> = field.windows(3).enumerate().map(swing).collect();
    let size = swings.iter().map(Vector3::norm).sum::<f64>() / swings.len().max(1) as f64;
    // a sample that was lost changes the sign of all that follow
    let span_s = field.last().map_or(0.0, |last| last.0 - field[0].0);
    let block = ((HELD_S / span_s.max(HELD_S) * swings.len() as f64) as usize).max(1);
    let mut squares = Matrix3::zeros();
    let blocks = swings.chunks(block).map(|block| block.iter().sum::<Vector3<f64>>() / block.len() as f64);
    let mut count = 0.0;
    for mean in blocks {
        squares += mean * mean.transpose();
        count += 1.0;
    }
    (squares.symmetric_eigenvalues().max() / count).max(0.0).sqrt() / size.max(f64::MIN_POSITIVE)
}

/// A field that a logger interpolated or held between fewer samples of the sensor.
fn check_interpolated(field: &Series, rate: &Series, add: &mut Add<'_>) {
    let (mut next, mut straight, mut same, mut all) = (0, 0_usize, 0_usize, 0_usize);
    for three in field.windows(3) {
        while rate.get(next + 1).is_some_and(|event| event.0 <= three[1].0) {
            next += 1;
        }
        // at rest a coarse sensor says the same anyway
        let turns = rate.get(next).is_some_and(|event| event.1.norm() > TURNING_RAD_S);
        let (before, after) = (three[1].1 - three[0].1, three[2].1 - three[1].1);
        if !turns {
            continue;
        }
        all += 1;
        if after == Vector3::zeros() {
            same += 1;
        } else if before != Vector3::zeros() && (after - before).norm() < 0.01 * after.norm() {
            straight += 1;
        }
    }
    if all < FEWEST {
        return;
    }
    let hz = hz(field);
    // a field that is held misleads less: its repeated values show themselves
    for (count, word, weight) in [(straight, "interpolated", Weight::Doubt), (same, "held", Weight::Note)] {
        let share = count as f64 / all as f64;
        if share > 0.4 {
            let true_hz = hz * (1.0 - share);
            let text = format!(
                "the field is {word}: of its {hz:.0} samples a second about {true_hz:.0} are the sensor's own; save each sensor with its own times"
            );
            add("field_interpolated", weight, text);
        }
    }
}

fn hz(series: &Series) -> f64 {
    median(series.windows(2).map(|pair| pair[1].0 - pair[0].0).collect()).recip()
}

fn check_rate(field: &Series, rate: &Series, add: &mut Add<'_>) {
    if field.len() < 20 {
        return;
    }
    let (field_hz, rate_hz) = (hz(field), hz(rate));
    if field_hz < LEAST_FIELD_HZ {
        let text = format!(
            "the magnetometer has {field_hz:.1} samples a second: a turn is over before it is seen; record at 25 Hz or more"
        );
        add("rate_low", Weight::Doubt, text);
    } else if rate.len() >= 20 && rate_hz < LEAST_RATE_HZ {
        let text = format!(
            "the gyroscope has {rate_hz:.1} samples a second, too few to follow a turn; record at 25 Hz or more"
        );
        add("rate_low", Weight::Doubt, text);
    }
}

/// Whether accelerometer and gyroscope have the magnetometer's clock.
pub(super) fn check_clocks(streams: [&[(i64, Vector3<f64>)]; 3], add: &mut Add<'_>) -> bool {
    let span = |events: &[(i64, Vector3<f64>)]| Some((events.first()?.0, events.last()?.0));
    let [field, others @ ..] = streams;
    let Some((first_ns, last_ns)) = span(field) else { return false };
    let mut all = true;
    for (events, name, option) in [(others[0], "accelerometer", "a"), (others[1], "gyroscope", "g")] {
        let Some((begin_ns, end_ns)) = span(events).filter(|_| events.len().min(field.len()) >= FEWEST) else {
            continue;
        };
        let common_ns = last_ns.min(end_ns) - first_ns.max(begin_ns);
        let shorter_ns = (last_ns - first_ns).min(end_ns - begin_ns);
        if common_ns < shorter_ns / 2 {
            let off_s = (first_ns - begin_ns) as f64 / 1e9;
            let text = format!(
                "the {name} runs on another clock: it begins {:.1} s {} the magnetometer; if they began together, --shift {option}={off_s:.3}",
                off_s.abs(),
                if off_s > 0.0 { "before" } else { "after" }
            );
            add("clock", Weight::Fault, text);
            all = false;
        }
    }
    all
}
