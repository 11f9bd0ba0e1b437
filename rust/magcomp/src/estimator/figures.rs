//! Figures of our estimators that are formed anew once a second, since they cost more than a sample may: (15) sigma_T over the latest
//! N_min samples, and the predicted error of a corrected direction. Both are of the calibration that is in force then.

use super::answer::{Answer, Counted};
use super::paper::{WindowedConfig, evenness};
use crate::calibration::Calibration;
use crate::ellipsoid::direction_sigma_deg;
use crate::priors::STEP_S;
use crate::room::Roomy;
use crate::sample::{MagneticSample, seconds};
use nalgebra::{SMatrix, Vector3};
use std::collections::VecDeque;

/// Time after which they are formed anew, s: a display of them can be read that often.
const ANEW_S: f64 = 2.0 * STEP_S;

/// A calibration, and its covariance where that is known.
pub(super) struct InForce {
    pub calibration: Option<Calibration>,
    pub covariance: Option<SMatrix<f64, 9, 9>>,
}

/// See the module.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Figures {
    config: WindowedConfig,
    /// The latest N_min samples, oldest first.
    latest: Roomy<VecDeque<Vector3<f64>>>,
    /// Samples so far.
    samples: usize,
    /// When the figures were formed.
    formed_ns: Option<i64>,
    /// In force the last time that it was asked for, or given since.
    calibration: Option<Calibration>,
    sigma_t: Option<f64>,
    direction_sigma_deg: Option<f64>,
}

impl Figures {
    /// All memory is taken here.
    pub fn new(config: WindowedConfig) -> Self {
        let latest = Roomy::<VecDeque<_>>::new(config.n_min);
        Self {
            config,
            latest,
            samples: 0,
            formed_ns: None,
            calibration: None,
            sigma_t: None,
            direction_sigma_deg: None,
        }
    }

    /// As new, in the memory that is there.
    pub fn restart(&mut self) {
        self.latest.clear();
        (self.samples, self.formed_ns, self.calibration) = (0, None, None);
        (self.sigma_t, self.direction_sigma_deg) = (None, None);
    }

    /// A calibration was given.
    pub fn look_through(&mut self, calibration: Option<Calibration>) {
        self.calibration = calibration.or(self.calibration);
    }

    /// What directions are counted over.
    pub fn counted(&self) -> Counted<'_> {
        Counted { through: self.calibration.as_ref(), samples: self.samples.min(self.config.n_max) }
    }

    /// Puts the figures into the answer to a sample; now and then `in_force` is asked.
    pub fn finish(&mut self, answer: &mut Answer, sample: &MagneticSample, in_force: impl FnOnce() -> InForce) {
        let is_due = self.formed_ns.is_none_or(|formed_ns| seconds(formed_ns, sample.time_ns).abs() >= ANEW_S);
        self.samples = self.samples.saturating_add(1);
        if self.latest.len() == self.config.n_min {
            self.latest.pop_front();
        }
        self.latest.push_back(sample.field_ut);
        if is_due {
            self.formed_ns = Some(sample.time_ns);
            let InForce { calibration, covariance } = in_force();
            self.look_through(calibration);
            let enough = self.calibration.filter(|_| self.latest.len() == self.config.n_min);
            self.sigma_t = enough.map(|it| evenness(self.latest.iter().rev(), &it, self.config.normalisation).sigma_t);
            let known = calibration.zip(covariance);
            let sigma_deg =
                known.map(|(calibration, covariance)| direction_sigma_deg(&calibration, &covariance).min(180.0));
            // nothing is exactly known: rounding has left no covariance
            self.direction_sigma_deg = sigma_deg.filter(|sigma_deg| *sigma_deg > 0.0);
        }
        (answer.sigma_t, answer.direction_sigma_deg) = (self.sigma_t, self.direction_sigma_deg);
    }
}
