//! Tests of the aided estimator that look inside it.

mod filter;
mod jacobians;
mod magnets;
mod mechanisms;
mod motion;
mod probation;
mod robustness;
mod sigma;
mod simulator;
mod starts;
mod steps;
