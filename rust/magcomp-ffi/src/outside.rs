//! Headings and orientations from outside, and what they are worth: low rates, so no fast path.

use crate::compensator::Compensator;
use crate::convert::same;
use crate::error::MagcompError;
use crate::record::Vector3;
use crate::status::HeadingAid;
use magcomp::nalgebra::{Quaternion, UnitQuaternion};

/// A heading that something else than the magnetometer knows: a GNSS course, a landmark that the user tapped, a corridor of a map.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct HeadingSample {
    /// When it was true, nanoseconds, on the magnetometer's clock: up to 5 s before the latest magnetometer sample.
    pub time_ns: i64,
    /// Degrees clockwise from north, -360 to 360.
    pub heading_deg: f64,
    /// One standard deviation, degrees, above 0 and up to 180. Errors are taken to last for 10 s: ten headings within one second
    /// tell little more than one.
    pub sigma_deg: f64,
    /// Which north.
    pub reference: NorthReference,
    /// What points there.
    pub axis: HeadedAxis,
}

/// The north that a heading counts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, uniffi::Enum)]
pub enum NorthReference {
    /// True north, as of maps and GNSS. While no declination is set it is learned from these headings.
    True,
    /// Magnetic north.
    Magnetic,
}

/// What a heading from outside is that of.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Enum)]
pub enum HeadedAxis {
    /// A direction of the device: the top edge is (0, 1, 0), the back camera (0, 0, -1).
    Device {
        /// Of any length but 0, device frame.
        axis: Vector3,
    },
    /// A vehicle in which the device lies, turned against it by an angle that does not change: that angle is learned while the vehicle turns.
    /// A device that is moved in its holder is noticed.
    Vehicle,
}

/// An orientation that something else than these sensors knows: the pose of ARKit's or ARCore's camera.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct AttitudeSample {
    /// When it was true, nanoseconds, on the magnetometer's clock.
    pub time_ns: i64,
    /// The real part of the quaternion w + x i + y j + z k that takes a vector of the device frame to a world whose z points up. It may have
    /// any length but 0.
    pub w: f64,
    /// The part of i.
    pub x: f64,
    /// The part of j.
    pub y: f64,
    /// The part of k.
    pub z: f64,
    /// What is known of that world's y axis.
    pub yaw: Yaw,
}

/// What is known of the y axis of an outside world.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Enum)]
pub enum Yaw {
    /// It points anywhere, and stays: the turns stand in for a gyroscope where that is missing.
    Relative,
    /// It points north.
    Absolute {
        /// One standard deviation, degrees, as that of a `HeadingSample`.
        sigma_deg: f64,
        /// Which north.
        reference: NorthReference,
    },
}

/// A declination that headings from true north have shown.
#[derive(Clone, Copy, Debug, PartialEq, uniffi::Record)]
pub struct FoundDeclination {
    /// Degrees, east positive.
    pub declination_deg: f64,
    /// One standard deviation, degrees.
    pub sigma_deg: f64,
}

same! {
    NorthReference: NorthReference { True, Magnetic }
}

impl From<HeadingSample> for magcomp::HeadingSample {
    fn from(s: HeadingSample) -> Self {
        let HeadingSample { time_ns, heading_deg, sigma_deg, reference, axis } = s;
        let axis = match axis {
            HeadedAxis::Device { axis } => magcomp::HeadedAxis::Device(axis.into()),
            HeadedAxis::Vehicle => magcomp::HeadedAxis::Vehicle,
        };
        Self { time_ns, heading_deg, sigma_deg, reference: reference.into(), axis }
    }
}

impl AttitudeSample {
    fn checked(self) -> Result<magcomp::AttitudeSample, magcomp::EventRejection> {
        let Self { time_ns, w, x, y, z, yaw } = self;
        let quaternion = Quaternion::new(w, x, y, z);
        if !quaternion.coords.iter().all(|it| it.is_finite()) {
            return Err(magcomp::EventRejection::NotFinite);
        }
        let to_world = UnitQuaternion::try_new(quaternion, f64::MIN_POSITIVE);
        let to_world = to_world.ok_or(magcomp::EventRejection::OutOfRange)?;
        let yaw = match yaw {
            Yaw::Relative => magcomp::Yaw::Relative,
            Yaw::Absolute { sigma_deg, reference } => magcomp::Yaw::Absolute { sigma_deg, reference: reference.into() },
        };
        Ok(magcomp::AttitudeSample { time_ns, to_world, yaw })
    }
}

#[uniffi::export]
impl Compensator {
    /// A heading from outside: a GNSS course, a landmark. It is used at the magnetometer sample that follows it in time, or comes up to 5 s late.
    /// North is carried by the gyroscope from one to the next; without a gyroscope they are not used. One that contradicts what is known is
    /// ignored, unless others say the same for a minute. The filtered field, heading and attitude go by it; the calibration and the corrected
    /// field do not. Fails with `EventRejected`, which says why it was not taken.
    pub fn push_heading(&self, sample: HeadingSample) -> Result<(), MagcompError> {
        self.with_core(|core| Ok(core.push_heading(sample.into())?))
    }

