//! Structs of the caller that begin with their size, so that a later version can append members.

use crate::error::{Error, Failure};
use std::ptr::{copy_nonoverlapping, from_mut, from_ref};

/// Largest size that a version of these structs will have, bytes: above it the caller has not set it.
const LARGEST: usize = 4096;

/// # Safety
/// `repr(C)`; the first member is a `usize`, the struct's size; the others may hold any bits.
pub(crate) unsafe trait Grows: Copy {
    /// Its name in C.
    const NAME: &str;
    /// Its size in the first version, bytes.
    const FIRST: usize;
}

/// How many bytes the caller's struct has room for.
///
/// # Safety
/// `at` is null, or a struct of the caller's whose size is set.
pub(crate) unsafe fn room<T: Grows>(at: *const T) -> Result<usize, Failure> {
    if at.is_null() {
        return Err(Failure::null(T::NAME));
    }
    // SAFETY: every version begins with the size
    let size = unsafe { at.cast::<usize>().read() };
    if !(T::FIRST..=LARGEST).contains(&size) {
        let (name, own) = (T::NAME, size_of::<T>());
        let why = format!("size of {name} is {size}, expected sizeof({name}), {own} bytes; set it before each call");
        return Err(Failure { code: Error::Size, why });
    }
    Ok(size)
}

/// Fills what there is room for; `size` becomes the bytes that were filled.
///
/// # Safety
/// `at` has room for `room` bytes.
pub(crate) unsafe fn fill<T: Grows>(at: *mut T, room: usize, mut value: T) {
    let filled = room.min(size_of::<T>());
    // SAFETY: the trait's
    unsafe { from_mut(&mut value).cast::<usize>().write(filled) };
    // SAFETY: both have as many bytes, and the caller's struct is not on our stack
    unsafe { copy_nonoverlapping(from_ref(&value).cast::<u8>(), at.cast(), filled) };
}
