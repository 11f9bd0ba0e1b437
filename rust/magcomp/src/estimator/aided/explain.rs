//! What the estimator tells of its inside (`Compensator::explain`). Nothing here changes it.

#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::Vector3;

use super::Aided;
use super::phase::Phase;
use super::state::{BIAS, DELAY};
use crate::explanation::{EXPLAINED_HYPOTHESES, Estimator, EstimatorPhase, Explanation, NoiseLevels};

impl Aided {
    pub fn explain(&self) -> Explanation {
        let (trial, filter) = (self.phase.trial(), self.phase.known());
        let at_rest_rad_s = match &self.phase {
            Phase::Starting(first) => Some(Vector3::repeat(first.bias_variance.sqrt())),
            Phase::Running(..) | Phase::Undecided(..) => None,
        };
        Explanation {
            estimator: Estimator::Aided,
            phase: match self.phase {
                Phase::Starting(_) => EstimatorPhase::Starting,
                Phase::Running(..) => EstimatorPhase::Running,
                Phase::Undecided(..) => EstimatorPhase::Undecided,
            },
            tries_both: false,
            sample: self.judged.map(|(usage, _)| usage),
            innovation: self.judged.and_then(|(_, innovation)| innovation),
            gated_share: self.phase.running().map(|running| running.watch.share),
            compared_turn_deg: trial.map(|trial| trial.rotation_rad.to_degrees()),
            hypotheses: trial.map_or([None; EXPLAINED_HYPOTHESES], |it| {
                let [first, second] = it.explain();
                [Some(first), Some(second), None, None]
            }),
            noise: NoiseLevels {
                white_ut: Some(self.senses.white.sigma_ut()),
                local_ut: Some(self.adaptation.local_ut),
                hard_iron_walk_ut: Some(self.tuning.offset_walk_ut),
                delay_s: filter.map(|filter| filter.part(DELAY).x),
                delay_sigma_s: filter.map(|filter| filter.own(DELAY).x.sqrt()),
                gyroscope_bias_rad_s: Some(self.gyroscope().0),
                gyroscope_bias_sigma_rad_s: filter
                    .map(|filter| filter.variances(BIAS).map(f64::sqrt))
                    .or(at_rest_rad_s),
            },
            outside: None,
        }
    }
}
