//! The elementary functions that no processor rounds by a standard: the one door to them.
//!
//! They come from the crate `libm`, which is plain arithmetic, so that a reading has the same bits on every platform; the platform's own library rounds
//! the last bit as it likes. `clippy.toml` of the core refuses `f64`'s and nalgebra's. `sqrt`, `mul_add` and what rounds to whole numbers are exact
//! everywhere and stay those of `f64`. `powi` is a product; of which factors first is the compiler's to say, so its powers here are small.
//!
//! ```text
//! q = (cos(|v| / 2), sin(|v| / 2) v / |v|),   v = 2 atan2(|q_v|, q_w) q_v / |q_v|           the unit quaternion of a rotation vector, and back
//! sin a / a = sum (-a^2)^k / (2 k + 1)!,   (1 - cos a) / a^2 = sum (-a^2)^k / (2 k + 2)!,   (a - sin a) / a^3 = sum (-a^2)^k / (2 k + 3)!
//! asin s / s = sum c_k s^(2 k),   c_k = c_{k-1} (2 k - 1)^2 / (2 k (2 k + 1))
//! ```
//! The series are used below a quarter of a radian, where they are as exact as rounding and a third of the work.

#[cfg(test)]
mod tests;

#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Quaternion, UnitQuaternion, Vector3};

pub(crate) use libm::{atan2, cbrt, cos, exp, log as ln, sin, sincos as sin_cos};

/// The length of (a, b), whose squares are neither too large nor too small for a number.
pub(crate) fn hypot(a: f64, b: f64) -> f64 {
    (a * a + b * b).sqrt()
}

/// What a low-pass of `time_s` takes of a value that has lasted for `dt_s`.
pub(crate) fn gain(dt_s: f64, time_s: f64) -> f64 {
    (dt_s / time_s).min(1.0)
}

/// Mathematics: below this square of an angle, a quarter of a radian, six terms of the series leave out less than rounding does, rad^2.
const SMALL_RAD2: f64 = 0.0625;
/// Mathematics: the square of the sine of half of it, of which eight terms are as good.
const SMALL_SINE2: f64 = 0.015_544_7;
/// Mathematics: (-1)^k / (2 k + n)!
const TURN_SERIES: [[f64; 6]; 3] = [series(1), series(2), series(3)];
/// Mathematics: c_k.
const ARC_SERIES: [f64; 8] = arc_series();

const fn series(n: usize) -> [f64; 6] {
    let (mut factors, mut term, mut k) = ([0.0; 6], 1.0 / [1.0, 1.0, 2.0, 6.0][n], 0);
    while k < 6 {
        factors[k] = term;
        term /= -(((2 * k + n + 1) * (2 * k + n + 2)) as f64);
        k += 1;
    }
    factors
}

const fn arc_series() -> [f64; 8] {
    let (mut factors, mut k) = ([1.0; 8], 1);
    while k < 8 {
        factors[k] = factors[k - 1] * ((2 * k - 1) * (2 * k - 1)) as f64 / (2 * k * (2 * k + 1)) as f64;
        k += 1;
    }
    factors
}

fn sum_of<const N: usize>(factors: &[f64; N], x: f64) -> f64 {
    factors.iter().rev().fold(0.0, |sum, factor| sum * x + factor)
}

/// sin a / a, (1 - cos a) / a^2 and (a - sin a) / a^3, of a^2.
#[inline]
pub(crate) fn turn_factors(angle2: f64) -> [f64; 3] {
    if angle2 < SMALL_RAD2 {
        return [0, 1, 2].map(|n| sum_of(&TURN_SERIES[n], angle2));
    }
    let angle = angle2.sqrt();
    let (sin, cos) = sin_cos(angle);
    [sin / angle, (1.0 - cos) / angle2, (angle - sin) / (angle2 * angle)]
}

/// The rotation by the angle |v|, in radians, about v.
#[inline]
pub(crate) fn quaternion(v: &Vector3<f64>) -> UnitQuaternion<f64> {
    let half = v * 0.5;
    let half2 = half.norm_squared();
    let [sine, cosine, _] = turn_factors(half2);
    UnitQuaternion::new_unchecked(Quaternion::from_parts(1.0 - half2 * cosine, half * sine))
}

/// The vector of that rotation, at most pi long.
#[inline]
pub(crate) fn rotation_vector(q: &UnitQuaternion<f64>) -> Vector3<f64> {
    let imaginary = q.imag();
    let sine2 = imaginary.norm_squared();
    let half_by_sine = if sine2 < SMALL_SINE2 {
        sum_of(&ARC_SERIES, sine2)
    } else {
        let sine = sine2.sqrt();
        atan2(sine, q.w.abs()) / sine
    };
    imaginary * (2.0 * half_by_sine).copysign(q.w)
}
