//! The config as it crosses the border: every field may be left out, and then is the core's default.

// made, for people to read and not to edit
#[rustfmt::skip]
mod records;

pub use records::{Config, FitOptions, HeadingConfig, WindowedConfig};

/// The library's defaults, every field given.
#[uniffi::export]
pub fn default_config() -> Config {
    magcomp::Config::try_from(Config::default()).unwrap_or_default().into()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::MagcompError;

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
        let windowed = WindowedConfig { n_min: Some(50), ..Default::default() };
        let config = Config { field_strength_ut: Some(48.0), windowed: Some(windowed), ..Default::default() };
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
