package org.magcomp

/** What this library throws: an error of the core ([org.magcomp.core.MagcompException]), of the sensors, of a recording, of the native library. */
public abstract class CompassException internal constructor(message: String? = null, cause: Throwable? = null) : RuntimeException(message, cause)

/**
 * The app holds no native library for this phone's processor, or it can't be loaded: its ABI was left out when the app was
 * built, or the app was installed from another phone's APK.
 */
public class NativeLibraryException(cause: Throwable) :
    CompassException(
        "magcomp's native library can't be loaded (${(cause.cause ?: cause).message}); the app must hold it for this phone's ABI",
        cause,
    )
