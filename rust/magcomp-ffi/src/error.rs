//! Everything that can go wrong at the border, each something a caller can act on.

use crate::status::{EventRejection, FitProblem, RejectReason};

/// What went wrong. `text()` says it in a sentence.
#[derive(Clone, Debug, PartialEq, uniffi::Error)]
pub enum MagcompError {
    /// A field of the config is outside its range.
    Config {
        /// Path of the field, for instance `windowed.n_min`.
        field: String,
        /// What it was.
        value: String,
        /// What it may be.
        expected: String,
    },
    /// A magnetometer sample was not used; nothing has changed.
    Rejected {
        /// Why.
        reason: RejectReason,
    },
    /// A gyroscope, accelerometer or gravity event was not used; nothing has changed.
    EventRejected {
        /// Why.
        reason: EventRejection,
    },
    /// There is no fit.
    Fit {
        /// What the samples lack.
        problem: FitProblem,
    },
    /// The numbers are no calibration.
    Calibration {
        /// Why, in a sentence.
        why: String,
    },
    /// A text is no kept calibration: cut, changed to something impossible, or not written by this library. Start without it.
    KeptDamaged {
        /// The first thing that is wrong.
        why: String,
    },
    /// A kept calibration was written by a newer version of this library. Update it or start without.
    KeptNewer {
        /// Version of the text.
        found: i64,
    },
    /// The geomagnetic model does not cover the place.
    Place {
        /// Which limit was passed, in a sentence.
        why: String,
    },
    /// The object was closed. Make a new one.
    Closed,
    /// A defect of this library: the object refuses further use until `reset()`. Please report it.
    Panicked {
        /// What the panic said.
        what: String,
    },
}

#[uniffi::export]
impl MagcompError {
    /// One sentence for a log or a developer.
    pub fn text(&self) -> String {
        self.to_string()
    }
}

impl std::fmt::Display for MagcompError {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Config { field, value, expected } => write!(f, "config: {field} is {value}, expected {expected}"),
            Self::Rejected { reason } => magcomp::RejectReason::from(*reason).fmt(f),
            Self::EventRejected { reason } => magcomp::EventRejection::from(*reason).fmt(f),
            Self::Fit { problem } => magcomp::FitError::from(*problem).fmt(f),
            Self::Calibration { why } | Self::Place { why } => f.write_str(why),
            Self::KeptDamaged { why } => magcomp::KeptError::Damaged { why: why.clone() }.fmt(f),
            Self::KeptNewer { found } => {
                magcomp::KeptError::Newer { found: u32::try_from(*found).unwrap_or(u32::MAX) }.fmt(f)
            }
            Self::Closed => f.write_str("used after it was closed; make a new one"),
            Self::Panicked { what } => write!(f, "a defect of magcomp ({what}); call reset() to go on, and report it"),
        }
    }
}

impl std::error::Error for MagcompError {}

impl From<magcomp::ConfigError> for MagcompError {
    fn from(e: magcomp::ConfigError) -> Self {
        Self::Config { field: e.field.to_owned(), value: e.value, expected: e.expected }
    }
}

impl From<magcomp::RejectReason> for MagcompError {
    fn from(reason: magcomp::RejectReason) -> Self {
        Self::Rejected { reason: reason.into() }
    }
}

impl From<magcomp::EventRejection> for MagcompError {
    fn from(reason: magcomp::EventRejection) -> Self {
        Self::EventRejected { reason: reason.into() }
    }
}

impl From<magcomp::FitError> for MagcompError {
    fn from(problem: magcomp::FitError) -> Self {
        Self::Fit { problem: problem.into() }
    }
}

impl From<magcomp::CalibrationError> for MagcompError {
    fn from(e: magcomp::CalibrationError) -> Self {
        Self::Calibration { why: e.to_string() }
    }
}

impl From<magcomp::KeptError> for MagcompError {
    fn from(e: magcomp::KeptError) -> Self {
        match e {
            magcomp::KeptError::Damaged { why } => Self::KeptDamaged { why },
            magcomp::KeptError::Newer { found } => Self::KeptNewer { found: found.into() },
        }
    }
}

impl From<world_magnetic_model::Error> for MagcompError {
    fn from(e: world_magnetic_model::Error) -> Self {
        Self::Place { why: e.to_string() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The other facts are the core's own: `tests/host/facts.rs`.
    #[test]
    fn the_borders_own_errors_are_those_of_the_facts_every_language_asserts() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../tests/vectors/facts.json");
        let facts: serde_json::Value = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
        let said = |name| {
            let errors = facts["border_errors"].as_array().unwrap();
            errors.iter().find(|error| error["name"] == name).and_then(|error| error["text"].as_str()).unwrap()
        };
        assert_eq!(MagcompError::Closed.to_string(), said("Closed"));
        assert_eq!(MagcompError::Panicked { what: "why".to_owned() }.to_string(), said("Panicked"));
    }
}
