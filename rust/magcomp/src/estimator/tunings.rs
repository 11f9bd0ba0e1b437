//! The choices of our estimators together, for `magcomp sensitivity`.

use super::{adaptive, aided};
use crate::tuning::{Choice, Mechanism};

/// The choices of every estimator.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tunings {
    pub(crate) adaptive: adaptive::Tuning,
    pub(crate) aided: aided::Tuning,
}

impl Tunings {
    /// Every choice, with the estimator that makes it.
    pub fn list() -> impl Iterator<Item = (&'static str, &'static Choice)> {
        let adaptive = adaptive::Tuning::LIST.iter().map(|choice| ("adaptive", choice));
        adaptive.chain(aided::Tuning::LIST.iter().map(|choice| ("aided", choice)))
    }

    /// Every mechanism that can be switched off, with its estimator.
    pub fn mechanisms() -> impl Iterator<Item = (&'static str, &'static Mechanism)> {
        let adaptive = adaptive::Tuning::MECHANISMS.iter().map(|it| ("adaptive", it));
        adaptive.chain(aided::Tuning::MECHANISMS.iter().map(|it| ("aided", it)))
    }

    /// Switches a mechanism off; whether there is one of that name.
    pub fn switch_off(&mut self, estimator: &str, name: &str) -> bool {
        match estimator {
            "adaptive" => self.adaptive.switch_off(name),
            "aided" => self.aided.switch_off(name),
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
