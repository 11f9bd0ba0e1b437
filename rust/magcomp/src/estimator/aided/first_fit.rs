//! The first calibration: one fit (`batch`) of all samples of the start, made anew after each group of them.
//!
//! ```text
//! Q = mean back,  (lambda_i, v_i) = eig(I - Q' Q)
//! information -= C N^-1 C',   C = sum J_k' bend_k / v,   N = P_gg^-1 + sum bend_k' bend_k / v    what a bias would feign (`feigned`)
//! bend_k = M d(back_k far v_i)/dg                                                  i: the least lambda
//! ```
//! Source: docs/dev/METHOD-AIDED.md, Start.

use core::ops::Range;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::batch::{Matrix, Normal, Prior, UNKNOWNS, Vector, fit, model, parts};
use super::groups::Groups;
use super::state::{
    AXES, BIAS, CALIBRATION, DELAY, FIELD, Filter, HARD_IRON, HARD_IRON_ALONE, LOCAL, Parts, SKEW, SOFT_IRON,
    SOFT_IRON_ALONE,
};
use super::step::{Known, Step};
use super::tuning::Tuning;
use crate::ellipsoid::FitError;
use crate::level::Level;
use crate::math::descend::{Descent, Termination};
use crate::math::gaussian::Gaussian;
use crate::priors::{BEYOND_CHANCE, LARGEST_UT, SHOWN_RAD2};
use crate::reading::Missing;
use crate::strength::{EARTH_UT, POSSIBLE_UT, STRONGEST_AXIS_UT};

/// Choice: delay of the magnetometer against the gyroscope before anything is known, s: phones were found with -7 to 27 ms.
const DELAY_SD_S: f64 = 0.010;
/// Mathematics: variance of the trace of E, a gauge: as good as none.
const TRACE_VARIANCE: f64 = 1e-8;

/// A start under way.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct FirstFit {
    groups: Groups,
    /// The latest fit.
    x: Vector,
    /// The same as a filter, carried on to the latest sample, while the field's direction is known well enough to be told.
    pub(super) answer: Option<Filter>,
    /// The samples alone, without what was given, know the offset well enough for the filter to go on.
    pub(super) is_settled: bool,
    /// The calibration that was given, while it is believed.
    pub(super) given: Option<Before>,
    /// Strengths that a fit may find, uT.
    earth_ut: Range<f64>,
    /// Bias of the gyroscope as rest has shown it, rad/s, and its variance per axis.
    bias_rad_s: Vector3<f64>,
    pub(super) bias_variance: f64,
    /// Variance per axis of what the latest fit left beyond noise, uT^2; the next one allows for it.
    misfit_ut2: f64,
    /// Why the latest fit counts for nothing, if that can be said.
    refused: Option<FitError>,
    /// Largest eigenvalue of I - Q' Q: how far the device was turned about at least one axis, rad^2.
    widest_rad2: f64,
}

/// A calibration from elsewhere, or from before a pause: b and e.
#[derive(Clone, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Before {
    pub(super) calibration: Gaussian<9>,
    /// |h|, uT.
    pub(super) strength_ut: f64,
}

impl Before {
    /// The trace of E is a gauge, and what was measured best is not known better than rounding.
    fn precision(&self) -> Option<SMatrix<f64, 9, 9>> {
        let mut it = self.calibration.clone();
        it.add_variance(HARD_IRON_ALONE, HARD_IRON_ALONE.least_variance());
        it.add_variance(SOFT_IRON_ALONE, SOFT_IRON_ALONE.least_variance());
        Some(it.covariance.cholesky()?.inverse())
    }
}

impl FirstFit {
    pub(super) fn new(known_ut: Option<f64>, tuning: &Tuning) -> Self {
        // M may scale a known strength by three standard deviations
        let off = BEYOND_CHANCE * tuning.iron_sd;
        Self {
            earth_ut: known_ut.map_or(EARTH_UT, |it| it * (1.0 - off)..it * (1.0 + off)),
            bias_variance: tuning.bias_sd_rad_s.powi(2),
            ..Self::default()
        }
    }

    /// Before the first sample.
    #[inline(never)]
    pub(super) fn begin_from(&mut self, given: Before, tuning: &Tuning) {
        let prior = self.prior(Some(&given), 0.0, tuning);
        (self.given, self.x) = (Some(given), prior.mean);
        self.answer = prior.precision.cholesky().and_then(|p| filter(&self.x, &p.inverse(), tuning));
    }

    /// No sample has shown the field yet.
    pub(super) fn is_blind(&self) -> bool {
        FIELD.of(&self.x) == Vector3::zeros()
    }

