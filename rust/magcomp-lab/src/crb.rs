//! The Cramer-Rao bound of M and b from magnitudes alone (S. Kay, "Fundamentals of statistical signal processing:
//! estimation theory", ch. 3), in the paper's scale, |h| = 1: nine parameters.
//!
//! Sample n is Gaussian with covariance s^2 I about the mean of eq. (8), mu_n = M u_n + b. The direction u_n is not
//! known: two angles nu_n per sample are unknown too (nuisance). The Fisher information of a Gaussian mean is
//!     I = J^T J / s^2,   J = [d mu / d theta, d mu / d nu].
//! nu_n enters sample n alone, so it is eliminated sample by sample (Schur complement). There remains
//!     I_theta = sum_n  A_n^T (1 - P_n) A_n / s^2,   A_n = d mu_n / d theta (3 x 9),
//! with P_n the projection on the plane that the angles reach, spanned by M t for all t perpendicular to u_n.
//! The normal of that plane is q = M^-T u, since q.(M t) = u.t = 0; hence 1 - P_n = q q^T / |q|^2, and
//!     I_theta = sum_n  g g^T / (s^2 |q|^2),   g = A_n^T q = [q_i u_i ; q_i u_j + q_j u_i ; q]
//! for theta = [Mxx, Myy, Mzz, Mxy, Mxz, Myz, bx, by, bz]. No unbiased estimate has a variance below the diagonal of
//! the inverse.

use crate::parameters::Parameters;
use magcomp::nalgebra::{Matrix3, SMatrix, SVector, Vector3};

/// The information about theta in a set of samples.
#[derive(Clone, Debug)]
pub struct FisherInformation {
    inverse_transposed: Matrix3<f64>,
    sum: SMatrix<f64, 9, 9>,
    noise: f64,
    samples: usize,
}

impl FisherInformation {
    /// No samples yet, for true `parameters` and noise of standard deviation `noise` per axis, field strengths.
    /// None when M has no inverse.
    pub fn new(parameters: &Parameters, noise: f64) -> Option<Self> {
        let inverse_transposed = parameters.soft_iron.try_inverse()?.transpose();
        Some(Self { inverse_transposed, sum: SMatrix::zeros(), noise, samples: 0 })
    }

    /// One more sample, taken while the field pointed along the unit vector `u` (device frame).
    pub fn add(&mut self, u: &Vector3<f64>) {
        let q = self.inverse_transposed * u;
        let cross = |i: usize, j: usize| q[i] * u[j] + q[j] * u[i];
        let g = SVector::<f64, 9>::from_column_slice(&[
            q.x * u.x,
            q.y * u.y,
            q.z * u.z,
            cross(0, 1),
            cross(0, 2),
            cross(1, 2),
            q.x,
            q.y,
            q.z,
        ]);
        self.sum.ger(1.0 / (self.noise * self.noise * q.norm_squared()), &g, &g, 1.0);
        self.samples += 1;
    }

    /// The bound: smallest possible variance of each parameter. None while the samples do not determine all nine: each
    /// adds a matrix of rank one.
    pub fn smallest_variances(&self) -> Option<[f64; 9]> {
        if self.samples < 9 {
            return None;
        }
        let covariance = self.sum.cholesky()?.inverse();
        Some(std::array::from_fn(|i| covariance[(i, i)]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::parameters::ParameterSet;
    use crate::random::{Purpose, Random};
    use magcomp::nalgebra::{DMatrix, DVector};

    /// Mean of all samples for x = [theta, (azimuth, elevation) of every sample].
    fn mean(x: &DVector<f64>) -> DVector<f64> {
        let p = Parameters::from_theta(std::array::from_fn(|i| x[i]));
        let angles = x.rows(9, x.len() - 9);
        let samples = angles.len() / 2;
        DVector::from_iterator(
            samples * 3,
            (0..samples).flat_map(|n| {
                let ((sa, ca), (se, ce)) = (angles[2 * n].sin_cos(), angles[2 * n + 1].sin_cos());
                let mu = p.soft_iron * Vector3::new(ce * ca, ce * sa, se) + p.hard_iron;
                [mu.x, mu.y, mu.z]
            }),
        )
    }

    /// The whole Fisher information, angles and all, from finite differences of the mean; then the Schur complement.
    #[test]
    fn agrees_with_finite_differences_of_the_whole_model() {
        let (parameters, noise) = (ParameterSet::Ref.parameters(), 0.03);
        let mut random = Random::new(11, Purpose::Motion);
        let directions: Vec<_> = (0..25).map(|_| random.direction()).collect();
        let mut information = FisherInformation::new(&parameters, noise).unwrap();
        directions.iter().for_each(|u| information.add(u));

        let angles = directions.iter().flat_map(|u| [u.y.atan2(u.x), u.z.asin()]);
        let x = DVector::from_iterator(9 + 50, parameters.theta().into_iter().chain(angles));
        let mut jacobian = DMatrix::zeros(75, x.len());
        for i in 0..x.len() {
            let shifted = |by: f64| {
                let mut moved = x.clone();
                moved[i] += by;
                mean(&moved)
            };
            jacobian.set_column(i, &((shifted(1e-5) - shifted(-1e-5)) / 2e-5));
        }
        let all = jacobian.transpose() * jacobian / (noise * noise);
        let (theta, cross) = (all.view((0, 0), (9, 9)), all.view((0, 9), (9, 50)));
        let nuisance = all.view((9, 9), (50, 50)).into_owned().try_inverse().unwrap();
        let direct = theta - cross * nuisance * cross.transpose();

        let scale = direct.amax();
        for i in 0..9 {
            for j in 0..9 {
                let (a, b) = (information.sum[(i, j)], direct[(i, j)]);
                assert!((a - b).abs() < 1e-7 * scale, "({i}, {j}): {a} against {b}");
            }
        }
    }

    #[test]
    fn eight_samples_determine_nothing() {
        let mut information = FisherInformation::new(&ParameterSet::Mid.parameters(), 0.03).unwrap();
        let mut random = Random::new(1, Purpose::Motion);
        (0..8).for_each(|_| information.add(&random.direction()));
        assert!(information.smallest_variances().is_none());
    }
}
