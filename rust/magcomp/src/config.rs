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
    /// Largest component, uT, 1 to 100 000. Default 2000: phones carry offsets up to several hundred uT, and a magnetic cover can add
    /// a thousand. Larger accepts stronger magnets.
    pub range_ut: f64,
    /// The sensor's full scale, uT (Android: `Sensor.getMaximumRange`). A component at or beyond it is rejected as
    /// saturated. 1 to 100 000. Default none: not known.
    pub rail_ut: Option<f64>,
    /// So many equal samples in a row mean that the sensor hangs. Default 50, half a second at 100 Hz: the noise of every phone magnetometer
    /// changes the last digit sooner. 0 switches the check off. At most
    /// 1 000 000.
    pub stuck_samples: usize,
    /// Largest step ahead in time, s. Default 604800, a week: longer pauses than any app's, shorter than the
    /// jump of a time in the wrong unit. Pauses up to it are accepted. 0.001 to 2e10, which is
    /// more than there are nanoseconds in 64 bits.
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
    /// N_min, samples, 9 to N_max: the shortest window, and what sigma_T looks at. Default 100 (the paper's). Smaller follows changes sooner with more noise.
    pub n_min: usize,
    /// N_max, samples, at most 100 000 (32 bytes each): the longest window. Default 2000 (the paper's). Larger is steadier under poor motion and slower to forget.
    pub n_max: usize,
    /// sigma_th, dimensionless, 0 to 10: below it nothing is updated. Default 0.1. It stops updates at rest (not near azimuth
    /// 180), but not in all planar motion.
    pub sigma_th: f64,
    /// How the standard deviations in sigma_T are normalised. Default `HalfRange`, which comes closest to the transient in the paper's fig. 4.
    pub normalisation: Normalisation,
    /// Samples from one fit to the next, 1 to 100 000. Default 1 (the paper's). Larger costs less and follows in steps.
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
    /// Standard deviation of `up` at rest, degrees, 0 to 90, for `heading_sigma_deg`; what motion adds to gravity comes on top (little
    /// where a gyroscope carries `up`). Default 0.5: an accelerometer bias of 0.1 m/s^2, as phones have.
    pub tilt_sigma_deg: f64,
    /// What no calibration knows, uT per axis, 0 to 1000: the field of rooms is not uniform. Default 1.3, measured against
    /// optical orientation references in two laboratories; 0 for simulated data. The estimators and `Reading::field_sigma_ut`
    /// keep the value that the compensator was made with; one that is set later counts in `heading_sigma_deg` alone.
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

/// A check of a field against its range, both ends allowed; `none` passes where the field may be left out.
macro_rules! range {
    ($path:literal, $value:expr, $low:literal, $high:literal $(, $unit:literal)?) => {
        Check {
            ok: ($low..=$high).contains(&$value),
            field: $path,
            value: &$value,
            expected: concat!($low, " to ", $high $(, " ", $unit)?),
        }
    };
    ($path:literal, $value:expr, none, $low:literal, $high:literal, $unit:literal) => {
        Check {
            ok: $value.is_none_or(|value| ($low..=$high).contains(&value)),
            field: $path,
            value: &$value,
            expected: concat!($low, " to ", $high, " ", $unit, ", or none"),
        }
    };
}

impl Config {
    /// Whether every field is inside its range.
    ///
    /// # Errors
    /// [`ConfigError`] names the first field that is not, and its range.
    pub fn validate(&self) -> Result<(), ConfigError> {
        let (s, f, w, p) = (&self.sensor, &self.fit, &self.windowed, &self.pairing);
        let (low, high) = f.field_range_ut;
        first_failed(&[
            range!("sensor.range_ut", s.range_ut, 1.0, 100000.0, "uT"),
            range!("sensor.rail_ut", s.rail_ut, none, 1.0, 100000.0, "uT"),
            range!("sensor.stuck_samples", s.stuck_samples, 0, 1000000, "samples"),
            range!("sensor.max_gap_s", s.max_gap_s, 0.001, 2e10, "s"),
            range!("pairing.stale_s", p.stale_s, 0.001, 10.0, "s"),
            range!("pairing.max_rate_rad_s", p.max_rate_rad_s, 0.1, 100.0, "rad/s"),
            range!("pairing.max_up_m_s2", p.max_up_m_s2, 1.0, 1000.0, "m/s^2"),
            range!("pairing.max_lead_s", p.max_lead_s, 0.001, 3600.0, "s"),
            range!("fit.field_strength_ut", f.field_strength_ut, none, 1.0, 1000.0, "uT"),
            Check {
                ok: 1.0 <= low && low < high && high <= 1000.0,
                field: "fit.field_range_ut",
                value: &f.field_range_ut,
                expected: "1 <= low < high <= 1000 uT",
            },
            range!("fit.max_direction_sigma_deg", f.max_direction_sigma_deg, 0.001, 180.0, "deg"),
            range!("fit.error_floor_ut", f.error_floor_ut, 0.0, 1000.0, "uT"),
            range!("fit.max_residual_share", f.max_residual_share, 0.0001, 1000.0),
            range!("fit.max_iterations", f.max_iterations, 1, 1000),
            range!("fit.tolerance", f.tolerance, 1e-16, 0.1),
            range!("windowed.n_max", w.n_max, 9, 100000, "samples"),
            Check {
                ok: w.n_min >= SMALLEST_SAMPLE_COUNT,
                field: "windowed.n_min",
                value: &w.n_min,
                expected: "at least 9 samples",
            },
            Check {
                ok: w.n_min <= w.n_max,
                field: "windowed.n_min",
                value: &w.n_min,
                expected: "at most windowed.n_max",
            },
            range!("windowed.sigma_th", w.sigma_th, 0.0, 10.0),
            range!("windowed.refit_stride", w.refit_stride, 1, 100000, "samples"),
        ])?;
        self.heading.validate()?;
        self.aided.validate()?;
        self.adaptive.validate()
    }
}

impl HeadingConfig {
    /// Whether every field is inside its range.
    pub(crate) fn validate(&self) -> Result<(), ConfigError> {
        first_failed(&[
            range!("heading.declination_deg", self.declination_deg, none, -180.0, 180.0, "deg"),
            range!("heading.tilt_sigma_deg", self.tilt_sigma_deg, 0.0, 90.0, "deg"),
            range!("heading.field_sigma_ut", self.field_sigma_ut, 0.0, 1000.0, "uT"),
        ])
    }
}

/// Whether a field is inside its range, its path, its value, and the range.
struct Check<'a> {
    ok: bool,
    field: &'static str,
    value: &'a dyn std::fmt::Debug,
    expected: &'static str,
}

fn first_failed(checks: &[Check<'_>]) -> Result<(), ConfigError> {
    let Some(Check { field, value, expected, .. }) = checks.iter().find(|check| !check.ok) else { return Ok(()) };
    let value = format!("{value:?}");
    let value = value.strip_prefix("Some(").and_then(|v| v.strip_suffix(')')).unwrap_or(&value).to_owned();
    Err(ConfigError { field, value, expected })
}
