package org.magcomp

import android.content.res.Resources
import kotlinx.coroutines.flow.Flow
import kotlinx.coroutines.flow.map

/**
 * What most apps show of a reading. It has neither `copy` nor components, so later versions may add properties and break nobody.
 *
 * @property details all else: the corrected field, the raw sample, where to turn next
 */
public class CompassReading internal constructor(public val details: CompensatedReading) {
    /** Time of the magnetometer sample, nanoseconds. */
    public val timeNs: Long get() = details.answer.timeNs

    /** Clockwise from magnetic north, degrees, 0 to 360; null: there is none yet, and [status] says why. */
    public val headingDeg: Double? get() = details.answer.headingDeg

    /** One standard deviation of it, degrees. */
    public val headingSigmaDeg: Double? get() = details.answer.headingSigmaDeg

    /** Clockwise from true north, degrees, 0 to 360; null also before [Compass.setPlace]. */
    public val trueHeadingDeg: Double? get() = details.answer.trueHeadingDeg

    /** How the phone is turned: [rotationMatrix] and [orientation] have it in Android's ways. */
    public val attitude: DeviceAttitude? get() = details.answer.attitude

    /** What the compass is doing, and why. */
    public val status: CompensationStatus get() = details.answer.status

    /** What headings from outside are worth ([Compass.aid]); null where none came of late. */
    public val headingAid: HeadingAid? get() = details.headingAid

    /** The heading as a screen reader says it, in the language of [resources]. */
    public fun spoken(resources: Resources): String = details.reading.heading.spoken(resources)

    /** Whether the other one says the same in every detail. */
    override fun equals(other: Any?): Boolean = other is CompassReading && details == other.details

    /** That of the details. */
    override fun hashCode(): Int = details.hashCode()

    /** For logs. */
    override fun toString(): String =
        "CompassReading(headingDeg=$headingDeg, headingSigmaDeg=$headingSigmaDeg, trueHeadingDeg=$trueHeadingDeg, status=$status)"
}

/** [Compass.readings], each as what most apps show of it. */
public fun Compass.headings(): Flow<CompassReading> = readings().map(::CompassReading)
