//! Our two estimators, and which of them answers: with a gyroscope the aided one, without one the adaptive one, and of both while a start
//! tries them the one that knows more. Each begins anew in memory that was taken once.
//!
//! A gyroscope that is contradicted, as the other two witnesses have it (`compensator`), is tried beside the magnetometer alone, until it no longer is.

use super::EstimatorTunings;
use super::adaptive::Adaptive;
use super::aided::Aided;
use super::answer::{Answer, Counted};
use super::figures::{Figures, InForce};
use super::paper::WindowedConfig;
use crate::calibration::{Calibration, Given};
use crate::explanation::Explanation;
use crate::priors::SETTLED_S;
use crate::reading::Status;
use crate::sample::MagneticSample;
use crate::sensing::pairing::PairedInertial;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// See the module.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Ours {
    tunings: EstimatorTunings,
    strength_ut: Option<f64>,
    adaptive: Adaptive,
    gyroscope: Gyroscope,
    /// The other sensors do not turn as the gyroscope says.
    is_contradicted: bool,
    figures: Figures,
}

/// Which estimators a sample goes to.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
enum Gyroscope {
    /// To the adaptive one.
    Missing,
    /// To the aided one: the gyroscope has not led to a first calibration yet. To both once it has broken off, since one that stutters never does, or
    /// while it is contradicted.
    Starting(Aided),
    /// To the aided one.
    InUse(Aided),
}

/// The one that answers.
enum Speaker<'a> {
    Aided(&'a Aided),
    Adaptive(&'a Adaptive),
}

/// What is known of the gyroscope.
pub(crate) struct GyroscopeErrors {
    /// rad/s.
    pub bias_rad_s: Vector3<f64>,
    /// True rate = (I - scale) reading - bias.
    pub scale: Matrix3<f64>,
}

impl Ours {
    /// Begins with the one that needs no gyroscope. All memory is taken here.
    pub fn new(tunings: EstimatorTunings, strength_ut: Option<f64>, windowed: WindowedConfig) -> Self {
        let adaptive = Adaptive::new(tunings.adaptive, strength_ut, None);
        let figures = Figures::new(windowed);
        Self { tunings, strength_ut, adaptive, gyroscope: Gyroscope::Missing, is_contradicted: false, figures }
    }

    /// As new, in the memory that is there.
    pub fn restart(&mut self) {
        self.gyroscope = Gyroscope::Missing;
        self.adaptive.restart(None);
        self.figures.restart();
    }

    /// Begins with what is given, without a gyroscope: the aided one takes over with the next rotation.
    pub fn begin_from(&mut self, given: Option<Given>) {
        self.gyroscope = Gyroscope::Missing;
        self.adaptive.restart(given);
        self.figures.look_through(given.map(|given| given.calibration));
    }

    /// The gyroscope is there now (or no longer), and whether it is contradicted: whether it is another estimator's turn. One that comes begins from `given`.
    pub fn follow_gyroscope(
        &mut self,
        is_there: bool,
        is_contradicted: bool,
        given: impl FnOnce(&Self) -> Option<Given>,
    ) -> bool {
        self.is_contradicted = is_contradicted;
        self.gyroscope = match (&self.gyroscope, is_there) {
            (Gyroscope::Missing, true) => self.begin_aided(given(self)),
            (Gyroscope::InUse(_), true) if is_contradicted => {
                let given = given(self);
                self.adaptive.restart(given);
                self.begin_aided(given)
            }
            (Gyroscope::Starting(_), false) => Gyroscope::Missing,
            (Gyroscope::InUse(_), false) => {
                let given = given(self);
                self.adaptive.restart(given);
                Gyroscope::Missing
            }
            _ => return false,
        };
        true
    }

    fn begin_aided(&self, given: Option<Given>) -> Gyroscope {
        let mut aided = Aided::new(self.tunings.aided, self.strength_ut);
        if let Some(given) = given {
            aided.begin_from(&given);
        }
        Gyroscope::Starting(aided)
    }

    /// One sample that was checked, with what the other sensors said.
    pub fn push(&mut self, sample: &MagneticSample, paired: &PairedInertial) -> (Status, Answer) {
        let MagneticSample { time_ns, field_ut: raw_ut } = *sample;
        let adaptive = &mut self.adaptive;
        let (status, mut answer) = match &mut self.gyroscope {
            Gyroscope::InUse(aided) => aided.push(time_ns, raw_ut, paired),
            Gyroscope::Missing => adaptive.push(time_ns, &raw_ut, paired.up_m_s2),
            Gyroscope::Starting(aided) => {
                let told = aided.push(time_ns, raw_ut, paired);
                let is_doubted = is_doubted(aided, self.is_contradicted);
                let other = is_doubted.then(|| adaptive.push(time_ns, &raw_ut, paired.up_m_s2));
                match other {
                    Some(mut other) if !knows_more(aided, adaptive, self.is_contradicted) => {
                        other.1.carry = told.1.carry.filter(|_| !self.is_contradicted);
                        other
                    }
                    _ => told,
                }
            }
        };
        if let Gyroscope::Starting(aided) = &self.gyroscope
            && aided.has_learned()
            && !self.is_contradicted
        {
            self.gyroscope = Gyroscope::InUse(aided.clone());
        }
        let speaker = self.gyroscope.speaker(&self.adaptive, self.is_contradicted);
        self.figures.finish(&mut answer, sample, || match speaker {
            Speaker::Aided(it) => InForce { calibration: it.calibration(), covariance: it.covariance() },
            Speaker::Adaptive(it) => InForce { calibration: it.calibration(), covariance: it.covariance() },
        });
        answer.window = self.window();
        (status, answer)
    }

    pub fn carries(&self) -> bool {
        !matches!(self.gyroscope, Gyroscope::Missing)
    }

    /// A sample whose field is of no use: the gyroscope carries on where it points. The magnetometer alone has nothing to say.
    pub fn carry(&mut self, time_ns: i64, paired: &PairedInertial) -> Answer {
        match &mut self.gyroscope {
            Gyroscope::InUse(aided) | Gyroscope::Starting(aided) => aided.carry(time_ns, paired),
            Gyroscope::Missing => Answer::default(),
        }
    }

    fn speaker(&self) -> Speaker<'_> {
        self.gyroscope.speaker(&self.adaptive, self.is_contradicted)
    }

    /// Samples that the estimator looks at.
    pub fn window(&self) -> usize {
        if matches!(self.gyroscope, Gyroscope::Missing) { self.adaptive.window() } else { self.counted().samples }
    }

    pub fn counted(&self) -> Counted<'_> {
        self.figures.counted()
    }

    pub fn calibration(&self) -> Option<Calibration> {
        match self.speaker() {
            Speaker::Aided(aided) => aided.calibration(),
            Speaker::Adaptive(adaptive) => adaptive.calibration(),
        }
    }

    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        match self.speaker() {
            Speaker::Aided(aided) => aided.covariance(),
            Speaker::Adaptive(adaptive) => adaptive.covariance(),
        }
    }

    /// What was given, while no sample has come.
    pub fn untouched(&self) -> Option<Given> {
        self.adaptive.untouched().filter(|_| matches!(self.gyroscope, Gyroscope::Missing))
    }

    /// Whether the calibration in force was learned from live samples.
    pub fn has_learned(&self) -> bool {
        match self.speaker() {
            Speaker::Aided(aided) => aided.has_learned(),
            Speaker::Adaptive(adaptive) => adaptive.has_learned(),
        }
    }

    /// The inside of the estimator that answers.
    pub fn explain(&self) -> Explanation {
        let tries_both =
            matches!(&self.gyroscope, Gyroscope::Starting(aided) if is_doubted(aided, self.is_contradicted));
        let it = match self.speaker() {
            Speaker::Aided(aided) => aided.explain(),
            Speaker::Adaptive(adaptive) => adaptive.explain(),
        };
        Explanation { tries_both, ..it }
    }

    /// Of the gyroscope, while it is in use.
    pub fn gyroscope(&self) -> Option<GyroscopeErrors> {
        let (Gyroscope::InUse(aided) | Gyroscope::Starting(aided)) = &self.gyroscope else { return None };
        let (bias_rad_s, scale) = aided.gyroscope();
        Some(GyroscopeErrors { bias_rad_s, scale })
    }
}

