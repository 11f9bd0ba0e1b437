//! The kinds of events a phone delivers, each with its own time and rate.
//!
//! Device frame of all of them: x right, y up along the screen, z out of the screen (Android's and Apple's).

use nalgebra::{UnitQuaternion, Vector3};

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

/// A heading that something else than the magnetometer knows: a GNSS course, a landmark that the user tapped, a corridor of a map.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct HeadingSample {
    /// When it was true, nanoseconds, on the magnetometer's clock: up to 5 s before the latest magnetometer sample.
    pub time_ns: i64,
    /// Degrees clockwise from north, -360 to 360.
    pub heading_deg: f64,
    /// One standard deviation, degrees, above 0 and up to 180. Errors are taken to last for 10 s: ten headings within one second
    /// tell little more than one.
    pub sigma_deg: f64,
    /// Which north.
    pub reference: NorthReference,
    /// What points there.
    pub axis: HeadedAxis,
}

/// The north that a heading counts from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum NorthReference {
    /// True north, as of maps and GNSS. Without `HeadingConfig::declination_deg` the declination is learned from these headings.
    #[default]
    True,
    /// Magnetic north.
    Magnetic,
}

/// What a heading from outside is that of.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum HeadedAxis {
    /// A direction of the device, of any length, device frame: the top edge is (0, 1, 0), the camera (0, 0, -1).
    Device(Vector3<f64>),
    /// A vehicle in which the device lies, turned against it by an angle that does not change: that angle is learned while the vehicle turns.
    /// A device that is moved in its holder is noticed.
    Vehicle,
}

/// An orientation that something else than these sensors knows: ARKit's or ARCore's camera pose.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct AttitudeSample {
    /// When it was true, nanoseconds, on the magnetometer's clock.
    pub time_ns: i64,
    /// Takes a vector of the device frame to a world whose z points up.
    pub to_world: UnitQuaternion<f64>,
    /// What is known of that world's y axis.
    pub yaw: Yaw,
}

/// What is known of the y axis of an outside world.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Yaw {
    /// It points anywhere, and stays: the turns stand in for a gyroscope where that is missing.
    Relative,
    /// It points north.
    Absolute {
        /// One standard deviation, degrees, as of [`HeadingSample::sigma_deg`].
        sigma_deg: f64,
        /// Which north.
        reference: NorthReference,
    },
}

/// From one time to another, s; no pair of times overflows.
pub(crate) fn seconds(from_ns: i64, to_ns: i64) -> f64 {
    to_ns.saturating_sub(from_ns) as f64 * 1e-9
}
