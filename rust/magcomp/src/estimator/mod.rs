//! The estimators behind one `push`.

pub(crate) mod adaptive;
pub(crate) mod aided;
pub(crate) mod paper;
