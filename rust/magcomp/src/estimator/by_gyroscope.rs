//! Our two estimators, where a method has both, and which of them answers: with a gyroscope the aided one, without one the adaptive one, and of both while
//! a start tries them the one that knows more. Each begins anew in memory that was taken once.
//!
//! A gyroscope that is contradicted, as the other two witnesses have it (`compensator`), is tried beside the magnetometer alone, until it no longer is.

use super::adaptive::Adaptive;
use super::aided::Aided;
use super::answer::{Answer, Counted, Known};
use super::figures::Figures;
use crate::calibration::Given;
use crate::config::WindowedConfig;
use crate::explanation::Explanation;
use crate::priors::SETTLED_S;
use crate::reading::Status;
use crate::sample::MagneticSample;
use crate::sensing::pairing::PairedInertial;
use alloc::boxed::Box;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// The estimators that a method has, each as new while it has no samples.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) enum Own {
    /// `Method::Auto`.
    Both(Box<Aided>, Box<Adaptive>),
    /// `Method::Aided`: without a gyroscope it keeps its calibration.
    Aided(Box<Aided>),
    /// `Method::Adaptive`.
    Adaptive(Box<Adaptive>),
}

#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct ByGyroscope {
    own: Own,
    gyroscope: Gyroscope,
    /// What the aided one alone began from, until it is in use: what it makes of a gyroscope that reads nonsense does not count.
    given: Option<Given>,
    /// The other sensors do not turn as the gyroscope says.
    is_contradicted: bool,
    figures: Figures,
}

/// While it is there: samples go to the aided estimator.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
enum Gyroscope {
    Absent,
    /// It has led to no first calibration yet: samples go to both once it has broken off, since one that stutters never does, or while it is contradicted.
    Tried,
    InUse,
}

impl ByGyroscope {
    /// Begins without a gyroscope. All memory is taken here.
    pub fn new(own: Own, windowed: WindowedConfig) -> Self {
        Self { own, gyroscope: Gyroscope::Absent, given: None, is_contradicted: false, figures: Figures::new(windowed) }
    }

    pub fn restart(&mut self) {
        self.begin_anew(None);
        self.figures.restart();
    }

    /// Begins with what is given, without a gyroscope: the aided one takes over with the next rotation.
    pub fn begin_from(&mut self, given: Option<Given>) {
        self.begin_anew(given);
        self.figures.look_through(given.map(|given| given.calibration));
    }

    fn begin_anew(&mut self, given: Option<Given>) {
        self.gyroscope = Gyroscope::Absent;
        self.given = given.filter(|_| matches!(self.own, Own::Aided(_)));
        match &mut self.own {
            Own::Both(aided, adaptive) => {
                aided.restart(None);
                adaptive.restart(given);
            }
            Own::Aided(aided) => aided.restart(given),
            Own::Adaptive(adaptive) => adaptive.restart(given),
        }
    }

    /// The gyroscope is there now, or no longer, and whether it is contradicted. Returns true where a rotation is of no use: the estimator changes, and the
    /// new one starts from the calibration in force, widened by `given`; or there is but one, and no gyroscope for it.
    pub fn follow_gyroscope(
        &mut self,
        is_there: bool,
        is_contradicted: bool,
        given: impl FnOnce(Given) -> Given,
    ) -> bool {
        if matches!(self.own, Own::Adaptive(_)) {
            return false;
        }
        let was_contradicted = core::mem::replace(&mut self.is_contradicted, is_contradicted);
        let (is_in_use, is_alone) = (self.gyroscope == Gyroscope::InUse, matches!(self.own, Own::Aided(_)));
        let is_refuted = is_contradicted && (is_in_use || is_alone && !was_contradicted);
        if is_there == self.carries() && !is_refuted {
            return is_alone && (is_contradicted || !is_there);
        }
        let given = if is_alone && !is_in_use { self.given } else { self.in_force() }.map(given);
        self.gyroscope = if is_there { Gyroscope::Tried } else { Gyroscope::Absent };
        match &mut self.own {
            Own::Both(aided, adaptive) => {
                if is_in_use {
                    adaptive.restart(given);
                }
                aided.restart(given.filter(|_| is_there));
            }
            Own::Aided(aided) => {
                self.given = given;
                // a filter waits for the gyroscope, and is the less sure the longer
                if is_refuted || !aided.has_learned() {
                    aided.restart(given);
                }
            }
            Own::Adaptive(_) => {}
        }
        true
    }

