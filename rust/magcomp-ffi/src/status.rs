//! What the compensator is doing, and why: the core's enums as they cross the border.

mod convert;

/// What the compensator is doing, so that an app can tell its user what to do. `text()` says it in a sentence.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Enum)]
pub enum Status {
    /// No calibration yet.
    Collecting {
        /// What is still missing.
        missing: Missing,
    },
    /// Calibrated, and following changes.
    Tracking,
    /// Something changed; it is not yet decided whether the device or the place.
    Suspect {
        /// Time of the first sample that did not fit, nanoseconds.
        since_ns: i64,
    },
    /// Calibrated, but not learning: the calibration is kept.
    Held {
        /// Why nothing is learned at the moment.
        reason: HoldReason,
    },
    /// The environment is disturbed, not the device.
    Disturbed {
        /// Time of the first disturbed sample, nanoseconds.
        since_ns: i64,
    },
    /// This sample was not used, and nothing has changed. 50 of them in a row that agree on another clock begin that
    /// clock (see `push`).
    Rejected {
        /// Why it was not used.
        reason: RejectReason,
    },
}

/// What a first calibration still lacks.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Enum)]
pub enum Missing {
    /// More samples before a first fit is tried.
    Samples {
        /// Samples so far.
        have: i32,
        /// Samples needed.
        need: i32,
    },
    /// The samples allow no fit yet.
    Fit {
        /// Why.
        problem: FitProblem,
    },
    /// The device must be turned.
    Rotation,
    /// More directions, turned about more than one axis.
    Directions,
}

/// Why nothing is learned at the moment.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Enum)]
pub enum HoldReason {
    /// sigma_T is below its threshold: the latest orientations are too much alike.
    LowUniformity,
    /// The latest fit was refused.
    FitRefused {
        /// What it lacks.
        problem: FitProblem,
    },
    /// The method keeps one calibration: by choice it does not follow changes.
    Constant,
    /// The device lies still.
    AtRest,
    /// The device has hardly been turned of late.
    TooLittleRotation,
    /// The gyroscope is gone or reads nonsense; the magnetometer alone takes over within a second.
    NoGyroscope,
}

/// An axis of the device.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Axis {
    /// Along the screen, to the right.
    X,
    /// Along the screen, up.
    Y,
    /// Out of the screen.
    Z,
}

/// Why a sample was not used.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Enum)]
pub enum RejectReason {
    /// A component is NaN or infinite.
    NotFinite,
    /// A component is larger than any phone's magnetometer reads.
    OutOfRange {
        /// The component, microtesla.
        value_ut: f64,
        /// The limit, microtesla.
        limit_ut: f64,
    },
    /// A component is at the sensor's full scale: the true field is larger.
    Saturated {
        /// The axis of the component.
        axis: Axis,
        /// The component, microtesla.
        value_ut: f64,
        /// Full scale, microtesla.
        rail_ut: f64,
    },
    /// Time did not advance.
    TimeNotAfter {
        /// Time of this sample, nanoseconds.
        time_ns: i64,
        /// Time of the latest accepted sample, nanoseconds.
        latest_ns: i64,
    },
    /// Time jumped ahead further than any pause.
    TimeJump {
        /// The jump, seconds.
        gap_s: f64,
        /// The limit, seconds.
        limit_s: f64,
    },
    /// The same value to the last bit for too long: the sensor or its driver hangs.
    Stuck {
        /// How many times in a row the value was accepted before.
        repeats: i32,
    },
    /// The field turns as if these were the magnetometer's axes: an app has mixed up two frames. Asked again with every turn.
    Axes {
        /// The sample's component along the gyroscope's x, 1 to 3; negative where it points the other way.
        x: i32,
        /// Along y.
        y: i32,
        /// Along z.
        z: i32,
    },
}

/// Why a gyroscope, accelerometer or gravity event was not used; nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum EventRejection {
    /// A component is NaN or infinite.
    NotFinite,
    /// Beyond anything the sensor can read.
    OutOfRange,
    /// At or before a magnetometer sample already answered.
    Late,
    /// An event with this very time is there already.
    Duplicate,
    /// So far ahead of the magnetometer that it must be from another clock.
    Ahead,
}

/// The sensors the estimator runs on, as they come and go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum SensorMode {
    /// Gyroscope and accelerometer beside the magnetometer: everything works.
    GyroscopeAndGravity,
    /// No accelerometer: the field is corrected and carried, there is no heading.
    GyroscopeOnly,
    /// No usable gyroscope: changes are followed slower.
    GravityOnly,
    /// Neither: as `GravityOnly`, and there is no heading.
    MagnetometerOnly,
}

/// Which of the nine parameters a change set free.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum ModelOrder {
    /// None: all nine stay.
    Nothing,
    /// Hard iron alone.
    HardIron,
    /// All nine.
    All,
    /// Back to a calibration from before.
    Former,
}

/// A change that was decided.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Record)]
pub struct Event {
    /// What changed.
    pub kind: EventKind,
    /// Time of the first sample that no longer fitted, nanoseconds.
    pub since_ns: i64,
    /// Time of the decision, nanoseconds.
    pub decided_ns: i64,
}

