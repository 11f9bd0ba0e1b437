//! `magcomp_compensator`: the core's compensator behind a lock. A panic poisons the lock, which then refuses until it holds a new compensator.

use crate::calibration::Calibration;
use crate::error::{Error, Failure, c_text, caught, keep_for_thread, of_thread, text};
use crate::grows::{fill, room};
use crate::reading::Reading;
use magcomp_core::nalgebra::Vector3;
use magcomp_core::{KeptCalibration, MagneticSample, RotationRateSample, UpSample};
use std::ffi::{CString, c_char};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// What brings a calibration.
pub(crate) const TURN: &str = "push samples of a turned device";

/// Finds M and b from a stream of samples, again whenever they change. magcomp_compensator_create makes one.
pub struct Compensator {
    core: Mutex<Core>,
    error: Mutex<CString>,
    status: Mutex<CString>,
    kept: Mutex<CString>,
}

pub(crate) struct Core {
    pub(crate) compensator: magcomp_core::Compensator,
    /// Of the latest reading.
    status: Option<magcomp_core::Status>,
}

impl Core {
    fn new(config: magcomp_core::Config) -> Result<Self, Failure> {
        Ok(Self { compensator: magcomp_core::Compensator::new(config)?, status: None })
    }
}

impl Compensator {
    pub(crate) fn new(config: magcomp_core::Config) -> Result<Self, Failure> {
        let core = Mutex::new(Core::new(config)?);
        Ok(Self { core, error: Mutex::default(), status: Mutex::default(), kept: Mutex::default() })
    }

    /// Puts a new compensator with the same settings in the place of the old one, also after a panic.
    pub(crate) fn reset(&self) -> Result<(), Failure> {
        let mut core = even_poisoned(&self.core);
        *core = Core::new(core.compensator.config().clone())?;
        self.core.clear_poison();
        Ok(())
    }

    pub(crate) fn with(&self, action: impl FnOnce(&mut Core) -> Result<(), Failure>) -> Result<(), Failure> {
        caught(|| action(&mut *self.core.lock().map_err(|_| Failure::panicked_before())?))
    }
}

fn even_poisoned<T>(lock: &Mutex<T>) -> MutexGuard<'_, T> {
    lock.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Puts a text where the last one of its kind was.
fn put(place: &Mutex<CString>, text: CString) -> *const c_char {
    let mut place = even_poisoned(place);
    *place = text;
    place.as_ptr()
}

/// The code of what was done; the message is kept by the compensator, else by the thread.
pub(crate) fn code(compensator: Option<&Compensator>, done: Result<(), Failure>) -> Error {
    let Err(Failure { code, why }) = done else { return Error::None };
    match compensator {
        Some(it) => _ = put(&it.error, c_text(&why)),
        None => keep_for_thread(c_text(&why)),
    }
    code
}

/// # Safety
/// `compensator` is null, or was made by create and not freed.
pub(crate) unsafe fn with(
    compensator: *const Compensator,
    action: impl FnOnce(&mut Core) -> Result<(), Failure>,
) -> Error {
    // SAFETY: as said above
    let it = unsafe { compensator.as_ref() };
    code(it, it.ok_or_else(|| Failure::null("compensator")).and_then(|it| it.with(action)))
}

/// Makes a compensator, with everything that it will ever need, and puts it into `compensator`; free it with magcomp_compensator_free.
/// magcomp_compensator_create_with takes the settings as a struct.
///
/// `config_json` has the settings that are not to be the default, such as {"rail_ut": 1200, "heading": {"declination_deg": 2.5}}; null: all are.
/// magcomp_config lists them.
///
/// Errors: NULL_POINTER (`compensator`); CONFIG. `*compensator` is null then, and magcomp_compensator_last_error(NULL) has this thread's message.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_create(
    config_json: *const c_char,
    compensator: *mut *mut Compensator,
) -> Error {
    let config = || -> Result<magcomp_core::Config, Failure> {
        if config_json.is_null() {
            return Ok(magcomp_core::Config::default());
        }
        // SAFETY: the caller's
        serde_json::from_str(unsafe { text(config_json, "config_json") }?).map_err(Failure::config)
    };
    // SAFETY: null, or the caller's
    let done = caught(|| unsafe { create(compensator, config) });
    code(None, done)
}

/// Puts a compensator with these settings into `compensator`, or null.
///
/// # Safety
/// `compensator` is null, or has room for a pointer.
pub(crate) unsafe fn create(
    compensator: *mut *mut Compensator,
    config: impl FnOnce() -> Result<magcomp_core::Config, Failure>,
) -> Result<(), Failure> {
    if compensator.is_null() {
        return Err(Failure::null("compensator"));
    }
    // SAFETY: it is not null
    unsafe { compensator.write(std::ptr::null_mut()) };
    let made = Box::new(Compensator::new(config()?)?);
    // SAFETY: it is not null
    unsafe { compensator.write(Box::into_raw(made)) };
    Ok(())
}

