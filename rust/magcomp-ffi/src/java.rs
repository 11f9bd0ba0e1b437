//! Reading and writing Java's primitive arrays, and the only unsafe code of the project.
//!
//! The jni crate's own array types bring class loading and exceptions along, 70 kB and 60 ns a call. The JVM checks every
//! range itself, so nothing here can reach outside an array.

#![allow(unsafe_code)]

use jni::sys::{JNIEnv, jarray, jdouble, jint, jlong, jsize};

/// What a native method gets first: the thread's way into the JVM. Only the JVM makes one, for the length of a call.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Env(*mut JNIEnv);

/// A primitive array a native method was given, for the length of the call.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct JavaArray<T> {
    array: jarray,
    of: std::marker::PhantomData<T>,
}

/// Primitives that arrays are made of.
pub(crate) trait Element: Copy {
    /// # Safety
    /// `array` is an array of `Self`.
    unsafe fn read(env: Env, array: jarray, at: jsize, to: &mut [Self]);

    /// # Safety
    /// `array` is an array of `Self`.
    unsafe fn write(env: Env, array: jarray, at: jsize, from: &[Self]);
}

macro_rules! element {
    ($primitive:ty, $read:ident, $write:ident) => {
        impl Element for $primitive {
            unsafe fn read(env: Env, array: jarray, at: jsize, to: &mut [Self]) {
                // SAFETY: by the caller; the function table is the JVM's
                unsafe { ((**env.0).v1_1.$read)(env.0, array, at, to.len() as jsize, to.as_mut_ptr()) }
            }

            unsafe fn write(env: Env, array: jarray, at: jsize, from: &[Self]) {
                // SAFETY: as above
                unsafe { ((**env.0).v1_1.$write)(env.0, array, at, from.len() as jsize, from.as_ptr()) }
            }
        }
    };
}

element!(i8, GetByteArrayRegion, SetByteArrayRegion);
element!(jlong, GetLongArrayRegion, SetLongArrayRegion);
element!(jdouble, GetDoubleArrayRegion, SetDoubleArrayRegion);

impl<T: Element> JavaArray<T> {
    /// Elements; 0 for null.
    pub(crate) fn len(self, env: Env) -> usize {
        if self.array.is_null() {
            return 0;
        }
        // SAFETY: Kotlin's declaration says that this is an array, and it is not null
        let length: jint = unsafe { ((**env.0).v1_1.GetArrayLength)(env.0, self.array) };
        usize::try_from(length).unwrap_or(0)
    }

    /// Copies `to.len()` elements from `at`. Where the array has not that many, an `IndexOutOfBoundsException` waits for
    /// the native method's return, which must follow.
    pub(crate) fn read(self, env: Env, at: usize, to: &mut [T]) {
        if !self.array.is_null() {
            // SAFETY: Kotlin's declaration says which array it is
            unsafe { T::read(env, self.array, at as jsize, to) }
        }
    }

    /// Copies `from` to `at`. Where the array has no room for it, as `read`.
    pub(crate) fn write(self, env: Env, at: usize, from: &[T]) {
        if !self.array.is_null() {
            // SAFETY: as above
            unsafe { T::write(env, self.array, at as jsize, from) }
        }
    }
}
