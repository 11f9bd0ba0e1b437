//! Are a recording's units, signs, axes and clocks what they are taken for? Each sensor is asked by another: the gyroscope by the turn of the
//! field and of gravity, the field by its size and turn, gravity by the dip.
//!
//! Nothing here is tuned to a device: that a vector fixed in the world turns against the gyroscope holds for all of them.

mod axes;
mod dip;
mod finding;
mod questions;
mod samples;
mod tested;
mod windows;

use axes::{Askew, Fits, typed};
use dip::{Angle, LEAST_DIP_DEG, angle, corrected, dip_deg};
use finding::Add;
pub use finding::{Conventions, Finding, Streams, Weight};
use magcomp::nalgebra::{Matrix3, Vector3};
use questions::Seen;
pub use tested::{Answer, Tested};
use windows::{Event, Series, Turns, fit, median, windows};

/// Seconds of a window of the field, and of gravity, whose ends are averaged over as long.
const FIELD_S: f64 = 0.5;
const GRAVITY_S: f64 = 1.0;
/// Events of a sensor that are looked at.
const MOST: usize = 1 << 17;
/// Events of the field by which a delay is told: it is tried many times over.
const MOST_FOR_DELAY: usize = 1 << 14;
/// The field's radius without any device is 22 to 67 uT on Earth; iron and magnets near by make it 10 to 150.
const RADII_UT: (f64, f64) = (10.0, 150.0);
const EARTH_UT: (f64, f64) = (22.0, 67.0);
/// Delays that are looked at, and their step, s. A field is followed that is late or early by up to a tenth of a second.
const DELAY_S: f64 = 0.2;
const DELAY_STEP_S: f64 = 0.01;
const FOLLOWED_S: f64 = 0.115;
/// Windows by which a delay is told, s: short ones are sharper. Fewer tell nothing.
const DELAY_WINDOW_S: f64 = 0.3;
const FEWEST: usize = 16;
/// What is left over at the best delay, as a share of the worst: where a part of a recording counts, and where one part alone is enough.
const SHARP: f64 = 0.8;
const VERY_SHARP: f64 = 0.3;
/// The parts agree on a delay to this, s.
const AGREE_S: f64 = 0.015;
/// Share of the rows in which a phone faces down or hangs upside down, from which on that is odd.
const ODD: f64 = 0.6;

fn series(events: &[(i64, Vector3<f64>)], start_ns: i64) -> Series {
    let finite = |(_, value): &&(i64, Vector3<f64>)| value.iter().all(|part| part.is_finite());
    let seconds = |(time_ns, value): &(i64, Vector3<f64>)| ((time_ns - start_ns) as f64 / 1e9, *value);
    events.iter().take(MOST).filter(finite).map(seconds).collect()
}

