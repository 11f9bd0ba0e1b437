//! Headings and orientations from outside, and what they are worth.

use crate::compensator::{Compensator, code, with};
use crate::error::{Error, Failure};
use crate::status::HeadingAid;
use magcomp_core::nalgebra::{Quaternion, UnitQuaternion, Vector3};
use magcomp_core::{AttitudeSample, EventRejection, HeadedAxis, HeadingSample, NorthReference, Yaw};

/// What a direction from outside counts from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum North {
    /// Not north: the y axis of an outside world points anywhere, and stays.
    None = 0,
    /// True north, as of maps and GNSS. While no declination is set it is learned from these headings.
    True = 1,
    /// Magnetic north.
    Magnetic = 2,
}

/// A caller may pass any number where the header says `magcomp_north`.
fn reference(north: i32) -> Result<Option<NorthReference>, Failure> {
    match north {
        it if it == North::None as i32 => Ok(None),
        it if it == North::True as i32 => Ok(Some(NorthReference::True)),
        it if it == North::Magnetic as i32 => Ok(Some(NorthReference::Magnetic)),
        _ => Err(Failure::config(format!("reference is {north}, expected a magcomp_north"))),
    }
}

/// A heading from outside: a GNSS course, a landmark. Degrees clockwise from the north that `reference`, a magcomp_north, names, -360 to 360; its standard
/// deviation, above 0, up to 180 deg, of errors that are taken to last for 10 s. `axis` is what points there: three numbers of any length but 0, device
/// axes, such as the top edge 0, 1, 0; null: a vehicle in which the device lies, turned against it by an angle that does not change.
///
/// It is used at the magnetic sample that follows it in time, or comes up to 5 s late. The gyroscope carries north from one to the next; without a gyroscope
/// they are not used. One that contradicts what is known is ignored, unless others say the same for a minute. The filtered field, heading and attitude go
/// by it; the calibration and `field_ut` do not.
///
/// Errors: NULL_POINTER (`compensator`); CONFIG (`reference`); EVENT_NOT_FINITE, EVENT_OUT_OF_RANGE, EVENT_LATE, EVENT_DUPLICATE, EVENT_AHEAD: it is left out.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_push_heading(
    compensator: *mut Compensator,
    time_ns: i64,
    heading_deg: f64,
    sigma_deg: f64,
    reference: i32,
    axis: *const f64,
) -> Error {
    // SAFETY: null, or three numbers of the caller's
    let axis = unsafe { axis.cast::<[f64; 3]>().as_ref() }.map(|axis| Vector3::from(*axis));
    // SAFETY: null, or made by create and not freed
    unsafe {
        with(compensator, |core| {
            let reference = self::reference(reference)?.ok_or_else(|| {
                Failure::config("reference is MAGCOMP_NORTH_NONE; a heading counts from true or magnetic north")
            })?;
            let axis = axis.map_or(HeadedAxis::Vehicle, HeadedAxis::Device);
            Ok(core.compensator.push_heading(HeadingSample { time_ns, heading_deg, sigma_deg, reference, axis })?)
        })
    }
}

/// An orientation from outside, such as a camera's pose: the quaternion w + x i + y j + z k, of any length but 0, that takes device axes to a world whose z
/// points up. While the gyroscope is missing its turns stand in for it. Where the world's y axis points to a north, which `reference` then names, it is a
/// heading too, of the standard deviation `sigma_deg`; with MAGCOMP_NORTH_NONE `sigma_deg` is not read.
///
/// Errors: as magcomp_compensator_push_heading.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_push_attitude(
    compensator: *mut Compensator,
    time_ns: i64,
    w: f64,
    x: f64,
    y: f64,
    z: f64,
    reference: i32,
    sigma_deg: f64,
) -> Error {
    // SAFETY: null, or made by create and not freed
    unsafe {
        with(compensator, |core| {
            let yaw =
                self::reference(reference)?.map_or(Yaw::Relative, |reference| Yaw::Absolute { sigma_deg, reference });
            let quaternion = Quaternion::new(w, x, y, z);
            if !quaternion.coords.iter().all(|it| it.is_finite()) {
                return Err(EventRejection::NotFinite.into());
            }
            let to_world = UnitQuaternion::try_new(quaternion, f64::MIN_POSITIVE).ok_or(EventRejection::OutOfRange)?;
            Ok(core.compensator.push_attitude(AttitudeSample { time_ns, to_world, yaw })?)
        })
    }
}

/// What headings from outside are worth after the latest sample; MAGCOMP_HEADING_AID_NONE of null, and after a panic.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_heading_aid(compensator: *const Compensator) -> HeadingAid {
    let mut aid = HeadingAid::None;
    // SAFETY: null, or made by create and not freed
    if let Some(it) = unsafe { compensator.as_ref() } {
        // a failure is a panic, and was told by the call that panicked
        _ = it.with(|core| {
            aid = core.compensator.heading_aid().map_or(HeadingAid::None, Into::into);
            Ok(())
        });
    }
    aid
}

/// The declination that headings from true north have shown, deg, east positive, and its standard deviation. Either pointer may be null.
///
/// Errors: NULL_POINTER (`compensator`); NOTHING_YET: no such heading was used yet, or a declination is set. Both numbers are NaN then.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_found_declination(
    compensator: *const Compensator,
    declination_deg: *mut f64,
    sigma_deg: *mut f64,
) -> Error {
    let mut found = None;
    // SAFETY: null, or made by create and not freed
    let it = unsafe { compensator.as_ref() };
    let done = it.ok_or_else(|| Failure::null("compensator")).and_then(|it| {
        it.with(|core| {
            found = core.compensator.found_declination_deg();
            let nothing =
                || Failure::nothing_yet("declination", "push headings from true north, with none set in the config");
            found.map(|_| ()).ok_or_else(nothing)
        })
    });
    let (declination, sigma) = found.unwrap_or((f64::NAN, f64::NAN));
    for (place, value) in [(declination_deg, declination), (sigma_deg, sigma)] {
        if !place.is_null() {
            // SAFETY: it is not null
            unsafe { place.write(value) };
        }
    }
    code(it, done)
}
