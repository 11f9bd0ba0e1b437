//! The filter that follows the samples, and what belongs to it.

#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

use super::earth::Earth;
use super::state::{FIELD, Filter, HARD_IRON, LOCAL};
use super::tuning::Tuning;
use super::watch::Watch;
use crate::strength::STRONGEST_AXIS_UT;

/// See the module.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Running {
    pub(super) filter: Filter,
    pub(super) watch: Watch,
    /// The Earth's field, while that of the place is another.
    pub(super) earth: Option<Earth>,
    /// |m| before the chain of rotations broke, while it is not known where the field points.
    pub(super) lost_strength_ut: Option<f64>,
}

impl Running {
    /// The field of the place is another since then: the Earth's is carried beside it.
    pub(super) fn carry_earth(&mut self, since_ns: i64, tuning: &Tuning) {
        self.earth = tuning.new_place.then(|| Earth::of(&self.filter, self.earth.as_ref(), since_ns));
    }

    /// The chain of rotations is broken: where the field points is lost, and the sample is the best guess of it.
    pub(super) fn lose_field(&mut self, raw_ut: &Vector3<f64>, local_ut: f64) {
        let filter = &mut self.filter;
        let m = filter.part(FIELD);
        self.lost_strength_ut.get_or_insert(m.norm());
        if let Some((_, c)) = filter.parts().corrected(raw_ut) {
            if let Some(earth) = &mut self.earth {
                earth.lose(&m, &c);
            }
            filter.set_part(FIELD, &c);
        }
        filter.set_part(LOCAL, &Vector3::zeros());
        filter.isolate(FIELD, &Matrix3::from_diagonal_element(STRONGEST_AXIS_UT.powi(2)));
        filter.isolate(LOCAL, &Matrix3::from_diagonal_element(local_ut.powi(2)));
    }

    /// No sample is seen for so long: the hard iron drifts, up to what a first sample says of it.
    pub(super) fn drift(&mut self, dt_s: f64, tuning: &Tuning) {
        let room_ut2 = STRONGEST_AXIS_UT.powi(2) - self.filter.variances(HARD_IRON).sum() / 3.0;
        let walk_ut2 = tuning.gap_walk_ut.powi(2) * dt_s;
        self.filter.add_variance(HARD_IRON, walk_ut2.min(room_ut2).max(0.0));
    }
}
