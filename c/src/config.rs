//! `magcomp_config`: the settings as plain members, beside the text that `magcomp_compensator_create` takes.

use crate::compensator::{Compensator, code, create, with};
use crate::error::{Error, Failure, caught};
use crate::grows::{Grows, fill, room};
use magcomp_core::{HeadingConfig, ReferenceAxis, ScreenRotation};
use std::mem::offset_of;

/// How M and b are estimated.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Method {
    /// Gyroscope and gravity beside the magnetometer; the magnetometer alone while there is no usable gyroscope.
    Auto = 0,
    /// The magnetometer alone.
    Adaptive = 1,
    /// The paper's: a fit over the latest samples.
    Windowed = 2,
    /// One fit, then kept.
    Constant = 3,
}

/// Which axis of the device the heading is that of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Axis {
    /// The top edge, +y.
    TopEdge = 0,
    /// The back camera, -z.
    Camera = 1,
    /// The horizontal direction between both.
    Auto = 2,
}

/// Settings. magcomp_config_default fills in the defaults; change what is to differ. The text of magcomp_compensator_create has the paper's besides.
#[derive(Clone, Copy)]
#[repr(C)]
pub struct Config {
    /// sizeof(magcomp_config).
    pub size: usize,
    /// A magcomp_method. Default MAGCOMP_METHOD_AUTO.
    pub method: i32,
    /// A magcomp_axis, whose heading it is. Default MAGCOMP_AXIS_TOP_EDGE.
    pub axis: i32,
    /// How the screen's content is turned against the device: 0 (default), 90 (the screen's top is the device's right edge), 180 or 270 deg.
    pub screen_rotation_deg: i32,
    /// Largest component of a raw sample, 1 to 100000 uT. Default 2000.
    pub range_ut: f64,
    /// The sensor's full scale, 1 to 100000 uT. Default NaN: found once an axis has read the same extreme again and again in motion.
    pub rail_ut: f64,
    /// |h| where it is known, 1 to 1000 uT. Default NaN.
    pub field_strength_ut: f64,
    /// Declination, east positive, -180 to 180 deg: gives `true_heading_deg`. Default NaN: none.
    pub declination_deg: f64,
    /// Standard deviation of `up` at rest, 0 to 90 deg. Default 0.5.
    pub tilt_sigma_deg: f64,
}

// SAFETY: it is as the trait asks
unsafe impl Grows for Config {
    const NAME: &str = "magcomp_config";
    const FIRST: usize = offset_of!(Self, tilt_sigma_deg) + size_of::<f64>();
}

impl Default for Config {
    fn default() -> Self {
        let it = magcomp_core::Config::default();
        Self {
            size: size_of::<Self>(),
            method: Method::Auto as i32,
            axis: Axis::TopEdge as i32,
            screen_rotation_deg: 0,
            range_ut: it.range_ut,
            rail_ut: it.rail_ut.unwrap_or(f64::NAN),
            field_strength_ut: it.field_strength_ut.unwrap_or(f64::NAN),
            declination_deg: it.heading.declination_deg.unwrap_or(f64::NAN),
            tilt_sigma_deg: it.heading.tilt_sigma_deg,
        }
    }
}

impl Config {
    /// The caller's, and the defaults of what its version does not know.
    ///
    /// # Safety
    /// `at` is null, or a struct of the caller's whose size is set.
    unsafe fn of(at: *const Self) -> Result<Self, Failure> {
        // SAFETY: as said above
        let room = unsafe { room(at) }?;
        let mut it = Self::default();
        // SAFETY: both have as many bytes, and any bits are numbers
        unsafe { std::ptr::copy_nonoverlapping(at.cast::<u8>(), (&raw mut it).cast(), room.min(size_of::<Self>())) };
        Ok(it)
    }

    fn heading(&self) -> Result<HeadingConfig, Failure> {
        let axis = match self.axis {
            it if it == Axis::TopEdge as i32 => ReferenceAxis::TopEdge,
            it if it == Axis::Camera as i32 => ReferenceAxis::Camera,
            it if it == Axis::Auto as i32 => ReferenceAxis::Auto,
            it => return Err(Failure::config(format!("axis is {it}, expected a magcomp_axis"))),
        };
        let screen_rotation = match self.screen_rotation_deg {
            0 => ScreenRotation::Deg0,
            90 => ScreenRotation::Deg90,
            180 => ScreenRotation::Deg180,
            270 => ScreenRotation::Deg270,
            it => return Err(Failure::config(format!("screen_rotation_deg is {it}, expected 0, 90, 180 or 270"))),
        };
        let declination_deg = known(self.declination_deg);
        Ok(HeadingConfig { axis, screen_rotation, declination_deg, tilt_sigma_deg: self.tilt_sigma_deg })
    }

    fn checked(&self) -> Result<magcomp_core::Config, Failure> {
        let method = match self.method {
            it if it == Method::Auto as i32 => magcomp_core::Method::Auto,
            it if it == Method::Adaptive as i32 => magcomp_core::Method::Adaptive,
            it if it == Method::Windowed as i32 => magcomp_core::Method::Windowed,
            it if it == Method::Constant as i32 => magcomp_core::Method::Constant,
            it => return Err(Failure::config(format!("method is {it}, expected a magcomp_method"))),
        };
        Ok(magcomp_core::Config {
            method,
            range_ut: self.range_ut,
            rail_ut: known(self.rail_ut),
            field_strength_ut: known(self.field_strength_ut),
            heading: self.heading()?,
            ..magcomp_core::Config::default()
        })
    }
}

fn known(value: f64) -> Option<f64> {
    (!value.is_nan()).then_some(value)
}

/// Fills `config`, whose size is set, with the default of every setting. Errors: NULL_POINTER; SIZE. They leave no message.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_config_default(config: *mut Config) -> Error {
    // SAFETY: null, or the caller's
    match unsafe { room(config) } {
        Ok(room) => {
            // SAFETY: there is as much room
            unsafe { fill(config, room, Config::default()) };
            Error::None
        }
        Err(failure) => failure.code,
    }
}

/// As magcomp_compensator_create, with settings as members.
///
/// Errors: NULL_POINTER (both); SIZE; CONFIG. `*compensator` is null then, and magcomp_compensator_last_error(NULL) has this thread's message.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_create_with(
    config: *const Config,
    compensator: *mut *mut Compensator,
) -> Error {
    // SAFETY: null, or the caller's
    let done = caught(|| unsafe { create(compensator, || Config::of(config)?.checked()) });
    code(None, done)
}

/// As magcomp_compensator_set_heading: `axis`, `screen_rotation_deg`, `declination_deg` and `tilt_sigma_deg` of `config`; nothing else of it is used.
///
/// Errors: NULL_POINTER (both); SIZE; CONFIG.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_set_heading_with(
    compensator: *mut Compensator,
    config: *const Config,
) -> Error {
    // SAFETY: null, or the caller's; null, or made by create and not freed
    unsafe { with(compensator, |core| Ok(core.compensator.set_heading(Config::of(config)?.heading()?)?)) }
}
