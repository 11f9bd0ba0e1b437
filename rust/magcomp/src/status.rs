// made by bindings/generate.sh from bindings/status.toml
//! What the compensator is doing, and why.

use alloc::{format, string::String};

/// What the compensator is doing, so that an app can tell its user what to do. Its text is one sentence an app may show.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum Status {
    /// There is no calibration yet.
    #[error("collecting: {0}")]
    Collecting(Missing),
    /// Calibrated, and following changes.
    #[error("tracking")]
    Tracking,
    /// Something changed; it is not yet decided whether the device or the place.
    #[error("suspect: the field changed; not yet known whether the device's or the place's")]
    Suspect {
        /// Time of the first sample that did not fit, nanoseconds.
        since_ns: i64,
    },
    /// Calibrated, but not learning: the calibration is kept.
    #[error("held: {0}")]
    Held(HoldReason),
    /// The place is disturbed, not the device: the calibration is kept, and after 30 s learned on in the field of that place.
    #[error("disturbed: a magnetic object is near; move away from it")]
    Disturbed {
        /// Time of the first disturbed sample, nanoseconds.
        since_ns: i64,
    },
    /// This sample was not used, and changed nothing; 50 in a row that agree on another clock begin that clock.
    #[error("rejected: {0}")]
    Rejected(RejectReason),
}

/// What a first calibration still lacks. Its text is one sentence an app may show.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum Missing {
    /// Too few samples for a first fit.
    #[error("{have} of {need} samples; turn the device about")]
    Samples {
        /// Samples so far.
        have: usize,
        /// Samples needed.
        need: usize,
    },
    /// The samples allow no fit; the problem is named.
    #[error("{0}")]
    Fit(FitError),
    /// The device was hardly turned.
    #[error("turn the device")]
    Rotation,
    /// The device was turned, but not about enough axes.
    #[error("turn the device about more axes")]
    Directions,
}

/// Why nothing is learned at the moment. Its text is one sentence an app may show.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum HoldReason {
    /// Method `Windowed` alone: sigma_T is below its threshold, the latest orientations are too much alike.
    #[error("the latest orientations are too much alike")]
    LowUniformity,
    /// The latest fit was refused, or no place on Earth has such a field; the problem is named. Is the sensor's unit microtesla?
    #[error("{0}")]
    FitRefused(FitError),
    /// Method `Constant` alone: by choice it follows no changes.
    #[error("constant calibration")]
    Constant,
    /// The device lies still; nothing is learned from that.
    #[error("the device lies still")]
    AtRest,
    /// The device was hardly turned of late.
    #[error("turn the device to learn more")]
    TooLittleRotation,
    /// The gyroscope is gone or reads nonsense; the magnetometer alone takes over within a second, but with method `Aided`, which waits.
    #[error("the gyroscope is gone; turn the device about")]
    NoGyroscope,
}

/// An axis of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, thiserror::Error)]
pub enum Axis {
    /// Along the screen, to the right.
    #[error("x")]
    X,
    /// Along the screen, up.
    #[error("y")]
    Y,
    /// Out of the screen.
    #[error("z")]
    Z,
}

/// Why a sample was not used. Its text is one sentence an app may show.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum RejectReason {
    /// A component is NaN or infinite. Check where the samples come from.
    #[error("field is not finite")]
    NotFinite,
    /// A component is beyond the setting `range_ut`. Is the unit microtesla?
    #[error("field component {value_ut:.1} uT is outside +-{limit_ut:.1} uT; is the unit microtesla?")]
    OutOfRange {
        /// The component, microtesla.
        value_ut: f64,
        /// The limit, microtesla.
        limit_ut: f64,
    },
    /// A component is at the sensor's full scale, the setting `rail_ut` or as found: the true field is larger.
    #[error("field component {axis} {value_ut:.1} uT is at the sensor's full scale {rail_ut:.1} uT; move away from the magnet")]
    Saturated {
        /// The axis of the component.
        axis: Axis,
        /// The component, microtesla.
        value_ut: f64,
        /// Full scale, microtesla.
        rail_ut: f64,
    },
    /// Time did not advance.
    #[error("time {time_ns} ns is not after the latest sample's {latest_ns} ns; 50 such samples that follow one another begin another clock")]
    TimeNotAfter {
        /// Time of this sample, nanoseconds.
        time_ns: i64,
        /// Time of the latest accepted sample, nanoseconds.
        latest_ns: i64,
    },
    /// Time jumped ahead further than any pause. Is the unit nanoseconds?
    #[error("time jumped ahead by {gap_s:.0} s, more than {limit_s:.0} s; is the unit nanoseconds? 50 such samples that follow one another begin another clock")]
    TimeJump {
        /// The jump, seconds.
        gap_s: f64,
        /// The limit, seconds.
        limit_s: f64,
    },
    /// The same value to the last bit while the device turns, or where neither gyroscope nor accelerometer tells that it rests: the sensor hangs.
    #[error("the same value came {repeats} times; the sensor hangs")]
    Stuck {
        /// How many times in a row the value was accepted before.
        repeats: usize,
    },
    /// The field turns as if the magnetometer had other axes than the gyroscope; the text says which. Asked again with every turn. Give both sensors the same axes.
    #[error("the field turns with the gyroscope only if the magnetometer's axes are {} (or all three the other way); give both sensors the same axes", typed([*.x, *.y, *.z]))]
    Axes {
        /// The sample's component along the gyroscope's x, 1 to 3; negative where it points the other way.
        x: i8,
        /// Along y.
        y: i8,
        /// Along z.
        z: i8,
    },
}

