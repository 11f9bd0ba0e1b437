//! The state and its covariance: x = [m, b, e, g, tau, S, d], 28 numbers, P symmetric.
//!
//! ```text
//! m    field of the place in the magnetometer's axes at the gyroscope's time, uT
//! b    hard iron, uT
//! e    soft iron M = I + E, e = (E_xx, E_yy, E_zz, E_xy, E_xz, E_yz), trace E = 0
//! g    gyroscope bias, rad/s
//! tau  how late the magnetometer is against the gyroscope, s
//! S    by columns: scale and axes of the gyroscope against the magnetometer's, true rate = (I - S) reading - g; its skew part is the turn between both
//! d    local deviation of the field (rooms are not uniform), as m, uT
//! ```
//!
//! raw = M h + b leaves the scale between M and |h| free, so E is held traceless. P is made by a start (`first_fit`). It changes in `propagate`, in `measure`, in
//! `running` (a lost field, a long pause) and in the copies of a trial (`events`; `watch` puts a former calibration into one); `changes`, `probation` and
//! `quarantine` only exchange whole filters. Source: docs/dev/METHOD-AIDED.md.

use core::ops::Range;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use crate::ellipsoid::FitError;
use crate::math::gaussian::{Gaussian, Held, Part};
use crate::math::symmetric::inverse;
use crate::priors::BEYOND_CHANCE;

// the parts in their order, each with the least variance that rounding can carry
/// Mathematics: m, uT.
pub(crate) const FIELD: Part<3> = Part::first(1e-8);
/// Mathematics: b, uT.
pub(crate) const HARD_IRON: Part<3> = FIELD.then(1e-8);
/// Mathematics: e.
pub(crate) const SOFT_IRON: Part<6> = HARD_IRON.then(1e-12);
/// Mathematics: g, rad/s.
pub(crate) const BIAS: Part<3> = SOFT_IRON.then(1e-14);
/// Mathematics: tau, s.
pub(crate) const DELAY: Part<1> = BIAS.then(1e-12);
/// Mathematics: s.
pub(crate) const AXES: Part<9> = DELAY.then(1e-12);
/// Mathematics: d, uT.
pub(crate) const LOCAL: Part<3> = AXES.then(1e-8);
/// Length of the state.
pub(crate) const STATES: usize = LOCAL.end();

/// b and e.
pub(crate) const CALIBRATION: Part<9> = HARD_IRON.with_next();
/// m, b and e.
pub(crate) const FIELD_AND_CALIBRATION: Part<12> = FIELD.with_next();

// b and e where they stand alone, as a calibration
pub(crate) const HARD_IRON_ALONE: Part<3> = Part::first(HARD_IRON.least_variance());
pub(crate) const SOFT_IRON_ALONE: Part<6> = HARD_IRON_ALONE.then(SOFT_IRON.least_variance());

/// State and covariance.
pub(crate) type Filter = Gaussian<STATES>;

/// Index of E_ij in e.
pub(crate) const ELEMENT: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];

/// Mathematics: numbers of S, by columns, whose halved difference is its skew part about x, y and z.
pub(super) const SKEW: [(usize, usize); 3] = [(5, 7), (6, 2), (1, 3)];

/// Mathematics: share of the soft iron's variance that is left to its trace: none would make P singular, much would untie the gauge.
const TRACE_SHARE: f64 = 1e-6;

impl Filter {
    pub(crate) fn parts(&self) -> Parts {
        Parts::of(|i| self.mean[i])
    }

    /// That m is stronger or weaker than any field of a range, uT, if so.
    pub(super) fn impossible_field(&self, range_ut: &Range<f64>) -> Option<FitError> {
        let m = self.part(FIELD);
        let field_ut = m.norm();
        if range_ut.contains(&field_ut) {
            return None;
        }
        let doubt_ut = BEYOND_CHANCE * m.dot(&(self.own(FIELD) * m)).max(0.0).sqrt() / field_ut;
        let Range { start: low_ut, end: high_ut } = *range_ut;
        let is_impossible = field_ut + doubt_ut < low_ut || field_ut - doubt_ut > high_ut;
        is_impossible.then_some(FitError::FieldOutOfRange { field_ut, low_ut, high_ut })
    }

    /// Covariance of the misalignment, rad^2, and of the misalignment with m, uT rad.
    pub(super) fn misalignment_covariance(&self) -> (Matrix3<f64>, Matrix3<f64>) {
        let with = |k: usize| SKEW.map(|(a, b)| 0.5 * (self.axes_with(a, k) - self.axes_with(b, k)));
        let of_axes = SKEW.map(|(a, b)| [a, b].map(|k| Vector3::from(with(AXES.start() + k))));
        let own = Matrix3::from_columns(&of_axes.map(|[a, b]| (a - b) * 0.5));
        (own, Matrix3::from([0, 1, 2].map(|k| with(FIELD.start() + k))))
    }

