//! What is believed of the calibration in force: where it comes from, and how sure one may be of it.

#[cfg(test)]
mod tests;

use super::adopted::Adopted;
use crate::calibration::{Given, independent};
use crate::heading::Heading;
use crate::math::elementary::gain;
use crate::priors::{DAYS_UT, IRON_PER_UT, SETTLED_S};

#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Belief {
    /// What was adopted, until something is learned from live samples.
    pub adopted: Option<Adopted>,
    /// The calibration in force was learned from live samples.
    pub has_learned: bool,
    /// Dip of the field when it was last known, deg.
    pub inclination_deg: Option<f64>,
    /// How well the calibration was believed that was adopted last, uT.
    pub adopted_sigma_ut: Option<f64>,
}

impl Belief {
    /// The calibration in force is one that live samples have taught.
    pub fn learn(&mut self) {
        (self.has_learned, self.adopted) = (true, None);
    }

    /// The dip that is kept is a mean over some time: a walk's accelerations pass.
    pub fn see_dip(&mut self, heading: &Heading, since_s: f64) {
        let Some(seen_deg) = heading.inclination_deg else { return };
        let dip_deg = self.inclination_deg.get_or_insert(seen_deg);
        *dip_deg += (seen_deg - *dip_deg) * gain(since_s, SETTLED_S);
    }

    /// What the next estimator begins from: the calibration in force, no surer than usual unless one was given that is.
    pub fn no_surer_than_usual(&self, mut given: Given) -> Given {
        let least_ut = self.adopted_sigma_ut.map_or(DAYS_UT, |sigma_ut| sigma_ut.min(DAYS_UT));
        let lacks_ut2 = (least_ut * least_ut - given.hard_iron_ut2()).max(0.0);
        given.covariance += independent(lacks_ut2, IRON_PER_UT * IRON_PER_UT * lacks_ut2);
        given
    }
}
