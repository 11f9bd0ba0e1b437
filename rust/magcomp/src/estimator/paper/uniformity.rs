//! How evenly the orientations cover the sphere: sigma_T of eq. (12) to (15).
//!
//! (12) theta = acos(h_z), (13), (14) phi = atan2(h_y, h_x), in degrees, of the compensated field h (eq. 11);
//! (15) sigma_T = sqrt(sigma_phi^2 + sigma_theta^2), normalised standard deviations. The paper does not say how they
//! are normalised; both readings are offered. sigma_T uses angles about z only, so it misses uneven sets such as a cone about z
//! or a great circle through z; `EllipsoidFit::direction_sigma_deg` sees them.

#[cfg(test)]
mod tests;

use crate::calibration::Calibration;
use crate::config::Normalisation;
use crate::math::elementary::{atan2, hypot};
use core::f64::consts::SQRT_2;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

/// Mathematics: standard deviation of phi on an even sphere, 180 / sqrt(3) deg, times sqrt(2).
const EVEN_PHI_DEG: f64 = 103.923_048_454_132_64 * SQRT_2;
/// Mathematics: the same of theta: its variance is pi^2 / 4 - 2 rad^2.
const EVEN_THETA_DEG: f64 = 39.171_256_042_875_52 * SQRT_2;

/// (15) sigma_T of a set of corrected vectors (any unit): 0 when all are equal, 0.723 (`HalfRange`) or 1 (`EvenSphere`) when
/// they are even. The azimuth jumps from 180 to -180 degrees: nearly equal vectors about azimuth 180 give up to 1.
///
/// Zero for an empty set. Vectors of length zero count as lying along +z.
#[must_use]
pub fn uniformity(corrected: impl IntoIterator<Item = Vector3<f64>>, normalisation: Normalisation) -> f64 {
    let (phi_unit, theta_unit) = match normalisation {
        Normalisation::HalfRange => (180.0, 90.0),
        Normalisation::EvenSphere => (EVEN_PHI_DEG, EVEN_THETA_DEG),
    };
    let (mut phi, mut theta) = (Spread::default(), Spread::default());
    for h in corrected {
        // (12) acos(h_z / |h|), by the form that is exact near the poles too
        theta.add(atan2(hypot(h.x, h.y), h.z).to_degrees() / theta_unit);
        phi.add(atan2(h.y, h.x).to_degrees() / phi_unit);
    }
    (phi.variance() + theta.variance()).sqrt()
}

/// How the latest samples look through a calibration.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Evenness {
    /// (15).
    pub sigma_t: f64,
    /// Rms deviation of |h| from the calibration's strength, relative.
    pub spread: f64,
}

/// (11) to (15) of raw samples, uT.
pub(crate) fn evenness<'a>(
    raw_ut: impl Iterator<Item = &'a Vector3<f64>>,
    calibration: &Calibration,
    normalisation: Normalisation,
) -> Evenness {
    let (mut squares, mut count) = (0.0, 0_usize);
    let corrected = raw_ut.map(|raw_ut| {
        let h = calibration.correct(raw_ut);
        squares += (h.norm() / calibration.field_strength_ut() - 1.0).powi(2);
        count += 1;
        h
    });
    let sigma_t = uniformity(corrected, normalisation);
    Evenness { sigma_t, spread: (squares / count as f64).sqrt() }
}

/// Running variance (Welford).
#[derive(Default)]
struct Spread {
    count: f64,
    mean: f64,
    squares: f64,
}

impl Spread {
    fn add(&mut self, value: f64) {
        self.count += 1.0;
        let off = value - self.mean;
        self.mean += off / self.count;
        self.squares += off * (value - self.mean);
    }

    fn variance(&self) -> f64 {
        if self.count > 0.0 { self.squares / self.count } else { 0.0 }
    }
}
