// made by bindings/generate.sh from bindings/status.toml and bindings/config.toml
//! What the compensator is doing, and why, and what a setting can be that is no number: the core's enums as they cross the border, and their codes on the wire.

use crate::convert::{Cross, same};

/// What the compensator is doing, so that an app can tell its user what to do. `text()` says it in a sentence.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Enum)]
pub enum Status {
    /// There is no calibration yet.
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
    /// The place is disturbed, not the device: the calibration is kept, and after 30 s learned on in the field of that place.
    Disturbed {
        /// Time of the first disturbed sample, nanoseconds.
        since_ns: i64,
    },
    /// This sample was not used, and changed nothing; 50 in a row that agree on another clock begin that clock.
    Rejected {
        /// Why it was not used.
        reason: RejectReason,
    },
}

/// What a first calibration still lacks.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Enum)]
pub enum Missing {
    /// Too few samples for a first fit.
    Samples {
        /// Samples so far.
        have: i32,
        /// Samples needed.
        need: i32,
    },
    /// The samples allow no fit; the problem is named.
    Fit {
        /// Why.
        problem: FitProblem,
    },
    /// The device was hardly turned.
    Rotation,
    /// The device was turned, but not about enough axes.
    Directions,
}

/// Why nothing is learned at the moment.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Enum)]
pub enum HoldReason {
    /// Method `Windowed` alone: sigma_T is below its threshold, the latest orientations are too much alike.
    LowUniformity,
    /// The latest fit was refused, or no place on Earth has such a field; the problem is named. Is the sensor's unit microtesla?
    FitRefused {
        /// What it lacks.
        problem: FitProblem,
    },
    /// Method `Constant` alone: by choice it follows no changes.
    Constant,
    /// The device lies still; nothing is learned from that.
    AtRest,
    /// The device was hardly turned of late.
    TooLittleRotation,
    /// The gyroscope is gone or reads nonsense; the magnetometer alone takes over within a second, but with method `Aided`, which waits.
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
    /// A component is NaN or infinite. Check where the samples come from.
    NotFinite,
    /// A component is beyond the setting `range_ut`. Is the unit microtesla?
    OutOfRange {
        /// The component, microtesla.
        value_ut: f64,
        /// The limit, microtesla.
        limit_ut: f64,
    },
    /// A component is at the sensor's full scale, the setting `rail_ut` or as found: the true field is larger.
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
    /// Time jumped ahead further than any pause. Is the unit nanoseconds?
    TimeJump {
        /// The jump, seconds.
        gap_s: f64,
        /// The limit, seconds.
        limit_s: f64,
    },
    /// The same value to the last bit while the device turns, or where neither gyroscope nor accelerometer tells that it rests: the sensor hangs.
    Stuck {
        /// How many times in a row the value was accepted before.
        repeats: i32,
    },
    /// The field turns as if the magnetometer had other axes than the gyroscope; the text says which. Asked again with every turn. Give both sensors the same axes.
    Axes {
        /// The sample's component along the gyroscope's x, 1 to 3; negative where it points the other way.
        x: i32,
        /// Along y.
        y: i32,
        /// Along z.
        z: i32,
    },
}

/// Why there is no ellipsoid to report.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Enum)]
pub enum FitProblem {
    /// Fewer samples than the nine parameters.
    TooFewSamples {
        /// How many there are.
        have: i32,
    },
    /// All samples lie near one plane.
    Planar {
        /// Standard deviation of the samples across their thinnest direction, microtesla.
        thickness_ut: f64,
    },
    /// The directions seen leave too large an error.
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
    /// A surface that is no ellipsoid fits best.
    NotAnEllipsoid,
    /// The field is too weak or too strong to be the Earth's. Is the unit microtesla?
    FieldOutOfRange {
        /// Strength found, microtesla: the geometric mean of the half axes, or |m| with the gyroscope.
        field_ut: f64,
        /// Smallest accepted, microtesla.
        low_ut: f64,
        /// Largest accepted, microtesla.
        high_ut: f64,
    },
    /// A sample was NaN or infinite, or the numbers overflowed. Leave such values out.
    NotFinite,
}

/// Why a gyroscope, accelerometer or gravity event was not used; nothing has changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum EventRejection {
    /// A component is NaN or infinite.
    NotFinite,
    /// Beyond anything the sensor can read.
    OutOfRange,
    /// At or before a magnetometer sample already answered. Of a heading: more than 5 s old, or not after the latest one that was used.
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
    /// Neither: changes are followed slower, and there is no heading.
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

