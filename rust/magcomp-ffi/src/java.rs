//! Reading and writing Java's arrays of doubles, and the only unsafe code of the project.
//!
//! The jni crate's own array types bring class loading and exceptions along, 70 kB and 60 ns a call. The JVM checks every
//! range itself, so nothing here can reach outside an array.

#![allow(unsafe_code)]

use jni::sys::{JNIEnv, jdouble, jdoubleArray, jsize};

/// What a native method gets first: the thread's way into the JVM. Only the JVM makes one, for the length of a call.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct Env(*mut JNIEnv);

/// An array of doubles a native method was given, for the length of the call.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct JavaDoubles(jdoubleArray);

impl JavaDoubles {
    /// Elements; 0 for null.
    #[cfg(feature = "test-hooks")]
    pub(crate) fn len(self, env: Env) -> usize {
        if self.0.is_null() {
            return 0;
        }
        // SAFETY: Kotlin's declaration says that this is an array, and it is not null; the function table is the JVM's
        let length = unsafe { ((**env.0).v1_1.GetArrayLength)(env.0, self.0) };
        usize::try_from(length).unwrap_or(0)
    }

    /// Copies the first `to.len()` elements. Where the array has not that many, an `IndexOutOfBoundsException` waits for the native
    /// method's return, which must follow.
    pub(crate) fn read(self, env: Env, to: &mut [jdouble]) {
        if !self.0.is_null() {
            // SAFETY: Kotlin's declaration says which array it is; the function table is the JVM's
            unsafe { ((**env.0).v1_1.GetDoubleArrayRegion)(env.0, self.0, 0, to.len() as jsize, to.as_mut_ptr()) }
        }
    }

    /// Copies `from` to the beginning. Where the array has no room for it, as `read`.
    pub(crate) fn write(self, env: Env, from: &[jdouble]) {
        if !self.0.is_null() {
            // SAFETY: as above
            unsafe { ((**env.0).v1_1.SetDoubleArrayRegion)(env.0, self.0, 0, from.len() as jsize, from.as_ptr()) }
        }
    }
}
