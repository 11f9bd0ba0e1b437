//! Records that cross the border, and their conversions.

use crate::convert::{count, same};
use crate::error::MagcompError;
use crate::status::{ReferenceAxis, ScreenRotation};
use magcomp::nalgebra;

/// Three components in the device frame: x right, y up along the screen, z out of the screen.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct Vector3 {
    /// Along the screen, to the right.
    pub x: f64,
    /// Along the screen, up.
    pub y: f64,
    /// Out of the screen.
    pub z: f64,
}

impl From<nalgebra::Vector3<f64>> for Vector3 {
    fn from(v: nalgebra::Vector3<f64>) -> Self {
        Self { x: v.x, y: v.y, z: v.z }
    }
}

impl From<Vector3> for nalgebra::Vector3<f64> {
    fn from(v: Vector3) -> Self {
        Self::new(v.x, v.y, v.z)
    }
}

/// One raw magnetometer event.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct MagneticSample {
    /// Time of the event, nanoseconds, strictly increasing from one sample to the next.
    pub time_ns: i64,
    /// Raw (uncalibrated) field, microtesla, device frame.
    pub field_ut: Vector3,
    /// The operating system's own estimate of the hard iron, microtesla (Android: values 3 to 5 of the uncalibrated
    /// event). A jump in it shows in `Reading.reported_hard_iron_jump_ut`; `Config.use_reported_hard_iron` makes it
    /// the first calibration.
    #[uniffi(default = None)]
    pub reported_hard_iron_ut: Option<Vector3>,
}

impl From<MagneticSample> for magcomp::MagneticSample {
    fn from(s: MagneticSample) -> Self {
        Self { time_ns: s.time_ns, field_ut: s.field_ut.into() }
    }
}

/// One gyroscope event.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct RotationRateSample {
    /// Time of the event, nanoseconds, on the magnetometer's clock.
    pub time_ns: i64,
    /// Angular rate of the device, rad/s, device frame, counter-clockwise positive.
    pub rate_rad_s: Vector3,
}

impl From<RotationRateSample> for magcomp::RotationRateSample {
    fn from(s: RotationRateSample) -> Self {
        Self { time_ns: s.time_ns, rate_rad_s: s.rate_rad_s.into() }
    }
}

/// One accelerometer or gravity event.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct UpSample {
    /// Time of the event, nanoseconds, on the magnetometer's clock.
    pub time_ns: i64,
    /// What an accelerometer at rest reads: pointing up, m/s^2, device frame (Android's sign; iOS's gravity flipped).
    pub up_m_s2: Vector3,
}

impl From<UpSample> for magcomp::UpSample {
    fn from(s: UpSample) -> Self {
        Self { time_ns: s.time_ns, up_m_s2: s.up_m_s2.into() }
    }
}

/// A heading with its sigma and the inclination of the field. All angles are in degrees.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct Heading {
    /// Clockwise from magnetic north, 0 to 360 degrees.
    pub heading_deg: f64,
    /// One standard deviation of `heading_deg`, degrees; none when the calibration's own uncertainty is not known.
    pub heading_sigma_deg: Option<f64>,
    /// Clockwise from true north, 0 to 360 degrees. None without a declination.
    pub true_heading_deg: Option<f64>,
    /// Angle of the field below the horizon, -90 to 90 degrees. None where no field is known and north comes from outside.
    pub inclination_deg: Option<f64>,
}

impl From<magcomp::Heading> for Heading {
    fn from(h: magcomp::Heading) -> Self {
        let magcomp::Heading { heading_deg, heading_sigma_deg, true_heading_deg, inclination_deg } = h;
        Self { heading_deg, heading_sigma_deg, true_heading_deg, inclination_deg }
    }
}

/// How the device lies in the world: the unit quaternion w + x i + y j + z k that takes a vector of the device frame to (east,
/// north, up), north magnetic. w is at least 0.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct Attitude {
    /// The real part.
    pub w: f64,
    /// The part of i.
    pub x: f64,
    /// The part of j.
    pub y: f64,
    /// The part of k.
    pub z: f64,
    /// One standard deviation: the root of the sum of the variances of the rotation error about three axes at right angles,
    /// degrees, 0 to 180; none when the calibration's own uncertainty is not known.
    pub sigma_deg: Option<f64>,
}

impl From<magcomp::Attitude> for Attitude {
    fn from(a: magcomp::Attitude) -> Self {
        let magcomp::Attitude { to_world, sigma_deg } = a;
        Self { w: to_world.w, x: to_world.i, y: to_world.j, z: to_world.k, sigma_deg }
    }
}

/// The axis whose heading is reported, how the screen's content is turned, and the declination.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct HeadingFrame {
    /// The axis whose heading it is.
    pub axis: ReferenceAxis,
    /// How the screen's content is turned against the device's natural orientation.
    pub screen_rotation: ScreenRotation,
    /// Declination, degrees, east positive, -180 to 180: gives `true_heading_deg`. None: no true heading.
    #[uniffi(default = None)]
    pub declination_deg: Option<f64>,
}

/// Soft iron M: symmetric positive definite, dimensionless.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct SoftIron {
    /// m_xx.
    pub xx: f64,
    /// m_yy.
    pub yy: f64,
    /// m_zz.
    pub zz: f64,
    /// m_xy = m_yx.
    pub xy: f64,
    /// m_xz = m_zx.
    pub xz: f64,
    /// m_yz = m_zy.
    pub yz: f64,
}

impl From<&nalgebra::Matrix3<f64>> for SoftIron {
    fn from(m: &nalgebra::Matrix3<f64>) -> Self {
        Self { xx: m.m11, yy: m.m22, zz: m.m33, xy: m.m12, xz: m.m13, yz: m.m23 }
    }
}

