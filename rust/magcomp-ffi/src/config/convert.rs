//! The config's conversions: what was left out becomes the core's default, and what is out of range an error.

use super::{
    Config, FitOptions, HeadingConfig, Method, Normalisation, PairingConfig, ReferenceAxis, Residual, ScreenRotation,
    SensorLimits, WindowedConfig,
};
use crate::error::MagcompError;
use crate::record::{count, same_names};
use std::collections::HashMap;

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
            adaptive: adaptive_noise_ut.map_or(d.adaptive, |noise_ut| magcomp::AdaptiveConfig { noise_ut }),
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

fn aided_config(given: &HashMap<String, f64>) -> Result<magcomp::AidedConfig, MagcompError> {
    let mut config = magcomp::AidedConfig::default();
    for (name, &value) in given {
        if !config.set(name, value) {
            return Err(MagcompError::Config {
                field: format!("aided.{name}"),
                value: value.to_string(),
                expected: "the name of a setting".to_owned(),
            });
        }
    }
    Ok(config)
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
    use crate::config::default_config;

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
            adaptive_noise_ut: Some(0.7),
            pairing: None,
            heading: None,
        };
        let expected = magcomp::Config {
            windowed: magcomp::WindowedConfig { n_min: 50, ..Default::default() },
            aided: magcomp::AidedConfig { strength_ut: 50.0, ..Default::default() },
            adaptive: magcomp::AdaptiveConfig { noise_ut: 0.7 },
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
