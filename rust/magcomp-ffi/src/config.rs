//! The config as it crosses the border: every field may be left out, and then is the core's default.

use crate::error::MagcompError;
use crate::record::{Calibration, count, same_names};
use std::collections::HashMap;

/// How the hard and soft iron are estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Method {
    /// `Aided` while rotation rates arrive, else `Adaptive`.
    Auto,
    /// Gyroscope and gravity beside the magnetometer, whether or not they arrive.
    Aided,
    /// The magnetometer alone: a fit of everything since the latest change, changes noticed by themselves.
    Adaptive,
    /// The paper's: an ellipsoid fit over the latest samples, their number following sigma_T.
    Windowed,
    /// Its first step alone: one fit of the first well spread samples, then kept.
    Constant,
}

/// Everything a compensator can be told. A field left out is the library's default; `default_config()` shows them all.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct Config {
    /// How the hard and soft iron are estimated. Default `Auto`.
    #[uniffi(default = None)]
    pub method: Option<Method>,
    /// A calibration to begin with, for instance that of the last launch. Default none.
    #[uniffi(default = None)]
    pub initial: Option<Calibration>,
    /// Whether the operating system's own hard-iron estimate, where samples carry one, is the first calibration when
    /// there is no other: readings from the first sample on, as good as that estimate. Default false.
    #[uniffi(default = None)]
    pub use_reported_hard_iron: Option<bool>,
    /// What a raw sample may be.
    #[uniffi(default = None)]
    pub sensor: Option<SensorLimits>,
    /// What an ellipsoid fit accepts.
    #[uniffi(default = None)]
    pub fit: Option<FitOptions>,
    /// The paper's method.
    #[uniffi(default = None)]
    pub windowed: Option<WindowedConfig>,
    /// Settings of the method with gyroscope and gravity, by the name of a field of `AidedConfig` in the Rust library,
    /// which documents them with their units and ranges. A setting left out is the default.
    #[uniffi(default = None)]
    pub aided: Option<HashMap<String, f64>>,
    /// The method with the magnetometer alone: noise to start from, microtesla per axis, 0.01 to 20. Default 0.5; it is learned.
    #[uniffi(default = None)]
    pub adaptive_noise_ut: Option<f64>,
    /// How events of several sensors are brought together.
    #[uniffi(default = None)]
    pub pairing: Option<PairingConfig>,
    /// How headings are reported.
    #[uniffi(default = None)]
    pub heading: Option<HeadingConfig>,
}

/// What a raw sample may be; anything else is rejected with a reason. A field left out is the default.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct SensorLimits {
    /// Largest component, microtesla. Default 2000.
    #[uniffi(default = None)]
    pub range_ut: Option<f64>,
    /// The sensor's full scale, microtesla (Android: `Sensor.getMaximumRange`). A component at or beyond it is rejected
    /// as saturated. Default none: not known.
    #[uniffi(default = None)]
    pub rail_ut: Option<f64>,
    /// So many equal samples in a row mean that the sensor hangs. 0 switches the check off. Default 50.
    #[uniffi(default = None)]
    pub stuck_samples: Option<i32>,
    /// Largest step ahead in time, seconds. Default 604800, a week.
    #[uniffi(default = None)]
    pub max_gap_s: Option<f64>,
}

/// What is squared and summed by a fit.
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
    /// What is squared and summed. Default `Corrected`.
    #[uniffi(default = None)]
    pub residual: Option<Residual>,
    /// The field's strength, microtesla, where it is known (the geomagnetic model gives it): then the soft iron carries
    /// the sensor's scale. Default none: found by the fit.
    #[uniffi(default = None)]
    pub field_strength_ut: Option<f64>,
    /// Smallest field strength accepted, microtesla. Default 22.
    #[uniffi(default = None)]
    pub field_low_ut: Option<f64>,
    /// Largest field strength accepted, microtesla. Default 67.
    #[uniffi(default = None)]
    pub field_high_ut: Option<f64>,
    /// Largest predicted rms direction error, degrees, that is accepted. Default 10; larger accepts poorer coverage.
    #[uniffi(default = None)]
    pub max_direction_sigma_deg: Option<f64>,
    /// White noise, microtesla, that does as much harm as the errors which are not white. Default 5.
    #[uniffi(default = None)]
    pub error_floor_ut: Option<f64>,
    /// Largest residual rms that is accepted, as a share of the field strength. Default 0.05.
    #[uniffi(default = None)]
    pub max_residual_share: Option<f64>,
    /// Iterations at the most. Default 50.
    #[uniffi(default = None)]
    pub max_iterations: Option<i32>,
    /// The iteration has converged when a step changes no parameter by more than this (field strengths). Default 1e-10.
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
    /// N_min, samples: the shortest window. Default 100.
    #[uniffi(default = None)]
    pub n_min: Option<i32>,
    /// N_max, samples: the longest window. Default 2000.
    #[uniffi(default = None)]
    pub n_max: Option<i32>,
    /// sigma_th, dimensionless: below it nothing is updated. Default 0.1.
    #[uniffi(default = None)]
    pub sigma_th: Option<f64>,
    /// How the standard deviations in sigma_T are normalised. Default `HalfRange`.
    #[uniffi(default = None)]
    pub normalisation: Option<Normalisation>,
    /// Samples from one fit to the next. Default 1.
    #[uniffi(default = None)]
    pub refit_stride: Option<i32>,
}

