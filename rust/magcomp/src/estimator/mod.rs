//! The estimators behind one `push`: the paper's, or ours.

pub(crate) mod adaptive;
pub(crate) mod aided;
pub(crate) mod answer;
mod figures;
mod ours;
pub(crate) mod paper;
mod tunings;

use crate::calibration::{Calibration, Given, independent};
use crate::ellipsoid::EllipsoidFit;
use crate::explanation::Explanation;
use crate::priors::{DAYS_UT, IRON_PER_UT};
use crate::reading::Status;
use crate::sample::MagneticSample;
use crate::sensing::pairing::PairedInertial;
use answer::{Answer, Counted};
use nalgebra::SMatrix;
use ours::{GyroscopeErrors, Ours};
use paper::{Windowed, WindowedConfig};
pub(crate) use tunings::EstimatorTunings;

/// The estimator that a config asks for.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[expect(clippy::large_enum_variant, reason = "there is one, and it stands in a box")]
pub(crate) enum Estimator {
    Ours(Ours),
    Windowed(Windowed),
}

impl Estimator {
    /// Ours, in a field of this strength (uT) where it is known, for a validated config. All memory is taken here.
    pub fn ours(tunings: EstimatorTunings, strength_ut: Option<f64>, windowed: WindowedConfig) -> Self {
        Self::Ours(Ours::new(tunings, strength_ut, windowed))
    }

    /// The paper's: the same, and whether its first good fit is kept.
    pub fn windowed(is_constant: bool, windowed: WindowedConfig, strength_ut: Option<f64>) -> Self {
        Self::Windowed(Windowed::new(is_constant, windowed, strength_ut))
    }

    /// As new, in the memory that is there.
    pub fn restart(&mut self) {
        match self {
            Self::Ours(ours) => ours.restart(),
            Self::Windowed(windowed) => windowed.restart(),
        }
    }

    /// Begins anew with what is given; the paper's estimator goes on from it.
    pub fn begin_from(&mut self, given: Option<Given>) {
        match self {
            Self::Ours(ours) => ours.begin_from(given),
            Self::Windowed(windowed) => windowed.begin_from(given.map(|given| given.calibration)),
        }
    }

    /// The gyroscope is there now (or no longer), and whether it is contradicted: whether it is another estimator's turn. One that comes begins from
    /// what is in force, as `given` makes it.
    pub fn follow_gyroscope(
        &mut self,
        is_there: bool,
        is_contradicted: bool,
        given: impl FnOnce(Given) -> Given,
    ) -> bool {
        match self {
            Self::Ours(ours) => ours.follow_gyroscope(is_there, is_contradicted, |ours| {
                in_force(ours.untouched(), ours.calibration(), ours.covariance()).map(given)
            }),
            Self::Windowed(_) => false,
        }
    }

    /// One sample that was checked, with what the other sensors said.
    pub fn push(&mut self, sample: &MagneticSample, paired: &PairedInertial) -> (Status, Answer) {
        match self {
            Self::Ours(ours) => ours.push(sample, paired),
            Self::Windowed(windowed) => windowed.push(sample, paired.up_m_s2),
        }
    }

    /// Whether there is a gyroscope that carries on where the field points.
    pub fn carries(&self) -> bool {
        matches!(self, Self::Ours(ours) if ours.carries())
    }

    /// A sample whose field is of no use.
    pub fn carry(&mut self, time_ns: i64, paired: &PairedInertial) -> Answer {
        if let Self::Ours(ours) = self { ours.carry(time_ns, paired) } else { Answer::default() }
    }

    pub fn calibration(&self) -> Option<Calibration> {
        match self {
            Self::Ours(ours) => ours.calibration(),
            Self::Windowed(windowed) => windowed.calibration(),
        }
    }

    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        match self {
            Self::Ours(ours) => ours.covariance(),
            Self::Windowed(windowed) => windowed.fit().map(|fit| fit.covariance),
        }
    }

    /// The calibration in force, and how well it is known.
    pub fn in_force(&self) -> Option<Given> {
        let untouched = if let Self::Ours(ours) = self { ours.untouched() } else { None };
        in_force(untouched, self.calibration(), self.covariance())
    }

    /// Whether the calibration in force was learned from live samples.
    pub fn has_learned(&self) -> bool {
        match self {
            Self::Ours(ours) => ours.has_learned(),
            Self::Windowed(windowed) => windowed.fit().is_some(),
        }
    }

    /// The latest ellipsoid fit that was accepted.
    pub fn fit(&self) -> Option<&EllipsoidFit> {
        if let Self::Windowed(windowed) = self { windowed.fit() } else { None }
    }

    /// The inside of the estimator that answers.
    pub fn explain(&self) -> Explanation {
        match self {
            Self::Ours(ours) => ours.explain(),
            Self::Windowed(windowed) => windowed.explain(),
        }
    }

    /// What is known of the gyroscope, while it is in use.
    pub fn gyroscope(&self) -> Option<GyroscopeErrors> {
        if let Self::Ours(ours) = self { ours.gyroscope() } else { None }
    }

    /// Samples that it looks at.
    pub fn window(&self) -> usize {
        match self {
            Self::Ours(ours) => ours.window(),
            Self::Windowed(windowed) => windowed.counted().samples,
        }
    }

    /// What directions are counted over.
    pub fn counted(&self) -> Counted<'_> {
        match self {
            Self::Ours(ours) => ours.counted(),
            Self::Windowed(windowed) => windowed.counted(),
        }
    }
}

/// What was given and not touched; else the calibration, as sure as its covariance says, or as usual.
fn in_force(
    untouched: Option<Given>,
    calibration: Option<Calibration>,
    covariance: Option<SMatrix<f64, 9, 9>>,
) -> Option<Given> {
    let usual = || independent(DAYS_UT.powi(2), (IRON_PER_UT * DAYS_UT).powi(2));
    untouched.or_else(|| Some(Given { calibration: calibration?, covariance: covariance.unwrap_or_else(usual) }))
}