    /// An orientation from outside: a camera's pose. While the gyroscope is missing its turns stand in for it; where its world's y axis points
    /// north it is a heading too. Fails with `EventRejected`, which says why it was not taken.
    pub fn push_attitude(&self, sample: AttitudeSample) -> Result<(), MagcompError> {
        self.with_core(|core| Ok(core.push_attitude(sample.checked()?)?))
    }

    /// What headings from outside are worth after the latest sample. None where none came in the last two minutes.
    pub fn heading_aid(&self) -> Result<Option<HeadingAid>, MagcompError> {
        self.with_core(|core| Ok(core.heading_aid().map(Into::into)))
    }

    /// The declination that true headings from outside have shown. None before the first, and while a declination is set.
    pub fn found_declination(&self) -> Result<Option<FoundDeclination>, MagcompError> {
        self.with_core(|core| {
            let found = core.found_declination_deg();
            Ok(found.map(|(declination_deg, sigma_deg)| FoundDeclination { declination_deg, sigma_deg }))
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::default_config;
    use crate::status::EventRejection;

    fn course(time_ns: i64, sigma_deg: f64) -> HeadingSample {
        let reference = NorthReference::True;
        HeadingSample { time_ns, heading_deg: 90.0, sigma_deg, reference, axis: HeadedAxis::Vehicle }
    }

    fn pose(time_ns: i64, w: f64, yaw: Yaw) -> AttitudeSample {
        AttitudeSample { time_ns, w, x: 0.0, y: 0.0, z: 0.0, yaw }
    }

    #[test]
    fn what_cannot_be_used_is_refused_by_name() {
        let compensator = Compensator::new(default_config()).unwrap();
        let refused = |reason| Err(MagcompError::EventRejected { reason });
        assert_eq!(compensator.push_heading(course(1, 0.0)), refused(EventRejection::OutOfRange));
        assert_eq!(compensator.push_heading(course(1, f64::NAN)), refused(EventRejection::NotFinite));
        compensator.push_heading(course(1, 5.0)).unwrap();
        assert_eq!(compensator.push_heading(course(1, 5.0)), refused(EventRejection::Duplicate));
        let at_once = |w| compensator.push_attitude(pose(2, w, Yaw::Relative));
        assert_eq!(at_once(0.0), refused(EventRejection::OutOfRange));
        assert_eq!(at_once(f64::INFINITY), refused(EventRejection::NotFinite));
        at_once(3.0).unwrap();
        assert_eq!(at_once(3.0), refused(EventRejection::Late));
        assert_eq!(compensator.heading_aid().unwrap(), None);
        assert_eq!(compensator.found_declination().unwrap(), None);
    }

    /// A phone that lies flat, its top edge north by a calibration that is hardly known: a world turned by 30 degrees leads.
    #[test]
    fn an_absolute_pose_turns_north() {
        let compensator = Compensator::new(default_config()).unwrap();
        let answer = |time_ns: i64| {
            let rate_rad_s = Vector3 { x: 0.0, y: 0.0, z: 0.0 };
            compensator.push_rotation_rate(crate::record::RotationRateSample { time_ns, rate_rad_s }).unwrap();
            let up_m_s2 = Vector3 { x: 0.0, y: 0.0, z: 9.81 };
            compensator.push_up(crate::record::UpSample { time_ns, up_m_s2 }).unwrap();
            let field_ut = Vector3 { x: 0.2 * (time_ns as f64).sin(), y: 20.0, z: -45.0 };
            let sample = crate::record::MagneticSample { time_ns, field_ut, reported_hard_iron_ut: None };
            compensator.push(sample).unwrap().heading
        };
        let calibration = magcomp::Calibration::new(magcomp::nalgebra::Matrix3::identity(), [0.0; 3].into(), 49.244);
        compensator.adopt(calibration.unwrap().into(), 30.0).unwrap();
        let mut heading = None;
        for k in 1..3000 {
            let time_ns = k * 20_000_000;
            let half = -15.0_f64.to_radians();
            let yaw = Yaw::Absolute { sigma_deg: 1.0, reference: NorthReference::Magnetic };
            let sample = AttitudeSample { w: half.cos(), z: half.sin(), ..pose(time_ns, 1.0, yaw) };
            if k % 50 == 0 {
                compensator.push_attitude(sample).unwrap();
            }
            heading = answer(time_ns);
        }
        let heading = heading.unwrap();
        assert_eq!(compensator.heading_aid().unwrap(), Some(HeadingAid::Leads));
        assert!((heading.heading_deg - 30.0).abs() < 5.0, "{heading:?}");
    }
}
