package org.magcomp.core

/**
 * The JNI functions of `rust/magcomp-ffi/src/fast.rs`: primitives in, a caller-owned array out. Each answers a number,
 * below 0 an error. A handle whose object is gone answers [CLOSED]: it is a number, not a pointer.
 * Only [Compensator] makes handles, so the library is there where one is.
 */
internal object FastPath {
    const val CLOSED: Int = -1
    const val PANICKED: Int = -2

    const val HEADING: Int = 0
    const val HEADING_SIGMA: Int = 1
    const val TRUE_HEADING: Int = 2
    const val ATTITUDE_SIGMA: Int = 3

    // not in an initializer: what that throws is an Error of Java, and another one the second time

    /** Doubles in a reading; the first call of all who have no handle. */
    val slots: Int get() = NativeLibrary.check().let { slots() }

    @JvmStatic
    private external fun slots(): Int

    @JvmStatic
    external fun push(
        handle: Long,
        timeNs: Long,
        x: Double,
        y: Double,
        z: Double,
        bx: Double,
        by: Double,
        bz: Double,
        out: DoubleArray,
    ): Int

    /** One number of a heading in a frame, by the numbers of a reading; what is not known is NaN. */
    @JvmStatic
    external fun heading(numbers: DoubleArray, axis: Int, rotation: Int, which: Int): Double

    @JvmStatic
    external fun pushRotationRate(handle: Long, timeNs: Long, x: Double, y: Double, z: Double): Int

    @JvmStatic
    external fun pushUp(handle: Long, timeNs: Long, x: Double, y: Double, z: Double): Int

    @JvmStatic
    external fun calibration(handle: Long, out: DoubleArray): Int

    @JvmStatic
    external fun coverage(handle: Long, out: DoubleArray): Int

    /** Doubles of a calibration. */
    const val CALIBRATION: Int = 10

    /** Doubles of a coverage, when none of the 48 cells of the sphere was seen. */
    const val COVERAGE: Int = 1 + 3 * 48
}
