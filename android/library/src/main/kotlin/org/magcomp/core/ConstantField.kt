package org.magcomp.core

/**
 * One calibration from a set of orientations: collects them, shows which directions are missing, and fits. For apps that
 * ask their user to turn the phone about once; [Compensator] calibrates without being asked.
 *
 * Any thread may call it, and close it meanwhile: a call after [close] throws [MagcompException.Closed]. After a defect
 * of the library calls throw [MagcompException.Panicked] until [reset].
 *
 * @property samplesPerOrientation samples in a row that are averaged into one orientation. Above 1 the user must hold
 *   the phone still meanwhile; 1, the default, is for a phone that is turned about. A smaller number counts as 1
 * @throws org.magcomp.NativeLibraryException when the app holds no native library for this phone
 */
public class ConstantField @JvmOverloads constructor(public val samplesPerOrientation: Int = 1) : AutoCloseable {
    private val native = NativeLibrary.check().let { NativeConstantField(samplesPerOrientation) }

    /**
     * Takes one raw sample, microtesla, in the device frame.
     *
     * @throws MagcompException.Rejected when it is not finite; nothing has changed then
     */
    @Throws(MagcompException::class)
    public fun add(rawUt: DeviceVector): Unit = unlessClosed { native.add(rawUt) }

    /** How many orientations there are so far. */
    @Throws(MagcompException::class)
    public fun orientations(): Int = unlessClosed { native.orientations() }

    /** The directions that were seen and those that were not, about the best centre known so far. It costs a fit. */
    @Throws(MagcompException::class)
    public fun coverage(): DirectionCoverage = unlessClosed { native.coverage() }

    /**
     * Fits the calibration and its covariance. `CompensationConfig.initial` takes the calibration.
     *
     * @param options a field left out has the library's default
     * @throws MagcompException.Fit says what the orientations lack; the session can go on
     */
    @Throws(MagcompException::class)
    @JvmOverloads
    public fun finish(options: FitOptions? = null): EllipsoidFit = unlessClosed { native.finish(options) }

    /** Forgets the orientations, and makes it usable again after [MagcompException.Panicked]. */
    @Throws(MagcompException::class)
    public fun reset(): Unit = unlessClosed { native.reset() }

    /** Frees the native state now. A second call does nothing, and another thread may add meanwhile. */
    override fun close(): Unit = closing(native) { native.shutDown() }
}

/** The generated classes say IllegalStateException for a closed object. */
internal inline fun <T> unlessClosed(call: () -> T): T =
    try {
        call()
    } catch (_: IllegalStateException) {
        throw MagcompException.Closed()
    }

/** Ends the use of a native object, and frees it once no call is under way. A second time it does nothing. */
internal inline fun closing(native: AutoCloseable, shutDown: () -> Unit) {
    try {
        unlessClosed(shutDown)
        native.close()
    } catch (_: MagcompException.Closed) {
        // it was
    }
}
