//! The border between the core and Kotlin or Swift: converts and delegates, nothing else.
//!
//! uniffi serves everything that is not hot; `fast` (JNI) serves the stream of sensor events on the JVM, `c` (C) in Swift,
//! both with the numbers of `reading`. All act on the same objects. A panic never crosses: it becomes
//! [`MagcompError::Panicked`], and the object refuses further use until it is reset.
//!
//! Conversions are in `record`, `reading`, `status`, `config` and `error` alone, as exhaustive matches and destructurings: what
//! the core gains, the compiler asks for here.

mod c;
mod compensator;
mod config;
mod constant_field;
mod convert;
mod error;
#[cfg(not(target_vendor = "apple"))]
mod fast;
mod flat;
mod geomagnetic;
mod guarded;
mod handles;
#[cfg(not(target_vendor = "apple"))]
mod java;
mod logging;
mod outside;
// made, for people to read and not to edit, as `status` is
#[rustfmt::skip]
mod reading;
mod record;
#[rustfmt::skip]
mod status;

pub use compensator::Compensator;
pub use config::{Config, FitOptions, HeadingConfig, WindowedConfig, default_config};
pub use constant_field::ConstantField;
pub use error::MagcompError;
pub use geomagnetic::{GeomagneticField, geomagnetic_field};
pub use logging::{LogLevel, start_logging};
pub use outside::{AttitudeSample, FoundDeclination, HeadedAxis, HeadingSample, NorthReference, Yaw};
pub use reading::Reading;
pub use record::{
    Calibration, Coverage, Fit, Heading, HeadingFrame, MagneticSample, RotationRateSample, SoftIron, Termination,
    UpSample, Vector3, correct, heading, true_heading_deg,
};
pub use status::{
    Axis, Event, EventKind, EventRejection, FitProblem, HeadingAid, HoldReason, Method, Missing, ModelOrder,
    Normalisation, ReferenceAxis, RejectReason, Residual, ScreenRotation, SensorMode, Status,
};

uniffi::setup_scaffolding!();
