//! Readers of other people's formats may panic on a damaged file: that becomes an error, and nothing is printed.

use std::cell::Cell;
use std::panic::{self, UnwindSafe};
use std::sync::Once;
#[cfg(feature = "formats")]
use std::{fmt::Display, io};

thread_local! {
    static GUARDED: Cell<bool> = const { Cell::new(false) };
}

/// The result of `read`, or the error that it panicked.
pub(super) fn guarded<T>(read: impl FnOnce() -> T + UnwindSafe) -> Result<T, &'static str> {
    static QUIET: Once = Once::new();
    QUIET.call_once(|| {
        let usual = panic::take_hook();
        panic::set_hook(Box::new(move |panic| {
            if !GUARDED.get() {
                usual(panic);
            }
        }));
    });
    let before = GUARDED.replace(true);
    let result = panic::catch_unwind(read);
    GUARDED.set(before);
    result.map_err(|_| "the file is damaged: its reader stopped within it")
}

/// An error of such a reader, as one line.
#[cfg(feature = "formats")]
pub(super) fn one_line(why: impl Display) -> io::Error {
    io::Error::other(why.to_string().split_whitespace().collect::<Vec<_>>().join(" "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_becomes_an_error_and_only_panics_within_are_quiet() {
        assert_eq!(guarded(|| 7), Ok(7));
        let nested = guarded(|| {
            assert!(guarded(|| panic!("within")).is_err() && GUARDED.get());
            // another thread's panics are printed as ever
            std::thread::spawn(|| GUARDED.get()).join().unwrap()
        });
        assert_eq!(nested, Ok(false));
        assert_eq!(guarded(|| -> u8 { panic!("outermost") }), Err("the file is damaged: its reader stopped within it"));
        assert!(!GUARDED.get());
    }

    #[test]
    #[cfg(feature = "formats")]
    fn errors_are_one_line() {
        assert_eq!(one_line("a\n  b\r\nc").to_string(), "a b c");
    }
}
