//! A compass library for phones: it keeps pointing north when a magnet is put on the phone, and says how far off it may be.
//!
//! A raw magnetometer reads h_m = M h + b: the Earth's field h, squeezed by soft iron M and shifted by hard iron b.
//! [`Compensator`] re-estimates M and b from the stream of raw samples and returns for each a [`Reading`]: the corrected
//! field, the heading with its standard deviation, and what it is doing and why. By default ([`Method::Auto`]) the estimators are ours:
//! one with a gyroscope, one for the magnetometer alone. [`Method::Windowed`] is the method of P. Daponte, L. De Vito,
//! F. Picariello, S. Rapuano, C. Sementa, "A method for real-time compensation of magnetometers embedded on smartphones";
//! equation numbers in this crate are that paper's. docs/LIMITS.md says where the standard deviation is too small.
//!
//! ```
//! use magcomp::nalgebra::{Rotation3, Vector3};
//! use magcomp::{Compensator, Config, MagneticSample, RotationRateSample, UpSample};
//!
//! // a hand turns a phone that has 350 uT of its own
//! let attitude = |t: f64| Rotation3::from_euler_angles(0.6 * (2.0 * t).sin(), 0.5 * (1.4 * t).cos(), 0.5 * t);
//! let mut compensator = Compensator::new(Config::default())?;
//! for k in 1..=600_i64 {
//!     let (time_ns, t) = (10_000_000 * k, 0.01 * k as f64);
//!     let turn = attitude(t - 0.005).inverse() * attitude(t + 0.005);
//!     let to_device = attitude(t).inverse();
//!     let up_m_s2 = to_device * Vector3::new(0.0, 0.0, 9.81);
//!     let field_ut = to_device * Vector3::new(0.0, 25.0, -43.0) + Vector3::new(150.0, -70.0, 310.0);
//!
//!     // an event that cannot be used is refused, says why, and changes nothing
//!     let _ = compensator.push_rotation_rate(RotationRateSample { time_ns, rate_rad_s: turn.scaled_axis() / 0.01 });
//!     let _ = compensator.push_up(UpSample { time_ns, up_m_s2 });
//!     let reading = compensator.push(MagneticSample { time_ns, field_ut });
//!     if k % 100 == 0 {
//!         match reading.heading {
//!             Some(it) => println!("{:.0} deg +- {:.1}", it.heading_deg, it.heading_sigma_deg.unwrap_or(180.0)),
//!             None => println!("{}", reading.status), // a sentence that says what is missing
//!         }
//!     }
//! }
//! # assert!(compensator.keep(0).is_some());
//! # Ok::<(), magcomp::ConfigError>(())
//! ```
//!
//! `examples/compass.rs` is a compass of a stream of events.
//!
//! # Where each equation lives
//!
//! Files are those of `src/`. Each opens with its equations and their source; `docs/dev/METHOD.md` has the reasons. For our two estimators the
//! headings of `docs/dev/METHOD-AIDED.md` and `docs/dev/METHOD-ADAPTIVE.md` name the file of each equation.
//!
//! | equation, idea | item | file |
//! |---|---|---|
//! | (1) to (8) factory errors and disturbance: M = S C A, b = S C b_m + b_0 | [`FactoryErrors::compose`] | `calibration.rs` |
//! | h_m = M h + b | [`Calibration::distort`] | `calibration.rs` |
//! | (9), (10) the least-squares ellipsoid | [`fit_ellipsoid`], [`FitOptions`] | `ellipsoid/cost.rs`, `math/descend.rs` |
//! | its sums, exact, of constant cost | [`Moments`] | `ellipsoid/moments.rs` |
//! | its closed-form start | [`Moments::fit`] | `ellipsoid/start.rs` |
//! | its covariance; what is refused | [`EllipsoidFit`], [`direction_sigma_deg`] | `ellipsoid/report.rs` |
//! | (11) h = M^-1 (h_m - b) | [`Calibration::correct`] | `calibration.rs` |
//! | (12) to (15) sigma_T | [`uniformity`] | `estimator/paper/uniformity.rs` |
//! | (16) the window N | [`window_length`] | `estimator/paper/window.rs` |
//! | fig. 3, the real-time loop | [`Method::Windowed`], [`WindowedConfig`] | `estimator/paper/windowed.rs` |
//! | section III, a constant field | [`ConstantField`], [`Method::Constant`] | `estimator/paper/constant.rs` |
//! | the gauge: M symmetric, M = P R | [`Calibration::from_any`] | `calibration.rs` |
//! | ours, with a gyroscope: state, propagation, measurement, hypotheses | [`Method::Aided`] | `estimator/aided/` |
//! | ours, the magnetometer alone: a bank of filters over stored frames | [`Method::Adaptive`] | `estimator/adaptive/` |
//! | events that are delivered late or in batches, in the order of their times | [`EventQueue`] | `sensing/order.rs` |
//! | the turn between two samples; how far gravity leans | [`Compensator::push_rotation_rate`], [`Compensator::push_up`] | `sensing/` |
//! | heading atan2(a.E, a.N), its sigma, inclination | [`heading`], [`heading_sigma_deg`] | `heading.rs` |
//! | attitude from field and up, its sigma | [`attitude`], [`attitude_sigma_deg`] | `attitude.rs` |
//! | headings from outside, carried by the gyroscope | [`Compensator::push_heading`], [`Compensator::push_attitude`] | `north/` |
//! | when each direction was last seen, for every method | [`Coverage`] | `coverage/` |
//! | one `push`, from sample to reading | [`Compensator`], [`Reading`] | `compensator.rs` |
//! | why a reading says what it says | [`Compensator::explain`], [`Explanation`] | `explanation.rs`, `estimator/aided/explain.rs` |
//! | the settings | [`Config`] | `config.rs` |
//! | a calibration kept from one launch to the next; what live samples say of it | [`KeptCalibration`], [`Compensator::adopt`] | `kept.rs`, `compensator/keep.rs`, `adopted.rs` |
//!
//! The gauge: samples of a magnetometer determine M only up to a rotation. The symmetric positive definite M is reported.
//!
//! A reading has the same bits on every platform: sines, exponentials and their like come from the crate `libm` (`math/elementary.rs`).
//!
//! Without its default feature `std` the crate needs `alloc` alone.

