package org.magcomp

import org.magcomp.core.*

/**
 * The answer to one magnetometer sample, whole. It never changes.
 *
 * @property reading corrected field, heading, and what the compensator is doing; the heading is that of the config's frame
 * @property sample the raw sample that this answers
 * @property droppedBefore how many readings the collector lost right before this one because it was slow. The estimator saw every sample
 */
public class CompensatedReading internal constructor(
    public val reading: MagneticReading,
    public val sample: MagneticSample,
    public val droppedBefore: Long,
    internal val answer: Answer,
) {
    /** Makes a reading of records, for an app's own tests and previews. */
    public constructor(
        reading: MagneticReading,
        sample: MagneticSample,
        unseenDirections: List<DeviceVector> = emptyList(),
        droppedBefore: Long = 0,
        sensors: SensorsInUse? = null,
        storeError: Exception? = null,
        headingAid: HeadingAid? = null,
        stream: StreamStatus = StreamStatus.Live,
    ) : this(
        reading,
        sample,
        droppedBefore,
        Answer(reading.timeNs, reading.status, reading.event, null, Answer.Around(unseenDirections, sensors, storeError, headingAid, stream), null),
    )

    /**
     * Where the field has not pointed yet, unit vectors in the device frame. The app may ask its user to turn the phone so that it does. The
     * compass renews them several times a second.
     */
    public val unseenDirections: List<DeviceVector> get() = answer.around.unseenDirections

    /** The phone's sensors in use; null if the source knows none, as a recording. */
    public val sensors: SensorsInUse? get() = answer.around.sensors

    /**
     * The error that the calibration store threw last, or [MagcompException.KeptDamaged] or [MagcompException.KeptNewer] for the text that it
     * had kept; null without an error. Readings go on, and the next save tries again.
     */
    public val storeError: Exception? get() = answer.around.storeError

    /**
     * What headings from outside are worth ([Compass.aid]); null if none came in the last two minutes. The compass renews it several times a
     * second.
     */
    public val headingAid: HeadingAid? get() = answer.around.headingAid

    /**
     * Whether the sensors deliver what a heading is made of. A magnetometer that is silent ([StreamStatus.Silent]) makes a reading without a
     * sample: its heading, attitude and fields are null, its [sample] is NaN, its status is `Rejected`.
     */
    public val stream: StreamStatus get() = answer.around.stream

    /** The heading on a screen that has turned so far; null where there is none. A reading that an app made has the heading of its record. */
    public fun headingOn(rotation: ScreenRotation, axis: ReferenceAxis = ReferenceAxis.AUTO): CompassHeading? {
        if (answer.numbers == null) return reading.heading
        val headingDeg = answer.headingDeg(axis, rotation) ?: return null
        val inclinationDeg = reading.heading?.inclinationDeg
        return CompassHeading(headingDeg, answer.headingSigmaDeg(axis, rotation), answer.trueHeadingDeg(axis, rotation), inclinationDeg)
    }

    /** The same for a collector that lost so many before it. */
    internal fun after(dropped: Long) = CompensatedReading(reading, sample, dropped, answer)

    /** For logs. */
    override fun toString(): String = "CompensatedReading(reading=$reading, sample=$sample, unseenDirections=$unseenDirections, " +
        "droppedBefore=$droppedBefore, sensors=$sensors, storeError=$storeError, headingAid=$headingAid, stream=$stream)"
}
