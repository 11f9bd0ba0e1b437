//! The measurement: a raw sample is the field as it was tau ago, through the device's own disturbance.
//!
//! ```text
//! h0 = m + d,   R = exp([tau w]x),   h = R h0,   raw = M h + b + n,   n ~ sigma^2 I,   w = (I - S) rate - g,   rate: mean over the last tau
//! dr/dm = dr/dd = M R,  dr/db = I,  dr/de = D(h),  dr/dg = tau M [h]x J_l,  dr/ds = dr/dg (rate' (x) I),   dr/dtau = M (w x h)
//! S = H P H^T + sigma^2 I + B,   S = L L^T,   V = P H^T L^-T,   z = L^-1 v
//! x <- x + V z,   P <- P - V V^T + U U^T
//! ```
//! B is the second-order term of the bilinear E h. U is the part of V that belongs to states which an update holds (Schmidt): they
//! stay as they are, yet their uncertainty counts. P stays symmetric by construction. Source: docs/dev/METHOD-AIDED.md.

use crate::math::elementary::ln;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::state::{BIAS, DELAY, ELEMENT, FIELD, Filter, HARD_IRON, LOCAL, Parts, SOFT_IRON, STATES, covariance};
use super::step::FrameStep;
use super::tuning::Tuning;
use crate::math::gaussian::Held;
use crate::math::turn::Turn;

/// What a raw sample says about the state, before it is used.
#[derive(Clone, Copy)]
pub(crate) struct Innovation {
    /// raw minus what the state foretells, uT.
    pub(crate) v: Vector3<f64>,
    /// v^T S^-1 v.
    pub(crate) nis: f64,
    /// ln det S.
    pub(crate) ln_det: f64,
    /// The diagonal of S, uT^2.
    pub(crate) variance_ut2: Vector3<f64>,
    /// V.
    gain: SMatrix<f64, STATES, 3>,
    /// z.
    whitened: Vector3<f64>,
}

pub(crate) const NONE: Held<'static> = &[];
/// The calibration, the gyroscope's errors and tau are held: m and d alone are corrected.
pub(crate) const ALL_BUT_FIELD: Held<'static> = &[HARD_IRON.until(LOCAL)];
/// At rest the rate shows the bias, and what goes with it in m and d.
const ALL_BUT_FIELD_AND_BIAS: Held<'static> = &[HARD_IRON.until(BIAS), DELAY.until(LOCAL)];

/// What a state foretells of a raw sample, and dr/dx by its parts.
pub(crate) struct Model {
    pub(crate) raw_ut: Vector3<f64>,
    pub(super) by_field: Matrix3<f64>,
    by_bias: Matrix3<f64>,
    pub(super) by_delay: Vector3<f64>,
    /// h: what E acts on.
    pub(super) seen: Vector3<f64>,
    /// What S acts on.
    rate: Vector3<f64>,
}

impl Model {
    /// Of samples that are late by `late_s` beside the delay.
    pub(crate) fn of(x: &Parts, rate_rad_s: &Vector3<f64>, late_s: f64) -> Self {
        let (h0, w, tau, m) = (x.field + x.local, x.true_rate(rate_rad_s), x.delay + late_s, x.soft_iron());
        let Turn { rotation: back, left_jacobian: j } = Turn::by(&(w * tau));
        let seen = back * h0;
        Self {
            raw_ut: m * seen + x.hard_iron,
            by_field: m * back,
            by_bias: m * seen.cross_matrix() * j * tau,
            by_delay: m * w.cross(&seen),
            seen,
            rate: *rate_rad_s,
        }
    }

    /// H dx.
    #[inline(always)]
    pub(crate) fn times(&self, dx: &Parts) -> Vector3<f64> {
        self.by_field * (dx.field + dx.local)
            + dx.hard_iron
            + dx.iron * self.seen
            + self.by_bias * (dx.bias + dx.axes * self.rate)
            + self.by_delay * dx.delay
    }
}

/// L^-1 and det L of S = L L^T, whose lower triangle is read: a general factorisation costs ten times as much.
fn whitening(s: &Matrix3<f64>) -> Option<(Matrix3<f64>, f64)> {
    let root = |square: f64| (square > 0.0).then(|| square.sqrt());
    let x = root(s.m11)?;
    let (yx, zx) = (s.m21 / x, s.m31 / x);
    let y = root(s.m22 - yx * yx)?;
    let zy = (s.m32 - yx * zx) / y;
    let z = root(s.m33 - zx * zx - zy * zy)?;
    let mut inverse = Matrix3::from_diagonal(&Vector3::new(1.0 / x, 1.0 / y, 1.0 / z));
    inverse.m21 = -yx * inverse.m11 / y;
    inverse.m31 = (-zx * inverse.m11 - zy * inverse.m21) / z;
    inverse.m32 = -zy * inverse.m22 / z;
    Some((inverse, x * y * z))
}

