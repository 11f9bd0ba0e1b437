// made by bindings/generate.sh from bindings/config.toml
//! The settings' records and their conversions: what was left out becomes the core's default.

// one way to write a member, whichever struct of the core's it is in
#![allow(clippy::field_reassign_with_default)]

use crate::convert::count;
use crate::error::MagcompError;
use crate::record::Calibration;
use crate::status::{Method, ReferenceAxis, ScreenRotation, Residual, Normalisation};

/// A count of the core's; `field` is where it stands in the config.
fn size(field: &str, n: i32) -> Result<usize, MagcompError> {
    usize::try_from(n).map_err(|_| MagcompError::Config {
        field: field.to_owned(),
        value: n.to_string(),
        expected: "0 or above".to_owned(),
    })
}

/// All settings of a compensator. A setting left out has its default. `default_config()` shows them all.
#[derive(Clone, Debug, Default, PartialEq, uniffi::Record)]
pub struct Config {
    /// How the hard and soft iron are estimated. Default `Auto`.
    #[uniffi(default = None)]
    pub method: Option<Method>,
    /// A calibration to begin with, from elsewhere; that of the last launch is for `adopt_kept`. Default none.
    #[uniffi(default = None)]
    pub initial: Option<Calibration>,
    /// One standard deviation of each component of `initial`'s hard iron, microtesla, 0.01 to 1000. Default 2; larger makes the first headings less sure, and learning faster.
    #[uniffi(default = None)]
    pub initial_sigma_ut: Option<f64>,
    /// Whether the operating system's own hard-iron estimate, where samples carry one, becomes the first calibration when there is no other. There are then readings from the first sample on, with a standard deviation of 13 microtesla per axis. Default true.
    #[uniffi(default = None)]
    pub use_reported_hard_iron: Option<bool>,
    /// Largest component of a raw sample, microtesla, 1 to 100 000; a larger one is rejected. Default 2000; larger accepts stronger magnets.
    #[uniffi(default = None)]
    pub range_ut: Option<f64>,
    /// The magnetometer's full scale, microtesla (Android: `Sensor.getMaximumRange`). A component at or beyond it is rejected as saturated. 1 to 100 000. Default none: it is found once an axis has read the same extreme again and again in motion.
    #[uniffi(default = None)]
    pub rail_ut: Option<f64>,
    /// The field's strength, microtesla, 1 to 1000, where it is known (the geomagnetic model gives it): then the soft iron carries the sensor's scale. Every method listens to it. Default none: found by the method.
    #[uniffi(default = None)]
    pub field_strength_ut: Option<f64>,
    /// How headings are reported.
    #[uniffi(default = None)]
    pub heading: Option<HeadingConfig>,
    /// The paper's method.
    #[uniffi(default = None)]
    pub windowed: Option<WindowedConfig>,
}

impl From<magcomp::Config> for Config {
    fn from(core: magcomp::Config) -> Self {
        let magcomp::Config { method, initial, initial_sigma_ut, range_ut, rail_ut, field_strength_ut, heading, windowed } = core;
        Self {
            method: Some(method.into()),
            initial: initial.map(Into::into),
            initial_sigma_ut: Some(initial_sigma_ut),
            use_reported_hard_iron: Some(true),
            range_ut: Some(range_ut),
            rail_ut,
            field_strength_ut,
            heading: Some(heading.into()),
            windowed: Some(windowed.into()),
        }
    }
}

impl TryFrom<Config> for magcomp::Config {
    type Error = MagcompError;
    fn try_from(it: Config) -> Result<Self, MagcompError> {
        let mut core = Self::default();
        if let Some(value) = it.method {
            core.method = value.into();
        }
        core.initial = it.initial.map(TryInto::try_into).transpose()?;
        if let Some(value) = it.initial_sigma_ut {
            core.initial_sigma_ut = value;
        }
        if let Some(value) = it.range_ut {
            core.range_ut = value;
        }
        core.rail_ut = it.rail_ut;
        core.field_strength_ut = it.field_strength_ut;
        core.heading = it.heading.unwrap_or_default().try_into()?;
        core.windowed = it.windowed.unwrap_or_default().try_into()?;
        core.validate()?;
        Ok(core)
    }
}

/// How headings are reported. A field left out is the default.
#[derive(Clone, Debug, Default, PartialEq, uniffi::Record)]
pub struct HeadingConfig {
    /// The axis whose heading it is. Default `Auto`.
    #[uniffi(default = None)]
    pub axis: Option<ReferenceAxis>,
    /// How the screen's content is turned against the device. Default `Deg0`, not at all.
    #[uniffi(default = None)]
    pub screen_rotation: Option<ScreenRotation>,
    /// Declination, degrees, east positive, -180 to 180: gives `true_heading_deg`. Default none.
    #[uniffi(default = None)]
    pub declination_deg: Option<f64>,
    /// Standard deviation of `up` at rest, degrees, 0 to 90, for `heading_sigma_deg`; what motion adds to gravity comes on top. Default 0.5.
    #[uniffi(default = None)]
    pub tilt_sigma_deg: Option<f64>,
}

impl From<magcomp::HeadingConfig> for HeadingConfig {
    fn from(core: magcomp::HeadingConfig) -> Self {
        let magcomp::HeadingConfig { axis, screen_rotation, declination_deg, tilt_sigma_deg } = core;
        Self {
            axis: Some(axis.into()),
            screen_rotation: Some(screen_rotation.into()),
            declination_deg,
            tilt_sigma_deg: Some(tilt_sigma_deg),
        }
    }
}