/// What changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum EventKind {
    /// The device's own disturbance (a magnet or cover put on or taken off): relearned.
    DeviceStep,
    /// The device returned to an earlier calibration, which was restored.
    DeviceStepBack,
    /// The field of the place stepped: the calibration is held.
    PlaceChanged,
}

/// Why there is no ellipsoid to report.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Enum)]
pub enum FitProblem {
    /// Fewer samples than parameters.
    TooFewSamples {
        /// How many there are.
        have: i32,
    },
    /// All samples lie near one plane: turn the device about a second axis.
    Planar {
        /// Standard deviation of the samples across their thinnest direction, microtesla.
        thickness_ut: f64,
    },
    /// The directions do not determine the ellipsoid well enough.
    PoorCoverage {
        /// Predicted rms direction error, degrees.
        direction_sigma_deg: f64,
        /// The limit it exceeds, degrees.
        limit_deg: f64,
    },
    /// The samples do not lie on one ellipsoid: the disturbance or the place changed meanwhile.
    Inconsistent {
        /// Residual rms, microtesla.
        residual_ut: f64,
        /// The limit it exceeds, microtesla.
        limit_ut: f64,
    },
    /// The best quadric is not an ellipsoid.
    NotAnEllipsoid,
    /// The field is too weak or too strong to be the Earth's.
    FieldOutOfRange {
        /// Strength found, microtesla: the geometric mean of the half axes, or |m| with the gyroscope.
        field_ut: f64,
        /// Smallest accepted, microtesla.
        low_ut: f64,
        /// Largest accepted, microtesla.
        high_ut: f64,
    },
    /// A sample was NaN or infinite, or the numbers overflowed.
    NotFinite,
}

#[uniffi::export]
impl Status {
    /// One sentence an app may show.
    pub fn text(&self) -> String {
        magcomp::Status::from(*self).to_string()
    }

    /// One word for tables and logs: `collecting`, `tracking`, `suspect`, `held`, `disturbed`, `rejected`.
    pub fn label(&self) -> String {
        magcomp::Status::from(*self).label().to_owned()
    }
}

#[uniffi::export]
impl RejectReason {
    /// One sentence an app may show.
    pub fn text(&self) -> String {
        magcomp::RejectReason::from(*self).to_string()
    }
}

#[uniffi::export]
impl EventRejection {
    /// One sentence for a log.
    pub fn text(&self) -> String {
        magcomp::EventRejection::from(*self).to_string()
    }
}

#[uniffi::export]
impl FitProblem {
    /// One sentence an app may show.
    pub fn text(&self) -> String {
        magcomp::FitError::from(*self).to_string()
    }
}

/// One status of every kind, for comparing what JNI and what uniffi make of it.
#[cfg(feature = "test-hooks")]
pub(crate) fn examples() -> Vec<Status> {
    let collecting = |missing| Status::Collecting { missing };
    let problems = [
        FitProblem::TooFewSamples { have: 8 },
        FitProblem::Planar { thickness_ut: 0.5 },
        FitProblem::PoorCoverage { direction_sigma_deg: 12.5, limit_deg: 10.0 },
        FitProblem::Inconsistent { residual_ut: 7.5, limit_ut: 2.5 },
        FitProblem::NotAnEllipsoid,
        FitProblem::FieldOutOfRange { field_ut: 90.0, low_ut: 22.0, high_ut: 67.0 },
        FitProblem::NotFinite,
    ];
    let held = [
        HoldReason::LowUniformity,
        HoldReason::FitRefused { problem: problems[2] },
        HoldReason::Constant,
        HoldReason::AtRest,
        HoldReason::TooLittleRotation,
        HoldReason::NoGyroscope,
    ];
    let rejected = [
        RejectReason::NotFinite,
        RejectReason::OutOfRange { value_ut: -2500.0, limit_ut: 2000.0 },
        RejectReason::Saturated { axis: Axis::Z, value_ut: 1300.0, rail_ut: 1299.5 },
        // more digits than a double holds
        RejectReason::TimeNotAfter { time_ns: 7, latest_ns: 9_007_199_254_740_993 },
        RejectReason::TimeJump { gap_s: 1e6, limit_s: 604_800.0 },
        RejectReason::Stuck { repeats: 50 },
        RejectReason::Axes { x: 2, y: -1, z: 3 },
    ];
    let mut examples = vec![Status::Tracking, Status::Suspect { since_ns: -9_007_199_254_740_993 }];
    examples.push(collecting(Missing::Samples { have: 60, need: 100 }));
    examples.extend([Missing::Rotation, Missing::Directions].map(collecting));
    examples.extend(problems.map(|problem| collecting(Missing::Fit { problem })));
    examples.extend(held.map(|reason| Status::Held { reason }));
    examples.push(Status::Disturbed { since_ns: i64::MIN + 1 });
    examples.extend(rejected.map(|reason| Status::Rejected { reason }));
    examples
}
