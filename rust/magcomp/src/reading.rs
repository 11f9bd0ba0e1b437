//! What one `push` answers: the corrected sample, the heading, and in `status` what the compensator is doing.

use crate::attitude::Attitude;
use crate::ellipsoid::FitError;
use crate::heading::Heading;
use alloc::{format, string::String};
use nalgebra::Vector3;

/// The answer to one magnetometer sample. What is not known is None, never NaN.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct Reading {
    /// Time of the sample, nanoseconds.
    pub time_ns: i64,
    /// The corrected sample M^-1 (h_m - b), uT, device frame. None until there is a calibration, and for a rejected sample.
    pub field_ut: Option<Vector3<f64>>,
    /// The estimator's own, smoother estimate of the same vector, uT, where it has one; the heading comes from it.
    pub filtered_field_ut: Option<Vector3<f64>>,
    /// One standard deviation of `field_ut` per axis, uT. None without `field_ut` or a known covariance.
    pub field_sigma_ut: Option<f64>,
    /// |field_ut|, uT.
    pub total_field_ut: Option<f64>,
    /// Heading and inclination. None without a calibration, without a recent `up`, or where the axis is vertical.
    pub heading: Option<Heading>,
    /// How the device lies in the world, from the vector that the heading comes from. None without a calibration, without a recent
    /// `up`, or where the field is vertical.
    pub attitude: Option<Attitude>,
    /// (15) sigma_T over the latest N_min samples; the aided and the adaptive method form it anew once a second. None until there are
    /// that many and a calibration.
    pub sigma_t: Option<f64>,
    /// Samples that the estimator looks at: the paper's window; of the adaptive method those since the latest change; the aided
    /// method has no window, and counts directions over the latest N_max.
    pub window: usize,
    /// Share of the directions seen in that window, 0 to 1.
    pub coverage: f64,
    /// Predicted rms error of a corrected direction by the parameters in force, over all directions, degrees, above 0 and up to 180; the
    /// aided and the adaptive method form it anew once a second. None without a calibration or a known covariance.
    pub direction_sigma_deg: Option<f64>,
    /// The same for the one combination of parameters that is known worst: the root of the inverse of the information
    /// matrix's smallest eigenvalue, as an angle, degrees. Large where the directions seen leave something open, also
    /// where sigma_T does not show it. Adaptive method only.
    pub worst_sigma_deg: Option<f64>,
    /// Which parameters the latest change set free. Adaptive method only.
    pub model_order: Option<ModelOrder>,
    /// The sensors the estimator runs on.
    pub mode: SensorMode,
    /// The latest change that was decided, kept until the next. None before the first.
    pub event: Option<Event>,
    /// What the compensator is doing, and why.
    pub status: Status,
}

/// What headings from outside ([`crate::Compensator::push_heading`]) are worth. Its text is one sentence an app may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum HeadingAid {
    /// They agree with the magnetometer, which knows north at least as well by itself.
    #[error("headings from outside agree")]
    Used,
    /// North is what they say, carried by the gyroscope: the magnetometer knows it less well.
    #[error("north comes from outside")]
    Leads,
    /// The latest one contradicts what is known, and is ignored.
    #[error("the heading from outside disagrees, and is ignored")]
    Disagrees,
}

/// The sensors an estimator runs on, as they come and go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum SensorMode {
    /// Gyroscope and accelerometer beside the magnetometer: everything works.
    GyroscopeAndGravity,
    /// No accelerometer: the field is corrected and carried, there is no heading.
    GyroscopeOnly,
    /// No usable gyroscope: changes are followed slower.
    GravityOnly,
    /// Neither: as `GravityOnly`, and there is no heading.
    #[default]
    MagnetometerOnly,
}

/// Which parameters were free to change at the latest change, as the evidence had it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum ModelOrder {
    /// None: they are what they were.
    #[default]
    Nothing,
    /// b alone.
    HardIron,
    /// All nine.
    All,
    /// Back to a calibration from before.
    Former,
}

/// A change that was decided. Its text is one sentence an app may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{kind} in {:.1} s", (*.decided_ns as f64 - *.since_ns as f64) * 1e-9)]
#[derive(serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct Event {
    /// What changed.
    pub kind: EventKind,
    /// Time of the first sample that no longer fitted, nanoseconds.
    pub since_ns: i64,
    /// Time of the decision, nanoseconds.
    pub decided_ns: i64,
}

/// What changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum EventKind {
    /// The device's own disturbance (a magnet or cover put on or taken off): relearned.
    #[error("the device's own disturbance changed: relearned")]
    DeviceStep,
    /// The device returned to an earlier calibration, which was restored.
    #[error("the device is as it was before: restored")]
    DeviceStepBack,
    /// The field of the place stepped: the calibration is held.
    #[error("the place's field changed: noticed")]
    PlaceChanged,
}

/// What the compensator is doing, so that an app can tell its user what to do. Its text is one sentence an app may show.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum Status {
    /// No calibration yet.
    #[error("collecting: {0}")]
    Collecting(Missing),
    /// Calibrated, and following changes.
    #[error("tracking")]
    Tracking,
    /// Something changed; not yet decided what.
    #[error("suspect: the field changed; not yet known whether the device's or the place's")]
    Suspect {
        /// Time of the first sample that did not fit, nanoseconds.
        since_ns: i64,
    },
    /// Calibrated, but not learning: the calibration is kept.
    #[error("held: {0}")]
    Held(HoldReason),
    /// The environment is disturbed, not the device: its field is not the Earth's. With a gyroscope the heading is carried on.
    #[error("disturbed: a magnetic object is near; move away from it")]
    Disturbed {
        /// Time of the first disturbed sample, nanoseconds.
        since_ns: i64,
    },
    /// This sample was not used; nothing has changed. 50 in a row may begin another clock: see [`crate::Compensator::push`].
    #[error("rejected: {0}")]
    Rejected(RejectReason),
}

