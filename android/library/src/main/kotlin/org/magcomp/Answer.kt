package org.magcomp

import org.magcomp.core.*

/**
 * What the estimator answered to a sample. Kept as numbers, which take less than half of the records' room; a record is made when it is
 * first asked for. Two threads may make one each, which are equal.
 */
internal class Answer private constructor(
    /** As [ReadingBuffer] has them, then the raw sample; null: the records were given. */
    private val numbers: DoubleArray?,
    val timeNs: Long,
    val status: CompensationStatus,
    private val event: FieldEvent?,
    private val reported: DeviceVector?,
    private var madeReading: MagneticReading?,
    private var madeSample: MagneticSample?,
) {
    constructor(buffer: ReadingBuffer, sample: RawEvent) : this(
        buffer.slots.copyOf(ReadingBuffer.NUMBERS + 3).also {
            it[ReadingBuffer.NUMBERS] = sample.x
            it[ReadingBuffer.NUMBERS + 1] = sample.y
            it[ReadingBuffer.NUMBERS + 2] = sample.z
        },
        buffer.timeNs,
        buffer.status,
        buffer.event,
        sample.reported,
        null,
        null,
    )

    constructor(reading: MagneticReading, sample: MagneticSample) :
        this(null, reading.timeNs, reading.status, reading.event, sample.reportedHardIronUt, reading, sample)

    val reading: MagneticReading
        get() = madeReading ?: ReadingBuffer.reading(numbers!!, 0, timeNs, event, status).also { madeReading = it }

    val sample: MagneticSample
        get() = madeSample ?: MagneticSample(timeNs, ReadingBuffer.vector(numbers!!, ReadingBuffer.NUMBERS), reported).also { madeSample = it }

    val headingDeg: Double? get() = known(ReadingBuffer.HEADING) { headingDeg }
    val headingSigmaDeg: Double? get() = known(ReadingBuffer.HEADING_SIGMA) { headingSigmaDeg }
    val trueHeadingDeg: Double? get() = known(ReadingBuffer.TRUE_HEADING) { trueHeadingDeg }
    val attitude: DeviceAttitude? get() = if (numbers == null) reading.attitude else ReadingBuffer.attitude(numbers)

    private inline fun known(slot: Int, given: CompassHeading.() -> Double?): Double? =
        if (numbers == null) reading.heading?.given() else ReadingBuffer.known(numbers[slot])

    companion object {
        /** Of a sample that never came: no field, no heading, no attitude. Window and event are those of the answer before. */
        fun ofNothing(buffer: ReadingBuffer, latestNs: Long): Answer {
            val isFirst = latestNs == Long.MIN_VALUE
            val numbers = DoubleArray(ReadingBuffer.NUMBERS + 3) { Double.NaN }
            for (slot in intArrayOf(ReadingBuffer.WINDOW, ReadingBuffer.COVERAGE, ReadingBuffer.MODE)) numbers[slot] = buffer.slots[slot]
            numbers[ReadingBuffer.MODEL_ORDER] = -1.0
            val event = if (isFirst) null else buffer.event
            return Answer(numbers, if (isFirst) 0 else latestNs, NOTHING, event, null, null, null)
        }

        private val NOTHING = CompensationStatus.Rejected(RejectReason.NotFinite)
    }
}
