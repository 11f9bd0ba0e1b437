package org.magcomp.core

/**
 * Frees a magnetometer from the disturbance its phone carries, sample by sample.
 *
 * Any thread may call it, and close it meanwhile: a call after [close] throws [MagcompException.Closed]. After a defect
 * of the library calls throw [MagcompException.Panicked] until [reset].
 *
 * @property config the config it was made with. A field left out has the library's default, as in
 *   [Compass][org.magcomp.Compass] ([defaultConfig] shows all)
 * @throws MagcompException.Config when a field of the config is out of range
 * @throws org.magcomp.NativeLibraryException when the app holds no native library for this phone
 */
public class Compensator @JvmOverloads @Throws(MagcompException::class) constructor(public val config: CompensationConfig = CompensationConfig()) :
    AutoCloseable {
    private val native = NativeLibrary.check().let { NativeCompensator(config) }
    internal val handle = native.fastHandle()

    /**
     * Takes a raw magnetometer event and writes the answer to [out], without an allocation. A sample that cannot be used comes back with status
     * `Rejected` and changes nothing. After 50 such samples in a row whose times follow one another but not the latest used sample, the
     * compensator assumes another clock: it keeps the calibration and begins anew with everything else. At the sensor's full scale
     * (`Saturated`) a gyroscope carries the field on: the reading has a carried field and a heading, and the compensator learns nothing.
     *
     * @param timeNs time of the event, nanoseconds
     * @param xUt raw field to the right of the screen, microtesla
     * @param yUt raw field towards the top of the screen, microtesla
     * @param zUt raw field out of the screen, microtesla
     */
    @Throws(MagcompException::class)
    public fun push(timeNs: Long, xUt: Double, yUt: Double, zUt: Double, out: ReadingBuffer) {
        push(timeNs, xUt, yUt, zUt, Double.NaN, Double.NaN, Double.NaN, out)
    }

    /**
     * Takes a raw magnetometer event with the operating system's own estimate of the hard iron ([bxUt], [byUt], [bzUt],
     * microtesla; NaN for none), and else does the same as the shorter form.
     */
    @Throws(MagcompException::class)
    public fun push(
        timeNs: Long,
        xUt: Double,
        yUt: Double,
        zUt: Double,
        bxUt: Double,
        byUt: Double,
        bzUt: Double,
        out: ReadingBuffer,
    ) {
        check(FastPath.push(handle, timeNs, xUt, yUt, zUt, bxUt, byUt, bzUt, out.slots))
        out.timeNs = timeNs
    }

    /** Takes a raw magnetometer event and gives the answer, both as immutable records. */
    @Throws(MagcompException::class)
    public fun push(sample: MagneticSample): MagneticReading {
        val buffer = ReadingBuffer()
        val field = sample.fieldUt
        val reported = sample.reportedHardIronUt ?: NOT_REPORTED
        push(sample.timeNs, field.x, field.y, field.z, reported.x, reported.y, reported.z, buffer)
        return buffer.toReading()
    }

    /**
     * Takes a gyroscope event: time in nanoseconds, rates in rad/s about x, y and z.
     *
     * @return whether it was used; if not, for instance because it came too late, nothing has changed
     */
    @Throws(MagcompException::class)
    public fun pushRotationRate(timeNs: Long, xRadS: Double, yRadS: Double, zRadS: Double): Boolean =
        check(FastPath.pushRotationRate(handle, timeNs, xRadS, yRadS, zRadS)) == 0

    /**
     * Takes an accelerometer or gravity event: time in nanoseconds, m/s^2 along x, y and z; at rest it points up.
     *
     * @return whether it was used; if not, for instance because it came too late, nothing has changed
     */
    @Throws(MagcompException::class)
    public fun pushUp(timeNs: Long, xMS2: Double, yMS2: Double, zMS2: Double): Boolean =
        check(FastPath.pushUp(handle, timeNs, xMS2, yMS2, zMS2)) == 0

    /**
     * Takes a heading that something else than the magnetometer knows: a GNSS course, a landmark. The gyroscope carries north from one to the
     * next; without a gyroscope they are not used. A heading that contradicts what is known is ignored, unless others say the same for a
     * minute. The filtered field, heading and attitude go by it; the calibration and the corrected field do not.
     *
     * @return whether the heading was taken; if not, it came more than 5 s late, a second time, or from another clock, and nothing has changed
     * @throws MagcompException.EventRejected when a number is not finite or out of range; nothing has changed then
     */
    @Throws(MagcompException::class)
    public fun pushHeading(sample: HeadingSample): Boolean = taken { native.pushHeading(sample) }

    /**
     * Takes an orientation that something else knows: a camera's pose. Its turns stand in for a missing gyroscope. If its world's y axis points
     * north, it is a heading too, as [pushHeading] takes.
     *
     * @return whether the orientation was taken, as in [pushHeading]
     * @throws MagcompException.EventRejected when a number is not finite or out of range; nothing has changed then
     */
    @Throws(MagcompException::class)
    public fun pushAttitude(sample: AttitudeSample): Boolean = taken { native.pushAttitude(sample) }

    /** What headings from outside are worth after the latest sample; null if none came in the last two minutes. */
    @Throws(MagcompException::class)
    public fun headingAid(): HeadingAid? = unlessClosed { native.headingAid() }

    /** The declination that true headings from outside have shown; null before the first, and while a declination is set. */
    @Throws(MagcompException::class)
    public fun foundDeclination(): FoundDeclination? = unlessClosed { native.foundDeclination() }

    /**
     * Takes the events of a recording in the order they happened, and gives the answers to the magnetic ones. It does not look at the operating
     * system's own hard iron.
     */
    @Throws(MagcompException::class)
    public fun pushAll(events: List<SensorSample>): List<MagneticReading> = events.mapNotNull { event ->
        when (event) {
            is SensorSample.Magnetic -> return@mapNotNull push(event.sample.copy(reportedHardIronUt = null))
            is SensorSample.RotationRate -> with(event.sample.rateRadS) { pushRotationRate(event.timeNs, x, y, z) }
            is SensorSample.Up -> with(event.sample.upMS2) { pushUp(event.timeNs, x, y, z) }
        }
        null
    }

    /**
     * Changes the frame that headings have from now on, for instance when the screen was turned. Nothing else changes.
     *
     * @throws MagcompException.Config when the declination is out of range
     */
    @Throws(MagcompException::class)
    public fun setHeadingFrame(frame: HeadingFrame): Unit = unlessClosed { native.setHeadingFrame(frame) }

    /** The hard iron, soft iron and field strength in force, or null. */
    @Throws(MagcompException::class)
    public fun calibration(): MagnetometerCalibration? {
        val v = DoubleArray(FastPath.CALIBRATION)
        if (check(FastPath.calibration(handle, v)) == 0) return null
        return MagnetometerCalibration(SoftIron(v[0], v[1], v[2], v[3], v[4], v[5]), DeviceVector(v[6], v[7], v[8]), v[9])
    }

    /**
     * Puts a calibration in force until something better is learned. The stream goes on.
     *
     * @param hardIronSigmaUt one standard deviation of each component of its hard iron, microtesla, 0.01 to 1000; the first
     *   readings are as unsure as that
     * @throws MagcompException.Calibration when the numbers are no calibration
     * @throws MagcompException.Config when the standard deviation is out of range; nothing has changed then
     */
    @Throws(MagcompException::class)
    public fun adopt(calibration: MagnetometerCalibration, hardIronSigmaUt: Double): Unit =
        unlessClosed { native.adopt(calibration, hardIronSigmaUt) }

    /**
     * The calibration in force with what is known of it, as JSON, for [adoptKept] at the next launch. It is null while nothing was learned
     * from live samples: who gave a calibration has it already.
     *
     * @param unixTimeS now, seconds since 1970
     */
    @Throws(MagcompException::class)
    public fun keep(unixTimeS: Long): String? = unlessClosed { native.keep(unixTimeS) }

    /**
     * Puts the calibration of a text of [keep] in force until something better is learned. The stream, the config and the heading frame stay.
     * The calibration is as sure as it was, less what its age costs. The first live samples judge it: those that disagree widen or replace it.
     *
     * @param unixTimeS now, seconds since 1970, by the clock that [keep] was told; null: not known, so as good as nothing is believed
     *   beforehand
     * @throws MagcompException.KeptDamaged when it is no such text; nothing has changed then
     * @throws MagcompException.KeptNewer when a newer version wrote it; nothing has changed then
     */
    @Throws(MagcompException::class)
    public fun adoptKept(text: String, unixTimeS: Long?): Unit = unlessClosed { native.adoptKept(text, unixTimeS) }

    /**
     * Tells of time that the samples' clock does not show, because the phone slept. From here on the calibration is as unsure as one that was
     * kept for so long, and the compensator finds anew where the field points. The samples' time goes on.
     *
     * @param hiddenS about how long, seconds, 0 to 1e9
     * @throws MagcompException.Config when that is out of range; nothing has changed then
     */
    @Throws(MagcompException::class)
    public fun pushGap(hiddenS: Double): Unit = unlessClosed { native.pushGap(hiddenS) }

    /** How many gaps there were: of the gyroscope while it was in use, of samples, and those told by [pushGap]. */
    @Throws(MagcompException::class)
    public fun gaps(): Long = unlessClosed { native.gaps() }

    /**
     * The covariance in force of b_x b_y b_z (microtesla) m_xx m_yy m_zz m_xy m_xz m_yz (dimensionless), 9 x 9, row by row; null if it is
     * not known.
     */
    @Throws(MagcompException::class)
    public fun covariance(): List<Double>? = unlessClosed { native.covariance() }

    /** The latest ellipsoid fit that was accepted, with its covariance; the aided and the adaptive method make none. */
    @Throws(MagcompException::class)
    public fun fit(): EllipsoidFit? = unlessClosed { native.fit() }

    /** The directions that were seen, for guidance. */
    @Throws(MagcompException::class)
    public fun coverage(): DirectionCoverage {
        val out = DoubleArray(FastPath.COVERAGE)
        val count = coverage(out)
        return DirectionCoverage(out[0], List(count) { DeviceVector(out[1 + 3 * it], out[2 + 3 * it], out[3 + 3 * it]) })
    }

    /** The same as numbers: the share, then three for each direction, which it counts. */
    internal fun coverage(out: DoubleArray): Int = check(FastPath.coverage(handle, out))

    /**
     * Forgets everything but the config it was made with, also a heading frame that was set since. Makes the
     * compensator usable again after [MagcompException.Panicked].
     */
    @Throws(MagcompException::class)
    public fun reset(): Unit = unlessClosed { native.reset() }

    /** Frees the native state now. A second call does nothing, and another thread may push meanwhile. */
    override fun close(): Unit = closing(native) { native.shutDown() }

    private inline fun taken(push: () -> Unit): Boolean = try {
        unlessClosed(push)
        true
    } catch (e: MagcompException.EventRejected) {
        if (e.reason == EventRejection.NOT_FINITE || e.reason == EventRejection.OUT_OF_RANGE) throw e
        false
    }

    private fun check(code: Int): Int = when {
        code >= 0 -> code
        // the error with what the panic said; when another thread has reset it meanwhile, that call goes through
        code == FastPath.PANICKED -> unlessClosed { native.calibration() }.let { throw MagcompException.Panicked("reset meanwhile") }
        code == FastPath.CLOSED -> throw MagcompException.Closed()
        else -> error("native error $code: the library's native part is of another version")
    }

    private companion object {
        val NOT_REPORTED = DeviceVector(Double.NaN, Double.NaN, Double.NaN)
    }
}
