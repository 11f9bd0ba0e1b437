//! The choices of our estimators together.

use super::{adaptive, aided};

/// The choices of each.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct EstimatorTunings {
    pub adaptive: adaptive::Tuning,
    pub aided: aided::Tuning,
}
