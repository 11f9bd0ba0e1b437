//! Events in and answers out as plain numbers, for the paths that carry no records: C takes the answer as it stands, JNI writes it out as doubles.
//!
//! `include/magcomp.h` says what every number means, `reading` and `status` have the structs. What is not known is NaN, or -1 where a number is a code.

use crate::compensator::Compensator;
use crate::error::MagcompError;
use crate::reading::FlatReading;
use crate::record::{MagneticSample, RotationRateSample, UpSample, Vector3};

/// The handle's object is closed or gone.
pub(crate) const CLOSED: i32 = -1;
/// A panic was caught, now or before.
pub(crate) const PANICKED: i32 = -2;
/// An event was accepted; a rejected one answers 1 or more, by its reason.
pub(crate) const ACCEPTED: i32 = 0;

/// A raw magnetometer event, uT; `reported_ut` is the operating system's own hard iron, NaN for none.
pub(crate) fn push(
    compensator: &Compensator,
    time_ns: i64,
    field_ut: Vector3,
    reported_ut: Vector3,
) -> Result<(FlatReading, Option<magcomp::Pointing>), i32> {
    let known = !(reported_ut.x.is_nan() || reported_ut.y.is_nan() || reported_ut.z.is_nan());
    let sample = MagneticSample { time_ns, field_ut, reported_hard_iron_ut: known.then_some(reported_ut) };
    compensator
        .push_for(sample, |(reading, pointing), jump_ut| (FlatReading::of(reading, jump_ut), *pointing))
        .map_err(|error| code_of(&error))
}

/// A gyroscope event, rad/s.
pub(crate) fn push_rotation_rate(compensator: &Compensator, time_ns: i64, rate_rad_s: Vector3) -> i32 {
    event_code(compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s }))
}

/// An accelerometer or gravity event, m/s^2, pointing up.
pub(crate) fn push_up(compensator: &Compensator, time_ns: i64, up_m_s2: Vector3) -> i32 {
    event_code(compensator.push_up(UpSample { time_ns, up_m_s2 }))
}

pub(crate) fn event_code(result: Result<(), MagcompError>) -> i32 {
    match result {
        Ok(()) => ACCEPTED,
        Err(MagcompError::EventRejected { reason }) => reason.code(),
        Err(error) => code_of(&error),
    }
}

pub(crate) fn code_of(error: &MagcompError) -> i32 {
    match error {
        MagcompError::Panicked { .. } => PANICKED,
        // no other error comes from those who ask
        _ => CLOSED,
    }
}

#[cfg(test)]
mod tests {
    use crate::status::{EventKind, FlatStatus, Status};
    use serde_json::{Value, json};

    #[test]
    fn every_status_has_the_codes_and_numbers_that_kotlin_and_swift_read() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/vectors/statuses.json");
        let all: Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        for case in all["statuses"].as_array().unwrap() {
            let status: magcomp::Status = ron::from_str(case["status"].as_str().unwrap()).unwrap();
            let FlatStatus { kind, reason, problem, whole, real } = Status::from(status).into();
            assert_eq!(json!([kind, reason, problem]), case["border"]);
            let count = |key: &str| case[key].as_array().map_or(0, Vec::len);
            let (whole, rest) = whole.split_at(count("whole"));
            assert!(whole.is_empty() || json!(whole) == case["whole"] && rest.iter().all(|it| *it == 0), "{case}");
            let (real, rest) = real.split_at(count("real"));
            assert!(real.is_empty() || json!(real) == case["real"] && rest.iter().all(|it| it.is_nan()), "{case}");
        }
        for case in all["events"].as_array().unwrap() {
            let kind: magcomp::EventKind = ron::from_str(case["kind"].as_str().unwrap()).unwrap();
            assert_eq!(case["border"], EventKind::from(kind).code());
        }
    }
}
