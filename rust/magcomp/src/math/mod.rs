//! Plain mathematics, which knows nothing of magnetometers.

pub(crate) mod descend;
pub(crate) mod elementary;
pub(crate) mod gaussian;
pub(crate) mod ldl;
pub(crate) mod symmetric;
pub(crate) mod turn;