/// Frees a compensator and its texts. Null is left alone.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_free(compensator: *mut Compensator) {
    if !compensator.is_null() {
        // SAFETY: made by create, and freed once
        let freed = unsafe { Box::from_raw(compensator) };
        _ = caught(|| {
            drop(freed);
            Ok(())
        });
    }
}

/// The message of the latest call with this compensator that failed, in English; of null: of the latest call of this thread that failed without one, as
/// create does. Empty before the first. Never null. Good until the next such call fails.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_last_error(compensator: *const Compensator) -> *const c_char {
    // SAFETY: null, or made by create and not freed
    unsafe { compensator.as_ref() }.map_or_else(of_thread, |it| even_poisoned(&it.error).as_ptr())
}

/// Begins anew with the same settings, also after a panic: what was learned and adopted is forgotten. Errors: NULL_POINTER.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_reset(compensator: *mut Compensator) -> Error {
    // SAFETY: null, or made by create and not freed
    let it = unsafe { compensator.as_ref() };
    code(it, it.ok_or_else(|| Failure::null("compensator")).and_then(|it| caught(|| it.reset())))
}

/// From now on headings are reported like this; nothing else changes. `heading_json` has the settings that are not to be the default; null: all are.
/// They are those of magcomp_config's `heading`.
///
/// Errors: NULL_POINTER (`compensator`); CONFIG.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_set_heading(
    compensator: *mut Compensator,
    heading_json: *const c_char,
) -> Error {
    let action = |core: &mut Core| {
        let mut heading = magcomp_core::HeadingConfig::default();
        if !heading_json.is_null() {
            // SAFETY: the caller's
            heading = serde_json::from_str(unsafe { text(heading_json, "heading_json") }?).map_err(Failure::config)?;
        }
        Ok(core.compensator.set_heading(heading)?)
    };
    // SAFETY: null, or made by create and not freed
    unsafe { with(compensator, action) }
}

/// A raw magnetic sample, uT, device axes; its time, ns, is after that of the sample before. Fills `reading`, whose size is set.
///
/// Errors: NULL_POINTER (both); SIZE. A sample that cannot be used (NaN, out of range, time going backwards) is no error: see MAGCOMP_STATUS_REJECTED.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_push(
    compensator: *mut Compensator,
    time_ns: i64,
    x_ut: f64,
    y_ut: f64,
    z_ut: f64,
    reading: *mut Reading,
) -> Error {
    let action = |core: &mut Core| {
        // SAFETY: null, or the caller's
        let room = unsafe { room(reading) }?;
        let answer = core.compensator.push(MagneticSample { time_ns, field_ut: Vector3::new(x_ut, y_ut, z_ut) });
        core.status = Some(answer.status);
        // SAFETY: there is as much room
        unsafe { fill(reading, room, Reading::from(&answer)) };
        Ok(())
    };
    // SAFETY: null, or made by create and not freed
    unsafe { with(compensator, action) }
}

/// A gyroscope's event, rad/s, device axes, counter-clockwise positive, at its own rate; its time, ns, is of the magnetic samples' clock. Push it before
/// the magnetic sample that follows it.
///
/// Errors: NULL_POINTER; EVENT_NOT_FINITE, EVENT_OUT_OF_RANGE, EVENT_LATE, EVENT_DUPLICATE, EVENT_AHEAD: the event is left out, which does no harm now
/// and then.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_push_rotation_rate(
    compensator: *mut Compensator,
    time_ns: i64,
    x_rad_s: f64,
    y_rad_s: f64,
    z_rad_s: f64,
) -> Error {
    let sample = RotationRateSample { time_ns, rate_rad_s: Vector3::new(x_rad_s, y_rad_s, z_rad_s) };
    // SAFETY: null, or made by create and not freed
    unsafe { with(compensator, |core| Ok(core.compensator.push_rotation_rate(sample)?)) }
}

/// An accelerometer's or gravity event, m/s^2, device axes: what an accelerometer at rest reads, which points up (+9.81 along z when flat). Else as
/// magcomp_compensator_push_rotation_rate.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_push_up(
    compensator: *mut Compensator,
    time_ns: i64,
    x_m_s2: f64,
    y_m_s2: f64,
    z_m_s2: f64,
) -> Error {
    let sample = UpSample { time_ns, up_m_s2: Vector3::new(x_m_s2, y_m_s2, z_m_s2) };
    // SAFETY: null, or made by create and not freed
    unsafe { with(compensator, |core| Ok(core.compensator.push_up(sample)?)) }
}

