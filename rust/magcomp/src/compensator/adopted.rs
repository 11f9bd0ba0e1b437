//! A calibration from elsewhere, and what the first live samples say of it before anything is learned.
//!
//! ```text
//! b, M of now = those that were kept + x,     x ~ sum_k p_k N(0, P + s_k^2 C)         C: b by 1 uT an axis, M by 0.3 % a uT
//! s_0 = 2 uT: it is as it was          p_0 = 0.9 exp(-age / 6 h)
//! s_k = 4, 8, ... 512 uT: it changed   p_k = (1 - p_0) / 8: small and large changes are as likely, from a current to a cover with a magnet
//! r = |h| (sin dip, cos dip) - (c's part down, |c's level part|),  c = W (raw - b):   r ~ N(H x, 2 (2 uT)^2 I)      of two rooms, each uneven by 2 uT an axis
//!     without a dip or a vertical  r = |h| - |c|
//! b_system - b ~ N(x_b, sigma^2 I)                                                         where the system's is listened to
//! ```
//!
//! Each summand is conditioned on r, and weighed by the probability of r; mean and covariance of the mixture are what the estimators begin
//! with. So a total field or a dip that disagrees widens or moves the hard iron, and an offset that neither can show stays as likely as its age
//! makes it. Source: ours; the same phones differ from day to day by 3 to 50 uT, and by less than 3 within a day's hours.

#[cfg(test)]
mod tests;

use super::tuning::Tuning;
use crate::calibration::{Calibration, Given, independent, iron_rows};
use crate::kept::{CalibrationSource, KeptCalibration};
use crate::math::elementary::{exp, ln, sin_cos};
use crate::math::symmetric::symmetric;
use crate::priors::{BEYOND_CHANCE, DAYS_UT, IRON_PER_UT, LARGEST_UT, ROOM_UT, UNSEEN_IRON};
use crate::sample::MagneticSample;
use crate::strength::STRONGEST_AXIS_UT;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix2, Matrix3, SMatrix, SVector, Vector2, Vector3};

/// Choice: sizes of changes, each twice the one before: from twice what b moves in days, 4 uT, to beyond the largest, 512 uT.
const SIZES: usize = ((BEYOND_CHANCE * LARGEST_UT / DAYS_UT) as u32).next_power_of_two().ilog2() as usize;

type Matrix9 = SMatrix<f64, 9, 9>;
type Vector9 = SVector<f64, 9>;

/// One summand: log of its weight, mean and covariance of x.
#[derive(Clone, Copy)]
struct Summand {
    log_weight: f64,
    mean: Vector9,
    covariance: Matrix9,
}

/// A calibration that live samples have not confirmed.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Adopted {
    kept: Calibration,
    covariance: Matrix9,
    source: CalibrationSource,
    inclination_deg: Option<f64>,
    /// p_0.
    holds: f64,
    /// Time of the first sample, ns.
    since_ns: Option<i64>,
    /// In the order in which it came. The summands are made of it when they are asked for, since they are large.
    told: [Option<Evidence>; 2],
}

/// What was told of it since: each once.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
enum Evidence {
    /// A total field, with a dip where there was one.
    Sample { raw_ut: Vector3<f64>, up: Option<Vector3<f64>> },
    /// The system's hard iron, uT, and its covariance. Where it is what was adopted, its later ones are no other evidence.
    System { hard_iron_ut: Vector3<f64>, covariance_ut2: Matrix3<f64> },
}

/// Seconds since a calibration was kept. Of one that was learned at an unknown time, or by another clock, nothing is known.
fn age_s(kept: &KeptCalibration, unix_time_s: Option<i64>) -> f64 {
    match (kept.unix_time_s(), unix_time_s) {
        (Some(then), Some(now)) if now >= then => now.saturating_sub(then) as f64,
        (None, _) if kept.source() != CalibrationSource::Learned => 0.0,
        _ => f64::INFINITY,
    }
}

impl Adopted {
    pub fn new(kept: &KeptCalibration, unix_time_s: Option<i64>) -> Self {
        let is_learned = kept.source() == CalibrationSource::Learned;
        let at_once = if is_learned { Tuning::USED.changed_between } else { Tuning::USED.never_held };
        Self {
            kept: *kept.calibration(),
            covariance: *kept.covariance(),
            source: kept.source(),
            inclination_deg: kept.inclination_deg(),
            holds: (1.0 - at_once) * exp(-age_s(kept, unix_time_s) / Tuning::USED.changes_s),
            since_ns: None,
            told: [None; 2],
        }
    }

    /// Takes evidence, but of each kind the first alone. Whether it is something new.
    fn take(&mut self, new: Evidence) -> bool {
        let is_same = |it: &Evidence| core::mem::discriminant(it) == core::mem::discriminant(&new);
        let is_known = self.told.iter().flatten().any(is_same);
        let place = self.told.iter_mut().find(|it| it.is_none()).filter(|_| !is_known);
        place.map(|it| *it = Some(new)).is_some()
    }

    /// A live sample, with `up` of length 1 where the device is not accelerated. Whether it told something new.
    pub fn see(&mut self, sample: &MagneticSample, up: Option<&Vector3<f64>>) -> bool {
        let since_ns = *self.since_ns.get_or_insert(sample.time_ns);
        let is_late = sample.time_ns.saturating_sub(since_ns) >= (Tuning::USED.gone_s * 1e9) as i64;
        let waits = up.is_none() && self.inclination_deg.is_some() && !is_late;
        !waits && self.take(Evidence::Sample { raw_ut: sample.field_ut, up: up.copied() })
    }

