//! Whether a field can be as strong as a filter believes.

use std::ops::Range;

use super::state::{FIELD, Filter};
use crate::ellipsoid::FitError;
use crate::priors::BEYOND_CHANCE;

/// That m is stronger or weaker than any field of a range, uT, if so.
pub(super) fn impossible_field(filter: &Filter, range_ut: &Range<f64>) -> Option<FitError> {
    let m = filter.part(FIELD);
    let field_ut = m.norm();
    let doubt_ut = BEYOND_CHANCE * m.dot(&(filter.own(FIELD) * m)).max(0.0).sqrt() / field_ut;
    let Range { start: low_ut, end: high_ut } = *range_ut;
    (field_ut + doubt_ut < low_ut || field_ut - doubt_ut > high_ut).then_some(FitError::FieldOutOfRange {
        field_ut,
        low_ut,
        high_ut,
    })
}
