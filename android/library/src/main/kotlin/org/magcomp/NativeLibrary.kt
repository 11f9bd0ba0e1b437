package org.magcomp

/**
 * The app holds no native library for this phone's processor, or it can't be loaded: its ABI was left out when the app was
 * built, or the app was installed from another phone's APK.
 */
public class NativeLibraryException(cause: Throwable) :
    RuntimeException(
        "magcomp's native library can't be loaded (${(cause.cause ?: cause).message}); the app must hold it for this phone's ABI",
        cause,
    )

/** The native library, loaded once: over JNI for [FastPath], and over JNA for the generated code, which loads it again. */
internal object NativeLibrary {
    private val failure: LinkageError? = load("magcomp_ffi")

    /** @throws NativeLibraryException when it can't be loaded */
    fun check() {
        failure?.let { throw NativeLibraryException(it) }
    }

    /** What loading a library throws. */
    fun load(name: String): LinkageError? =
        try {
            System.loadLibrary(name)
            // the generated code binds its functions, and compares versions
            uniffiEnsureInitialized()
            null
        } catch (e: LinkageError) {
            e
        }
}
