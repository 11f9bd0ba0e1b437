//! Vectors in the device, and where they point by the reference.

use super::circle::Circle;
use crate::statistics::Spread;
use magcomp::nalgebra::Vector3;
use magcomp_recordings::recording::Row;
use serde::Serialize;

/// A figure of each field, on the rows that have a corrected one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Kinds<T> {
    /// As recorded.
    pub raw: Option<T>,
    /// As the operating system calibrated it; none where it was not recorded.
    pub system: Option<T>,
    /// The corrected sample.
    pub compensated: Option<T>,
}

impl<T> Kinds<T> {
    /// The same of what `of` makes of each.
    pub fn map<U>(self, of: impl Fn(T) -> U) -> Kinds<U> {
        Kinds { raw: self.raw.map(&of), system: self.system.map(&of), compensated: self.compensated.map(&of) }
    }
}

/// Vectors of one kind: the spread of their lengths, and the azimuths they have by the reference.
#[derive(Clone, Debug, Default)]
pub(super) struct Directions {
    pub lengths: Spread,
    pub azimuths: Circle,
}

impl Directions {
    /// A vector with the sigma of its azimuth, degrees; `counted`: it is part of the figures, not of the one azimuth alone.
    pub fn add(&mut self, row: &Row, vector: &Vector3<f64>, sigma_deg: Option<f64>, counted: bool) {
        if counted {
            self.lengths.add(vector.norm());
        }
        if let Some(azimuth_deg) = azimuth_deg(row, vector) {
            self.azimuths.add(azimuth_deg, sigma_deg, counted);
        }
    }
}

/// Azimuth of a device-frame vector by the reference orientation, degrees from north, clockwise.
pub fn azimuth_deg(row: &Row, field_ut: &Vector3<f64>) -> Option<f64> {
    let earth = row.attitude? * field_ut;
    Some(earth.x.atan2(earth.y).to_degrees()).filter(|azimuth| azimuth.is_finite())
}
