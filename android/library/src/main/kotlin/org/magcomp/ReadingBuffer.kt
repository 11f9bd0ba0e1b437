package org.magcomp

/**
 * A reading that is filled again and again, so that a stream of sensor events allocates nothing.
 *
 * What is not known is NaN here; [toReading] gives the same as an immutable [Reading], where it is null. A buffer is
 * not thread-safe: give every thread its own.
 */
public class ReadingBuffer {
    internal val slots: DoubleArray = DoubleArray(FastPath.slots())

    /** Time of the sample, nanoseconds. */
    public var timeNs: Long = 0
        internal set

    /** Corrected field to the right of the screen, microtesla. */
    public val xUt: Double get() = slots[FIELD]

    /** Corrected field towards the top of the screen, microtesla. */
    public val yUt: Double get() = slots[FIELD + 1]

    /** Corrected field out of the screen, microtesla. */
    public val zUt: Double get() = slots[FIELD + 2]

    /** Length of the corrected field, microtesla. */
    public val totalFieldUt: Double get() = slots[TOTAL_FIELD]

    /** Clockwise from magnetic north, degrees, 0 to 360. */
    public val headingDeg: Double get() = slots[HEADING]

    /** One standard deviation of [headingDeg], degrees. */
    public val headingSigmaDeg: Double get() = slots[HEADING_SIGMA]

    /** Clockwise from true north, degrees, 0 to 360; NaN without a declination. */
    public val trueHeadingDeg: Double get() = slots[TRUE_HEADING]

    /** Angle of the field below the horizon, degrees. */
    public val inclinationDeg: Double get() = slots[INCLINATION]

    /** Uniformity sigma_T of the latest orientations, dimensionless. */
    public val sigmaT: Double get() = slots[SIGMA_T]

    /** Samples in the window of the estimator. */
    public val window: Int get() = slots[WINDOW].toInt()

    /** Share of the directions seen in that window, 0 to 1. */
    public val coverage: Double get() = slots[COVERAGE]

    /** What the compensator is doing, and why. Allocates for a status that carries data. */
    public val status: Status get() = status(slots, timeNs)

    /** The same as an immutable record. */
    public fun toReading(): Reading = reading(slots, 0, timeNs)

