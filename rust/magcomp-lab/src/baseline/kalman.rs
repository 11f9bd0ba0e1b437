//! Kalman filters over the nine parameters x = (W, b) of |W (h - b)| = 1 (Beravs, Begus, Podobnik, Munih), W symmetric:
//! random walk of variance q a sample, extended or unscented, innovations above five standard deviations gated, and a
//! restart of the covariance when most of the latest are, or none. They start from the sphere through the first samples
//! that are well spread. Units: |h| of that sphere.
//!
//! Unscented: 19 sigma points x +- sqrt(9 + lambda) L_i, weights 1 / (2 (9 + lambda)), lambda = 0 (S. Julier, J. Uhlmann).

use super::algebraic;
use super::method::Baseline;
use super::window::calibration_of;
use magcomp::nalgebra::{Matrix3, SMatrix, SVector, Vector3};
use magcomp::{Calibration, MagneticSample};

type Vector9 = SVector<f64, 9>;
type Matrix9 = SMatrix<f64, 9, 9>;

/// Fewest and most samples for the sphere it starts from, and how evenly they must be spread before the most: smallest over
/// largest eigenvalue of their covariance. A filter that starts from a short arc never recovers.
const START: usize = 100;
const LONGEST_START: usize = 1500;
const SPREAD: f64 = 0.15;
/// Samples from one look at that to the next.
const STRIDE: usize = 20;
/// Standard deviations of W and b at the start, from a sphere that is about right, and after a restart.
const START_SD: (f64, f64) = (0.1, 0.1);
const RESTART_SD: (f64, f64) = (0.2, 0.5);
/// Innovations above this many standard deviations are not used.
const GATE: f64 = 5.0;
/// Share of gated samples (a mean over some 10) that restarts the covariance.
const RESTART: f64 = 0.4;

/// A filter.
#[derive(Clone, Debug, Default)]
pub struct Kalman {
    unscented: bool,
    walk: f64,
    restarts: bool,
    noise_ut: f64,
    first: Vec<Vector3<f64>>,
    started: bool,
    unit_ut: f64,
    centre_ut: Vector3<f64>,
    x: Vector9,
    p: Matrix9,
    share: f64,
}

impl Kalman {
    /// With a random walk of variance `walk` a sample, negative for one that never restarts, and the true noise of the samples, uT.
    pub fn new(unscented: bool, walk: f64, noise_ut: f64) -> Self {
        Self { unscented, walk: walk.abs(), restarts: walk > 0.0, noise_ut, ..Self::default() }
    }

    fn widen(&mut self, by: (f64, f64)) {
        for i in 0..9 {
            let sd = if i < 6 { by.0 } else { by.1 };
            self.p[(i, i)] += sd * sd;
        }
    }

    fn is_spread(&self) -> bool {
        let mean = self.first.iter().sum::<Vector3<f64>>() / self.first.len() as f64;
        let scatter: Matrix3<f64> = self.first.iter().map(|p| (p - mean) * (p - mean).transpose()).sum();
        let values = scatter.symmetric_eigenvalues();
        values.min() > SPREAD * values.max()
    }

    fn begin(&mut self) {
        self.started = true;
        let sphere = algebraic::sphere(&self.first);
        let mean = self.first.iter().sum::<Vector3<f64>>() / self.first.len() as f64;
        // a short arc says little: then the centre is looked for from the middle of the samples
        let (radius, centre) = sphere.map_or((50.0, mean), |(a, b)| (a.m11.sqrt().recip(), b));
        self.unit_ut = if (20.0..80.0).contains(&radius) { radius } else { 50.0 };
        self.centre_ut = if (centre - mean).norm() < 1.5 * self.unit_ut { centre } else { mean };
        self.x = Vector9::from_column_slice(&[1.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]);
        self.widen(START_SD);
    }

    fn predicted(x: &Vector9, u: &Vector3<f64>) -> f64 {
        (shape(x) * (u - x.fixed_rows::<3>(6))).norm()
    }

    /// Innovation variance without noise, and cov(x, z).
    fn extended(&self, u: &Vector3<f64>) -> (f64, f64, Vector9) {
        let (w, o) = (shape(&self.x), u - self.x.fixed_rows::<3>(6));
        let v = w * o;
        let (r, n) = (v.norm(), v.normalize());
        let wn = w * n;
        let g = Vector9::from_column_slice(&[
            n.x * o.x,
            n.y * o.y,
            n.z * o.z,
            n.x * o.y + n.y * o.x,
            n.x * o.z + n.z * o.x,
            n.y * o.z + n.z * o.y,
            -wn.x,
            -wn.y,
            -wn.z,
        ]);
        let pg = self.p * g;
        (r, g.dot(&pg), pg)
    }

    fn unscented(&self, u: &Vector3<f64>) -> Option<(f64, f64, Vector9)> {
        let l = self.p.cholesky()?.l() * 3.0;
        let points = (0..9).flat_map(|i| [l.column(i).into_owned(), -l.column(i)]);
        let values: Vec<(Vector9, f64)> = points.map(|d| (d, Self::predicted(&(self.x + d), u))).collect();
        let mean = values.iter().map(|(_, z)| z).sum::<f64>() / 18.0;
        let variance = values.iter().map(|(_, z)| (z - mean).powi(2)).sum::<f64>() / 18.0;
        let cross = values.iter().map(|(d, z)| d * (z - mean)).sum::<Vector9>() / 18.0;
        Some((mean, variance, cross))
    }
}

fn shape(x: &Vector9) -> Matrix3<f64> {
    Matrix3::new(x[0], x[3], x[4], x[3], x[1], x[5], x[4], x[5], x[2])
}

impl Baseline for Kalman {
    fn push(&mut self, sample: &MagneticSample) {
        if !self.started {
            self.first.push(sample.field_ut);
            let count = self.first.len();
            let looked = count >= START && count.is_multiple_of(STRIDE);
            if count == LONGEST_START || (looked && self.is_spread()) {
                self.begin();
            }
            return;
        }
        let u = (sample.field_ut - self.centre_ut) / self.unit_ut;
        (0..9).for_each(|i| self.p[(i, i)] += self.walk);
        let moments = if self.unscented { self.unscented(&u) } else { Some(self.extended(&u)) };
        let Some((mean, variance, cross)) = moments else {
            self.p = Matrix9::zeros();
            self.widen(RESTART_SD);
            return;
        };
        let slope = shape(&self.x).norm_squared() / 3.0;
        let s = variance + (self.noise_ut / self.unit_ut).powi(2) * slope;
        let innovation = 1.0 - mean;
        let gated = innovation.abs() > GATE * s.sqrt();
        self.share += 0.1 * (f64::from(u8::from(gated)) - self.share);
        if self.restarts && self.share > RESTART {
            self.widen(RESTART_SD);
            self.share = 0.0;
        } else if !gated {
            self.x += cross * (innovation / s);
            self.p -= cross * cross.transpose() / s;
            self.p = (self.p + self.p.transpose()) * 0.5;
        }
    }

    fn correct(&self, raw_ut: &Vector3<f64>) -> Option<Vector3<f64>> {
        self.calibration().map(|calibration| calibration.correct(raw_ut))
    }

    fn calibration(&self) -> Option<Calibration> {
        if !self.started {
            return None;
        }
        let w = shape(&self.x) / self.unit_ut;
        calibration_of(&(w * w), self.centre_ut + self.x.fixed_rows::<3>(6) * self.unit_ut)
    }
}