#![cfg_attr(not(any(feature = "std", test)), no_std)]
#![cfg_attr(
    test,
    allow(
        clippy::disallowed_methods,
        reason = "tests compare with the platform's functions or make their own streams with them"
    )
)]

extern crate alloc;

pub use nalgebra;

mod attitude;
mod calibration;
mod compensator;
// made, as `status` is
#[rustfmt::skip]
mod config;
mod coverage;
mod ellipsoid;
mod estimator;
mod explanation;
mod heading;
mod kept;
mod level;
mod math;
mod noise;
mod north;
mod pointing;
mod priors;
mod range;
mod reading;
mod room;
mod sample;
mod sensing;
// made, for people to read and not to edit
#[rustfmt::skip]
mod status;
mod strength;
mod tuning;

pub use attitude::{Attitude, attitude, attitude_sigma_deg};
pub use calibration::{Calibration, CalibrationError, Disturbance, FactoryErrors};
pub use compensator::Compensator;
#[doc(hidden)]
pub use compensator::Tunings;
pub use config::{
    Config, HeadingConfig, Method, Normalisation, ReferenceAxis, Residual, ScreenRotation, WindowedConfig,
};
pub use coverage::{CELLS, Coverage};
pub use ellipsoid::{
    EllipsoidFit, FitOptions, Moments, SMALLEST_SAMPLE_COUNT, Termination, direction_sigma_deg, fit_ellipsoid,
};
pub use estimator::paper::{ConstantField, uniformity, window_length};
pub use explanation::{
    ChangeHypothesis, ChangeKind, EXPLAINED_HYPOTHESES, Estimator, EstimatorPhase, Explanation, InnovationTest,
    NoiseLevels, OutsideTest, SampleUse,
};
pub use heading::{Heading, heading, heading_sigma_deg, true_heading_deg};
pub use kept::{CalibrationSource, KEPT_VERSION, KeptCalibration, KeptError};
pub use pointing::Pointing;
pub use range::ConfigError;
pub use reading::{Event, Reading};
pub use sample::{
    AttitudeSample, HeadedAxis, HeadingSample, MagneticSample, NorthReference, RotationRateSample, UpSample, Yaw,
};
pub use sensing::order::{EventQueue, SensorEvent};
pub use status::{
    Axis, EventKind, EventRejection, FitError, HeadingAid, HoldReason, Missing, ModelOrder, RejectReason, SensorMode,
    Status,
};
#[doc(hidden)]
pub use tuning::{Choice, Mechanism};

/// README's code runs as a test.
#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