/// How events of several sensors are brought together. A field left out is the default.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct PairingConfig {
    /// A sensor whose newest event is older than this at a magnetometer sample counts as absent, seconds. Default 0.25.
    #[uniffi(default = None)]
    pub stale_s: Option<f64>,
    /// Largest rotation rate believed, rad/s. Default 60.
    #[uniffi(default = None)]
    pub max_rate_rad_s: Option<f64>,
    /// Largest acceleration believed, m/s^2. Default 200.
    #[uniffi(default = None)]
    pub max_up_m_s2: Option<f64>,
    /// An event further ahead of the newest magnetometer sample is from another clock, seconds. Default 10.
    #[uniffi(default = None)]
    pub max_lead_s: Option<f64>,
}

/// Which axis of the device the heading is that of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum ReferenceAxis {
    /// Top edge of the screen.
    TopEdge,
    /// Back camera.
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

/// How headings are reported. A field left out is the default.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct HeadingConfig {
    /// The axis whose heading it is. Default the top edge.
    #[uniffi(default = None)]
    pub axis: Option<ReferenceAxis>,
    /// How the screen's content is turned. Default not at all.
    #[uniffi(default = None)]
    pub screen_rotation: Option<ScreenRotation>,
    /// Declination, degrees, east positive, -180 to 180: gives `true_heading_deg`. Default none.
    #[uniffi(default = None)]
    pub declination_deg: Option<f64>,
    /// Standard deviation of `up`, degrees, for `heading_sigma_deg`. Default 1.
    #[uniffi(default = None)]
    pub tilt_sigma_deg: Option<f64>,
    /// What no calibration knows, microtesla per axis: the field of rooms is not uniform. Default 1.3.
    #[uniffi(default = None)]
    pub field_sigma_ut: Option<f64>,
}

/// The library's defaults, every field given.
#[uniffi::export]
pub fn default_config() -> Config {
    let magcomp::Config { method, initial, sensor, fit, windowed, aided, adaptive, pairing, heading } =
        magcomp::Config::default();
    Config {
        method: Some(method.into()),
        initial: initial.map(Into::into),
        use_reported_hard_iron: Some(false),
        sensor: Some(sensor.into()),
        fit: Some(fit.into()),
        windowed: Some(windowed.into()),
        aided: Some(settings(&aided)),
        adaptive_noise_ut: Some(adaptive.noise_ut),
        pairing: Some(pairing.into()),
        heading: Some(heading.into()),
    }
}

impl TryFrom<Config> for magcomp::Config {
    type Error = MagcompError;
    fn try_from(c: Config) -> Result<Self, MagcompError> {
        let Config {
            method,
            initial,
            use_reported_hard_iron: _,
            sensor,
            fit,
            windowed,
            aided,
            adaptive_noise_ut,
            pairing,
            heading,
        } = c;
        let d = Self::default();
        let config = Self {
            method: method.map_or(d.method, Into::into),
            initial: initial.map(TryInto::try_into).transpose()?,
            sensor: sensor.map_or(Ok(d.sensor), TryInto::try_into)?,
            fit: fit.map_or(Ok(d.fit), TryInto::try_into)?,
            windowed: windowed.map_or(Ok(d.windowed), TryInto::try_into)?,
            aided: aided.map_or(Ok(d.aided), |settings| aided_config(&settings))?,
            adaptive: magcomp::AdaptiveConfig { noise_ut: adaptive_noise_ut.unwrap_or(d.adaptive.noise_ut) },
            pairing: pairing.map_or(d.pairing, Into::into),
            heading: heading.map_or(d.heading, Into::into),
        };
        config.validate()?;
        Ok(config)
    }
}

impl From<magcomp::SensorLimits> for SensorLimits {
    fn from(s: magcomp::SensorLimits) -> Self {
        let magcomp::SensorLimits { range_ut, rail_ut, stuck_samples, max_gap_s } = s;
        Self {
            range_ut: Some(range_ut),
            rail_ut,
            stuck_samples: Some(count(stuck_samples)),
            max_gap_s: Some(max_gap_s),
        }
    }
}

