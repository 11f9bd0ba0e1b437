//! A rate of b: the sums over time against the samples, a course against a filter of twelve states, and fits of tau and r to
//! smooth motions with noise, at rest and not.

use super::super::hypothesis::Gaussian;
use super::super::likelihood::Likelihood;
use super::super::line::{Line, Timed};
use super::super::parameters::{Matrix9, Vector9, tau_of};
use super::super::rate::{Course, RATE_S, RATE_VARIANCE_UT};
use crate::ellipsoid::Moments;
use nalgebra::{Matrix3, SMatrix, Vector3};

const UNIT_UT: f64 = 50.0;
const PERIOD_S: f64 = 0.01;
const M: Matrix3<f64> = Matrix3::new(1.06, 0.04, -0.03, 0.04, 0.95, 0.05, -0.03, 0.05, 1.02);
const B: Vector3<f64> = Vector3::new(0.4, -0.6, 0.5);

/// Normal numbers, always the same.
struct Normal(u64);

impl Normal {
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 11) as f64 + 0.5) / (1_u64 << 53) as f64
    }

    fn three(&mut self) -> Vector3<f64> {
        Vector3::from_fn(|_, _| {
            let (r, angle) = ((-2.0 * self.uniform().ln()).sqrt(), std::f64::consts::TAU * self.uniform());
            r * angle.cos()
        })
    }
}

/// Samples (units) of a hand's smooth motion, b moving by `rate` units/s about the middle, with noise of `sigma`.
fn stream(seed: u64, count: usize, rate: &Vector3<f64>, sigma: f64) -> Vec<Vector3<f64>> {
    let mut random = Normal(seed);
    let mut wander = random.three();
    let mut direction = random.three().normalize();
    (0..count)
        .map(|k| {
            wander = wander * 0.99 + random.three() * 0.08;
            direction = (direction + wander.cross(&direction) * PERIOD_S).normalize();
            let seconds = (k as f64 - 0.5 * (count - 1) as f64) * PERIOD_S;
            M * direction + B + rate * seconds + random.three() * sigma
        })
        .collect()
}

fn timed(samples: &[Vector3<f64>]) -> Timed {
    let mut timed = Timed::new();
    samples.iter().for_each(|u| timed.add(u));
    timed
}

#[test]
fn sums_over_time_without_the_latest_are_those_of_the_rest() {
    let samples = stream(1, 200, &Vector3::zeros(), 0.01);
    let (all, latest) = (timed(&samples), timed(&samples[150..]));
    let (without, direct) = (all.without(&latest), timed(&samples[..150]));
    assert_eq!(without.count(), 150);
    let ((once, twice), (direct_once, direct_twice)) = (without.means(PERIOD_S), direct.means(PERIOD_S));
    assert!((once - direct_once).amax() < 1e-12 && (twice - direct_twice).amax() < 1e-12);
}

/// Fits of 20 streams of 8 s: mean over them and the axes of (r - rate)^2 / R, and how often log B exceeds 6.
fn fits(rate: &Vector3<f64>, sigma: f64) -> (f64, usize) {
    let expected = tau_of(&Matrix3::identity(), &Vector3::zeros());
    let near = tau_of(&M.try_inverse().expect("regular"), &B);
    let mut prior = Matrix9::identity() / 0.01;
    (6..9).for_each(|i| prior[(i, i)] = 1.0);
    let (mut square, mut found) = (0.0, 0);
    for seed in 1..=20 {
        let samples = stream(seed, 800, rate, sigma);
        let mut moments = Moments::new(Vector3::zeros(), UNIT_UT);
        samples.iter().for_each(|u| moments.add(&(u * UNIT_UT)));
        let likelihood = Likelihood::new(&moments, sigma * sigma, samples.len() as f64);
        let timed = timed(&samples);
        let line = Line::new(&likelihood, &timed, PERIOD_S, (&prior, &expected), UNIT_UT);
        let course = line.fit(&near).expect("an ellipsoid");
        let off = course.rate - rate;
        square += off.dot(&(course.spread().try_inverse().expect("positive") * off)) / 60.0;
        found += usize::from(course.log_evidence(&Vector3::zeros(), UNIT_UT) > 6.0);
    }
    (square, found)
}

#[test]
fn noise_is_no_rate_and_a_rate_is_found() {
    for sigma in [0.01, 0.03] {
        let (square, found) = fits(&Vector3::zeros(), sigma);
        assert!(square < 1.0 && found == 0, "at rest, noise {sigma}: {square:.2}, {found} found");
    }
    let (square, found) = fits(&(Vector3::new(0.4, -0.2, 0.3) / UNIT_UT), 0.01);
    assert!(square < 2.0 && found >= 15, "0.54 uT/s: {square:.2}, {found} found");
}

#[test]
fn a_course_is_a_filter_of_twelve_states() {
    type Matrix12 = SMatrix<f64, 12, 12>;
    let root = Matrix12::from_fn(|i, j| ((i * 7 + j * 3) as f64).sin() * 0.02);
    let mut p = root * root.transpose() + Matrix12::identity() * 1e-4;
    let mut mean = SMatrix::<f64, 12, 1>::from_fn(|i, _| (i as f64).cos() * 0.1);
    let mut course = Course::of(&mean, &p).expect("positive");
    let t = 0.64;
    for k in 0..5 {
        // tau is measured with noise
        let noise = Matrix9::from_diagonal_element(2e-4);
        let seen = Vector9::from_fn(|i, _| ((i + k) as f64).sin() * 0.1);
        let h = SMatrix::<f64, 9, 12>::identity();
        let gain = p * h.transpose() * (h * p * h.transpose() + noise).try_inverse().expect("positive");
        mean += gain * (seen - h * mean);
        p -= gain * h * p;
        course.learn(&Gaussian {
            mean: mean.fixed_rows::<9>(0).into_owned(),
            covariance: p.fixed_view::<9, 9>(0, 0).into_owned(),
        });
        // beta moves, the rate decays
        let keep = (-t / RATE_S).exp();
        let mut f = Matrix12::identity();
        (0..3).for_each(|i| (f[(6 + i, 9 + i)], f[(9 + i, 9 + i)]) = (t, keep));
        (mean, p) = (f * mean, f * p * f.transpose());
        (9..12).for_each(|i| p[(i, i)] += (1.0 - keep * keep) * RATE_VARIANCE_UT / (UNIT_UT * UNIT_UT));
        course.carry(&Vector3::zeros(), t, RATE_S, RATE_VARIANCE_UT / (UNIT_UT * UNIT_UT), |known| *known);
        assert!((course.known.mean - mean.fixed_rows::<9>(0)).amax() < 1e-9);
        assert!((course.rate - mean.fixed_rows::<3>(9)).amax() < 1e-9);
        assert!((course.known.covariance - p.fixed_view::<9, 9>(0, 0)).amax() < 1e-10);
        assert!((course.spread() - p.fixed_view::<3, 3>(9, 9)).amax() < 1e-10);
        assert!((course.gain * course.known.covariance - p.fixed_view::<3, 9>(9, 0)).amax() < 1e-10);
    }
}
