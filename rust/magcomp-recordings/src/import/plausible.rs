//! Checks the units: each sensor's median step of time and median size must be those of a phone. The error about a wrong
//! unit names the option that mends it.

use super::session::Session;
use super::stream::Stream;
use super::units::{GRAVITY_M_S2, Kind};
use crate::error::{Place, RecordingError};
use magcomp::nalgebra::Vector3;

/// Usual steps of sensors, s: 5 kHz to 0.5 Hz.
const STEPS_S: (f64, f64) = (2e-4, 2.0);
/// Events that are looked at, at most, spread over the session.
const LOOKED_AT: usize = 5001;
/// Sizes that may be, and the usual one: raw field, uT; rotation rate, rad/s; both as medians.
const FIELDS_UT: [f64; 3] = [5.0, 5000.0, 50.0];
const RATES_RAD_S: [f64; 3] = [0.0, 20.0, 1.0];
/// Accelerations are in g below this low size and in m/s^2 above. Carried, swung or running phones have 4.6 to 17 m/s^2 there,
/// which is 0.5 to 1.7 g: this is halfway on a scale of ratios.
pub(super) const BETWEEN_G_AND_M_S2: f64 = 2.8;
/// The share of accelerations that are less than the low size. Shocks raise the median, hardly this; free fall lowers the smallest.
const LOW: f64 = 0.2;
/// A median acceleration beyond these, m/s^2, is lively.
const LIVELY_M_S2: (f64, f64) = (5.0, 20.0);

/// Refuses a session whose numbers no phone gives. Returns warnings about numbers that are rare. Where the unit of the times is known, a sensor that
/// has too few events is left out, but not the magnetometer.
pub(super) fn check(session: &mut Session) -> Result<Vec<String>, RecordingError> {
    let is_told = session.is_time_told;
    check_time(&session.raw, "magnetometer", is_told)?;
    for kind in [Kind::Up, Kind::Rate, Kind::System] {
        match check_time(session.stream(kind), kind.word(), is_told) {
            Err(why @ RecordingError::Usage(_)) => {
                *session.stream(kind) = Stream::default();
                session.leave_out(kind.word(), why);
            }
            checked => checked?,
        }
    }
    let fields = [("T", 1e6), ("mT", 1e3), ("G", 100.0), ("nT", 1e-3)];
    for stream in [&session.raw, &session.system] {
        check_size(stream, "a field of 5 to 5000 uT", FIELDS_UT, "m", &fields)?;
    }
    let warnings = check_acceleration(&session.up)?;
    check_size(&session.rate, "a rotation rate below 20 rad/s", RATES_RAD_S, "g", &[("deg/s", 0.01745)])?;
    Ok(warnings)
}

fn check_acceleration(stream: &Stream<Vector3<f64>>) -> Result<Vec<String>, RecordingError> {
    let sizes = sizes(stream);
    let (Some(low), Some(median), Some([_, place])) = (at(&sizes, LOW), at(&sizes, 0.5), &stream.first) else {
        return Ok(Vec::new());
    };
    let in_g = BETWEEN_G_AND_M_S2 / GRAVITY_M_S2;
    if (BETWEEN_G_AND_M_S2..BETWEEN_G_AND_M_S2 * GRAVITY_M_S2).contains(&low) {
        let lively = !(LIVELY_M_S2.0..=LIVELY_M_S2.1).contains(&median);
        let text = || {
            let unit = "a run has such; if it was none, name the unit by --units a=...";
            format!("{}: acceleration is mostly {median:.1} m/s^2: {unit}", place.path.display())
        };
        return Ok(lively.then(text).into_iter().collect());
    }
    let hint = if (in_g..BETWEEN_G_AND_M_S2).contains(&low) {
        "; it looks like g: --units a=g, or a=-g for Apple's sign"
    } else if low < in_g {
        "; is it an acceleration without gravity?"
    } else {
        ""
    };
    let found = format!("mostly {median:.3}{hint}");
    Err(refused(place, "an acceleration of about 9.8 m/s^2 at times", &found))
}

