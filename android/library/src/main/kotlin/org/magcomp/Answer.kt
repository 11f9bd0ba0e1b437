package org.magcomp

import org.magcomp.core.*

/**
 * What the estimator answered to a sample, as far as a screen needs it, for screens of any rotation. It never changes.
 *
 * @property around what most answers have in common
 * @property numbers the attitude's four numbers and the five of the core's `Pointing`: what the heading of any axis is formed of; null without
 *   an attitude
 * @property whole all of the answer, where somebody collects that
 */
internal class Answer(
    val timeNs: Long,
    val status: CompensationStatus,
    val event: FieldEvent?,
    val numbers: DoubleArray?,
    val around: Around,
    record: Record?,
) {
    /** Of its run. [SharedReadings] counts before anyone sees it. */
    var number = 0L

    val whole: CompensatedReading? = record?.let { CompensatedReading(it.reading, it.sample, 0, this) }

    /** The records, which a screen needs none of. */
    class Record(val reading: MagneticReading, val sample: MagneticSample)

    /** What seldom changes. */
    class Around(
        val unseenDirections: List<DeviceVector>,
        val sensors: SensorsInUse?,
        val storeError: Exception?,
        val headingAid: HeadingAid?,
        val stream: StreamStatus,
    )

    /** Whether it tells that there are no samples. It is true until the next one. */
    val isSilence: Boolean get() = (around.stream as? StreamStatus.Silent)?.sensors?.contains(PhoneSensor.MAGNETOMETER) == true

    fun headingDeg(axis: ReferenceAxis, rotation: ScreenRotation) = known(axis, rotation, FastPath.HEADING)

    fun headingSigmaDeg(axis: ReferenceAxis, rotation: ScreenRotation) = known(axis, rotation, FastPath.HEADING_SIGMA)

    fun trueHeadingDeg(axis: ReferenceAxis, rotation: ScreenRotation) = known(axis, rotation, FastPath.TRUE_HEADING)

    val attitude: DeviceAttitude? get() = numbers?.let {
        DeviceAttitude(it[0], it[1], it[2], it[3], known(ReferenceAxis.AUTO, ScreenRotation.DEG0, FastPath.ATTITUDE_SIGMA))
    }

    private fun known(axis: ReferenceAxis, rotation: ScreenRotation, which: Int): Double? =
        numbers?.let { ReadingBuffer.known(FastPath.heading(it, axis.ordinal, rotation.ordinal, which)) }
}
