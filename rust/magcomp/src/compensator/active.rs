//! The estimator that answers. There is one at a time; another takes its place in the same memory.

use crate::calibration::{Calibration, Given, UNEVEN_UT, calibration_covariance, independent};
use crate::config::{Config, Method};
use crate::estimator::Tunings;
use crate::estimator::adaptive::Adaptive;
use crate::estimator::aided::Aided;
use crate::estimator::answer::Answer;
use crate::estimator::paper::{Clerk, Windowed};
use crate::kept::{IRON_PER_UT, USUAL_SIGMA_UT};
use crate::reading::{SensorMode, Status};
use crate::sample::MagneticSample;
use crate::sensing::pairing::PairedInertial;
use nalgebra::{Matrix3, SMatrix};

/// One of the estimators.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "it is overwritten in place: a box in each would allocate")]
pub(super) enum Active {
    Aided(Aided),
    Adaptive(Adaptive),
    Windowed(Windowed),
}

impl Active {
    /// What a method begins with; of the two of `Auto` the one that needs no gyroscope.
    pub fn new(config: &Config, tunings: &Tunings, initial: Option<Given>) -> Self {
        match config.method {
            Method::Windowed | Method::Constant => Self::Windowed(Windowed::new(config.method == Method::Constant)),
            Method::Auto | Method::Aided | Method::Adaptive => {
                Self::Adaptive(Adaptive::new(tunings.adaptive, config.field_strength_ut, initial))
            }
        }
    }

    /// The aided estimator, from the calibration in force.
    pub fn aided(config: &Config, tunings: &Tunings, given: Option<Given>) -> Self {
        let mut aided = Aided::new(tunings.aided, config.field_strength_ut);
        if let Some(given) = given {
            aided.begin_from(&given);
        }
        Self::Aided(aided)
    }

    /// One sample that was checked, with what the other sensors said; the clerk takes it down.
    pub fn push(&mut self, sample: &MagneticSample, paired: &PairedInertial, clerk: &mut Clerk) -> (Status, Answer) {
        let (time_ns, raw_ut, up) = (sample.time_ns, &sample.field_ut, paired.up_m_s2);
        let (status, answer) = match self {
            Self::Aided(aided) => {
                let answered = aided.push(time_ns, *raw_ut, paired);
                clerk.note(raw_ut, || aided.calibration());
                return answered;
            }
            Self::Adaptive(adaptive) => {
                let answered = adaptive.push(time_ns, raw_ut, up);
                if clerk.note(raw_ut, || adaptive.calibration()) {
                    clerk.measure();
                }
                answered
            }
            Self::Windowed(windowed) => {
                let status = windowed.push(time_ns, raw_ut, clerk);
                let field_ut = clerk.noted.calibration.map(|calibration| calibration.correct(raw_ut));
                let field_ut = field_ut.filter(|field| field.norm().is_finite());
                let field_covariance_ut2 = windowed.fit.zip(field_ut).map(|(fit, field)| {
                    let w = fit.calibration.soft_iron_inverse();
                    let noise = w * w.transpose() * fit.residual_rms_ut.powi(2);
                    calibration_covariance(&fit.covariance, w, &field) + noise
                });
                let direction_sigma_deg = windowed.fit.map(|fit| fit.direction_sigma_deg);
                (status, Answer { field_ut, field_covariance_ut2, direction_sigma_deg, ..Answer::default() })
            }
        };
        // what no calibration knows
        let uneven_ut2 = Matrix3::identity() * UNEVEN_UT.powi(2);
        let field_covariance_ut2 = answer.field_covariance_ut2.map(|covariance| covariance + uneven_ut2);
        let mode = if up.is_some() { SensorMode::GravityOnly } else { SensorMode::MagnetometerOnly };
        (status, Answer { field_covariance_ut2, up, sigma_t: clerk.noted.sigma_t, mode, ..answer })
    }

    pub fn calibration(&self, clerk: &Clerk) -> Option<Calibration> {
        match self {
            Self::Aided(aided) => aided.calibration(),
            Self::Adaptive(adaptive) => adaptive.calibration(),
            Self::Windowed(_) => clerk.noted.calibration,
        }
    }

    /// The calibration in force, and how well it is known.
    pub fn in_force(&self, clerk: &Clerk) -> Option<Given> {
        if let Self::Adaptive(adaptive) = self
            && let Some(given) = adaptive.untouched()
        {
            return Some(given);
        }
        let covariance = self.covariance().unwrap_or_else(|| {
            let sigma_ut = USUAL_SIGMA_UT;
            independent(sigma_ut.powi(2), (IRON_PER_UT * sigma_ut).powi(2))
        });
        Some(Given { calibration: self.calibration(clerk)?, covariance })
    }

    /// Whether the calibration in force was learned from live samples.
    pub fn has_learned(&self) -> bool {
        match self {
            Self::Aided(aided) => aided.has_learned(),
            Self::Adaptive(adaptive) => adaptive.has_learned(),
            Self::Windowed(windowed) => windowed.fit.is_some(),
        }
    }

    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        match self {
            Self::Aided(aided) => aided.covariance(),
            Self::Adaptive(adaptive) => adaptive.covariance(),
            Self::Windowed(windowed) => windowed.fit.map(|fit| fit.covariance),
        }
    }

    /// Samples that the estimator looks at.
    pub fn window(&self, clerk: &Clerk) -> usize {
        match self {
            Self::Adaptive(adaptive) => adaptive.window(),
            Self::Aided(_) | Self::Windowed(_) => clerk.window,
        }
    }
}