impl From<SoftIron> for nalgebra::Matrix3<f64> {
    fn from(m: SoftIron) -> Self {
        Self::new(m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz)
    }
}

/// Raw field = soft iron * field + hard iron.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct Calibration {
    /// M, dimensionless, no element of it or of its inverse beyond +-1000.
    pub soft_iron: SoftIron,
    /// b, microtesla, each component within +-100 000: subtracted from the raw field.
    pub hard_iron_ut: Vector3,
    /// Strength of the field it was found in, microtesla, 1 to 1000.
    pub field_strength_ut: f64,
}

impl From<magcomp::Calibration> for Calibration {
    fn from(c: magcomp::Calibration) -> Self {
        Self {
            soft_iron: c.soft_iron().into(),
            hard_iron_ut: (*c.hard_iron_ut()).into(),
            field_strength_ut: c.field_strength_ut(),
        }
    }
}

impl TryFrom<Calibration> for magcomp::Calibration {
    type Error = MagcompError;
    fn try_from(c: Calibration) -> Result<Self, MagcompError> {
        Ok(Self::new(c.soft_iron.into(), c.hard_iron_ut.into(), c.field_strength_ut)?)
    }
}

/// An ellipsoid fit and how far to trust it.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct Fit {
    /// M, b and the field strength.
    pub calibration: Calibration,
    /// 9 x 9, row by row, in the order b_x b_y b_z (microtesla) m_xx m_yy m_zz m_xy m_xz m_yz (dimensionless).
    pub covariance: Vec<f64>,
    /// Iterations made.
    pub iterations: i32,
    /// Why they ended.
    pub termination: Termination,
    /// Rms distance of the samples from the ellipsoid, microtesla: the noise per axis.
    pub residual_rms_ut: f64,
    /// Longest over shortest half axis.
    pub axis_ratio: f64,
    /// Predicted rms error of a corrected direction, degrees.
    pub direction_sigma_deg: f64,
    /// Samples in the fit.
    pub samples: i32,
}

impl From<&magcomp::EllipsoidFit> for Fit {
    fn from(f: &magcomp::EllipsoidFit) -> Self {
        Self {
            calibration: f.calibration.into(),
            covariance: f.covariance.transpose().iter().copied().collect(),
            iterations: count(f.iterations),
            termination: f.termination.into(),
            residual_rms_ut: f.residual_rms_ut,
            axis_ratio: f.axis_ratio,
            direction_sigma_deg: f.direction_sigma_deg,
            samples: count(f.samples),
        }
    }
}

/// Why an iteration stopped. Each is an answer; the last two say how good.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum Termination {
    /// The last step was below the tolerance.
    Converged,
    /// No step lowers the cost any more: rounding decides.
    Stalled,
    /// The number of iterations ran out first.
    MaxIterations,
}

same! {
    Termination: Termination { Converged, Stalled, MaxIterations }
}

/// Which directions of the sphere have been seen, for guidance.
#[derive(Clone, Debug, PartialEq, uniffi::Record)]
pub struct Coverage {
    /// Share of the 48 equal cells of the sphere that were seen, 0 to 1.
    pub share: f64,
    /// Middles of the cells not yet seen, unit vectors, device frame: turn the device so that the field points there.
    pub unseen_directions: Vec<Vector3>,
}

impl From<&magcomp::Coverage> for Coverage {
    fn from(c: &magcomp::Coverage) -> Self {
        Self { share: c.share(), unseen_directions: c.unseen_directions().into_iter().map(Into::into).collect() }
    }
}

/// The corrected field, microtesla, of a raw sample (microtesla), by a calibration.
///
/// Fails when the numbers are no calibration: a number is not finite, or the soft iron is not symmetric positive definite.
#[uniffi::export]
pub fn correct(calibration: Calibration, raw_ut: Vector3) -> Result<Vector3, MagcompError> {
    let calibration: magcomp::Calibration = calibration.try_into()?;
    Ok(calibration.correct(&raw_ut.into()).into())
}

/// The heading in a frame, from a corrected field (microtesla) and `up` (any length), both in the device frame.
///
/// None when the field or the axis is vertical, or anything is not finite or zero. It has no sigma.
#[uniffi::export]
pub fn heading(field_ut: Vector3, up: Vector3, frame: HeadingFrame) -> Result<Option<Heading>, MagcompError> {
    crate::guarded::caught(|| heading_in(&field_ut.into(), &up.into(), &frame))
        .map_err(|what| MagcompError::Panicked { what })
}

pub(crate) fn heading_in(
    field_ut: &nalgebra::Vector3<f64>,
    up: &nalgebra::Vector3<f64>,
    frame: &HeadingFrame,
) -> Option<Heading> {
    let found = magcomp::heading(field_ut, up, frame.axis.into(), frame.screen_rotation.into())?;
    let true_heading_deg = frame.declination_deg.map(|d| magcomp::true_heading_deg(found.heading_deg, d));
    Some(Heading { true_heading_deg, ..found.into() })
}

/// The attitude from a corrected field (microtesla) and `up` (any length), both in the device frame.
///
/// None when the field is vertical, or anything is not finite or zero. It has no sigma.
#[uniffi::export]
pub fn attitude(field_ut: Vector3, up: Vector3) -> Result<Option<Attitude>, MagcompError> {
    crate::guarded::caught(|| magcomp::attitude(&field_ut.into(), &up.into()).map(Into::into))
        .map_err(|what| MagcompError::Panicked { what })
}

/// True heading, degrees, 0 to 360, from a magnetic heading and the declination (east positive), degrees.
#[uniffi::export]
pub fn true_heading_deg(heading_deg: f64, declination_deg: f64) -> f64 {
    magcomp::true_heading_deg(heading_deg, declination_deg)
}
