//! A calibration as it is kept from one launch to the next, with what is known of it, as JSON:
//!
//! ```json
//! {"magcomp_calibration": 1, "source": "learned", "unix_time_s": 1795560000, "inclination_deg": 64.8,
//!  "soft_iron": [1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0], "hard_iron_ut": [120.0, -80.0, 300.0], "field_strength_ut": 48.0,
//!  "covariance": [[9 numbers], ... 9 rows]}
//! ```
//!
//! `soft_iron` is M (symmetric, so by rows or columns), dimensionless; `covariance` has the order b_x b_y b_z (uT) m_xx m_yy m_zz m_xy m_xz m_yz
//! (dimensionless). `unix_time_s` and `inclination_deg` may be missing or null: not known. Fields that are not named here are passed
//! over. A change of form that an older library would misread gets another version number.

#[cfg(test)]
mod tests;

use crate::calibration::{Calibration, independent, is_covariance};
use crate::priors::{IRON_PER_UT, UNSEEN_IRON};
use crate::range::{ConfigError, in_range};
use alloc::{borrow::ToOwned, string::String, string::ToString};
use core::ops::RangeInclusive;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::SMatrix;

/// Format: version of the text written here.
pub const KEPT_VERSION: u32 = 1;

/// Limit: what a standard deviation of a component of b may be, uT.
pub(crate) const SIGMAS_UT: RangeInclusive<f64> = 0.01..=1000.0;

/// Where a calibration came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum CalibrationSource {
    /// A compensator learned it from live samples.
    Learned,
    /// The operating system reports it.
    System,
    /// Somebody gave it.
    Given,
}

/// A calibration with what is known of it: covariance, source and date.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KeptCalibration {
    calibration: Calibration,
    covariance: SMatrix<f64, 9, 9>,
    source: CalibrationSource,
    inclination_deg: Option<f64>,
    unix_time_s: Option<i64>,
}

/// Why a text is no calibration that can be used. Nothing has changed.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum KeptError {
    /// Cut, changed by hand to something impossible, or no such text at all.
    #[error("kept calibration is damaged ({why}); start without it")]
    Damaged {
        /// The first thing that is wrong.
        why: String,
    },
    /// Written by a newer version.
    #[error(
        "kept calibration has version {found}, this library reads up to {KEPT_VERSION}; update it or start without"
    )]
    Newer {
        /// Format: version of the text.
        found: u32,
    },
}

/// The text.
#[derive(serde::Serialize, serde::Deserialize)]
struct Text {
    magcomp_calibration: u32,
    source: CalibrationSource,
    unix_time_s: Option<i64>,
    inclination_deg: Option<f64>,
    #[serde(flatten)]
    calibration: Calibration,
    covariance: [[f64; 9]; 9],
}

/// All that is read of a newer version.
#[derive(serde::Deserialize)]
struct Version {
    magcomp_calibration: u32,
}

impl KeptCalibration {
    /// What a compensator has learned. `None` where the covariance is none.
    pub(crate) fn learned(
        calibration: Calibration,
        covariance: SMatrix<f64, 9, 9>,
        inclination_deg: Option<f64>,
        unix_time_s: i64,
    ) -> Option<Self> {
        let (covariance, source) = (covariance.symmetric_part(), CalibrationSource::Learned);
        let it = Self { calibration, covariance, source, inclination_deg, unix_time_s: Some(unix_time_s) };
        (is_covariance(&covariance) && leaves_doubt(&covariance)).then_some(it)
    }

    /// A calibration from elsewhere, whose hard iron errs by `hard_iron_sigma_ut` (one standard deviation of each component, uT, 0.01
    /// to 1000) and whose soft iron by as much as usually goes with that: 0.3 % of M for each uT, 8 % at most.
    ///
    /// # Errors
    /// [`ConfigError`] when `hard_iron_sigma_ut` is out of range.
    pub fn given(calibration: Calibration, hard_iron_sigma_ut: f64) -> Result<Self, ConfigError> {
        let iron = (IRON_PER_UT * hard_iron_sigma_ut).min(UNSEEN_IRON);
        Self::from_elsewhere(calibration, hard_iron_sigma_ut, iron, CalibrationSource::Given)
    }

