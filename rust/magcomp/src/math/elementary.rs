//! The elementary functions that no processor rounds by a standard: the one door to them.
//!
//! They come from the crate `libm`, which is plain arithmetic, so that a reading has the same bits on every platform; the platform's own library rounds
//! the last bit as it likes. `clippy.toml` of the core refuses `f64`'s and nalgebra's. `sqrt`, `mul_add` and what rounds to whole numbers are exact
//! everywhere and stay those of `f64`. `powi` is a product; of which factors first is the compiler's to say, so its powers here are small.
//!
//! ```text
//! q = (cos(|v| / 2), sin(|v| / 2) v / |v|),   v = 2 atan2(|q_v|, q_w) q_v / |q_v|           the unit quaternion of a rotation vector, and back
//! ```

#[cfg(test)]
mod tests;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

pub(crate) use libm::{atan2, cbrt, cos, exp, log as ln, sin, sincos as sin_cos};

/// The length of (a, b), whose squares are neither too large nor too small for a number.
pub(crate) fn hypot(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

/// The rotation by the angle |v|, in radians, about v.
pub(crate) fn quaternion(v: &Vector3<f64>) -> UnitQuaternion<f64> {
    let half = v * 0.5;
    let half_rad = half.norm();
    if half_rad <= f64::EPSILON {
        return UnitQuaternion::identity();
    }
    let (sin, cos) = sin_cos(half_rad);
    UnitQuaternion::new_unchecked(Quaternion::from_parts(cos, half * (sin / half_rad)))
}

/// The vector of that rotation, at most pi long.
pub(crate) fn rotation_vector(q: &UnitQuaternion<f64>) -> Vector3<f64> {
    let imaginary = q.imag();
    let length = imaginary.norm();
    if length == 0.0 {
        return Vector3::zeros();
    }
    let angle_rad = 2.0 * atan2(length, q.w.abs());
    imaginary * (angle_rad / length).copysign(q.w)
}
