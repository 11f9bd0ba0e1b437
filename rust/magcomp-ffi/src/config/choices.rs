//! What a setting can be that is no number.

use crate::convert::same_names;
use crate::error::MagcompError;

/// How the hard and soft iron are estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Method {
    /// Uses gyroscope and gravity beside the magnetometer; works as `Adaptive` while there is no usable gyroscope.
    Auto,
    /// The same as `Auto`.
    Aided,
    /// Uses the magnetometer alone; notices changes and relearns them as fast as the samples allow.
    Adaptive,
    /// The paper's method: an ellipsoid fit over the latest samples, whose number follows sigma_T.
    Windowed,
    /// The first step of the paper's method alone: one fit of the first well spread samples, kept from then on.
    Constant,
}

/// The residual that a fit squares and sums.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Residual {
    /// Eq. (10) of the paper as written.
    Algebraic,
    /// Divided by its own gradient: a distance in raw units, free of the noise bias.
    Corrected,
}

/// How the standard deviations in sigma_T are normalised.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Normalisation {
    /// By half the range of each axis.
    HalfRange,
    /// By the standard deviation of evenly spread directions.
    EvenSphere,
}

same_names! {
    Method { Auto, Aided, Adaptive, Windowed, Constant }
    Residual { Algebraic, Corrected }
    Normalisation { HalfRange, EvenSphere }
}

/// A count of the core's; `field` is where it stands in the config.
pub(super) fn size(field: &str, n: i32) -> Result<usize, MagcompError> {
    usize::try_from(n).map_err(|_| MagcompError::Config {
        field: field.to_owned(),
        value: n.to_string(),
        expected: "0 or above".to_owned(),
    })
}
