// made by bindings/generate.sh from bindings/status.toml and bindings/reading.toml
package org.magcomp.core

/**
 * A reading that is filled again and again, so that a stream of sensor events allocates nothing.
 *
 * A value that is not known is NaN here; [toReading] makes an immutable [MagneticReading] of it, where such a value is null. A buffer is
 * not thread-safe: give every thread its own.
 */
public class ReadingBuffer {
    internal val slots: DoubleArray = DoubleArray(FastPath.slots)

    /** Time of the sample, nanoseconds. */
    public var timeNs: Long = 0
        internal set

    /** Corrected field to the right of the screen, microtesla. */
    public val xUt: Double get() = slots[FIELD]

    /** Corrected field towards the top of the screen, microtesla. */
    public val yUt: Double get() = slots[FIELD + 1]

    /** Corrected field out of the screen, microtesla. */
    public val zUt: Double get() = slots[FIELD + 2]

    /** One standard deviation of the corrected field per axis, microtesla. */
    public val fieldSigmaUt: Double get() = slots[FIELD_SIGMA]

    /** The estimator's own, smoother estimate of the same vector, to the right of the screen, microtesla. */
    public val filteredXUt: Double get() = slots[FILTERED_FIELD]

    /** The same towards the top of the screen, microtesla. */
    public val filteredYUt: Double get() = slots[FILTERED_FIELD + 1]

    /** The same out of the screen, microtesla. */
    public val filteredZUt: Double get() = slots[FILTERED_FIELD + 2]

    /** Length of the corrected field, microtesla. */
    public val totalFieldUt: Double get() = slots[TOTAL_FIELD]

    /** Clockwise from magnetic north, degrees, 0 to 360. */
    public val headingDeg: Double get() = slots[HEADING]

    /** One standard deviation of [headingDeg], degrees. NaN when the calibration's own uncertainty is not known. */
    public val headingSigmaDeg: Double get() = slots[HEADING_SIGMA]

    /** Clockwise from true north, degrees, 0 to 360. NaN without a declination. */
    public val trueHeadingDeg: Double get() = slots[TRUE_HEADING]

    /** Angle of the field below the horizon, degrees. NaN where no field is known and north comes from outside. */
    public val inclinationDeg: Double get() = slots[INCLINATION]

    /** Real part of the unit quaternion that takes a vector of the device frame to (east, north, up), north magnetic. */
    public val attitudeW: Double get() = slots[ATTITUDE]

    /** Its part of i. */
    public val attitudeX: Double get() = slots[ATTITUDE + 1]

    /** Its part of j. */
    public val attitudeY: Double get() = slots[ATTITUDE + 2]

    /** Its part of k. */
    public val attitudeZ: Double get() = slots[ATTITUDE + 3]

    /** One standard deviation of the attitude, as [DeviceAttitude.sigmaDeg], degrees. NaN when the calibration's own uncertainty is not known. */
    public val attitudeSigmaDeg: Double get() = slots[ATTITUDE_SIGMA]

    /** Uniformity sigma_T of the latest orientations, 0 to about 1, dimensionless. NaN until there are enough of them and a calibration. */
    public val sigmaT: Double get() = slots[SIGMA_T]

    /** Samples in the window of the estimator. */
    public val window: Int get() = slots[WINDOW].toInt()

    /** Share of the directions seen in that window, 0 to 1. */
    public val coverage: Double get() = slots[COVERAGE]

    /** Predicted rms error of a corrected direction by the parameters in force, over all directions, degrees. NaN when it is not known. */
    public val directionSigmaDeg: Double get() = slots[DIRECTION_SIGMA]

    /** The same for the one combination of parameters that is known worst, degrees. */
    public val worstSigmaDeg: Double get() = slots[WORST_SIGMA]

    /** Which parameters the latest change set free. Adaptive method only. Null when it is not known. */
    public val modelOrder: ModelOrder? get() = ModelOrder.entries.getOrNull(slots[MODEL_ORDER].toInt())

    /** By how much the operating system's own hard-iron estimate jumped with this sample, microtesla. A jump means that the operating system has recalibrated; the raw field has not changed. NaN when it did not jump or is not reported. */
    public val reportedHardIronJumpUt: Double get() = slots[REPORTED_JUMP]

    /** The sensors the estimator runs on. */
    public val mode: SensorMode get() = SensorMode.entries[slots[MODE].toInt()]

    /** The latest change that was decided. Allocates when it is another one than before. */
    public val event: FieldEvent?
        get() {
            val kind = FieldEventKind.entries.getOrNull(slots[EVENT].toInt())
            val sinceNs = whole(EVENT_TIMES)
            val decidedNs = whole(EVENT_TIMES + 2)
            val isSame = latestEvent.let { it != null && it.kind == kind && it.sinceNs == sinceNs && it.decidedNs == decidedNs }
            if (!isSame) latestEvent = kind?.let { FieldEvent(it, sinceNs = sinceNs, decidedNs = decidedNs) }
            return latestEvent
        }
    private var latestEvent: FieldEvent? = null

    /** What the compensator is doing, and why. Allocates for a status that carries data. */
    public val status: CompensationStatus
        get() = when (val kind = slots[STATUS].toInt()) {
            0 -> CompensationStatus.Collecting(missing())
            1 -> CompensationStatus.Tracking
            2 -> CompensationStatus.Suspect(whole(WHOLE))
            3 -> CompensationStatus.Held(holdReason())
            4 -> CompensationStatus.Disturbed(whole(WHOLE))
            5 -> CompensationStatus.Rejected(rejectReason())
            else -> error("status $kind: the library's native part is of another version")
        }

