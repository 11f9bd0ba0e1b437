//! Checks the units: each sensor's median step of time and median size must be those of a phone. The error about a wrong
//! unit names the option that mends it.

use super::session::{Session, Stream};
use crate::error::{LabError, Place};
use magcomp::nalgebra::Vector3;

/// Usual steps of sensors, s: 5 kHz to 0.5 Hz.
const STEPS_S: (f64, f64) = (2e-4, 2.0);
/// Events that are looked at, at most, spread over the session.
const LOOKED_AT: usize = 5001;
/// Sizes that may be, and the usual one: raw field, uT; acceleration, m/s^2; rotation rate, rad/s.
const FIELDS_UT: [f64; 3] = [5.0, 5000.0, 50.0];
const ACCELERATIONS_M_S2: [f64; 3] = [5.0, 20.0, 9.8];
const RATES_RAD_S: [f64; 3] = [0.0, 20.0, 1.0];

/// Refuses a session whose numbers no phone gives.
pub(super) fn check(session: &Session) -> Result<(), LabError> {
    for stream in [&session.raw, &session.up, &session.rate, &session.system] {
        check_time(stream)?;
    }
    let fields = [("T", 1e6), ("mT", 1e3), ("G", 100.0), ("nT", 1e-3)];
    for stream in [&session.raw, &session.system] {
        check_size(stream, "a field of 5 to 5000 uT", FIELDS_UT, "m", &fields)?;
    }
    check_size(&session.up, "an acceleration of about 9.8 m/s^2", ACCELERATIONS_M_S2, "a", &[("g", 9.80665)])?;
    check_size(&session.rate, "a rotation rate below 20 rad/s", RATES_RAD_S, "g", &[("deg/s", 0.01745)])
}

fn check_time(stream: &Stream<Vector3<f64>>) -> Result<(), LabError> {
    let mut steps: Vec<f64> = stream.events.windows(2).map(|pair| (pair[1].0 - pair[0].0) as f64 / 1e9).collect();
    steps.sort_by(f64::total_cmp);
    let (Some(step_s), Some([time, _])) = (steps.get(steps.len() / 2).copied(), &stream.first) else { return Ok(()) };
    if (STEPS_S.0..=STEPS_S.1).contains(&step_s) {
        return Ok(());
    }
    let units = [("ns", "nanoseconds", 1e-9), ("us", "microseconds", 1e-6), ("ms", "milliseconds", 1e-3)];
    let fitting = units.iter().find(|(.., factor)| (STEPS_S.0..=STEPS_S.1).contains(&(step_s * factor)));
    let hint = match fitting {
        Some((unit, name, _)) => format!("time looks like {name}: --units t={unit}"),
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
) -> Result<(), LabError> {
    let every = stream.events.len().div_ceil(LOOKED_AT).max(1);
    let mut sizes: Vec<f64> = stream.events.iter().step_by(every).map(|(_, value)| value.norm()).collect();
    sizes.retain(|size| size.is_finite());
    sizes.sort_by(f64::total_cmp);
    let (Some(size), Some([_, value])) = (sizes.get(sizes.len() / 2).copied(), &stream.first) else { return Ok(()) };
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

fn refused(place: &Place, expected: &str, found: &str) -> LabError {
    LabError::Recording { place: place.clone(), expected: expected.to_owned(), found: found.to_owned() }
}
