//! Our two estimators, and which of them answers: with a gyroscope the aided one, without one the adaptive one, and of both while a start
//! tries them the one that knows more. Each begins anew in memory that was taken once.
//!
//! A gyroscope that is contradicted, as the other two witnesses have it (`compensator`), is tried beside the magnetometer alone, until it no longer is.

use super::adaptive::{self, Adaptive};
use super::aided::{self, Aided};
use super::answer::{Answer, Counted, Known};
use super::figures::Figures;
use crate::calibration::Given;
use crate::config::WindowedConfig;
use crate::explanation::Explanation;
use crate::priors::SETTLED_S;
use crate::reading::Status;
use crate::sample::MagneticSample;
use crate::sensing::pairing::PairedInertial;
use nalgebra::{Matrix3, SMatrix, Vector3};

#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct ByGyroscope {
    tuning: aided::Tuning,
    strength_ut: Option<f64>,
    adaptive: Adaptive,
    /// While it is there: samples go to the aided estimator.
    gyroscope: Option<Gyroscope>,
    /// The other sensors do not turn as the gyroscope says.
    is_contradicted: bool,
    figures: Figures,
}

#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
struct Gyroscope {
    aided: Aided,
    /// It has led to a first calibration. Before that, samples go to both once it has broken off, since one that stutters never does, or
    /// while it is contradicted.
    is_in_use: bool,
}

impl ByGyroscope {
    /// Begins with the one that needs no gyroscope. All memory is taken here.
    pub fn new(
        adaptive: adaptive::Tuning,
        tuning: aided::Tuning,
        strength_ut: Option<f64>,
        windowed: WindowedConfig,
    ) -> Self {
        let (adaptive, figures) = (Adaptive::new(adaptive, strength_ut, None), Figures::new(windowed));
        Self { tuning, strength_ut, adaptive, gyroscope: None, is_contradicted: false, figures }
    }

    pub fn restart(&mut self) {
        self.gyroscope = None;
        self.adaptive.restart(None);
        self.figures.restart();
    }

    /// Begins with what is given, without a gyroscope: the aided one takes over with the next rotation.
    pub fn begin_from(&mut self, given: Option<Given>) {
        self.gyroscope = None;
        self.adaptive.restart(given);
        self.figures.look_through(given.map(|given| given.calibration));
    }

    /// The gyroscope is there now, or no longer, and whether it is contradicted. Returns true where the estimator changes: the new one starts from the
    /// calibration in force, widened by `given`.
    pub fn follow_gyroscope(
        &mut self,
        is_there: bool,
        is_contradicted: bool,
        given: impl FnOnce(Given) -> Given,
    ) -> bool {
        self.is_contradicted = is_contradicted;
        let is_in_use = self.gyroscope.as_ref().map(|it| it.is_in_use);
        if is_there == is_in_use.is_some() && !(is_contradicted && is_in_use == Some(true)) {
            return false;
        }
        let given = self.in_force().map(given);
        if is_in_use == Some(true) {
            self.adaptive.restart(given);
        }
        self.gyroscope = is_there.then(|| {
            let mut aided = Aided::new(self.tuning, self.strength_ut);
            given.iter().for_each(|given| aided.begin_from(given));
            Gyroscope { aided, is_in_use: false }
        });
        true
    }

    pub fn push(&mut self, sample: &MagneticSample, paired: &PairedInertial) -> (Status, Answer) {
        let MagneticSample { time_ns, field_ut: raw_ut } = *sample;
        let (adaptive, is_contradicted) = (&mut self.adaptive, self.is_contradicted);
        let (status, mut answer) = match &mut self.gyroscope {
            None => adaptive.push(time_ns, &raw_ut, paired.up_m_s2),
            Some(Gyroscope { aided, is_in_use }) => {
                let mut told = aided.push(time_ns, raw_ut, paired);
                if !*is_in_use && is_doubted(aided, is_contradicted) {
                    let other = adaptive.push(time_ns, &raw_ut, paired.up_m_s2);
                    if !knows_more(aided, adaptive, is_contradicted) {
                        let carry = told.1.carry.filter(|_| !is_contradicted);
                        told = (other.0, Answer { carry, ..other.1 });
                    }
                }
                *is_in_use |= aided.has_learned() && !is_contradicted;
                told
            }
        };
        let known = self.figures.is_due(sample.time_ns).then(|| self.known());
        self.figures.finish(&mut answer, sample, known);
        answer.window = self.window();
        (status, answer)
    }

    /// Whether there is a gyroscope that carries on where the field points.
    pub fn carries(&self) -> bool {
        self.gyroscope.is_some()
    }

    /// A sample whose field is of no use: the gyroscope carries on where it points. The magnetometer alone has nothing to say.
    pub fn carry(&mut self, time_ns: i64, paired: &PairedInertial) -> Answer {
        self.gyroscope.as_mut().map_or_else(Answer::default, |it| it.aided.carry(time_ns, paired))
    }

    pub fn window(&self) -> usize {
        if self.carries() { self.counted().samples } else { self.adaptive.window() }
    }

    pub fn counted(&self) -> Counted<'_> {
        self.figures.counted()
    }

    /// The aided one, where it answers.
    fn answering(&self) -> Option<&Aided> {
        let Gyroscope { aided, is_in_use } = self.gyroscope.as_ref()?;
        (*is_in_use || knows_more(aided, &self.adaptive, self.is_contradicted)).then_some(aided)
    }

    /// What the one that answers knows.
    pub fn known(&self) -> Known {
        let adaptive = &self.adaptive;
        match self.answering() {
            Some(aided) => Known { calibration: aided.calibration(), covariance: aided.covariance() },
            None => Known { calibration: adaptive.calibration(), covariance: adaptive.covariance() },
        }
    }

    /// The calibration in force; what was given, while no sample has come.
    pub fn in_force(&self) -> Option<Given> {
        self.adaptive.untouched().filter(|_| !self.carries()).or_else(|| self.known().in_force())
    }

    pub fn has_learned(&self) -> bool {
        self.answering().map_or_else(|| self.adaptive.has_learned(), Aided::has_learned)
    }

    pub fn explain(&self) -> Explanation {
        let tries_both = |it: &Gyroscope| !it.is_in_use && is_doubted(&it.aided, self.is_contradicted);
        let tries_both = self.gyroscope.as_ref().is_some_and(tries_both);
        Explanation { tries_both, ..self.answering().map_or_else(|| self.adaptive.explain(), Aided::explain) }
    }

    /// Bias of the gyroscope, rad/s, and its scale error, while it is there: true rate = (I - scale) reading - bias.
    pub fn gyroscope(&self) -> Option<(Vector3<f64>, Matrix3<f64>)> {
        self.gyroscope.as_ref().map(|it| it.aided.gyroscope())
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
