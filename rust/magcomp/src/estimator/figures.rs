//! Figures of our estimators that are formed anew once a second, since they cost more than a sample may: (15) sigma_T over the latest
//! N_min samples, and the predicted error of a corrected direction. Both are of the calibration that is in force then.

use super::answer::{Answer, Counted, Known};
use super::paper::evenness;
use crate::calibration::Calibration;
use crate::config::WindowedConfig;
use crate::ellipsoid::direction_sigma_deg;
use crate::room::Roomy;
use crate::sample::{MagneticSample, seconds};
use alloc::collections::VecDeque;
use core::mem::take;
use nalgebra::Vector3;

/// Choice: time after which they are formed anew, s: a display of them can be read that often. Smaller: dearer. Larger: a display lags.
const ANEW_S: f64 = 1.0;

#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
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
        Self { config, latest: Roomy::<VecDeque<_>>::new(config.n_min), ..Self::default() }
    }

    /// As new, in the memory that is there.
    pub fn restart(&mut self) {
        self.latest.clear();
        *self = Self { config: self.config, latest: take(&mut self.latest), ..Self::default() };
    }

    /// A calibration was given.
    pub fn look_through(&mut self, calibration: Option<Calibration>) {
        self.calibration = calibration.or(self.calibration);
    }

    /// What directions are counted over.
    pub fn counted(&self) -> Counted<'_> {
        Counted { through: self.calibration.as_ref(), samples: self.samples.min(self.config.n_max) }
    }

    /// Whether they are formed anew at a sample of this time.
    pub fn is_due(&self, time_ns: i64) -> bool {
        self.formed_ns.is_none_or(|formed_ns| seconds(formed_ns, time_ns).abs() >= ANEW_S)
    }

    /// Puts the figures into the answer to a sample; of what is known they are formed anew.
    pub fn finish(&mut self, answer: &mut Answer, sample: &MagneticSample, known: Option<Known>) {
        self.samples = self.samples.saturating_add(1);
        self.latest.roll(sample.field_ut, self.config.n_min);
        if let Some(Known { calibration, covariance }) = known {
            self.formed_ns = Some(sample.time_ns);
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