/// What a first calibration still lacks.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum Missing {
    /// More samples before a first fit is tried.
    #[error("{have} of {need} samples; turn the device about")]
    Samples {
        /// Samples so far.
        have: usize,
        /// Samples needed.
        need: usize,
    },
    /// The samples allow no fit yet; the error says why.
    #[error("{0}")]
    Fit(FitError),
    /// The device must be turned.
    #[error("turn the device")]
    Rotation,
    /// More directions, turned about more than one axis.
    #[error("turn the device about more axes")]
    Directions,
}

/// Why nothing is learned at the moment.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum HoldReason {
    /// sigma_T is below its threshold.
    #[error("the latest orientations are too much alike")]
    LowUniformity,
    /// The latest fit was refused, or with the gyroscope the field is one that no place on Earth has; the error says why.
    #[error("{0}")]
    FitRefused(FitError),
    /// The device lies still.
    #[error("the device lies still")]
    AtRest,
    /// The device has hardly been turned of late.
    #[error("turn the device to learn more")]
    TooLittleRotation,
    /// The gyroscope is gone or reads nonsense; the magnetometer alone takes over within a second.
    #[error("the gyroscope is gone; turn the device about")]
    NoGyroscope,
    /// The method is a constant calibration: by choice it does not follow changes.
    #[error("constant calibration")]
    Constant,
}

/// An axis of the device: x right, y up along the screen, z out of the screen.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, thiserror::Error)]
pub enum Axis {
    /// Right.
    #[error("x")]
    X,
    /// Up along the screen.
    #[error("y")]
    Y,
    /// Out of the screen.
    #[error("z")]
    Z,
}

/// Why a sample was not used.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum RejectReason {
    /// A component is NaN or infinite.
    #[error("field is not finite")]
    NotFinite,
    /// A component is larger than any phone's magnetometer reads.
    #[error("field component {value_ut:.1} uT is outside +-{limit_ut:.1} uT; is the unit microtesla?")]
    OutOfRange {
        /// The component, uT.
        value_ut: f64,
        /// The limit, uT.
        limit_ut: f64,
    },
    /// A component is at the sensor's full scale: the true field is larger.
    #[error(
        "field component {axis} {value_ut:.1} uT is at the sensor's full scale {rail_ut:.1} uT; move away from the magnet"
    )]
    Saturated {
        /// The axis of the component.
        axis: Axis,
        /// The component, uT.
        value_ut: f64,
        /// Full scale, uT.
        rail_ut: f64,
    },
    /// Time did not advance.
    #[error(
        "time {time_ns} ns is not after the latest sample's {latest_ns} ns; 50 such samples that follow one another begin another clock"
    )]
    TimeNotAfter {
        /// Time of this sample, nanoseconds.
        time_ns: i64,
        /// Time of the latest accepted sample, nanoseconds.
        latest_ns: i64,
    },
    /// Time jumped ahead further than any pause.
    #[error(
        "time jumped ahead by {gap_s:.0} s, more than {limit_s:.0} s; is the unit nanoseconds? 50 such samples that follow one another begin another clock"
    )]
    TimeJump {
        /// The jump, s.
        gap_s: f64,
        /// The limit, s.
        limit_s: f64,
    },
    /// The same value to the last bit for too long while the device turns, or while neither gyroscope nor accelerometer tells that it rests: the sensor or its
    /// driver hangs. Over with the next other value.
    #[error("the same value came {repeats} times; the sensor hangs")]
    Stuck {
        /// How many times in a row the value was accepted before.
        repeats: usize,
    },
    /// The field turns as if these were the magnetometer's axes: an app has mixed up two frames. Asked again with every turn.
    #[error(
        "the field turns with the gyroscope only if the magnetometer's axes are {} (or all three the other way); give both sensors the same axes",
        typed([*.x, *.y, *.z])
    )]
    Axes {
        /// The sample's component along the gyroscope's x, 1 to 3; negative where it points the other way.
        x: i8,
        /// Along y.
        y: i8,
        /// Along z.
        z: i8,
    },
}

impl Status {
    /// One word for tables and logs: `collecting`, `tracking`, `suspect`, `held`, `disturbed`, `rejected`.
    #[must_use]
    pub fn label(&self) -> &'static str {
        match self {
            Self::Collecting(_) => "collecting",
            Self::Tracking => "tracking",
            Self::Suspect { .. } => "suspect",
            Self::Held(_) => "held",
            Self::Disturbed { .. } => "disturbed",
            Self::Rejected(_) => "rejected",
        }
    }
}

/// Axes as one types them: `y,-x,z`.
fn typed(axes: [i8; 3]) -> String {
    let name = |axis: i8| ["x", "y", "z"][usize::from(axis.unsigned_abs().clamp(1, 3)) - 1];
    axes.map(|axis| format!("{}{}", if axis < 0 { "-" } else { "" }, name(axis))).join(",")
}
