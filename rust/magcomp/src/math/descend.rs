//! The one damped descent (Levenberg 1944, Marquardt 1963) to a minimum of a cost f(x) >= 0 of N unknowns:
//!
//! ```text
//! (H + mu D) dx = -g,   x <- x + dx where that lowers f
//! g: half the gradient;  H: half the Hessian, or Gauss and Newton's in its place;  D: a scale for each unknown
//! mu: 0 as long as every step lowers f; else it grows until one does, and falls from there
//! ```

#[cfg(test)]
mod tests;

use super::ldl;
use nalgebra::{SMatrix, SVector};

/// Mathematics: a step without damping that raises the cost by no more than its rounding (relative) is taken: closer to the minimum than
/// the root of this the cost says nothing any more, the gradient still does.
const ROUNDING: f64 = 1e-11;
/// Choice: damping of the first step after one that did not lower the cost. Marquardt's own is 0.01; a start from the closed form or
/// from the fit before is nearer (`magcomp-tests`, `direct`).
const FIRST_DAMPING: f64 = 1e-4;
/// Mathematics: Marquardt's factors by which the damping grows and falls.
const GROWS: f64 = 10.0;
/// Mathematics: see `GROWS`.
const FALLS: f64 = 0.1;

/// Why a descent stopped. Each is an answer; `Stalled` and `MaxIterations` say how good.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub enum Termination {
    /// The last step was below the tolerance.
    Converged,
    /// No step lowers the cost any more: rounding decides.
    Stalled,
    /// The number of iterations ran out first.
    MaxIterations,
}

/// Of a cost at a place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Derivatives<const N: usize> {
    /// g, half the gradient.
    pub gradient: SVector<f64, N>,
    /// H, half the Hessian, of which the lower triangle is read.
    pub hessian: SMatrix<f64, N, N>,
}

/// A cost to be made least.
pub(crate) trait Cost<const N: usize> {
    /// x, with whatever was computed there.
    type Place;

    /// f.
    fn value(&self, at: &Self::Place) -> f64;

    /// g and H.
    fn derivatives(&self, at: &Self::Place) -> Derivatives<N>;

    /// D for this H. It is asked for only where damping is needed.
    fn scale(&self, _at: &Self::Place, hessian: &SMatrix<f64, N, N>) -> SVector<f64, N> {
        hessian.diagonal()
    }

    /// Where a step leads to. None: nowhere; a shorter one is tried.
    fn after(&self, from: &Self::Place, step: &SVector<f64, N>) -> Option<Self::Place>;
}

/// A step that was taken.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Step {
    /// Largest change of an unknown.
    pub size: f64,
    /// By how much it lowered the cost.
    pub gain: f64,
    /// mu.
    pub damping: f64,
}

/// How long a descent may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Limits {
    /// Steps, 1 or more.
    pub iterations: usize,
    /// Dampings that are tried for one step, 1 or more.
    pub dampings: usize,
}

/// Where a descent ended.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Descent<P> {
    pub place: P,
    pub iterations: usize,
    pub termination: Termination,
}

/// Descends from a place until `is_last` says so of a step.
pub(crate) fn descend<const N: usize, C: Cost<N>>(
    cost: &C,
    mut place: C::Place,
    limits: Limits,
    mut is_last: impl FnMut(&Step) -> bool,
) -> Descent<C::Place> {
    let mut damping = 0.0;
    for iteration in 1..=limits.iterations {
        let Some(step) = one_step(cost, &mut place, damping, limits.dampings) else {
            return Descent { place, iterations: iteration, termination: Termination::Stalled };
        };
        if is_last(&step) {
            return Descent { place, iterations: iteration, termination: Termination::Converged };
        }
        damping = if step.damping > FIRST_DAMPING { step.damping * FALLS } else { 0.0 };
    }
    Descent { place, iterations: limits.iterations, termination: Termination::MaxIterations }
}

/// Takes the step by the least damping, from `damping` on, that lowers the cost.
fn one_step<const N: usize, C: Cost<N>>(
    cost: &C,
    from: &mut C::Place,
    mut damping: f64,
    dampings: usize,
) -> Option<Step> {
    let Derivatives { gradient, hessian } = cost.derivatives(from);
    let value = cost.value(from);
    for _ in 0..dampings {
        let most = if damping == 0.0 { value * (1.0 + ROUNDING) } else { value };
        if let Some(step) = damped_step(cost, from, damping, &gradient, &hessian)
            && let Some(next) = cost.after(from, &step)
            && cost.value(&next) <= most
        {
            let gain = value - cost.value(&next);
            *from = next;
            return Some(Step { size: step.amax(), gain, damping });
        }
        damping = if damping == 0.0 { FIRST_DAMPING } else { damping * GROWS };
    }
    None
}

/// -(H + mu D)^-1 g. Not inlined: its matrices are off the stack while the cost is worked out where the step leads to.
#[inline(never)]
fn damped_step<const N: usize, C: Cost<N>>(
    cost: &C,
    from: &C::Place,
    damping: f64,
    gradient: &SVector<f64, N>,
    hessian: &SMatrix<f64, N, N>,
) -> Option<SVector<f64, N>> {
    let mut damped = *hessian;
    if damping > 0.0 {
        let scale = cost.scale(from, hessian);
        (0..N).for_each(|i| damped[(i, i)] += damping * scale[i]);
    }
    ldl::solve(&damped, &-gradient)
}
