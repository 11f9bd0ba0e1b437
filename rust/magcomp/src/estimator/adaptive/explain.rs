//! What the estimator tells of its inside (`Compensator::explain`). Nothing here changes it.

use super::Adaptive;
use super::filter::Kind;
use crate::explanation::{
    ChangeHypothesis, ChangeKind, EXPLAINED_HYPOTHESES, Estimator, EstimatorPhase, Explanation, NoiseLevels, SampleUse,
};
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;

impl Adaptive {
    pub fn explain(&self) -> Explanation {
        Explanation {
            estimator: Estimator::Adaptive,
            phase: if !self.has_learned() {
                EstimatorPhase::Starting
            } else if self.decision.suspected_ns.is_some() {
                EstimatorPhase::Undecided
            } else {
                EstimatorPhase::Running
            },
            tries_both: false,
            sample: self.usage.or((self.count > 0).then_some(SampleUse::Pooled)),
            innovation: None,
            gated_share: None,
            compared_turn_deg: None,
            hypotheses: self.likeliest(),
            outside: None,
            noise: NoiseLevels {
                white_ut: Some(self.white().sqrt() * self.unit_ut),
                local_ut: Some(self.bank.noise.uneven.size * self.unit_ut),
                hard_iron_walk_ut: Some(self.tuning.walk_ut),
                ..NoiseLevels::default()
            },
        }
    }

    /// The likeliest hypothesis of each change, in order.
    fn likeliest(&self) -> [Option<ChangeHypothesis>; EXPLAINED_HYPOTHESES] {
        let mut found = [None; EXPLAINED_HYPOTHESES];
        let Some(best) = self.bank.best() else { return found };
        // twins and forks share the name of their change
        let mut ids = [0; EXPLAINED_HYPOTHESES];
        for k in 0..EXPLAINED_HYPOTHESES {
            let others = self.bank.all.iter().filter(|h| !ids[..k].contains(&h.id));
            let Some(next) = others.max_by(|a, b| a.log_joint().total_cmp(&b.log_joint())) else { break };
            ids[k] = next.id;
            found[k] = Some(ChangeHypothesis {
                kind: match next.kind {
                    Kind::Cold => ChangeKind::FromNothing,
                    Kind::Device => ChangeKind::Device,
                    Kind::Place => ChangeKind::Place,
                    Kind::Former => ChangeKind::DeviceBack,
                },
                onset_ns: next.onset_ns,
                log_odds: next.log_joint() - best.log_joint(),
                gated_share: None,
            });
        }
        found
    }
}
