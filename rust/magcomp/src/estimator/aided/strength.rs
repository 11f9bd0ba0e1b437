//! How strong the field is, and how well that is known.

use nalgebra::SVector;

use super::state::{FIELD, Gaussian, OFFSET};
use crate::quadric::FitError;

/// Half of the Earth's weakest and twice its strongest field, uT: disturbed places are within it, other units are not.
const POSSIBLE_UT: (f64, f64) = (11.0, 134.0);
/// Standard deviations by which |m| must be outside that to be refused: one in 400.
const BEYOND_DOUBT: f64 = 3.0;

/// That no place has a field as strong or as weak as m, if so.
pub(super) fn impossible_field(filter: &Gaussian) -> Option<FitError> {
    let m = filter.vector(FIELD);
    let field_ut = m.norm();
    let doubt_ut = BEYOND_DOUBT * m.dot(&(filter.block(FIELD, FIELD) * m)).max(0.0).sqrt() / field_ut;
    let (low_ut, high_ut) = POSSIBLE_UT;
    (field_ut + doubt_ut < low_ut || field_ut - doubt_ut > high_ut).then_some(FitError::FieldOutOfRange {
        field_ut,
        low_ut,
        high_ut,
    })
}

/// The covariance of (b, e) with |m|, and the variance of |m|. Where the field points is not known when it was lost; how strong
/// it is stays known.
pub(super) fn strength_covariance(filter: &Gaussian, lost: bool, lost_sd_ut: f64) -> (SVector<f64, 9>, f64) {
    if lost {
        return (SVector::zeros(), lost_sd_ut * lost_sd_ut);
    }
    let m = filter.vector(FIELD);
    let along = m / m.norm().max(1.0);
    let cross = filter.p.fixed_view::<9, 3>(OFFSET, FIELD) * along;
    (cross, along.dot(&(filter.block(FIELD, FIELD) * along)))
}