/// About so many seconds passed, 0 to 1e9, that the samples' clock does not show: the system slept. The calibration is as unsure as one that was kept for
/// so long. Errors: NULL_POINTER; CONFIG.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_push_gap(compensator: *mut Compensator, hidden_s: f64) -> Error {
    // SAFETY: null, or made by create and not freed
    unsafe { with(compensator, |core| Ok(core.compensator.push_gap(hidden_s)?)) }
}

/// The status of the latest reading as one English sentence with its numbers, such as "collecting: turn the device about more axes". Empty before the
/// first, and of null. Never null. Good until the next call of this function.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_status_text(compensator: *const Compensator) -> *const c_char {
    // SAFETY: null, or made by create and not freed
    let Some(it) = (unsafe { compensator.as_ref() }) else { return c"".as_ptr() };
    let status = even_poisoned(&it.core).status;
    put(&it.status, status.map_or_else(CString::default, |status| c_text(&status.to_string())))
}

/// M, b and |h| in force. Fills `calibration`, whose size is set.
///
/// Errors: NULL_POINTER (both); SIZE; NOTHING_YET.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_calibration(
    compensator: *const Compensator,
    calibration: *mut Calibration,
) -> Error {
    let action = |core: &mut Core| {
        // SAFETY: null, or the caller's
        let room = unsafe { room(calibration) }?;
        let own = core.compensator.calibration().ok_or_else(|| Failure::nothing_yet("calibration", TURN))?;
        // SAFETY: there is as much room
        unsafe { fill(calibration, room, Calibration::from(own)) };
        Ok(())
    };
    // SAFETY: null, or made by create and not freed
    unsafe { with(compensator, action) }
}

/// From now on this calibration is in force, until something better is learned. `hard_iron_sigma_ut` is one standard deviation of each component of b, 0.01
/// to 1000 uT. Live samples judge it first: the status is MAGCOMP_STATUS_HELD until a turned device agrees.
///
/// Errors: NULL_POINTER (both); SIZE; CALIBRATION; CONFIG (`hard_iron_sigma_ut`).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_adopt_calibration(
    compensator: *mut Compensator,
    calibration: *const Calibration,
    hard_iron_sigma_ut: f64,
) -> Error {
    let action = |core: &mut Core| {
        // SAFETY: null, or the caller's
        unsafe { room(calibration) }?;
        // SAFETY: it has all members of the first version, which are those of this one
        let given = unsafe { calibration.read() }.checked()?;
        core.compensator.adopt(&KeptCalibration::given(given, hard_iron_sigma_ut)?, None);
        Ok(())
    };
    // SAFETY: null, or made by create and not freed
    unsafe { with(compensator, action) }
}

/// What was learned, with its covariance and age, as one line of JSON to be kept for the next launch. `unix_time_s` is now, seconds since 1970. The text is
/// the compensator's, good until the next call of this function.
///
/// Errors: NULL_POINTER (both); NOTHING_YET: nothing was learned from live samples; `*kept_json` is null then.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_keep(
    compensator: *const Compensator,
    unix_time_s: i64,
    kept_json: *mut *const c_char,
) -> Error {
    // SAFETY: null, or made by create and not freed
    let place = unsafe { compensator.as_ref() }.map(|it| &it.kept);
    let action = |core: &mut Core| {
        if kept_json.is_null() {
            return Err(Failure::null("kept_json"));
        }
        // SAFETY: it is not null
        unsafe { kept_json.write(std::ptr::null()) };
        let kept =
            core.compensator.keep(unix_time_s).ok_or_else(|| Failure::nothing_yet("learned calibration", TURN))?;
        if let Some(place) = place {
            // SAFETY: it is not null
            unsafe { kept_json.write(put(place, c_text(&kept.to_json()))) };
        }
        Ok(())
    };
    // SAFETY: null, or made by create and not freed
    unsafe { with(compensator, action) }
}

/// Begins with a text of magcomp_compensator_keep, as sure as its age makes it. `unix_time_s` is now, seconds since 1970 by the clock that keep was told; of
/// a time before that, such as MAGCOMP_TIME_UNKNOWN, as good as nothing is believed beforehand. Live samples judge it first, as above.
///
/// Errors: NULL_POINTER (both); CONFIG (not UTF-8); KEPT_DAMAGED; KEPT_NEWER.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn magcomp_compensator_adopt(
    compensator: *mut Compensator,
    kept_json: *const c_char,
    unix_time_s: i64,
) -> Error {
    let action = |core: &mut Core| {
        // SAFETY: the caller's
        let kept = KeptCalibration::from_json(unsafe { text(kept_json, "kept_json") }?)?;
        core.compensator.adopt(&kept, Some(unix_time_s));
        Ok(())
    };
    // SAFETY: null, or made by create and not freed
    unsafe { with(compensator, action) }
}

/// Any thread may call.
const _: fn() = || {
    fn any_thread<T: Send + Sync>() {}
    any_thread::<Compensator>();
};