/// A size that few accelerations are below, by which their unit can be told.
pub(super) fn low_size(stream: &Stream<Vector3<f64>>) -> Option<f64> {
    at(&sizes(stream), LOW)
}

/// Sizes of events spread over a session, the smallest first.
fn sizes(stream: &Stream<Vector3<f64>>) -> Vec<f64> {
    let every = stream.events.len().div_ceil(LOOKED_AT).max(1);
    let mut sizes: Vec<f64> = stream.events.iter().step_by(every).map(|(_, value)| value.norm()).collect();
    sizes.retain(|size| size.is_finite());
    sizes.sort_by(f64::total_cmp);
    sizes
}

/// The value below which this share of sorted values is.
fn at(sorted: &[f64], share: f64) -> Option<f64> {
    sorted.get((sorted.len() as f64 * share) as usize).copied()
}

fn check_time(stream: &Stream<Vector3<f64>>, sensor: &str, is_told: bool) -> Result<(), RecordingError> {
    let mut steps: Vec<f64> = stream.events.windows(2).map(|pair| (pair[1].0 - pair[0].0) as f64 / 1e9).collect();
    steps.sort_by(f64::total_cmp);
    let (Some(step_s), Some([time, _])) = (steps.get(steps.len() / 2).copied(), &stream.first) else { return Ok(()) };
    if (STEPS_S.0..=STEPS_S.1).contains(&step_s) {
        return Ok(());
    }
    if is_told {
        let span_s = steps.iter().sum::<f64>();
        let (path, events) = (time.path.display(), stream.events.len());
        let few =
            if step_s > STEPS_S.1 { "few: a turn is over before it is seen" } else { "many: are times repeated?" };
        let how_often = if step_s >= 1.0 { format!("{step_s:.0} s") } else { format!("{step_s} s") };
        let text = format!(
            "{path}: {events} {sensor} events in {span_s:.0} s, one each {how_often}: too {few}; record at 25 to 200 Hz"
        );
        return Err(RecordingError::Usage(text));
    }
    let units = [("ns", "nanoseconds", 1e-9), ("us", "microseconds", 1e-6), ("ms", "milliseconds", 1e-3)];
    let fitting = units.iter().find(|(.., factor)| (STEPS_S.0..=STEPS_S.1).contains(&(step_s * factor)));
    let hint = match fitting {
        Some((unit, name, _)) => format!("too few events, or time looks like {name}: --units t={unit}"),
        None => "name the unit by --units t=s, ms, us or ns".to_owned(),
    };
    Err(refused(time, "steps of 0.2 ms to 2 s", &format!("steps of {step_s} s; {hint}")))
}

fn check_size(
    stream: &Stream<Vector3<f64>>,
    expected: &str,
    [low, high, usual]: [f64; 3],
    option: &str,
    units: &[(&str, f64)],
) -> Result<(), RecordingError> {
    let (Some(size), Some([_, value])) = (at(&sizes(stream), 0.5), &stream.first) else { return Ok(()) };
    if (low..=high).contains(&size) {
        return Ok(());
    }
    // of the units that fit, the one that comes closest to the usual size
    let far = |factor: f64| (size * factor / usual).ln().abs();
    let fitting = units.iter().filter(|(_, factor)| (low..=high).contains(&(size * factor)));
    let fitting = fitting.min_by(|(_, a), (_, b)| far(*a).total_cmp(&far(*b)));
    let hint = fitting.map_or_else(String::new, |(unit, _)| format!("; it looks like {unit}: --units {option}={unit}"));
    Err(refused(value, expected, &format!("mostly {size:.3}{hint}")))
}

fn refused(place: &Place, expected: &str, found: &str) -> RecordingError {
    RecordingError::Form { place: place.clone(), expected: expected.to_owned(), found: found.to_owned() }
}
