//! What is kept of the samples that do not fit: their share, size and beginning; and the calibration before the last step.
//!
//! ```text
//! share += (1 - exp(-dt / t)) ([NIS > gate] - share),   t = 0.6 s, falling with 0.25 s while hypotheses run
//! |v|, raw - (M h + b)_former:  low-passed over gated samples (gain 0.1)
//! ```
//! A former calibration whose residual is small is where the hypothesis `device` starts from. Source: docs/METHOD.md;
//! the recall is new.

// index arithmetic is the mathematics here
#![allow(clippy::needless_range_loop)]

use crate::sound::{checked, is_covariance};
use nalgebra::{SMatrix, SVector, Vector3};

use super::state::{Dense, Gaussian, OFFSET, iron_rows, packed_index};
use super::step::Step;
use super::tuning::Tuning;

/// A calibration that was in force before a step.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub(crate) struct Former {
    /// b and e.
    mean: SVector<f64, 9>,
    /// Their covariance, packed lower triangle; what rounding does to it, what is added covers.
    packed: SVector<f32, 45>,
}

checked!(Former, |it| is_covariance(&SMatrix::<f64, 9, 9>::from_fn(|i, j| f64::from(it.packed[packed_index(i, j)]))));

impl Former {
    pub(crate) fn of(filter: &Gaussian) -> Self {
        let mut packed = SVector::zeros();
        let mut k = 0;
        for i in 0..9 {
            for j in 0..=i {
                packed[k] = filter.p(OFFSET + i, OFFSET + j) as f32;
                k += 1;
            }
        }
        Self { mean: filter.mean.fixed_rows::<9>(OFFSET).into_owned(), packed }
    }

    /// raw - (M h + b) of this calibration, uT.
    pub(crate) fn residual(&self, raw_ut: &Vector3<f64>, h: &Vector3<f64>) -> Vector3<f64> {
        let rows = iron_rows(h);
        let mut r = raw_ut - h;
        for i in 0..3 {
            r[i] -= self.mean[i];
            for k in 0..6 {
                r[i] -= rows[i][k] * self.mean[3 + k];
            }
        }
        r
    }

    /// Puts this calibration into a filter, apart from all else in it.
    pub(crate) fn put_into(&self, dense: &mut Dense, tuning: &Tuning) {
        for i in OFFSET..OFFSET + 9 {
            for j in 0..dense.p.len() {
                dense.p[i][j] = 0.0;
                dense.p[j][i] = 0.0;
            }
        }
        let mut k = 0;
        for i in 0..9 {
            dense.x[OFFSET + i] = self.mean[i];
            for j in 0..=i {
                let value = f64::from(self.packed[k]);
                dense.p[OFFSET + i][OFFSET + j] = value;
                dense.p[OFFSET + j][OFFSET + i] = value;
                k += 1;
            }
        }
        dense.add_variance(OFFSET, tuning.noise_start_ut * tuning.noise_start_ut);
    }
}

/// Watches the share of samples that the filter does not explain.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize), serde(remote = "Self"))]
pub(crate) struct Watch {
    /// Low-passed share of gated samples.
    pub(crate) share: f64,
    /// When the present run of gated samples began.
    pub(crate) since_ns: i64,
    /// Low-passed |v| over gated samples, uT.
    pub(crate) misfit_ut: f64,
    /// Low-passed residual of the former calibration over gated samples, uT.
    pub(crate) former_ut: Vector3<f64>,
    /// Rotation over gated samples, fading otherwise, rad.
    pub(crate) rotation_rad: f64,
}

checked!(Watch, |it| (0.0..=1.0).contains(&it.share) && it.misfit_ut >= 0.0 && it.rotation_rad >= 0.0);

impl Watch {
    pub(crate) fn new() -> Self {
        Self { share: 0.0, since_ns: 0, misfit_ut: 0.0, former_ut: Vector3::zeros(), rotation_rad: 0.0 }
    }

    /// One sample: its innovation if it was gated, and the residual of the former calibration.
    pub(crate) fn step(
        &mut self,
        step: &Step<'_>,
        gated: Option<&Vector3<f64>>,
        former: Option<Vector3<f64>>,
        clearing: bool,
        tuning: &Tuning,
    ) {
        let time_s = if clearing && gated.is_none() { tuning.quick_s } else { tuning.gated_time_s };
        if let Some(v) = gated {
            if self.share < 0.5 * tuning.suspect_share {
                self.since_ns = step.time_ns;
                self.misfit_ut = v.norm();
                self.former_ut = former.unwrap_or_default();
            }
            self.misfit_ut += tuning.misfit_gain * (v.norm() - self.misfit_ut);
            if let Some(former) = former {
                self.former_ut += (former - self.former_ut) * tuning.misfit_gain;
            }
            self.rotation_rad += step.angle_rad;
        } else {
            self.rotation_rad *= (-step.dt_s).exp();
        }
        self.share += (1.0 - (-step.dt_s / time_s).exp()) * (f64::from(gated.is_some()) - self.share);
    }
}
