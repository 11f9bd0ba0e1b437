//! The least-squares fit of all groups of a start.
//!
//! ```text
//! mean raw of a group = M (u + tau w x u) + b,   u = back h,   M = I + E
//! least   sum |raw - model|^2 / v + |x - x_0|^2_W          x = (h, b, e, g, tau, s), 25 numbers
//! v = sigma^2 / n + (place^2 + misfit) t_c / t             t: seconds of the group, t_c = 1 s: a room's field is correlated
//! ```
//! Source: docs/dev/METHOD-AIDED.md, Start; b and e by variable projection; the descent: `math/descend`.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::groups::{Groups, Seen};
use super::measure::Model;
use super::state::{AXES, BIAS, CALIBRATION, DELAY, FIELD, HARD_IRON, LOCAL, Parts, SOFT_IRON};
use crate::calibration::iron_rows;
use crate::math::descend::{Cost, Derivatives, Descent, Limits, descend};

/// Length of x = (h, b, e, g, tau, s): the state without d.
pub(super) const UNKNOWNS: usize = LOCAL.start();
/// Choice: steps of a fit at most, as a sample must not cost much; one that has not converged goes on with the next group.
const LIMITS: Limits = Limits { iterations: 8, dampings: 8 };
/// Mathematics: a step that lowers the cost, a chi-squared, by less than this moves x by less than a tenth of its standard deviation.
const CONVERGED: f64 = 0.01;

pub(super) type Vector = SVector<f64, UNKNOWNS>;
pub(super) type Matrix = SMatrix<f64, UNKNOWNS, UNKNOWNS>;

/// What a fit knows beside the samples.
pub(super) struct Prior {
    pub(super) mean: Vector,
    pub(super) precision: Matrix,
    pub(super) noise_ut2: f64,
    /// Variance per axis of the unevenness of the place, times the seconds over which it is correlated, uT^2 s.
    pub(super) place_ut2_s: f64,
}

impl Prior {
    /// Variance per axis of a group's mean sample, uT^2.
    pub(super) fn variance(&self, mean: &Seen) -> f64 {
        self.noise_ut2 / mean.count + self.place_ut2_s / mean.moved_s
    }
}

/// A place x: the cost there with its derivatives, and what the samples say of the residuals.
#[derive(Default)]
pub(super) struct Normal {
    pub(super) x: Vector,
    pub(super) cost: f64,
    pub(super) curvature: Matrix,
    pub(super) slope: Vector,
    /// Sum of |raw - model|^2, groups, their samples and seconds.
    pub(super) residual_ut2: f64,
    pub(super) groups: f64,
    pub(super) count: f64,
    pub(super) moved_s: f64,
    /// Mean of `back`.
    pub(super) back: Matrix3<f64>,
}

/// The cost of a start, over (h, g, tau, s): b and e are solved for exactly at each place.
struct Batch<'a> {
    groups: &'a Groups,
    prior: &'a Prior,
}

impl Batch<'_> {
    /// x with b and e at their best for its (h, g, tau, s).
    fn place(&self, mut x: Vector) -> Option<Normal> {
        CALIBRATION.set(&mut x, &SVector::zeros());
        let at = normal(self.groups, self.prior, &x);
        let linear = CALIBRATION.block(&at.curvature).cholesky()?;
        CALIBRATION.set(&mut x, &linear.solve(&CALIBRATION.of(&at.slope)));
        Some(normal(self.groups, self.prior, &x))
    }
}

impl Cost<UNKNOWNS> for Batch<'_> {
    type Place = Normal;

    fn value(&self, at: &Normal) -> f64 {
        at.cost
    }

    fn derivatives(&self, at: &Normal) -> Derivatives<UNKNOWNS> {
        Derivatives { gradient: -at.slope, hessian: at.curvature }
    }

    /// The curvature that is left once b and e have adapted.
    fn scale(&self, _at: &Normal, hessian: &Matrix) -> Vector {
        let Some(linear) = CALIBRATION.block(hessian).cholesky() else { return hessian.diagonal() };
        let cross = hessian.fixed_rows::<9>(CALIBRATION.start()).into_owned();
        let adapted = linear.solve(&cross);
        Vector::from_fn(|k, _| {
            if CALIBRATION.range().contains(&k) {
                0.0
            } else {
                (hessian[(k, k)] - cross.column(k).dot(&adapted.column(k))).max(0.0)
            }
        })
    }

    fn after(&self, from: &Normal, step: &Vector) -> Option<Normal> {
        self.place(from.x + step)
    }
}

/// Descends from a guess of x. Returns the place, and why it ended there.
pub(super) fn fit(groups: &Groups, prior: &Prior, from: Vector) -> Option<Descent<Normal>> {
    let batch = Batch { groups, prior };
    Some(descend(&batch, batch.place(from)?, LIMITS, |step| step.gain < CONVERGED))
}

/// The cost at x with its derivatives.
fn normal(groups: &Groups, prior: &Prior, x: &Vector) -> Normal {
    let off = x - prior.mean;
    let pull = prior.precision * off;
    let mut it = Normal { x: *x, cost: off.dot(&pull), slope: -pull, ..Normal::default() };
    it.curvature.copy_from(&prior.precision);
    let x = parts(x);
    for mean in groups.means(&x) {
        let v = prior.variance(&mean);
        let (j, residual) = model(&x, &mean);
        let size = residual.norm_squared();
        it.cost += size / v;
        // column by column: the product of all takes much of the stack
        let to = j.transpose();
        for (mut column, of) in it.curvature.column_iter_mut().zip(j.column_iter()) {
            column += to * of / v;
        }
        it.slope += to * residual / v;
        it.residual_ut2 += size;
        it.groups += 1.0;
        it.count += mean.count;
        it.moved_s += mean.moved_s;
        it.back += mean.back * mean.count;
    }
    it.back /= it.count.max(1.0);
    it
}

/// x as a state without d.
pub(super) fn parts(x: &Vector) -> Parts {
    Parts::of(|i| if i < UNKNOWNS { x[i] } else { 0.0 })
}

/// The derivative of a group's mean sample by x, and what it differs from the model by, uT.
pub(super) fn model(x: &Parts, mean: &Seen) -> (SMatrix<f64, 3, UNKNOWNS>, Vector3<f64>) {
    let model = Model::of(&Parts { field: mean.back * x.field, ..*x }, &mean.rate_rad_s, 0.0);
    let by_gyroscope = model.by_field * mean.by_gyroscope;
    let mut j = SMatrix::<f64, 3, UNKNOWNS>::zeros();
    j.fixed_columns_mut::<3>(FIELD.start()).copy_from(&(model.by_field * mean.back));
    j.fixed_columns_mut::<3>(HARD_IRON.start()).copy_from(&Matrix3::identity());
    j.fixed_columns_mut::<6>(SOFT_IRON.start()).copy_from(&iron_rows(&model.seen));
    j.fixed_columns_mut::<3>(BIAS.start()).copy_from(&by_gyroscope.fixed_columns::<3>(0));
    j.fixed_columns_mut::<9>(AXES.start()).copy_from(&by_gyroscope.fixed_columns::<9>(3));
    j.set_column(DELAY.start(), &model.by_delay);
    (j, mean.raw_ut - model.raw_ut)
}
