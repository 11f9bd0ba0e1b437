//! The lab of magcomp: simulator, Cramer-Rao bound, the paper's experiments, replays, plots, and the command
//! `magcomp`, which is a thin shell over these modules.
//!
//! The arrows point one way: `random`, `parameters`, `course`, `motion`, `surroundings`, `inertial` make up `simulate`, whose
//! streams `catalogue` names and `score` judges; these and `crb` feed `experiment`; recordings and loggers' sessions
//! come from the crate `magcomp-recordings` and feed `replay`, which `trials` does for folders; `table`, `plot` and `report` show the results.
//! In a browser (`web/`) only what `replay` needs is there.

pub mod atomic;
pub mod baseline;
mod beside;
pub mod catalogue;
#[cfg(not(target_family = "wasm"))]
pub mod command;
pub mod course;
pub mod crb;
pub mod error;
#[cfg(not(target_family = "wasm"))]
pub mod experiment;
pub mod inertial;
mod magnetometer;
pub mod motion;
pub mod parallel;
pub mod parameters;
pub mod plot;
#[cfg(not(target_family = "wasm"))]
mod progress;
pub mod random;
pub mod replay;
pub mod report;
#[cfg(not(target_family = "wasm"))]
pub mod score;
#[cfg(not(target_family = "wasm"))]
mod sensitivity;
pub mod simulate;
pub mod statistics;
mod surroundings;
pub mod table;
#[cfg(not(target_family = "wasm"))]
pub mod trials;
