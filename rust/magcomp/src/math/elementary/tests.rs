//! Against nalgebra's, and of the functions what must hold to the bit.

use super::{atan2, cbrt, cos, exp, hypot, ln, quaternion, rotation_vector, sin, sin_cos};
use nalgebra::{UnitQuaternion, Vector3};

#[test]
fn quaternions_and_vectors_are_those_of_nalgebra() {
    let axis = Vector3::new(0.48, -0.6, 0.64);
    for angle_rad in [0.0, 1e-200, 1e-9, 1e-3, 0.1, 0.2499, 0.2501, 0.3, 0.499, 0.501, 3.1, 3.3, 6.2, 40.0] {
        let v = axis * angle_rad;
        let (ours, theirs) = (quaternion(&v), UnitQuaternion::from_scaled_axis(v));
        assert!((ours.into_inner() - theirs.into_inner()).norm() < 1e-15, "{v:?}");
        assert!((rotation_vector(&ours) - theirs.scaled_axis()).norm() < 1e-14, "{v:?}");
        let other_sign = UnitQuaternion::new_unchecked(-ours.into_inner());
        assert!((rotation_vector(&other_sign) - theirs.scaled_axis()).norm() < 1e-14, "{v:?}");
    }
}

/// The bits of each function at arguments where platforms differ or might: whatever the platform, these are them.
#[test]
fn bits_are_the_same_everywhere() {
    let mut hash = 0_u64;
    let mut add = |v: f64| hash = hash.rotate_left(5).wrapping_mul(0x0100_0000_01b3) ^ v.to_bits();
    for k in 0..20_000 {
        let x = f64::from(k - 10_000) * 0.001_234_567;
        let (sin_x, cos_x) = sin_cos(x);
        assert_eq!((sin_x.to_bits(), cos_x.to_bits()), (sin(x).to_bits(), cos(x).to_bits()));
        let positive = f64::from(k + 1) * 0.000_987_654_3;
        [sin_x, cos_x, exp(x), ln(positive), cbrt(x), hypot(x, positive), atan2(x, 1.7 - positive)]
            .into_iter()
            .for_each(&mut add);
    }
    assert_eq!(hash, 0x89a3_bfed_2bf4_3505);
}
