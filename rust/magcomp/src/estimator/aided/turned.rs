//! How the device turned over several samples, and what the gyroscope's errors add to that.
//!
//! ```text
//! turn <- r turn,   G <- r G + (dt, increment') (x) I         r: a sample's turn as it is read
//! with the gyroscope's bias g and scale error s:  exp([G (g, s)]x) turn
//! ```
//! Source: docs/dev/METHOD-AIDED.md, Start.

use nalgebra::{Matrix3, SMatrix, SVector, Vector3};

use super::state::Parts;
use crate::math::turn::Turn;

/// See the module.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(super) struct Turned {
    pub(super) turn: Matrix3<f64>,
    /// G.
    pub(super) by_gyroscope: SMatrix<f64, 3, 12>,
    pub(super) seconds: f64,
}

impl Default for Turned {
    fn default() -> Self {
        Self { turn: Matrix3::identity(), by_gyroscope: SMatrix::zeros(), seconds: 0.0 }
    }
}

impl Turned {
    /// A step of the gyroscope, its errors not removed. Returns r.
    pub(super) fn step(&mut self, increment_rad: &Vector3<f64>, dt_s: f64) -> Matrix3<f64> {
        let r = Turn::by(&-increment_rad).rotation;
        self.turn = r * self.turn;
        self.by_gyroscope = r * self.by_gyroscope;
        for (k, read) in increment_rad.push(dt_s).iter().enumerate() {
            // dt is last, and the bias first
            let first = 3 * ((k + 1) % 4);
            (0..3).for_each(|axis| self.by_gyroscope[(axis, first + axis)] += read);
        }
        self.seconds += dt_s;
        r
    }

    /// This, and then the next.
    pub(super) fn joined(&self, next: &Self) -> Self {
        Self {
            turn: next.turn * self.turn,
            by_gyroscope: next.turn * self.by_gyroscope + next.by_gyroscope,
            seconds: self.seconds + next.seconds,
        }
    }

    /// What (g, s) adds to the turn, rad.
    pub(super) fn added(&self, x: &Parts) -> Vector3<f64> {
        let mut errors = SVector::<f64, 12>::zeros();
        errors.fixed_rows_mut::<3>(0).copy_from(&x.bias);
        errors.fixed_rows_mut::<9>(3).copy_from_slice(x.axes.as_slice());
        self.by_gyroscope * errors
    }
}
