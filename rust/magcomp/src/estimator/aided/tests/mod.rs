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

use super::Aided;
use crate::estimator::answer::Answer;
use crate::reading::Status;
use crate::sensing::pairing::PairedInertial;
use nalgebra::Vector3;

impl Aided {
    /// What it says of a sample.
    fn told(&mut self, time_ns: i64, raw_ut: Vector3<f64>, inertial: &PairedInertial) -> (Status, Answer) {
        let mut answer = Answer::default();
        (self.push(time_ns, raw_ut, inertial, &mut answer), answer)
    }
}
