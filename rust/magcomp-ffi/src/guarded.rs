//! One mutex around one object, and the two rules of the border: a panic is caught and the object refuses further use
//! until it is reset; after `shut_down` it refuses for good.

use crate::error::MagcompError;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::{Mutex, MutexGuard};

pub(crate) struct Guarded<T>(Mutex<State<T>>);

enum State<T> {
    Open(T),
    /// What the panic said.
    Panicked(String),
    ShutDown,
}

impl<T> Guarded<T> {
    pub(crate) fn new(value: T) -> Self {
        Self(Mutex::new(State::Open(value)))
    }

    /// Runs `action` on the object, or says why not.
    pub(crate) fn with<R>(&self, action: impl FnOnce(&mut T) -> Result<R, MagcompError>) -> Result<R, MagcompError> {
        let mut state = self.lock();
        let value = match &mut *state {
            State::Open(value) => value,
            State::Panicked(message) => return Err(MagcompError::Panicked { what: message.clone() }),
            State::ShutDown => return Err(MagcompError::Closed),
        };
        caught(|| action(value)).unwrap_or_else(|what| {
            *state = State::Panicked(what.clone());
            Err(MagcompError::Panicked { what })
        })
    }

    /// Puts a new object in the place of the old one, also after a panic.
    pub(crate) fn replace(&self, make: impl FnOnce() -> Result<T, MagcompError>) -> Result<(), MagcompError> {
        let mut state = self.lock();
        if matches!(*state, State::ShutDown) {
            return Err(MagcompError::Closed);
        }
        match caught(make) {
            Ok(Ok(value)) => *state = State::Open(value),
            Ok(Err(error)) => return Err(error),
            Err(what) => {
                *state = State::Panicked(what.clone());
                return Err(MagcompError::Panicked { what });
            }
        }
        Ok(())
    }

    /// Drops the object now.
    pub(crate) fn shut_down(&self) {
        *self.lock() = State::ShutDown;
    }

    // `with` catches panics before they reach the guard, so the mutex itself is never poisoned by one of ours
    fn lock(&self) -> MutexGuard<'_, State<T>> {
        self.0.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
    }
}

/// The action's result, or what its panic said.
pub(crate) fn caught<R>(action: impl FnOnce() -> R) -> Result<R, String> {
    catch_unwind(AssertUnwindSafe(action)).map_err(|payload| {
        let text = payload.downcast_ref::<&str>().map(|text| (*text).to_owned());
        let what = text.or_else(|| payload.downcast_ref::<String>().cloned()).unwrap_or_default();
        log::error!("panic caught at the border: {what}");
        what
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_is_an_error_until_replaced() {
        let guarded = Guarded::new(1);
        let panicked = Err(MagcompError::Panicked { what: "broken".to_owned() });
        assert_eq!(guarded.with(|_| -> Result<i32, _> { panic!("broken") }), panicked);
        assert_eq!(guarded.with(|value| Ok(*value)), panicked, "refuses further use");
        guarded.replace(|| Ok(2)).unwrap();
        assert_eq!(guarded.with(|value| Ok(*value)), Ok(2));
    }

    #[test]
    fn a_panic_while_replacing_is_an_error_too() {
        let guarded = Guarded::new(1);
        let panicked = Err(MagcompError::Panicked { what: "no 7".to_owned() });
        assert_eq!(guarded.replace(|| panic!("no {}", 7)), panicked);
        assert_eq!(guarded.with(|value| Ok(*value)).map(|_| ()), panicked);
    }

    #[test]
    fn shut_down_is_for_good() {
        let guarded = Guarded::new(1);
        guarded.shut_down();
        assert_eq!(guarded.with(|value| Ok(*value)), Err(MagcompError::Closed));
        assert_eq!(guarded.replace(|| Ok(2)), Err(MagcompError::Closed));
        guarded.shut_down();
    }
}
