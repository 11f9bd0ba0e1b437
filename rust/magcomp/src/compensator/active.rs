//! The estimator that answers. There is one at a time, or two while a start tries both; another takes its place in the same memory.

use crate::calibration::{Calibration, Given, UNEVEN_UT, calibration_covariance, independent};
use crate::config::{Config, Method};
use crate::ellipsoid::direction_sigma_deg;
use crate::estimator::Tunings;
use crate::estimator::adaptive::Adaptive;
use crate::estimator::aided::Aided;
use crate::estimator::answer::Answer;
use crate::estimator::paper::{Clerk, Noted, Windowed};
use crate::explanation::Explanation;
use crate::kept::{IRON_PER_UT, USUAL_SIGMA_UT};
use crate::reading::{SensorMode, Status};
use crate::sample::MagneticSample;
use crate::sensing::pairing::PairedInertial;
use nalgebra::{Matrix3, SMatrix};

/// One of the estimators, or the two that a start tries.
#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "it is overwritten in place: a box in each would allocate")]
pub(super) enum Active {
    Aided(Aided),
    Adaptive(Adaptive),
    /// The gyroscope is there, and has not led to a first calibration yet: one that stutters never does.
    Starting(Aided, Adaptive),
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

    /// The gyroscope is usable now (or no longer): whether the estimators are others for it. Those that come begin from `given`.
    pub fn follow_gyroscope(
        &mut self,
        is_usable: bool,
        config: &Config,
        tunings: &Tunings,
        given: impl FnOnce(&Self) -> Option<Given>,
    ) -> bool {
        let given = match (&*self, is_usable) {
            (Self::Adaptive(_), true) | (Self::Aided(_), false) => given(self),
            (Self::Starting(..), false) => None,
            _ => return false,
        };
        // any, for a moment
        *self = match std::mem::replace(self, Self::Windowed(Windowed::default())) {
            Self::Adaptive(adaptive) => {
                let mut aided = Aided::new(tunings.aided, config.field_strength_ut);
                if let Some(given) = given {
                    aided.begin_from(&given);
                }
                Self::Starting(aided, adaptive)
            }
            Self::Starting(_, adaptive) => Self::Adaptive(adaptive),
            Self::Aided(_) | Self::Windowed(_) => Self::new(config, tunings, given),
        };
        true
    }

    /// One sample that was checked, with what the other sensors said; the clerk takes it down.
    pub fn push(&mut self, sample: &MagneticSample, paired: &PairedInertial, clerk: &mut Clerk) -> (Status, Answer) {
        let (time_ns, raw_ut, up) = (sample.time_ns, &sample.field_ut, paired.up_m_s2);
        let alone = |(status, answer): (Status, Answer)| {
            let mode = if up.is_some() { SensorMode::GravityOnly } else { SensorMode::MagnetometerOnly };
            (status, Answer { up, mode, ..answer })
        };
        let (status, answer) = match self {
            Self::Aided(aided) => aided.push(time_ns, *raw_ut, paired),
            Self::Adaptive(adaptive) => alone(adaptive.push(time_ns, raw_ut, up)),
            Self::Starting(aided, adaptive) => {
                let (told, other) = (aided.push(time_ns, *raw_ut, paired), adaptive.push(time_ns, raw_ut, up));
                if knows_more(aided, adaptive) { told } else { alone(other) }
            }
            Self::Windowed(windowed) => {
                let status = windowed.push(time_ns, raw_ut, clerk);
                let field_ut = clerk.noted.calibration.map(|calibration| calibration.correct(raw_ut));
                let field_ut = field_ut.filter(|field| field.norm().is_finite());
                let field_covariance_ut2 = windowed.fit.zip(field_ut).map(|(fit, field)| {
                    let w = fit.calibration.soft_iron_inverse();
                    let noise = w * w.transpose() * fit.residual_rms_ut.powi(2);
                    // what this method does not learn: rooms are not uniform
                    let uneven = Matrix3::from_diagonal_element(UNEVEN_UT.powi(2));
                    calibration_covariance(&fit.covariance, w, &field) + noise + uneven
                });
                let direction_sigma_deg = windowed.fit.map(|fit| fit.direction_sigma_deg);
                let sigma_t = clerk.noted.sigma_t;
                let answer = Answer { field_ut, field_covariance_ut2, direction_sigma_deg, ..Answer::default() };
                return alone((status, Answer { sigma_t, ..answer }));
            }
        };
        if matches!(self, Self::Starting(aided, _) if aided.has_learned())
            && let Self::Starting(aided, _) = std::mem::replace(self, Self::Windowed(Windowed::default()))
        {
            *self = Self::Aided(aided);
        }
        if clerk.note(raw_ut, || self.own_calibration()) {
            clerk.measure();
            clerk.noted.direction_sigma_deg = self
                .own_calibration()
                .zip(self.covariance())
                .map(|(calibration, covariance)| direction_sigma_deg(&calibration, &covariance).min(180.0));
        }
        let Noted { sigma_t, direction_sigma_deg, .. } = clerk.noted;
        (status, Answer { sigma_t, direction_sigma_deg, ..answer })
    }

