//! The attitude of the device from a corrected field h and the direction of up, and its uncertainty.
//!
//! ```text
//! v_world = [E N up]^T v_device                        with the level frame of h (`level`)
//! phi: the small rotation of the world that takes the true attitude to the one found
//! phi_east, phi_north: up leans                     variance s_tilt^2 each
//! phi_up: h errs along E, or V leans into E         variance (E^T P E + V^2 s_tilt^2) / H^2
//! H = |h x up|, V = h . up, P: covariance of h
//! ```
//! The sum of the three variances is the same in every frame.

use crate::heading::angle_sigma_deg;
use crate::level::{Level, Tilt};
use crate::math::elementary::hypot;
use nalgebra::{Matrix3, Rotation3, UnitQuaternion, Vector3};

/// How the device lies in the world. It needs no reference axis, so it is known also where the axis of the heading is vertical.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct Attitude {
    /// Takes a vector of the device frame (not turned with the screen's content) to (east, north, up), north magnetic. Its w is at least 0.
    pub to_world: UnitQuaternion<f64>,
    /// One standard deviation: the root of the sum of the variances of the rotation error about three axes at right angles,
    /// degrees, 0 to 180. 180 where north is lost in its uncertainty; None when the calibration's own uncertainty is not known.
    pub sigma_deg: Option<f64>,
}

/// The attitude from a corrected field (uT) and `up` (any length), both in the device frame.
///
/// None when the field is vertical, or anything is not finite or of length zero. `sigma_deg` is left empty: see [`attitude_sigma_deg`].
#[must_use]
pub fn attitude(field_ut: &Vector3<f64>, up: &Vector3<f64>) -> Option<Attitude> {
    Some(of_level(&Level::of(field_ut, up)?))
}

/// The same of a field's level frame.
pub(crate) fn of_level(level: &Level) -> Attitude {
    let to_device = Rotation3::from_basis_unchecked(&[level.east, level.north, level.up]);
    let to_world = UnitQuaternion::from_rotation_matrix(&to_device.inverse());
    let to_world = if to_world.w < 0.0 { UnitQuaternion::new_unchecked(-to_world.into_inner()) } else { to_world };
    Attitude { to_world, sigma_deg: None }
}

/// One standard deviation of the attitude, as [`Attitude::sigma_deg`] defines it.
///
/// `field_ut` is the corrected field, `covariance_ut2` the covariance of its error (uT^2), `tilt_sigma_deg` the standard
/// deviation of `up` about a horizontal axis. None where [`attitude`] is.
#[must_use]
pub fn attitude_sigma_deg(
    field_ut: &Vector3<f64>,
    up: &Vector3<f64>,
    covariance_ut2: &Matrix3<f64>,
    tilt_sigma_deg: f64,
) -> Option<f64> {
    let level = Level::of(field_ut, up)?;
    let tilt = Tilt { sigma_deg: tilt_sigma_deg, ..Tilt::default() };
    sigma_of_level(&level, level.across_rad2(covariance_ut2), &tilt)
}

/// The same of a field's level frame, and of the part of it that the covariance makes ([`Level::across_rad2`]).
pub(crate) fn sigma_of_level(level: &Level, across_rad2: f64, tilt: &Tilt) -> Option<f64> {
    let about_up_rad2 = level.variance_of(across_rad2, tilt.variance_rad2(), tilt.common_rad2);
    let about_up_deg = angle_sigma_deg(about_up_rad2)?;
    let sigma = hypot(about_up_deg, tilt.sigma_deg * core::f64::consts::SQRT_2).min(180.0);
    sigma.is_finite().then_some(sigma)
}
