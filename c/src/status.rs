// made by bindings/generate.sh from bindings/status.toml
//! The enums of what the compensator is doing, and why, with the codes of the C header.

use magcomp_core as core;

/// What the compensator is doing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Status {
    /// There is no calibration yet. `reason` says why.
    Collecting = 0,
    /// Calibrated, and following changes.
    Tracking = 1,
    /// Something changed; it is not yet decided whether the device or the place.
    Suspect = 2,
    /// Calibrated, but not learning: the calibration is kept. `reason` says why.
    Held = 3,
    /// The place is disturbed, not the device: the calibration is kept, and after 30 s learned on in the field of that place.
    Disturbed = 4,
    /// This sample was not used, and changed nothing; 50 in a row that agree on another clock begin that clock. `reason` says why.
    Rejected = 5,
}

/// Why the status is what it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Reason {
    /// The status says it all.
    None = 0,
    /// Collecting: too few samples for a first fit.
    Samples = 1,
    /// Collecting: the device was hardly turned.
    Rotation = 2,
    /// Collecting: the device was turned, but not about enough axes.
    Directions = 3,
    /// Collecting: the samples allow no fit; the problem is named. See `fit_problem`.
    Fit = 4,
    /// Held: the device lies still; nothing is learned from that.
    AtRest = 5,
    /// Held: the device was hardly turned of late.
    TooLittleRotation = 6,
    /// Held: method `Windowed` alone: sigma_T is below its threshold, the latest orientations are too much alike.
    LowUniformity = 7,
    /// Held: the latest fit was refused, or no place on Earth has such a field; the problem is named. Is the sensor's unit microtesla? See `fit_problem`.
    FitRefused = 8,
    /// Held: the gyroscope is gone or reads nonsense; the magnetometer alone takes over within a second, but with method `Aided`, which waits.
    NoGyroscope = 9,
    /// Held: method `Constant` alone: by choice it follows no changes.
    Constant = 10,
    /// Rejected: a component is NaN or infinite. Check where the samples come from.
    NotFinite = 11,
    /// Rejected: a component is beyond the setting `range_ut`. Is the unit microtesla?
    OutOfRange = 12,
    /// Rejected: a component is at the sensor's full scale, the setting `rail_ut` or as found: the true field is larger.
    Saturated = 13,
    /// Rejected: time did not advance.
    TimeNotAfter = 14,
    /// Rejected: time jumped ahead further than any pause. Is the unit nanoseconds?
    TimeJump = 15,
    /// Rejected: the same value to the last bit while the device turns, or where neither gyroscope nor accelerometer tells that it rests: the sensor hangs.
    Stuck = 16,
    /// Rejected: the field turns as if the magnetometer had other axes than the gyroscope; the text says which. Asked again with every turn. Give both sensors the same axes.
    Axes = 17,
}

/// Why there is no ellipsoid to report.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum FitProblem {
    /// `reason` is about no fit.
    None = 0,
    /// Fewer samples than the nine parameters.
    TooFewSamples = 1,
    /// All samples lie near one plane.
    Planar = 2,
    /// The directions seen leave too large an error.
    PoorCoverage = 3,
    /// The samples do not lie on one ellipsoid: the disturbance or the place changed meanwhile.
    Inconsistent = 4,
    /// A surface that is no ellipsoid fits best.
    NotAnEllipsoid = 5,
    /// The field is too weak or too strong to be the Earth's. Is the unit microtesla?
    FieldOutOfRange = 6,
    /// A sample was NaN or infinite, or the numbers overflowed. Leave such values out.
    NotFinite = 7,
}

impl From<core::FitError> for FitProblem {
    fn from(it: core::FitError) -> Self {
        match it {
            core::FitError::TooFewSamples { .. } => Self::TooFewSamples,
            core::FitError::Planar { .. } => Self::Planar,
            core::FitError::PoorCoverage { .. } => Self::PoorCoverage,
            core::FitError::Inconsistent { .. } => Self::Inconsistent,
            core::FitError::NotAnEllipsoid => Self::NotAnEllipsoid,
            core::FitError::FieldOutOfRange { .. } => Self::FieldOutOfRange,
            core::FitError::NotFinite => Self::NotFinite,
        }
    }
}

/// What changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Event {
    /// None yet.
    None = 0,
    /// The device's own disturbance changed (a magnet or cover was put on or taken off), and was relearned.
    DeviceStep = 1,
    /// The device is as it was before; that calibration was restored.
    DeviceStepBack = 2,
    /// The field of the place changed; the calibration is held.
    PlaceChanged = 3,
}

impl From<core::EventKind> for Event {
    fn from(it: core::EventKind) -> Self {
        match it {
            core::EventKind::DeviceStep => Self::DeviceStep,
            core::EventKind::DeviceStepBack => Self::DeviceStepBack,
            core::EventKind::PlaceChanged => Self::PlaceChanged,
        }
    }
}