    pub fn calibration(&self, clerk: &Clerk) -> Option<Calibration> {
        self.own_calibration().or(match self {
            Self::Windowed(_) => clerk.noted.calibration,
            _ => None,
        })
    }

    /// The calibration of an estimator that has no window.
    fn own_calibration(&self) -> Option<Calibration> {
        match self {
            Self::Aided(aided) => aided.calibration(),
            Self::Adaptive(adaptive) => adaptive.calibration(),
            Self::Starting(aided, adaptive) if knows_more(aided, adaptive) => aided.calibration(),
            Self::Starting(_, adaptive) => adaptive.calibration(),
            Self::Windowed(_) => None,
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
            Self::Starting(aided, adaptive) if knows_more(aided, adaptive) => aided.has_learned(),
            Self::Starting(_, adaptive) => adaptive.has_learned(),
            Self::Windowed(windowed) => windowed.fit.is_some(),
        }
    }

    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        match self {
            Self::Aided(aided) => aided.covariance(),
            Self::Adaptive(adaptive) => adaptive.covariance(),
            Self::Starting(aided, adaptive) if knows_more(aided, adaptive) => aided.covariance(),
            Self::Starting(_, adaptive) => adaptive.covariance(),
            Self::Windowed(windowed) => windowed.fit.map(|fit| fit.covariance),
        }
    }

    /// The inside of the estimator that speaks.
    pub fn explain(&self, clerk: &Clerk) -> Explanation {
        match self {
            Self::Aided(aided) => aided.explain(),
            Self::Adaptive(adaptive) => adaptive.explain(),
            Self::Starting(aided, adaptive) => {
                let it = if knows_more(aided, adaptive) { aided.explain() } else { adaptive.explain() };
                Explanation { tries_both: true, ..it }
            }
            Self::Windowed(windowed) => windowed.explain(clerk),
        }
    }

    /// The estimator that has a gyroscope.
    pub fn aided(&self) -> Option<&Aided> {
        match self {
            Self::Aided(aided) | Self::Starting(aided, _) => Some(aided),
            Self::Adaptive(_) | Self::Windowed(_) => None,
        }
    }

    /// Samples that the estimator looks at.
    pub fn window(&self, clerk: &Clerk) -> usize {
        match self {
            Self::Adaptive(adaptive) => adaptive.window(),
            Self::Aided(_) | Self::Starting(..) | Self::Windowed(_) => clerk.window,
        }
    }
}

/// Rotations without a break for so long after one lead to a first calibration wherever the place allows one, s.
const CHAIN_S: f64 = 5.0;

/// Which of the two of a start speaks: the one with the gyroscope, unless that keeps breaking off and the other one alone knows a calibration,
/// or has learned b better.
fn knows_more(aided: &Aided, adaptive: &Adaptive) -> bool {
    if !aided.broke_within(CHAIN_S) {
        return true;
    }
    let of_b = |p: SMatrix<f64, 9, 9>| p.fixed_view::<3, 3>(0, 0).trace();
    match (aided.covariance().map(of_b), adaptive.covariance().map(of_b)) {
        (Some(ours), Some(theirs)) => !adaptive.has_learned() || ours <= theirs,
        (None, Some(_)) => false,
        (_, None) => true,
    }
}
