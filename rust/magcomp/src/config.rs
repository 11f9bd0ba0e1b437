// made by bindings/generate.sh from bindings/config.toml
//! What can be chosen, checked once.

use crate::calibration::Calibration;
use crate::range::{ConfigError, in_range};
use alloc::{borrow::ToOwned, string::ToString};

/// How the hard and soft iron are estimated. The default is `Auto`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum Method {
    /// Gyroscope and gravity beside the magnetometer; works as `Adaptive` while there is no usable gyroscope.
    #[default]
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

/// The axis of the device whose heading is reported. The default is `TopEdge`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum ReferenceAxis {
    /// Top edge of the screen, +y.
    #[default]
    TopEdge,
    /// Back camera, -z.
    Camera,
    /// The horizontal direction between top edge and camera: no flip when the phone passes upright.
    Auto,
}

/// How the screen's content is turned against the device's natural orientation, as Android's `Display.getRotation`. The default is `Deg0`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum ScreenRotation {
    /// Natural orientation: portrait on phones.
    #[default]
    Deg0,
    /// Landscape, the device turned counter-clockwise: the screen's top is the device's right edge.
    Deg90,
    /// Upside down.
    Deg180,
    /// The other landscape: the screen's top is the device's left edge.
    Deg270,
}

/// The residual that a fit squares and sums. The default is `Corrected`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Residual {
    /// Eq. (10) of the paper as written. Biased in scale by about 3 nu^2 (nu: noise over field strength), and in everything when the sphere is only partly covered.
    Algebraic,
    /// Divided by its own gradient: a distance in raw units, free of the noise bias.
    #[default]
    Corrected,
}

/// How the standard deviations in sigma_T, eq. (15), are normalised. The default is `HalfRange`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Normalisation {
    /// By half the range of each axis, 180 and 90 degrees: even orientations give 0.723, and so N = 626 of 100 to 2000.
    #[default]
    HalfRange,
    /// By sqrt(2) times the standard deviation of evenly spread directions, which so give 1.
    EvenSphere,
}

/// All settings of a compensator. A setting left out has its default.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct Config {
    /// How the hard and soft iron are estimated. Default `Auto`.
    pub method: Method,
    /// A calibration to begin with, from elsewhere; that of the last launch is for `adopt_kept`. Default none.
    pub initial: Option<Calibration>,
    /// One standard deviation of each component of `initial`'s hard iron, microtesla, 0.01 to 1000. Default 2; larger makes the first headings less sure, and learning faster. Why: a phone that was calibrated the day before. The windowed methods, which have no prior, do not listen to it.
    pub initial_sigma_ut: f64,
    /// Largest component of a raw sample, microtesla, 1 to 100 000; a larger one is rejected. Default 2000; larger accepts stronger magnets. Why: phones carry offsets up to several hundred microtesla, and a magnetic cover can add a thousand.
    pub range_ut: f64,
    /// The magnetometer's full scale, microtesla (Android: `Sensor.getMaximumRange`). A component at or beyond it is rejected as saturated. 1 to 100 000. Default none: it is found once an axis has read the same extreme again and again in motion.
    pub rail_ut: Option<f64>,
    /// The field's strength, microtesla, 1 to 1000, where it is known (the geomagnetic model gives it): then the soft iron carries the sensor's scale. Every method listens to it. Default none: found by the method. Why: M then has a gauge of its own, det M = 1; for the aided method tr M = 3.
    pub field_strength_ut: Option<f64>,
    /// How headings are reported.
    pub heading: HeadingConfig,
    /// The paper's method.
    pub windowed: WindowedConfig,
}

impl Default for Config {
    fn default() -> Self {
        Self {
            method: Method::Auto,
            initial: None,
            initial_sigma_ut: 2.0,
            range_ut: 2000.0,
            rail_ut: None,
            field_strength_ut: None,
            heading: HeadingConfig::default(),
            windowed: WindowedConfig::default(),
        }
    }
}

