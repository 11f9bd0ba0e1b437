//! Readers of other people's formats may panic on a damaged file: that becomes an error, and nothing is printed.

use std::cell::Cell;
use std::fmt::Display;
use std::io;
use std::panic::{self, UnwindSafe};
use std::sync::Once;

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
pub(super) fn one_line(why: impl Display) -> io::Error {
    io::Error::other(why.to_string().split_whitespace().collect::<Vec<_>>().join(" "))
}
