//! Something that changes with time: a value to start from and a list of changes.
//!
//! One rule makes every disturbance of the experiments: a step is a change that takes no time, a ramp one that does,
//! a pulse two steps, repeated steps many.

use crate::parameters::Parameters;
use magcomp::nalgebra::Vector3;

/// Values between which a schedule can interpolate.
pub trait Between: Copy {
    /// `self` at share 0, `to` at share 1, linear between.
    #[must_use]
    fn between(self, to: Self, share: f64) -> Self;
}

impl Between for Vector3<f64> {
    fn between(self, to: Self, share: f64) -> Self {
        self.lerp(&to, share)
    }
}

impl Between for Parameters {
    fn between(self, to: Self, share: f64) -> Self {
        Self {
            soft_iron: self.soft_iron * (1.0 - share) + to.soft_iron * share,
            hard_iron: self.hard_iron.lerp(&to.hard_iron, share),
        }
    }
}

/// One change of a [`Schedule`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Change<T> {
    /// When it begins, s.
    pub at_s: f64,
    /// How long it takes, s; 0 for a step.
    pub over_s: f64,
    /// The value afterwards.
    pub to: T,
}

/// A value over time.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule<T> {
    /// The value before any change.
    pub start: T,
    /// Changes in the order of their times, none beginning before the one ahead of it has ended.
    pub changes: Vec<Change<T>>,
}

impl<T: Between> Schedule<T> {
    /// Never changes.
    #[must_use]
    pub fn constant(start: T) -> Self {
        Self { start, changes: Vec::new() }
    }

    /// Becomes `to` at `at_s`.
    #[must_use]
    pub fn step(start: T, at_s: f64, to: T) -> Self {
        Self::ramp(start, at_s, 0.0, to)
    }

    /// Goes to `to` between `at_s` and `at_s + over_s`.
    #[must_use]
    pub fn ramp(start: T, at_s: f64, over_s: f64, to: T) -> Self {
        Self { start, changes: vec![Change { at_s, over_s, to }] }
    }

    /// Is `to` between `at_s` and `at_s + for_s`.
    #[must_use]
    pub fn pulse(start: T, at_s: f64, for_s: f64, to: T) -> Self {
        let change = |at_s, to| Change { at_s, over_s: 0.0, to };
        Self { start, changes: vec![change(at_s, to), change(at_s + for_s, start)] }
    }

    /// Steps to the next of `values` every `period_s`.
    #[must_use]
    pub fn repeated(start: T, period_s: f64, values: impl IntoIterator<Item = T>) -> Self {
        let step = |(k, to)| Change { at_s: period_s * (k as f64 + 1.0), over_s: 0.0, to };
        Self { start, changes: values.into_iter().enumerate().map(step).collect() }
    }

    /// The value at a time, s.
    #[must_use]
    pub fn at(&self, time_s: f64) -> T {
        let mut value = self.start;
        for change in self.changes.iter().take_while(|change| time_s >= change.at_s) {
            let elapsed_s = time_s - change.at_s;
            if elapsed_s < change.over_s {
                return value.between(change.to, elapsed_s / change.over_s);
            }
            value = change.to;
        }
        value
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn x_at(schedule: &Schedule<Vector3<f64>>, times: &[f64]) -> Vec<f64> {
        times.iter().map(|t| schedule.at(*t).x).collect()
    }

    #[test]
    fn every_shape_is_where_it_should_be() {
        let (zero, one) = (Vector3::zeros(), Vector3::x());
        assert_eq!(x_at(&Schedule::constant(one), &[0.0, 9.0]), [1.0, 1.0]);
        assert_eq!(x_at(&Schedule::step(zero, 5.0, one), &[4.999, 5.0]), [0.0, 1.0]);
        assert_eq!(x_at(&Schedule::ramp(zero, 5.0, 2.0, one), &[5.0, 6.0, 7.0]), [0.0, 0.5, 1.0]);
        assert_eq!(x_at(&Schedule::pulse(zero, 5.0, 1.0, one), &[4.9, 5.5, 6.0]), [0.0, 1.0, 0.0]);
        let repeated = Schedule::repeated(zero, 1.0, [one, zero, one * 2.0]);
        assert_eq!(x_at(&repeated, &[0.5, 1.5, 2.5, 99.0]), [0.0, 1.0, 0.0, 2.0]);
    }
}
