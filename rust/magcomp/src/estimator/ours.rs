//! Our two estimators, and which of them answers: with a gyroscope the aided one, without one the adaptive one, and of both while a start
//! tries them the one that knows more. Another takes the place of the one before in the same memory.

use super::Tunings;
use super::adaptive::Adaptive;
use super::aided::Aided;
use super::answer::{Answer, Counted};
use super::figures::{Figures, InForce};
use super::paper::WindowedConfig;
use crate::calibration::{Calibration, Given};
use crate::explanation::Explanation;
use crate::reading::Status;
use crate::sample::MagneticSample;
use crate::sensing::pairing::PairedInertial;
use crate::tuning::choices;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// See the module.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Ours {
    tunings: Tunings,
    strength_ut: Option<f64>,
    pair: Pair,
    figures: Figures,
}

#[derive(Clone, Debug, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "it is overwritten in place: a box in each would allocate")]
enum Pair {
    Aided(Aided),
    Adaptive(Adaptive),
    /// The gyroscope is there, and has not led to a first calibration yet: one that stutters never does.
    Starting(Aided, Adaptive),
}

/// The one of a pair that answers.
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
    /// What it reads explains nothing.
    pub is_useless: bool,
}

impl Ours {
    /// Begins with the one that needs no gyroscope. All memory is taken here.
    pub fn new(tunings: Tunings, strength_ut: Option<f64>, windowed: WindowedConfig) -> Self {
        let pair = Pair::Adaptive(Adaptive::new(tunings.adaptive, strength_ut, None));
        Self { tunings, strength_ut, pair, figures: Figures::new(windowed) }
    }

    /// As new, in the memory that is there.
    pub fn restart(&mut self) {
        self.pair = Pair::Adaptive(Adaptive::new(self.tunings.adaptive, self.strength_ut, None));
        self.figures.restart();
    }

    /// Begins with what is given, without a gyroscope: the aided one takes over with the next rotation.
    pub fn begin_from(&mut self, given: Option<Given>) {
        self.pair = Pair::Adaptive(Adaptive::new(self.tunings.adaptive, self.strength_ut, given));
        self.figures.look_through(given.map(|given| given.calibration));
    }

    /// The gyroscope is usable now (or no longer): whether it is another estimator's turn. One that comes begins from `given`.
    pub fn follow_gyroscope(&mut self, is_usable: bool, given: impl FnOnce(&Self) -> Option<Given>) -> bool {
        self.pair = match (&self.pair, is_usable) {
            (Pair::Adaptive(adaptive), true) => {
                let mut aided = Aided::new(self.tunings.aided, self.strength_ut);
                if let Some(given) = given(self) {
                    aided.begin_from(&given);
                }
                Pair::Starting(aided, adaptive.clone())
            }
            (Pair::Starting(_, adaptive), false) => Pair::Adaptive(adaptive.clone()),
            (Pair::Aided(_), false) => {
                Pair::Adaptive(Adaptive::new(self.tunings.adaptive, self.strength_ut, given(self)))
            }
            _ => return false,
        };
        true
    }

    /// One sample that was checked, with what the other sensors said.
    pub fn push(&mut self, sample: &MagneticSample, paired: &PairedInertial) -> (Status, Answer) {
        let MagneticSample { time_ns, field_ut: raw_ut } = *sample;
        let (status, answer) = match &mut self.pair {
            Pair::Aided(aided) => aided.push(time_ns, raw_ut, paired),
            Pair::Adaptive(adaptive) => adaptive.push(time_ns, &raw_ut, paired.up_m_s2),
            Pair::Starting(aided, adaptive) => {
                let told = aided.push(time_ns, raw_ut, paired);
                let other = adaptive.push(time_ns, &raw_ut, paired.up_m_s2);
                if knows_more(aided, adaptive) { told } else { other }
            }
        };
        if let Pair::Starting(aided, _) = &self.pair
            && aided.has_learned()
        {
            self.pair = Pair::Aided(aided.clone());
        }
        let pair = &self.pair;
        let answer = self.figures.finish(answer, &raw_ut, || match pair.speaker() {
            Speaker::Aided(it) => InForce { calibration: it.calibration(), covariance: it.covariance() },
            Speaker::Adaptive(it) => InForce { calibration: it.calibration(), covariance: it.covariance() },
        });
        (status, Answer { window: self.window(), ..answer })
    }

