//! magcomp for C and C++: the core's `Compensator` behind an opaque pointer, plain structs, codes in place of errors. The docs of what is exported
//! are those of `include/magcomp.h`, which cbindgen writes from these files.
//!
//! Names begin with their object's: `magcomp_push` and two more are taken by the stream that Swift uses (`rust/magcomp-ffi/src/c.rs`), and an app may
//! link both.

// what the caller of a function must keep to is said in the header: pointers are null or good
#![allow(clippy::missing_safety_doc)]

mod calibration;
mod compensator;
mod config;
mod error;
mod fit;
mod grows;
mod outside;
mod reading;
// made, for people to read and not to edit
#[rustfmt::skip]
mod settings;
// made, for people to read and not to edit
#[rustfmt::skip]
mod status;
#[cfg(test)]
mod tests;

use std::ffi::{CStr, c_char};

/// The time since 1970 is not known: it is before all.
pub const MAGCOMP_TIME_UNKNOWN: i64 = i64::MIN;

/// The version that a program is compiled for; magcomp_version() has that of the library which it runs with.
pub const MAGCOMP_VERSION_MAJOR: u32 = 0;
/// Its second number. Before 1.0 another one may be another ABI.
pub const MAGCOMP_VERSION_MINOR: u32 = 1;
/// Its third number.
pub const MAGCOMP_VERSION_PATCH: u32 = 0;

const VERSION: &CStr = match CStr::from_bytes_with_nul(concat!(env!("CARGO_PKG_VERSION"), "\0").as_bytes()) {
    Ok(version) => version,
    Err(_) => panic!("a version has no zero byte"),
};

/// The library's version, such as 0.1.0.
#[unsafe(no_mangle)]
pub extern "C" fn magcomp_version() -> *const c_char {
    VERSION.as_ptr()
}