/// The sensors the estimator runs on, as they come and go.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Mode {
    /// Gyroscope and accelerometer beside the magnetometer: everything works.
    GyroscopeAndGravity = 0,
    /// No accelerometer: the field is corrected and carried, there is no heading.
    GyroscopeOnly = 1,
    /// No usable gyroscope: changes are followed slower.
    GravityOnly = 2,
    /// Neither: changes are followed slower, and there is no heading.
    MagnetometerOnly = 3,
}

impl From<core::SensorMode> for Mode {
    fn from(it: core::SensorMode) -> Self {
        match it {
            core::SensorMode::GyroscopeAndGravity => Self::GyroscopeAndGravity,
            core::SensorMode::GyroscopeOnly => Self::GyroscopeOnly,
            core::SensorMode::GravityOnly => Self::GravityOnly,
            core::SensorMode::MagnetometerOnly => Self::MagnetometerOnly,
        }
    }
}

/// Which of the nine parameters a change set free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum ModelOrder {
    /// The estimator does not tell.
    None = 0,
    /// None: all nine stay.
    Nothing = 1,
    /// Hard iron alone.
    HardIron = 2,
    /// All nine.
    All = 3,
    /// Back to a calibration from before.
    Former = 4,
}

impl From<core::ModelOrder> for ModelOrder {
    fn from(it: core::ModelOrder) -> Self {
        match it {
            core::ModelOrder::Nothing => Self::Nothing,
            core::ModelOrder::HardIron => Self::HardIron,
            core::ModelOrder::All => Self::All,
            core::ModelOrder::Former => Self::Former,
        }
    }
}

/// What headings from outside are worth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum HeadingAid {
    /// None came in the last two minutes.
    None = 0,
    /// They agree with the magnetometer, which knows north at least as well by itself.
    Used = 1,
    /// North is what they say, carried by the gyroscope: the magnetometer knows it less well.
    Leads = 2,
    /// The latest one contradicts what is known, and is ignored.
    Disagrees = 3,
}

impl From<core::HeadingAid> for HeadingAid {
    fn from(it: core::HeadingAid) -> Self {
        match it {
            core::HeadingAid::Used => Self::Used,
            core::HeadingAid::Leads => Self::Leads,
            core::HeadingAid::Disagrees => Self::Disagrees,
        }
    }
}

/// Status, reason, problem of a fit, and since when, ns.
pub(crate) fn told(status: &core::Status) -> (Status, Reason, FitProblem, i64) {
    let none = FitProblem::None;
    match status {
        core::Status::Collecting(why) => match why {
            core::Missing::Samples { .. } => (Status::Collecting, Reason::Samples, none, 0),
            core::Missing::Fit(problem) => (Status::Collecting, Reason::Fit, (*problem).into(), 0),
            core::Missing::Rotation => (Status::Collecting, Reason::Rotation, none, 0),
            core::Missing::Directions => (Status::Collecting, Reason::Directions, none, 0),
        },
        core::Status::Tracking => (Status::Tracking, Reason::None, none, 0),
        core::Status::Suspect { since_ns } => (Status::Suspect, Reason::None, none, *since_ns),
        core::Status::Held(why) => match why {
            core::HoldReason::LowUniformity => (Status::Held, Reason::LowUniformity, none, 0),
            core::HoldReason::FitRefused(problem) => (Status::Held, Reason::FitRefused, (*problem).into(), 0),
            core::HoldReason::Constant => (Status::Held, Reason::Constant, none, 0),
            core::HoldReason::AtRest => (Status::Held, Reason::AtRest, none, 0),
            core::HoldReason::TooLittleRotation => (Status::Held, Reason::TooLittleRotation, none, 0),
            core::HoldReason::NoGyroscope => (Status::Held, Reason::NoGyroscope, none, 0),
        },
        core::Status::Disturbed { since_ns } => (Status::Disturbed, Reason::None, none, *since_ns),
        core::Status::Rejected(why) => match why {
            core::RejectReason::NotFinite => (Status::Rejected, Reason::NotFinite, none, 0),
            core::RejectReason::OutOfRange { .. } => (Status::Rejected, Reason::OutOfRange, none, 0),
            core::RejectReason::Saturated { .. } => (Status::Rejected, Reason::Saturated, none, 0),
            core::RejectReason::TimeNotAfter { .. } => (Status::Rejected, Reason::TimeNotAfter, none, 0),
            core::RejectReason::TimeJump { .. } => (Status::Rejected, Reason::TimeJump, none, 0),
            core::RejectReason::Stuck { .. } => (Status::Rejected, Reason::Stuck, none, 0),
            core::RejectReason::Axes { .. } => (Status::Rejected, Reason::Axes, none, 0),
        },
    }
}