impl Filter {
    /// B_i = sum_jl P(E_ij, E_il) (P_mm + P_dd)_jl + P(E_ij, m_l) P(m_j, E_il), not below zero.
    fn second_order(&self) -> Vector3<f64> {
        let field = self.own(FIELD) + self.own(LOCAL);
        Vector3::from(ELEMENT.map(|row| {
            let mut sum = 0.0;
            for (j, &ij) in row.iter().enumerate() {
                for (l, &il) in row.iter().enumerate() {
                    let (ij, il, j_m, l_m) =
                        (SOFT_IRON.start() + ij, SOFT_IRON.start() + il, FIELD.start() + j, FIELD.start() + l);
                    let cross = self.covariance[(ij, l_m)] * self.covariance[(j_m, il)];
                    sum += (self.covariance[(ij, il)] * field[(j, l)] + cross).max(0.0);
                }
            }
            sum
        }))
    }

    /// The innovation of a sample; `None` when S has no Cholesky factor.
    pub(crate) fn innovation(&self, step: &FrameStep, tuning: &Tuning) -> Option<Innovation> {
        let (raw_ut, sigma_ut) = (step.raw_ut, step.sigma_ut);
        let model = Model::of(&self.parts(), &step.delayed_rad_s, step.late_s);
        let bilinear_ut2 = if tuning.second_order { self.second_order() } else { Vector3::zeros() };
        let ph = covariance::<STATES, 3>(|k, i| self.covariance[(k, i)], |dx| model.times(dx));
        let s = covariance::<3, 3>(|k, i| ph[(i, k)], |dx| model.times(dx))
            + Matrix3::from_diagonal(&bilinear_ut2.add_scalar(sigma_ut * sigma_ut));
        let (l_inverse, root_det) = whitening(&s)?;
        let v = raw_ut - model.raw_ut;
        let whitened = l_inverse * v;
        let nis = whitened.norm_squared();
        let ln_det = 2.0 * ln(root_det);
        // P H^T L^-T, of which nothing is above the diagonal of L^-1
        let mut gain = ph;
        for k in 0..STATES {
            gain[(k, 1)] = ph[(k, 0)] * l_inverse.m21 + ph[(k, 1)] * l_inverse.m22;
            gain[(k, 2)] = ph[(k, 0)] * l_inverse.m31 + ph[(k, 1)] * l_inverse.m32 + ph[(k, 2)] * l_inverse.m33;
            gain[(k, 0)] *= l_inverse.m11;
        }
        (nis.is_finite() && ln_det.is_finite()).then(|| Innovation {
            v,
            nis,
            ln_det,
            variance_ut2: s.diagonal(),
            gain,
            whitened,
        })
    }

    /// What the magnetometer should read at rest, uT.
    pub(crate) fn expected_ut(&self) -> Vector3<f64> {
        Model::of(&self.parts(), &Vector3::zeros(), 0.0).raw_ut
    }

    /// Corrects the state by an innovation found from this very state; the states of `held` stay.
    pub(crate) fn update(&mut self, innovation: &Innovation, held: Held<'_>) {
        self.correct_soundly(&innovation.gain, &innovation.whitened, held);
    }

    /// The scalar measurement |m| = `strength_ut` with the given variance, m and its companions corrected.
    pub(crate) fn update_strength(&mut self, strength_ut: f64, variance: f64) {
        let m = self.part(FIELD);
        let size = m.norm();
        if size < 1e-6 {
            return;
        }
        let u = m / size;
        let hp = self.columns(FIELD) * u;
        let along = u.dot(&FIELD.of(&hp));
        // what the curvature of |m| hides: half the variance across, over |m|
        let across = (self.variances(FIELD).sum() - along).max(0.0) / size;
        let sd = (along + variance + 0.5 * across * across).sqrt();
        self.correct_soundly(&(hp / sd), &SVector::from([(strength_ut - size) / sd]), NONE);
    }

    /// The measurement g = rate (at rest), with `variance` per axis; b, e, tau and s hold (Schmidt).
    pub(crate) fn update_bias(&mut self, rate_rad_s: &Vector3<f64>, variance: f64) {
        for (k, rate) in BIAS.range().zip(rate_rad_s) {
            let column = self.covariance.column(k).into_owned();
            let sd = (column[k] + variance).sqrt();
            let off = SVector::from([(rate - self.mean[k]) / sd]);
            self.correct_soundly(&(column / sd), &off, ALL_BUT_FIELD_AND_BIAS);
        }
    }
}
