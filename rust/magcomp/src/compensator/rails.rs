//! The full scale of a sensor that nobody has told: an axis that reads its extreme value again and again, to the last bit, while the device turns.
//!
//! An axis that is not cut off changes meanwhile: where the others change by d about its extreme, by d^2 / 8 B in the strongest field B. That has to be more
//! than two of its last bits, the least that it has changed by so far.

#[cfg(test)]
mod tests;

use crate::reading::{Axis, RejectReason};
use crate::strength::EARTH_UT;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

/// Choice: how often an axis repeats an extreme on end, not by chance, where the field turns.
const REPEATS: u32 = 4;
/// Choice: where the other axes change by so much about the extreme of this one, it changes by 0.3 uT in a field of 45 uT, two last bits of a sensor, uT.
const TURNED_UT: f64 = 10.0;

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Rails {
    latest_ut: Option<Vector3<f64>>,
    axes: [Extremes; 3],
}

/// The extremes that one axis has read, and how it repeats them.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
struct Extremes {
    lowest_ut: f64,
    highest_ut: f64,
    last_bit_ut: Option<f64>,
    /// How often the latest reading, an extreme, was repeated.
    repeats: u32,
    /// Of all axes meanwhile.
    least_ut: Vector3<f64>,
    most_ut: Vector3<f64>,
    /// Full scale, at either end.
    low_ut: Option<f64>,
    high_ut: Option<f64>,
}

impl Rails {
    /// Whether an axis reads its full scale.
    pub fn check(&self, field_ut: &Vector3<f64>) -> Result<(), RejectReason> {
        for (extremes, (&value_ut, axis)) in self.axes.iter().zip(field_ut.iter().zip([Axis::X, Axis::Y, Axis::Z])) {
            if [extremes.low_ut, extremes.high_ut].contains(&Some(value_ut)) {
                return Err(RejectReason::Saturated { axis, value_ut, rail_ut: value_ut.abs() });
            }
        }
        Ok(())
    }

    /// A sample that is used.
    pub fn see(&mut self, field_ut: &Vector3<f64>) {
        let latest_ut = self.latest_ut.replace(*field_ut);
        for (axis, extremes) in self.axes.iter_mut().enumerate() {
            extremes.see(axis, field_ut, latest_ut.as_ref());
        }
    }
}

impl Extremes {
    fn see(&mut self, axis: usize, field_ut: &Vector3<f64>, latest_ut: Option<&Vector3<f64>>) {
        let value_ut = field_ut[axis];
        let Some(latest_ut) = latest_ut else {
            (self.lowest_ut, self.highest_ut) = (value_ut, value_ut);
            return;
        };
        if !(self.lowest_ut < value_ut && value_ut < self.highest_ut) {
            // what is exceeded was no full scale
            self.high_ut = self.high_ut.filter(|rail| value_ut <= *rail);
            self.low_ut = self.low_ut.filter(|rail| value_ut >= *rail);
            self.lowest_ut = self.lowest_ut.min(value_ut);
            self.highest_ut = self.highest_ut.max(value_ut);
        }
        let change_ut = (value_ut - latest_ut[axis]).abs();
        if change_ut > 0.0 {
            self.last_bit_ut = Some(self.last_bit_ut.map_or(change_ut, |least| least.min(change_ut)));
        }
        let is_extreme = value_ut == self.lowest_ut || value_ut == self.highest_ut;
        if value_ut != latest_ut[axis] || !is_extreme {
            self.repeats = 0;
            return;
        }
        if self.repeats == 0 {
            (self.least_ut, self.most_ut) = (*latest_ut, *latest_ut);
        }
        self.repeats = self.repeats.saturating_add(1);
        (self.least_ut, self.most_ut) = (self.least_ut.inf(field_ut), self.most_ut.sup(field_ut));
        let has_moved = self.highest_ut - self.lowest_ut > TURNED_UT;
        let turned_ut = (self.most_ut - self.least_ut).norm();
        let changes_ut = (0.5 * turned_ut).powi(2) / (2.0 * EARTH_UT.end);
        let is_still = self.last_bit_ut.is_some_and(|last_bit_ut| changes_ut > 2.0 * last_bit_ut);
        if self.repeats >= REPEATS && has_moved && turned_ut > TURNED_UT && is_still {
            let rail_ut = if value_ut == self.highest_ut { &mut self.high_ut } else { &mut self.low_ut };
            *rail_ut = Some(value_ut);
        }
    }
}
