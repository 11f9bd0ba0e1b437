//! The config's conversions: what was left out becomes the core's default, and what is out of range an error.

use super::{Config, FitOptions, HeadingConfig, Method, Normalisation, Residual, WindowedConfig};
use crate::convert::{count, same_names};
use crate::error::MagcompError;
use crate::record::ReferenceAxis;

/// What a screen shows: it does not flip when the phone is raised.
const USUAL_AXIS: ReferenceAxis = ReferenceAxis::Auto;

impl TryFrom<Config> for magcomp::Config {
    type Error = MagcompError;
    fn try_from(c: Config) -> Result<Self, MagcompError> {
        let Config {
            method,
            initial,
            initial_sigma_ut,
            use_reported_hard_iron: _,
            range_ut,
            rail_ut,
            field_strength_ut,
            heading,
            windowed,
        } = c;
        let d = Self::default();
        let config = Self {
            method: method.map_or(d.method, Into::into),
            initial: initial.map(TryInto::try_into).transpose()?,
            initial_sigma_ut: initial_sigma_ut.unwrap_or(d.initial_sigma_ut),
            range_ut: range_ut.unwrap_or(d.range_ut),
            rail_ut,
            field_strength_ut,
            heading: heading.unwrap_or_default().into(),
            windowed: windowed.map_or(Ok(d.windowed), TryInto::try_into)?,
        };
        config.validate()?;
        Ok(config)
    }
}

impl From<magcomp::FitOptions> for FitOptions {
    fn from(f: magcomp::FitOptions) -> Self {
        let magcomp::FitOptions {
            residual,
            field_strength_ut,
            field_range_ut: (field_low_ut, field_high_ut),
            max_direction_sigma_deg,
            noise_floor_ut,
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
            noise_floor_ut: Some(noise_floor_ut),
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
            noise_floor_ut: f.noise_floor_ut.unwrap_or(d.noise_floor_ut),
            max_residual_share: f.max_residual_share.unwrap_or(d.max_residual_share),
            max_iterations: size("fit.max_iterations", f.max_iterations, d.max_iterations)?,
            tolerance: f.tolerance.unwrap_or(d.tolerance),
        })
    }
}

impl From<magcomp::WindowedConfig> for WindowedConfig {
    fn from(w: magcomp::WindowedConfig) -> Self {
        let magcomp::WindowedConfig { n_min, n_max, sigma_th, normalisation, residual, noise_floor_ut } = w;
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
    fn try_from(w: WindowedConfig) -> Result<Self, MagcompError> {
        let d = Self::default();
        Ok(Self {
            n_min: size("windowed.n_min", w.n_min, d.n_min)?,
            n_max: size("windowed.n_max", w.n_max, d.n_max)?,
            sigma_th: w.sigma_th.unwrap_or(d.sigma_th),
            normalisation: w.normalisation.map_or(d.normalisation, Into::into),
            residual: w.residual.map_or(d.residual, Into::into),
            noise_floor_ut: w.noise_floor_ut.unwrap_or(d.noise_floor_ut),
        })
    }
}

impl From<magcomp::HeadingConfig> for HeadingConfig {
    fn from(h: magcomp::HeadingConfig) -> Self {
        let magcomp::HeadingConfig { axis, screen_rotation, declination_deg, tilt_sigma_deg } = h;
        Self {
            axis: Some(axis.into()),
            screen_rotation: Some(screen_rotation.into()),
            declination_deg,
            tilt_sigma_deg: Some(tilt_sigma_deg),
        }
    }
}

impl Default for HeadingConfig {
    fn default() -> Self {
        Self { axis: Some(USUAL_AXIS), ..magcomp::HeadingConfig::default().into() }
    }
}

impl From<HeadingConfig> for magcomp::HeadingConfig {
    fn from(h: HeadingConfig) -> Self {
        let d = Self::default();
        Self {
            axis: h.axis.unwrap_or(USUAL_AXIS).into(),
            screen_rotation: h.screen_rotation.map_or(d.screen_rotation, Into::into),
            declination_deg: h.declination_deg,
            tilt_sigma_deg: h.tilt_sigma_deg.unwrap_or(d.tilt_sigma_deg),
        }
    }
}

same_names! {
    Method { Auto, Aided, Adaptive, Windowed, Constant }
    Residual { Algebraic, Corrected }
    Normalisation { HalfRange, EvenSphere }
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
    use crate::config::default_config;

    /// The core's defaults with a phone's axis.
    fn phone() -> magcomp::Config {
        let heading = magcomp::HeadingConfig { axis: magcomp::ReferenceAxis::Auto, ..Default::default() };
        magcomp::Config { heading, ..Default::default() }
    }

    #[test]
    fn the_defaults_come_back_as_they_went() {
        assert_eq!(magcomp::Config::try_from(default_config()), Ok(phone()));
    }

    #[test]
    fn what_is_left_out_is_the_default() {
        let windowed = WindowedConfig {
            n_min: Some(50),
            n_max: None,
            sigma_th: None,
            normalisation: None,
            residual: None,
            noise_floor_ut: None,
        };
        let config = Config {
            method: None,
            initial: None,
            initial_sigma_ut: None,
            use_reported_hard_iron: None,
            range_ut: None,
            rail_ut: None,
            field_strength_ut: Some(48.0),
            heading: None,
            windowed: Some(windowed),
        };
        let expected = magcomp::Config {
            field_strength_ut: Some(48.0),
            windowed: magcomp::WindowedConfig { n_min: 50, ..Default::default() },
            ..phone()
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
    }
}