    /** The same as an immutable record. */
    public fun toReading(): MagneticReading = reading(timeNs, event, status)

    /** The numbers with another time, event and status. */
    internal fun reading(timeNs: Long, event: FieldEvent?, status: CompensationStatus): MagneticReading = MagneticReading(
        timeNs = timeNs,
        fieldUt = vector(FIELD),
        fieldSigmaUt = known(slots[FIELD_SIGMA]),
        filteredFieldUt = vector(FILTERED_FIELD),
        totalFieldUt = known(slots[TOTAL_FIELD]),
        heading = heading(),
        attitude = attitude(),
        sigmaT = known(slots[SIGMA_T]),
        window = slots[WINDOW].toInt(),
        coverage = slots[COVERAGE],
        directionSigmaDeg = known(slots[DIRECTION_SIGMA]),
        worstSigmaDeg = known(slots[WORST_SIGMA]),
        modelOrder = modelOrder,
        reportedHardIronJumpUt = known(slots[REPORTED_JUMP]),
        mode = mode,
        event = event,
        status = status,
    )

    private fun heading(): CompassHeading? = known(slots[HEADING])?.let {
        CompassHeading(
            headingDeg = it,
            headingSigmaDeg = known(slots[HEADING_SIGMA]),
            trueHeadingDeg = known(slots[TRUE_HEADING]),
            inclinationDeg = known(slots[INCLINATION]),
        )
    }

    private fun attitude(): DeviceAttitude? = known(slots[ATTITUDE])?.let {
        DeviceAttitude(
            w = it,
            x = slots[ATTITUDE + 1],
            y = slots[ATTITUDE + 2],
            z = slots[ATTITUDE + 3],
            sigmaDeg = known(slots[ATTITUDE_SIGMA]),
        )
    }

    private fun missing(): CollectingReason =
        when (val reason = slots[REASON].toInt()) {
            0 -> CollectingReason.Samples(whole(WHOLE).toInt(), whole(WHOLE + 2).toInt())
            1 -> CollectingReason.Fit(fitProblem())
            2 -> CollectingReason.Rotation
            3 -> CollectingReason.Directions
            else -> error("missing $reason: the library's native part is of another version")
        }

    private fun holdReason(): HoldReason =
        when (val reason = slots[REASON].toInt()) {
            0 -> HoldReason.LowUniformity
            1 -> HoldReason.FitRefused(fitProblem())
            2 -> HoldReason.Constant
            3 -> HoldReason.AtRest
            4 -> HoldReason.TooLittleRotation
            5 -> HoldReason.NoGyroscope
            else -> error("hold reason $reason: the library's native part is of another version")
        }

    private fun rejectReason(): RejectReason =
        when (val reason = slots[REASON].toInt()) {
            0 -> RejectReason.NotFinite
            1 -> RejectReason.OutOfRange(slots[REAL], slots[REAL + 1])
            2 -> RejectReason.Saturated(DeviceAxis.entries[whole(WHOLE).toInt()], slots[REAL], slots[REAL + 1])
            3 -> RejectReason.TimeNotAfter(whole(WHOLE), whole(WHOLE + 2))
            4 -> RejectReason.TimeJump(slots[REAL], slots[REAL + 1])
            5 -> RejectReason.Stuck(whole(WHOLE).toInt())
            6 -> RejectReason.Axes(slots[REAL].toInt(), slots[REAL + 1].toInt(), slots[REAL + 2].toInt())
            else -> error("reject reason $reason: the library's native part is of another version")
        }

    private fun fitProblem(): FitProblem =
        when (val problem = slots[FIT_PROBLEM].toInt()) {
            0 -> FitProblem.TooFewSamples(whole(WHOLE).toInt())
            1 -> FitProblem.Planar(slots[REAL])
            2 -> FitProblem.PoorCoverage(slots[REAL], slots[REAL + 1])
            3 -> FitProblem.Inconsistent(slots[REAL], slots[REAL + 1])
            4 -> FitProblem.NotAnEllipsoid
            5 -> FitProblem.FieldOutOfRange(slots[REAL], slots[REAL + 1], slots[REAL + 2])
            6 -> FitProblem.NotFinite
            else -> error("fit problem $problem: the library's native part is of another version")
        }

    private fun vector(at: Int): DeviceVector? = if (slots[at].isNaN()) null else DeviceVector(slots[at], slots[at + 1], slots[at + 2])

    /** A whole number from its upper and lower 32 bits. */
    private fun whole(at: Int): Long = (slots[at].toLong() shl 32) or slots[at + 1].toLong()

    internal companion object {
        const val FIELD = 0
        const val FIELD_SIGMA = 3
        const val FILTERED_FIELD = 4
        const val TOTAL_FIELD = 7
        const val HEADING = 8
        const val HEADING_SIGMA = 9
        const val TRUE_HEADING = 10
        const val INCLINATION = 11
        const val ATTITUDE = 12
        const val ATTITUDE_SIGMA = 16
        const val SIGMA_T = 17
        const val WINDOW = 18
        const val COVERAGE = 19
        const val DIRECTION_SIGMA = 20
        const val WORST_SIGMA = 21
        const val MODEL_ORDER = 22
        const val REPORTED_JUMP = 23
        const val MODE = 24
        const val EVENT = 25
        const val EVENT_TIMES = 26
        const val STATUS = 30
        const val REASON = 31
        const val FIT_PROBLEM = 32
        const val REAL = 33
        const val WHOLE = 36
        const val POINTING = 40

        fun known(value: Double): Double? = if (value.isNaN()) null else value
    }
}