    internal companion object {
        // as `mod slot` in fast.rs
        const val STATUS = 0
        const val REASON = 1
        const val DETAILS = 2
        const val FIT_PROBLEM = 4
        const val FIT_DETAILS = 5
        const val FIELD = 8
        const val FILTERED_FIELD = 11
        const val TOTAL_FIELD = 14
        const val HEADING = 15
        const val HEADING_SIGMA = 16
        const val TRUE_HEADING = 17
        const val INCLINATION = 18
        const val SIGMA_T = 19
        const val WINDOW = 20
        const val COVERAGE = 21
        const val REPORTED_JUMP = 22
        const val FIELD_SIGMA = 23
        const val MODE = 24
        const val EVENT = 25
        const val DIRECTION_SIGMA = 30
        const val WORST_SIGMA = 31
        const val ORDER = 32

        fun reading(slots: DoubleArray, at: Int, timeNs: Long): Reading {
            val heading = known(slots[at + HEADING])?.let {
                Heading(
                    headingDeg = it,
                    headingSigmaDeg = known(slots[at + HEADING_SIGMA]),
                    trueHeadingDeg = known(slots[at + TRUE_HEADING]),
                    inclinationDeg = slots[at + INCLINATION],
                )
            }
            return Reading(
                timeNs = timeNs,
                fieldUt = vector(slots, at + FIELD),
                fieldSigmaUt = known(slots[at + FIELD_SIGMA]),
                filteredFieldUt = vector(slots, at + FILTERED_FIELD),
                totalFieldUt = known(slots[at + TOTAL_FIELD]),
                heading = heading,
                sigmaT = known(slots[at + SIGMA_T]),
                window = slots[at + WINDOW].toInt(),
                coverage = slots[at + COVERAGE],
                reportedHardIronJumpUt = known(slots[at + REPORTED_JUMP]),
                directionSigmaDeg = known(slots[at + DIRECTION_SIGMA]),
                worstSigmaDeg = known(slots[at + WORST_SIGMA]),
                modelOrder = known(slots[at + ORDER])?.let { ModelOrder.entries[it.toInt()] },
                mode = SensorMode.entries[slots[at + MODE].toInt()],
                event = event(slots, at + EVENT),
                status = status(slots, timeNs, at),
            )
        }

        fun status(slots: DoubleArray, timeNs: Long, at: Int = 0): Status {
            val a = slots[at + DETAILS]
            val b = slots[at + DETAILS + 1]
            return when (val code = slots[at + STATUS].toInt()) {
                0 -> Status.Collecting(missing(slots, at, a, b))
                1 -> Status.Tracking
                2 -> Status.Suspect(whole(a, b))
                3 -> Status.Held(holdReason(slots, at))
                4 -> Status.Disturbed(whole(a, b))
                5 -> Status.Rejected(rejectReason(slots[at + REASON].toInt(), a, b, timeNs))
                else -> error("status $code: the library's native part is of another version")
            }
        }

        private fun event(slots: DoubleArray, at: Int): Event? = known(slots[at])?.let {
            val kind = EventKind.entries[it.toInt()]
            Event(kind, sinceNs = whole(slots[at + 1], slots[at + 2]), decidedNs = whole(slots[at + 3], slots[at + 4]))
        }

        private fun missing(slots: DoubleArray, at: Int, a: Double, b: Double): Missing =
            when (val code = slots[at + REASON].toInt()) {
                0 -> Missing.Samples(a.toInt(), b.toInt())
                1 -> Missing.Fit(fitProblem(slots, at))
                2 -> Missing.Rotation
                3 -> Missing.Directions
                else -> error("missing $code: the library's native part is of another version")
            }

        private fun holdReason(slots: DoubleArray, at: Int): HoldReason =
            when (val code = slots[at + REASON].toInt()) {
                0 -> HoldReason.LowUniformity
                1 -> HoldReason.FitRefused(fitProblem(slots, at))
                2 -> HoldReason.Constant
                3 -> HoldReason.AtRest
                4 -> HoldReason.TooLittleRotation
                5 -> HoldReason.NoGyroscope
                else -> error("hold reason $code: the library's native part is of another version")
            }

        private fun rejectReason(code: Int, a: Double, b: Double, timeNs: Long): RejectReason =
            when (code) {
                0 -> RejectReason.NotFinite
                1 -> RejectReason.OutOfRange(a, b)
                2 -> RejectReason.Saturated(a, b)
                3 -> RejectReason.TimeNotAfter(timeNs, whole(a, b))
                4 -> RejectReason.TimeJump(a, b)
                5 -> RejectReason.Stuck(a.toInt())
                else -> error("reject reason $code: the library's native part is of another version")
            }

        private fun fitProblem(slots: DoubleArray, at: Int): FitProblem {
            val details = at + FIT_DETAILS
            return when (val code = slots[at + FIT_PROBLEM].toInt()) {
                0 -> FitProblem.TooFewSamples(slots[details].toInt())
                1 -> FitProblem.Planar(slots[details])
                2 -> FitProblem.PoorCoverage(slots[details], slots[details + 1])
                3 -> FitProblem.Inconsistent(slots[details], slots[details + 1])
                4 -> FitProblem.NotAnEllipsoid
                5 -> FitProblem.FieldOutOfRange(slots[details], slots[details + 1], slots[details + 2])
                6 -> FitProblem.NotFinite
                else -> error("fit problem $code: the library's native part is of another version")
            }
        }

        private fun known(value: Double): Double? = if (value.isNaN()) null else value

        private fun vector(slots: DoubleArray, at: Int): Vector3? =
            known(slots[at])?.let { Vector3(it, slots[at + 1], slots[at + 2]) }

        /** A time from its upper and lower 32 bits. */
        private fun whole(upper: Double, lower: Double): Long = (upper.toLong() shl 32) or lower.toLong()
    }
}
