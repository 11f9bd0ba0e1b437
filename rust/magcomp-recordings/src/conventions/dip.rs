//! The angle between gravity and the field: how large it is, and whether it stays the same however the device turns. Where it does not, and would with
//! one of the two in other axes, somebody mixed up two frames.
//!
//! ```text
//! z = <a' c>: the mean over a window of gravity (in g) along the field's direction;   z_G: with G a in place of a, G one of the 24 right-handed frames
//! ```
//! A gravity that points the other way keeps its angle, too: that only a place's known dip tells.

use super::axes::turns;
use super::windows::{Event, Series, median};
use magcomp::nalgebra::{Matrix3, Vector3};
use magcomp::{FitOptions, fit_ellipsoid};

/// Gravity for the dip is averaged over this: a turn blurs it.
const UP_S: f64 = 0.2;
/// A window, s: swings of a hand average out.
const WINDOW_S: f64 = 0.5;
/// Windows of a part, by each of which the axes are told.
const PART: usize = 50;
const FEWEST: usize = 16;
/// Spread of z where the angle stays the same: a sine of 10 degrees; and where it is no proof that it does not: of 25 degrees.
const SAME: f64 = 0.17;
const OTHER: f64 = 0.42;
/// Field samples that the ellipsoid is fitted to.
const FITTED: usize = 2000;
const STANDARD_G: f64 = 9.80665;
/// A dip of a smaller size has no sign.
pub(super) const LEAST_DIP_DEG: f64 = 20.0;

/// The corrected field at each of its times: about the centre that the gyroscope tells, else about that of an ellipsoid.
pub(super) fn corrected(field: &Series, centre: Option<Vector3<f64>>) -> Option<Series> {
    if let Some(centre) = centre {
        return Some(field.iter().map(|(time_s, value)| (*time_s, value - centre)).collect());
    }
    let every = field.len().div_ceil(FITTED).max(1);
    let points: Vec<Vector3<f64>> = field.iter().step_by(every).map(|(_, value)| *value).collect();
    let fit = fit_ellipsoid(&points, &FitOptions::default()).ok()?;
    Some(field.iter().map(|(time_s, value)| (*time_s, fit.calibration.correct(value))).collect())
}

/// Field and averaged gravity at the field's times.
fn pairs<'a>(field: &'a [Event], up: &'a [Event]) -> impl Iterator<Item = (f64, Vector3<f64>, Vector3<f64>)> + 'a {
    let mut averaged: Option<Vector3<f64>> = None;
    let (mut next, mut before_s) = (0, 0.0);
    field.iter().filter_map(move |(time_s, value)| {
        while let Some((up_s, up)) = up.get(next).filter(|event| event.0 <= *time_s) {
            let mean = averaged.get_or_insert(*up);
            *mean += (up - *mean) * ((up_s - before_s) / UP_S).clamp(0.0, 1.0);
            (before_s, next) = (*up_s, next + 1);
        }
        Some((*time_s, *value, averaged?))
    })
}

/// The field's angle below the horizon, degrees; none without gravity, or where it is not clear. `field` is corrected.
pub(super) fn dip_deg(field: &[Event], up: &[Event], axes: &Matrix3<f64>) -> Option<f64> {
    let sines = pairs(field, up).map(|(_, value, up)| {
        let turned = axes * value;
        -turned.dot(&up) / (turned.norm() * up.norm())
    });
    let dips: Vec<f64> =
        sines.filter(|sine| sine.is_finite()).map(|sine| sine.clamp(-1.0, 1.0).asin().to_degrees()).collect();
    (dips.len() > 50).then(|| median(dips))
}

/// What the angle between gravity and field says of their axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Angle {
    /// It stays the same, and would not in other axes.
    Same,
    /// It would stay the same with gravity in these axes.
    OtherAxes(Matrix3<f64>),
}

