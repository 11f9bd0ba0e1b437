//! The rotation by a vector, and how it changes with that vector.
//!
//! ```text
//! R = exp([v]x) = I + sin a / a [v]x + (1 - cos a) / a^2 [v]x^2,   a = |v|          (Rodrigues)
//! J_l = I + (1 - cos a) / a^2 [v]x + (a - sin a) / a^3 [v]x^2:   exp([v + dv]x) = exp([J_l dv]x) exp([v]x)
//! ```

#[cfg(test)]
mod tests;

use crate::math::elementary::turn_factors;
use nalgebra::{Matrix3, Vector3};

/// A rotation by a vector.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Turn {
    /// R.
    pub rotation: Matrix3<f64>,
    /// J_l.
    pub left_jacobian: Matrix3<f64>,
}

impl Turn {
    /// By the angle |v|, in radians, about v.
    #[inline(always)]
    pub fn by(v: &Vector3<f64>) -> Self {
        let angle2 = v.norm_squared();
        let [first, second, third] = turn_factors(angle2);
        let (k, k2) = (v.cross_matrix(), v * v.transpose() - Matrix3::identity() * angle2);
        Self {
            rotation: Matrix3::identity() + k * first + k2 * second,
            left_jacobian: Matrix3::identity() + k * second + k2 * third,
        }
    }
}