impl TryFrom<SensorLimits> for magcomp::SensorLimits {
    type Error = MagcompError;
    fn try_from(s: SensorLimits) -> Result<Self, MagcompError> {
        let d = Self::default();
        Ok(Self {
            range_ut: s.range_ut.unwrap_or(d.range_ut),
            rail_ut: s.rail_ut,
            stuck_samples: size("sensor.stuck_samples", s.stuck_samples, d.stuck_samples)?,
            max_gap_s: s.max_gap_s.unwrap_or(d.max_gap_s),
        })
    }
}

impl From<magcomp::FitOptions> for FitOptions {
    fn from(f: magcomp::FitOptions) -> Self {
        let magcomp::FitOptions {
            residual,
            field_strength_ut,
            field_range_ut: (field_low_ut, field_high_ut),
            max_direction_sigma_deg,
            error_floor_ut,
            max_residual_share,
            max_iterations,
            tolerance,
        } = f;
        Self {
            residual: Some(residual.into()),
            field_strength_ut,
            field_low_ut: Some(field_low_ut),
            field_high_ut: Some(field_high_ut),
            max_direction_sigma_deg: Some(max_direction_sigma_deg),
            error_floor_ut: Some(error_floor_ut),
            max_residual_share: Some(max_residual_share),
            max_iterations: Some(count(max_iterations)),
            tolerance: Some(tolerance),
        }
    }
}

impl TryFrom<FitOptions> for magcomp::FitOptions {
    type Error = MagcompError;
    fn try_from(f: FitOptions) -> Result<Self, MagcompError> {
        let d = Self::default();
        let field_range_ut =
            (f.field_low_ut.unwrap_or(d.field_range_ut.0), f.field_high_ut.unwrap_or(d.field_range_ut.1));
        Ok(Self {
            residual: f.residual.map_or(d.residual, Into::into),
            field_strength_ut: f.field_strength_ut,
            field_range_ut,
            max_direction_sigma_deg: f.max_direction_sigma_deg.unwrap_or(d.max_direction_sigma_deg),
            error_floor_ut: f.error_floor_ut.unwrap_or(d.error_floor_ut),
            max_residual_share: f.max_residual_share.unwrap_or(d.max_residual_share),
            max_iterations: size("fit.max_iterations", f.max_iterations, d.max_iterations)?,
            tolerance: f.tolerance.unwrap_or(d.tolerance),
        })
    }
}

impl From<magcomp::WindowedConfig> for WindowedConfig {
    fn from(w: magcomp::WindowedConfig) -> Self {
        let magcomp::WindowedConfig { n_min, n_max, sigma_th, normalisation, refit_stride } = w;
        Self {
            n_min: Some(count(n_min)),
            n_max: Some(count(n_max)),
            sigma_th: Some(sigma_th),
            normalisation: Some(normalisation.into()),
            refit_stride: Some(count(refit_stride)),
        }
    }
}

impl TryFrom<WindowedConfig> for magcomp::WindowedConfig {
    type Error = MagcompError;
    fn try_from(w: WindowedConfig) -> Result<Self, MagcompError> {
        let d = Self::default();
        Ok(Self {
            n_min: size("windowed.n_min", w.n_min, d.n_min)?,
            n_max: size("windowed.n_max", w.n_max, d.n_max)?,
            sigma_th: w.sigma_th.unwrap_or(d.sigma_th),
            normalisation: w.normalisation.map_or(d.normalisation, Into::into),
            refit_stride: size("windowed.refit_stride", w.refit_stride, d.refit_stride)?,
        })
    }
}

/// The aided method's settings by name. As text, because the core's snapshots have brought its reader along anyway.
fn settings(config: &magcomp::AidedConfig) -> HashMap<String, f64> {
    serde_json::to_string(config).and_then(|text| serde_json::from_str(&text)).unwrap_or_default()
}

fn aided_config(given: &HashMap<String, f64>) -> Result<magcomp::AidedConfig, MagcompError> {
    let error = |name: &str, value: f64, expected: &str| MagcompError::Config {
        field: format!("aided.{name}"),
        value: value.to_string(),
        expected: expected.to_owned(),
    };
    let mut all = settings(&magcomp::AidedConfig::default());
    for (name, value) in given {
        if !value.is_finite() {
            return Err(error(name, *value, "a finite number"));
        }
        *all.get_mut(name).ok_or_else(|| error(name, *value, "the name of a setting"))? = *value;
    }
    let text = serde_json::to_string(&all);
    text.and_then(|text| serde_json::from_str(&text)).map_err(|e| error(&e.to_string(), 0.0, "settings"))
}

