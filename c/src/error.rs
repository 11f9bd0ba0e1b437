//! Codes and messages of what is refused.

use magcomp_core::{CalibrationError, ConfigError, EventRejection, KeptError};
use std::any::Any;
use std::cell::RefCell;
use std::ffi::{CStr, CString, c_char};
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Whether a call did what it is for, and why not.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(i32)]
pub enum Error {
    /// It did.
    None = 0,
    /// A pointer that must not be null is null.
    NullPointer = 1,
    /// The `size` of a struct is not set, or smaller than any version's.
    Size = 2,
    /// A setting, or a number beside it, is unknown or outside its range; or a text is no JSON, or not UTF-8.
    Config = 3,
    /// M, b and |h| are none that a calibration can have.
    Calibration = 4,
    /// A text is no kept calibration. Start without it.
    KeptDamaged = 5,
    /// A kept calibration was written by a newer version. Update the library, or start without.
    KeptNewer = 6,
    /// There is nothing to hand out yet: nothing was learned.
    NothingYet = 7,
    /// A panic was caught: a fault of the library. The compensator refuses every call but reset, free and those for its texts.
    Panicked = 8,
    /// An event beside the magnetic samples has a number that is NaN or infinite.
    EventNotFinite = 9,
    /// Such an event is beyond anything a sensor reads: 60 rad/s, 200 m/s^2; or beyond what its function takes.
    EventOutOfRange = 10,
    /// Such an event is at or before a magnetic sample that was pushed. A heading: more than 5 s so, or not after the latest that was used.
    EventLate = 11,
    /// Such an event has the time of another.
    EventDuplicate = 12,
    /// Such an event is so far ahead of the magnetic samples that its clock must be another.
    EventAhead = 13,
    /// No ellipsoid fits these samples.
    Fit = 14,
}

/// What a call refuses, and why.
#[derive(Debug)]
pub(crate) struct Failure {
    pub(crate) code: Error,
    pub(crate) why: String,
}

impl Failure {
    pub(crate) fn null(name: &str) -> Self {
        Self { code: Error::NullPointer, why: format!("{name} is a null pointer") }
    }

    pub(crate) fn nothing_yet(what: &str, after: &str) -> Self {
        Self { code: Error::NothingYet, why: format!("there is no {what} yet; {after}") }
    }

    pub(crate) fn config(error: impl std::fmt::Display) -> Self {
        Self { code: Error::Config, why: format!("config: {error}") }
    }

    pub(crate) fn panicked_before() -> Self {
        let why = "a call before this one panicked; reset the compensator or free it".to_owned();
        Self { code: Error::Panicked, why }
    }

    fn panicked(payload: &(dyn Any + Send)) -> Self {
        let text = payload.downcast_ref::<&str>().copied();
        let what = text.or_else(|| payload.downcast_ref::<String>().map(String::as_str)).unwrap_or("no message");
        Self { code: Error::Panicked, why: format!("panicked: {what}; reset the compensator or free it") }
    }
}

impl From<ConfigError> for Failure {
    fn from(error: ConfigError) -> Self {
        Self { code: Error::Config, why: error.to_string() }
    }
}

impl From<CalibrationError> for Failure {
    fn from(error: CalibrationError) -> Self {
        let why = match error {
            // the core's names a function that is not here
            CalibrationError::NotSymmetricPositiveDefinite => {
                "soft_iron is not symmetric positive definite; give the factor P of M = P R, R a rotation".to_owned()
            }
            _ => error.to_string(),
        };
        Self { code: Error::Calibration, why }
    }
}

impl From<KeptError> for Failure {
    fn from(error: KeptError) -> Self {
        let code = match error {
            KeptError::Damaged { .. } => Error::KeptDamaged,
            KeptError::Newer { .. } => Error::KeptNewer,
        };
        Self { code, why: error.to_string() }
    }
}

impl From<EventRejection> for Failure {
    fn from(rejection: EventRejection) -> Self {
        let code = match rejection {
            EventRejection::NotFinite => Error::EventNotFinite,
            EventRejection::OutOfRange => Error::EventOutOfRange,
            EventRejection::Late => Error::EventLate,
            EventRejection::Duplicate => Error::EventDuplicate,
            EventRejection::Ahead => Error::EventAhead,
        };
        Self { code, why: rejection.to_string() }
    }
}

/// What an action answers; a panic is an answer.
pub(crate) fn caught<T>(action: impl FnOnce() -> Result<T, Failure>) -> Result<T, Failure> {
    catch_unwind(AssertUnwindSafe(action)).unwrap_or_else(|payload| Err(Failure::panicked(&*payload)))
}

/// A text for C. What the caller wrote may be quoted in it, with a zero in it.
pub(crate) fn c_text(text: &str) -> CString {
    CString::new(text.replace('\0', " ")).unwrap_or_default()
}

/// A text of the caller's.
///
/// # Safety
/// `text` is null, or ends with a zero byte and stays as it is for `'a`.
pub(crate) unsafe fn text<'a>(text: *const c_char, name: &str) -> Result<&'a str, Failure> {
    if text.is_null() {
        return Err(Failure::null(name));
    }
    // SAFETY: it is not null
    let text = unsafe { CStr::from_ptr(text) };
    text.to_str().map_err(|error| Failure::config(format!("{name} is not UTF-8: {error}")))
}

thread_local! {
    /// Of calls that have no compensator.
    static LATEST: RefCell<CString> = RefCell::default();
}

/// Keeps the message of a call that has no compensator.
pub(crate) fn keep_for_thread(message: CString) {
    // none is kept for a thread that ends
    let _ = LATEST.try_with(|latest| *latest.borrow_mut() = message);
}

/// The message of the latest such call of this thread.
pub(crate) fn of_thread() -> *const c_char {
    LATEST.try_with(|latest| latest.borrow().as_ptr()).unwrap_or(c"".as_ptr())
}
