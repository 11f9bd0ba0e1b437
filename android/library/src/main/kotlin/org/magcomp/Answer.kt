package org.magcomp

import org.magcomp.core.*

/**
 * What the estimator answered to a sample. Kept as numbers, which take less than half of the records' room; a record is made when it is
 * first asked for. Two threads may make one each, which are equal.
 */
internal class Answer private constructor(
    /** As [ReadingBuffer] has them before [ReadingBuffer.SIGMA_T], then the raw sample; null: the records were given. */
    private val numbers: DoubleArray?,
    /** As it has them from there on. The core forms them once a second: the answers between share them. */
    private val figures: DoubleArray?,
    val timeNs: Long,
    val status: CompensationStatus,
    private val event: FieldEvent?,
    private val reported: DeviceVector?,
    private var madeReading: MagneticReading?,
    private var madeSample: MagneticSample?,
) {
    constructor(buffer: ReadingBuffer, sample: RawEvent, before: Answer?) : this(
        buffer.slots.copyOf(RAW + 3).also {
            it[RAW] = sample.x
            it[RAW + 1] = sample.y
            it[RAW + 2] = sample.z
        },
        before?.figures?.takeIf { isSame(buffer.slots, it) } ?: buffer.slots.copyOfRange(RAW, ReadingBuffer.NUMBERS),
        buffer.timeNs,
        buffer.status,
        buffer.event,
        sample.reported,
        null,
        null,
    )

    constructor(reading: MagneticReading, sample: MagneticSample) :
        this(null, null, reading.timeNs, reading.status, reading.event, sample.reportedHardIronUt, reading, sample)

    val reading: MagneticReading
        get() = madeReading ?: ReadingBuffer.reading(numbers!!, 0, timeNs, event, status, figures!!, -RAW).also { madeReading = it }

    val sample: MagneticSample
        get() = madeSample ?: MagneticSample(timeNs, ReadingBuffer.vector(numbers!!, RAW), reported).also { madeSample = it }

    val headingDeg: Double? get() = known(ReadingBuffer.HEADING) { headingDeg }
    val headingSigmaDeg: Double? get() = known(ReadingBuffer.HEADING_SIGMA) { headingSigmaDeg }
    val trueHeadingDeg: Double? get() = known(ReadingBuffer.TRUE_HEADING) { trueHeadingDeg }
    val attitude: DeviceAttitude? get() = if (numbers == null) reading.attitude else ReadingBuffer.attitude(numbers)

    private inline fun known(slot: Int, given: CompassHeading.() -> Double?): Double? =
        if (numbers == null) reading.heading?.given() else ReadingBuffer.known(numbers[slot])

    companion object {
        /** Where the raw sample is among the numbers. */
        private const val RAW = ReadingBuffer.SIGMA_T

        /** What is not known is NaN, which equals nothing. */
        private fun isSame(slots: DoubleArray, figures: DoubleArray): Boolean {
            for (k in figures.indices) if (slots[RAW + k].toRawBits() != figures[k].toRawBits()) return false
            return true
        }

        /** Of a sample that never came: no field, no heading, no attitude. Window and event are those of the answer before. */
        fun ofNothing(buffer: ReadingBuffer, latestNs: Long): Answer {
            val isFirst = latestNs == Long.MIN_VALUE
            val figures = DoubleArray(ReadingBuffer.NUMBERS - RAW) { Double.NaN }
            for (slot in intArrayOf(ReadingBuffer.WINDOW, ReadingBuffer.COVERAGE, ReadingBuffer.MODE)) figures[slot - RAW] = buffer.slots[slot]
            figures[ReadingBuffer.MODEL_ORDER - RAW] = -1.0
            val event = if (isFirst) null else buffer.event
            return Answer(DoubleArray(RAW + 3) { Double.NaN }, figures, if (isFirst) 0 else latestNs, NOTHING, event, null, null, null)
        }

        private val NOTHING = CompensationStatus.Rejected(RejectReason.NotFinite)
    }
}
