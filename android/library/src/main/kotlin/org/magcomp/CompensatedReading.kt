package org.magcomp

import org.magcomp.core.*

/**
 * The answer to one magnetometer sample, as collectors get it. It never changes.
 *
 * @property unseenDirections where the field has not pointed yet, unit vectors in the device frame. The app may ask its user to turn the
 *   phone so that it does. The compass renews them several times a second
 * @property droppedBefore how many readings the collector lost right before this one because it was slow. The estimator saw every sample
 * @property sensors the phone's sensors in use; null if the source knows none, as a recording
 * @property storeError the error that the calibration store threw last, or [MagcompException.KeptDamaged] or
 *   [MagcompException.KeptNewer] for the text that it had kept; null without an error. Readings go on, and the next save tries again
 * @property headingAid what headings from outside are worth ([Compass.aid]); null if none came in the last two minutes. The compass renews it
 *   several times a second
 * @property stream whether the sensors deliver what a heading is made of. A magnetometer that is silent ([StreamStatus.Silent]) makes a reading
 *   without a sample: its heading, attitude and fields are null, its [sample] is NaN, its status is `Rejected`
 */
public class CompensatedReading internal constructor(
    internal val answer: Answer,
    public val unseenDirections: List<DeviceVector>,
    public val droppedBefore: Long,
    public val sensors: SensorsInUse?,
    public val storeError: Exception?,
    public val headingAid: HeadingAid?,
    public val stream: StreamStatus,
    /** Of its run. [SharedReadings] counts before anyone sees it. */
    internal var number: Long = 0,
) {
    /**
     * Makes a reading of records, for an app's own tests and previews.
     *
     * @param reading corrected field, heading, and what the compensator is doing
     * @param sample the raw sample it answers
     */
    public constructor(
        reading: MagneticReading,
        sample: MagneticSample,
        unseenDirections: List<DeviceVector> = emptyList(),
        droppedBefore: Long = 0,
        sensors: SensorsInUse? = null,
        storeError: Exception? = null,
        headingAid: HeadingAid? = null,
        stream: StreamStatus = StreamStatus.Live,
    ) : this(Answer(reading, sample), unseenDirections, droppedBefore, sensors, storeError, headingAid, stream)

    /** Corrected field, heading, and what the compensator is doing. The record is made when it is first asked for. */
    public val reading: MagneticReading get() = answer.reading

    /** The raw sample that this answers. The record is made when it is first asked for. */
    public val sample: MagneticSample get() = answer.sample

    /** Whether it tells that there are no samples. It is true until the next reading. */
    internal val isSilence: Boolean get() = (stream as? StreamStatus.Silent)?.sensors?.contains(PhoneSensor.MAGNETOMETER) == true

    /** The same for a collector that lost so many before it. */
    internal fun after(dropped: Long) = CompensatedReading(answer, unseenDirections, dropped, sensors, storeError, headingAid, stream, number)

    private fun parts() = listOf(reading, sample, unseenDirections, droppedBefore, sensors, storeError, headingAid, stream)

    /** Whether the other one says the same in every detail. */
    override fun equals(other: Any?): Boolean = other is CompensatedReading && parts() == other.parts()

    /** That of the details. */
    override fun hashCode(): Int = parts().hashCode()

    /** For logs. */
    override fun toString(): String = "CompensatedReading(reading=$reading, sample=$sample, unseenDirections=$unseenDirections, " +
        "droppedBefore=$droppedBefore, sensors=$sensors, storeError=$storeError, headingAid=$headingAid, stream=$stream)"
}
