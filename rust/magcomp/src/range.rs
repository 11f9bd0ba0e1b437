//! The range of a setting, and the error that names it.

/// A setting is outside its range.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("config: {field} is {value}, expected {expected}")]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct ConfigError {
    /// Path of the setting, for instance `windowed.n_min`.
    pub field: &'static str,
    /// What it was.
    pub value: String,
    /// What it may be.
    pub expected: &'static str,
}

/// A check of a field against its range, both ends allowed; `none` passes where the field may be left out.
macro_rules! range {
    ($path:literal, $value:expr, $low:literal, $high:literal $(, $unit:literal)?) => {
        $crate::range::Check {
            ok: ($low..=$high).contains(&$value),
            field: $path,
            value: &$value,
            expected: concat!($low, " to ", $high $(, " ", $unit)?),
        }
    };
    ($path:literal, $value:expr, none, $low:literal, $high:literal, $unit:literal) => {
        $crate::range::Check {
            ok: $value.is_none_or(|value| ($low..=$high).contains(&value)),
            field: $path,
            value: &$value,
            expected: concat!($low, " to ", $high, " ", $unit, ", or none"),
        }
    };
}
pub(crate) use range;

/// Whether a field is inside its range, its path, its value, and the range.
pub(crate) struct Check<'a> {
    pub ok: bool,
    pub field: &'static str,
    pub value: &'a dyn std::fmt::Debug,
    pub expected: &'static str,
}

/// The error of the first field that is not.
pub(crate) fn first_failed(checks: &[Check<'_>]) -> Result<(), ConfigError> {
    let Some(Check { field, value, expected, .. }) = checks.iter().find(|check| !check.ok) else { return Ok(()) };
    let value = format!("{value:?}");
    let value = value.strip_prefix("Some(").and_then(|v| v.strip_suffix(')')).unwrap_or(&value).to_owned();
    Err(ConfigError { field, value, expected })
}
