//! The last calibration as JSON, which `Calibration` reads in Rust, Kotlin and Swift.

use crate::atomic::write_atomically;
use crate::error::RunError;
use magcomp::Compensator;
use serde_json::{Value, json};
use std::path::Path;

/// Writes the calibration in force to `path`, as [`calibration_json`].
pub fn write_calibration(path: &Path, compensator: &Compensator, recording: &str, time_s: f64) -> Result<(), RunError> {
    let text = calibration_json(compensator, recording, time_s).ok_or_else(|| {
        RunError::Experiment(
            "--calibration: no calibration was found, so none was written; turn the device about more axes".to_owned(),
        )
    })?;
    write_atomically(path, |out| out.write_all(text.as_bytes()))
}

/// The calibration in force, none where there is none: an object with `soft_iron` (the nine elements of M), `hard_iron_ut` (b) and
/// `field_strength_ut` as `Calibration` reads and writes them. Beside them stand `covariance` (nine rows in the order of
/// `covariance_order`; null where it is not known), `format`, `time_s` and `recording`, which `Calibration` passes over.
pub fn calibration_json(compensator: &Compensator, recording: &str, time_s: f64) -> Option<String> {
    let calibration = compensator.calibration()?;
    let covariance = compensator.covariance().map(|covariance| {
        let row = |i: usize| (0..9).map(|j| covariance[(i, j)]).collect::<Vec<f64>>();
        (0..9).map(row).collect::<Vec<_>>()
    });
    let mut object = json!({
        "format": "magcomp calibration 1",
        "recording": recording,
        "time_s": time_s,
        "covariance": covariance,
        "covariance_order": ["b_x", "b_y", "b_z", "m_xx", "m_yy", "m_zz", "m_xy", "m_xz", "m_yz"],
    });
    if let (Value::Object(object), Value::Object(parts)) = (&mut object, json!(calibration)) {
        object.extend(parts);
    }
    Some(serde_json::to_string_pretty(&object).expect("numbers under names") + "\n")
}
