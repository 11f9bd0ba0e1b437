//! What can be chosen, checked once. Every field: unit, effect, default and where the default comes from.

use crate::calibration::Calibration;
use crate::ellipsoid::SMALLEST_SAMPLE_COUNT;
use crate::estimator::paper::WindowedConfig;
use crate::heading::HeadingConfig;
use crate::kept::SIGMAS_UT;
use crate::priors::DAYS_UT;
use crate::range::{ConfigError, in_range};
use alloc::{borrow::ToOwned, string::ToString};

/// How M and b are estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum Method {
    /// Gyroscope and gravity beside the magnetometer; `Adaptive` while there is no usable gyroscope. The default.
    #[default]
    Auto,
    /// The same as `Auto`.
    Aided,
    /// The magnetometer alone: a fit of everything since the latest change, changes noticed by themselves.
    Adaptive,
    /// The paper's: an ellipsoid fit over the latest N samples, N following sigma_T (fig. 3).
    Windowed,
    /// Its first step alone: one fit of the first well spread samples, then kept (section III).
    Constant,
}

/// Everything a [`crate::Compensator`] can be told: sixteen settings. `Config::default()` suits a phone; a setting is changed
/// on it, as the example there shows.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default, deny_unknown_fields)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct Config {
    /// How M and b are estimated. Default [`Method::Auto`].
    pub method: Method,
    /// A calibration to begin with, for instance that of the last launch. Default none.
    pub initial: Option<Calibration>,
    /// One standard deviation of each component of `initial`'s hard iron, uT, 0.01 to 1000. Default 2: a phone that was
    /// calibrated the day before. Larger makes the first headings less sure, and learning faster. The windowed methods, which
    /// have no prior, do not listen to it.
    pub initial_sigma_ut: f64,
    /// Largest component of a raw sample, uT, 1 to 100 000; a larger one is rejected. Default 2000: phones carry offsets up to several
    /// hundred uT, and a magnetic cover can add a thousand. Larger accepts stronger magnets.
    pub range_ut: f64,
    /// The magnetometer's full scale, uT (Android: `Sensor.getMaximumRange`). A component at or beyond it is rejected as
    /// saturated. 1 to 100 000. Default none: it is found once an axis has read the same extreme again and again in motion.
    pub rail_ut: Option<f64>,
    /// |h| in uT, 1 to 1000, where it is known, as [`crate::FitOptions::field_strength_ut`]. Every method listens to it. None (the
    /// default): the strength is found, and M has a gauge of its own, det M = 1; for the aided method tr M = 3.
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
            initial_sigma_ut: DAYS_UT,
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
        let w = &self.windowed;
        in_range("initial_sigma_ut", self.initial_sigma_ut, SIGMAS_UT, "uT")?;
        in_range("range_ut", self.range_ut, 1.0..=100_000.0, "uT")?;
        in_range("rail_ut", self.rail_ut, 1.0..=100_000.0, "uT, or none")?;
        in_range("field_strength_ut", self.field_strength_ut, 1.0..=1000.0, "uT, or none")?;
        in_range("windowed.n_max", w.n_max, SMALLEST_SAMPLE_COUNT..=100_000, "samples")?;
        if !(SMALLEST_SAMPLE_COUNT..=w.n_max).contains(&w.n_min) {
            let is_small = w.n_min < SMALLEST_SAMPLE_COUNT;
            let expected = if is_small { "at least 9 samples" } else { "at most windowed.n_max" }.to_owned();
            return Err(ConfigError { field: "windowed.n_min", value: w.n_min.to_string(), expected });
        }
        in_range("windowed.sigma_th", w.sigma_th, 0.0..=10.0, "")?;
        in_range("windowed.noise_floor_ut", w.noise_floor_ut, 0.0..=1000.0, "uT")?;
        validate_heading(&self.heading)
    }
}

/// Whether every field of the heading's is inside its range.
pub(crate) fn validate_heading(heading: &HeadingConfig) -> Result<(), ConfigError> {
    in_range("heading.declination_deg", heading.declination_deg, -180.0..=180.0, "deg, or none")?;
    in_range("heading.tilt_sigma_deg", heading.tilt_sigma_deg, 0.0..=90.0, "deg")
}
