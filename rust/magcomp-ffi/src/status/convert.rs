//! Status and what belongs to it, from the library's types and back.

use super::{
    Axis, Event, EventKind, EventRejection, FitProblem, HoldReason, Missing, ModelOrder, RejectReason, SensorMode,
    Status,
};
use crate::convert::{count, same_names};

impl From<magcomp::Status> for Status {
    fn from(s: magcomp::Status) -> Self {
        use magcomp::Status as S;
        match s {
            S::Collecting(missing) => Self::Collecting { missing: missing.into() },
            S::Tracking => Self::Tracking,
            S::Suspect { since_ns } => Self::Suspect { since_ns },
            S::Held(reason) => Self::Held { reason: reason.into() },
            S::Disturbed { since_ns } => Self::Disturbed { since_ns },
            S::Rejected(reason) => Self::Rejected { reason: reason.into() },
        }
    }
}

impl From<Status> for magcomp::Status {
    fn from(s: Status) -> Self {
        match s {
            Status::Collecting { missing } => Self::Collecting(missing.into()),
            Status::Tracking => Self::Tracking,
            Status::Suspect { since_ns } => Self::Suspect { since_ns },
            Status::Held { reason } => Self::Held(reason.into()),
            Status::Disturbed { since_ns } => Self::Disturbed { since_ns },
            Status::Rejected { reason } => Self::Rejected(reason.into()),
        }
    }
}

impl From<magcomp::Missing> for Missing {
    fn from(m: magcomp::Missing) -> Self {
        use magcomp::Missing as M;
        match m {
            M::Samples { have, need } => Self::Samples { have: count(have), need: count(need) },
            M::Fit(error) => Self::Fit { problem: error.into() },
            M::Rotation => Self::Rotation,
            M::Directions => Self::Directions,
        }
    }
}

impl From<Missing> for magcomp::Missing {
    fn from(m: Missing) -> Self {
        match m {
            Missing::Samples { have, need } => Self::Samples { have: size(have), need: size(need) },
            Missing::Fit { problem } => Self::Fit(problem.into()),
            Missing::Rotation => Self::Rotation,
            Missing::Directions => Self::Directions,
        }
    }
}

impl From<magcomp::Event> for Event {
    fn from(e: magcomp::Event) -> Self {
        let magcomp::Event { kind, since_ns, decided_ns } = e;
        Self { kind: kind.into(), since_ns, decided_ns }
    }
}

same_names! {
    Axis { X, Y, Z }
    EventRejection { NotFinite, OutOfRange, Late, Duplicate, Ahead }
    SensorMode { GyroscopeAndGravity, GyroscopeOnly, GravityOnly, MagnetometerOnly }
    ModelOrder { Nothing, HardIron, All, Former }
    EventKind { DeviceStep, DeviceStepBack, PlaceChanged }
}

impl From<magcomp::HoldReason> for HoldReason {
    fn from(r: magcomp::HoldReason) -> Self {
        use magcomp::HoldReason as H;
        match r {
            H::LowUniformity => Self::LowUniformity,
            H::FitRefused(error) => Self::FitRefused { problem: error.into() },
            H::Constant => Self::Constant,
            H::AtRest => Self::AtRest,
            H::TooLittleRotation => Self::TooLittleRotation,
            H::NoGyroscope => Self::NoGyroscope,
        }
    }
}

impl From<HoldReason> for magcomp::HoldReason {
    fn from(r: HoldReason) -> Self {
        match r {
            HoldReason::LowUniformity => Self::LowUniformity,
            HoldReason::FitRefused { problem } => Self::FitRefused(problem.into()),
            HoldReason::Constant => Self::Constant,
            HoldReason::AtRest => Self::AtRest,
            HoldReason::TooLittleRotation => Self::TooLittleRotation,
            HoldReason::NoGyroscope => Self::NoGyroscope,
        }
    }
}

impl From<magcomp::RejectReason> for RejectReason {
    fn from(r: magcomp::RejectReason) -> Self {
        use magcomp::RejectReason as R;
        match r {
            R::NotFinite => Self::NotFinite,
            R::OutOfRange { value_ut, limit_ut } => Self::OutOfRange { value_ut, limit_ut },
            R::Saturated { axis, value_ut, rail_ut } => Self::Saturated { axis: axis.into(), value_ut, rail_ut },
            R::TimeNotAfter { time_ns, latest_ns } => Self::TimeNotAfter { time_ns, latest_ns },
            R::TimeJump { gap_s, limit_s } => Self::TimeJump { gap_s, limit_s },
            R::Stuck { repeats } => Self::Stuck { repeats: count(repeats) },
            R::Axes { x, y, z } => Self::Axes { x: x.into(), y: y.into(), z: z.into() },
        }
    }
}

impl From<RejectReason> for magcomp::RejectReason {
    fn from(r: RejectReason) -> Self {
        use RejectReason as R;
        match r {
            R::NotFinite => Self::NotFinite,
            R::OutOfRange { value_ut, limit_ut } => Self::OutOfRange { value_ut, limit_ut },
            R::Saturated { axis, value_ut, rail_ut } => Self::Saturated { axis: axis.into(), value_ut, rail_ut },
            R::TimeNotAfter { time_ns, latest_ns } => Self::TimeNotAfter { time_ns, latest_ns },
            R::TimeJump { gap_s, limit_s } => Self::TimeJump { gap_s, limit_s },
            R::Stuck { repeats } => Self::Stuck { repeats: size(repeats) },
            R::Axes { x, y, z } => Self::Axes { x: axis(x), y: axis(y), z: axis(z) },
        }
    }
}

impl From<magcomp::FitError> for FitProblem {
    fn from(e: magcomp::FitError) -> Self {
        use magcomp::FitError as F;
        match e {
            F::TooFewSamples { have } => Self::TooFewSamples { have: count(have) },
            F::Planar { thickness_ut } => Self::Planar { thickness_ut },
            F::PoorCoverage { direction_sigma_deg, limit_deg } => Self::PoorCoverage { direction_sigma_deg, limit_deg },
            F::Inconsistent { residual_ut, limit_ut } => Self::Inconsistent { residual_ut, limit_ut },
            F::NotAnEllipsoid => Self::NotAnEllipsoid,
            F::FieldOutOfRange { field_ut, low_ut, high_ut } => Self::FieldOutOfRange { field_ut, low_ut, high_ut },
            F::NotFinite => Self::NotFinite,
        }
    }
}

impl From<FitProblem> for magcomp::FitError {
    fn from(p: FitProblem) -> Self {
        use FitProblem as P;
        match p {
            P::TooFewSamples { have } => Self::TooFewSamples { have: size(have) },
            P::Planar { thickness_ut } => Self::Planar { thickness_ut },
            P::PoorCoverage { direction_sigma_deg, limit_deg } => Self::PoorCoverage { direction_sigma_deg, limit_deg },
            P::Inconsistent { residual_ut, limit_ut } => Self::Inconsistent { residual_ut, limit_ut },
            P::NotAnEllipsoid => Self::NotAnEllipsoid,
            P::FieldOutOfRange { field_ut, low_ut, high_ut } => Self::FieldOutOfRange { field_ut, low_ut, high_ut },
            P::NotFinite => Self::NotFinite,
        }
    }
}

/// 1 to 3, or negative; anything else is none.
fn axis(n: i32) -> i8 {
    i8::try_from(n).unwrap_or(0)
}

fn size(n: i32) -> usize {
    usize::try_from(n).unwrap_or(0)
}