    pub fn push(&mut self, sample: &MagneticSample, paired: &PairedInertial, answer: &mut Answer) -> Status {
        let MagneticSample { time_ns, field_ut: raw_ut } = *sample;
        let (gyroscope, is_contradicted) = (self.gyroscope, self.is_contradicted);
        let mut status;
        match &mut self.own {
            Own::Aided(aided) => status = aided.push(time_ns, raw_ut, paired, answer),
            Own::Both(aided, adaptive) if gyroscope != Gyroscope::Absent => {
                status = aided.push(time_ns, raw_ut, paired, answer);
                if gyroscope == Gyroscope::Tried && is_doubted(aided, is_contradicted) {
                    let other = adaptive.push(time_ns, &raw_ut, paired.up_m_s2);
                    if !knows_more(aided, adaptive, is_contradicted) {
                        let carry = answer.carry.filter(|_| !is_contradicted);
                        (status, *answer) = (other.0, Answer { carry, ..other.1 });
                    }
                }
            }
            Own::Both(_, adaptive) | Own::Adaptive(adaptive) => {
                (status, *answer) = adaptive.push(time_ns, &raw_ut, paired.up_m_s2);
            }
        }
        if gyroscope == Gyroscope::Tried && !is_contradicted && self.aided().is_some_and(Aided::has_learned) {
            (self.gyroscope, self.given) = (Gyroscope::InUse, None);
        }
        let known = self.figures.is_due(sample.time_ns).then(|| self.known());
        self.figures.finish(answer, sample, known);
        answer.window = self.window();
        status
    }

    /// Whether there is a gyroscope that carries on where the field points.
    pub fn carries(&self) -> bool {
        self.gyroscope != Gyroscope::Absent
    }

    /// The aided one, while there is a gyroscope.
    fn aided(&self) -> Option<&Aided> {
        match &self.own {
            Own::Both(aided, _) | Own::Aided(aided) if self.carries() => Some(aided),
            _ => None,
        }
    }

    /// A sample whose field is of no use: the gyroscope carries on where it points. The magnetometer alone has nothing to say.
    pub fn carry(&mut self, time_ns: i64, paired: &PairedInertial) -> Answer {
        match &mut self.own {
            Own::Both(aided, _) | Own::Aided(aided) if self.gyroscope != Gyroscope::Absent => {
                aided.carry(time_ns, paired)
            }
            _ => Answer::default(),
        }
    }

    pub fn window(&self) -> usize {
        match &self.own {
            Own::Both(_, adaptive) | Own::Adaptive(adaptive) if !self.carries() => adaptive.window(),
            _ => self.counted().samples,
        }
    }

    pub fn counted(&self) -> Counted<'_> {
        self.figures.counted()
    }

    /// The one that answers.
    fn answering(&self) -> Result<&Aided, &Adaptive> {
        let (aided, adaptive) = match &self.own {
            Own::Aided(aided) => return Ok(aided),
            Own::Adaptive(adaptive) => return Err(adaptive),
            Own::Both(aided, adaptive) => (aided, adaptive),
        };
        match self.gyroscope {
            Gyroscope::InUse => Ok(aided),
            Gyroscope::Tried if knows_more(aided, adaptive, self.is_contradicted) => Ok(aided),
            _ => Err(adaptive),
        }
    }

    /// What was given, while no sample has come.
    fn untouched(&self) -> Option<Given> {
        match self.answering() {
            Ok(aided) => self.given.filter(|_| aided.is_untouched()),
            Err(adaptive) => adaptive.untouched().filter(|_| !self.carries()),
        }
    }

    /// What the one that answers knows.
    pub fn known(&self) -> Known {
        if let Some(given) = self.untouched() {
            return Known { calibration: Some(given.calibration), covariance: None };
        }
        match self.answering() {
            Ok(aided) => Known { calibration: aided.calibration(), covariance: aided.covariance() },
            Err(adaptive) => Known { calibration: adaptive.calibration(), covariance: adaptive.covariance() },
        }
    }

    /// The calibration in force; what was given, while no sample has come.
    pub fn in_force(&self) -> Option<Given> {
        self.untouched().or_else(|| self.known().in_force())
    }

    pub fn has_learned(&self) -> bool {
        self.answering().map_or_else(Adaptive::has_learned, Aided::has_learned)
    }

    pub fn explain(&self) -> Explanation {
        let doubts = |aided| self.gyroscope == Gyroscope::Tried && is_doubted(aided, self.is_contradicted);
        let tries_both = matches!(&self.own, Own::Both(aided, _) if doubts(aided));
        Explanation { tries_both, ..self.answering().map_or_else(Adaptive::explain, Aided::explain) }
    }

    /// Bias of the gyroscope, rad/s, and its scale error, while it is there: true rate = (I - scale) reading - bias.
    pub fn gyroscope(&self) -> Option<(Vector3<f64>, Matrix3<f64>)> {
        self.aided().map(Aided::gyroscope)
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