    /// Samples that the estimator looks at.
    pub fn window(&self) -> usize {
        match &self.pair {
            Pair::Adaptive(adaptive) => adaptive.window(),
            Pair::Aided(_) | Pair::Starting(..) => self.counted().samples,
        }
    }

    pub fn counted(&self) -> Counted {
        self.figures.counted()
    }

    pub fn calibration(&self) -> Option<Calibration> {
        match self.pair.speaker() {
            Speaker::Aided(aided) => aided.calibration(),
            Speaker::Adaptive(adaptive) => adaptive.calibration(),
        }
    }

    pub fn covariance(&self) -> Option<SMatrix<f64, 9, 9>> {
        match self.pair.speaker() {
            Speaker::Aided(aided) => aided.covariance(),
            Speaker::Adaptive(adaptive) => adaptive.covariance(),
        }
    }

    /// What was given, while no sample has come.
    pub fn untouched(&self) -> Option<Given> {
        if let Pair::Adaptive(adaptive) = &self.pair { adaptive.untouched() } else { None }
    }

    /// Whether the calibration in force was learned from live samples.
    pub fn has_learned(&self) -> bool {
        match self.pair.speaker() {
            Speaker::Aided(aided) => aided.has_learned(),
            Speaker::Adaptive(adaptive) => adaptive.has_learned(),
        }
    }

    /// The inside of the estimator that answers.
    pub fn explain(&self) -> Explanation {
        let tries_both = matches!(self.pair, Pair::Starting(..));
        let it = match self.pair.speaker() {
            Speaker::Aided(aided) => aided.explain(),
            Speaker::Adaptive(adaptive) => adaptive.explain(),
        };
        Explanation { tries_both, ..it }
    }

    /// Of the gyroscope, while it is in use.
    pub fn gyroscope(&self) -> Option<GyroscopeErrors> {
        let (Pair::Aided(aided) | Pair::Starting(aided, _)) = &self.pair else { return None };
        let (bias_rad_s, scale) = aided.gyroscope();
        Some(GyroscopeErrors { bias_rad_s, scale, is_useless: aided.is_gyroscope_useless() })
    }
}

impl Pair {
    fn speaker(&self) -> Speaker<'_> {
        match self {
            Self::Starting(aided, adaptive) if !knows_more(aided, adaptive) => Speaker::Adaptive(adaptive),
            Self::Aided(aided) | Self::Starting(aided, _) => Speaker::Aided(aided),
            Self::Adaptive(adaptive) => Speaker::Adaptive(adaptive),
        }
    }
}

choices! {
    /// The choices.
    Tuning {
        /// Rotations without a break for so long after one lead to a first calibration wherever the place allows one
        chain_s: 5.0, "s", "rust/magcomp-lab/tests/streams.rs";
    }
}

/// Which of the two of a start answers: the one with the gyroscope, unless that keeps breaking off and the other one alone knows a calibration,
/// or has learned b better.
fn knows_more(aided: &Aided, adaptive: &Adaptive) -> bool {
    if !aided.broke_within(Tuning::USED.chain_s) {
        return true;
    }
    let of_b = |p: SMatrix<f64, 9, 9>| p.fixed_view::<3, 3>(0, 0).trace();
    match (aided.covariance().map(of_b), adaptive.covariance().map(of_b)) {
        (Some(ours), Some(theirs)) => !adaptive.has_learned() || ours <= theirs,
        (None, Some(_)) => false,
        (_, None) => true,
    }
}
