//! Heading, inclination and their uncertainty from a corrected field and the direction of up.
//!
//! The heading of a device axis a is atan2(a.E, a.N), with east and north of `level`: degrees clockwise from magnetic north, 0 to 360. Inclination: positive
//! when h points down.
//!
//! A tilt of `up` turns the heading of an axis (e, n, u) = (a.E, a.N, a.U), h = e^2 + n^2, as it leans
//! ```text
//! to east: V / H - n u / h + (n a'.E - e a'.N) / h,   to north: e u / h + (n a'.E - e a'.N) / h,   a': the change of an axis that follows `up`
//! ```
//!
//! Three reference axes, after turning the device frame by the screen rotation (so that x is the screen's right edge
//! and y its top edge, as the user sees it):
//! * the top edge: the classical compass of a phone lying flat; undefined when the phone is upright;
//! * the camera, -z: what the user looks at through an upright phone; undefined when it lies flat;
//! * automatic: the one horizontal direction in the plane of both, up x (right edge). It is the top edge when flat,
//!   the camera when upright, and passes through any pitch, overhead too, without a flip. Where the right edge itself
//!   points up (upright in landscape with the screen locked) that direction is undefined, and the camera takes over
//!   gradually. Some jump no choice can avoid: a screen locked to portrait turned further, to more than 126 deg from upright
//!   portrait, is taken as upside down.

#[cfg(test)]
mod tests;

use crate::config::{ReferenceAxis, ScreenRotation};
use crate::level::{Level, Tilt, VERTICAL};
use crate::math::elementary::atan2;
#[cfg(not(feature = "std"))]
use nalgebra::ComplexField as _;
use nalgebra::{Matrix3, Vector3};

impl ScreenRotation {
    /// The screen's right and top edge, as the user sees them, in the device frame.
    #[must_use]
    pub fn axes(self) -> (Vector3<f64>, Vector3<f64>) {
        let (x, y) = (Vector3::x(), Vector3::y());
        match self {
            Self::Deg0 => (x, y),
            Self::Deg90 => (-y, x),
            Self::Deg180 => (-x, -y),
            Self::Deg270 => (y, -x),
        }
    }
}

/// A heading and what belongs to it. All angles in degrees.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
#[cfg_attr(not(feature = "exhaustive"), non_exhaustive)]
pub struct Heading {
    /// Clockwise from magnetic north, 0 to 360.
    pub heading_deg: f64,
    /// One standard deviation of `heading_deg`, 0 to 180; None when the calibration's own uncertainty is not known.
    pub heading_sigma_deg: Option<f64>,
    /// Clockwise from true north, 0 to 360: heading_deg + declination. None without a declination.
    pub true_heading_deg: Option<f64>,
    /// Angle of the field below the horizon, -90 to 90. None where no field is known and north comes from outside.
    pub inclination_deg: Option<f64>,
}

/// Choice: where the right edge rises so far (sine of its elevation), 45 deg, the automatic axis begins to follow the camera: tests/host/headings.rs.
const RISE_BEGIN: f64 = 0.707;
/// Choice: ... and where it rises so far, 64 deg, the axis follows the camera alone.
const RISE_END: f64 = 0.9;
/// Choice: a vector whose standard deviation is so many times its length knows no direction at all: 115 deg, where an arc comes near half a turn.
const LOST_RATIO: f64 = 2.0;
/// Heading of a reference axis from a corrected field (uT) and `up` (any length), both in the device frame.
///
/// None when the field or the axis is vertical, or anything is not finite or of length zero. `heading_sigma_deg`
/// and `true_heading_deg` are left empty: see [`heading_sigma_deg`] and [`true_heading_deg`].
#[must_use]
pub fn heading(
    field_ut: &Vector3<f64>,
    up: &Vector3<f64>,
    axis: ReferenceAxis,
    rotation: ScreenRotation,
) -> Option<Heading> {
    of_level(&Level::of(field_ut, up)?, axis, rotation)
}

/// The same of a field's level frame.
pub(crate) fn of_level(level: &Level, axis: ReferenceAxis, rotation: ScreenRotation) -> Option<Heading> {
    let bearing_rad = level.bearing(&pointing(&level.up, axis, rotation), VERTICAL)?;
    Some(Heading {
        heading_deg: wrap_360(bearing_rad.to_degrees()),
        heading_sigma_deg: None,
        true_heading_deg: None,
        inclination_deg: Some(atan2(-level.vertical, level.horizontal).to_degrees()),
    })
}

/// The axis of the device the heading is that of, for a unit `up`.
fn pointing(up: &Vector3<f64>, axis: ReferenceAxis, rotation: ScreenRotation) -> Vector3<f64> {
    let (right, top) = rotation.axes();
    let camera = -Vector3::z();
    match axis {
        ReferenceAxis::TopEdge => top,
        ReferenceAxis::Camera => camera,
        ReferenceAxis::Auto => {
            let level = up.cross(&right).try_normalize(VERTICAL).unwrap_or_default();
            level + (camera - level) * camera_share(right.dot(up))
        }
    }
}

