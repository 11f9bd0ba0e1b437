//! Strengths of fields, uT: what the world magnetic model has, and what buildings make of it.

use core::ops::Range;

/// Physics: the Earth's field with what buildings do to it; the world magnetic model has 22 to 67.
pub(crate) const EARTH_UT: Range<f64> = 18.0..72.0;
/// Physics: standard deviation of the logarithm of the strength, about its geometric mean over the globe.
pub(crate) const EARTH_SD: f64 = 0.28;
/// Limit: half of the Earth's weakest and twice its strongest field: disturbed places are within it, other units are not.
pub(crate) const POSSIBLE_UT: Range<f64> = 11.0..134.0;
/// Physics: the Earth's strongest field, 67 uT, an axis (67 / 3^0.5). What is known no better than that tells no direction.
pub(crate) const STRONGEST_AXIS_UT: f64 = 39.0;