    /// The operating system's hard iron, which says nothing of M.
    ///
    /// # Errors
    /// [`ConfigError`] when `hard_iron_sigma_ut` is out of range.
    pub fn system(calibration: Calibration, hard_iron_sigma_ut: f64) -> Result<Self, ConfigError> {
        Self::from_elsewhere(calibration, hard_iron_sigma_ut, UNSEEN_IRON, CalibrationSource::System)
    }

    fn from_elsewhere(
        calibration: Calibration,
        sigma_ut: f64,
        iron: f64,
        source: CalibrationSource,
    ) -> Result<Self, ConfigError> {
        in_range("hard_iron_sigma_ut", sigma_ut, SIGMAS_UT, "uT")?;
        let covariance = independent(sigma_ut.powi(2), iron.powi(2));
        Ok(Self { calibration, covariance, source, inclination_deg: None, unix_time_s: None })
    }

    /// M, b and the strength of the field they were found in.
    #[must_use]
    pub fn calibration(&self) -> &Calibration {
        &self.calibration
    }

    /// Covariance in the order b_x b_y b_z (uT) m_xx m_yy m_zz m_xy m_xz m_yz (dimensionless).
    #[must_use]
    pub fn covariance(&self) -> &SMatrix<f64, 9, 9> {
        &self.covariance
    }

    /// Where it came from.
    #[must_use]
    pub fn source(&self) -> CalibrationSource {
        self.source
    }

    /// Dip of the field it was found in, degrees, positive downwards; `None`: not known.
    #[must_use]
    pub fn inclination_deg(&self) -> Option<f64> {
        self.inclination_deg
    }

    /// When it was kept, seconds since 1970 (UTC) by the caller's clock; `None`: not known.
    #[must_use]
    pub fn unix_time_s(&self) -> Option<i64> {
        self.unix_time_s
    }

    /// The text, one line.
    #[must_use]
    pub fn to_json(&self) -> String {
        let Self { calibration, covariance, source, inclination_deg, unix_time_s } = *self;
        let (magcomp_calibration, covariance) = (KEPT_VERSION, covariance.into());
        let text = Text { magcomp_calibration, source, unix_time_s, inclination_deg, calibration, covariance };
        serde_json::to_string(&text).expect("finite numbers under names")
    }

    /// Reads a text.
    ///
    /// # Errors
    /// [`KeptError`] when it is damaged or from a newer version.
    pub fn from_json(text: &str) -> Result<Self, KeptError> {
        let damaged = |error: serde_json::Error| KeptError::Damaged { why: error.to_string() };
        let Version { magcomp_calibration: found } = serde_json::from_str(text).map_err(damaged)?;
        if found > KEPT_VERSION {
            return Err(KeptError::Newer { found });
        }
        let Text { source, unix_time_s, inclination_deg, calibration, covariance, .. } =
            serde_json::from_str(text).map_err(damaged)?;
        let wrong = |why: &str| KeptError::Damaged { why: why.to_owned() };
        if found == 0 {
            return Err(wrong("there is no version 0"));
        }
        let covariance = SMatrix::<f64, 9, 9>::from(covariance);
        if !is_covariance(&covariance) {
            return Err(wrong("covariance is not symmetric and positive semi-definite"));
        }
        if !leaves_doubt(&covariance) {
            return Err(wrong("covariance says that the hard iron is exactly known"));
        }
        if inclination_deg.is_some_and(|dip| !(-90.0..=90.0).contains(&dip)) {
            return Err(wrong("inclination_deg is not -90 to 90"));
        }
        Ok(Self { calibration, covariance: covariance.symmetric_part(), source, inclination_deg, unix_time_s })
    }
}

/// No component of b is exactly known: no sample would ever move it.
fn leaves_doubt(covariance: &SMatrix<f64, 9, 9>) -> bool {
    (0..3).all(|i| covariance[(i, i)] > 0.0)
}