/// Checks a recording.
pub fn check(streams: &Streams<'_>) -> Conventions {
    let start_ns = streams.field.first().map_or(0, |(time_ns, _)| *time_ns);
    let [field, up, rate] = [streams.field, streams.up, streams.rate].map(|events| series(events, start_ns));
    let mut found = Conventions::default();
    let mut add = |kind, weight, text: String| found.findings.push(Finding { kind, weight, text });
    for (name, numbers, events) in [
        ("magnetometer", field.len(), streams.field),
        ("accelerometer", up.len(), streams.up),
        ("gyroscope", rate.len(), streams.rate),
    ] {
        samples::check_numbers(name, numbers, events.len().min(MOST), &mut add);
    }
    samples::check(&field, &up, &rate, &mut add);
    let has_clock = samples::check_clocks([streams.field, streams.up, streams.rate], &mut add);
    let turns = Turns::of(&rate);
    let of_gravity = Fits::of(&windows(&up, &turns, GRAVITY_S, GRAVITY_S, 0.0), false);
    let field_windows = windows(&field, &turns, FIELD_S, 0.0, 0.0);
    let of_field = Fits::of(&field_windows, true).filter(|_| has_clock);
    let (gravity, field_fits) = (of_gravity.as_ref(), of_field.as_ref());
    check_axes(field_fits, gravity, &field, &up, &mut add);
    let centred = field_fits.filter(|fits| fits.best < 0.6 && fits.fit.roundness > 0.01);
    let about_centre = corrected(&field, centred.map(|fits| fits.fit.offset));
    if let (Some(fits), Some(about_centre)) = (centred, &about_centre) {
        let radius_ut = median(about_centre.iter().map(|(_, value)| value.norm()).collect());
        check_radius(radius_ut, &mut add);
        found.radius_ut = Some(radius_ut);
        if !fits.differs() {
            found.dip_deg = dip_deg(about_centre, &up, &Matrix3::identity());
        }
    }
    let mut add = |kind, weight, text: String| found.findings.push(Finding { kind, weight, text });
    let is_turned = |fits: Option<&Fits>| fits.is_some_and(|fits| fits.differs());
    let askew = Askew::of(&field_windows).filter(|_| field_fits.is_some_and(Fits::agrees));
    if let Some(deg) = askew.and_then(|askew| askew.proven_deg()) {
        let text = format!(
            "the magnetometer is turned by {deg:.0} deg about the screen's normal against the gyroscope, as a module that is glued askew: --frame \
             m=x,y,z,{:.0}",
            -deg
        );
        add("field_askew", Weight::Fault, text);
    }
    let angle = about_centre.as_ref().and_then(|field| angle(field, &up)).filter(|_| has_clock);
    if let Some(Angle::OtherAxes(axes)) = angle.filter(|_| !is_turned(field_fits) && !is_turned(gravity)) {
        let (named, back) = (typed(&axes), typed(&axes.transpose()));
        let text = format!(
            "the angle between gravity and field changes as if one of the two had other axes; it stays the same with --frame a={named}, or with \
             --frame m={back}"
        );
        add("dip_axes", Weight::Fault, text);
    }
    if field_fits.is_some_and(Fits::agrees) {
        found.field_delay_s = delay_s(&field[..field.len().min(MOST_FOR_DELAY)], &turns);
    }
    let mut add = |kind, weight, text: String| found.findings.push(Finding { kind, weight, text });
    if let Some(delay_s) = found.field_delay_s.filter(|delay_s| delay_s.abs() > FOLLOWED_S) {
        let (size_ms, word) = (1000.0 * delay_s.abs(), if delay_s < 0.0 { "early" } else { "late" });
        let text = format!(
            "the field comes {size_ms:.0} ms too {word} for the gyroscope's turns: stamp both with the sensors' own times, or --shift m={:.2}",
            -delay_s
        );
        add("field_delay", Weight::Doubt, text);
    }
    check_sign(streams, &up, found.dip_deg, &mut add);
    found.findings.sort_by_key(|finding| std::cmp::Reverse(finding.weight));
    let seen = Seen { has_clock, field: field_fits, gravity, askew, angle };
    found.tested = seen.tested(&found, streams);
    found
}

