//! The estimators behind one `push`: the paper's, or ours.

pub(crate) mod adaptive;
pub(crate) mod aided;
pub(crate) mod answer;
mod by_gyroscope;
mod figures;
pub(crate) mod paper;

use crate::calibration::Given;
use crate::ellipsoid::EllipsoidFit;
use crate::explanation::Explanation;
use crate::reading::Status;
use crate::sample::MagneticSample;
use crate::sensing::pairing::PairedInertial;
use alloc::boxed::Box;
use answer::{Answer, Counted, Known};
pub(crate) use by_gyroscope::{ByGyroscope, Own};
use paper::Windowed;

/// The estimator that a config asks for.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) enum Estimator {
    ByGyroscope(Box<ByGyroscope>),
    Windowed(Box<Windowed>),
}

impl Estimator {
    /// As new, in the memory that is there.
    pub fn restart(&mut self) {
        match self {
            Self::ByGyroscope(it) => it.restart(),
            Self::Windowed(windowed) => windowed.restart(),
        }
    }

    /// Begins anew with what is given; the paper's estimator goes on from it.
    pub fn begin_from(&mut self, given: Option<Given>) {
        match self {
            Self::ByGyroscope(it) => it.begin_from(given),
            Self::Windowed(windowed) => windowed.begin_from(given.map(|given| given.calibration)),
        }
    }

    /// One sample that was checked, with what the other sensors said. Fills an `answer` that says nothing yet: it is large.
    pub fn push(&mut self, sample: &MagneticSample, paired: &PairedInertial, answer: &mut Answer) -> Status {
        match self {
            Self::ByGyroscope(it) => it.push(sample, paired, answer),
            Self::Windowed(windowed) => {
                let status;
                (status, *answer) = windowed.push(sample, paired.up_m_s2);
                status
            }
        }
    }

    /// A sample whose field is of no use.
    pub fn carry(&mut self, time_ns: i64, paired: &PairedInertial) -> Answer {
        if let Self::ByGyroscope(it) = self { it.carry(time_ns, paired) } else { Answer::default() }
    }

    /// Of the estimator that answers.
    pub fn known(&self) -> Known {
        match self {
            Self::ByGyroscope(it) => it.known(),
            Self::Windowed(windowed) => windowed.known(),
        }
    }

    /// The calibration in force, and how well it is known.
    pub fn in_force(&self) -> Option<Given> {
        match self {
            Self::ByGyroscope(it) => it.in_force(),
            Self::Windowed(windowed) => windowed.known().in_force(),
        }
    }

    /// Whether the calibration in force was learned from live samples.
    pub fn has_learned(&self) -> bool {
        match self {
            Self::ByGyroscope(it) => it.has_learned(),
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
            Self::ByGyroscope(it) => it.explain(),
            Self::Windowed(windowed) => windowed.explain(),
        }
    }

    /// Samples that it looks at.
    pub fn window(&self) -> usize {
        match self {
            Self::ByGyroscope(it) => it.window(),
            Self::Windowed(windowed) => windowed.counted().samples,
        }
    }

    /// What directions are counted over.
    pub fn counted(&self) -> Counted<'_> {
        match self {
            Self::ByGyroscope(it) => it.counted(),
            Self::Windowed(windowed) => windowed.counted(),
        }
    }
}
