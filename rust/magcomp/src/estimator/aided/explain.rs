//! What the estimator tells of its inside (`Compensator::explain`). Nothing here changes it.

use nalgebra::Vector3;

use super::Aided;
use super::phase::Phase;
use super::state::{BIAS, Filter};
use crate::explanation::{EXPLAINED_HYPOTHESES, Estimator, EstimatorPhase, Explanation, InnovationTest, NoiseLevels};

impl Aided {
    pub fn explain(&self) -> Explanation {
        let trial = self.phase.trial();
        let mut hypotheses = [None; EXPLAINED_HYPOTHESES];
        if let Some(trial) = trial {
            for (slot, hypothesis) in hypotheses.iter_mut().zip(trial.explain()) {
                *slot = Some(hypothesis);
            }
        }
        Explanation {
            estimator: Estimator::Aided,
            phase: match self.phase {
                Phase::Starting(_) => EstimatorPhase::Starting,
                Phase::Running(_) => EstimatorPhase::Running,
                Phase::Undecided(..) => EstimatorPhase::Undecided,
            },
            tries_both: false,
            sample: self.judged.map(|judged| judged.usage),
            innovation: self.judged.and_then(|judged| judged.innovation).map(|it| InnovationTest {
                innovation_ut: it.v,
                expected_ut: it.variance_ut2.map(f64::sqrt),
                ratio: it.nis / self.tuning.gate,
            }),
            gated_share: self.phase.running().map(|running| running.watch.share),
            compared_turn_deg: trial.map(|trial| trial.rotation_rad.to_degrees()),
            hypotheses,
            noise: self.noise_levels(),
            outside: None,
        }
    }

    fn noise_levels(&self) -> NoiseLevels {
        let filter = self.phase.known();
        let sigma_rad_s = |filter: &Filter| filter.variances(BIAS).map(f64::sqrt);
        let at_rest_rad_s = match &self.phase {
            Phase::Starting(first) => Some(first.rest_bias_sigma_rad_s()),
            Phase::Running(_) | Phase::Undecided(..) => None,
        };
        NoiseLevels {
            white_ut: Some(self.adaptation.sample.sigma_ut()),
            local_ut: Some(self.adaptation.local_ut),
            hard_iron_walk_ut: Some(self.adaptation.walk_ut),
            delay_s: filter.map(Filter::delay_s),
            delay_sigma_s: filter.map(|filter| filter.delay_s2().sqrt()),
            gyroscope_bias_rad_s: Some(self.gyroscope().0),
            gyroscope_bias_sigma_rad_s: filter.map(sigma_rad_s).or(at_rest_rad_s.map(Vector3::repeat)),
        }
    }
}
