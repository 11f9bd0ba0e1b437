//! The likelihood against a direct sum over its samples, and every derivative against central differences: at random
//! parameters, on whole spheres and on narrow caps.

use super::super::Adaptive;
use super::super::angle::AngularWeight;
use super::super::likelihood::Likelihood;
use super::super::parameters::{
    Matrix9, Vector9, Vector10, centre, jacobian, quadric, radius_gradient, see, shape, tau_of, vector_gradient,
};
use super::super::publish::Published;
use crate::config::Config;
use crate::ellipsoid::Moments;
use nalgebra::{Matrix3, Rotation3, Vector3};
use proptest::prelude::*;

/// Where the raw samples lie, uT, and their unit.
const UNIT_UT: f64 = 45.0;
/// Step of the differences.
const STEP: f64 = 1e-4;

fn vector(range: f64) -> impl Strategy<Value = Vector3<f64>> {
    [-range..range, -range..range, -range..range].prop_map(Vector3::from)
}

/// T with half axes of 0.5 to 2 units, turned any way, and beta.
fn any_tau() -> impl Strategy<Value = Vector9> {
    ([0.5..2.0, 0.5..2.0, 0.5..2.0], vector(3.0), vector(1.5)).prop_map(|(values, turn, beta)| {
        let q = Rotation3::new(turn).into_inner();
        tau_of(&(q * Matrix3::from_diagonal(&Vector3::from(values)) * q.transpose()), &beta)
    })
}

/// Directions within an angle (degrees) of an axis: a cap of 4 to a whole sphere.
fn directions() -> impl Strategy<Value = Vec<Vector3<f64>>> {
    (4.0..180.0_f64, vector(3.0), 9_usize..60, 0.0..1.0_f64).prop_map(|(cap, turn, count, from)| {
        let turn = Rotation3::new(turn);
        let spiral = (0..count).map(|k| {
            let z = 1.0 - (1.0 - cap.to_radians().cos()) * (k as f64 + 0.5) / count as f64;
            let (sin, cos) = (2.399_963 * (k as f64 + from)).sin_cos();
            let r = (1.0 - z * z).sqrt();
            turn * Vector3::new(r * cos, r * sin, z)
        });
        spiral.collect()
    })
}

/// Samples (units) on the ellipsoid of tau, off it by `off` along a direction that varies.
fn samples(tau: &Vector9, directions: &[Vector3<f64>], off: f64) -> Vec<Vector3<f64>> {
    let inverse = shape(tau).try_inverse().expect("bounded");
    let at = |(k, n): (usize, &Vector3<f64>)| {
        let k = k as f64;
        centre(tau) + inverse * n + Vector3::new((k * 1.3).sin(), (k * 2.1).cos(), (k * 0.7).sin()) * off
    };
    directions.iter().enumerate().map(at).collect()
}

fn moments(samples: &[Vector3<f64>]) -> Moments {
    let mut moments = Moments::new(Vector3::zeros(), UNIT_UT);
    samples.iter().for_each(|u| moments.add(&(u * UNIT_UT)));
    moments
}

fn mean(values: impl ExactSizeIterator<Item = f64>) -> f64 {
    let count = values.len() as f64;
    values.sum::<f64>() / count
}

/// r^2 - 1.
fn residual(tau: &Vector9, u: &Vector3<f64>) -> f64 {
    (shape(tau) * (u - centre(tau))).norm_squared() - 1.0
}

/// D: mean of |grad r^2|^2 + 2 (r^2 - 1) tr A. Well inside an ellipsoid it is negative: there is no distance to it.
fn slope(tau: &Vector9, samples: &[Vector3<f64>]) -> f64 {
    let a = shape(tau).pow(2);
    let gradient = |u: &Vector3<f64>| a * (u - centre(tau)) * 2.0;
    mean(samples.iter().map(|u| gradient(u).norm_squared() + 2.0 * residual(tau, u) * a.trace()))
}

fn d(u: &Vector3<f64>) -> Vector10 {
    let (x, y, z) = (u.x, u.y, u.z);
    Vector10::from_column_slice(&[x * x, y * y, z * z, 2.0 * x * y, 2.0 * x * z, 2.0 * y * z, x, y, z, 1.0])
}

/// Central difference along parameter k, of fourth order.
fn difference<const N: usize>(
    tau: &Vector9,
    k: usize,
    value: impl Fn(&Vector9) -> nalgebra::SVector<f64, N>,
) -> nalgebra::SVector<f64, N> {
    let across = |by: f64| value(&(tau + Vector9::ith(k, by))) - value(&(tau - Vector9::ith(k, by)));
    (across(STEP) * 8.0 - across(2.0 * STEP)) / (12.0 * STEP)
}

