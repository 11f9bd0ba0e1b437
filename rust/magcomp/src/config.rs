//! What can be chosen, checked once. Every field: unit, effect, default and where the default comes from.

use crate::calibration::Calibration;
use crate::ellipsoid::{FitOptions, SMALLEST_SAMPLE_COUNT};
use crate::estimator::adaptive::AdaptiveConfig;
use crate::estimator::aided::AidedConfig;
use crate::heading::{ReferenceAxis, ScreenRotation};
use crate::pairing::PairingConfig;
use crate::uniformity::Normalisation;
use serde::{Deserialize, Serialize};

/// How M and b are estimated.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Method {
    /// `Aided` while rotation rates arrive, else `Adaptive`. The default.
    #[default]
    Auto,
    /// Gyroscope and gravity beside the magnetometer, whether or not they arrive.
    Aided,
    /// The magnetometer alone: a fit of everything since the latest change, changes noticed by themselves.
    Adaptive,
    /// The paper's: an ellipsoid fit over the latest N samples, N following sigma_T (fig. 3).
    Windowed,
    /// Its first step alone: one fit of the first well spread samples, then kept (section III).
    Constant,
}

/// Everything a [`crate::Compensator`] can be told. `Config::default()` suits a phone.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// How M and b are estimated. Default [`Method::Auto`].
    pub method: Method,
    /// A calibration to begin with, for instance that of the last launch. Default none.
    pub initial: Option<Calibration>,
    /// What a raw sample may be.
    pub sensor: SensorLimits,
    /// What an ellipsoid fit accepts.
    pub fit: FitOptions,
    /// The method with gyroscope and gravity.
    pub aided: AidedConfig,
    /// The method with the magnetometer alone.
    pub adaptive: AdaptiveConfig,
    /// How events of several sensors are brought together.
    pub pairing: PairingConfig,
    /// The paper's method.
    pub windowed: WindowedConfig,
    /// How headings are reported.
    pub heading: HeadingConfig,
}

/// What a raw sample may be; anything else is rejected with a reason.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SensorLimits {
    /// Largest component, uT. Default 2000: phones carry offsets up to several hundred uT, and a magnetic cover can add
    /// a thousand. Larger accepts stronger magnets.
    pub range_ut: f64,
    /// The sensor's full scale, uT (Android: `Sensor.getMaximumRange`). A component at or beyond it is rejected as
    /// saturated. Default none: not known.
    pub rail_ut: Option<f64>,
    /// So many equal samples in a row mean that the sensor hangs. Default 50, half a second at 100 Hz: the noise of every phone magnetometer
    /// changes the last digit sooner. 0 switches the check off.
    pub stuck_samples: usize,
    /// Largest step ahead in time, s. Default 604800, a week: longer pauses than any app's, shorter than the
    /// jump of a time in the wrong unit. Pauses up to it are accepted.
    pub max_gap_s: f64,
}

impl Default for SensorLimits {
    fn default() -> Self {
        Self { range_ut: 2000.0, rail_ut: None, stuck_samples: 50, max_gap_s: 604_800.0 }
    }
}

/// The paper's method (section IV, fig. 3).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct WindowedConfig {
    /// N_min, samples: the shortest window, and what sigma_T looks at. Default 100 (the paper's). Smaller follows changes sooner with more noise.
    pub n_min: usize,
    /// N_max, samples: the longest window. Default 2000 (the paper's). Larger is steadier under poor motion and slower to forget.
    pub n_max: usize,
    /// sigma_th, dimensionless: below it nothing is updated. Default 0.1. It stops updates at rest (not near azimuth 180), but not in all planar motion.
    pub sigma_th: f64,
    /// How the standard deviations in sigma_T are normalised. Default `HalfRange`, which comes closest to the transient in the paper's fig. 4.
    pub normalisation: Normalisation,
    /// Samples from one fit to the next. Default 1 (the paper's). Larger costs less and follows in steps.
    pub refit_stride: usize,
}

impl Default for WindowedConfig {
    fn default() -> Self {
        Self { n_min: 100, n_max: 2000, sigma_th: 0.1, normalisation: Normalisation::HalfRange, refit_stride: 1 }
    }
}

/// How headings are reported.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct HeadingConfig {
    /// The axis whose heading it is. Default the top edge.
    pub axis: ReferenceAxis,
    /// How the screen's content is turned. Default not at all.
    pub screen_rotation: ScreenRotation,
    /// Declination, degrees, east positive, -180 to 180: gives `true_heading_deg`. Default none.
    pub declination_deg: Option<f64>,
    /// Standard deviation of `up` at rest, degrees, for `heading_sigma_deg`; what motion adds to gravity comes on top (little
    /// where a gyroscope carries `up`). Default 0.5: an accelerometer bias of 0.1 m/s^2, as phones have.
    pub tilt_sigma_deg: f64,
    /// What no calibration knows, uT per axis: the field of rooms is not uniform. Default 1.3, measured against optical
    /// orientation references in two laboratories; 0 for simulated data.
    pub field_sigma_ut: f64,
}

