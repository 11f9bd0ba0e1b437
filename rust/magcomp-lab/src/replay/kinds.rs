//! A figure of the raw, the system's and the compensated field, side by side.

use serde::Serialize;

/// A figure of each field, on the rows that have a corrected one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Kinds<T> {
    /// As recorded.
    pub raw: Option<T>,
    /// As the operating system calibrated it; none where it was not recorded.
    pub system: Option<T>,
    /// The corrected sample.
    pub compensated: Option<T>,
}

impl<T> Kinds<T> {
    /// The same of what `of` makes of each.
    pub fn map<U>(self, of: impl Fn(T) -> U) -> Kinds<U> {
        Kinds { raw: self.raw.map(&of), system: self.system.map(&of), compensated: self.compensated.map(&of) }
    }
}