/// Of a corrected field; none where the motion does not tell it.
pub(super) fn angle(field: &[Event], up: &[Event]) -> Option<Angle> {
    let mut windows: Vec<Matrix3<f64>> = Vec::new();
    let (mut sum, mut samples, mut begin_s) = (Matrix3::zeros(), 0.0, f64::NEG_INFINITY);
    for (time_s, value, up) in pairs(field, up) {
        let product = value.normalize() * up.transpose() / STANDARD_G;
        if !product.iter().all(|part| part.is_finite()) {
            continue;
        }
        if time_s - begin_s >= WINDOW_S {
            if samples > 0.0 {
                windows.push(sum / samples);
            }
            (sum, samples, begin_s) = (Matrix3::zeros(), 0.0, time_s);
        }
        sum += product;
        samples += 1.0;
    }
    let frames: Vec<Matrix3<f64>> = turns().into_iter().filter(|frame| frame.determinant() > 0.0).collect();
    let mut votes = vec![0_usize; frames.len()];
    let mut parts = 0;
    for part in windows.chunks(PART).filter(|part| part.len() >= FEWEST) {
        parts += 1;
        // z of a frame G: the sum of (c a') over the elements that G joins
        let spread = |frame: &Matrix3<f64>| {
            let z: Vec<f64> = part.iter().map(|window| window.dot(frame)).collect();
            let mean = z.iter().sum::<f64>() / z.len() as f64;
            (z.iter().map(|z| (z - mean).powi(2)).sum::<f64>() / z.len() as f64).sqrt()
        };
        let spreads: Vec<f64> = frames.iter().map(spread).collect();
        let mut order: Vec<usize> = (0..frames.len()).collect();
        order.sort_by(|a, b| spreads[*a].total_cmp(&spreads[*b]));
        // it stays the same in one frame, and clearly not in the next
        if spreads[order[0]] < SAME && spreads[order[1]] > OTHER.min(3.0 * spreads[order[0]].max(0.05)) {
            votes[order[0]] += 1;
        }
    }
    let best = (0..frames.len()).max_by_key(|k| votes[*k]).filter(|k| 2 * votes[*k] > parts)?;
    Some(if frames[best] == Matrix3::identity() { Angle::Same } else { Angle::OtherAxes(frames[best]) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use magcomp::nalgebra::Rotation3;

    /// A hand turns a device about; its accelerometer reads `axes` times what it should, moved by so many g; the field is off by `left_ut`.
    fn turned(seconds: f64, axes: Matrix3<f64>, moved_g: f64, left_ut: Vector3<f64>) -> Option<Angle> {
        let mut attitude = Rotation3::identity();
        let (mut field, mut up) = (Series::new(), Series::new());
        for k in 0..(seconds * 50.0) as i32 {
            let t = f64::from(k) * 0.02;
            let rate = Vector3::new((0.9 * t).sin(), (1.3 * t + 1.0).cos(), 0.8 * (0.5 * t).sin());
            attitude *= Rotation3::new(rate * 0.02);
            let moved = Vector3::new((1.9 * t).sin(), (2.3 * t).cos(), (3.0 * t).sin()) * moved_g;
            up.push((t, axes * (attitude.inverse() * Vector3::z() + moved) * STANDARD_G));
            field.push((t, attitude.inverse() * Vector3::new(0.0, 25.0, -43.0) + left_ut));
        }
        angle(&field, &up)
    }

    #[test]
    fn gravity_in_other_axes_is_found_and_sound_sensors_are_not_suspected() {
        let none = Vector3::zeros();
        assert_eq!(turned(60.0, Matrix3::identity(), 0.03, none), Some(Angle::Same));
        let swapped = Matrix3::from_row_slice(&[0.0, 1.0, 0.0, -1.0, 0.0, 0.0, 0.0, 0.0, 1.0]);
        // what mends it is the way back
        assert_eq!(turned(60.0, swapped, 0.03, none), Some(Angle::OtherAxes(swapped.transpose())));
        // too short; moved with half of gravity, where nothing can be said
        assert_eq!(turned(5.0, swapped, 0.03, none), None);
        for moved_g in [0.3, 0.5, 1.0] {
            let found = turned(60.0, Matrix3::identity(), moved_g, none);
            assert!(matches!(found, None | Some(Angle::Same)), "{moved_g}: {found:?}");
        }
        // a field that is off by a quarter
        let found = turned(60.0, Matrix3::identity(), 0.03, Vector3::new(9.0, 0.0, -9.0));
        assert!(matches!(found, None | Some(Angle::Same)), "{found:?}");
    }
}
