use super::*;
use crate::noise::Lasting;

fn frame(u: Vector3<f64>) -> Frame {
    Frame { u, white: 1e-4, uneven: Lasting { phi: 1.0, variance: 0.01 }, ..Frame::default() }
}

/// Turns about z at a height of 0.4, and nods by this amplitude, rad; white noise of 0.01 along each axis; the frames are seen from (0, 0, 0.4).
fn turned(nod: f64, frames: usize) -> Spread {
    let mut state = 1_u64;
    let mut normal = || {
        let mut uniform = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 11) as f64 / (1u64 << 53) as f64
        };
        (0..12).map(|_| uniform()).sum::<f64>() - 6.0
    };
    let mut spread = Spread::new(Matrix3::from_diagonal_element(0.25), 0.04, 1.0);
    for k in 0..frames {
        let (sin, cos) = (k as f64 * 0.1).sin_cos();
        let noise = Vector3::new(normal(), normal(), normal()) * 0.01;
        let direction = Vector3::new(cos, sin, nod * (k as f64 * 0.37).sin()).normalize();
        spread.add(&frame(direction + Vector3::z() * 0.4 + noise), &direction, 2e-4);
    }
    spread
}

#[test]
fn turns_about_one_axis_tell_nothing_along_it() {
    let (axis, least) = turned(0.0, 400).least(&Matrix3::identity()).expect("frames");
    assert!(axis.z.abs() > 0.999, "{axis}");
    assert!((least - 0.25).abs() < 0.005, "{least} of 0.25");
}

#[test]
fn turns_about_two_axes_are_as_good_as_their_derivatives_say() {
    for frames in [100, 400] {
        let (axis, least) = turned(0.1, frames).least(&Matrix3::identity()).expect("frames");
        assert!(axis.z.abs() > 0.999, "{axis}");
        // each frame tells nod^2 / 2 over its variance of 2e-4; noise widens the spread, and the limit takes two deviations of chance off
        let ratio = least * frames as f64 * 0.005 / 2e-4;
        assert!(ratio > 0.9 && ratio < 1.1, "{frames}: {ratio}");
    }
}

#[test]
fn an_axis_of_known_mean_directions_is_known() {
    // all frames in one direction: along it beta is as well known as the strength and what lasts of the unevenness
    let mut spread = turned(0.0, 0);
    for k in 0..50 {
        let off = Vector3::new(0.0, (f64::from(k) * 0.3).sin(), (f64::from(k) * 0.7).cos()) * 0.2;
        spread.add(&frame(Vector3::x() + off), &Vector3::x(), 2e-4);
    }
    let (axis, least) = spread.least(&Matrix3::identity()).expect("frames");
    assert!(axis.x.abs() > 0.99, "{axis}");
    assert!((least - 1.0 / (1.0 / 0.25 + 1.0 / (0.04 + 0.01))).abs() < 1e-3, "{least}");
}

#[test]
fn a_centre_that_walks_is_forgotten() {
    let mut spread = turned(0.1, 400);
    let before = spread.least(&Matrix3::identity()).expect("frames").1;
    spread.walk(0.01);
    let after = spread.least(&Matrix3::identity()).expect("frames").1;
    assert!(after > 2.5 * before && after < 3.5 * before, "{before} to {after}");
}
