//! Which directions a device has shown to the field, for guidance while calibrating: `cells` says when each was last seen, `guidance` keeps
//! that for a stream of samples.

mod cells;
mod guidance;
#[cfg(test)]
mod tests;

pub use cells::{CELLS, Coverage};
pub(crate) use guidance::{FEWEST_KEPT, Guidance};