    /// The system's hard iron: the first that is told beside a calibration of another source. Whether it told something new.
    pub fn hear(&mut self, system: &KeptCalibration) -> bool {
        let hard_iron_ut = *system.calibration().hard_iron_ut();
        let covariance_ut2 = system.covariance().fixed_view::<3, 3>(0, 0).into();
        self.source != CalibrationSource::System && self.take(Evidence::System { hard_iron_ut, covariance_ut2 })
    }

    fn summands(&self) -> [Summand; SIZES + 1] {
        let is_learned = self.source == CalibrationSource::Learned;
        let mut summands = core::array::from_fn(|k| {
            let (size_ut, weight) = match k {
                // what was given says itself how well it holds
                0 => (if is_learned { DAYS_UT } else { 0.0 }, self.holds),
                _ => (DAYS_UT * f64::from(1 << k), (1.0 - self.holds) / SIZES as f64),
            };
            let iron = (IRON_PER_UT * size_ut).min(UNSEEN_IRON);
            let covariance = self.covariance + independent(size_ut.powi(2), iron.powi(2));
            Summand { log_weight: ln(weight), mean: Vector9::zeros(), covariance }
        });
        for told in self.told.iter().flatten() {
            match told {
                Evidence::Sample { raw_ut, up } => self.see_field(&mut summands, raw_ut, up.as_ref()),
                Evidence::System { hard_iron_ut, covariance_ut2 } => {
                    let (r, h) = (hard_iron_ut - self.kept.hard_iron_ut(), SMatrix::<f64, 3, 9>::identity());
                    summands.iter_mut().for_each(|it| it.measure(&h, &r, covariance_ut2));
                }
            }
        }
        summands
    }

    fn see_field(&self, summands: &mut [Summand], raw_ut: &Vector3<f64>, up: Option<&Vector3<f64>>) {
        let (c, strength_ut) = (self.kept.correct(raw_ut), self.kept.field_strength_ut());
        // dc = -W (db + dM c)
        let w = self.kept.soft_iron_inverse();
        let mut by = SMatrix::<f64, 3, 9>::zeros();
        by.fixed_columns_mut::<3>(0).copy_from(&-w);
        by.fixed_columns_mut::<6>(3).copy_from(&(-w * iron_rows(&c)));
        // how much longer c should be, or both its parts, and where they point; one of no length has no direction
        let along = |v: Vector3<f64>, length_ut: f64| (length_ut - v.norm(), v.try_normalize(1e-6).unwrap_or_default());
        let parts = match self.inclination_deg.zip(up) {
            Some((dip_deg, up)) => {
                let (sin, cos) = sin_cos(dip_deg.to_radians());
                let vertical = up * up.dot(&c);
                [(strength_ut * sin + vertical.dot(up), -up), along(c - vertical, strength_ut * cos)]
            }
            None => [along(c, strength_ut), Default::default()],
        };
        let r = Vector2::from(parts.map(|(longer_ut, _)| longer_ut));
        let h = SMatrix::<f64, 2, 9>::from_rows(&parts.map(|(_, direction)| direction.transpose() * by));
        let noise = Matrix2::from_diagonal_element(2.0 * ROOM_UT * ROOM_UT);
        summands.iter_mut().for_each(|it| it.measure(&h, &r, &noise));
    }

    /// What is believed now; `None` where so little is left of it that a start from nothing is as good.
    pub fn believed(&self) -> Option<Given> {
        let summands = self.summands();
        let most = summands.iter().fold(f64::NEG_INFINITY, |most, it| most.max(it.log_weight));
        let weights = summands.each_ref().map(|it| exp(it.log_weight - most));
        let sum: f64 = weights.iter().sum();
        let shares = || summands.iter().zip(weights.map(|weight| weight / sum));
        let mean = shares().fold(Vector9::zeros(), |mean, (it, share)| mean + it.mean * share);
        let covariance = shares().fold(Matrix9::zeros(), |covariance, (it, share)| {
            let off = it.mean - mean;
            covariance + (it.covariance + off * off.transpose()) * share
        });
        let soft_iron = self.kept.soft_iron() + symmetric(&mean.fixed_rows::<6>(3).into_owned());
        let hard_iron_ut = self.kept.hard_iron_ut() + mean.fixed_rows::<3>(0);
        let calibration = Calibration::new(soft_iron, hard_iron_ut, self.kept.field_strength_ut()).ok()?;
        let given = Given { calibration, covariance: covariance.symmetric_part() };
        (given.hard_iron_ut2() < STRONGEST_AXIS_UT.powi(2)).then_some(given)
    }
}

impl Summand {
    /// r = H x + noise.
    fn measure<const N: usize>(&mut self, h: &SMatrix<f64, N, 9>, r: &SVector<f64, N>, noise: &SMatrix<f64, N, N>) {
        let v = r - h * self.mean;
        let variance = h * self.covariance * h.transpose() + noise;
        let Some(cholesky) = variance.cholesky() else { return };
        let gain = cholesky.solve(&(h * self.covariance)).transpose();
        self.log_weight -= 0.5 * (v.dot(&cholesky.solve(&v)) + ln(cholesky.determinant()));
        self.mean += gain * v;
        self.covariance -= gain * variance * gain.transpose();
    }
}