/// The derivative of `pointing` where `up` leans to d.
fn pointing_slope(up: &Vector3<f64>, axis: ReferenceAxis, rotation: ScreenRotation, d: &Vector3<f64>) -> Vector3<f64> {
    if axis != ReferenceAxis::Auto {
        return Vector3::zeros();
    }
    let (right, _) = rotation.axes();
    let across = up.cross(&right);
    let Some(level) = across.try_normalize(VERTICAL) else { return Vector3::zeros() };
    let turned = d.cross(&right);
    let level_turned = (turned - level * level.dot(&turned)) / across.norm();
    let rise = right.dot(up);
    let share = camera_share(rise);
    let share_turned =
        if share > 0.0 && share < 1.0 { right.dot(d) * rise.signum() / (RISE_END - RISE_BEGIN) } else { 0.0 };
    level_turned * (1.0 - share) + (-Vector3::z() - level) * share_turned
}

/// How far the automatic axis follows the camera, 0 to 1, where the right edge rises with this sine.
fn camera_share(rise: f64) -> f64 {
    ((rise.abs() - RISE_BEGIN) / (RISE_END - RISE_BEGIN)).clamp(0.0, 1.0)
}

/// One standard deviation of the heading of an axis, degrees: up to 115, or 180 where the field's or the axis' horizontal
/// part is lost in its uncertainty.
///
/// `field_ut` is the corrected field, `covariance_ut2` the covariance of its error (uT^2), `tilt_sigma_deg` the
/// standard deviation of `up` about a horizontal axis. Only errors across the field count, and the shorter its
/// horizontal part the more: near the magnetic poles sigma grows as it must. A tilt turns the horizontal parts of field
/// and axis alike, each by the tangent of its elevation: an axis that points up has no heading either.
#[must_use]
pub fn heading_sigma_deg(
    field_ut: &Vector3<f64>,
    up: &Vector3<f64>,
    axis: ReferenceAxis,
    rotation: ScreenRotation,
    covariance_ut2: &Matrix3<f64>,
    tilt_sigma_deg: f64,
) -> Option<f64> {
    let tilt = Tilt { sigma_deg: tilt_sigma_deg, ..Tilt::default() };
    let level = Level::of(field_ut, up)?;
    sigma_of_level(&level, axis, rotation, level.across_rad2(covariance_ut2), &tilt)
}

/// The same of a field's level frame, and of the part of it that the covariance makes ([`Level::across_rad2`]).
pub(crate) fn sigma_of_level(
    level: &Level,
    axis: ReferenceAxis,
    rotation: ScreenRotation,
    across_rad2: f64,
    tilt: &Tilt,
) -> Option<f64> {
    let Level { east, north, up, .. } = level;
    let pointing = pointing(up, axis, rotation);
    let (e, n) = level.parts(&pointing);
    // an axis that is vertical itself has no heading: every tilt turns it
    let h = (e * e + n * n).max(VERTICAL * VERTICAL);
    let rise = pointing.dot(up) / h;
    let follows = |to: &Vector3<f64>| {
        let (by_east, by_north) = level.parts(&pointing_slope(up, axis, rotation, to));
        (n * by_east - e * by_north) / h
    };
    let to_east = level.vertical / level.horizontal - n * rise + follows(east);
    let to_north = e * rise + follows(north);
    // what the field is off by turns with the first of the terms alone
    let common_rad2 = 2.0 * tilt.common_rad2 * to_east * level.vertical / level.horizontal;
    let tilt_rad2 = tilt.variance_rad2() * (to_east * to_east + to_north * to_north);
    angle_sigma_deg((across_rad2 + tilt_rad2 - common_rad2).max(0.0))
}

/// The standard deviation of an angle of this variance, degrees; 180 where it knows no direction at all.
pub(crate) fn angle_sigma_deg(variance_rad2: f64) -> Option<f64> {
    // as an arc, since an arc tangent would stop at 90
    let sd_rad = variance_rad2.max(0.0).sqrt();
    let sigma = if sd_rad > LOST_RATIO { 180.0 } else { sd_rad.to_degrees() };
    variance_rad2.is_finite().then_some(sigma)
}

/// True heading from a magnetic heading and the declination (east positive), degrees, 0 to 360.
#[must_use]
pub fn true_heading_deg(heading_deg: f64, declination_deg: f64) -> f64 {
    wrap_360(heading_deg + declination_deg)
}

/// Mathematics: a full turn, deg.
const TURN_DEG: f64 = 360.0;

/// An angle in [0, 360).
fn wrap_360(deg: f64) -> f64 {
    let rest = deg % TURN_DEG;
    let wrapped = if rest < 0.0 { rest + TURN_DEG } else { rest };
    if wrapped >= TURN_DEG { 0.0 } else { wrapped }
}
