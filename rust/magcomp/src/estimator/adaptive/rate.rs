//! How fast b moves, where a hypothesis says that it does: a first-order Markov process r beside the state, whose integral b is.
//!
//! ```text
//! r <- phi r + w,   b <- b + T (1 - phi) r + v,   phi = exp(-dt / T):     w, v of variances and covariance
//! s^2 (1 - phi^2),   s^2 T (2 dt - T (3 - 4 phi + phi^2)),   s^2 T (1 - phi)^2                  (Singer 1970)
//! ```
//! It stands beside the state, and not in it, so that only a hypothesis whose b moves pays for it.

#[cfg(test)]
mod tests;

use super::parameters::{Numbers, STATES};
use crate::math::elementary::exp;
use crate::noise::Process;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, SMatrix, Vector3};

/// Units a second; zero and sure where b rests.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Rate<const N: usize = STATES> {
    pub mean: Vector3<f64>,
    /// Covariance with the state.
    pub with: SMatrix<f64, N, 3>,
    pub own: Matrix3<f64>,
}

impl<const N: usize> Default for Rate<N> {
    fn default() -> Self {
        Self { mean: Vector3::zeros(), with: SMatrix::zeros(), own: Matrix3::zeros() }
    }
}

impl<const N: usize> Rate<N> {
    /// Nothing is known of it but what is usual.
    pub fn new(rates: Process) -> Self {
        Self { own: Matrix3::from_diagonal_element(rates.size * rates.size), ..Self::default() }
    }

    /// After a miss of the state with derivative g, nu with variance s; pg: the state's covariance times g.
    pub fn update(&mut self, nu: f64, s: f64, g: &Numbers<N>, pg: &Numbers<N>) {
        let by = self.with.transpose() * g;
        self.mean -= by * (nu / s);
        self.with -= pg * (by / s).transpose();
        self.own -= by * (by / s).transpose();
    }
}

/// What a time makes of a rate and its integral.
pub(super) struct Over {
    /// What is left of the rate.
    pub phi: f64,
    /// The integral of a rate of one.
    pub by: f64,
    /// New variances and covariance: of the rate, of both, of the integral.
    pub own: f64,
    pub with: f64,
    pub walked: f64,
}

impl Over {
    pub fn new(rates: Process, seconds: f64) -> Self {
        let (variance, lasts_s) = (rates.size * rates.size, rates.lasts_s);
        let phi = exp(-seconds / lasts_s);
        Self {
            phi,
            by: lasts_s * (1.0 - phi),
            own: variance * (1.0 - phi * phi),
            with: variance * lasts_s * (1.0 - phi).powi(2),
            walked: variance * lasts_s * (2.0 * seconds - lasts_s * (1.0 - phi) * (3.0 - phi)),
        }
    }
}
