//! The estimators behind one `push`.

pub(crate) mod windowed;