impl From<magcomp::PairingConfig> for PairingConfig {
    fn from(p: magcomp::PairingConfig) -> Self {
        let magcomp::PairingConfig { stale_s, max_rate_rad_s, max_up_m_s2, max_lead_s } = p;
        Self {
            stale_s: Some(stale_s),
            max_rate_rad_s: Some(max_rate_rad_s),
            max_up_m_s2: Some(max_up_m_s2),
            max_lead_s: Some(max_lead_s),
        }
    }
}

impl From<PairingConfig> for magcomp::PairingConfig {
    fn from(p: PairingConfig) -> Self {
        let d = Self::default();
        Self {
            stale_s: p.stale_s.unwrap_or(d.stale_s),
            max_rate_rad_s: p.max_rate_rad_s.unwrap_or(d.max_rate_rad_s),
            max_up_m_s2: p.max_up_m_s2.unwrap_or(d.max_up_m_s2),
            max_lead_s: p.max_lead_s.unwrap_or(d.max_lead_s),
        }
    }
}

impl From<magcomp::HeadingConfig> for HeadingConfig {
    fn from(h: magcomp::HeadingConfig) -> Self {
        let magcomp::HeadingConfig { axis, screen_rotation, declination_deg, tilt_sigma_deg, field_sigma_ut } = h;
        Self {
            axis: Some(axis.into()),
            screen_rotation: Some(screen_rotation.into()),
            declination_deg,
            tilt_sigma_deg: Some(tilt_sigma_deg),
            field_sigma_ut: Some(field_sigma_ut),
        }
    }
}

impl From<HeadingConfig> for magcomp::HeadingConfig {
    fn from(h: HeadingConfig) -> Self {
        let d = Self::default();
        Self {
            axis: h.axis.map_or(d.axis, Into::into),
            screen_rotation: h.screen_rotation.map_or(d.screen_rotation, Into::into),
            declination_deg: h.declination_deg,
            tilt_sigma_deg: h.tilt_sigma_deg.unwrap_or(d.tilt_sigma_deg),
            field_sigma_ut: h.field_sigma_ut.unwrap_or(d.field_sigma_ut),
        }
    }
}

same_names! {
    Method { Auto, Aided, Adaptive, Windowed, Constant }
    Residual { Algebraic, Corrected }
    Normalisation { HalfRange, EvenSphere }
    ReferenceAxis { TopEdge, Camera, Auto }
    ScreenRotation { Deg0, Deg90, Deg180, Deg270 }
}

fn size(field: &str, given: Option<i32>, default: usize) -> Result<usize, MagcompError> {
    let Some(n) = given else { return Ok(default) };
    usize::try_from(n).map_err(|_| MagcompError::Config {
        field: field.to_owned(),
        value: n.to_string(),
        expected: "0 or above".to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_defaults_come_back_as_they_went() {
        assert_eq!(magcomp::Config::try_from(default_config()), Ok(magcomp::Config::default()));
    }

    #[test]
    fn what_is_left_out_is_the_default() {
        let windowed =
            WindowedConfig { n_min: Some(50), n_max: None, sigma_th: None, normalisation: None, refit_stride: None };
        let config = Config {
            method: None,
            initial: None,
            use_reported_hard_iron: None,
            sensor: None,
            fit: None,
            windowed: Some(windowed),
            aided: Some(HashMap::from([("strength_ut".to_owned(), 50.0)])),
            pairing: None,
            heading: None,
        };
        let expected = magcomp::Config {
            windowed: magcomp::WindowedConfig { n_min: 50, ..Default::default() },
            aided: magcomp::AidedConfig { strength_ut: 50.0, ..Default::default() },
            ..Default::default()
        };
        assert_eq!(magcomp::Config::try_from(config), Ok(expected));
    }

    #[test]
    fn what_is_out_of_range_is_named() {
        let mut config = default_config();
        config.windowed.as_mut().unwrap().n_min = Some(-3);
        let expected = MagcompError::Config {
            field: "windowed.n_min".to_owned(),
            value: "-3".to_owned(),
            expected: "0 or above".to_owned(),
        };
        assert_eq!(magcomp::Config::try_from(config.clone()), Err(expected));
        config.windowed.as_mut().unwrap().n_min = Some(3);
        let error = magcomp::Config::try_from(config.clone()).unwrap_err();
        assert_eq!(error.to_string(), "config: windowed.n_min is 3, expected at least 9 samples");
        config.windowed = None;
        for (name, value) in [("no_such_setting", 1.0), ("strength_ut", f64::NAN), ("strength_ut", -1.0)] {
            config.aided = Some(HashMap::from([(name.to_owned(), value)]));
            let error = magcomp::Config::try_from(config.clone()).unwrap_err();
            assert!(error.to_string().starts_with(&format!("config: aided.{name} is {value}")), "{error}");
        }
    }
}
