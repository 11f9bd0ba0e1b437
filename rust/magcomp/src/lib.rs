//! Frees a smartphone's magnetometer from the magnetic disturbance the phone carries, continuously, while it is in use.
//!
//! A raw magnetometer reads h_m = M h + b: the Earth's field h, squeezed by soft iron M and shifted by hard iron b.
//! [`Compensator`] re-estimates M and b from the stream of raw samples and returns for each a [`Reading`]: the corrected
//! field, the heading with its standard deviation, and what it is doing and why. By default ([`Method::Auto`]) the estimators are ours:
//! one with a gyroscope, one for the magnetometer alone. [`Method::Windowed`] is the method of P. Daponte, L. De Vito,
//! F. Picariello, S. Rapuano, C. Sementa, "A method for real-time compensation of magnetometers embedded on smartphones";
//! equation numbers in this crate are that paper's. README's limits say where the standard deviation is too small.
//!
//! Where to find what: error model (1) to (8) and correction (11) in `calibration`; the ellipsoid (9), (10) in
//! `ellipsoid`; sigma_T (12) to (15) in `uniformity`; the window (16) in `window`; fig. 3 in `estimator/windowed`; what is
//! ours in `estimator/aided` (with a gyroscope) and `estimator/adaptive` (without).
//!
//! The gauge: samples of a magnetometer determine M only up to a rotation. The symmetric positive definite M is reported.

pub use nalgebra;

mod answer;
mod calibration;
mod compensator;
mod config;
mod constant;
mod coverage;
mod ellipsoid;
mod estimator;
mod heading;
mod pairing;
mod reading;
mod sample;
mod snapshot;
mod tilt;
mod uniformity;
mod window;

pub use calibration::{Calibration, CalibrationError, Disturbance, FactoryErrors};
pub use compensator::Compensator;
pub use config::{Config, ConfigError, HeadingConfig, Method, SensorLimits, WindowedConfig};
pub use constant::ConstantField;
pub use coverage::{CELLS, Coverage};
pub use ellipsoid::{
    EllipsoidFit, FitError, FitOptions, Moments, Residual, SMALLEST_SAMPLE_COUNT, Termination, direction_sigma_deg,
    fit_ellipsoid,
};
pub use estimator::adaptive::AdaptiveConfig;
pub use estimator::aided::AidedConfig;
pub use heading::{Heading, ReferenceAxis, ScreenRotation, heading, heading_sigma_deg, true_heading_deg};
pub use pairing::{EventRejection, PairingConfig};
pub use reading::{Event, EventKind, HoldReason, Missing, ModelOrder, Reading, RejectReason, SensorMode, Status};
pub use sample::{MagneticSample, RotationRateSample, UpSample};
pub use snapshot::{Restored, SNAPSHOT_VERSION, SnapshotError};
pub use uniformity::{Normalisation, uniformity};
pub use window::window_length;

/// README's code runs as a test.
#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
struct Readme;
