//! How much a finding says, and where it goes.

use serde::Serialize;

/// How much a finding says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Weight {
    /// Worth knowing.
    Note,
    /// The result may be worse than it need be.
    Doubt,
    /// The result is wrong.
    Fault,
}

/// Takes a finding: its kind, how much it says, and the sentence.
pub(super) type Add<'a> = dyn FnMut(&'static str, Weight, String) + 'a;