/// Units and axes of gyroscope, field and gravity. One that stands alone against the other two is the guilty one.
fn check_axes(field: Option<&Fits>, gravity: Option<&Fits>, events: &Series, up: &Series, add: &mut Add<'_>) {
    let field_differs = field.is_some_and(Fits::differs);
    let gravity_differs = gravity.is_some_and(Fits::differs);
    let unit = [field, gravity].into_iter().flatten().find(|fits| fits.differs() && fits.unit != "rad/s");
    if let Some(fits) = unit {
        let by = if field_differs { "the field's" } else { "gravity's" };
        let axes = if fits.is_turned() { format!(" and --frame g={}", typed(&fits.axes)) } else { String::new() };
        let text = format!("{by} turn says that the gyroscope is in deg/s, not rad/s: --units g=deg/s{axes}");
        add("gyroscope_unit", Weight::Fault, text);
        return;
    }
    let mirrored = field.filter(|fits| field_differs && fits.is_mirror());
    if let Some(fits) = mirrored {
        let axes = typed(&fits.axes);
        let text = format!(
            "the field turns as if an axis of the gyroscope were swapped or flipped; it fits as {axes}: --frame g={axes}"
        );
        add("gyroscope_axes", Weight::Fault, text);
        return;
    }
    match (field, gravity) {
        // both say the same of the gyroscope
        (Some(one), Some(other)) if field_differs && gravity_differs && one.axes == other.axes => {
            let axes = typed(&one.axes);
            let text = format!(
                "field and gravity turn as if the gyroscope's axes were others; it fits as {axes}: --frame g={axes}"
            );
            add("gyroscope_axes", Weight::Fault, text);
        }
        (Some(fits), _) if field_differs => {
            let axes = fits.axes.transpose();
            // a mirror turns as its opposite does: the one whose dip is that of the northern half of the Earth, where most people live
            let centred = corrected(events, Some(fits.fit.offset));
            let dip = centred.and_then(|field| dip_deg(&field, up, &axes));
            let axes = if dip.is_some_and(|dip| dip < -LEAST_DIP_DEG) { -axes } else { axes };
            let (named, other) = (typed(&axes), typed(&-axes));
            let south = if dip.is_some_and(|dip| dip.abs() > LEAST_DIP_DEG) {
                format!(" (south of the magnetic equator m={other})")
            } else {
                format!(" (or m={other})")
            };
            let text = format!(
                "the field turns as if the magnetometer's axes were others; it fits as {named}: --frame m={named}{south}"
            );
            add("field_axes", Weight::Fault, text);
        }
        // accelerations in step with the turns look so too: only where they are small, and hardly anything is left over
        (agreeing, Some(fits)) if gravity_differs && fits.is_turned() => {
            let sizes: Vec<f64> = up.iter().map(|(_, value)| (value.norm() - 9.81).abs()).collect();
            let is_calm = median(sizes) < 0.5;
            let limit = if agreeing.is_some_and(Fits::agrees) { 0.35 } else { 0.6 };
            if is_calm && fits.best < limit {
                let (sensor, option, axes) = if agreeing.is_some_and(Fits::agrees) {
                    ("accelerometer", "a", fits.axes.transpose())
                } else {
                    ("gyroscope", "g", fits.axes)
                };
                let axes = typed(&axes);
                let text = format!(
                    "gravity turns as if the {sensor}'s axes were others; it fits as {axes}: --frame {option}={axes}"
                );
                add(if option == "a" { "accelerometer_axes" } else { "gyroscope_axes" }, Weight::Fault, text);
            }
        }
        _ => {}
    }
}

fn check_radius(radius_ut: f64, add: &mut Add<'_>) {
    if (RADII_UT.0..=RADII_UT.1).contains(&radius_ut) {
        return;
    }
    let units = [
        ("mG", "milligauss", 0.1),
        ("G", "gauss", 100.0),
        ("mT", "millitesla", 1e3),
        ("nT", "nanotesla", 1e-3),
        ("T", "tesla", 1e6),
    ];
    let fitting = units.iter().find(|(_, _, factor)| (EARTH_UT.0..=EARTH_UT.1).contains(&(radius_ut * factor)));
    let hint = fitting.map_or_else(
        || "is it another unit? --units m=FACTOR to uT".to_owned(),
        |(unit, name, _)| format!("{name}? --units m={unit}"),
    );
    let text =
        format!("the field is about {radius_ut:.0} uT wherever it is turned, and the Earth has 22 to 67: {hint}");
    add("field_unit", Weight::Fault, text);
}

