//! The rotation by a vector, and how it changes with that vector.
//!
//! ```text
//! R = exp([v]x) = I + sin a / a [v]x + (1 - cos a) / a^2 [v]x^2,   a = |v|          (Rodrigues)
//! J_l = I + (1 - cos a) / a^2 [v]x + (a - sin a) / a^3 [v]x^2:   exp([v + dv]x) = exp([J_l dv]x) exp([v]x)
//! ```

#[cfg(test)]
mod tests;

use crate::math::elementary::sin_cos;
use nalgebra::{Matrix3, Vector3};

/// Mathematics: below this angle the series is more exact than the closed form, rad: what it leaves out is 1e-18.
const SMALL_RAD: f64 = 1e-4;

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
    pub fn by(v: &Vector3<f64>) -> Self {
        let angle2 = v.norm_squared();
        let angle = angle2.sqrt();
        let (first, second, third) = if angle < SMALL_RAD {
            (1.0 - angle2 / 6.0, 0.5 - angle2 / 24.0, 1.0 / 6.0 - angle2 / 120.0)
        } else {
            let (sin, cos) = sin_cos(angle);
            (sin / angle, (1.0 - cos) / angle2, (angle - sin) / (angle2 * angle))
        };
        let k = v.cross_matrix();
        let k2 = k * k;
        Self {
            rotation: Matrix3::identity() + k * first + k2 * second,
            left_jacobian: Matrix3::identity() + k * second + k2 * third,
        }
    }
}
