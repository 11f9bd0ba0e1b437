//! How much what is learned weighs.

/// Choice: values that the belief at the start is worth.
pub(super) const START: f64 = 10.0;
/// Choice: values that are remembered: 6 % of scatter.
pub(super) const MEMORY: f64 = 300.0;
