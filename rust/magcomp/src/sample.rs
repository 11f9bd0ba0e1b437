//! The three kinds of events a phone delivers, each with its own time and rate.
//!
//! Device frame of all of them: x right, y up along the screen, z out of the screen (Android's and Apple's).

use nalgebra::Vector3;

/// One raw magnetometer event.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct MagneticSample {
    /// Time of the event, nanoseconds, strictly increasing from one sample to the next.
    pub time_ns: i64,
    /// Raw (uncalibrated) field, microtesla, device frame.
    pub field_ut: Vector3<f64>,
}

/// One gyroscope event.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RotationRateSample {
    /// Time of the event, nanoseconds, on the magnetometer's clock.
    pub time_ns: i64,
    /// Angular rate of the device, rad/s, device frame, counter-clockwise positive.
    pub rate_rad_s: Vector3<f64>,
}

/// One accelerometer or gravity event.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct UpSample {
    /// Time of the event, nanoseconds, on the magnetometer's clock.
    pub time_ns: i64,
    /// What an accelerometer at rest reads: pointing up, m/s^2, device frame (Android's sign).
    pub up_m_s2: Vector3<f64>,
}