/// How late the field is behind the gyroscope: the delay at which least is left over, by each quarter of the recording that tells it
/// sharply; none where they do not agree.
fn delay_s(field: &[Event], turns: &Turns) -> Option<f64> {
    let steps = (DELAY_S / DELAY_STEP_S).round() as i32;
    let shifts: Vec<f64> = (-steps..=steps).map(|step| f64::from(step) * DELAY_STEP_S).collect();
    let quarter = field.len().div_ceil(4).max(1);
    let mut found = Vec::new();
    let mut sharpest: f64 = 1.0;
    for part in field.chunks(quarter) {
        let left = |shift: &f64| {
            let windows = windows(part, turns, DELAY_WINDOW_S, 0.0, *shift);
            if windows.len() < FEWEST { f64::NAN } else { fit(&windows, &Matrix3::identity(), true).left }
        };
        let left: Vec<f64> = shifts.iter().map(left).collect();
        let most = left.iter().copied().fold(f64::NAN, f64::max);
        let least = (1..left.len() - 1).min_by(|a, b| left[*a].total_cmp(&left[*b]));
        let Some(k) = least.filter(|k| left[*k] < SHARP * most && left[*k] <= left[0].min(left[left.len() - 1])) else {
            continue;
        };
        // the lowest point of the parabola through three
        let (before, at, after) = (left[k - 1], left[k], left[k + 1]);
        let bend = before - 2.0 * at + after;
        let part = if bend > 0.0 { (before - after) / bend / 2.0 } else { 0.0 };
        found.push(-(shifts[k] + part * DELAY_STEP_S));
        sharpest = sharpest.min(at / most);
    }
    let middle = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        let half = values.len() / 2;
        if values.len().is_multiple_of(2) { (values[half - 1] + values[half]) / 2.0 } else { values[half] }
    };
    if found.is_empty() || found.len() == 1 && sharpest > VERY_SHARP {
        return None;
    }
    let delay_s = middle(found.clone());
    let off = found.iter().map(|found| (found - delay_s).abs()).collect();
    (middle(off) <= AGREE_S).then_some(delay_s)
}

/// The sign of the accelerometer: by a reference, by the dip, and by how phones are held.
fn check_sign(streams: &Streams<'_>, up: &Series, dip_deg: Option<f64>, add: &mut Add<'_>) {
    let option = "--units a=-m/s2";
    if let Some(share) = down_by_reference(streams).filter(|share| *share > 0.9) {
        let percent = 100.0 * share;
        let text = format!(
            "gravity points down by the reference in {percent:.0} % of the rows: the acceleration is of Apple's sign: {option}"
        );
        add("accelerometer_sign", Weight::Fault, text);
        return;
    }
    if up.len() < 50 || dip_deg.is_some_and(|dip_deg| dip_deg > LEAST_DIP_DEG) {
        return;
    }
    let share =
        |is: &dyn Fn(&Vector3<f64>) -> bool| up.iter().filter(|(_, up)| is(up)).count() as f64 / up.len() as f64;
    let faces_down = share(&|up| up.z < -2.8);
    let is_odd = share(&|up| up.y + up.z < 0.0);
    match dip_deg.filter(|dip_deg| *dip_deg < -LEAST_DIP_DEG) {
        Some(dip_deg) if is_odd > ODD => {
            let text = format!(
                "the phone faces down or hangs upside down in {:.0} % of the rows, and the dip is {dip_deg:.0} deg, as south of the magnetic \
                 equator: if neither is so, the acceleration is of Apple's sign: {option}",
                100.0 * is_odd
            );
            add("accelerometer_sign", Weight::Fault, text);
        }
        Some(dip_deg) => {
            let text = format!(
                "the dip is {dip_deg:.0} deg, as south of the magnetic equator; if you were north of it, the acceleration is of Apple's sign: {option}"
            );
            add("dip_sign", Weight::Note, text);
        }
        None if faces_down > 0.9 => {
            let text = format!(
                "the screen faced down nearly all the time; if it did not, the acceleration is of Apple's sign: {option}"
            );
            add("accelerometer_sign", Weight::Doubt, text);
        }
        None => {}
    }
}

/// The share of rows in which gravity points down by the reference; none without one.
fn down_by_reference(streams: &Streams<'_>) -> Option<f64> {
    let (mut next, mut down, mut all) = (0, 0_u32, 0_u32);
    for (time_ns, attitude) in streams.attitude.iter().take(MOST) {
        while streams.up.get(next + 1).is_some_and(|event| event.0 <= *time_ns) {
            next += 1;
        }
        let up = streams.up.get(next).filter(|event| (event.0 - time_ns).abs() < 100_000_000);
        if let Some((_, up)) = up {
            all += 1;
            down += u32::from((attitude * up).z < 0.0);
        }
    }
    (all >= 50).then(|| f64::from(down) / f64::from(all))
}
