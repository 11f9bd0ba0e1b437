//! What is in force, and when something new replaces it.
//!
//! What may replace them is the mean of the hypotheses: of all parameters the least mean square error is predicted for it.
//! After a change it is released only where the direction error predicted for it is smaller than that of
//! holding the old ones, over the directions of late and the whole sphere, each for half. What holding costs is taken
//! from the samples themselves: they miss the old ellipsoid by m along the field, and twice m^2 across it is what an
//! error of b in a random direction then does.

use super::angle::AngularWeight;
use super::likelihood::Likelihood;
use super::noise::Noise;
use super::parameters::{Matrix9, Vector9, see, shape, vector_gradient};
use super::rivals::Rivals;
use super::samples::Samples;
use crate::reading::ModelOrder;
use crate::snapshot::{checked, is_covariance};
use nalgebra::{Matrix3, Vector3};
use serde::{Deserialize, Serialize};

/// Parameters in force: their second moment about the truth, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(remote = "Self")]
pub(super) struct Published {
    pub tau: Vector9,
    pub covariance: Matrix9,
    /// Mean square direction error expected when they were released, radians^2.
    pub expected: f64,
}

checked!(Published, |it| is_covariance(&it.covariance) && it.expected >= 0.0);

/// Samples of late whose directions count, and how far apart they are.
const DIRECTIONS: usize = 12;
/// Fewest samples of a segment before a former calibration is released again, what was known, and something new.
const FEWEST_FORMER: usize = 2;
const FEWEST_KNOWN: usize = 3;
const FEWEST_HARD_IRON: usize = 6;
const FEWEST_DIAGONAL: usize = 8;
const FEWEST_ALL: usize = 7;

/// Directions of the latest samples, and the sphere.
pub(super) fn directions(samples: &Samples, centre_ut: &Vector3<f64>, unit_ut: f64, tau: &Vector9) -> AngularWeight {
    let mut path = AngularWeight::new();
    let count = samples.age.min(96);
    let stride = (count / DIRECTIONS).max(1);
    for back in (0..count).step_by(stride) {
        path.add(tau, &((samples.latest(back) - centre_ut) / unit_ut));
    }
    path.and(&AngularWeight::sphere(tau))
}

/// Standard deviations between two places beyond which one of them must be wrong about itself, squared.
const APART: f64 = 4.0;

/// Predicted mean square direction errors (radians^2): of new parameters, and of what is in force.
pub(super) struct Comparison {
    pub new: f64,
    /// By what the samples miss it, and by the mixture.
    pub held: f64,
    pub held_by_mixture: f64,
}

pub(super) fn compare(
    rivals: &Rivals,
    tau: &Vector9,
    held: Option<&Published>,
    likelihood: &Likelihood,
    weight: &AngularWeight,
) -> Comparison {
    let new = weight.expected(&rivals.spread_about(tau));
    let held_by_mixture = held.map_or(f64::INFINITY, |published| weight.expected(&rivals.spread_about(&published.tau)));
    let held = held.map_or(f64::INFINITY, |published| {
        let missed = likelihood.at(&published.tau).map_or(f64::INFINITY, |point| point.distance_squared);
        let scale = shape(&published.tau).norm_squared() / 3.0;
        held_by_mixture.min(2.0 * (missed - likelihood.variance).max(0.0) * scale)
    });
    Comparison { new, held, held_by_mixture }
}

impl Comparison {
    /// Whether the new ones lie further from those in force than both predictions allow: one of the two is wrong.
    pub fn contradicts_itself(&self) -> bool {
        self.held_by_mixture > APART * (self.held + self.new)
    }
}

/// Whether there are samples enough to compare at all.
pub(super) fn may_compare(samples: &Samples, order: ModelOrder) -> bool {
    samples.age
        >= match order {
            ModelOrder::Former => FEWEST_FORMER,
            ModelOrder::Nothing => FEWEST_KNOWN,
            ModelOrder::HardIron => FEWEST_HARD_IRON,
            ModelOrder::Diagonal => FEWEST_DIAGONAL,
            ModelOrder::All => FEWEST_ALL,
        }
}

impl Published {
    /// T (u - beta) and the covariance of it, for noise of the samples too, and for that alone: in field strengths.
    pub fn correct(&self, u: &Vector3<f64>, noise: &Noise) -> Option<(Vector3<f64>, Matrix3<f64>, Matrix3<f64>)> {
        let seen = see(&self.tau, u)?;
        let g = vector_gradient(&self.tau, &seen.offset);
        let t = shape(&self.tau);
        let noise = t * t * noise.variance;
        Some((seen.direction * seen.radius, g * self.covariance * g.transpose() + noise, noise))
    }
}
