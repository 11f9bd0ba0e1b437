//! The config as it crosses the border: every field may be left out, and then is the core's default.

mod convert;

use crate::record::{Calibration, ReferenceAxis, ScreenRotation};

/// How the hard and soft iron are estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Method {
    /// Uses gyroscope and gravity beside the magnetometer; works as `Adaptive` while there is no usable gyroscope.
    Auto,
    /// The same as `Auto`.
    Aided,
    /// Uses the magnetometer alone; notices changes and relearns them as fast as the samples allow.
    Adaptive,
    /// The paper's method: an ellipsoid fit over the latest samples, whose number follows sigma_T.
    Windowed,
    /// The first step of the paper's method alone: one fit of the first well spread samples, kept from then on.
    Constant,
}

/// All settings of a compensator. A setting left out has the library's default; `default_config()` shows them all.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct Config {
    /// How the hard and soft iron are estimated. Default `Auto`.
    #[uniffi(default = None)]
    pub method: Option<Method>,
    /// A calibration to begin with, from elsewhere; that of the last launch is for `adopt_kept`. Default none.
    #[uniffi(default = None)]
    pub initial: Option<Calibration>,
    /// One standard deviation of each component of `initial`'s hard iron, microtesla, 0.01 to 1000. Default 2; larger makes the
    /// first headings less sure, and learning faster.
    #[uniffi(default = None)]
    pub initial_sigma_ut: Option<f64>,
    /// Whether the operating system's own hard-iron estimate, where samples carry one, becomes the first calibration
    /// when there is no other. There are then readings from the first sample on, with a standard deviation of 13
    /// microtesla per axis. Default true.
    #[uniffi(default = None)]
    pub use_reported_hard_iron: Option<bool>,
    /// Largest component of a raw sample, microtesla, 1 to 100 000; a larger one is rejected. Default 2000; larger accepts stronger
    /// magnets.
    #[uniffi(default = None)]
    pub range_ut: Option<f64>,
    /// The magnetometer's full scale, microtesla (Android: `Sensor.getMaximumRange`). A component at or beyond it is rejected
    /// as saturated. 1 to 100 000. Default none: it is found once an axis has read the same extreme again and again in motion.
    #[uniffi(default = None)]
    pub rail_ut: Option<f64>,
    /// The field's strength, microtesla, 1 to 1000, where it is known (the geomagnetic model gives it): then the soft iron
    /// carries the sensor's scale. Every method listens to it. Default none: found by the method.
    #[uniffi(default = None)]
    pub field_strength_ut: Option<f64>,
    /// How headings are reported.
    #[uniffi(default = None)]
    pub heading: Option<HeadingConfig>,
    /// The paper's method.
    #[uniffi(default = None)]
    pub windowed: Option<WindowedConfig>,
}

/// The residual that a fit squares and sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Residual {
    /// Eq. (10) of the paper as written.
    Algebraic,
    /// Divided by its own gradient: a distance in raw units, free of the noise bias.
    Corrected,
}

/// What a fit accepts and how it iterates. A field left out is the default.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct FitOptions {
    /// The residual that a fit squares and sums. Default `Corrected`.
    #[uniffi(default = None)]
    pub residual: Option<Residual>,
    /// The field's strength, microtesla, 1 to 1000, where it is known (the geomagnetic model gives it): then the soft iron
    /// carries the sensor's scale. Every method listens to it. Default none: found by the method.
    #[uniffi(default = None)]
    pub field_strength_ut: Option<f64>,
    /// Smallest field strength accepted, microtesla, 1 or more. Default 22.
    #[uniffi(default = None)]
    pub field_low_ut: Option<f64>,
    /// Largest field strength accepted, microtesla, at most 1000. Default 67.
    #[uniffi(default = None)]
    pub field_high_ut: Option<f64>,
    /// Largest predicted rms direction error, degrees, 0.001 to 180, that is accepted. Default 10; larger accepts poorer coverage.
    #[uniffi(default = None)]
    pub max_direction_sigma_deg: Option<f64>,
    /// Least white noise, microtesla per axis, 0 to 1000, for which the direction error is predicted. Default 5.
    #[uniffi(default = None)]
    pub noise_floor_ut: Option<f64>,
    /// Largest residual rms that is accepted, as a share of the field strength, 0.0001 to 1000. Default 0.05.
    #[uniffi(default = None)]
    pub max_residual_share: Option<f64>,
    /// Iterations at the most, 1 to 1000. Default 50.
    #[uniffi(default = None)]
    pub max_iterations: Option<i32>,
    /// The iteration has converged when a step changes no parameter by more than this (field strengths), 1e-16 to 0.1. Default
    /// 1e-10.
    #[uniffi(default = None)]
    pub tolerance: Option<f64>,
}

/// How the standard deviations in sigma_T are normalised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Normalisation {
    /// By half the range of each axis.
    HalfRange,
    /// By the standard deviation of evenly spread directions.
    EvenSphere,
}

/// The paper's method. A field left out is the default.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct WindowedConfig {
    /// N_min, samples, 9 to N_max: the shortest window. Default 100.
    #[uniffi(default = None)]
    pub n_min: Option<i32>,
    /// N_max, samples, at most 100 000: the longest window. Default 2000.
    #[uniffi(default = None)]
    pub n_max: Option<i32>,
    /// sigma_th, dimensionless, 0 to 10: below it nothing is updated. Default 0.1.
    #[uniffi(default = None)]
    pub sigma_th: Option<f64>,
    /// How the standard deviations in sigma_T are normalised. Default `HalfRange`.
    #[uniffi(default = None)]
    pub normalisation: Option<Normalisation>,
    /// The residual that fits square and sum. Default `Corrected`. `Algebraic` follows the paper as written: a window
    /// is fitted however far its samples lie from one ellipsoid.
    #[uniffi(default = None)]
    pub residual: Option<Residual>,
    /// Least white noise, microtesla per axis, 0 to 1000, for which a fit is judged. Default 5; smaller accepts poorer
    /// coverage where the residual is small.
    #[uniffi(default = None)]
    pub noise_floor_ut: Option<f64>,
}

/// How headings are reported. A field left out is the default.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct HeadingConfig {
    /// The axis whose heading it is. Default `Auto`.
    #[uniffi(default = None)]
    pub axis: Option<ReferenceAxis>,
    /// How the screen's content is turned. Default not at all.
    #[uniffi(default = None)]
    pub screen_rotation: Option<ScreenRotation>,
    /// Declination, degrees, east positive, -180 to 180: gives `true_heading_deg`. Default none.
    #[uniffi(default = None)]
    pub declination_deg: Option<f64>,
    /// Standard deviation of `up` at rest, degrees, 0 to 90, for `heading_sigma_deg`; what motion adds to gravity comes on top. Default 0.5.
    #[uniffi(default = None)]
    pub tilt_sigma_deg: Option<f64>,
}

/// The library's defaults, every field given.
#[uniffi::export]
pub fn default_config() -> Config {
    let magcomp::Config {
        method,
        initial,
        initial_sigma_ut,
        range_ut,
        rail_ut,
        field_strength_ut,
        heading: _,
        windowed,
    } = magcomp::Config::default();
    Config {
        method: Some(method.into()),
        initial: initial.map(Into::into),
        initial_sigma_ut: Some(initial_sigma_ut),
        use_reported_hard_iron: Some(true),
        range_ut: Some(range_ut),
        rail_ut,
        field_strength_ut,
        heading: Some(HeadingConfig::default()),
        windowed: Some(windowed.into()),
    }
}
