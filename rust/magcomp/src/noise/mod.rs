//! What a magnetometer's samples miss a calibrated field by, learned from the misses: white noise (`level`), an error that lasts (`markov`), and
//! what a stay tells (`stay`). Nothing here knows a gyroscope or an estimator; units are those of the misses.

#[cfg(test)]
mod tests;

mod level;
mod markov;
mod memory;
mod stay;

pub(crate) use level::MeanSquare;
pub(crate) use markov::{Lasting, Markov, Process};
pub(crate) use stay::Stays;
