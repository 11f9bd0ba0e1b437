//! Tests of the aided estimator that look inside it.

mod filter;
mod jacobians;
mod magnitude;
mod robustness;
mod simulator;
mod steps;