impl TryFrom<HeadingConfig> for magcomp::HeadingConfig {
    type Error = MagcompError;
    fn try_from(it: HeadingConfig) -> Result<Self, MagcompError> {
        let mut core = Self::default();
        core.axis = it.axis.unwrap_or(ReferenceAxis::Auto).into();
        if let Some(value) = it.screen_rotation {
            core.screen_rotation = value.into();
        }
        core.declination_deg = it.declination_deg;
        if let Some(value) = it.tilt_sigma_deg {
            core.tilt_sigma_deg = value;
        }
        Ok(core)
    }
}

/// The paper's method (section IV, fig. 3). A field left out is the default.
#[derive(Clone, Debug, Default, PartialEq, uniffi::Record)]
pub struct WindowedConfig {
    /// N_min, samples, 9 to N_max: the shortest window, and what sigma_T looks at. Default 100; smaller follows changes sooner with more noise.
    #[uniffi(default = None)]
    pub n_min: Option<i32>,
    /// N_max, samples, at most 100 000: the longest window. Default 2000; larger is steadier under poor motion and slower to forget.
    #[uniffi(default = None)]
    pub n_max: Option<i32>,
    /// sigma_th, dimensionless, 0 to 10: below it nothing is updated. Default 0.1.
    #[uniffi(default = None)]
    pub sigma_th: Option<f64>,
    /// How the standard deviations in sigma_T are normalised. Default `HalfRange`.
    #[uniffi(default = None)]
    pub normalisation: Option<Normalisation>,
    /// The residual that fits square and sum. Default `Corrected`. `Algebraic` follows the paper as written: a window is fitted however far its samples lie from one ellipsoid.
    #[uniffi(default = None)]
    pub residual: Option<Residual>,
    /// Least white noise, microtesla per axis, 0 to 1000, for which a fit is judged. Default 5; smaller accepts poorer coverage where the residual is small.
    #[uniffi(default = None)]
    pub noise_floor_ut: Option<f64>,
}

impl From<magcomp::WindowedConfig> for WindowedConfig {
    fn from(core: magcomp::WindowedConfig) -> Self {
        let magcomp::WindowedConfig { n_min, n_max, sigma_th, normalisation, residual, noise_floor_ut } = core;
        Self {
            n_min: Some(count(n_min)),
            n_max: Some(count(n_max)),
            sigma_th: Some(sigma_th),
            normalisation: Some(normalisation.into()),
            residual: Some(residual.into()),
            noise_floor_ut: Some(noise_floor_ut),
        }
    }
}

impl TryFrom<WindowedConfig> for magcomp::WindowedConfig {
    type Error = MagcompError;
    fn try_from(it: WindowedConfig) -> Result<Self, MagcompError> {
        let mut core = Self::default();
        if let Some(value) = it.n_min {
            core.n_min = size("windowed.n_min", value)?;
        }
        if let Some(value) = it.n_max {
            core.n_max = size("windowed.n_max", value)?;
        }
        if let Some(value) = it.sigma_th {
            core.sigma_th = value;
        }
        if let Some(value) = it.normalisation {
            core.normalisation = value.into();
        }
        if let Some(value) = it.residual {
            core.residual = value.into();
        }
        if let Some(value) = it.noise_floor_ut {
            core.noise_floor_ut = value;
        }
        Ok(core)
    }
}

/// What a fit accepts and how it iterates. A field left out is the default.
#[derive(Clone, Debug, Default, PartialEq, uniffi::Record)]
pub struct FitOptions {
    /// The residual that a fit squares and sums. Default `Corrected`.
    #[uniffi(default = None)]
    pub residual: Option<Residual>,
    /// The field's strength, microtesla, 1 to 1000, where it is known (the geomagnetic model gives it): then the soft iron carries the sensor's scale. Every method listens to it. Default none: found by the method.
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
    /// The iteration has converged when a step changes no parameter by more than this (field strengths), 1e-16 to 0.1. Default 1e-10.
    #[uniffi(default = None)]
    pub tolerance: Option<f64>,
}

impl From<magcomp::FitOptions> for FitOptions {
    fn from(core: magcomp::FitOptions) -> Self {
        let magcomp::FitOptions { residual, field_strength_ut, field_range_ut, max_direction_sigma_deg, noise_floor_ut, max_residual_share, max_iterations, tolerance } = core;
        Self {
            residual: Some(residual.into()),
            field_strength_ut,
            field_low_ut: Some(field_range_ut.0),
            field_high_ut: Some(field_range_ut.1),
            max_direction_sigma_deg: Some(max_direction_sigma_deg),
            noise_floor_ut: Some(noise_floor_ut),
            max_residual_share: Some(max_residual_share),
            max_iterations: Some(count(max_iterations)),
            tolerance: Some(tolerance),
        }
    }
}

impl TryFrom<FitOptions> for magcomp::FitOptions {
    type Error = MagcompError;
    fn try_from(it: FitOptions) -> Result<Self, MagcompError> {
        let mut core = Self::default();
        if let Some(value) = it.residual {
            core.residual = value.into();
        }
        core.field_strength_ut = it.field_strength_ut;
        if let Some(value) = it.field_low_ut {
            core.field_range_ut.0 = value;
        }
        if let Some(value) = it.field_high_ut {
            core.field_range_ut.1 = value;
        }
        if let Some(value) = it.max_direction_sigma_deg {
            core.max_direction_sigma_deg = value;
        }
        if let Some(value) = it.noise_floor_ut {
            core.noise_floor_ut = value;
        }
        if let Some(value) = it.max_residual_share {
            core.max_residual_share = value;
        }
        if let Some(value) = it.max_iterations {
            core.max_iterations = size("fit.max_iterations", value)?;
        }
        if let Some(value) = it.tolerance {
            core.tolerance = value;
        }
        Ok(core)
    }
}
