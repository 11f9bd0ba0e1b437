//! The range of a setting, and the error that names it.

use alloc::{borrow::ToOwned, format, string::String};
use core::fmt::Debug;
use core::ops::RangeInclusive;

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
    pub expected: String,
}

/// Whether a setting lies in its range, both ends allowed; one that is left out does.
pub(crate) fn in_range<T: PartialOrd + Debug>(
    field: &'static str,
    value: impl Into<Option<T>>,
    range: RangeInclusive<T>,
    unit: &str,
) -> Result<(), ConfigError> {
    let Some(value) = value.into().filter(|value| !range.contains(value)) else { return Ok(()) };
    let expected = format!("{:?} to {:?} {unit}", range.start(), range.end()).trim_end().to_owned();
    Err(ConfigError { field, value: format!("{value:?}"), expected })
}
