//! The choices and switches of all parts, by name, for `magcomp sensitivity`; and the estimator that they make.

use super::tuning::Tuning;
use crate::config::{Config, Method};
use crate::estimator::adaptive::{self, Adaptive};
use crate::estimator::aided::{self, Aided};
use crate::estimator::paper::Windowed;
use crate::estimator::{ByGyroscope, Estimator, Own};
use crate::sensing::witnesses;
use crate::tuning::{Choice, Mechanism};
use alloc::boxed::Box;

/// The choices of every estimator, and the switches of every part.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Tunings {
    pub(super) adaptive: adaptive::Tuning,
    pub(super) aided: aided::Tuning,
    pub(super) compensator: Tuning,
    pub(super) witnesses: witnesses::Tuning,
}

impl Tunings {
    /// The estimator of a validated config. All memory is taken here.
    pub(super) fn estimator(self, config: &Config) -> Estimator {
        let (windowed, strength_ut) = (config.windowed, config.field_strength_ut);
        let of_paper = |is_constant| Estimator::Windowed(Box::new(Windowed::new(is_constant, windowed, strength_ut)));
        let aided = || Box::new(Aided::new(self.aided, strength_ut));
        let adaptive = || Box::new(Adaptive::new(self.adaptive, strength_ut, None));
        let ours = |own| Estimator::ByGyroscope(Box::new(ByGyroscope::new(own, windowed)));
        match config.method {
            Method::Windowed => of_paper(false),
            Method::Constant => of_paper(true),
            Method::Auto => ours(Own::Both(aided(), adaptive())),
            Method::Aided => ours(Own::Aided(aided())),
            Method::Adaptive => ours(Own::Adaptive(adaptive())),
        }
    }

    /// Every choice of the estimators, with the one that makes it.
    pub fn list() -> impl Iterator<Item = (&'static str, &'static Choice)> {
        let adaptive = adaptive::Tuning::LIST.iter().map(|choice| ("adaptive", choice));
        adaptive.chain(aided::Tuning::LIST.iter().map(|choice| ("aided", choice)))
    }

    /// Every mechanism that can be switched off, with its part.
    pub fn mechanisms() -> impl Iterator<Item = (&'static str, &'static Mechanism)> {
        let of = |part: &'static str, all: &'static [Mechanism]| all.iter().map(move |it| (part, it));
        of("adaptive", adaptive::Tuning::MECHANISMS)
            .chain(of("aided", aided::Tuning::MECHANISMS))
            .chain(of("compensator", Tuning::MECHANISMS))
            .chain(of("witnesses", witnesses::Tuning::MECHANISMS))
    }

    /// Switches a mechanism off; whether there is one of that name.
    pub fn switch_off(&mut self, part: &str, name: &str) -> bool {
        match part {
            "adaptive" => self.adaptive.switch_off(name),
            "aided" => self.aided.switch_off(name),
            "compensator" => self.compensator.switch_off(name),
            "witnesses" => self.witnesses.switch_off(name),
            _ => false,
        }
    }

    /// Sets a choice; whether there is one of that name.
    pub fn set(&mut self, estimator: &str, name: &str, value: f64) -> bool {
        match estimator {
            "adaptive" => self.adaptive.set(name, value),
            "aided" => self.aided.set(name, value),
            _ => false,
        }
    }
}