impl Gyroscope {
    fn speaker<'a>(&'a self, adaptive: &'a Adaptive, is_contradicted: bool) -> Speaker<'a> {
        match self {
            Self::Starting(aided) if !knows_more(aided, adaptive, is_contradicted) => Speaker::Adaptive(adaptive),
            Self::InUse(aided) | Self::Starting(aided) => Speaker::Aided(aided),
            Self::Missing => Speaker::Adaptive(adaptive),
        }
    }
}

/// Whether the magnetometer alone is tried beside a gyroscope that is contradicted, or that keeps breaking off.
fn is_doubted(aided: &Aided, is_contradicted: bool) -> bool {
    is_contradicted || aided.broke_within(SETTLED_S)
}

/// Which of the two of a start answers: the one with the gyroscope, unless that is contradicted, or it keeps breaking off and the other one alone
/// knows a calibration, or has learned b better.
fn knows_more(aided: &Aided, adaptive: &Adaptive, is_contradicted: bool) -> bool {
    if is_contradicted {
        return false;
    }
    if !is_doubted(aided, is_contradicted) {
        return true;
    }
    let of_b = |p: SMatrix<f64, 9, 9>| p.fixed_view::<3, 3>(0, 0).trace();
    match (aided.covariance().map(of_b), adaptive.covariance().map(of_b)) {
        (Some(ours), Some(theirs)) => !adaptive.has_learned() || ours <= theirs,
        (None, Some(_)) => false,
        (_, None) => true,
    }
}