/// What changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum EventKind {
    /// The device's own disturbance changed (a magnet or cover was put on or taken off), and was relearned.
    DeviceStep,
    /// The device is as it was before; that calibration was restored.
    DeviceStepBack,
    /// The field of the place changed; the calibration is held.
    PlaceChanged,
}

/// What headings from outside are worth. `text()` says it in a sentence.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum HeadingAid {
    /// They agree with the magnetometer, which knows north at least as well by itself.
    Used,
    /// North is what they say, carried by the gyroscope: the magnetometer knows it less well.
    Leads,
    /// The latest one contradicts what is known, and is ignored.
    Disagrees,
}

/// How the hard and soft iron are estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Method {
    /// Gyroscope and gravity beside the magnetometer; works as `Adaptive` while there is no usable gyroscope.
    Auto,
    /// As `Auto` in far less memory: without a usable gyroscope it keeps its calibration, and learns nothing.
    Aided,
    /// The magnetometer alone: notices changes, and relearns them as fast as the samples allow.
    Adaptive,
    /// The paper's: an ellipsoid fit over the latest samples, whose number follows sigma_T.
    Windowed,
    /// The first step of the paper's method alone: one fit of the first well spread samples, kept from then on.
    Constant,
}

/// The axis of the device whose heading is reported.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum ReferenceAxis {
    /// Top edge of the screen, +y.
    TopEdge,
    /// Back camera, -z.
    Camera,
    /// The horizontal direction between top edge and camera: no flip when the phone passes upright.
    Auto,
}

/// How the screen's content is turned against the device's natural orientation, as Android's `Display.getRotation`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum ScreenRotation {
    /// Natural orientation: portrait on phones.
    Deg0,
    /// Landscape, the device turned counter-clockwise: the screen's top is the device's right edge.
    Deg90,
    /// Upside down.
    Deg180,
    /// The other landscape: the screen's top is the device's left edge.
    Deg270,
}

/// The residual that a fit squares and sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Residual {
    /// Eq. (10) of the paper as written. Biased in scale by about 3 nu^2 (nu: noise over field strength), and in everything when the sphere is only partly covered.
    Algebraic,
    /// Divided by its own gradient: a distance in raw units, free of the noise bias.
    Corrected,
}

/// How the standard deviations in sigma_T, eq. (15), are normalised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Normalisation {
    /// By half the range of each axis, 180 and 90 degrees: even orientations give 0.723, and so N = 626 of 100 to 2000.
    HalfRange,
    /// By sqrt(2) times the standard deviation of evenly spread directions, which so give 1.
    EvenSphere,
}

impl Cross<Axis> for magcomp::Axis {
    fn cross(self) -> Axis {
        self.into()
    }
}

impl Cross<magcomp::Axis> for Axis {
    fn cross(self) -> magcomp::Axis {
        self.into()
    }
}

