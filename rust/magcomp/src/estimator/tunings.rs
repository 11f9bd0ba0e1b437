//! The choices of our estimators together, for `magcomp sensitivity`.

use super::{adaptive, aided};
use crate::tuning::Choice;

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

    /// Sets a choice; whether there is one of that name.
    pub fn set(&mut self, estimator: &str, name: &str, value: f64) -> bool {
        match estimator {
            "adaptive" => self.adaptive.set(name, value),
            "aided" => self.aided.set(name, value),
            _ => false,
        }
    }
}