impl Default for HeadingConfig {
    fn default() -> Self {
        Self {
            axis: ReferenceAxis::TopEdge,
            screen_rotation: ScreenRotation::Deg0,
            declination_deg: None,

            tilt_sigma_deg: 0.5,
            field_sigma_ut: 1.3,
        }
    }
}

/// A field of the config is outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("config: {field} is {value}, expected {expected}")]
pub struct ConfigError {
    /// Path of the field, for instance `windowed.n_min`.
    pub field: &'static str,
    /// What it was.
    pub value: String,
    /// What it may be.
    pub expected: &'static str,
}

/// Longest window: the ring holds so many samples, 32 bytes each.
const LARGEST_WINDOW: usize = 100_000;

impl Config {
    /// Whether every field is inside its range.
    ///
    /// # Errors
    /// [`ConfigError`] names the first field that is not, and its range.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let (s, f, w) = (&self.sensor, &self.fit, &self.windowed);
        let checks: [Check<'_>; 19] = [
            (positive(s.range_ut), "sensor.range_ut", &s.range_ut, "above 0 uT"),
            (s.rail_ut.is_none_or(positive), "sensor.rail_ut", &s.rail_ut, "above 0 uT, or none"),
            (positive(self.pairing.stale_s), "pairing.stale_s", &self.pairing.stale_s, "above 0 s"),
            (
                positive(self.pairing.max_rate_rad_s),
                "pairing.max_rate_rad_s",
                &self.pairing.max_rate_rad_s,
                "above 0 rad/s",
            ),
            (positive(self.pairing.max_up_m_s2), "pairing.max_up_m_s2", &self.pairing.max_up_m_s2, "above 0 m/s^2"),
            (positive(self.pairing.max_lead_s), "pairing.max_lead_s", &self.pairing.max_lead_s, "above 0 s"),
            (positive(s.max_gap_s), "sensor.max_gap_s", &s.max_gap_s, "above 0 s"),
            (
                f.field_strength_ut.is_none_or(positive),
                "fit.field_strength_ut",
                &f.field_strength_ut,
                "above 0 uT, or none",
            ),
            (
                positive(f.field_range_ut.0)
                    && f.field_range_ut.1 > f.field_range_ut.0
                    && f.field_range_ut.1.is_finite(),
                "fit.field_range_ut",
                &f.field_range_ut,
                "0 < low < high, uT",
            ),
            (
                positive(f.max_direction_sigma_deg),
                "fit.max_direction_sigma_deg",
                &f.max_direction_sigma_deg,
                "above 0 deg",
            ),
            (not_negative(f.error_floor_ut), "fit.error_floor_ut", &f.error_floor_ut, "0 uT or above"),
            (positive(f.max_residual_share), "fit.max_residual_share", &f.max_residual_share, "above 0"),
            (f.max_iterations >= 1, "fit.max_iterations", &f.max_iterations, "at least 1"),
            (positive(f.tolerance), "fit.tolerance", &f.tolerance, "above 0"),
            (w.n_min >= SMALLEST_SAMPLE_COUNT, "windowed.n_min", &w.n_min, "at least 9 samples"),
            (w.n_max >= w.n_min, "windowed.n_max", &w.n_max, "at least windowed.n_min"),
            (w.n_max <= LARGEST_WINDOW, "windowed.n_max", &w.n_max, "at most 100000 samples"),
            (not_negative(w.sigma_th), "windowed.sigma_th", &w.sigma_th, "0 or above"),
            (w.refit_stride >= 1, "windowed.refit_stride", &w.refit_stride, "at least 1"),
        ];
        first_failed(&checks)?;
        self.heading.validate()?;
        self.aided.validate()?;
        self.adaptive.validate()
    }
}

impl HeadingConfig {
    /// Whether every field is inside its range.
    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        let h = self;
        first_failed(&[
            (
                h.declination_deg.is_none_or(|d| (-180.0..=180.0).contains(&d)),
                "heading.declination_deg",
                &h.declination_deg,
                "-180 to 180 deg, or none",
            ),
            (not_negative(h.tilt_sigma_deg), "heading.tilt_sigma_deg", &h.tilt_sigma_deg, "0 deg or above"),
            (not_negative(h.field_sigma_ut), "heading.field_sigma_ut", &h.field_sigma_ut, "0 uT or above"),
        ])
    }
}

/// Whether it holds, the field's path, its value, and what it may be.
type Check<'a> = (bool, &'static str, &'a dyn std::fmt::Debug, &'static str);

fn positive(v: f64) -> bool {
    v > 0.0 && v.is_finite()
}

fn not_negative(v: f64) -> bool {
    v >= 0.0 && v.is_finite()
}

fn first_failed(checks: &[Check<'_>]) -> Result<(), ConfigError> {
    let Some((_, field, value, expected)) = checks.iter().find(|(ok, ..)| !ok) else { return Ok(()) };
    let value = format!("{value:?}");
    let value = value.strip_prefix("Some(").and_then(|v| v.strip_suffix(')')).unwrap_or(&value).to_owned();
    Err(ConfigError { field, value, expected })
}