same! {
    Status: Status { Collecting(missing), Tracking, Suspect { since_ns }, Held(reason), Disturbed { since_ns }, Rejected(reason) }
    Missing: Missing { Samples { have, need }, Fit(problem), Rotation, Directions }
    HoldReason: HoldReason { LowUniformity, FitRefused(problem), Constant, AtRest, TooLittleRotation, NoGyroscope }
    Axis: Axis { X, Y, Z }
    RejectReason: RejectReason { NotFinite, OutOfRange { value_ut, limit_ut }, Saturated { axis, value_ut, rail_ut }, TimeNotAfter { time_ns, latest_ns }, TimeJump { gap_s, limit_s }, Stuck { repeats }, Axes { x, y, z } }
    FitProblem: FitError { TooFewSamples { have }, Planar { thickness_ut }, PoorCoverage { direction_sigma_deg, limit_deg }, Inconsistent { residual_ut, limit_ut }, NotAnEllipsoid, FieldOutOfRange { field_ut, low_ut, high_ut }, NotFinite }
    EventRejection: EventRejection { NotFinite, OutOfRange, Late, Duplicate, Ahead }
    SensorMode: SensorMode { GyroscopeAndGravity, GyroscopeOnly, GravityOnly, MagnetometerOnly }
    ModelOrder: ModelOrder { Nothing, HardIron, All, Former }
    EventKind: EventKind { DeviceStep, DeviceStepBack, PlaceChanged }
    HeadingAid: HeadingAid { Used, Leads, Disagrees }
    Method: Method { Auto, Aided, Adaptive, Windowed, Constant }
    ReferenceAxis: ReferenceAxis { TopEdge, Camera, Auto }
    ScreenRotation: ScreenRotation { Deg0, Deg90, Deg180, Deg270 }
    Residual: Residual { Algebraic, Corrected }
    Normalisation: Normalisation { HalfRange, EvenSphere }
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

impl From<magcomp::Event> for Event {
    fn from(it: magcomp::Event) -> Self {
        let magcomp::Event { kind, since_ns, decided_ns } = it;
        Self { kind: kind.into(), since_ns, decided_ns }
    }
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

#[uniffi::export]
impl HeadingAid {
    /// One sentence an app may show.
    pub fn text(&self) -> String {
        magcomp::HeadingAid::from(*self).to_string()
    }
}

impl Axis {
    pub(crate) fn code(self) -> i32 {
        self as i32
    }
}

impl EventRejection {
    pub(crate) fn code(self) -> i32 {
        self as i32 + 1
    }
}

impl SensorMode {
    pub(crate) fn code(self) -> i32 {
        self as i32
    }
}

impl ModelOrder {
    pub(crate) fn code(self) -> i32 {
        self as i32
    }
}

impl EventKind {
    pub(crate) fn code(self) -> i32 {
        self as i32
    }
}

/// No case, where a number is a case's code.
pub(crate) const NONE: i32 = -1;

/// `MagcompStatus`.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct FlatStatus {
    pub(crate) kind: i32,
    pub(crate) reason: i32,
    pub(crate) problem: i32,
    pub(crate) whole: [i64; 2],
    pub(crate) real: [f64; 3],
}

impl FlatStatus {
    const fn of(kind: i32, reason: i32) -> Self {
        Self { kind, reason, problem: NONE, whole: [0; 2], real: [f64::NAN; 3] }
    }

    const fn whole(self, first: i64, second: i64) -> Self {
        Self { whole: [first, second], ..self }
    }

    const fn real(self, first: f64, second: f64, third: f64) -> Self {
        Self { real: [first, second, third], ..self }
    }
}

impl FitProblem {
    /// A status whose reason this is.
    fn of(self, kind: i32, reason: i32) -> FlatStatus {
        let with = |problem| FlatStatus { problem, ..FlatStatus::of(kind, reason) };
        match self {
            Self::TooFewSamples { have } => with(0).whole(have.into(), 0),
            Self::Planar { thickness_ut } => with(1).real(thickness_ut, f64::NAN, f64::NAN),
            Self::PoorCoverage { direction_sigma_deg, limit_deg } => with(2).real(direction_sigma_deg, limit_deg, f64::NAN),
            Self::Inconsistent { residual_ut, limit_ut } => with(3).real(residual_ut, limit_ut, f64::NAN),
            Self::NotAnEllipsoid => with(4),
            Self::FieldOutOfRange { field_ut, low_ut, high_ut } => with(5).real(field_ut, low_ut, high_ut),
            Self::NotFinite => with(6),
        }
    }
}

impl From<Status> for FlatStatus {
    fn from(status: Status) -> Self {
        match status {
            Status::Collecting { missing } => match missing {
                Missing::Samples { have, need } => Self::of(0, 0).whole(have.into(), need.into()),
                Missing::Fit { problem } => problem.of(0, 1),
                Missing::Rotation => Self::of(0, 2),
                Missing::Directions => Self::of(0, 3),
            },
            Status::Tracking => Self::of(1, NONE),
            Status::Suspect { since_ns } => Self::of(2, NONE).whole(since_ns, 0),
            Status::Held { reason } => match reason {
                HoldReason::LowUniformity => Self::of(3, 0),
                HoldReason::FitRefused { problem } => problem.of(3, 1),
                HoldReason::Constant => Self::of(3, 2),
                HoldReason::AtRest => Self::of(3, 3),
                HoldReason::TooLittleRotation => Self::of(3, 4),
                HoldReason::NoGyroscope => Self::of(3, 5),
            },
            Status::Disturbed { since_ns } => Self::of(4, NONE).whole(since_ns, 0),
            Status::Rejected { reason } => match reason {
                RejectReason::NotFinite => Self::of(5, 0),
                RejectReason::OutOfRange { value_ut, limit_ut } => Self::of(5, 1).real(value_ut, limit_ut, f64::NAN),
                RejectReason::Saturated { axis, value_ut, rail_ut } => Self::of(5, 2).whole(axis.code().into(), 0).real(value_ut, rail_ut, f64::NAN),
                RejectReason::TimeNotAfter { time_ns, latest_ns } => Self::of(5, 3).whole(time_ns, latest_ns),
                RejectReason::TimeJump { gap_s, limit_s } => Self::of(5, 4).real(gap_s, limit_s, f64::NAN),
                RejectReason::Stuck { repeats } => Self::of(5, 5).whole(repeats.into(), 0),
                RejectReason::Axes { x, y, z } => Self::of(5, 6).real(x.into(), y.into(), z.into()),
            },
        }
    }
}
