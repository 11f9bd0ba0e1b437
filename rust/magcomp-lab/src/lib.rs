//! The lab of magcomp: simulator, Cramer-Rao bound, the paper's experiments, rivals, and the command `magcomp`, which is a thin shell over these modules
//! and over the crate `magcomp-replay`, which plays recordings, judges them and shows results.
//!
//! The arrows point one way: `random`, `parameters`, `course`, `motion`, `surroundings`, `inertial` make up `simulate`, whose
//! streams `catalogue` names and `score` judges; these and `crb` feed `experiment`; `trials` plays folders of recordings.

pub mod baseline;
pub mod catalogue;
pub mod command;
pub mod course;
pub mod crb;
pub mod experiment;
pub mod inertial;
mod magnetometer;
pub mod motion;
pub mod parallel;
pub mod parameters;
pub mod random;
pub mod score;
mod sensitivity;
pub mod simulate;
mod surroundings;
pub mod trials;