    /// What is believed now, to tell noise from the device's motion.
    pub(super) fn known(&self, tuning: &Tuning) -> Known {
        let (bias, axes) = self.gyroscope();
        let axes_sd = if tuning.gyroscope_axes { tuning.axes_sd } else { 0.0 };
        Known { x: Parts { bias, axes, ..parts(&self.x) }, bias_sd_rad_s: self.bias_variance.sqrt(), axes_sd }
    }

    /// Bias (rad/s) and scale error of the gyroscope.
    pub(super) fn gyroscope(&self) -> (Vector3<f64>, Matrix3<f64>) {
        let x = parts(&self.x);
        // a fit that counts for nothing says nothing of the gyroscope either
        self.answer.as_ref().map_or((self.bias_rad_s, Matrix3::zeros()), |_| (x.bias, x.axes))
    }

    /// At rest the rate is the bias.
    pub(super) fn rest(&mut self, rate_rad_s: &Vector3<f64>, variance: f64) {
        let gain = self.bias_variance / (self.bias_variance + variance);
        self.bias_rad_s += (rate_rad_s - self.bias_rad_s) * gain;
        self.bias_variance *= 1.0 - gain;
        BIAS.set(&mut self.x, &self.bias_rad_s);
        if let Some(answer) = &mut self.answer {
            answer.update_bias(rate_rad_s, variance);
        }
    }

    /// The device turned.
    pub(super) fn turn(&mut self, step: &Step) {
        self.groups.turn(&step.increment_rad, step.dt_s);
        if let Some(answer) = &mut self.answer {
            answer.propagate(&step.increment_rad, step.dt_s, &step.noise);
        }
        let h = step.turn * FIELD.of(&self.x);
        FIELD.set(&mut self.x, &h);
    }

    /// What the samples so far lack.
    pub(super) fn missing(&self) -> Missing {
        match self.refused {
            Some(error) => Missing::Fit(error),
            None if self.widest_rad2 < SHOWN_RAD2 => Missing::Rotation,
            None => Missing::Directions,
        }
    }

    /// A sample taken in motion; `up` as far as it is known.
    pub(super) fn add(&mut self, step: &Step, up: Option<&Vector3<f64>>, tuning: &Tuning) {
        let is_full = self.groups.add(&step.raw_ut, &step.rate_rad_s, step.dt_s);
        // what was given answers from the first sample on
        if is_full || (self.given.is_some() && self.is_blind()) {
            self.fit(step.sigma_ut.powi(2), up, tuning);
        }
        if is_full {
            // more than a place leaves, less than another unit does: the device may have changed meanwhile
            let changed_ut2 = (0.5 * tuning.smallest_step_ut).powi(2)..STRONGEST_AXIS_UT.powi(2);
            if tuning.forget && changed_ut2.contains(&self.misfit_ut2) {
                self.groups.forget();
            }
            self.groups.close();
        }
    }

    /// In parts that are not inlined: their matrices are large, and so are never on the stack together.
    fn fit(&mut self, noise_ut2: f64, up: Option<&Vector3<f64>>, tuning: &Tuning) {
        self.answer = None;
        let prior = self.prior(self.given.as_ref(), noise_ut2, tuning);
        let fitted = fit(&self.groups, &prior, self.x);
        self.x = fitted.as_ref().map_or(prior.mean, |it| it.place.x);
        let Some(Descent { place, termination, .. }) = &fitted else { return };
        self.find(place, &prior, *termination != Termination::MaxIterations, tuning);
        if !self.counts(place, &prior, up, tuning).unwrap_or(false) {
            self.answer = None;
        }
    }

    /// The filter that a fit makes.
    #[inline(never)]
    fn find(&mut self, normal: &Normal, prior: &Prior, has_converged: bool, tuning: &Tuning) {
        let covariance = self.covariance(normal, &prior.precision, prior, tuning).filter(|_| has_converged);
        self.answer = covariance.and_then(|p| filter(&normal.x, &p, tuning));
    }

