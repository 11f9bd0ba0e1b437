//! `magcomp_config` as its functions take it, beside the text of `magcomp_compensator_create`.

use crate::compensator::{Compensator, code, create, with};
use crate::error::{Error, Failure, caught};
use crate::grows::{Grows, fill, room};
use crate::settings::Config;
use std::mem::offset_of;

// SAFETY: it is as the trait asks
unsafe impl Grows for Config {
    const NAME: &str = "magcomp_config";
    const FIRST: usize = offset_of!(Self, tilt_sigma_deg) + size_of::<f64>();
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
    let done = caught(|| unsafe { create(compensator, || Config::of(config)?.core()) });
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
