//! Small changes: evidence that the latest samples of some span want other parameters.
//!
//! With g half the score and H the information of the span's samples at the estimate, a jump drawn from N(0, P_j) at the
//! span's start raises the log evidence by (linearised)
//!     log B = g^T (H + P_j^-1)^-1 g / 2 - log det (I + P_j H) / 2
//! H is taken raw, J^T S J: the noise's share left in makes it cautious. P(log B > c) <= e^-c while nothing changes.

use super::hypothesis::Gaussian;
use super::likelihood::Likelihood;
use super::parameters::{Matrix9, Vector9, is_bounded};
use crate::ellipsoid::ldl::Ldl;

/// Standard deviations of the jumps looked for: T's diagonal, off-diagonal, beta.
const JUMPS: [[f64; 3]; 4] = [[1e-3, 1e-3, 0.05], [1e-3, 1e-3, 0.3], [0.06, 0.04, 0.1], [0.4, 0.15, 0.6]];

/// The largest log B over the jumps; where it exceeds `enough`, less what the posterior itself could still take up.
pub(super) fn log_evidence_of_jump(likelihood: &Likelihood, posterior: &Gaussian, enough: f64) -> f64 {
    let tau = &posterior.mean;
    let Some(point) = likelihood.at(tau) else { return f64::NEG_INFINITY };
    let score = likelihood.score(tau, &point);
    let (_, raw) = likelihood.derivatives(tau, &point);
    let mut largest = f64::NEG_INFINITY;
    for [diagonal, off_diagonal, centre] in JUMPS {
        let sd = |i: usize| [diagonal, off_diagonal, centre][i / 3];
        // with P_j = D^2:  H + P_j^-1 = D^-1 (D H D + I) D^-1
        let scaled = Matrix9::from_fn(|i, j| raw[(i, j)] * sd(i) * sd(j) + if i == j { 1.0 } else { 0.0 });
        let Some(factors) = Ldl::new(&scaled) else { continue };
        let g = Vector9::from_fn(|i, _| score[i] * sd(i));
        largest = largest.max(0.5 * (factors.square(&g) - factors.log_det));
    }
    if largest > enough
        && let Some(l) = posterior.covariance.cholesky().map(|c| c.l())
        && let Some(open) = (l.tr_mul(&(raw * l)) + Matrix9::identity()).cholesky()
    {
        let g = l.tr_mul(&score);
        largest -= 0.5 * g.dot(&open.solve(&g));
    }
    largest
}

/// What was known before the samples of `likelihood` came in: their information and their score taken off again.
pub(super) fn without(posterior: &Gaussian, likelihood: &Likelihood) -> Gaussian {
    let tau = posterior.mean;
    let before = || {
        let point = likelihood.at(&tau)?;
        let information = posterior.covariance.cholesky()?.inverse() - likelihood.information(&tau, &point);
        let cholesky = information.cholesky()?;
        let (gradient, _) = likelihood.derivatives(&tau, &point);
        let covariance = cholesky.inverse();
        let mean = tau + cholesky.solve(&gradient);
        // taking off nearly everything leaves rounding: then what is left is known about half as well as before
        let sane = (0..9).all(|i| covariance[(i, i)] < 4.0 * posterior.covariance[(i, i)]);
        (sane && is_bounded(&mean)).then_some(Gaussian { mean, covariance })
    };
    before().unwrap_or(Gaussian { mean: tau, covariance: posterior.covariance * 2.0 })
}