    /// Whether it counts, if there is one.
    #[inline(never)]
    fn counts(&mut self, normal: &Normal, prior: &Prior, up: Option<&Vector3<f64>>, tuning: &Tuning) -> Option<bool> {
        let found = self.answer.as_ref()?;
        let (off_rad2, own_ut2) = (off_rad2(&found.part(FIELD), &found.own(FIELD), up), found.own(HARD_IRON).trace());
        self.refused = found.impossible_field(&POSSIBLE_UT);
        let is_earthly = self.earth_ut.contains(&FIELD.of(&self.x).norm());
        if self.refused.is_some()
            || !is_earthly
            || tuning.plausible && !is_plausible(&self.x, prior, self.given.is_some())
        {
            // the next fit begins afresh: this may be a valley that leads nowhere, or what was given no longer holds
            self.given = None;
            self.x = self.prior(None, prior.noise_ut2, tuning).mean;
            return None;
        }
        let unaided_ut2 = if self.given.is_some() { self.unaided_ut2(normal, prior, tuning)? } else { own_ut2 };
        // once the groups are full, a fit learns no more: the filter, which forgets nothing, goes on from less
        let most_ut = tuning.adopt_sd_ut * if self.groups.is_full() { 1.5 } else { 1.0 };
        self.is_settled = unaided_ut2 < most_ut * most_ut;
        let is_known = off_rad2 < tuning.publish_deg.to_radians().powi(2);
        Some(is_known || self.is_settled || self.given.is_some())
    }

    /// Variance of b without what was given.
    #[inline(never)]
    fn unaided_ut2(&mut self, normal: &Normal, prior: &Prior, tuning: &Tuning) -> Option<f64> {
        let unaided = self.prior(None, prior.noise_ut2, tuning).precision;
        Some(HARD_IRON.block(&self.covariance(normal, &unaided, prior, tuning)?).trace())
    }

    fn prior(&self, given: Option<&Before>, noise_ut2: f64, tuning: &Tuning) -> Prior {
        let mut mean = Vector::zeros();
        BIAS.set(&mut mean, &self.bias_rad_s);
        let mut precision = Matrix::zeros();
        let iron = 1.0 / tuning.iron_sd.powi(2);
        FIELD.block_mut(&mut precision).fill_diagonal(1.0 / STRONGEST_AXIS_UT.powi(2));
        HARD_IRON.block_mut(&mut precision).fill_diagonal(1.0 / LARGEST_UT.powi(2));
        let elements = SVector::from([1.0, 1.0, 1.0, 2.0, 2.0, 2.0]) * iron;
        SOFT_IRON.block_mut(&mut precision).set_diagonal(&elements);
        BIAS.block_mut(&mut precision).fill_diagonal(1.0 / self.bias_variance);
        let delay = if tuning.delay { 1.0 / DELAY_SD_S.powi(2) } else { 1.0 / DELAY.least_variance() };
        DELAY.block_mut(&mut precision).fill_diagonal(delay);
        AXES.block_mut(&mut precision).copy_from(&axes_precision(tuning));
        if let Some((given, known)) = given.and_then(|given| Some((given, given.precision()?))) {
            CALIBRATION.set(&mut mean, &given.calibration.mean);
            CALIBRATION.block_mut(&mut precision).copy_from(&known);
        }
        let mut iron = SOFT_IRON.block_mut(&mut precision);
        let mut trace = iron.fixed_view_mut::<3, 3>(0, 0);
        trace += Matrix3::repeat(1.0 / TRACE_VARIANCE);
        // what contradicts a given calibration is not the place's doing
        let misfit_ut2 = if given.is_some() { 0.0 } else { self.misfit_ut2 };
        Prior { mean, precision, noise_ut2, place_ut2_s: place_ut2_s(misfit_ut2, tuning) }
    }

    /// Covariance of x for the information `before` the samples: that of the fit with what it left.
    fn covariance(&mut self, normal: &Normal, before: &Matrix, prior: &Prior, tuning: &Tuning) -> Option<Matrix> {
        let mean_t = normal.moved_s / normal.groups;
        let white = prior.noise_ut2 * normal.groups / normal.count;
        let freedom = (3.0 * normal.groups - 9.0).max(1.0);
        let left = normal.residual_ut2 / freedom - white * (1.0 + 2.0 / freedom.sqrt());
        // no more than the Earth's field itself: more is no place's doing
        self.misfit_ut2 = if tuning.misfit { left.clamp(0.0, STRONGEST_AXIS_UT.powi(2)) } else { 0.0 };
        let assumed = white + prior.place_ut2_s / mean_t;
        let found = white + place_ut2_s(self.misfit_ut2, tuning) / mean_t;
        let share = assumed / found;
        let q = normal.back;
        let eigen = (Matrix3::identity() - q.transpose() * q).symmetric_eigen();
        let mut seen = normal.curvature;
        seen.zip_apply(&prior.precision, |seen, prior| *seen = (*seen - prior) * share);
        let unseen = eigen.eigenvectors.column(eigen.eigenvalues.imin());
        let bias = BIAS.block(&inverse_of_sum(&seen, before)?);
        if tuning.feigned {
            self.leave_out_feigned(&mut seen, share, &bias, unseen * STRONGEST_AXIS_UT, prior)?;
        }
        self.widest_rad2 = eigen.eigenvalues.max();
        inverse_of_sum(&seen, before)
    }