    /// Covariance of a number of S, by columns, with a state.
    fn axes_with(&self, k: usize, state: usize) -> f64 {
        self.covariance[(AXES.start() + k, state)]
    }

    /// Adds variance to the soft iron by the traceless pattern T.
    pub(crate) fn add_soft_iron_variance(&mut self, variance: f64) {
        let diagonal = Matrix3::from_diagonal_element(1.0 + TRACE_SHARE) - Matrix3::repeat(1.0 / 3.0);
        let mut pattern = SMatrix::<f64, 6, 6>::identity() * (0.5 * variance);
        pattern.fixed_view_mut::<3, 3>(0, 0).copy_from(&(diagonal * variance));
        self.add(SOFT_IRON, &pattern);
    }

    /// Corrects by R measured numbers, and keeps P positive definite for ever.
    #[inline(always)]
    pub(super) fn correct_soundly<const R: usize>(
        &mut self,
        gain: &SMatrix<f64, STATES, R>,
        white: &SVector<f64, R>,
        held: Held<'_>,
    ) {
        self.correct(gain, white, held);
        self.raise(FIELD);
        self.raise(HARD_IRON);
        self.raise(SOFT_IRON);
        self.raise(BIAS);
        self.raise(DELAY);
        self.raise(AXES);
        self.raise(LOCAL);
    }
}

/// A state, or a small change of one, by its parts: E and S as matrices.
#[derive(Clone, Copy)]
pub(crate) struct Parts {
    pub(crate) field: Vector3<f64>,
    pub(crate) hard_iron: Vector3<f64>,
    /// E.
    pub(crate) iron: Matrix3<f64>,
    pub(crate) bias: Vector3<f64>,
    pub(crate) delay: f64,
    /// S.
    pub(crate) axes: Matrix3<f64>,
    pub(crate) local: Vector3<f64>,
}

impl Parts {
    #[inline(always)]
    pub(crate) fn of(x: impl Fn(usize) -> f64) -> Self {
        let vector = |i| Vector3::new(x(i), x(i + 1), x(i + 2));
        let axes = AXES.start();
        Self {
            field: vector(FIELD.start()),
            hard_iron: vector(HARD_IRON.start()),
            iron: Matrix3::from(ELEMENT.map(|column| column.map(|k| x(SOFT_IRON.start() + k)))),
            bias: vector(BIAS.start()),
            delay: x(DELAY.start()),
            axes: Matrix3::from_columns(&[vector(axes), vector(axes + 3), vector(axes + 6)]),
            local: vector(LOCAL.start()),
        }
    }

    /// M of a state.
    pub(crate) fn soft_iron(&self) -> Matrix3<f64> {
        Matrix3::identity() + self.iron
    }

    /// W = M^-1, and c = W (raw - b) of a raw sample at its own time, uT. `None` while M has no inverse.
    pub(crate) fn corrected(&self, raw_ut: &Vector3<f64>) -> Option<(Matrix3<f64>, Vector3<f64>)> {
        let w = inverse(&self.soft_iron())?;
        Some((w, w * (raw_ut - self.hard_iron)))
    }

    /// How the device turned in `dt_s` in which the gyroscope's readings add up to `increment`: (I - S) increment - g dt.
    pub(crate) fn turned(&self, increment: &Vector3<f64>, dt_s: f64) -> Vector3<f64> {
        increment - self.axes * increment - self.bias * dt_s
    }

    /// The skew part of S: the turn from the magnetometer's axes, which m, b, e and d have, to those of the device, rad.
    pub(crate) fn misalignment(&self) -> Vector3<f64> {
        Vector3::from(SKEW.map(|(a, b)| 0.5 * (self.axes[a] - self.axes[b])))
    }

    /// The device's rate for a gyroscope's reading.
    pub(crate) fn true_rate(&self, reading: &Vector3<f64>) -> Vector3<f64> {
        self.turned(reading, 1.0)
    }
}

/// The covariance of N states with R numbers that are linear in the state; `p(k, i)` is that of the k-th of them with state i.
#[inline(always)]
pub(crate) fn covariance<const N: usize, const R: usize>(
    p: impl Fn(usize, usize) -> f64,
    linear: impl Fn(&Parts) -> SVector<f64, R>,
) -> SMatrix<f64, N, R> {
    let mut to = SMatrix::<f64, N, R>::zeros();
    for k in 0..N {
        to.row_mut(k).tr_copy_from(&linear(&Parts::of(|i| p(k, i))));
    }
    to
}