impl Config {
    /// Whether every field is inside its range.
    ///
    /// # Errors
    /// [`ConfigError`] names the first field that is not, and its range.
    pub fn validate(&self) -> Result<(), ConfigError> {
        in_range("initial_sigma_ut", self.initial_sigma_ut, 0.01..=1000.0, "uT")?;
        in_range("range_ut", self.range_ut, 1.0..=100000.0, "uT")?;
        in_range("rail_ut", self.rail_ut, 1.0..=100000.0, "uT, or none")?;
        in_range("field_strength_ut", self.field_strength_ut, 1.0..=1000.0, "uT, or none")?;
        self.heading.validate()?;
        self.windowed.validate()?;
        Ok(())
    }
}

/// How headings are reported. A field left out is the default.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct HeadingConfig {
    /// The axis whose heading it is. Default `TopEdge`.
    pub axis: ReferenceAxis,
    /// How the screen's content is turned against the device. Default `Deg0`, not at all.
    pub screen_rotation: ScreenRotation,
    /// Declination, degrees, east positive, -180 to 180: gives `true_heading_deg`. Default none.
    pub declination_deg: Option<f64>,
    /// Standard deviation of `up` at rest, degrees, 0 to 90, for `heading_sigma_deg`; what motion adds to gravity comes on top. Default 0.5. Why: an accelerometer bias of 0.1 m/s^2, as phones have. Motion adds little where a gyroscope carries `up`.
    pub tilt_sigma_deg: f64,
}

impl Default for HeadingConfig {
    fn default() -> Self {
        Self {
            axis: ReferenceAxis::TopEdge,
            screen_rotation: ScreenRotation::Deg0,
            declination_deg: None,
            tilt_sigma_deg: 0.5,
        }
    }
}

impl HeadingConfig {
    /// Whether every field is inside its range.
    ///
    /// # Errors
    /// [`ConfigError`] names the first field that is not, and its range.
    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        in_range("heading.declination_deg", self.declination_deg, -180.0..=180.0, "deg, or none")?;
        in_range("heading.tilt_sigma_deg", self.tilt_sigma_deg, 0.0..=90.0, "deg")?;
        Ok(())
    }
}

/// The paper's method (section IV, fig. 3). A field left out is the default.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct WindowedConfig {
    /// N_min, samples, 9 to N_max: the shortest window, and what sigma_T looks at. Default 100; smaller follows changes sooner with more noise. Why: the paper's.
    pub n_min: usize,
    /// N_max, samples, at most 100 000: the longest window. Default 2000; larger is steadier under poor motion and slower to forget. Why: the paper's. A sample takes 24 bytes.
    pub n_max: usize,
    /// sigma_th, dimensionless, 0 to 10: below it nothing is updated. Default 0.1. Why: it stops updates at rest (not near azimuth 180), but not in all planar motion.
    pub sigma_th: f64,
    /// How the standard deviations in sigma_T are normalised. Default `HalfRange`. Why: it comes closest to the transient of about 700 samples in the paper's fig. 4.
    pub normalisation: Normalisation,
    /// The residual that fits square and sum. Default `Corrected`. `Algebraic` follows the paper as written: a window is fitted however far its samples lie from one ellipsoid.
    pub residual: Residual,
    /// Least white noise, microtesla per axis, 0 to 1000, for which a fit is judged. Default 5; smaller accepts poorer coverage where the residual is small. Why: that of `FitOptions`.
    pub noise_floor_ut: f64,
}

impl Default for WindowedConfig {
    fn default() -> Self {
        Self {
            n_min: 100,
            n_max: 2000,
            sigma_th: 0.1,
            normalisation: Normalisation::HalfRange,
            residual: Residual::Corrected,
            noise_floor_ut: 5.0,
        }
    }
}

impl WindowedConfig {
    /// Whether every field is inside its range.
    ///
    /// # Errors
    /// [`ConfigError`] names the first field that is not, and its range.
    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        in_range("windowed.n_max", self.n_max, 9..=100000, "samples")?;
        in_range("windowed.sigma_th", self.sigma_th, 0.0..=10.0, "")?;
        in_range("windowed.noise_floor_ut", self.noise_floor_ut, 0.0..=1000.0, "uT")?;
        if !(9..=self.n_max).contains(&self.n_min) {
            let is_small = self.n_min < 9;
            let expected = if is_small { "at least 9 samples" } else { "at most windowed.n_max" }.to_owned();
            return Err(ConfigError { field: "windowed.n_min", value: self.n_min.to_string(), expected });
        }
        Ok(())
    }
}