/// Why there is no ellipsoid to report. Its text is one sentence an app may show.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum FitError {
    /// Fewer samples than the nine parameters.
    #[error("{have} samples are too few for an ellipsoid: 9 are needed, more are better")]
    TooFewSamples {
        /// How many there are.
        have: usize,
    },
    /// All samples lie near one plane.
    #[error("samples lie within {thickness_ut:.2} uT of one plane; turn the device about a second axis")]
    Planar {
        /// Standard deviation of the samples across their thinnest direction, microtesla.
        thickness_ut: f64,
    },
    /// The directions seen leave too large an error.
    #[error("predicted direction error {direction_sigma_deg:.1} deg exceeds {limit_deg:.1} deg; turn the device to more directions")]
    PoorCoverage {
        /// Predicted rms direction error, degrees.
        direction_sigma_deg: f64,
        /// The limit it exceeds, degrees.
        limit_deg: f64,
    },
    /// The samples do not lie on one ellipsoid: the disturbance or the place changed meanwhile.
    #[error("samples lie {residual_ut:.1} uT off the best ellipsoid, more than {limit_ut:.1} uT; the disturbance or the place changed meanwhile")]
    Inconsistent {
        /// Residual rms, microtesla.
        residual_ut: f64,
        /// The limit it exceeds, microtesla.
        limit_ut: f64,
    },
    /// A surface that is no ellipsoid fits best.
    #[error("samples are fitted best by a surface that is no ellipsoid; the disturbance changed meanwhile, or too few directions were seen")]
    NotAnEllipsoid,
    /// The field is too weak or too strong to be the Earth's. Is the unit microtesla?
    #[error("field strength {field_ut:.1} uT is outside {low_ut:.1} to {high_ut:.1} uT; the place is disturbed or the sensor's unit is not microtesla")]
    FieldOutOfRange {
        /// Strength found, microtesla: the geometric mean of the half axes, or |m| with the gyroscope.
        field_ut: f64,
        /// Smallest accepted, microtesla.
        low_ut: f64,
        /// Largest accepted, microtesla.
        high_ut: f64,
    },
    /// A sample was NaN or infinite, or the numbers overflowed. Leave such values out.
    #[error("a sample is not finite; leave out NaN and infinite values")]
    NotFinite,
}

/// Why a gyroscope, accelerometer or gravity event was not used; nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum EventRejection {
    /// A component is NaN or infinite.
    #[error("event holds a value that is not finite")]
    NotFinite,
    /// Beyond anything the sensor can read.
    #[error("event is beyond the sensor's range")]
    OutOfRange,
    /// At or before a magnetometer sample already answered. Of a heading: more than 5 s old, or not after the latest one that was used.
    #[error("event is older than the last magnetometer sample paired")]
    Late,
    /// An event with this very time is there already.
    #[error("an event with the same time is already there")]
    Duplicate,
    /// So far ahead of the magnetometer that it must be from another clock.
    #[error("event lies too far ahead of the magnetometer; is it from another clock?")]
    Ahead,
}

/// The sensors the estimator runs on, as they come and go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum SensorMode {
    /// Gyroscope and accelerometer beside the magnetometer: everything works.
    GyroscopeAndGravity,
    /// No accelerometer: the field is corrected and carried, there is no heading.
    GyroscopeOnly,
    /// No usable gyroscope: changes are followed slower.
    GravityOnly,
    /// Neither: changes are followed slower, and there is no heading.
    #[default]
    MagnetometerOnly,
}

/// Which of the nine parameters a change set free.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum ModelOrder {
    /// None: all nine stay.
    #[default]
    Nothing,
    /// Hard iron alone.
    HardIron,
    /// All nine.
    All,
    /// Back to a calibration from before.
    Former,
}

/// What changed. Its text is one sentence an app may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, thiserror::Error)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum EventKind {
    /// The device's own disturbance changed (a magnet or cover was put on or taken off), and was relearned.
    #[error("the device's own disturbance changed: relearned")]
    DeviceStep,
    /// The device is as it was before; that calibration was restored.
    #[error("the device is as it was before: restored")]
    DeviceStepBack,
    /// The field of the place changed; the calibration is held.
    #[error("the place's field changed: noticed")]
    PlaceChanged,
}

/// What headings from outside are worth. Its text is one sentence an app may show.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize, thiserror::Error)]
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
