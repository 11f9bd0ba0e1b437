package org.magcomp

import android.content.res.Resources
import org.magcomp.core.*

/**
 * What most apps show of a reading.
 *
 * @property details everything else: the corrected field, the raw sample, where to turn next
 */
public class CompassReading internal constructor(public val details: CompensatedReading) {
    /** Time of the magnetometer sample, nanoseconds. */
    public val timeNs: Long get() = details.answer.timeNs

    /** The heading, clockwise from magnetic north, degrees, 0 to 360. It is null where there is none; [stream], or else [status], says why. */
    public val headingDeg: Double? get() = details.answer.headingDeg

    /** One standard deviation of [headingDeg], degrees. */
    public val headingSigmaDeg: Double? get() = details.answer.headingSigmaDeg

    /** The heading, clockwise from true north, degrees, 0 to 360. It is null also before [Compass.setPlace]. */
    public val trueHeadingDeg: Double? get() = details.answer.trueHeadingDeg

    /** How the phone is turned. [rotationMatrix] and [orientation] give it as Android does. */
    public val attitude: DeviceAttitude? get() = details.answer.attitude

    /** What the compass is doing, and why. */
    public val status: CompensationStatus get() = details.answer.status

    /** Whether the sensors deliver what a heading is made of. While the magnetometer is silent, [status] is `Rejected`. */
    public val stream: StreamStatus get() = details.stream

    /** One sentence for a screen, in the language of [resources]: what the stream lacks, or else the status. */
    public fun text(resources: Resources): String = stream.text(resources) ?: status.text(resources)

    /** What the user can do for a better heading, in the language of [resources]; null if there is nothing to do. */
    public fun guidance(resources: Resources): String? = if (stream == StreamStatus.Live) status.guidance(resources) else null

    /** What headings from outside are worth ([Compass.aid]); null if none came of late. */
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

/** What a screen shows ([Compass.state]). */
public sealed class CompassState {
    /** No reading has come yet. */
    public data object Waiting : CompassState()

    /**
     * Readings come.
     *
     * @property reading the latest
     */
    public class Live(public val reading: CompassReading) : CompassState() {
        /** Whether the other one has the same reading. */
        override fun equals(other: Any?): Boolean = other is Live && reading == other.reading

        /** That of the reading. */
        override fun hashCode(): Int = reading.hashCode()

        /** For logs. */
        override fun toString(): String = "Live($reading)"
    }

    /**
     * No more readings come.
     *
     * @property error why, such as a missing magnetometer, or [MagcompException.Closed]; null: the source has ended
     */
    public class Ended(public val error: Exception?) : CompassState() {
        /** For logs. */
        override fun toString(): String = "Ended($error)"
    }
}