    /// Information of the samples that a bias of the gyroscope would feign: a bias and the field along the axis of the turns are confounded. Where
    /// the fit puts that part near zero it claims what it cannot know, so the bias is marginalised as if that part were `unseen`.
    #[inline(never)]
    fn leave_out_feigned(
        &self,
        seen: &mut Matrix,
        share: f64,
        bias: &Matrix3<f64>,
        unseen_ut: Vector3<f64>,
        prior: &Prior,
    ) -> Option<()> {
        let x = parts(&self.x);
        let mut cross = SMatrix::<f64, UNKNOWNS, 3>::zeros();
        let mut own = bias.try_inverse()?;
        let unseen = self.groups.means(&Parts { field: unseen_ut, ..x });
        for (mean, unseen) in self.groups.means(&x).zip(unseen) {
            let v = prior.variance(&mean);
            let bend = x.soft_iron() * unseen.by_gyroscope.fixed_columns::<3>(0);
            let (j, _) = model(&x, &mean);
            cross += j.transpose() * bend / v;
            own += bend.transpose() * bend / v;
        }
        let (left, right) = (cross * own.try_inverse()?, cross.transpose());
        for (mut column, of) in seen.column_iter_mut().zip(right.column_iter()) {
            column -= left * of * share;
        }
        Some(())
    }
}

/// (A + B)^-1
#[inline(never)]
fn inverse_of_sum(a: &Matrix, b: &Matrix) -> Option<Matrix> {
    Some((a + b).cholesky()?.inverse())
}

/// Precision of S before anything is known: each number has an error of its own, and both of a pair that is skew the misalignment's.
fn axes_precision(tuning: &Tuning) -> SMatrix<f64, 9, 9> {
    if !tuning.gyroscope_axes {
        return SMatrix::from_diagonal_element(1.0 / AXES.least_variance());
    }
    let (own, turn) = (tuning.axes_sd.powi(2), tuning.misalignment_sd_rad.powi(2));
    let mut precision = SMatrix::from_diagonal_element(1.0 / own);
    for (a, b) in SKEW {
        precision[(a, a)] -= turn / (own * (own + 2.0 * turn));
        precision[(b, b)] = precision[(a, a)];
        precision[(a, b)] = turn / (own * (own + 2.0 * turn));
        precision[(b, a)] = precision[(a, b)];
    }
    precision
}

/// Whether what the samples tell of (e, g, tau, s), and of a b that was given, is likely beforehand: chi-squared within two
/// standard deviations.
fn is_plausible(x: &Vector, prior: &Prior, has_offset: bool) -> bool {
    let first = if has_offset { HARD_IRON.start() } else { SOFT_IRON.start() };
    let off = Vector::from_fn(|k, _| if k >= first { x[k] - prior.mean[k] } else { 0.0 });
    let count = (UNKNOWNS - first) as f64;
    off.dot(&(prior.precision * off)) < count + 2.0 * (2.0 * count).sqrt()
}

/// Variance per axis of the field of a place, of which the latest fit left so much, times the seconds over which it is correlated, uT^2 s.
fn place_ut2_s(misfit_ut2: f64, tuning: &Tuning) -> f64 {
    if tuning.unevenness { (tuning.place_ut.powi(2) + misfit_ut2) * tuning.group_s } else { 0.0 }
}

/// Variance of the direction of `h`: about `up` where it is known, of the worst axis else, rad^2.
fn off_rad2(h: &Vector3<f64>, p_hh: &Matrix3<f64>, up: Option<&Vector3<f64>>) -> f64 {
    match up {
        Some(up) => Level::of(h, up).map_or(f64::INFINITY, |level| level.across_rad2(p_hh)),
        None => p_hh.symmetric_eigenvalues().max() / h.norm_squared(),
    }
}

/// The filter that starts from a fit.
fn filter(x: &Vector, p: &Matrix, tuning: &Tuning) -> Option<Filter> {
    let mut filter = Filter::default();
    filter.mean.fixed_rows_mut::<UNKNOWNS>(0).copy_from(x);
    filter.covariance.fixed_view_mut::<UNKNOWNS, UNKNOWNS>(0, 0).copy_from(p);
    filter.add_variance(LOCAL, if tuning.unevenness { tuning.local_most_ut.powi(2) } else { 0.0 });
    filter.is_finite().then_some(filter)
}