fn scalar(value: f64) -> nalgebra::Vector1<f64> {
    nalgebra::Vector1::new(value)
}

/// Largest difference of two matrices over the largest element.
fn apart(a: &Matrix9, b: &Matrix9) -> f64 {
    (a - b).amax() / b.amax()
}

const SIGMA: f64 = 0.01;

/// Somewhere between: what a fit passes on its way.
fn beside(truth: &Vector9, other: &Vector9) -> Vector9 {
    truth + (other - truth) * 0.1
}

fn likelihood(samples: &[Vector3<f64>], sigma: f64) -> Likelihood {
    Likelihood::new(&moments(samples), sigma * sigma, samples.len() as f64)
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    /// L = w C / D with C the mean of (r^2 - 1)^2.
    #[test]
    fn the_cost_is_the_sum_over_the_samples(truth in any_tau(), by in any_tau(), n in directions()) {
        let samples = samples(&truth, &n, 0.05);
        let tau = beside(&truth, &by);
        let c = mean(samples.iter().map(|u| residual(&tau, u).powi(2)));
        let slope = slope(&tau, &samples);
        let direct = c / slope;
        let found = likelihood(&samples, SIGMA).at(&tau);
        prop_assert_eq!(found.is_some(), slope > 1e-6);
        let Some(point) = found else { return Ok(()) };
        prop_assert!((point.distance_squared - direct).abs() < 1e-9 * direct.max(1e-3), "{point:?} {direct}");
        let cost = direct * samples.len() as f64 / (SIGMA * SIGMA);
        prop_assert!((point.cost - cost).abs() < 1e-9 * cost.max(10.0));
    }

    #[test]
    fn half_the_gradient_agrees_with_differences(truth in any_tau(), by in any_tau(), n in directions()) {
        let samples = samples(&truth, &n, 0.02);
        let likelihood = likelihood(&samples, SIGMA);
        let tau = beside(&truth, &by);
        // near the pole of C / D differences are no measure
        let Some(point) = likelihood.at(&tau).filter(|_| slope(&tau, &samples) > 1.0) else { return Ok(()) };
        let (gradient, hessian) = likelihood.derivatives(&tau, &point);
        let size = (point.cost * hessian.amax()).sqrt();
        for k in 0..9 {
            let cost = |tau: &Vector9| scalar(likelihood.at(tau).map_or(f64::NAN, |point| point.cost));
            let numeric = 0.5 * difference(&tau, k, cost).x;
            prop_assert!((gradient[k] - numeric).abs() < 1e-5 * size, "{k}: {} against {numeric}", gradient[k]);
        }
    }

    /// Where the fit is exact, nothing is left out: half the second derivative is J^T S J w / D.
    #[test]
    fn the_hessian_is_the_second_derivative_where_the_fit_is_exact(truth in any_tau(), n in directions()) {
        let likelihood = likelihood(&samples(&truth, &n, 0.0), SIGMA);
        let derivatives = |tau: &Vector9| likelihood.derivatives(tau, &likelihood.at(tau).expect("near the samples"));
        let (gradient, hessian) = derivatives(&truth);
        prop_assert!(gradient.amax() < 1e-9 * hessian.amax());
        let mut numeric = Matrix9::zeros();
        (0..9).for_each(|k| numeric.set_column(k, &difference(&truth, k, |tau| derivatives(tau).0)));
        prop_assert!(apart(&hessian, &numeric) < 1e-7, "{}", apart(&hessian, &numeric));
    }

    /// Elsewhere it is the sum of the outer products of the residuals' gradients, never indefinite.
    #[test]
    fn the_hessian_is_gauss_newton_anywhere(truth in any_tau(), by in any_tau(), n in directions()) {
        let samples = samples(&truth, &n, 0.05);
        let likelihood = likelihood(&samples, SIGMA);
        let tau = beside(&truth, &by);
        let Some(point) = likelihood.at(&tau) else { return Ok(()) };
        let (_, hessian) = likelihood.derivatives(&tau, &point);
        let mut direct = Matrix9::zeros();
        for u in &samples {
            let g = Vector9::from_fn(|k, _| difference(&tau, k, |tau| scalar(residual(tau, u))).x);
            direct += g * g.transpose();
        }
        // w / D, from C / D and C
        let c = mean(samples.iter().map(|u| residual(&tau, u).powi(2)));
        let direct = direct * (point.distance_squared / c / (SIGMA * SIGMA));
        prop_assert!(apart(&hessian, &direct) < 1e-7, "{}", apart(&hessian, &direct));
        prop_assert!(hessian.symmetric_eigenvalues().min() > -1e-9 * hessian.amax());
    }

    /// Noise of the variance that is taken off leaves the information as it is without noise, the score at zero and C / D
    /// at its variance, up to s^4. Instead of noise: six samples about each, with the moments of white noise.
    #[test]
    fn noise_adds_neither_information_nor_score(truth in any_tau(), n in directions()) {
        let sigma = 1e-3;
        let clean = samples(&truth, &n, 0.0);
        let reach = sigma * 3.0_f64.sqrt();
        let noisy = clean.iter().flat_map(|u| {
            (0..6).map(move |k| u + Vector3::ith(k / 2, if k % 2 == 0 { reach } else { -reach }))
        });
        let noisy: Vec<_> = noisy.collect();
        let count = clean.len() as f64;
        let with = Likelihood::new(&moments(&noisy), sigma * sigma, count);
        let without = Likelihood::new(&moments(&clean), sigma * sigma, count);
        let point = with.at(&truth).expect("near the samples");
        prop_assert!((point.distance_squared / (sigma * sigma) - 1.0).abs() < 1e-4, "{}", point.distance_squared);
        let expected = without.derivatives(&truth, &without.at(&truth).expect("near the samples")).1;
        let information = with.information(&truth, &point);
        prop_assert!(apart(&information, &expected) < 1e-3, "{}", apart(&information, &expected));
        // one standard deviation of the score is the root of the information
        prop_assert!(with.score(&truth, &point).amax() < 0.01 * expected.amax().sqrt());
        // raw, the noise's own share is left in: cautious
        prop_assert!(with.derivatives(&truth, &point).1.trace() > information.trace());
    }

    /// d.p = r^2 - 1, d.dp = 2 r dr = 2 r n.dv, and each of them against differences.
    #[test]
    fn the_derivatives_of_one_sample_belong_together(tau in any_tau(), u in vector(2.5)) {
        let Some(seen) = see(&tau, &u).filter(|seen| seen.radius > 0.05) else { return Ok(()) };
        prop_assert!((d(&u).dot(&quadric(&tau)) - residual(&tau, &u)).abs() < 1e-11);
        let (j, g, v) = (jacobian(&tau), radius_gradient(&tau, &seen), vector_gradient(&tau, &seen.offset));
        prop_assert!((j.tr_mul(&d(&u)) - g * (2.0 * seen.radius)).amax() < 1e-11);
        prop_assert!((v.tr_mul(&seen.direction) - g).amax() < 1e-12);
        for k in 0..9 {
            let p = difference(&tau, k, quadric);
            prop_assert!((p - j.column(k)).amax() < 1e-8, "p, column {k}");
            let turned = difference(&tau, k, |tau| shape(tau) * (u - centre(tau)));
            prop_assert!((turned - v.column(k)).amax() < 1e-9, "T (u - beta), column {k}");
        }
    }

    /// dtau^T W dtau is the mean square of the angles that a small dtau turns the samples by.
    #[test]
    fn the_angular_weight_is_the_mean_square_of_angles(tau in any_tau(), by in any_tau(), n in directions()) {
        let samples = samples(&tau, &n, 0.02);
        let mut weight = AngularWeight::new();
        samples.iter().for_each(|u| weight.add(&tau, u));
        let step = (by - tau) * 1e-4;
        let seen = |tau: &Vector9, u: &Vector3<f64>| see(tau, u).expect("not the centre").direction;
        let direct = mean(samples.iter().map(|u| {
            let (before, after) = (seen(&(tau - step), u), seen(&(tau + step), u));
            before.angle(&after).powi(2) / 4.0
        }));
        let found = weight.expected(&(step * step.transpose()));
        prop_assert!((found / direct - 1.0).abs() < 1e-4, "{found} against {direct}");
    }

    /// The covariance that is given out is that of tau, through the differences of the calibration that is given out.
    #[test]
    fn the_covariance_given_out_belongs_to_the_calibration(tau in any_tau(), by in any_tau(), known: bool) {
        let mut config = Config::default();
        config.fit.field_strength_ut = known.then_some(48.0);
        let mut estimator = Adaptive::new(&config, None);
        estimator.started = true;
        estimator.centre_ut = Vector3::new(80.0, -120.0, 300.0);
        let step = by - tau;
        let published = |tau: Vector9| Published { tau, covariance: step * step.transpose(), expected: 0.0 };
        let mut theta = |tau: Vector9| {
            estimator.published = Some(published(tau));
            let found = estimator.calibration().expect("bounded");
            let (m, b) = (found.soft_iron(), found.hard_iron_ut());
            (Vector9::from([b.x, b.y, b.z, m.m11, m.m22, m.m33, m.m12, m.m13, m.m23]), estimator.covariance())
        };
        let change = (theta(tau + step * STEP).0 - theta(tau - step * STEP).0) / (2.0 * STEP);
        let covariance = theta(tau).1.expect("bounded");
        prop_assert!(apart(&covariance, &(change * change.transpose())) < 1e-5);
    }
}
